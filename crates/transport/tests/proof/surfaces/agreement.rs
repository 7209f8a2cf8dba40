//! The three integrators estimate the same pictures of scenes that have everything: light, layers and all.
//!
//! The tests are those of [`crate::agreement`]: Welch's t by region and quantity, at a level of 1e-3 for each picture.

use std::path::Path;

use glam::DVec3;
use tyndall_scene::Scene;
use tyndall_scene::description::Integrator;

use super::{MATERIALS, assert_same_pictures, effort, for_all_integrators};
use crate::agreement::batches;
use crate::scenes::{scene_in, write_random_npy};

/// Independent films of each integrator.
const BATCHES: u64 = 16;

/// A scene with a grid in a file, seen along -z.
pub fn furnished(camera: &str, objects: &str) -> Scene {
    let folder = tempfile::tempdir().expect("a folder for test files");
    write_random_npy(&folder.path().join("random.npy"), [12, 12, 12], 31);
    scene_among(folder.path(), camera, objects)
}

fn scene_among(folder: &Path, camera: &str, objects: &str) -> Scene {
    let text = format!("camera = {camera}\n film = {{ resolution = [24, 24] }}\n {objects} {MATERIALS}");
    scene_in(folder, &text)
}

fn assert_all_agree(name: &str, scene: &Scene) {
    let all = for_all_integrators(scene, DVec3::ONE);
    let [reference, fast, spectral] = [0, 1, 2].map(|i| {
        let (_, scene, integrator) = &all[i];
        batches(scene, *integrator, 71 + i as u64, BATCHES * effort())
    });
    for (other, batches) in [("fast", fast), ("spectral", spectral)] {
        let kinds = [Integrator::Reference, Integrator::Fast];
        assert_same_pictures(&format!("{name}, reference and {other}"), kinds, &[reference.clone(), batches]);
    }
}

const DEPTHS: [Option<u32>; 2] = [Some(2), None];

/// A room of fog with a lamp in its ceiling, a spot, a mirror, a glass of milk and a ball of smoke; the camera is in the
/// fog.
pub fn room() -> Scene {
    furnished(
        "{ position = [0.3, 0.2, 1.8], target = [0, -0.1, 0], vertical_fov = 60 }",
        r#"
        [medium]
        mu_t = 0.15
        albedo = [0.9, 0.8, 0.7]
        phase = { type = "hg", g = 0.4 }
        [[volume]]
        name = "milk"
        mu_t = 6
        albedo = [0.99, 0.95, 0.9]
        [[volume]]
        name = "smoke"
        mu_t = 3
        albedo = 0.6
        phase = { type = "hg", g = 0.6 }
        [[light]]
        type = "spot"
        position = [-0.8, 0.7, 0.8]
        direction = [1, -1, -0.8]
        intensity = [2, 1, 3]
        angle = 30
        inner_angle = 15
        [[shape]]
        box = { min = [-1, -1, -2], max = [1, 1, 2] }
        flip = true
        material = "chequered"
        [[shape]]
        rectangle = { corner = [-0.3, 0.98, -0.3], u = [0.6, 0, 0], v = [0, 0, 0.6] }
        material = "grey"
        emission = { radiance = [4, 3.5, 3] }
        [[shape]]
        sphere = { center = [-0.5, -0.6, -0.4], radius = 0.4 }
        material = { type = "conductor", metal = "copper" }
        [[shape]]
        cylinder = { from = [0.5, -0.95, 0.1], to = [0.5, -0.3, 0.1], radius = 0.3, capped = true }
        material = "glass"
        interior = "milk"
        exterior = "medium"
        [[shape]]
        sphere = { center = [-0.1, 0.2, -0.2], radius = 0.4 }
        material = "none"
        interior = "smoke"
        exterior = "medium"
        "#,
    )
}

#[test]
fn a_foggy_room_with_lamps_mirrors_and_milk() {
    let mut room = room();
    for max_depth in DEPTHS {
        room.max_depth = max_depth;
        assert_all_agree(&format!("room to depth {max_depth:?}"), &room);
    }
}

