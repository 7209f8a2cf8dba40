//! Delta tracking as an estimator of transmittance: 1 if a tracked flight reaches the end, else 0.
//!
//! Source: Woodcock, Murphy, Hemmings & Longworth 1965; used so by Raab, Seibert & Keller 2006. Unbiased, with the variance
//! T(1 − T) whatever the majorant. Expected lookups: ∫ μ̄ T.

use std::ops::ControlFlow;

use tyndall_lanes::Random;

use crate::along_ray::{AlongRay, Lookups, tentative_collisions};
use crate::properties::{MajorantUse, Properties};

pub(super) const PROPERTIES: Properties = Properties {
    name: "delta-tracking",
    unbiased: true,
    majorant: MajorantUse::Bounding,
    needs: &[],
    source: "Woodcock et al. 1965",
};

pub(super) fn estimate(ray: &AlongRay, random: &mut Random, lookups: &mut Lookups) -> f64 {
    let flight = tentative_collisions(
        ray,
        |piece| piece.majorant,
        random,
        |at, random| {
            let is_real = random.f64() * at.rate < ray.mu_t(at.t, lookups);
            if is_real { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
        },
    );
    if flight.is_break() { 0.0 } else { 1.0 }
}
