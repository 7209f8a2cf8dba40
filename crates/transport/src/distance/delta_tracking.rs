//! Delta tracking: collisions of a heterogeneous medium among those of a denser homogeneous one.
//!
//! The medium is filled up with fictitious ("null") matter to the majorant μ̄ ≥ μt. Tentative collisions follow
//! exp(−μ̄ t); one is real with probability μt/μ̄, otherwise flight goes on. Here the majorant is that of the grid's
//! cell, changed from cell to cell, which the exponential's lack of memory allows.
//!
//! Source: Woodcock, Murphy, Hemmings & Longworth 1965; Novák et al. 2018, section 3.2. Unbiased. Expected lookups:
//! ∫ μ̄ along the flight.

use std::ops::ControlFlow;
use tyndall_lanes::Random;
use tyndall_scene::Ray;
use tyndall_volumes::BrickGrid;

pub(super) fn sample(grid: &BrickGrid, mu_t: f64, local: &Ray, end: f64, random: &mut Random) -> Option<f64> {
    let flight = grid.segments(local.origin, local.direction, (0.0, end), |segment| {
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
            if random.f64() * majorant < extinction {
                return ControlFlow::Break(t);
            }
        }
    });
    flight.break_value()
}
