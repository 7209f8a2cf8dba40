//! Ratio tracking: T as the product of (1 − μt/μ̄) over tentative collisions.
//!
//! The tentative collisions are those of delta tracking under the majorant μ̄; in place of ending at a real one, the
//! weight takes the probability that it was null. Source: Novák, Selle & Jarosz 2014, "Residual ratio tracking for
//! estimating attenuation in participating media". Unbiased, also where the majorant does not bound. Variance without
//! roulette: T²(exp(∫ μt²/μ̄) − 1). Expected lookups: ∫ μ̄ along the ray, less what roulette saves: below a weight of 0.1 the
//! walk goes on with probability weight/0.1 and weight 0.1.

use std::ops::ControlFlow;

use tyndall_lanes::Random;

use crate::along_ray::{AlongRay, Lookups, tentative_collisions};
use crate::properties::{MajorantUse, Properties};

pub(super) const PROPERTIES: Properties = Properties {
    name: "ratio-tracking",
    unbiased: true,
    majorant: MajorantUse::NonBounding,
    needs: &[],
    source: "Novák, Selle & Jarosz 2014",
};

pub(super) const WITH_ROULETTE: Properties = Properties { name: "ratio-tracking-roulette", ..PROPERTIES };

/// Weight below which roulette is played, and the weight of survivors.
pub(super) const ROULETTE_WEIGHT: f64 = 0.1;

/// `roulette_weight` is 0 for none.
pub(super) fn estimate(
    ray: &AlongRay,
    roulette_weight: f64,
    random: &mut Random,
    lookups: &mut Lookups,
) -> f64 {
    let mut weight = 1.0_f64;
    let walk = tentative_collisions(
        ray,
        |piece| piece.majorant,
        random,
        |at, random| {
            weight *= 1.0 - ray.mu_t(at.t, lookups) / at.rate;
            if weight.abs() < roulette_weight {
                if random.f64() * roulette_weight >= weight.abs() {
                    return ControlFlow::Break(());
                }
                weight = roulette_weight.copysign(weight);
            }
            if at.is_hopeless(weight) { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
        },
    );
    if walk.is_break() { 0.0 } else { weight }
}
