//! Distance sampling: where along a ray light next meets the medium.
//!
//! Every sampler draws `t` with density p(t) = μt(t)·T(t), so that a collision's weight is 1, or finds that the ray
//! leaves without one, which happens with probability T. One file for each way.

mod closed_form;
mod delta_tracking;

use tyndall_lanes::Random;
use tyndall_scene::{Density, Ray, Volume};

/// The distance of the first collision with `volume` along `ray` before `end`, if there is one.
pub fn sample_distance(volume: &Volume, ray: &Ray, end: f64, random: &mut Random) -> Option<f64> {
    let local = volume.local_ray(ray);
    match &volume.density {
        Density::Grid(grid) => delta_tracking::sample(grid, volume.medium.mu_t, &local, end, random),
        _ => closed_form::sample(volume, &local, end, random),
    }
}
