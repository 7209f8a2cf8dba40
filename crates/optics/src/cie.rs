//! Colour: what the CIE 1931 standard observer makes of a spectrum, and linear Rec. 709.
//!
//!   (X, Y, Z) = ∫ L(λ) (x̄, ȳ, z̄)(λ) dλ / ∫ ȳ dλ
//!
//! The integral is the sum over 360, 361, … 830 nm. Divided by ∫ ȳ, a spectrum that is 1 everywhere has Y = 1, so that
//! spectra of light and their RGB are in one unit: for L in W/(m² sr nm) the luminance in cd/m² is
//! [`LUMINANCE_OF_Y`] · Y. RGB is linear Rec. 709 (IEC 61966-2-1) with the white (x, y) = (0.3127, 0.3290).

mod daylight;
mod observer;

use glam::{DMat3, DVec3};

use daylight::D65;
use observer::COLOUR_MATCHING;

/// Shortest wavelength that is seen, nm.
pub const FIRST_NM: f64 = 360.0;
/// Longest wavelength that is seen, nm.
pub const LAST_NM: f64 = 830.0;

/// ∫ ȳ dλ, nm.
pub const Y_INTEGRAL_NM: f64 = 106.856_917_101;

/// cd/m² for Y = 1 of a radiance in W/(m² sr nm): the luminous efficacy 683.002 lm/W times ∫ ȳ dλ.
pub const LUMINANCE_OF_Y: f64 = 683.002 * Y_INTEGRAL_NM;

/// XYZ to linear Rec. 709, from the primaries' chromaticities and D65 at (0.3127, 0.3290); columns.
const RGB_OF_XYZ: DMat3 = DMat3::from_cols(
    DVec3::new(3.2404541621141054, -0.9692660305051868, 0.0556434309591147),
    DVec3::new(-1.5371385127977166, 1.8760108454466942, -0.2040259135167538),
    DVec3::new(-0.4985314095560162, 0.0415560175303501, 1.0572251882231791),
);

/// Luminance Y of linear Rec. 709 is the dot product with this.
pub const LUMINANCE_OF_RGB: DVec3 = DVec3::new(0.2126728514056225, 0.7151521552878178, 0.07217499330655938);

/// x̄, ȳ, z̄ at a wavelength in nm, linear between the nanometres; 0 outside 360–830 nm.
pub fn colour_matching(wavelength_nm: f64) -> DVec3 {
    if !(FIRST_NM..=LAST_NM).contains(&wavelength_nm) {
        return DVec3::ZERO;
    }
    let place = wavelength_nm - FIRST_NM;
    let index = (place as usize).min(COLOUR_MATCHING.len() - 2);
    let [here, next] = [index, index + 1].map(|i| DVec3::from_array(COLOUR_MATCHING[i]));
    here + (next - here) * (place - index as f64)
}

/// XYZ of a spectrum of light, given per wavelength in nm.
pub fn xyz(spectrum: impl Fn(f64) -> f64) -> DVec3 {
    let sum: DVec3 = COLOUR_MATCHING
        .iter()
        .enumerate()
        .map(|(index, &matching)| DVec3::from_array(matching) * spectrum(FIRST_NM + index as f64))
        .sum();
    sum / Y_INTEGRAL_NM
}

/// Linear Rec. 709 of XYZ; channels of colours outside its gamut are negative.
pub fn xyz_to_rgb(xyz: DVec3) -> DVec3 {
    RGB_OF_XYZ * xyz
}

/// XYZ of linear Rec. 709.
pub fn rgb_to_xyz(rgb: DVec3) -> DVec3 {
    RGB_OF_XYZ.inverse() * rgb
}

/// Luminance Y of linear Rec. 709.
pub fn luminance(rgb: DVec3) -> f64 {
    LUMINANCE_OF_RGB.dot(rgb)
}

/// The colour within the gamut of Rec. 709 that has this colour's luminance: negative channels become 0, and the
/// others weaker in one proportion. Black if the luminance is not positive.
pub fn into_gamut(rgb: DVec3) -> DVec3 {
    let clipped = rgb.max(DVec3::ZERO);
    let (wanted, has) = (luminance(rgb), luminance(clipped));
    if wanted > 0.0 && has > 0.0 { clipped * (wanted / has) } else { DVec3::ZERO }
}

/// The light of RGB (1, 1, 1): daylight D65, tilted by at most 2e-5 of itself so that its colour by this module's sum
/// and matrix is (1, 1, 1) to 1e-9. Beyond 360–830 nm the nearer end's.
pub fn white(wavelength_nm: f64) -> f64 {
    let wavelength_nm = wavelength_nm.clamp(FIRST_NM, LAST_NM);
    let place = (wavelength_nm - FIRST_NM) / 5.0;
    let index = (place as usize).min(D65.len() - 2);
    let daylight = D65[index] + (D65[index + 1] - D65[index]) * (place - index as f64);
    let u = (wavelength_nm - 595.0) / 235.0;
    daylight * (0.010_112_238_024_088_6 - u * (1.014_906_704_52e-7 + u * 9.660_730_505_55e-8))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn equal_energy_has_luminance_one_and_white_is_white() {
        let equal = xyz(|_| 1.0);
        assert!((equal.y - 1.0).abs() < 1e-11 && (equal - 1.0).abs().max_element() < 5e-4, "{equal}");
        let white = xyz_to_rgb(xyz(white));
        assert!((white - 1.0).abs().max_element() < 1e-9, "{white}");
    }

    #[test]
    fn the_matrix_takes_each_primary_to_its_chromaticity() {
        let chromaticities = [[0.64, 0.33], [0.30, 0.60], [0.15, 0.06], [0.3127, 0.3290]];
        for (rgb, [x, y]) in [DVec3::X, DVec3::Y, DVec3::Z, DVec3::ONE].into_iter().zip(chromaticities) {
            let xyz = rgb_to_xyz(rgb);
            let sum = xyz.element_sum();
            assert!((xyz.x / sum - x).abs() < 5e-5 && (xyz.y / sum - y).abs() < 5e-5, "{rgb}: {xyz}");
            assert!((luminance(rgb) - xyz.y).abs() < 1e-12);
        }
    }

    #[test]
    fn colours_are_brought_into_the_gamut_with_their_luminance() {
        let outside = DVec3::new(4.0, 0.2, -0.1);
        let inside = into_gamut(outside);
        assert!(inside.min_element() >= 0.0 && (luminance(inside) - luminance(outside)).abs() < 1e-12);
        assert_eq!(into_gamut(DVec3::new(1.0, -1.0, 0.0)), DVec3::ZERO);
        let common = DVec3::new(0.2, 0.5, 0.1);
        assert!((into_gamut(common) - common).abs().max_element() < 1e-15);
    }
}
