//! Transmittance in closed form: T = exp(−τ), with τ = μt·length in a homogeneous medium (Beer's law) and a difference
//! of exponentials in an exponential atmosphere.
//!
//! Exact; no lookups.

use tyndall_scene::{Ray, Volume};

pub(super) fn transmittance(volume: &Volume, local: &Ray, end: f64) -> f64 {
    let integral = volume.interval(local, end).and_then(|within| volume.density_integral(local, within));
    integral.map_or(1.0, |integral| (-volume.medium.mu_t * integral).exp())
}
