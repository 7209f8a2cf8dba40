//! Transmittance estimation: how much of the light gets through, T = exp(−∫ μt).
//!
//! Every estimator has T as its mean. One file for each.

mod closed_form;
mod ratio_tracking;

use tyndall_lanes::Random;
use tyndall_scene::{Density, Ray, Volume};

/// An unbiased estimate of the transmittance of `volume` along `ray` from 0 to `end`.
pub fn estimate_transmittance(volume: &Volume, ray: &Ray, end: f64, random: &mut Random) -> f64 {
    let local = volume.local_ray(ray);
    match &volume.density {
        Density::Grid(grid) => ratio_tracking::estimate(grid, volume.medium.mu_t, &local, end, random),
        _ => closed_form::transmittance(volume, &local, end),
    }
}
