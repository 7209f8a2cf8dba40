//! Light that a path finds by going on, weighted against next-event estimation having drawn it.
//!
//! The balance heuristic (Veach 1997, section 9.2): a path that turned at x into ω with the density p has the weight
//! p/(p + P p_l) for the light it meets, where P is the probability with which next-event estimation at x draws that light
//! and p_l the density with which it then draws ω. The camera's own ray, and one from a mirror, have no competition.

use glam::DVec3;
use tyndall_scene::{Hit, Scene};

/// Where a path last turned, and the density with which it did so into its direction, 1/sr; none for the camera's own ray
/// and after a mirror.
pub(crate) type Turned = Option<(DVec3, f64)>;

/// Weight of a path that finds the light of this number, whose samples at a place have the density `light_pdf`.
pub(crate) fn weight(scene: &Scene, number: usize, turned: Turned, light_pdf: impl Fn(DVec3) -> f64) -> f64 {
    match turned {
        Some((from, pdf)) => pdf / (pdf + scene.light_probability(number, from) * light_pdf(from)),
        None => 1.0,
    }
}

/// Radiance of the lights at infinity from `direction`, each with its weight.
pub(crate) fn surroundings(scene: &Scene, direction: DVec3, turned: Turned) -> DVec3 {
    let lights = scene.lights.iter().enumerate();
    lights
        .map(|(number, light)| {
            let radiance = light.radiance(direction);
            if radiance == DVec3::ZERO {
                return DVec3::ZERO;
            }
            radiance * weight(scene, number, turned, |_| light.pdf(direction))
        })
        .sum()
}

/// Radiance of the lamp, if it is one, that a path in `direction` meets, with its weight.
pub(crate) fn lamp(scene: &Scene, hit: &Hit, direction: DVec3, turned: Turned) -> DVec3 {
    let Some((number, lamp)) = scene.lamp(hit) else { return DVec3::ZERO };
    let light_pdf = |from| lamp.pdf_of_hit(from, direction, hit.position, hit.normal);
    lamp.radiance_from(hit.normal, direction) * weight(scene, number, turned, light_pdf)
}
