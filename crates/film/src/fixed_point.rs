//! Numbers whose sums do not depend on the order of addition.
//!
//! Floating-point addition rounds, so (a+b)+c ≠ a+(b+c), and a picture would depend on who added first. Integers
//! do not round: a sample is turned into a fixed-point number once, on its own, and everything after that is exact.
//! Kulisch's long accumulators follow the same idea; a renderer needs fewer bits:
//!
//! ```text
//! Σx   i128, 64 fractional bits   |x| < 2^32, steps of 5e-20, room for 2^31 samples
//! Σx²  192 bits, 96 of them fractional          x² < 2^64, steps of 1e-29, room for 2^31 samples
//! ```
//!
//! This spans radiance from starlight in W/m² (1e-12) to the sun's disc in cd/m² (1.6e9). From 2^-40 upwards an
//! `f32` fits Σx without any rounding; from 2^-25 upwards its square fits Σx².
//!
//! All additions wrap, so that sums from a file that lies cannot end the program.

/// Fractional bits of Σx.
pub const SUM_FRACTION_BITS: i32 = 64;
/// Fractional bits of Σx².
pub const SQUARE_FRACTION_BITS: i32 = 96;
/// Values must be smaller than this in magnitude.
pub const LIMIT: f32 = 4_294_967_296.0;
/// So many samples a pixel can be added without overflow.
pub const MAX_SAMPLES: u64 = 1 << 31;

/// Splits a finite number into its integer mantissa and exponent: |x| = mantissa · 2^exponent.
fn mantissa_and_exponent(x: f32) -> (u32, i32) {
    let bits = x.to_bits();
    let biased = (bits >> 23 & 0xff) as i32;
    let fraction = bits & 0x007f_ffff;
    if biased == 0 { (fraction, -149) } else { (fraction | 0x0080_0000, biased - 150) }
}

/// `m` · 2^`shift`, rounded to the nearest integer (halves away from zero).
fn shifted(m: u64, shift: i32) -> u128 {
    match shift {
        0.. => u128::from(m) << shift,
        -63..0 => u128::from((m + (1 << (-shift - 1))) >> -shift),
        _ => 0,
    }
}

/// `x` as an integer count of 2^-`fraction_bits`; `x` must be finite and |x|·2^`fraction_bits` below 2^127.
pub fn to_fixed(x: f32, fraction_bits: i32) -> i128 {
    let (m, e) = mantissa_and_exponent(x);
    let magnitude = shifted(u64::from(m), e + fraction_bits) as i128;
    if x.is_sign_negative() { -magnitude } else { magnitude }
}

/// `x` as an integer count of 2^-`fraction_bits`, back in floating point.
pub fn to_f64(x: i128, fraction_bits: i32) -> f64 {
    libm::ldexp(x as f64, -fraction_bits)
}

/// Σx²: 192 bits, least significant word first, [`SQUARE_FRACTION_BITS`] of them fractional.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct SquareSum(pub [u64; 3]);

impl SquareSum {
    /// Adds x²; |x| must be below [`LIMIT`].
    pub fn add_square_of(&mut self, x: f32) {
        let (m, e) = mantissa_and_exponent(x);
        let square = u64::from(m) * u64::from(m);
        let shift = 2 * e + SQUARE_FRACTION_BITS;
        // |x| < 2^32 bounds the shift by 112: the value starts in word 0 or 1 and is at most two words long.
        if shift < 64 {
            let value = shifted(square, shift);
            self.add(Self([value as u64, (value >> 64) as u64, 0]));
        } else {
            let value = shifted(square, shift - 64);
            self.add(Self([0, value as u64, (value >> 64) as u64]));
        }
    }

    /// Adds another sum, modulo 2^192.
    pub fn add(&mut self, other: Self) {
        let (a, b) = (self.low(), other.low());
        let (low, carry) = a.overflowing_add(b);
        let high = self.0[2].wrapping_add(other.0[2]).wrapping_add(u64::from(carry));
        self.0 = [low as u64, (low >> 64) as u64, high];
    }

    fn low(self) -> u128 {
        u128::from(self.0[0]) | u128::from(self.0[1]) << 64
    }
}

/// The unbiased variance of `n` numbers from their exact sums,
///
/// ```text
/// s² = (n Σx² − (Σx)²) / (n (n − 1))
/// ```
///
/// The difference cancels almost wholly where noise is small, so it is taken in 256-bit integers and rounded once.
/// Infinite for n < 2: nothing is known yet.
pub fn sample_variance(n: u64, sum: i128, squares: SquareSum) -> f64 {
    if n < 2 {
        return f64::INFINITY;
    }
    // Both terms with 128 fractional bits: Σx² is shifted by 32.
    let squares_times_n = {
        let factor = u128::from(n) << 32;
        let low = product(squares.low(), factor);
        let high = product(u128::from(squares.0[2]), factor);
        [low[0], low[1].wrapping_add(high[0])]
    };
    let magnitude = sum.unsigned_abs();
    let difference = subtract(squares_times_n, product(magnitude, magnitude));
    let n = n as f64;
    libm::ldexp(difference, -128) / (n * (n - 1.0))
}

