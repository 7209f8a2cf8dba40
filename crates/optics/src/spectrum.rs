//! Spectra: a quantity for each wavelength, and the three channels it has in an RGB picture.
//!
//! A spectrum is either a *coefficient* (a number that multiplies light: an albedo, an absorption coefficient) or
//! *light* (a radiance, an irradiance, an intensity). Their RGB differ:
//! - of a coefficient it is the colour of white light that was multiplied by it, RGB(∫ c W (x̄, ȳ, z̄) dλ), with the
//!   white W of [`cie::white`]: a constant c has RGB (c, c, c);
//! - of light it is its own colour, RGB(∫ L (x̄, ȳ, z̄) dλ).
//!
//! Channels below 0, of colours outside the gamut of Rec. 709, count as 0: of a coefficient just so, of light by
//! [`cie::into_gamut`], which keeps the luminance. Spectra of light are in W/(m² sr nm) or whatever unit the scene
//! uses, such that 1 at all wavelengths has luminance 1 (see [`cie::xyz`]).

use glam::DVec3;

use crate::cie;
use crate::planck;
use crate::uplift;

/// A quantity for each wavelength.
#[derive(Debug, Clone, PartialEq)]
pub enum Spectrum {
    /// The same at all wavelengths.
    Constant(f64),
    /// A coefficient of which three channels are known: Σ cᵢ Bᵢ(λ) with the basis of [`uplift`].
    Rgb(DVec3),
    /// Light of which three channels are known: W(λ) Σ cᵢ Bᵢ(λ), W being the white of [`cie::white`].
    RgbLight(DVec3),
    /// Linear between the wavelengths given; constant beyond the first and the last. Made by [`Spectrum::sampled`].
    Sampled {
        /// In nm, increasing.
        wavelengths_nm: Vec<f64>,
        /// As many values.
        values: Vec<f64>,
    },
    /// scale · B(λ, T), with Planck's B in W/(m² sr nm).
    Blackbody {
        /// T in kelvin.
        kelvin: f64,
        /// Factor on the radiance.
        scale: f64,
    },
    /// value · (λ / at_nm)^exponent; molecules scatter with the exponent −4.
    PowerLaw {
        /// Where the value holds, nm.
        at_nm: f64,
        /// The value there.
        value: f64,
        /// Power of the wavelength.
        exponent: f64,
    },
}

/// Why a list of samples is no spectrum.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum SpectrumError {
    /// There are no samples.
    Empty,
    /// The numbers of wavelengths and of values differ.
    Lengths(usize, usize),
    /// A wavelength is not above 0 and above the one before it; its place.
    Order(usize),
    /// A value is not finite; its place.
    NotFinite(usize),
}

impl std::fmt::Display for SpectrumError {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Empty => write!(f, "has no samples: give at least one wavelength and its value"),
            Self::Lengths(wavelengths, values) => {
                write!(f, "has {wavelengths} wavelengths but {values} values: give one value for each")
            }
            Self::Order(index) => {
                write!(
                    f,
                    "is out of order: wavelength number {} must be above 0 and above the one before it",
                    index + 1
                )
            }
            Self::NotFinite(index) => write!(f, "has an odd value: number {} must be finite", index + 1),
        }
    }
}

impl std::error::Error for SpectrumError {}

impl Spectrum {
    /// Linear between `values` at `wavelengths_nm`.
    pub fn sampled(wavelengths_nm: Vec<f64>, values: Vec<f64>) -> Result<Spectrum, SpectrumError> {
        if wavelengths_nm.is_empty() && values.is_empty() {
            return Err(SpectrumError::Empty);
        }
        if wavelengths_nm.len() != values.len() {
            return Err(SpectrumError::Lengths(wavelengths_nm.len(), values.len()));
        }
        let mut before = 0.0;
        for (index, &nm) in wavelengths_nm.iter().enumerate() {
            if !(nm > before && nm.is_finite()) {
                return Err(SpectrumError::Order(index));
            }
            before = nm;
        }
        if let Some(index) = values.iter().position(|value| !value.is_finite()) {
            return Err(SpectrumError::NotFinite(index));
        }
        Ok(Spectrum::Sampled { wavelengths_nm, values })
    }

    /// A black body's light, of the given luminance Y.
    pub fn blackbody_of_luminance(kelvin: f64, luminance: f64) -> Spectrum {
        let of_one = planck::luminance(kelvin);
        let scale = if of_one > 0.0 { luminance / of_one } else { 0.0 };
        Spectrum::Blackbody { kelvin, scale }
    }

