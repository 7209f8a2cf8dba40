//! Sixteen wavelengths, sunlight at them, and what the eye makes of it.
//!
//! Colour matching functions: the analytic fit of Wyman, Sloan & Shirley 2013, "Simple Analytic
//! Approximations to the CIE XYZ Color Matching Functions". XYZ to linear Rec. 709 for a D65 white (IEC
//! 61966-2-1).

use std::array;
use std::f64::consts::PI;

use glam::{DMat3, DVec3};

/// Number of wavelengths.
pub(super) const COUNT: usize = 16;

/// A quantity at each wavelength.
pub(super) type Spectrum = [f64; COUNT];

/// Distance between wavelengths, nm; each stands for the band of this width about it.
const STEP: f64 = 20.0;

/// The wavelengths: 400, 420, … 700 nm.
pub(super) fn wavelengths() -> Spectrum {
    array::from_fn(|index| 400.0 + STEP * index as f64)
}

/// Solar irradiance outside the atmosphere, W/(m² nm): means of ASTM G-173 over each band, at the mean
/// distance of the sun.
pub(super) const SOLAR_IRRADIANCE: Spectrum = [
    1.437, 1.710, 1.762, 2.028, 1.978, 1.937, 1.849, 1.872, 1.842, 1.825, 1.767, 1.689, 1.626, 1.539, 1.493,
    1.429,
];

/// Absorption cross-section of ozone at 233 K, 1e-25 m²: means over each band of the spectra of Gorshelev et
/// al. 2014 and Serdyuchenko et al. 2014.
pub(super) const OZONE_CROSS_SECTION: Spectrum = [
    0.0110, 0.0414, 0.1214, 0.2993, 0.6338, 1.1908, 1.8705, 2.9230, 3.8830, 4.5350, 4.8600, 4.0225, 2.9385,
    2.0450, 1.3410, 0.8439,
];

/// Applies `f` at each wavelength.
pub(super) fn each(f: impl FnMut(usize) -> f64) -> Spectrum {
    array::from_fn(f)
}

/// Spectral radiance or irradiance, in units of solar irradiance, to linear Rec. 709 in units of 100,000
/// lm/m² / π. Colours outside the gamut are clipped.
pub(super) struct ToRgb {
    weights: [DVec3; COUNT],
}

impl ToRgb {
    pub(super) fn new() -> Self {
        let to_rgb = DMat3::from_cols(
            DVec3::new(3.2404542, -0.9692660, 0.0556434),
            DVec3::new(-1.5371385, 1.8760108, -0.2040259),
            DVec3::new(-0.4985314, 0.0415560, 1.0572252),
        );
        const LUMENS_PER_WATT: f64 = 683.0;
        const UNIT: f64 = 100_000.0 / PI;
        let wavelengths = wavelengths();
        let weights = array::from_fn(|index| {
            let power = SOLAR_IRRADIANCE[index] * STEP;
            to_rgb * colour_matching(wavelengths[index]) * (power * LUMENS_PER_WATT / UNIT)
        });
        Self { weights }
    }

    pub(super) fn convert(&self, spectrum: &Spectrum) -> DVec3 {
        let sum: DVec3 = self.weights.iter().zip(spectrum).map(|(weight, value)| *weight * *value).sum();
        sum.max(DVec3::ZERO)
    }
}

/// CIE 1931 x̄, ȳ, z̄ at a wavelength in nm.
fn colour_matching(wavelength: f64) -> DVec3 {
    // A Gaussian with different widths below and above its centre.
    let lobe = |height: f64, centre: f64, below: f64, above: f64| {
        let distance = (wavelength - centre) / if wavelength < centre { below } else { above };
        height * libm::exp(-0.5 * distance * distance)
    };
    DVec3::new(
        lobe(1.056, 599.8, 37.9, 31.0) + lobe(0.362, 442.0, 16.0, 26.7) + lobe(-0.065, 501.1, 20.4, 26.2),
        lobe(0.821, 568.8, 46.9, 40.5) + lobe(0.286, 530.9, 16.3, 31.1),
        lobe(1.217, 437.0, 11.8, 36.0) + lobe(0.681, 459.0, 26.0, 13.8),
    )
}

/// A reflectance of three channels at each wavelength, by linear interpolation between the bands' middles.
pub(super) fn reflectance(rgb: DVec3) -> Spectrum {
    let wavelengths = wavelengths();
    each(|index| {
        let wavelength = wavelengths[index];
        if wavelength < 545.0 {
            let green = ((wavelength - 460.0) / 85.0).clamp(0.0, 1.0);
            rgb.z + (rgb.y - rgb.z) * green
        } else {
            let red = ((wavelength - 545.0) / 65.0).clamp(0.0, 1.0);
            rgb.y + (rgb.x - rgb.y) * red
        }
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sunlight_outside_the_atmosphere_is_133_kilolux_of_nearly_white_light() {
        let rgb = ToRgb::new().convert(&[1.0; COUNT]);
        let luminance = rgb.dot(DVec3::new(0.2126, 0.7152, 0.0722));
        let lux = luminance * 100_000.0 / PI;
        assert!((lux - 133_000.0).abs() < 2_000.0, "{lux}");
        // About 5,800 K: a little warmer than D65.
        let ratio = rgb / rgb.y;
        assert!((1.0..1.15).contains(&ratio.x) && (0.85..1.0).contains(&ratio.z), "{rgb}");
    }
}
