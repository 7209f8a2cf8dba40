//! Delta tracking: collisions of a heterogeneous medium among those of a denser homogeneous one.
//!
//! The medium is filled up with fictitious ("null") matter to the majorant μ̄ ≥ μt. Tentative collisions follow
//! exp(−μ̄ t); one is real with probability μt/μ̄, otherwise flight goes on. Here the majorant is that of the grid's
//! cell, changed from cell to cell, which the exponential's lack of memory allows.
//!
//! Source: Woodcock, Murphy, Hemmings & Longworth 1965; Novák et al. 2018, section 3.2. Unbiased, analog. Expected lookups:
//! ∫ μ̄ along the flight.

use std::ops::ControlFlow;

use tyndall_lanes::Random;

use super::Flight;
use crate::along_ray::{AlongRay, Lookups, tentative_collisions};
use crate::properties::{MajorantUse, Properties};

pub(super) const PROPERTIES: Properties = Properties {
    name: "delta-tracking",
    unbiased: true,
    majorant: MajorantUse::Bounding,
    needs: &[],
    source: "Woodcock et al. 1965",
};

pub(super) fn sample(ray: &AlongRay, random: &mut Random, lookups: &mut Lookups) -> Flight {
    let flight = tentative_collisions(
        ray,
        |piece| piece.majorant,
        random,
        |at, random| {
            let mu_t = ray.mu_t(at.t, lookups);
            if random.f64() * at.rate < mu_t { ControlFlow::Break(at.t) } else { ControlFlow::Continue(()) }
        },
    );
    Flight::analog(flight.break_value())
}
