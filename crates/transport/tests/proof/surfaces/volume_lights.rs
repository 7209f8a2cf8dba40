//! Volumes that glow as lights: next-event estimation finds what paths find, and what a closed form says.

use std::f64::consts::PI;

use glam::DVec3;
use tyndall_scene::Light;
use tyndall_scene::description::Integrator;

use super::agreement::furnished;
use super::{assert_same_pictures, effort, for_all_integrators};
use crate::agreement::batches;
use crate::rendering::render;
use crate::scenes::{scene, with_next_event};
use crate::statistics::two_sided_quantile;

/// A glowing medium over a floor, whose light arrives directly or after being reflected once.
const GLOWING: [(&str, &str); 7] = [
    ("a ball by Le", "sphere = { center = [0, 0, 0], radius = 0.4 }\n mu_t = 3\n albedo = 0.2\n emission = [3, 2, 1]"),
    (
        "a box by length",
        "box = { min = [-0.5, -0.4, -0.3], max = [0.2, 0.1, 0.4] }\n mu_t = 1\n albedo = 0.5\n emission_per_length = [1, 2, 3]
         transform = { rotate = [10, 20, 30] }",
    ),
    (
        "a grid by Le",
        "file = \"random.npy\"\n mu_t = 4\n albedo = 0.3\n emission = [3, 2, 1]
         transform = { scale = [0.06, 0.08, 0.05], rotate = [0, 20, 0], translate = [-0.4, -0.5, -0.3] }",
    ),
    (
        "a grid by length",
        "file = \"random.npy\"\n mu_t = 2\n albedo = 0.3\n emission_per_length = [3, 2, 1]
         transform = { scale = 0.07, translate = [-0.4, -0.5, -0.3] }",
    ),
    (
        "a ball of many albedos",
        "sphere = { center = [5.5, 5.5, 5.5], radius = 6 }\n mu_t = 3\n albedo = 0.3\n emission = [3, 2, 1]
         albedo_grid = { file = \"random.npy\" }
         transform = { scale = 0.06, translate = [-0.4, -0.5, -0.3] }",
    ),
    (
        "a box of flames that would reach beyond it",
        "box = { min = [3, 4, 3], max = [9, 8, 8] }\n mu_t = 3\n albedo = 0.3\n emission = [3, 2, 1]
         emission_grid = { file = \"random.npy\" }
         transform = { scale = 0.09, translate = [-0.6, -0.7, -0.5] }",
    ),
    (
        "a box that is there only inside a ball",
        "box = { min = [-0.5, -0.5, -0.5], max = [0.5, 0.5, 0.5] }\n name = \"cut\"\n mu_t = 2\n albedo = 0.3\n emission = [3, 2, 1]
         [[shape]]
         sphere = { center = [0.2, 0, 0], radius = 0.5 }
         material = \"none\"
         interior = \"cut\"",
    ),
];

#[test]
fn light_from_glowing_media_is_the_same_with_and_without_next_event_estimation() {
    for (name, volume) in GLOWING {
        let mut scene = furnished(
            "{ position = [0.3, 2.4, 2.6], target = [0.1, -0.5, 0], vertical_fov = 34 }",
            &format!(
                "[[volume]]\n {volume}
                 [[shape]]
                 plane = {{ point = [0, -0.8, 0], normal = [0, 1, 0] }}
                 material = \"chequered\"
                 [[shape]]
                 sphere = {{ center = [0.7, -0.4, 0.2], radius = 0.3 }}
                 material = \"grey\""
            ),
        );
        scene.max_depth = Some(2);
        let alone = with_next_event(scene.clone(), &vec![0.0; scene.lights.len()]);
        let without = batches(&alone, Integrator::Reference, 41, 12 * effort());
        for (number, (integrator, scene, kind)) in
            for_all_integrators(&scene, DVec3::ONE).into_iter().enumerate()
        {
            let with = batches(&scene, kind, 42 + number as u64, 12 * effort());
            let name = format!("{name}, {integrator} with next event against reference without");
            assert_same_pictures(&name, [Integrator::Reference, kind], &[without.clone(), with]);
        }
    }
}

/// A thin ball that adds ε per length sends out 4π ε in all directions per volume. Seen from outside it might be a point in
/// its middle (the flux falls as gravity does), so that a floor at the distance d below has the irradiance
///
///   E = ε V cos θ / d²,   V = 4/3 π R³,   L = ρ E/π.
///
/// The camera looks at one place of the floor, past the ball.
#[test]
fn a_thin_glowing_ball_lights_a_floor_as_a_point_in_its_middle_would() {
    let (radius, height, aside) = (0.7_f64, 1.2_f64, 0.9_f64);
    let text = format!(
        "camera = {{ position = [{aside}, 0.6, 2], target = [{aside}, 0, 0], vertical_fov = 0.01 }}
         film = {{ resolution = [8, 8] }}
         [[volume]]
         sphere = {{ center = [0, {height}, 0], radius = {radius} }}
         mu_t = 1e-7
         albedo = 0
         emission_per_length = [1, 2, 0.5]
         [[shape]]
         plane = {{ point = [0, 0, 0], normal = [0, 1, 0] }}
         material = {{ type = \"diffuse\", reflectance = 0.6 }}"
    );
    let scene = scene(&text);
    assert!(scene.lights.iter().any(|light| matches!(light, Light::Volume(_))), "the ball is a light");
    let squared = height * height + aside * aside;
    let irradiance = 4.0 / 3.0 * PI * radius.powi(3) * height / squared.powf(1.5);
    let truth = DVec3::new(1.0, 2.0, 0.5) * irradiance * 0.6 / PI;
    let alone = with_next_event(scene.clone(), &vec![0.0; scene.lights.len()]);
    for (way, scene) in [("next event", scene), ("paths alone", alone)] {
        for (integrator, scene, kind) in for_all_integrators(&scene, DVec3::ONE) {
            let film = render(&scene, kind, 7, 0..512 * effort());
            for (channel, estimate) in film.image_mean().into_iter().enumerate() {
                let z = (estimate.mean - truth[channel]) / estimate.standard_error;
                eprintln!("{way}, {integrator}: {estimate:?} for {}, z = {z}", truth[channel]);
                assert!(z.abs() < two_sided_quantile(1e-3 / 18.0), "{way}, {integrator}: z = {z}");
                assert!(estimate.standard_error < 0.02 * truth[channel], "{way}, {integrator}: says nothing");
            }
        }
    }
}
