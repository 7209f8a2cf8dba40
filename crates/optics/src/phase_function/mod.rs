//! Phase functions f_p(ω, ω′): the density, per unit solid angle, of the direction after a scattering event.
//!
//! Directions are those in which light travels, before and after: cos θ = +1 is forward, g > 0 is forward. Each phase
//! function integrates to 1 over the sphere and is sampled exactly, so that its value is the density of its samples and
//! a sample's weight is 1. One file for each kind; all but SGGX depend on the angle θ alone.

mod draine;
mod fog;
mod henyey_greenstein;
mod mixture;
mod rayleigh;
mod schlick;
mod sggx;
mod spectral;
mod table_file;
mod tabulated;

pub use fog::{FogFit, GREATEST_FOG_DIAMETER_UM};
pub use mixture::Mixture;
pub use sggx::{Sggx, SggxKind};
pub use spectral::SpectralPhase;
pub use table_file::{PhaseTableError, parse_phase_table, read_phase_table};
pub use tabulated::{TabulatedPhase, UnsoundTable};

use glam::DVec3;
use std::f64::consts::{PI, TAU};
use std::sync::Arc;

/// A phase function.
#[derive(Debug, Clone, PartialEq)]
pub enum PhaseFunction {
    /// 1/(4π).
    Isotropic,
    /// Henyey & Greenstein 1941.
    HenyeyGreenstein {
        /// Mean cosine, in (−1, 1).
        g: f64,
    },
    /// Schlick's approximation of Henyey and Greenstein's (Blasi, Le Saëc & Schlick 1993).
    Schlick {
        /// Parameter in (−1, 1), above 0 is forward; not the mean cosine.
        k: f64,
    },
    /// Molecules, and particles far smaller than the wavelength: 3/(16π)·(1 + cos² θ), for unpolarised light.
    Rayleigh,
    /// Draine 2003; with `alpha` = 1 that of Cornette & Shanks 1992.
    Draine {
        /// Parameter in (−1, 1); the mean cosine is another.
        g: f64,
        /// Weight of cos² θ, at least 0.
        alpha: f64,
    },
    /// Oriented flakes or fibres (Heitz et al. 2015).
    Sggx(Sggx),
    /// Linear in cos θ between the rows of a table.
    Tabulated(Arc<TabulatedPhase>),
    /// One of two phase functions with fixed probabilities.
    Mixture(Arc<Mixture>),
}

impl PhaseFunction {
    /// Cornette & Shanks 1992, with parameter `g` in (−1, 1), which is not the mean cosine.
    pub fn cornette_shanks(g: f64) -> PhaseFunction {
        PhaseFunction::Draine { g, alpha: 1.0 }
    }

    /// Two Henyey-Greenstein lobes with mean cosines `g1`, which has `weight` in [0, 1], and `g2`.
    pub fn double_henyey_greenstein(g1: f64, g2: f64, weight: f64) -> PhaseFunction {
        let [first, second] = [g1, g2].map(|g| PhaseFunction::HenyeyGreenstein { g });
        PhaseFunction::mixture(weight, first, second)
    }

    /// Fog and cloud of water droplets of a diameter in µm, above 0 and up to [`GREATEST_FOG_DIAMETER_UM`]
    /// (Jendersie & d'Eon 2023).
    pub fn fog(diameter_um: f64) -> PhaseFunction {
        FogFit::new(diameter_um).phase_function()
    }

    /// `first` with the probability `weight` in [0, 1], else `second`. Neither may be SGGX, whose particles take
    /// shares of the light that change with its direction.
    pub fn mixture(weight: f64, first: PhaseFunction, second: PhaseFunction) -> PhaseFunction {
        PhaseFunction::Mixture(Arc::new(Mixture::new(weight, [first, second])))
    }

    /// Value in 1/sr for light that travels along the unit vector `before` and then along `after`, which is also the
    /// density with which [`PhaseFunction::sample`] gives that direction.
    pub fn value(&self, before: DVec3, after: DVec3) -> f64 {
        match self {
            PhaseFunction::Sggx(sggx) => sggx.value(before, after),
            _ => self.value_at_cosine(before.dot(after)),
        }
    }

