//! Distance sampling in closed form: the t at which the optical thickness is −ln(1 − ξ). In a homogeneous medium that
//! is t = −ln(1 − ξ)/μt; an exponential atmosphere has an inverse too.
//!
//! Source: Novák, Georgiev, Hanika & Jarosz 2018, "Monte Carlo methods for volumetric light transport simulation",
//! section 3.1. Unbiased; no lookups.

use tyndall_lanes::Random;
use tyndall_scene::{Ray, Volume};

pub(super) fn sample(volume: &Volume, local: &Ray, end: f64, random: &mut Random) -> Option<f64> {
    let (enter, leave) = volume.interval(local, end)?;
    let t = volume.distance_of_integral(local, enter, random.exponential_f64() / volume.medium.mu_t);
    (t < leave).then_some(t)
}