#[test]
fn fire_and_embers_over_a_floor() {
    let fire = furnished(
        "{ position = [0.3, 0.6, 3.6], target = [0, -0.1, 0], vertical_fov = 38 }",
        r#"
        [[volume]]
        file = "random.npy"
        mu_t = 3
        albedo = 0.4
        emission = [3, 1.5, 0.4]
        transform = { scale = 0.07, rotate = [0, 30, 0], translate = [-0.4, -0.7, -0.3] }
        [[volume]]
        sphere = { center = [0.6, -0.3, 0.1], radius = 0.3 }
        mu_t = 1
        albedo = 0.5
        emission_per_length = [0.5, 0.8, 2]
        [[volume]]
        name = "embers"
        mu_t = 2
        albedo = 0.3
        emission = [2, 0.5, 0.1]
        [[shape]]
        box = { min = [-1.1, -0.8, -0.2], max = [-0.7, -0.4, 0.2] }
        material = "none"
        interior = "embers"
        [[shape]]
        plane = { point = [0, -0.8, 0], normal = [0, 1, 0] }
        material = "chequered"
        [[shape]]
        mesh = { vertices = [[0.2, -0.7, 0.6], [0.7, -0.7, 0.8], [0.5, -0.7, 0.3], [0.5, -0.1, 0.6]], triangles = [[0, 1, 3], [1, 2, 3], [2, 0, 3], [0, 2, 1]] }
        material = "grey"
        emission = { radiance = [0.2, 0.5, 0.3] }
        [[shape]]
        rectangle = { corner = [-0.9, -0.8, 0.5], u = [0.8, 0, 0], v = [0, 0.9, 0] }
        material = "lattice"
        [[light]]
        type = "constant"
        radiance = 0.05
        "#,
    );
    assert_all_agree("fire", &fire);
}

/// Lights that are all looked at from the first surface by the fast integrator.
#[test]
fn smoke_over_a_floor_under_points_and_parallel_light() {
    let smoke = furnished(
        "{ position = [0.3, 0.6, 3.6], target = [0, -0.1, 0], vertical_fov = 38 }",
        r#"
        [[volume]]
        file = "random.npy"
        mu_t = 4
        albedo = [0.9, 0.8, 0.6]
        transform = { scale = 0.07, rotate = [0, 30, 0], translate = [-0.4, -0.7, -0.3] }
        [[shape]]
        plane = { point = [0, -0.8, 0], normal = [0, 1, 0] }
        material = "chequered"
        [[shape]]
        sphere = { center = [0.7, -0.3, 0.4], radius = 0.3 }
        material = { type = "plastic", reflectance = [0.2, 0.4, 0.8], roughness = 0.2 }
        [[light]]
        type = "point"
        position = [1, 0.8, 0.5]
        intensity = [0.8, 0.7, 0.5]
        [[light]]
        type = "spot"
        position = [-0.9, 0.9, 0.5]
        direction = [1, -1, -0.5]
        intensity = [0.4, 1, 2]
        angle = 40
        inner_angle = 15
        [[light]]
        type = "distant"
        direction = [-1, -1, -0.4]
        irradiance = [0.5, 0.3, 0.1]
        "#,
    );
    assert_all_agree("smoke over a floor", &smoke);
}

/// So many lamps that they are chosen by place.
#[test]
fn many_lamps_and_rough_materials_in_nested_volumes() {
    let mut objects = String::from(
        r#"
        [[volume]]
        name = "thin"
        mu_t = 0.5
        albedo = [0.9, 0.8, 0.6]
        phase = { type = "hg", g = 0.5 }
        [[volume]]
        name = "thick"
        mu_t = 3
        albedo = 0.9
        [[shape]]
        box = { min = [-1.2, -1, -1], max = [1.2, 1, 1.2] }
        material = "none"
        interior = "thin"
        [[shape]]
        sphere = { center = [0.1, 0.4, 0], radius = 0.4 }
        material = "none"
        interior = "thick"
        exterior = "thin"
        [[shape]]
        sphere = { center = [0.3, 0.5, 0.1], radius = 0.3 }
        material = "none"
        interior = "thick"
        [[shape]]
        plane = { point = [0, -0.9, 0], normal = [0, 1, 0] }
        material = { type = "rough_diffuse", reflectance = [0.7, 0.6, 0.5], sigma = 30 }
        [[shape]]
        sphere = { center = [-0.7, -0.4, 0.2], radius = 0.4 }
        material = { type = "dielectric", index = 1.5, roughness = 0.3 }
        exterior = "thin"
        [[shape]]
        sphere = { center = [0.1, -0.5, 0.5], radius = 0.35 }
        material = { type = "conductor", metal = "gold", roughness = [0.2, 0.4] }
        [[shape]]
        box = { min = [0.5, -0.9, -0.3], max = [1, -0.3, 0.3] }
        material = { type = "plastic", reflectance = [0.2, 0.4, 0.8], roughness = 0.2 }
        "#,
    );
    for i in 0..24 {
        let (sin, cos) = (f64::from(i) * 0.7).sin_cos();
        let (x, y, z) = (1.1 * cos, 0.07 * f64::from(i) - 0.85, 1.0 * sin - 0.3);
        objects += &match i % 3 {
            0 => format!(
                "[[light]]\n type = \"point\"\n position = [{x}, {y}, {z}]\n intensity = [0.1, 0.2, 0.1]\n"
            ),
            1 => format!(
                "[[shape]]\n sphere = {{ center = [{x}, {y}, {z}], radius = 0.05 }}\n material = \"grey\"\n emission = {{ radiance = [3, 2, 1] }}\n"
            ),
            _ => format!(
                "[[shape]]\n rectangle = {{ corner = [{x}, {y}, {z}], u = [0.2, 0, 0], v = [0, 0, 0.2] }}\n material = \"grey\"\n emission = {{ radiance = [1, 1, 2], two_sided = true }}\n"
            ),
        };
    }
    let lamps =
        furnished("{ position = [0.3, 0.3, 3.8], target = [0, -0.1, 0], vertical_fov = 36 }", &objects);
    assert!(lamps.light_tree.is_some(), "{} lights are few", lamps.lights.len());
    assert_all_agree("many lamps", &lamps);
}