    /// Value in 1/sr at cos θ; of SGGX, for light that travels along its axis.
    pub fn value_at_cosine(&self, cos_theta: f64) -> f64 {
        let cos_theta = cos_theta.clamp(-1.0, 1.0);
        match *self {
            PhaseFunction::Isotropic => 0.25 / PI,
            PhaseFunction::HenyeyGreenstein { g } => henyey_greenstein::value(g, cos_theta),
            PhaseFunction::Schlick { k } => schlick::value(k, cos_theta),
            PhaseFunction::Rayleigh => rayleigh::value(cos_theta),
            PhaseFunction::Draine { g, alpha } => draine::value(g, alpha, cos_theta),
            PhaseFunction::Sggx(ref sggx) => sggx.value_along_axis(cos_theta),
            PhaseFunction::Tabulated(ref table) => table.value(cos_theta),
            PhaseFunction::Mixture(ref mixture) => mixture.value(cos_theta),
        }
    }

    /// A direction after scattering of light that travels along the unit vector `before`, for `u` uniform in [0, 1)².
    pub fn sample(&self, before: DVec3, u: [f64; 2]) -> DVec3 {
        if let PhaseFunction::Sggx(sggx) = self {
            return sggx.sample(before, u);
        }
        let cos_theta = self.sample_cosine(u[0]);
        let sin_theta = ((1.0 - cos_theta) * (1.0 + cos_theta)).max(0.0).sqrt();
        let (sin_phi, cos_phi) = libm::sincos(TAU * u[1]);
        let (tangent, bitangent) = before.any_orthonormal_pair();
        (tangent * (sin_theta * cos_phi) + bitangent * (sin_theta * sin_phi) + before * cos_theta).normalize()
    }

    /// cos θ distributed as f_p, for `u` uniform in [0, 1); of SGGX, for light that travels along its axis. It is the
    /// inverse of the cumulative distribution, but for mixtures, where `u` also chooses the part.
    pub fn sample_cosine(&self, u: f64) -> f64 {
        let cos_theta = match *self {
            PhaseFunction::Isotropic => 2.0 * u - 1.0,
            PhaseFunction::HenyeyGreenstein { g } => henyey_greenstein::sample(g, u),
            PhaseFunction::Schlick { k } => schlick::sample(k, u),
            PhaseFunction::Rayleigh => rayleigh::sample(u),
            PhaseFunction::Draine { g, alpha } => draine::sample(g, alpha, u),
            PhaseFunction::Sggx(ref sggx) => sggx.sample_along_axis(u),
            PhaseFunction::Tabulated(ref table) => table.sample(u),
            PhaseFunction::Mixture(ref mixture) => mixture.sample(u),
        };
        cos_theta.clamp(-1.0, 1.0)
    }

    /// ∫ f_p cos θ dω; of SGGX, for light that travels along its axis.
    pub fn mean_cosine(&self) -> f64 {
        match *self {
            PhaseFunction::Isotropic | PhaseFunction::Rayleigh => 0.0,
            PhaseFunction::HenyeyGreenstein { g } => g,
            PhaseFunction::Schlick { k } => schlick::mean_cosine(k),
            PhaseFunction::Draine { g, alpha } => draine::mean_cosine(g, alpha),
            PhaseFunction::Sggx(ref sggx) => sggx.mean_cosine_along_axis(),
            PhaseFunction::Tabulated(ref table) => table.mean_cosine(),
            PhaseFunction::Mixture(ref mixture) => mixture.mean_cosine(),
        }
    }

    /// ∫ f_p cos θ dω of light that travels along the unit vector `before`.
    pub fn mean_cosine_from(&self, before: DVec3) -> f64 {
        match self {
            PhaseFunction::Sggx(sggx) => sggx.mean_cosine(before),
            _ => self.mean_cosine(),
        }
    }

    /// What the extinction of the medium is multiplied by for light that travels along the unit vector `direction`: the
    /// mean area that a particle turns to it, in 0…1. 1 but for oriented particles. It is the same forth and back.
    pub fn projected_area(&self, direction: DVec3) -> f64 {
        match self {
            PhaseFunction::Sggx(sggx) => sggx.projected_area(direction),
            _ => 1.0,
        }
    }
}
