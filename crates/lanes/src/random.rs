//! Counter-based random numbers: draw `n` of a path is a pure function of (seed, pixel, sample, n).
//!
//! Each path has a 64-bit key, hashed from (seed, pixel, sample); draw `n` is the finaliser of SplitMix64 (Steele,
//! Lea & Flood 2014, with the constants of Stafford's "Mix13") applied to `key + n·γ`. No state is shared between
//! paths, so a picture does not depend on which thread or machine makes which path, or in which order. Two of 2^26
//! paths of 2^10 draws each share a stretch of numbers with probability of about 2^-2 *somewhere in the picture*;
//! nothing is biased by that, since keys are spread evenly.

/// The odd constant nearest 2^64 / golden ratio: successive counters land far apart.
pub(crate) const GAMMA: u64 = 0x9e37_79b9_7f4a_7c15;
/// Its inverse modulo 2^64.
const INVERSE_GAMMA: u64 = inverse(GAMMA);

/// The inverse of an odd number modulo 2^64: each step of Newton's method doubles the number of right bits.
const fn inverse(odd: u64) -> u64 {
    let mut inverse = odd;
    let mut right_bits = 3;
    while right_bits < u64::BITS {
        inverse = inverse.wrapping_mul(2_u64.wrapping_sub(odd.wrapping_mul(inverse)));
        right_bits *= 2;
    }
    inverse
}

#[inline(always)]
pub(crate) fn mix(mut z: u64) -> u64 {
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    z ^ (z >> 31)
}

/// The random numbers of one path, in order.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Random {
    /// key + (draws so far)·γ: key and counter in one word.
    state: u64,
}

impl Random {
    /// The numbers of sample `sample` of pixel `pixel` under `seed`.
    #[inline]
    pub fn new(seed: u64, pixel: u64, sample: u64) -> Random {
        let key = mix(mix(mix(seed.wrapping_add(GAMMA)) ^ pixel.wrapping_mul(GAMMA)).wrapping_add(sample));
        Random { state: mix(key) }
    }

    /// How many numbers were drawn from these since they were as `earlier` is.
    #[inline(always)]
    pub fn draws_since(&self, earlier: &Random) -> u64 {
        self.state.wrapping_sub(earlier.state).wrapping_mul(INVERSE_GAMMA)
    }

    /// 64 uniform bits.
    #[inline(always)]
    pub fn bits(&mut self) -> u64 {
        self.state = self.state.wrapping_add(GAMMA);
        mix(self.state)
    }

    /// Uniform in [0, 1), a multiple of 2^-53.
    #[inline(always)]
    pub fn f64(&mut self) -> f64 {
        (self.bits() >> 11) as f64 * (1.0 / (1u64 << 53) as f64)
    }

    /// Uniform in [0, 1), a multiple of 2^-24.
    #[inline(always)]
    pub fn f32(&mut self) -> f32 {
        (self.bits() >> 40) as f32 * (1.0 / (1u32 << 24) as f32)
    }

    /// Two independent uniforms in [0, 1), multiples of 2^-24, from one draw.
    #[inline(always)]
    pub fn f32x2(&mut self) -> [f32; 2] {
        let bits = self.bits();
        let scale = 1.0 / (1u32 << 24) as f32;
        [(bits >> 40) as f32 * scale, ((bits >> 8) & 0xff_ffff) as f32 * scale]
    }

    /// Three independent uniforms in [0, 1), multiples of 2^-21, from one draw.
    #[inline(always)]
    pub fn f32x3(&mut self) -> [f32; 3] {
        let bits = self.bits();
        let scale = 1.0 / (1u32 << 21) as f32;
        let part = |shift: u32| ((bits >> shift) as u32 & 0x1f_ffff) as f32 * scale;
        [part(43), part(22), part(1)]
    }

    /// Exponential variate of mean 1 in (0, 16.7): −ln of a uniform on the multiples of 2^-24 in (0, 1].
    #[inline(always)]
    pub fn exponential(&mut self) -> f32 {
        let u = ((self.bits() >> 40) + 1) as f32 * (1.0 / (1u32 << 24) as f32);
        -crate::ln(u)
    }

    /// Exponential variate of mean 1 in f64.
    #[inline(always)]
    pub fn exponential_f64(&mut self) -> f64 {
        -(1.0 - self.f64()).ln()
    }
}

#[cfg(test)]
mod tests {
    use super::Random;

    #[test]
    fn draws_are_counted_whatever_is_drawn() {
        for seed in 0..100 {
            let begun = Random::new(seed, 2, 3);
            let mut random = begun;
            for _ in 0..seed {
                random.f32x3();
            }
            assert_eq!(random.draws_since(&begun), seed);
        }
    }

    #[test]
    fn draws_depend_on_seed_pixel_and_sample() {
        let first = |s, p, n| Random::new(s, p, n).bits();
        let all =
            [first(0, 0, 0), first(1, 0, 0), first(0, 1, 0), first(0, 0, 1), first(1, 1, 0), first(0, 1, 1)];
        for (i, a) in all.iter().enumerate() {
            assert!(all[i + 1..].iter().all(|b| a != b));
        }
        assert_eq!(first(3, 5, 7), first(3, 5, 7));
    }

    /// χ² over 256 cells for each kind of draw and for pairs that neighbour in pixel or sample:
    /// each statistic stays below the 1 − 10⁻⁶ quantile of χ² with 255 degrees of freedom (about 375).
    #[test]
    fn draws_are_uniform_within_and_across_streams() {
        const N: usize = 1 << 18;
        let chi2 = |cells: &[u32; 256]| {
            let expected = N as f64 / 256.0;
            cells.iter().map(|&c| (c as f64 - expected).powi(2) / expected).sum::<f64>()
        };
        let cell = |u: f64| (u * 16.0) as usize;
        let mut kinds = [[0u32; 256]; 6];
        let mut within = Random::new(7, 0, 0);
        for i in 0..N as u64 {
            kinds[0][cell(within.f64()) * 16 + cell(within.f64())] += 1;
            let [a, b] = within.f32x2();
            kinds[1][cell(a.into()) * 16 + cell(b.into())] += 1;
            let [a, b, c] = within.f32x3();
            kinds[2][cell(a.into()) * 16 + cell(b.into())] += 1;
            kinds[3][cell(b.into()) * 16 + cell(c.into())] += 1;
            kinds[4][cell(Random::new(7, i, 0).f64()) * 16 + cell(Random::new(7, i + 1, 0).f64())] += 1;
            kinds[5][cell(Random::new(7, 0, i).f64()) * 16 + cell(Random::new(7, 0, i + 1).f64())] += 1;
        }
        for (kind, cells) in kinds.iter().enumerate() {
            assert!(chi2(cells) < 375.0, "kind {kind}: chi2 {}", chi2(cells));
        }
    }

    #[test]
    fn exponential_has_mean_and_variance_one() {
        let mut random = Random::new(11, 0, 0);
        let n = 1_000_000;
        let draws: Vec<f64> = (0..n).map(|_| f64::from(random.exponential())).collect();
        let mean = draws.iter().sum::<f64>() / n as f64;
        let second = draws.iter().map(|x| x * x).sum::<f64>() / n as f64;
        // Standard errors: 1/√n of the mean, √20/√n of the second moment.
        assert!((mean - 1.0).abs() < 4.5e-3, "{mean}");
        assert!((second - 2.0).abs() < 2.1e-2, "{second}");
    }
}
