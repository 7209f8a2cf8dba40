//! Four wavelengths for a path, and what the CIE 1931 standard observer makes of the radiance at them.
//!
//! The wavelengths are drawn with the density
//!
//!   p(λ) ∝ sech²((λ − 538 nm)/138.9 nm) on 360…830 nm,   F⁻¹(u) = 538 nm + 138.9 nm · artanh(t₀ + u (t₁ − t₀)),
//!
//! with t₀, t₁ the tanh of the ends' (λ − 538 nm)/138.9 nm: about as the eye sees them (Radziszewski, Boryczko & Alda 2009,
//! "An improved technique for full spectral rendering"). One random number u gives four of them, u + i/4 modulo 1, so that
//! they are spread over the range (Wilkie et al. 2014, "Hero wavelength spectral sampling"). By each the radiance is
//! weighted with
//!
//!   (x̄, ȳ, z̄)(λᵢ) / (4 p(λᵢ) ∫ȳ dλ),
//!
//! whose mean is XYZ in the unit of [`cie::xyz`].

use glam::DVec3;
use tyndall_optics::cie;

/// Where the density is greatest, nm.
const CENTRE_NM: f64 = 538.0;
/// Width of the density, nm.
const WIDTH_NM: f64 = 1.0 / 0.0072;

/// A wavelength in nm and its density in 1/nm, for `u` uniform in [0, 1).
pub(super) fn sample(u: f64) -> (f64, f64) {
    let [low, high] = [cie::FIRST_NM, cie::LAST_NM].map(|nm| libm::tanh((nm - CENTRE_NM) / WIDTH_NM));
    let tanh = low + u * (high - low);
    let wavelength = (CENTRE_NM + WIDTH_NM * libm::atanh(tanh)).clamp(cie::FIRST_NM, cie::LAST_NM);
    (wavelength, (1.0 - tanh * tanh) / (WIDTH_NM * (high - low)))
}

/// Four wavelengths in nm for `u` uniform in [0, 1), and the XYZ that radiance 1 at each adds.
pub(super) fn four(u: f64) -> ([f64; 4], [DVec3; 4]) {
    let drawn = [0.0, 0.25, 0.5, 0.75].map(|step| sample((u + step).fract()));
    let xyz = drawn
        .map(|(wavelength, density)| cie::colour_matching(wavelength) / (4.0 * density * cie::Y_INTEGRAL_NM));
    (drawn.map(|(wavelength, _)| wavelength), xyz)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn wavelengths_follow_their_density_over_the_whole_range() {
        assert!((sample(0.0).0 - 360.0).abs() < 1e-9 && (sample(1.0).0 - 830.0).abs() < 1e-9);
        // The derivative of the inverse distribution is 1/p.
        for u in (1..100).map(|i| f64::from(i) / 100.0) {
            let step = 1e-6;
            let slope = (sample(u + step).0 - sample(u - step).0) / (2.0 * step);
            assert!((slope * sample(u).1 - 1.0).abs() < 1e-6, "{u}");
        }
    }

    #[test]
    fn four_wavelengths_give_the_colour_of_a_spectrum() {
        for spectrum in [|_| 1.0, cie::white, |nm: f64| (nm / 550.0).powi(-4)] {
            let n = 20_000;
            let mean = |u: f64| -> DVec3 {
                let (wavelengths, xyz) = four(u);
                (0..4).map(|i| xyz[i] * spectrum(wavelengths[i])).sum()
            };
            let sum: DVec3 = (0..n).map(|i| mean((f64::from(i) + 0.5) / f64::from(n))).sum();
            let (mean, truth) = (sum / f64::from(n), cie::xyz(spectrum));
            // The products of two polygons between their corners are not in the sum over nanometres.
            assert!((mean - truth).abs().max_element() < 3e-5, "{mean}, not {truth}");
        }
    }
}