/// a·b as two halves of 128 bits, the lower first (schoolbook multiplication).
fn product(a: u128, b: u128) -> [u128; 2] {
    const LOW: u128 = u64::MAX as u128;
    let (a0, a1, b0, b1) = (a & LOW, a >> 64, b & LOW, b >> 64);
    let (p00, p01, p10, p11) = (a0 * b0, a0 * b1, a1 * b0, a1 * b1);
    let middle = (p00 >> 64) + (p01 & LOW) + (p10 & LOW);
    [(p00 & LOW) | middle << 64, p11 + (p01 >> 64) + (p10 >> 64) + (middle >> 64)]
}

/// a − b of 256-bit numbers, rounded to `f64`; 0 where the rounding of tiny squares has made it negative.
fn subtract(a: [u128; 2], b: [u128; 2]) -> f64 {
    if (a[1], a[0]) <= (b[1], b[0]) {
        return 0.0;
    }
    let (low, borrow) = a[0].overflowing_sub(b[0]);
    let high = a[1].wrapping_sub(b[1]).wrapping_sub(u128::from(borrow));
    libm::ldexp(high as f64, 128) + low as f64
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn conversion_is_exact_from_2_to_the_minus_40_up() {
        for x in [0.0, 1.0, -1.0, 0.1, -3.7e6, 4.0e9, 1e-7, 2f32.powi(-40), -1.234e-12, f32::MIN_POSITIVE] {
            let back = to_f64(to_fixed(x, SUM_FRACTION_BITS), SUM_FRACTION_BITS);
            assert!((back - f64::from(x)).abs() <= 2f64.powi(-65), "{x}");
            if x.abs() >= 2f32.powi(-40) {
                assert_eq!(back, f64::from(x));
            }
        }
    }

    #[test]
    fn extremes_fit_with_the_greatest_sample_count() {
        let brightest = LIMIT.next_down();
        let sum = to_fixed(brightest, SUM_FRACTION_BITS).checked_mul(MAX_SAMPLES.into());
        assert!(sum.is_some());
        let mut square = SquareSum::default();
        square.add_square_of(brightest);
        assert!(square.0[2].checked_mul(MAX_SAMPLES + 1).is_some());
    }

    #[test]
    fn a_constant_has_no_variance_at_any_brightness() {
        for x in [3.3e9f32, 0.3, 1.7e-7] {
            let mut squares = SquareSum::default();
            let mut sum = 0;
            for _ in 0..1000 {
                sum += to_fixed(x, SUM_FRACTION_BITS);
                squares.add_square_of(x);
            }
            assert_eq!(sample_variance(1000, sum, squares), 0.0, "{x}");
        }
    }

    #[test]
    fn fewer_than_two_samples_tell_nothing_of_the_variance() {
        assert_eq!(sample_variance(1, to_fixed(1.0, 64), SquareSum::default()), f64::INFINITY);
    }

    proptest! {
        #[test]
        fn variance_agrees_with_two_passes_in_double_precision(
            values in prop::collection::vec(-1f32..1.0, 2..50), exponent in -36i32..30, offset in -10f32..10.0,
        ) {
            let values: Vec<f32> = values.iter().map(|v| (v + offset) * 2f32.powi(exponent)).collect();
            let (mut sum, mut squares) = (0, SquareSum::default());
            for &v in &values {
                sum += to_fixed(v, SUM_FRACTION_BITS);
                squares.add_square_of(v);
            }
            let n = values.len() as f64;
            let mean = values.iter().map(|&v| f64::from(v)).sum::<f64>() / n;
            let truth = values.iter().map(|&v| (f64::from(v) - mean).powi(2)).sum::<f64>() / (n - 1.0);
            let scale = mean * mean + truth;
            let variance = sample_variance(values.len() as u64, sum, squares);
            // 2^-96 is the step of Σx²; 1e-13 the rounding of the two passes.
            prop_assert!((variance - truth).abs() <= 1e-13 * scale + 2f64.powi(-94), "{variance} {truth}");
        }

        #[test]
        fn any_sum_of_squares_is_taken_without_overflow(n: u64, sum: i128, squares: [u64; 3]) {
            prop_assert!(sample_variance(n, sum, SquareSum(squares)) >= 0.0);
        }

        #[test]
        fn wide_products_have_the_right_halves(a: u128, b: u128) {
            let [low, high] = product(a, b);
            prop_assert_eq!(low, a.wrapping_mul(b));
            let exact = a as f64 * b as f64;
            let wide = high as f64 * 2f64.powi(128) + low as f64;
            prop_assert!((wide - exact).abs() <= 1e-15 * exact);
        }
    }
}
