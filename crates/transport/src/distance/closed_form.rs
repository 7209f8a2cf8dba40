//! Distance sampling in closed form, for a homogeneous medium: t = −ln(1 − ξ)/μt.
//!
//! Source: Novák, Georgiev, Hanika & Jarosz 2018, "Monte Carlo methods for volumetric light transport simulation",
//! section 3.1. Unbiased; no lookups.

use tyndall_lanes::Random;

pub(super) fn sample(mu_t: f64, (enter, leave): (f64, f64), random: &mut Random) -> Option<f64> {
    let t = enter + random.exponential_f64() / mu_t;
    (t < leave).then_some(t)
}