    /// The value at a wavelength in nm.
    pub fn at(&self, wavelength_nm: f64) -> f64 {
        match self {
            Self::Constant(value) => *value,
            Self::Rgb(channels) => channels.dot(uplift::basis(wavelength_nm)),
            Self::RgbLight(channels) => {
                cie::white(wavelength_nm) * channels.dot(uplift::basis(wavelength_nm))
            }
            Self::Sampled { wavelengths_nm, values } => interpolate(wavelengths_nm, values, wavelength_nm),
            Self::Blackbody { kelvin, scale } => scale * planck::radiance(wavelength_nm, *kelvin),
            Self::PowerLaw { at_nm, value, exponent } => value * libm::pow(wavelength_nm / at_nm, *exponent),
        }
    }

    /// Red, green and blue of a coefficient; none is below 0 unless the spectrum is.
    pub fn rgb(&self) -> DVec3 {
        match self {
            Self::Constant(value) => DVec3::splat(*value),
            Self::Rgb(channels) => *channels,
            _ => cie::xyz_to_rgb(cie::xyz(|nm| cie::white(nm) * self.at(nm))).max(DVec3::ZERO),
        }
    }

    /// Red, green and blue of light; none is below 0.
    pub fn light_rgb(&self) -> DVec3 {
        match self {
            Self::RgbLight(channels) => *channels,
            _ => cie::into_gamut(cie::xyz_to_rgb(cie::xyz(|nm| self.at(nm)))),
        }
    }

    /// Whether a coefficient is the same at all wavelengths by its form.
    pub fn is_grey(&self) -> bool {
        match self {
            Self::Constant(_) => true,
            Self::Rgb(channels) => channels.max_element() == channels.min_element(),
            Self::Sampled { values, .. } => values.iter().all(|value| *value == values[0]),
            Self::PowerLaw { value, exponent, .. } => *value == 0.0 || *exponent == 0.0,
            Self::RgbLight(channels) => *channels == DVec3::ZERO,
            Self::Blackbody { scale, .. } => *scale == 0.0,
        }
    }

    /// Whether every value is 0 by the spectrum's form.
    pub fn is_zero(&self) -> bool {
        self.is_grey() && self.at(550.0) == 0.0
    }

    /// Every value finite and at least 0 between 360 and 830 nm.
    pub fn is_sound(&self) -> bool {
        let sound = |value: f64| value.is_finite() && value >= 0.0;
        match self {
            Self::Sampled { values, .. } => values.iter().all(|value| sound(*value)),
            // The others are monotonic, a mixture, or have one sign.
            _ => [360.0, 595.0, 830.0].into_iter().all(|nm| sound(self.at(nm))) && sound_channels(self),
        }
    }

    /// The spectrum of `f` of the values. Constants, channels and samples keep their form, and others become samples
    /// every 5 nm from 360 to 830 nm.
    pub fn map(&self, f: impl Fn(f64) -> f64) -> Spectrum {
        match self {
            Self::Constant(value) => Self::Constant(f(*value)),
            Self::Rgb(channels) => Self::Rgb(channels.map(f)),
            Self::Sampled { wavelengths_nm, values } => Self::Sampled {
                wavelengths_nm: wavelengths_nm.clone(),
                values: values.iter().map(|value| f(*value)).collect(),
            },
            _ => {
                let wavelengths_nm: Vec<f64> = (72..=166).map(|step| 5.0 * f64::from(step)).collect();
                let values = wavelengths_nm.iter().map(|nm| f(self.at(*nm))).collect();
                Self::Sampled { wavelengths_nm, values }
            }
        }
    }

    /// The spectrum times a factor, in its own form.
    pub fn scaled(&self, factor: f64) -> Spectrum {
        match self {
            Self::RgbLight(channels) => Self::RgbLight(*channels * factor),
            Self::Blackbody { kelvin, scale } => Self::Blackbody { kelvin: *kelvin, scale: scale * factor },
            Self::PowerLaw { at_nm, value, exponent } => {
                Self::PowerLaw { at_nm: *at_nm, value: value * factor, exponent: *exponent }
            }
            _ => self.map(|value| value * factor),
        }
    }
}

fn sound_channels(spectrum: &Spectrum) -> bool {
    match spectrum {
        Spectrum::Rgb(channels) | Spectrum::RgbLight(channels) => {
            channels.is_finite() && channels.min_element() >= 0.0
        }
        _ => true,
    }
}

