//! Light that media send out of themselves.
//!
//! Of the source term μa·Le a collision brings (1 − albedo)·Le, since collisions are drawn with density μt·T. Light that
//! is given per length, ε, may shine where nothing collides. It is gathered on the way to the next collision at t_c:
//!
//!   E[ ∫₀^{t_c} ε dt ] = ∫₀^∞ ε(t) P(t_c > t) dt = ∫₀^∞ ε(t) T(t) dt
//!
//! the line integration of Villemin & Hery 2013, "Practical illumination from flames". In a grid the integral is
//! estimated by one uniform point in each cell of the ray; elsewhere it has a closed form. Unbiased. Lookups: one for each cell
//! where there is something.

use std::ops::ControlFlow;

use glam::DVec3;
use tyndall_lanes::Random;
use tyndall_scene::{Density, Ray, Volume};
use tyndall_volumes::BrickGrid;

/// An unbiased estimate of the light that `volume` adds to `ray` per length from 0 to `end`, in red, green and blue.
pub fn emission_along(volume: &Volume, ray: &Ray, end: f64, random: &mut Random) -> DVec3 {
    let per_length = volume.medium.emission_per_length;
    if per_length == DVec3::ZERO {
        return DVec3::ZERO;
    }
    per_length * emitting_length(volume, ray, end, random)
}

/// An unbiased estimate of the integral, along `ray` from 0 to `end`, of what multiplies the emission per length of
/// `volume`: its emission grid if it has one, its density otherwise.
pub fn emitting_length(volume: &Volume, ray: &Ray, end: f64, random: &mut Random) -> f64 {
    let emission = volume.fields.as_ref().and_then(|fields| fields.emission.as_ref());
    if let Some((field, scale)) = emission {
        return scale * integral(&field.grid, &field.local_ray(ray), end, random);
    }
    let local = volume.local_ray(ray);
    match &volume.density {
        Density::Grid(grid) => integral(grid, &local, end, random),
        _ => volume
            .interval(&local, end)
            .and_then(|interval| volume.density_integral(&local, interval))
            .unwrap_or(0.0),
    }
}

/// Where `volume` may send out light per length along `ray` from 0 to `end`.
pub(crate) fn emitting_stretch(volume: &Volume, ray: &Ray, end: f64) -> Option<(f64, f64)> {
    let emission = volume.fields.as_ref().and_then(|fields| fields.emission.as_ref());
    match emission {
        Some((field, _)) => field.interval(&field.local_ray(ray), end),
        None => volume.interval(&volume.local_ray(ray), end),
    }
}

/// What multiplies the emission per length of `volume` at a distance inside its [`emitting_stretch`].
pub(crate) fn emission_factor_along(volume: &Volume, ray: &Ray, t: f64) -> f64 {
    if volume.fields.as_ref().is_some_and(|fields| fields.emission.is_some()) {
        return volume.emission_factor(ray.at(t));
    }
    volume.density_at(volume.local_ray(ray).at(t))
}

/// An unbiased estimate of the integral of a grid's values along a ray in the coordinates of its filter.
fn integral(grid: &BrickGrid, local: &Ray, end: f64, random: &mut Random) -> f64 {
    let mut sum = 0.0;
    let _ = grid.segments::<()>(local.origin, local.direction, (0.0, end), |segment| {
        if segment.bounds.max > 0.0 {
            let length = segment.end - segment.start;
            sum += length * grid.value(local.at(segment.start + random.f64() * length));
        }
        ControlFlow::Continue(())
    });
    sum
}
