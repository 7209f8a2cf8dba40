//! One homogeneous sphere in a plane wave (Mie 1908; Bohren & Huffman 1983, chapter 4).
//!
//! With the size x = 2πr/λ, the refractive index m relative to the medium around, and the Riccati-Bessel functions
//! ψₙ(z) = z jₙ(z), χₙ(z) = −z yₙ(z), ξₙ = ψₙ − iχₙ,
//!
//! ```text
//! aₙ = [ψₙ′(mx) ψₙ(x) − m ψₙ(mx) ψₙ′(x)] / [ψₙ′(mx) ξₙ(x) − m ψₙ(mx) ξₙ′(x)]
//! bₙ = [m ψₙ′(mx) ψₙ(x) − ψₙ(mx) ψₙ′(x)] / [m ψₙ′(mx) ξₙ(x) − ψₙ(mx) ξₙ′(x)]
//! ```
//!
//! Both are (ψₙ₊₁ − Cₙψₙ)/(ξₙ₊₁ − Cₙξₙ), where Cₙ = m ρₙ₊₁(mx) for bₙ, Cₙ = ρₙ₊₁(mx)/m + (1 − m⁻²)(n+1)/x for aₙ, and
//! ρₙ = ψₙ/ψₙ₋₁. In that form small spheres lose no digits. The Wronskian ψₙ₊₁χₙ − ψₙχₙ₊₁ = −1 makes
//! Re aₙ − |aₙ|² = Im Cₙ/|ξₙ₊₁ − Cₙξₙ|², so that absorption is a sum of positive terms, however weak it is.

use num_complex::Complex64;
use std::f64::consts::PI;

use super::MieError;
use super::riccati_bessel::{chi, psi, ratios};
use crate::refractive_index::RefractiveIndex;

/// Sizes that are computed: below, a sphere is a point; above, tables of its diffraction peak make no sense.
const SIZES: std::ops::RangeInclusive<f64> = 1e-6..=1e5;

/// Greatest |m|x, which bounds memory: some 100 MB.
const GREATEST_INNER_SIZE: f64 = 2e6;

/// A sphere of one size and refractive index at one wavelength.
#[derive(Debug, Clone, PartialEq)]
pub struct Sphere {
    /// Size parameter x = 2πr/λ, with the wavelength in the medium around.
    pub x: f64,
    /// Extinction efficiency: cross section over πr².
    pub q_ext: f64,
    /// Scattering efficiency.
    pub q_sca: f64,
    /// Absorption efficiency, the difference of the two, without their cancellation.
    pub q_abs: f64,
    /// Radar backscattering efficiency 4|S(180°)|²/x².
    pub q_back: f64,
    /// Asymmetry: mean cosine of the scattering angle.
    pub g: f64,
    /// (2n+1)/(n(n+1)) (aₙ + bₙ) and the same of (aₙ − bₙ), from n = 1.
    coefficients: Vec<[Complex64; 2]>,
}

impl Sphere {
    /// Solves the sphere of size `x` (1e-6 to 1e5) and refractive index `m` relative to the medium around.
    pub fn new(m: RefractiveIndex, x: f64) -> Result<Self, MieError> {
        check_sphere(m, x)?;
        Ok(Self::solve(Complex64::new(m.n, m.k), x))
    }

    /// Number of terms in the series.
    pub(super) fn terms(&self) -> usize {
        self.coefficients.len()
    }

    fn solve(m: Complex64, x: f64) -> Self {
        let terms = number_of_terms(x);
        let inner = ratios(m * x, terms + 1);
        let (psi, chi) = (psi(x, terms + 1), chi(x, terms + 1));

        let (mut sca, mut abs, mut asymmetry, mut back) = (0.0, 0.0, 0.0, Complex64::ZERO);
        let mut coefficients = Vec::with_capacity(terms);
        let mut previous: Option<[Complex64; 2]> = None;
        for n in 1..=terms {
            let order = n as f64;
            let magnetic = m * inner[n + 1];
            let electric = inner[n + 1] / m + (1.0 - (m * m).inv()) * (order + 1.0) / x;
            let [(a, a_absorbs), (b, b_absorbs)] = [electric, magnetic].map(|c| {
                let numerator = psi[n + 1] - c * psi[n];
                let denominator = numerator - Complex64::I * (chi[n + 1] - c * chi[n]);
                (numerator / denominator, c.im / denominator.norm_sqr())
            });
            sca += (2.0 * order + 1.0) * (a.norm_sqr() + b.norm_sqr());
            abs += (2.0 * order + 1.0) * (a_absorbs + b_absorbs);
            let pair = (2.0 * order + 1.0) / (order * (order + 1.0));
            asymmetry += pair * (a * b.conj()).re;
            if let Some([a_before, b_before]) = previous {
                let neighbours = (order - 1.0) * (order + 1.0) / order;
                asymmetry += neighbours * (a_before * a.conj() + b_before * b.conj()).re;
            }
            back += (order + 0.5) * if n % 2 == 0 { a - b } else { b - a };
            coefficients.push([(a + b) * pair, (a - b) * pair]);
            previous = Some([a, b]);
        }
        let q_sca = 2.0 / (x * x) * sca;
        let q_abs = 2.0 / (x * x) * abs;
        Self {
            x,
            q_ext: q_sca + q_abs,
            q_sca,
            q_abs,
            q_back: 4.0 / (x * x) * back.norm_sqr(),
            g: 4.0 / (x * x * q_sca) * asymmetry,
            coefficients,
        }
    }

