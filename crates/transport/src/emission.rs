//! Light that media send out of themselves.
//!
//! Of the source term μa·Le a collision brings (1 − albedo)·Le, since collisions are drawn with density μt·T. Light that
//! is given per length, ε, may shine where nothing collides. It is gathered on the way to the next collision at t_c:
//!
//!   E[ ∫₀^{t_c} ε dt ] = ∫₀^∞ ε(t) P(t_c > t) dt = ∫₀^∞ ε(t) T(t) dt
//!
//! the line integration of Villemin & Hery 2013, "Practical illumination from flames". In a grid the integral is
//! estimated by one uniform point in each cell of the ray; elsewhere it has a closed form, or is estimated by one uniform
//! point if it has a weight. Unbiased. Lookups: one for each cell where there is something.
//!
//! Media that glow are lights as well: next-event estimation draws a point y in them with a density p_V per volume. Both
//! ways of finding y from x at the distance d are joined by weights that add up to 1 for every y (Veach 1997, section 9.2):
//!
//!   w_path = p_ω κ/(p_ω κ + p_V d²),   w_light = 1 − w_path,
//!
//! where p_ω is the density with which the path goes on in that direction and κ that with which it then finds y, but for the
//! transmittance, which both have: μt, or something like it, and 1/d for what is gathered on the way.

use std::ops::ControlFlow;

use glam::DVec3;
use tyndall_lanes::Random;
use tyndall_scene::light::VolumeLight;
use tyndall_scene::{Density, Field, Light, Ray, Scene, Volume};
use tyndall_volumes::BrickGrid;

/// An unbiased estimate of the light that `volume` adds to `ray` per length between the distances of `range`, in red,
/// green and blue.
pub fn emission_along(volume: &Volume, ray: &Ray, range: (f64, f64), random: &mut Random) -> DVec3 {
    weighted_emission_along(volume, ray, range, None, random)
}

/// The same, each part of the way with a weight by its distance.
pub(crate) fn weighted_emission_along(
    volume: &Volume,
    ray: &Ray,
    range: (f64, f64),
    weight: Option<&dyn Fn(f64) -> f64>,
    random: &mut Random,
) -> DVec3 {
    let per_length = volume.medium.emission_per_length;
    if per_length == DVec3::ZERO {
        return DVec3::ZERO;
    }
    per_length * emitting_length(volume, ray, range, weight, random)
}

/// An unbiased estimate of the weighted integral, along `ray` between the distances of `range`, of what multiplies the
/// emission per length of `volume`: its emission grid if it has one, its density otherwise.
pub(crate) fn emitting_length(
    volume: &Volume,
    ray: &Ray,
    range: (f64, f64),
    weight: Option<&dyn Fn(f64) -> f64>,
    random: &mut Random,
) -> f64 {
    let local = volume.local_ray(ray);
    let weigh = |t: f64| weight.map_or(1.0, |weight| weight(t));
    if let Some((field, scale)) = emission_field(volume) {
        let Some(range) = within_shape(volume, &local, range) else { return 0.0 };
        return scale * integral(&field.grid, &field.local_ray(ray), range, weigh, random);
    }
    match &volume.density {
        Density::Grid(grid) => integral(grid, &local, range, weigh, random),
        _ => {
            let Some((start, end)) = within_shape(volume, &local, range) else { return 0.0 };
            if weight.is_none() {
                return volume.density_integral(&local, (start, end)).unwrap_or(0.0);
            }
            let t = start + random.f64() * (end - start);
            (end - start) * volume.density_at(local.at(t)) * weigh(t)
        }
    }
}

fn emission_field(volume: &Volume) -> Option<&(Field, f64)> {
    volume.fields.as_ref().and_then(|fields| fields.emission.as_ref())
}

/// The part of the range of the ray inside the volume's shape; all of it for a density grid, beside which there may be
/// flames as well.
fn within_shape(volume: &Volume, local: &Ray, range: (f64, f64)) -> Option<(f64, f64)> {
    match &volume.density {
        Density::Grid(_) => Some(range),
        _ => volume.interval(local, range),
    }
}

/// Where `volume` may send out light per length along `ray` between the distances of `range`.
pub(crate) fn emitting_stretch(volume: &Volume, ray: &Ray, range: (f64, f64)) -> Option<(f64, f64)> {
    let local = volume.local_ray(ray);
    let Some((field, _)) = emission_field(volume) else { return volume.interval(&local, range) };
    field.interval(&field.local_ray(ray), within_shape(volume, &local, range)?)
}

/// What multiplies the emission per length of `volume` at a distance inside its [`emitting_stretch`].
pub(crate) fn emission_factor_along(volume: &Volume, ray: &Ray, t: f64) -> f64 {
    volume.emission_per_length_factor(ray.at(t))
}

