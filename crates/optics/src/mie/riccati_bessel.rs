//! Riccati-Bessel functions, each by the recurrence that is stable for it.
//!
//! ```text
//! fₙ₊₁(z) = (2n+1)/z fₙ(z) − fₙ₋₁(z)    for f = ψ, χ        ψ₀ = sin z, χ₀ = cos z        ρₙ = ψₙ/ψₙ₋₁
//! ```
//!
//! (Abramowitz & Stegun 1964, 10.1.19 and 10.3). χ grows with n beyond z and is computed upward; ψ falls there and would
//! drown in χ, so that its ratios are computed downward (Miller's algorithm; Wiscombe 1980).

use num_complex::Complex64;

/// ρₙ(z) for n = 0 … `last`, by ρₙ = 1/((2n+1)/z − ρₙ₊₁).
pub(super) fn ratios(z: Complex64, last: usize) -> Vec<Complex64> {
    let mut ratios = vec![Complex64::ZERO; last + 1];
    let inverse = z.inv();
    let mut ratio = Complex64::ZERO;
    for n in (0..=first_order(z.norm(), last)).rev() {
        let denominator = (2 * n + 1) as f64 * inverse - ratio;
        // At a zero of ψₙ₋₁ the ratio is infinite; a great number in its place leads to the right one below.
        ratio = if denominator == Complex64::ZERO { Complex64::new(1e30, 0.0) } else { denominator.inv() };
        if n <= last {
            ratios[n] = ratio;
        }
    }
    ratios
}

/// ψₙ(x) for n = 0 … `last`: upward while it oscillates, by its ratios where it falls.
pub(super) fn psi(x: f64, last: usize) -> Vec<f64> {
    let ratios = ratios(Complex64::new(x, 0.0), last);
    let mut psi = Vec::with_capacity(last + 1);
    psi.push(libm::sin(x));
    let mut before = libm::cos(x);
    for n in 1..=last {
        let (order, now) = (n as f64, psi[n - 1]);
        let next = if order <= x { (2.0 * order - 1.0) / x * now - before } else { ratios[n].re * now };
        before = now;
        psi.push(next);
    }
    psi
}

/// χₙ(x) for n = 0 … `last`.
pub(super) fn chi(x: f64, last: usize) -> Vec<f64> {
    let mut chi = Vec::with_capacity(last + 1);
    chi.push(libm::cos(x));
    let mut before = -libm::sin(x);
    for n in 1..=last {
        let now = chi[n - 1];
        chi.push((2 * n - 1) as f64 / x * now - before);
        before = now;
    }
    chi
}

/// From where to go down: beyond z the error of a start with 0 falls as exp(−4/3 t^{3/2}) with t = (n − z)/(z/2)^{1/3},
/// which at 8 z^{1/3} is below the last digit.
fn first_order(size: f64, last: usize) -> usize {
    last.max((size + 8.0 * libm::cbrt(size)) as usize) + 15
}
