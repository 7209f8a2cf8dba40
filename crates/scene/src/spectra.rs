//! A medium by wavelength, and the three channels it has in an RGB picture.
//!
//! μt = μa + μs and albedo = μs/μt hold at each wavelength. In RGB they hold in each channel: the channels of sums and
//! quotients are the sums and quotients of the channels.

use glam::DVec3;
use tyndall_optics::{PhaseFunction, SpectralPhase, Spectrum};

/// What a medium does to light where its density is 1, by wavelength.
#[derive(Debug, Clone, PartialEq)]
pub struct MediumSpectra {
    /// Extinction and albedo, 1/scene unit.
    pub coefficients: SpectralCoefficients,
    /// Emitted radiance Le; the source term is μa·Le.
    pub emission: Spectrum,
    /// Radiance added per length, independent of absorption.
    pub emission_per_length: Spectrum,
    /// The phase functions.
    pub phase: MediumPhase,
}

/// Coefficients in the form in which they were given.
#[derive(Debug, Clone, PartialEq)]
pub enum SpectralCoefficients {
    /// μt and μs/μt.
    ExtinctionAndAlbedo {
        /// Extinction coefficient, 1/scene unit.
        mu_t: Spectrum,
        /// Single-scattering albedo, 0…1.
        albedo: Spectrum,
    },
    /// μa and μs.
    AbsorptionAndScattering {
        /// Absorption coefficient, 1/scene unit.
        mu_a: Spectrum,
        /// Scattering coefficient, 1/scene unit.
        mu_s: Spectrum,
    },
}

impl SpectralCoefficients {
    /// Extinction coefficient at a wavelength in nm, 1/scene unit.
    pub fn mu_t(&self, wavelength_nm: f64) -> f64 {
        match self {
            Self::ExtinctionAndAlbedo { mu_t, .. } => mu_t.at(wavelength_nm),
            Self::AbsorptionAndScattering { mu_a, mu_s } => mu_a.at(wavelength_nm) + mu_s.at(wavelength_nm),
        }
    }

    /// Single-scattering albedo at a wavelength in nm; 0 where there is no extinction.
    pub fn albedo(&self, wavelength_nm: f64) -> f64 {
        match self {
            Self::ExtinctionAndAlbedo { albedo, .. } => albedo.at(wavelength_nm).min(1.0),
            Self::AbsorptionAndScattering { mu_a, mu_s } => {
                let (mu_a, mu_s) = (mu_a.at(wavelength_nm), mu_s.at(wavelength_nm));
                if mu_s > 0.0 { mu_s / (mu_a + mu_s) } else { 0.0 }
            }
        }
    }

    /// Extinction coefficient of red, green and blue.
    pub fn mu_t_rgb(&self) -> DVec3 {
        match self {
            Self::ExtinctionAndAlbedo { mu_t, .. } => mu_t.rgb(),
            Self::AbsorptionAndScattering { mu_a, mu_s } => mu_a.rgb() + mu_s.rgb(),
        }
    }

    /// Single-scattering albedo of red, green and blue.
    pub fn albedo_rgb(&self) -> DVec3 {
        match self {
            Self::ExtinctionAndAlbedo { albedo, .. } => albedo.rgb().min(DVec3::ONE),
            Self::AbsorptionAndScattering { mu_a, mu_s } => {
                let (mu_a, mu_s) = (mu_a.rgb(), mu_s.rgb());
                let albedo = |i: usize| if mu_s[i] > 0.0 { mu_s[i] / (mu_a[i] + mu_s[i]) } else { 0.0 };
                DVec3::new(albedo(0), albedo(1), albedo(2))
            }
        }
    }

    /// The coefficients times a factor; the albedo stays.
    pub fn scaled(self, factor: f64) -> Self {
        if factor == 1.0 {
            return self;
        }
        match self {
            Self::ExtinctionAndAlbedo { mu_t, albedo } => {
                Self::ExtinctionAndAlbedo { mu_t: mu_t.scaled(factor), albedo }
            }
            Self::AbsorptionAndScattering { mu_a, mu_s } => {
                Self::AbsorptionAndScattering { mu_a: mu_a.scaled(factor), mu_s: mu_s.scaled(factor) }
            }
        }
    }
}

/// Phase functions by wavelength.
#[derive(Debug, Clone, PartialEq)]
pub enum MediumPhase {
    /// Given for some wavelengths, or one for all.
    ByWavelength(SpectralPhase),
    /// Henyey and Greenstein's, with a mean cosine for each wavelength.
    HenyeyGreenstein(Spectrum),
}

/// Wavelengths, in nm, that have the hues of the primaries red, green and blue of Rec. 709.
pub(crate) const PRIMARIES_NM: [f64; 3] = [611.4, 549.1, 464.3];

impl MediumPhase {
    /// The phase function at a wavelength in nm.
    pub fn at(&self, wavelength_nm: f64) -> PhaseFunction {
        match self {
            Self::ByWavelength(phase) => phase.at(wavelength_nm),
            Self::HenyeyGreenstein(g) => PhaseFunction::HenyeyGreenstein { g: g.at(wavelength_nm) },
        }
    }

    /// Whether it is the same at all wavelengths.
    pub fn is_grey(&self) -> bool {
        match self {
            Self::ByWavelength(phase) => phase.is_grey(),
            Self::HenyeyGreenstein(g) => g.is_grey(),
        }
    }

    /// The phase functions of red, green and blue, if they differ: of those given by wavelength the ones at the hues of the
    /// primaries.
    pub fn rgb(&self) -> Option<[PhaseFunction; 3]> {
        if self.is_grey() {
            return None;
        }
        Some(match self {
            Self::ByWavelength(phase) => PRIMARIES_NM.map(|nm| phase.at(nm)),
            Self::HenyeyGreenstein(g) => g.rgb().to_array().map(|g| PhaseFunction::HenyeyGreenstein { g }),
        })
    }
}