    /// The phase function of unpolarised light at cos θ, 1/sr: (|S₁|² + |S₂|²)/(2πx²Qsca).
    pub fn phase_function(&self, cos_theta: f64) -> f64 {
        let (mut there, mut opposite) = ([0.0], [0.0]);
        let weight = 1.0 / (PI * self.x * self.x * self.q_sca);
        self.add_intensities(&[cos_theta], weight, &mut there, &mut opposite);
        there[0]
    }

    /// Adds `weight` (|S₁|² + |S₂|²)/2 at each cos θ to `there`, and that at −cos θ to `opposite`.
    pub(super) fn add_intensities(
        &self,
        cos_theta: &[f64],
        weight: f64,
        there: &mut [f64],
        opposite: &mut [f64],
    ) {
        let blocks = cos_theta.chunks(LANES).zip(there.chunks_mut(LANES)).zip(opposite.chunks_mut(LANES));
        for ((cosines, there), opposite) in blocks {
            let mut mu = [1.0; LANES];
            mu[..cosines.len()].copy_from_slice(cosines);
            let intensities = self.intensities(&mu);
            for (sums, intensities) in [there, opposite].into_iter().zip(intensities) {
                for (sum, intensity) in sums.iter_mut().zip(intensities) {
                    *sum += weight * intensity;
                }
            }
        }
    }

    /// (|S₁|² + |S₂|²)/2 = (|S₊|² + |S₋|²)/4 at some angles and at those opposite, in a form that compiles to vectors.
    ///
    /// The amplitudes are S± = S₁ ± S₂ = Σ (2n+1)/(n(n+1)) (aₙ ± bₙ)(πₙ ± τₙ), with the angular functions by the upward
    /// recurrence of Wiscombe 1980, "Improved Mie scattering algorithms", eq. 15-17. For the opposite angle, πₙ ± τₙ is
    /// (−1)ⁿ⁺¹(πₙ ∓ τₙ).
    fn intensities(&self, mu: &[f64; LANES]) -> [[f64; LANES]; 2] {
        let (mut pi_before, mut pi) = ([0.0; LANES], [1.0; LANES]);
        let [mut there, mut opposite] = [[[0.0; LANES]; 4]; 2];
        let mut sign = 1.0;
        for (index, [plus, minus]) in self.coefficients.iter().enumerate() {
            let n = (index + 1) as f64;
            let growth = (n + 1.0) / n;
            let [signed_plus, signed_minus] = [plus * sign, minus * sign];
            sign = -sign;
            for lane in 0..LANES {
                let s = mu[lane] * pi[lane];
                let t = s - pi_before[lane];
                let tau = n * t - pi_before[lane];
                let (together, apart) = (pi[lane] + tau, pi[lane] - tau);
                there[0][lane] += plus.re * together;
                there[1][lane] += plus.im * together;
                there[2][lane] += minus.re * apart;
                there[3][lane] += minus.im * apart;
                opposite[0][lane] += signed_plus.re * apart;
                opposite[1][lane] += signed_plus.im * apart;
                opposite[2][lane] += signed_minus.re * together;
                opposite[3][lane] += signed_minus.im * together;
                pi_before[lane] = pi[lane];
                pi[lane] = s + growth * t;
            }
        }
        [there, opposite].map(|sums| {
            std::array::from_fn(|lane| 0.25 * sums.iter().map(|sum| sum[lane] * sum[lane]).sum::<f64>())
        })
    }
}

/// Whether a sphere can be solved.
pub(super) fn check_sphere(m: RefractiveIndex, x: f64) -> Result<(), MieError> {
    m.check()?;
    if !SIZES.contains(&x) {
        return Err(MieError::Size { x });
    }
    if m.n == 1.0 && m.k == 0.0 {
        return Err(MieError::NoContrast);
    }
    let m = libm::hypot(m.n, m.k);
    if m * x > GREATEST_INNER_SIZE { Err(MieError::InnerSize { m, x }) } else { Ok(()) }
}

/// Angles whose amplitudes are summed together: as many as fit the registers.
const LANES: usize = 4;

/// Beyond x + 4.05 x^{1/3} terms the rest is below 1e-14 of Qext (Wiscombe 1980, eq. 8). Some more, since amplitudes far
/// from forward fall only with the root of that, and more slowly where a sharp resonance lies beyond.
fn number_of_terms(x: f64) -> usize {
    (x + 5.0 * libm::cbrt(x)) as usize + 8
}
