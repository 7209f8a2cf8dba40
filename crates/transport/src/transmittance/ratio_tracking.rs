//! Ratio tracking: T as the product of (1 − μt/μ̄) over tentative collisions.
//!
//! The tentative collisions are those of delta tracking under the majorant μ̄; in place of ending at a real one, the
//! weight takes the probability that it was null. Source: Novák, Selle & Jarosz 2014, "Residual ratio tracking for
//! estimating attenuation in participating media". Unbiased. Expected lookups: ∫ μ̄ along the ray, less what
//! roulette saves: below a weight of 0.1 the walk goes on with probability weight/0.1 and weight 0.1.

use std::ops::ControlFlow;
use tyndall_lanes::Random;
use tyndall_scene::Ray;
use tyndall_volumes::BrickGrid;

/// Weight below which roulette is played, and the weight of survivors.
const ROULETTE_WEIGHT: f64 = 0.1;

pub(super) fn estimate(grid: &BrickGrid, mu_t: f64, local: &Ray, end: f64, random: &mut Random) -> f64 {
    let mut weight = 1.0;
    let walk = grid.segments(local.origin, local.direction, (0.0, end), |segment| {
        let majorant = mu_t * f64::from(segment.bounds.max);
        if majorant <= 0.0 {
            return ControlFlow::Continue(());
        }
        let mut t = segment.start;
        loop {
            t += random.exponential_f64() / majorant;
            if t >= segment.end {
                return ControlFlow::Continue(());
            }
            let extinction = mu_t * grid.value(local.at(t));
            weight *= 1.0 - extinction / majorant;
            if weight < ROULETTE_WEIGHT {
                if random.f64() * ROULETTE_WEIGHT >= weight {
                    return ControlFlow::Break(());
                }
                weight = ROULETTE_WEIGHT;
            }
        }
    });
    if walk.is_break() { 0.0 } else { weight }
}
