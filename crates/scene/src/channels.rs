//! The channels that one light path carries, and what a medium is in each of them.
//!
//! A path in a chromatic medium carries up to four quantities at once, which see different extinctions: red, green and
//! blue, or radiance at some wavelengths. They are kept in the lanes of a [`DVec4`]; lanes beyond
//! [`count`](Channels::count) are 0.

use std::borrow::Cow;

use glam::{DVec3, DVec4};
use tyndall_optics::{PhaseFunction, Spectrum, planck, uplift};

use crate::description::{ColourMode, FilmOutput};
use crate::{Medium, SceneDescription, Volume};

/// What the channels of a path are.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Channels {
    /// Linear red, green and blue (Rec. 709).
    Rgb,
    /// Four wavelengths, nm.
    Wavelengths([f64; 4]),
}

impl Channels {
    /// How many channels there are, at most 4.
    pub fn count(&self) -> usize {
        match self {
            Self::Rgb => 3,
            Self::Wavelengths(_) => 4,
        }
    }

    /// 1 in every channel.
    pub fn ones(&self) -> DVec4 {
        match self {
            Self::Rgb => DVec3::ONE.extend(0.0),
            Self::Wavelengths(_) => DVec4::ONE,
        }
    }
}

/// What the three channels of a picture are.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub enum Observer {
    /// Linear red, green and blue (Rec. 709), and light is taken to be made of these three.
    #[default]
    Rgb,
    /// Linear red, green and blue of light of all wavelengths, as the CIE 1931 standard observer sees it.
    SpectralRgb,
    /// The same light as CIE XYZ.
    SpectralXyz,
    /// Radiance at three wavelengths, nm.
    Bands([f64; 3]),
}

/// The observers whose films make the picture of a scene: at least one, and one for each three bands. Where bands do not
/// fill the last three, the last of them is repeated.
pub fn observers(description: &SceneDescription) -> Vec<Observer> {
    let bands = description.film.bands.as_deref().unwrap_or_default();
    match (description.render.mode, description.film.output) {
        (ColourMode::Rgb, _) => vec![Observer::Rgb],
        (ColourMode::Spectral, _) if !bands.is_empty() => {
            let three = |bands: &[f64]| Observer::Bands([0, 1, 2].map(|i| bands[i.min(bands.len() - 1)]));
            bands.chunks(3).map(three).collect()
        }
        (ColourMode::Spectral, FilmOutput::Rgb) => vec![Observer::SpectralRgb],
        (ColourMode::Spectral, FilmOutput::Xyz) => vec![Observer::SpectralXyz],
    }
}

/// What a medium does to light where its density is 1, in each channel of a path.
#[derive(Debug, Clone, PartialEq)]
pub struct ChannelMedium<'a> {
    /// Extinction coefficient μt, 1/scene unit.
    pub mu_t: DVec4,
    /// Single-scattering albedo μs/μt, 0…1.
    pub albedo: DVec4,
    /// Emitted radiance Le.
    pub emission: DVec4,
    /// Radiance added per length, 1/scene unit.
    pub emission_per_length: DVec4,
    /// The phase functions.
    pub phases: ChannelPhases<'a>,
}

/// The phase function of each channel.
#[derive(Debug, Clone, PartialEq)]
pub enum ChannelPhases<'a> {
    /// One for all channels.
    Same(&'a PhaseFunction),
    /// One for each.
    Each([Cow<'a, PhaseFunction>; 4]),
}

impl ChannelMedium<'_> {
    /// Extinction coefficients for light that travels along the unit vector `direction`, or against it.
    pub fn mu_t_along(&self, direction: DVec3) -> DVec4 {
        match &self.phases {
            ChannelPhases::Same(phase) => self.mu_t * phase.projected_area(direction),
            ChannelPhases::Each(phases) => {
                let areas = phases.each_ref().map(|phase| phase.projected_area(direction));
                self.mu_t * DVec4::from_array(areas)
            }
        }
    }
}

impl ChannelPhases<'_> {
    /// The phase function of a channel.
    pub fn of(&self, channel: usize) -> &PhaseFunction {
        match self {
            Self::Same(phase_function) => phase_function,
            Self::Each(phase_functions) => &phase_functions[channel],
        }
    }

    /// Value in 1/sr of every channel's phase function for light that turns from `before` to `after`.
    pub fn values(&self, before: DVec3, after: DVec3) -> DVec4 {
        match self {
            Self::Same(phase_function) => DVec4::splat(phase_function.value(before, after)),
            Self::Each(phase_functions) => {
                DVec4::from_array(phase_functions.each_ref().map(|phase| phase.value(before, after)))
            }
        }
    }
}

