//! Transmittance estimation: how much of the light gets through, T = exp(−∫ μt).
//!
//! Every estimator has T as its mean, but for those that say that they are biased. One file for each.

mod closed_form;
mod delta_tracking;
mod next_flight;
mod p_series;
mod ratio_tracking;
mod ray_marching;
mod regular_tracking;
mod residual_ratio_tracking;
mod telescoping;
mod track_length;
mod unbiased_ray_marching;

use tyndall_lanes::Random;
use tyndall_scene::{Density, Ray, Volume};

use crate::along_ray::{AlongRay, Lookups};
use crate::properties::{Properties, Reason, check};

/// A way to estimate transmittance; see the file of each.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum TransmittanceEstimator {
    /// Beer's law.
    ClosedForm,
    /// Voxel by voxel.
    RegularTracking,
    /// Quadrature by equal steps; biased.
    RayMarching {
        /// Number of steps over the ray, at least 1.
        steps: u32,
    },
    /// 1 if a tracked flight gets through, else 0.
    DeltaTracking,
    /// 1 less the expected collisions of a tracked flight.
    TrackLength,
    /// Product of the probabilities of null collisions.
    RatioTracking,
    /// The same, ended by roulette where it has become small.
    RatioTrackingRoulette,
    /// A control extinction in closed form, ratio tracking for the rest.
    ResidualRatioTracking,
    /// Expected flights through, from every tentative collision.
    NextFlight,
    /// The same, ended at a real collision.
    NextFlightAnalog,
    /// Power series about the majorant.
    PSeriesCmf,
    /// Power series about ray-marched estimates.
    UnbiasedRayMarching,
    /// Ray marching with its bias taken off by a randomly truncated telescoping sum.
    TelescopingRayMarching,
}

impl TransmittanceEstimator {
    /// One of each.
    pub const ALL: [Self; 13] = [
        Self::ClosedForm,
        Self::RegularTracking,
        Self::RayMarching { steps: ray_marching::STEPS },
        Self::DeltaTracking,
        Self::TrackLength,
        Self::RatioTracking,
        Self::RatioTrackingRoulette,
        Self::ResidualRatioTracking,
        Self::NextFlight,
        Self::NextFlightAnalog,
        Self::PSeriesCmf,
        Self::UnbiasedRayMarching,
        Self::TelescopingRayMarching,
    ];

    /// The estimator of this name, such as `ratio-tracking`.
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|estimator| estimator.name() == name)
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
            Self::TrackLength => &track_length::PROPERTIES,
            Self::RatioTracking => &ratio_tracking::PROPERTIES,
            Self::RatioTrackingRoulette => &ratio_tracking::WITH_ROULETTE,
            Self::ResidualRatioTracking => &residual_ratio_tracking::PROPERTIES,
            Self::NextFlight => &next_flight::PROPERTIES,
            Self::NextFlightAnalog => &next_flight::ANALOG,
            Self::PSeriesCmf => &p_series::PROPERTIES,
            Self::UnbiasedRayMarching => &unbiased_ray_marching::PROPERTIES,
            Self::TelescopingRayMarching => &telescoping::PROPERTIES,
        }
    }

    /// Whether it can be used on `ray`.
    ///
    /// # Errors
    /// The reason why not.
    pub fn check(self, ray: &AlongRay) -> Result<(), Reason> {
        check(self.properties(), ray)
    }

    /// One estimate of the transmittance along all of `ray`.
    pub fn estimate(self, ray: &AlongRay, random: &mut Random, lookups: &mut Lookups) -> f64 {
        match self {
            Self::ClosedForm => closed_form::transmittance(ray, lookups),
            Self::RegularTracking => regular_tracking::transmittance(ray, lookups),
            Self::RayMarching { steps } => ray_marching::estimate(ray, steps, random, lookups),
            Self::DeltaTracking => delta_tracking::estimate(ray, random, lookups),
            Self::TrackLength => track_length::estimate(ray, random, lookups),
            Self::RatioTracking => ratio_tracking::estimate(ray, 0.0, random, lookups),
            Self::RatioTrackingRoulette => {
                ratio_tracking::estimate(ray, ratio_tracking::ROULETTE_WEIGHT, random, lookups)
            }
            Self::ResidualRatioTracking => residual_ratio_tracking::estimate(ray, random, lookups),
            Self::NextFlight => next_flight::estimate(ray, random, lookups),
            Self::NextFlightAnalog => next_flight::estimate_analog(ray, random, lookups),
            Self::PSeriesCmf => p_series::estimate(ray, random, lookups),
            Self::UnbiasedRayMarching => unbiased_ray_marching::estimate(ray, random, lookups),
            Self::TelescopingRayMarching => telescoping::estimate(ray, random, lookups),
        }
    }
}

/// An unbiased estimate of the transmittance of `volume` along `ray` between the two distances of `range`, by what is best
/// as a rule: the closed form where there is one, else ratio tracking with roulette.
pub fn estimate_transmittance(volume: &Volume, ray: &Ray, range: (f64, f64), random: &mut Random) -> f64 {
    let Some(ray) = AlongRay::through_one(volume, ray, range) else { return 1.0 };
    let estimator = match volume.density {
        Density::Grid(_) => TransmittanceEstimator::RatioTrackingRoulette,
        _ => TransmittanceEstimator::ClosedForm,
    };
    estimator.estimate(&ray, random, &mut Lookups::default())
}