fn interpolate(wavelengths_nm: &[f64], values: &[f64], wavelength_nm: f64) -> f64 {
    let after = wavelengths_nm.partition_point(|nm| *nm <= wavelength_nm);
    match after {
        0 => values[0],
        _ if after == values.len() => values[after - 1],
        _ => {
            let (from, to) = (wavelengths_nm[after - 1], wavelengths_nm[after]);
            let within = (wavelength_nm - from) / (to - from);
            values[after - 1] + (values[after] - values[after - 1]) * within
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn channels_come_back_from_their_spectra() {
        for channels in [DVec3::ONE, DVec3::new(0.9, 0.1, 0.4), DVec3::new(0.0, 30.0, 2.0), DVec3::X] {
            // Through the wavelengths, not through the stored channels.
            let coefficient = Spectrum::Rgb(channels);
            let samples: Vec<f64> = (360..=830).map(|nm| coefficient.at(f64::from(nm))).collect();
            let wavelengths: Vec<f64> = (360..=830).map(f64::from).collect();
            let sampled = Spectrum::sampled(wavelengths.clone(), samples).unwrap();
            assert!((sampled.rgb() - channels).abs().max_element() < 1e-6, "{channels}");

            let light = Spectrum::RgbLight(channels);
            let samples = (360..=830).map(|nm| light.at(f64::from(nm))).collect();
            let sampled = Spectrum::sampled(wavelengths, samples).unwrap();
            assert!((sampled.light_rgb() - channels).abs().max_element() < 1e-6, "{channels}");
        }
    }

    #[test]
    fn grey_is_grey_and_albedos_stay_albedos() {
        for nm in (300..900).map(f64::from) {
            assert!((Spectrum::Rgb(DVec3::splat(0.3)).at(nm) - 0.3).abs() < 1e-15);
            let albedo = Spectrum::Rgb(DVec3::new(1.0, 0.0, 1.0)).at(nm);
            assert!((0.0..=1.0 + 1e-15).contains(&albedo), "{nm}: {albedo}");
        }
    }

    #[test]
    fn samples_are_joined_by_lines_and_hold_at_the_ends() {
        let spectrum = Spectrum::sampled(vec![400.0, 500.0, 700.0], vec![1.0, 3.0, 0.0]).unwrap();
        for (nm, value) in
            [(300.0, 1.0), (400.0, 1.0), (450.0, 2.0), (500.0, 3.0), (600.0, 1.5), (700.0, 0.0), (900.0, 0.0)]
        {
            assert_eq!(spectrum.at(nm), value, "{nm}");
        }
        assert_eq!(spectrum.scaled(2.0).at(450.0), 4.0);
    }

    #[test]
    fn lists_that_are_no_spectra_are_refused() {
        let refused =
            |nm: &[f64], values: &[f64]| Spectrum::sampled(nm.to_vec(), values.to_vec()).unwrap_err();
        assert_eq!(refused(&[], &[]), SpectrumError::Empty);
        assert_eq!(refused(&[1.0], &[]), SpectrumError::Lengths(1, 0));
        assert_eq!(refused(&[500.0, 400.0], &[1.0, 1.0]), SpectrumError::Order(1));
        assert_eq!(refused(&[0.0], &[1.0]), SpectrumError::Order(0));
        assert_eq!(refused(&[f64::NAN], &[1.0]), SpectrumError::Order(0));
        assert_eq!(refused(&[400.0], &[f64::INFINITY]), SpectrumError::NotFinite(0));
    }

    #[test]
    fn molecules_scatter_blue_the_most() {
        let rayleigh = Spectrum::PowerLaw { at_nm: 550.0, value: 2.0, exponent: -4.0 };
        assert!((rayleigh.at(275.0) - 32.0).abs() < 1e-12 && rayleigh.at(550.0) == 2.0);
        let rgb = rayleigh.rgb();
        assert!(rgb.x < rgb.y && rgb.y < rgb.z, "{rgb}");
        assert!(rayleigh.is_sound() && !rayleigh.is_grey());
        let steep = Spectrum::PowerLaw { at_nm: 1e-300, value: 1.0, exponent: 300.0 };
        assert!(!steep.is_sound());
    }

    #[test]
    fn a_black_body_has_the_luminance_asked_for() {
        for kelvin in [1000.0, 3000.0, 6500.0, 20_000.0] {
            let light = Spectrum::blackbody_of_luminance(kelvin, 3.0);
            assert!((cie::luminance(light.light_rgb()) - 3.0).abs() < 1e-9);
        }
        assert!(Spectrum::blackbody_of_luminance(1.0, 3.0).is_zero());
    }
}