impl Medium {
    /// What the medium is in each of `channels`.
    pub fn in_channels(&self, channels: &Channels) -> ChannelMedium<'_> {
        match channels {
            Channels::Rgb => self.in_rgb(),
            Channels::Wavelengths(wavelengths_nm) => self.at_wavelengths(*wavelengths_nm),
        }
    }

    fn in_rgb(&self) -> ChannelMedium<'_> {
        let chromatic = self.chromatic.as_deref();
        let mu_t = chromatic.map_or(DVec3::splat(self.mu_t), |chromatic| chromatic.mu_t);
        let phases = self.phases(|phase_functions| [0, 1, 2, 2].map(|colour| &phase_functions[colour]));
        ChannelMedium {
            mu_t: mu_t.extend(0.0),
            albedo: self.albedo.extend(0.0),
            emission: self.emission.extend(0.0),
            emission_per_length: self.emission_per_length.extend(0.0),
            phases,
        }
    }

    /// Where only colours are known, they become spectra that have them.
    fn at_wavelengths(&self, wavelengths_nm: [f64; 4]) -> ChannelMedium<'_> {
        let each = |value: &dyn Fn(f64) -> f64| DVec4::from_array(wavelengths_nm.map(value));
        if let Some(spectra) = self.spectra.as_deref() {
            let phases = if spectra.phase.is_grey() {
                ChannelPhases::Same(&self.phase_function)
            } else {
                ChannelPhases::Each(wavelengths_nm.map(|nm| Cow::Owned(spectra.phase.at(nm))))
            };
            return ChannelMedium {
                mu_t: each(&|nm| spectra.coefficients.mu_t(nm)),
                albedo: each(&|nm| spectra.coefficients.albedo(nm)),
                emission: each(&|nm| spectra.emission.at(nm)),
                emission_per_length: each(&|nm| spectra.emission_per_length.at(nm)),
                phases,
            };
        }
        let at = |spectrum: &Spectrum| each(&|nm| spectrum.at(nm));
        let phases = self.phases(|phase_functions| {
            wavelengths_nm.map(|nm| &phase_functions[uplift::basis(nm).max_position()])
        });
        let mu_t = match self.chromatic.as_deref() {
            Some(chromatic) => at(&Spectrum::Rgb(chromatic.mu_t)),
            None => DVec4::splat(self.mu_t),
        };
        ChannelMedium {
            mu_t,
            albedo: at(&Spectrum::Rgb(self.albedo)),
            emission: at(&Spectrum::RgbLight(self.emission)),
            emission_per_length: at(&Spectrum::RgbLight(self.emission_per_length)),
            phases,
        }
    }

    /// The phase functions of the channels, of which `choose` takes one for each if they differ.
    fn phases<'a>(
        &'a self,
        choose: impl Fn(&'a [PhaseFunction; 3]) -> [&'a PhaseFunction; 4],
    ) -> ChannelPhases<'a> {
        let chromatic = self.chromatic.as_deref();
        match chromatic.and_then(|chromatic| chromatic.phase_functions.as_ref()) {
            Some(phase_functions) => ChannelPhases::Each(choose(phase_functions).map(Cow::Borrowed)),
            None => ChannelPhases::Same(&self.phase_function),
        }
    }
}

impl Volume {
    /// Albedo and emitted radiance Le at a place, in channels in which the volume's medium is `medium`.
    pub fn colours_at(&self, position: DVec3, medium: &ChannelMedium, channels: &Channels) -> (DVec4, DVec4) {
        let Some(fields) = &self.fields else { return (medium.albedo, medium.emission) };
        let factor = self.albedo_factor(position);
        let kelvin =
            fields.temperature.as_ref().map(|temperature| (temperature, temperature.kelvin(position)));
        let (factor, glow) = match channels {
            Channels::Rgb => {
                let glow =
                    kelvin.map(|(field, kelvin)| field.colours.at(kelvin) * field.radiance_factor(kelvin));
                (factor.extend(0.0), glow.unwrap_or_default().extend(0.0))
            }
            Channels::Wavelengths(wavelengths_nm) => {
                let glow = |nm| {
                    kelvin.map_or(0.0, |(field, kelvin)| {
                        planck::radiance(nm, kelvin) * field.radiance_factor(kelvin)
                    })
                };
                let factor = Spectrum::Rgb(factor);
                (
                    DVec4::from_array(wavelengths_nm.map(|nm| factor.at(nm))),
                    DVec4::from_array(wavelengths_nm.map(glow)),
                )
            }
        };
        (medium.albedo * factor, (medium.emission + glow) * self.emission_factor(position))
    }
}