#[test]
fn a_cloud_in_glass_and_bent_meshes_under_sun_and_sky() {
    let garden = furnished(
        "{ position = [0.3, 0.6, 3.6], target = [0, -0.1, 0], vertical_fov = 38, aperture_radius = 0.05 }",
        r#"
        [[volume]]
        name = "cloud"
        file = "random.npy"
        mu_t = 8
        albedo = [0.95, 0.9, 0.8]
        transform = { scale = 0.12, translate = [-1.1, -0.8, -0.6] }
        [[light]]
        type = "sky"
        sun_elevation = 40
        sun_azimuth = 250
        [[light]]
        type = "distant"
        direction = [-1, -1, -0.4]
        irradiance = [0.5, 0.3, 0.1]
        [[shape]]
        plane = { point = [0, -0.8, 0], normal = [0, 1, 0] }
        material = "chequered"
        [[shape]]
        box = { min = [-0.9, -0.7, -0.4], max = [0, 0.3, 0.4] }
        transform = { rotate = [0, 20, 0] }
        material = "glass"
        interior = "cloud"
        [[shape]]
        mesh = { vertices = [[-1, -1, 1], [1, -1, -1], [-1, 1, -1], [1, 1, 1]], triangles = [[0, 1, 3], [1, 2, 3], [2, 0, 3], [0, 2, 1]], normals = [[-1, -1, 1], [1, -1, -1], [-1, 1, -1], [1, 1, 1]] }
        transform = { scale = 0.3 }
        instances = [{ translate = [0.6, -0.4, 0] }, { rotate = [0, 40, 0], scale = [0.5, 1, 0.7], translate = [0.5, 0.4, -0.3] }]
        material = { type = "plastic", reflectance = [0.7, 0.3, 0.2] }
        [[shape]]
        rectangle = { corner = [0.2, -0.8, 0.7], u = [0.9, 0, 0], v = [0, 0.9, 0] }
        material = "pane"
        "#,
    );
    assert_all_agree("garden", &garden);
}

#[test]
fn from_inside_of_a_ball_of_foggy_glass() {
    let inside = furnished(
        "{ position = [0.1, 0.1, 0.5], target = [0, 0, -1], vertical_fov = 70 }",
        r#"
        [[volume]]
        name = "fog"
        mu_t = 0.7
        albedo = [0.9, 0.8, 0.95]
        phase = { type = "hg", g = 0.3 }
        [[shape]]
        sphere = { center = [0, 0, 0], radius = 1 }
        material = "glass"
        interior = "fog"
        [[shape]]
        sphere = { center = [0.3, -0.2, -0.3], radius = 0.25 }
        material = "none"
        exterior = "fog"
        [[shape]]
        plane = { point = [0, -1.3, 0], normal = [0, 1, 0] }
        material = "chequered"
        [[shape]]
        disc = { center = [-0.5, 1.5, -1], normal = [0.3, -1, 0.3], radius = 0.7 }
        material = "grey"
        emission = { radiance = [3, 2, 1] }
        [[light]]
        type = "point"
        position = [-0.3, 0.3, -0.4]
        intensity = [0.1, 0.3, 0.2]
        [[light]]
        type = "constant"
        radiance = 0.1
        "#,
    );
    assert_all_agree("inside of glass", &inside);
}
