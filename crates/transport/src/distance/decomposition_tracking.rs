//! Decomposition tracking: a control extinction μc sampled in closed form, the residual μt − μc by tracking, and the nearer
//! collision taken.
//!
//! Of two independent processes the first event follows the sum of their rates. Where the control comes first nothing is
//! looked up at the collision itself. Analog, the control must not exceed the extinction: it is the minorant, or less.
//! Weighted, the residual may be negative, and its tentative collisions, of rate μ̄r ≥ |μt − μc|, are weighted as in weighted
//! delta tracking.
//!
//! Source: Kutz, Habel, Li & Novák 2017, "Spectral and decomposition tracking for rendering heterogeneous volumes". Unbiased.
//! Expected lookups: ∫ μ̄r along the flight.

use std::ops::ControlFlow;

use tyndall_lanes::Random;

use super::Flight;
use super::weighted_delta_tracking::real_or_null;
use crate::along_ray::{AlongRay, Lookups, Piece};
use crate::properties::{MajorantUse, Need, Properties};

pub(super) const PROPERTIES: Properties = Properties {
    name: "decomposition-tracking",
    unbiased: true,
    majorant: MajorantUse::Bounding,
    needs: &[Need::Control],
    source: "Kutz et al. 2017",
};

pub(super) const WEIGHTED: Properties =
    Properties { name: "weighted-decomposition-tracking", majorant: MajorantUse::NonBounding, ..PROPERTIES };

pub(super) fn sample(ray: &AlongRay, random: &mut Random, lookups: &mut Lookups) -> Flight {
    let flight = ray.pieces(|piece| {
        let control = piece.control.min(piece.minorant);
        first_of_two(piece, control, piece.majorant - control, random, |t, rate, random| {
            random.f64() * rate < ray.mu_t(t, lookups) - control
        })
    });
    Flight::analog(flight.break_value())
}

pub(super) fn sample_weighted(ray: &AlongRay, random: &mut Random, lookups: &mut Lookups) -> Flight {
    let mut weight = 1.0;
    let flight = ray.pieces(|piece| {
        first_of_two(piece, piece.control, piece.residual_majorant, random, |t, rate, random| {
            let (is_real, factor) = real_or_null(ray.mu_t(t, lookups) - piece.control, rate, random);
            weight *= factor;
            is_real
        })
    });
    match flight.break_value() {
        Some(t) => Flight { t: Some(t), weight, escape: 0.0 },
        None => Flight { t: None, weight: 0.0, escape: weight },
    }
}

/// The nearer in this piece of a collision with the control and one of the residual's tentative collisions, of rate
/// `residual`, that `is_real`.
fn first_of_two(
    piece: &Piece,
    control: f64,
    residual: f64,
    random: &mut Random,
    mut is_real: impl FnMut(f64, f64, &mut Random) -> bool,
) -> ControlFlow<f64> {
    let free = |rate: f64, random: &mut Random| {
        if rate > 0.0 { random.exponential_f64() / rate } else { f64::INFINITY }
    };
    let control_t = piece.start + free(control, random);
    let mut t = piece.start;
    loop {
        t += free(residual, random);
        if t >= control_t.min(piece.end) {
            break;
        }
        if is_real(t, residual, random) {
            return ControlFlow::Break(t);
        }
    }
    if control_t < piece.end { ControlFlow::Break(control_t) } else { ControlFlow::Continue(()) }
}
