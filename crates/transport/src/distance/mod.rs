//! Distance sampling: where along a ray light next meets the medium.
//!
//! A sampler returns a [`Flight`]: a collision distance with a weight, and a weight for what lies beyond the ray, such that
//!
//! ```text
//! E[weight·f(t)] = ∫ μt(t) T(t) f(t) dt   for every f,      E[escape] = T(end)
//! ```
//!
//! Analog samplers draw t with density μt·T, so that one weight is 1 and the other 0. One file for each way.

mod closed_form;
mod decomposition_tracking;
mod delta_tracking;
mod equiangular;
mod forced_collision;
mod ray_marching;
mod regular_tracking;
pub(crate) mod spectral_tracking;
mod weighted_delta_tracking;

use tyndall_lanes::Random;
use tyndall_scene::{Density, Ray, Volume};

use crate::along_ray::{AlongRay, Lookups};
use crate::properties::{Properties, Reason, check};

pub(crate) use equiangular::Equiangular;
pub use spectral_tracking::ChromaticFlight;

/// Where a ray collides, and what goes on beyond it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Flight {
    /// Distance of the collision.
    pub t: Option<f64>,
    /// Weight of the collision; 0 if there is none.
    pub weight: f64,
    /// Weight of what arrives from beyond the ray's end.
    pub escape: f64,
}

impl Flight {
    /// An analog flight.
    pub fn analog(t: Option<f64>) -> Self {
        let weight = if t.is_some() { 1.0 } else { 0.0 };
        Self { t, weight, escape: 1.0 - weight }
    }
}

/// A way to sample distances; see the file of each.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum DistanceSampler {
    /// The inverse of Beer's law.
    ClosedForm,
    /// Voxel by voxel.
    RegularTracking,
    /// By equal steps; biased.
    RayMarching {
        /// Number of steps over the ray, at least 1.
        steps: u32,
    },
    /// Real among tentative collisions.
    DeltaTracking,
    /// The same under a majorant that need not bound.
    WeightedDeltaTracking,
    /// The nearer of a collision with the control and one with the residual.
    DecompositionTracking,
    /// The same with a control that may exceed the extinction.
    WeightedDecompositionTracking,
    /// Delta tracking for all channels at once.
    SpectralTracking,
    /// In proportion to the light of a point light.
    Equiangular,
    /// Always a collision, weighted by its probability.
    ForcedCollision,
}

impl DistanceSampler {
    /// One of each.
    pub const ALL: [Self; 10] = [
        Self::ClosedForm,
        Self::RegularTracking,
        Self::RayMarching { steps: ray_marching::STEPS },
        Self::DeltaTracking,
        Self::WeightedDeltaTracking,
        Self::DecompositionTracking,
        Self::WeightedDecompositionTracking,
        Self::SpectralTracking,
        Self::Equiangular,
        Self::ForcedCollision,
    ];

    /// The sampler of this name, such as `delta-tracking`.
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|sampler| sampler.name() == name)
    }

    /// Its name.
    pub fn name(self) -> &'static str {
        self.properties().name
    }

    /// What it declares of itself.
    pub fn properties(self) -> &'static Properties {
        match self {
            Self::ClosedForm => &closed_form::PROPERTIES,
            Self::RegularTracking => &regular_tracking::PROPERTIES,
            Self::RayMarching { .. } => &ray_marching::PROPERTIES,
            Self::DeltaTracking => &delta_tracking::PROPERTIES,
            Self::WeightedDeltaTracking => &weighted_delta_tracking::PROPERTIES,
            Self::DecompositionTracking => &decomposition_tracking::PROPERTIES,
            Self::WeightedDecompositionTracking => &decomposition_tracking::WEIGHTED,
            Self::SpectralTracking => &spectral_tracking::PROPERTIES,
            Self::Equiangular => &equiangular::PROPERTIES,
            Self::ForcedCollision => &forced_collision::PROPERTIES,
        }
    }

    /// Whether its weights are 0 and 1, so that collisions can be counted.
    pub fn is_analog(self) -> bool {
        !matches!(
            self,
            Self::WeightedDeltaTracking
                | Self::WeightedDecompositionTracking
                | Self::Equiangular
                | Self::ForcedCollision
        )
    }

    /// Whether it can be used on `ray`.
    ///
    /// # Errors
    /// The reason why not.
    pub fn check(self, ray: &AlongRay) -> Result<(), Reason> {
        check(self.properties(), ray)
    }

    /// One flight along `ray`.
    pub fn sample(self, ray: &AlongRay, random: &mut Random, lookups: &mut Lookups) -> Flight {
        match self {
            Self::ClosedForm => closed_form::sample(ray, random, lookups),
            Self::RegularTracking => regular_tracking::sample(ray, random, lookups),
            Self::RayMarching { steps } => ray_marching::sample(ray, steps, random, lookups),
            Self::DeltaTracking => delta_tracking::sample(ray, random, lookups),
            Self::WeightedDeltaTracking => weighted_delta_tracking::sample(ray, random, lookups),
            Self::DecompositionTracking => decomposition_tracking::sample(ray, random, lookups),
            Self::WeightedDecompositionTracking => {
                decomposition_tracking::sample_weighted(ray, random, lookups)
            }
            Self::SpectralTracking => spectral_tracking::sample_grey(ray, random, lookups),
            Self::Equiangular => equiangular::sample(ray, random, lookups),
            Self::ForcedCollision => forced_collision::sample(ray, random, lookups),
        }
    }
}

/// The distance of the first collision with `volume` along `ray` between the two distances of `range`, if there is one; by
/// what is best as a rule: the closed form where there is one, else delta tracking.
pub fn sample_distance(volume: &Volume, ray: &Ray, range: (f64, f64), random: &mut Random) -> Option<f64> {
    let ray = AlongRay::through_one(volume, ray, range)?;
    let sampler = match volume.density {
        Density::Grid(_) => DistanceSampler::DeltaTracking,
        _ => DistanceSampler::ClosedForm,
    };
    sampler.sample(&ray, random, &mut Lookups::default()).t
}
