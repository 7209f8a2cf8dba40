//! The channels that one light path carries, and what a medium is in each of them.
//!
//! A path in a chromatic medium carries up to four quantities at once, which see different extinctions: red, green and
//! blue, or radiance at some wavelengths. They are kept in the lanes of a [`DVec4`]; lanes beyond
//! [`count`](Channels::count) are 0.

use std::borrow::Cow;

use glam::{DVec3, DVec4};
use tyndall_optics::{PhaseFunction, Spectrum, uplift};

use crate::Medium;

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

/// What a medium does to light where its density is 1, in each channel of a path.
#[derive(Debug, Clone, PartialEq)]
pub struct ChannelMedium<'a> {
    /// Extinction coefficient μt, 1/scene unit.
    pub mu_t: DVec4,
    /// Single-scattering albedo μs/μt, 0…1.
    pub albedo: DVec4,
    /// Emitted radiance Le.
    pub emission: DVec4,
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
            phases,
        }
    }

    /// Colours become spectra that have them.
    fn at_wavelengths(&self, wavelengths_nm: [f64; 4]) -> ChannelMedium<'_> {
        let at = |spectrum: &Spectrum| DVec4::from_array(wavelengths_nm.map(|nm| spectrum.at(nm)));
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
