//! Light of a black body: Planck's law, and its colour.
//!
//!   B(λ, T) = 2 h c² / λ⁵ / (exp(h c / (λ k T)) − 1)
//!
//! in vacuum, with the exact constants of the SI since 2019 (CODATA 2018).

use glam::DVec3;

use crate::cie;

/// h, J s.
const PLANCK: f64 = 6.626_070_15e-34;
/// c, m/s.
const SPEED_OF_LIGHT: f64 = 299_792_458.0;
/// k, J/K.
const BOLTZMANN: f64 = 1.380_649e-23;

/// Spectral radiance of a black body, W/(m² sr nm); 0 at and below 0 K.
pub fn radiance(wavelength_nm: f64, kelvin: f64) -> f64 {
    if !(kelvin > 0.0 && wavelength_nm > 0.0) {
        return 0.0;
    }
    let wavelength = wavelength_nm * 1e-9;
    let exponent = PLANCK * SPEED_OF_LIGHT / (wavelength * BOLTZMANN * kelvin);
    let per_metre = 2.0 * PLANCK * SPEED_OF_LIGHT.powi(2) / wavelength.powi(5) / libm::expm1(exponent);
    per_metre * 1e-9
}

/// b of Wien's law λ T = b for the wavelength at which [`radiance`] is greatest, m K (CODATA 2018).
const WIEN: f64 = 2.897_771_955e-3;

/// The greatest spectral radiance of a black body over all wavelengths, W/(m² sr nm); it grows as T⁵.
pub fn greatest_radiance(kelvin: f64) -> f64 {
    radiance(WIEN / kelvin * 1e9, kelvin)
}

/// Luminance Y of a black body in the unit of [`cie::xyz`]; times [`cie::LUMINANCE_OF_Y`] it is in cd/m².
pub fn luminance(kelvin: f64) -> f64 {
    cie::xyz(|nm| radiance(nm, kelvin)).y
}

/// Colour of a black body in linear Rec. 709, in the unit of [`cie::xyz`]. Below about 1900 K its blue is negative: the
/// colour is more saturated than the primaries.
pub fn rgb(kelvin: f64) -> DVec3 {
    cie::xyz_to_rgb(cie::xyz(|nm| radiance(nm, kelvin)))
}

/// [`rgb`] within the gamut ([`cie::into_gamut`]), from a table over temperature.
///
/// From 200 to 50,000 K the table's steps are 0.1 % and it is linear in between, which is right to 1e-4 where it is
/// worst (below 1000 K) and to 2e-5 above 2000 K. Darker ones are black; hotter ones are computed.
#[derive(Debug, Clone, PartialEq)]
pub struct BlackbodyColours {
    colours: Vec<DVec3>,
}

const COLDEST: f64 = 200.0;
const HOTTEST: f64 = 50_000.0;
const STEP: f64 = 1e-3;

impl BlackbodyColours {
    /// Computes the table.
    pub fn new() -> BlackbodyColours {
        let steps = (libm::log(HOTTEST / COLDEST) / STEP).ceil() as usize;
        let colour = |step: usize| cie::into_gamut(rgb(COLDEST * libm::exp(STEP * step as f64)));
        BlackbodyColours { colours: (0..=steps).map(colour).collect() }
    }

    /// The colour at a temperature in kelvin.
    pub fn at(&self, kelvin: f64) -> DVec3 {
        if kelvin.is_nan() || kelvin < COLDEST {
            return DVec3::ZERO;
        }
        let place = libm::log(kelvin / COLDEST) / STEP;
        let index = place as usize;
        let Some(&[low, high]) = self.colours.get(index..).and_then(|rest| rest.first_chunk()) else {
            return cie::into_gamut(rgb(kelvin));
        };
        let [from, to] = [index, index + 1].map(|step| COLDEST * libm::exp(STEP * step as f64));
        low + (high - low) * ((kelvin - from) / (to - from))
    }
}

impl Default for BlackbodyColours {
    fn default() -> Self {
        Self::new()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_integral_over_wavelength_is_the_law_of_stefan_and_boltzmann() {
        // σ T⁴/π; steps of 1 nm from 0.1 to 100 μm hold all but 1e-4 of it at 2000 K.
        let total: f64 = (100..100_000).map(|nm| radiance(f64::from(nm), 2000.0)).sum();
        let expected = 5.670_374_419e-8 * 2000.0_f64.powi(4) / std::f64::consts::PI;
        assert!((total / expected - 1.0).abs() < 1e-4, "{total} {expected}");
    }

    #[test]
    fn the_greatest_radiance_is_that_of_the_best_wavelength() {
        for kelvin in [300.0, 1500.0, 6500.0] {
            let best = (1..300_000).map(|step| radiance(0.1 * f64::from(step), kelvin)).fold(0.0, f64::max);
            assert!((greatest_radiance(kelvin) / best - 1.0).abs() < 1e-6, "{kelvin}");
        }
        let ratio = greatest_radiance(4000.0) / greatest_radiance(2000.0);
        assert!((ratio / 32.0 - 1.0).abs() < 1e-12, "{ratio}");
        assert_eq!(greatest_radiance(0.0), 0.0);
    }

    #[test]
    fn odd_temperatures_are_black() {
        for kelvin in [0.0, -5.0, f64::NAN, f64::NEG_INFINITY, 1e-300] {
            assert_eq!(radiance(500.0, kelvin), 0.0);
            assert_eq!(BlackbodyColours::new().at(kelvin), DVec3::ZERO);
        }
    }

    #[test]
    fn the_table_of_colours_follows_the_sum() {
        let table = BlackbodyColours::new();
        for step in 0..60 {
            let kelvin = 210.0 * 1.1_f64.powi(step) + 0.37;
            let (tabled, summed) = (table.at(kelvin), cie::into_gamut(rgb(kelvin)));
            assert!((tabled - summed).abs().max_element() <= 1.5e-3 * summed.max_element(), "{kelvin}");
            let bound = if kelvin > 900.0 { 1.5e-4 } else { 1.5e-3 };
            assert!((tabled - summed).abs().max_element() <= bound * summed.max_element(), "{kelvin}");
        }
    }
}
