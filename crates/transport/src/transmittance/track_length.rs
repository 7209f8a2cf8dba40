//! Track-length estimation: T = 1 − ∫ μt T, where a tracked flight, instead of counting its collision, scores the collisions
//! that were to be expected along its track.
//!
//!   X = 1 − Σ μt(tᵢ)/μ̄   over the tentative collisions up to and with the first real one
//!
//! The sum is the integral of μt over the track, taken at the tentative collisions, which lie along it with density μ̄.
//! Source: Spanier 1966, "Two pairs of families of estimators for transport problems". (In Novák et al. 2018 "track-length"
//! is the 0/1 score of delta tracking.) Unbiased, but may be negative. In a homogeneous medium under a loose majorant the
//! variance tends to 1 − 2τT − T², less than that of delta tracking where τ is below about 1.26 and more beyond. Expected
//! lookups: ∫ μ̄ T.

use std::ops::ControlFlow;

use tyndall_lanes::Random;

use crate::along_ray::{AlongRay, Lookups, tentative_collisions};
use crate::properties::{MajorantUse, Properties};

pub(super) const PROPERTIES: Properties = Properties {
    name: "track-length",
    unbiased: true,
    majorant: MajorantUse::Bounding,
    needs: &[],
    source: "Spanier 1966",
};

pub(super) fn estimate(ray: &AlongRay, random: &mut Random, lookups: &mut Lookups) -> f64 {
    let mut estimate = 1.0;
    let _ = tentative_collisions(
        ray,
        |piece| piece.majorant,
        random,
        |at, random| {
            let mu_t = ray.mu_t(at.t, lookups);
            estimate -= mu_t / at.rate;
            if random.f64() * at.rate < mu_t { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
        },
    );
    estimate
}
