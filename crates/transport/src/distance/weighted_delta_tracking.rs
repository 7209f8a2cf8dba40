//! Weighted delta tracking: delta tracking under a rate μ̄ of tentative collisions that need not bound the extinction.
//!
//! Where μt > μ̄ the null matter μn = μ̄ − μt is negative. A tentative collision is real with probability
//! |μt|/(|μt| + |μn|), and the weight takes what that is too little or too much:
//!
//!   real: w ← w·μt/(μ̄ P),    null: w ← w·μn/(μ̄ (1 − P)),   each ±(|μt| + |μn|)/μ̄
//!
//! Source: Galtier et al. 2013, "Integral formulation of null-collision Monte Carlo algorithms"; Legrady, Molnar, Klausz &
//! Major 2017, "Woodcock method with arbitrary sampling cross section". Unbiased; the same as delta tracking where μ̄ bounds;
//! elsewhere weights grow and change sign. Expected lookups: ∫ μ̄ along the flight.

use std::ops::ControlFlow;

use tyndall_lanes::Random;

use super::Flight;
use crate::along_ray::{AlongRay, Lookups, tentative_collisions};
use crate::properties::{MajorantUse, Properties};

pub(super) const PROPERTIES: Properties = Properties {
    name: "weighted-delta-tracking",
    unbiased: true,
    majorant: MajorantUse::NonBounding,
    needs: &[],
    source: "Galtier et al. 2013",
};

pub(super) fn sample(ray: &AlongRay, random: &mut Random, lookups: &mut Lookups) -> Flight {
    let mut weight = 1.0;
    let flight = tentative_collisions(
        ray,
        |piece| piece.majorant,
        random,
        |at, random| {
            let mu_t = ray.mu_t(at.t, lookups);
            let (is_real, factor) = real_or_null(mu_t, at.rate, random);
            weight *= factor;
            if is_real { ControlFlow::Break(at.t) } else { ControlFlow::Continue(()) }
        },
    );
    match flight.break_value() {
        Some(t) => Flight { t: Some(t), weight, escape: 0.0 },
        None => Flight { t: None, weight: 0.0, escape: weight },
    }
}

/// Whether a tentative collision of `rate` with an extinction `mu_t`, of any sign, is real, and the factor on the weight.
pub(super) fn real_or_null(mu_t: f64, rate: f64, random: &mut Random) -> (bool, f64) {
    let null = rate - mu_t;
    let size = mu_t.abs() + null.abs();
    let is_real = random.f64() * size < mu_t.abs();
    let part = if is_real { mu_t } else { null };
    (is_real, (size / rate).copysign(part))
}