/// An unbiased estimate of the weighted integral of a grid's values along a ray in the coordinates of its filter.
fn integral(
    grid: &BrickGrid,
    local: &Ray,
    range: (f64, f64),
    weigh: impl Fn(f64) -> f64,
    random: &mut Random,
) -> f64 {
    let mut sum = 0.0;
    let _ = grid.segments::<()>(local.origin, local.direction, range, |segment| {
        if segment.bounds.max > 0.0 {
            let length = segment.end - segment.start;
            let t = segment.start + random.f64() * length;
            sum += length * grid.value(local.at(t)) * weigh(t);
        }
        ControlFlow::Continue(())
    });
    sum
}

/// A point of a glowing volume that next-event estimation has drawn.
pub(crate) struct Glow {
    /// Where it is.
    pub position: DVec3,
    /// Unit vector there.
    pub toward: DVec3,
    /// Its distance.
    pub distance: f64,
    /// p_V d²: its density over solid angle times length, 1/(sr length).
    pub density: f64,
}

/// Draws a point of `light` as seen from `from`, for `u` uniform in [0, 1)³; none where there is no direction to it, or no light.
pub(crate) fn draw_glow(light: &VolumeLight, from: DVec3, u: [f64; 3]) -> Option<Glow> {
    let sample = light.sample(u);
    let offset = sample.position - from;
    let distance = offset.length();
    (distance != 0.0 && sample.pdf_volume > 0.0).then(|| Glow {
        position: sample.position,
        toward: offset / distance,
        distance,
        density: distance * distance * sample.pdf_volume,
    })
}

/// μt of `volume` at any place, for light that travels along `toward`. Points of a light may lie beside its volume, where no path
/// finds them.
pub(crate) fn extinction_at(volume: &Volume, position: DVec3, toward: DVec3) -> f64 {
    let density = volume.density_anywhere(volume.world_to_local.transform_point3(position));
    volume.medium.mu_t_along(toward) * density
}

/// The source term of `volume` at a place where its extinction is `mu_t`: μa·Le and what is given per length, radiance
/// per length in red, green and blue.
pub(crate) fn source_at(volume: &Volume, position: DVec3, mu_t: f64) -> DVec3 {
    let mut source = DVec3::ZERO;
    if mu_t > 0.0 {
        source += (DVec3::ONE - volume.albedo_at(position)) * volume.emission_at(position) * mu_t;
    }
    if volume.medium.emission_per_length != DVec3::ZERO {
        source += volume.medium.emission_per_length * volume.emission_per_length_factor(position);
    }
    source
}

/// w_light of a point, where the extinction is `mu_t`, that next-event estimation has drawn: with `probability` this light of
/// all, which is that of `volume`, where a path goes there with the density `path_pdf`.
pub(crate) fn light_weight(volume: &Volume, glow: &Glow, mu_t: f64, probability: f64, path_pdf: f64) -> f64 {
    let by_path = path_pdf * found(volume, mu_t, glow.distance);
    let by_light = probability * glow.density;
    if by_path + by_light > 0.0 { by_light / (by_path + by_light) } else { 0.0 }
}

/// κ, with which a path finds the light of `volume` at a place that it flies to, but for the transmittance.
fn found(volume: &Volume, mu_t: f64, distance: f64) -> f64 {
    mu_t + if volume.medium.emission_per_length != DVec3::ZERO { distance.recip() } else { 0.0 }
}

/// w_path of a path that has turned at `from` with the density `path_pdf` towards `position`, where the volume glows; 1 if
/// the volume is no light for next-event estimation.
pub(crate) fn path_weight(scene: &Scene, number: usize, from: DVec3, position: DVec3, path_pdf: f64) -> f64 {
    let volume = &scene.volumes[number];
    path_weight_by(scene, number, from, position, path_pdf, |toward| extinction_at(volume, position, toward))
}

/// The same, with the extinction there for light that travels towards it as [`light_weight`] is given it.
pub(crate) fn path_weight_by(
    scene: &Scene,
    number: usize,
    from: DVec3,
    position: DVec3,
    path_pdf: f64,
    extinction: impl FnOnce(DVec3) -> f64,
) -> f64 {
    let Some(light_number) = scene.light_of_volume(number) else { return 1.0 };
    let Light::Volume(light) = &scene.lights[light_number] else { return 1.0 };
    let volume = &scene.volumes[number];
    let offset = position - from;
    let distance_squared = offset.length_squared();
    if distance_squared == 0.0 {
        return 1.0;
    }
    let mu_t = extinction(offset.normalize());
    let by_path = path_pdf * found(volume, mu_t, distance_squared.sqrt());
    let probability = scene.light_probability(light_number, from);
    let by_light = probability * light.pdf_volume(position) * distance_squared;
    if by_path + by_light > 0.0 { by_path / (by_path + by_light) } else { 1.0 }
}
