//! Coefficients of a medium of many particles: μs = N Csca, μa = N Cabs for N particles in a volume.
//!
//! That particles are far apart and scatter independently is assumed, which holds to a few percent of the volume.

use super::{MieAverage, MieCache, MieError, SizeDistribution};
use crate::refractive_index::Substance;

/// Particles of one substance.
#[derive(Debug, Clone, PartialEq)]
pub struct Particles {
    /// What they are made of; the refractive index is relative to the medium around.
    pub substance: Substance,
    /// How large they are.
    pub distribution: SizeDistribution,
    /// How many there are.
    pub amount: Amount,
}

/// How many particles there are.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Amount {
    /// Particles in a cm³.
    NumberDensity(f64),
    /// Their mass in a m³, g; of water droplets, the liquid water content.
    Mass {
        /// g/m³.
        concentration: f64,
        /// Mass of a volume of the substance, g/cm³.
        density: f64,
    },
    /// The fraction of the volume that they fill.
    VolumeFraction(f64),
}

/// What particles do to light of one wavelength.
#[derive(Debug, Clone, PartialEq)]
pub struct ParticleOptics {
    /// Scattering coefficient, 1/m.
    pub mu_s: f64,
    /// Absorption coefficient, 1/m.
    pub mu_a: f64,
    /// The mean particle.
    pub average: MieAverage,
}

impl Particles {
    /// Coefficients and phase function in light of `wavelength` nm.
    pub fn at(&self, wavelength: f64, cache: &MieCache) -> Result<ParticleOptics, MieError> {
        let m = self.substance.refractive_index(wavelength)?;
        let average = cache.average(m, wavelength, &self.distribution)?;
        // µm² of cross section for each m³ of space, in m⁻¹.
        let coefficient = |q: f64| self.amount.per_cubic_metre(average.volume) * q * average.area * 1e-12;
        Ok(ParticleOptics { mu_s: coefficient(average.q_sca), mu_a: coefficient(average.q_abs), average })
    }
}

impl Amount {
    /// Number of particles in a m³, if their mean volume is `volume` µm³.
    pub fn per_cubic_metre(self, volume: f64) -> f64 {
        match self {
            Self::NumberDensity(per_cubic_centimetre) => per_cubic_centimetre * 1e6,
            Self::Mass { concentration, density } => concentration / (density * 1e6) / (volume * 1e-18),
            Self::VolumeFraction(fraction) => fraction / (volume * 1e-18),
        }
    }
}
