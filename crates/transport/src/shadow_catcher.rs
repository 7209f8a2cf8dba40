//! Shadow catchers: surfaces that are there only for the shadows that fall on them.
//!
//! What a compositor wants of one is how much darker it is for what the scene has put there: its reflected light as it is,
//! over the same if nothing stood between it and the lights. Both are estimated by the same directions, so that the
//! quotient of their means has little noise. Lights at infinity are found by next-event estimation and by directions drawn
//! from the surface, joined by the balance heuristic; the others by next-event estimation alone.

use glam::DVec3;
use tyndall_lanes::Random;
use tyndall_optics::cie;
use tyndall_scene::surface::Presence;
use tyndall_scene::{Light, Scene};

use crate::estimators::Estimators;
use crate::found_light::surroundings;
use crate::surface_vertex::SurfaceVertex;
use crate::way::Way;

/// Luminance that a catcher reflects towards the camera: as it is, and if nothing stood in the way.
pub(crate) fn reflected(
    scene: &Scene,
    vertex: &SurfaceVertex,
    presence: &Presence,
    random: &mut Random,
) -> [f32; 2] {
    let mut sums = [0.0; 2];
    let mut add = |[lit, unlit]: [DVec3; 2]| {
        sums[0] += cie::luminance(lit);
        sums[1] += cie::luminance(unlit);
    };
    if let Some((number, probability)) = scene.choose_light(vertex.position(), random.f64())
        && !matches!(scene.lights[number], Light::Volume(_))
    {
        let sample = scene.lights[number].sample(vertex.position(), [random.f64(), random.f64()]);
        let weight = if scene.lights[number].is_infinite() {
            let light_pdf = probability * sample.pdf;
            light_pdf / (light_pdf + vertex.pdf(sample.toward))
        } else {
            1.0
        };
        let unlit =
            vertex.value(sample.toward).truncate() * sample.radiance_over_pdf * (weight / probability);
        let seen = transmittance(scene, vertex, presence, sample.toward, sample.distance, random);
        add([unlit * seen, unlit]);
    }
    if let Some(onward) = vertex.sample(random) {
        let turned = onward.pdf.map(|pdf| (vertex.position(), pdf));
        let unlit = onward.weight.truncate() * surroundings(scene, onward.direction, turned);
        let seen = transmittance(scene, vertex, presence, onward.direction, f64::INFINITY, random);
        add([unlit * seen, unlit]);
    }
    sums.map(|sum| sum as f32)
}

/// What of the light from `toward` gets through; chromatic media count with their mean extinction.
fn transmittance(
    scene: &Scene,
    vertex: &SurfaceVertex,
    presence: &Presence,
    toward: DVec3,
    distance: f64,
    random: &mut Random,
) -> f64 {
    let (ray, presence) = vertex.leave(scene, toward, presence);
    let Some(way) = Way::connect(scene, &ray, distance, &presence, random) else { return 0.0 };
    Estimators::default().transmittance(scene, &ray, &way, random)
}
