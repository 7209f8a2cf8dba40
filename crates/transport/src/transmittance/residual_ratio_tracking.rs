//! Residual ratio tracking: T = exp(−∫ μc) · Π (1 − (μt − μc)/μ̄r), a control extinction μc in closed form and ratio tracking
//! for the rest, under a majorant μ̄r ≥ |μt − μc|.
//!
//! Source: Novák, Selle & Jarosz 2014, section 4. Unbiased. Variance: T²(exp(∫ (μt − μc)²/μ̄r) − 1). Expected lookups: ∫ μ̄r,
//! few where the control is near the extinction.

use std::ops::ControlFlow;

use tyndall_lanes::Random;

use crate::along_ray::{AlongRay, Lookups, tentative_collisions};
use crate::properties::{MajorantUse, Need, Properties};

pub(super) const PROPERTIES: Properties = Properties {
    name: "residual-ratio-tracking",
    unbiased: true,
    majorant: MajorantUse::NonBounding,
    needs: &[Need::Control],
    source: "Novák, Selle & Jarosz 2014",
};

pub(super) fn estimate(ray: &AlongRay, random: &mut Random, lookups: &mut Lookups) -> f64 {
    let mut control_thickness = 0.0;
    let _ = ray.pieces(|piece| {
        control_thickness += piece.control * (piece.end - piece.start);
        ControlFlow::<()>::Continue(())
    });
    let mut residual = 1.0;
    let _ = tentative_collisions(
        ray,
        |piece| piece.residual_majorant,
        random,
        |at, _| {
            residual *= 1.0 - (ray.mu_t(at.t, lookups) - at.piece.control) / at.rate;
            if at.is_hopeless(residual) { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
        },
    );
    libm::exp(-control_thickness) * residual
}
