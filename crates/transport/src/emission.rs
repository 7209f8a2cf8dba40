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
use tyndall_scene::{Density, Field, Ray, Volume};
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
    let local = volume.local_ray(ray);
    if let Some((field, scale)) = emission_field(volume) {
        let Some(range) = within_shape(volume, &local, end) else { return 0.0 };
        return scale * integral(&field.grid, &field.local_ray(ray), range, random);
    }
    match &volume.density {
        Density::Grid(grid) => integral(grid, &local, (0.0, end), random),
        _ => within_shape(volume, &local, end)
            .and_then(|range| volume.density_integral(&local, range))
            .unwrap_or(0.0),
    }
}

fn emission_field(volume: &Volume) -> Option<&(Field, f64)> {
    volume.fields.as_ref().and_then(|fields| fields.emission.as_ref())
}

/// The part of the ray up to `end` inside the volume's shape; all of it for a density grid, beside which there may be
/// flames as well.
fn within_shape(volume: &Volume, local: &Ray, end: f64) -> Option<(f64, f64)> {
    match &volume.density {
        Density::Grid(_) => Some((0.0, end)),
        _ => volume.interval(local, end),
    }
}

/// Where `volume` may send out light per length along `ray` from 0 to `end`.
pub(crate) fn emitting_stretch(volume: &Volume, ray: &Ray, end: f64) -> Option<(f64, f64)> {
    let local = volume.local_ray(ray);
    let Some((field, _)) = emission_field(volume) else { return volume.interval(&local, end) };
    let (start, end) = within_shape(volume, &local, end)?;
    let (enter, leave) = field.interval(&field.local_ray(ray), end)?;
    let enter = enter.max(start);
    (enter < leave).then_some((enter, leave))
}

/// What multiplies the emission per length of `volume` at a distance inside its [`emitting_stretch`].
pub(crate) fn emission_factor_along(volume: &Volume, ray: &Ray, t: f64) -> f64 {
    match emission_field(volume) {
        Some(_) => volume.emission_factor(ray.at(t)),
        None => volume.density_at(volume.local_ray(ray).at(t)),
    }
}

/// An unbiased estimate of the integral of a grid's values along a ray in the coordinates of its filter.
fn integral(grid: &BrickGrid, local: &Ray, range: (f64, f64), random: &mut Random) -> f64 {
    let mut sum = 0.0;
    let _ = grid.segments::<()>(local.origin, local.direction, range, |segment| {
        if segment.bounds.max > 0.0 {
            let length = segment.end - segment.start;
            sum += length * grid.value(local.at(segment.start + random.f64() * length));
        }
        ControlFlow::Continue(())
    });
    sum
}
