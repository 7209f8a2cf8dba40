//! Scenes of one homogeneous medium, or none, which the fast integrator traces with light along every ray, have the
//! reference integrator's pictures: lamps of all kinds in, beside and outside of the fog, thin and thick.

use tyndall_scene::Scene;
use tyndall_scene::description::Integrator;
use tyndall_transport::{DistanceSampler, Estimators, RenderOptions};

use super::agreement::furnished;
use super::{assert_same_pictures, effort};
use crate::agreement::batches_with;
use crate::rendering::{options, render};

/// Independent films of each integrator.
const BATCHES: u64 = 16;

fn assert_agree(name: &str, scene: Scene) {
    assert_agree_with(name, scene, Estimators::default());
}

/// The same with these estimators of the reference integrator.
fn assert_agree_with(name: &str, mut scene: Scene, estimators: Estimators) {
    for max_depth in [Some(1), None] {
        scene.max_depth = max_depth;
        assert!(scene.light_tree.is_none(), "{name}: so many lights are left to the pool");
        let kinds = [Integrator::Reference, Integrator::Fast];
        let reference = RenderOptions { estimators, ..options(kinds[0], 91) };
        let pair = [reference, options(kinds[1], 92)]
            .map(|options| batches_with(&scene, options, BATCHES * effort()));
        assert_same_pictures(&format!("{name} to depth {max_depth:?}"), kinds, &pair);
    }
}

const CAMERA: &str = "{ position = [0.2, 0.1, 1.9], target = [0, 0, 0], vertical_fov = 55 }";

/// A closed room of grey walls.
const WALLS: &str = r#"
    [[shape]]
    box = { min = [-1, -1, -1], max = [1, 1, 2] }
    flip = true
    material = "grey"
    "#;

/// A room of thin fog with a lamp under its ceiling.
pub fn lamp_in_fog() -> Scene {
    let lamp = r#"
        [medium]
        mu_t = 0.4
        albedo = [0.95, 0.9, 0.7]
        phase = { type = "hg", g = 0.3 }
        [[shape]]
        rectangle = { corner = [-0.25, 0.95, -0.25], u = [0.5, 0, 0], v = [0, 0, 0.5] }
        material = "grey"
        emission = { radiance = [6, 5, 3] }
        [[shape]]
        rectangle = { corner = [-1, -0.6, -0.5], u = [0.8, 0, 0], v = [0, 0.7, 0.2] }
        material = "chequered"
        "#;
    furnished(CAMERA, &format!("{WALLS}{lamp}"))
}

#[test]
fn a_room_of_thin_fog_under_a_lamp() {
    assert_agree("a lamp in fog", lamp_in_fog());
}

/// One lamp is in the fog, another, a mesh, outside of it.
#[test]
fn a_ball_of_thick_fog_among_lamps() {
    let objects = r#"
        [[volume]]
        sphere = { center = [-0.1, -0.1, 0], radius = 0.8 }
        mu_t = 5
        albedo = [0.9, 0.95, 0.8]
        phase = { type = "rayleigh" }
        [[light]]
        type = "constant"
        radiance = 0.1
        [[shape]]
        sphere = { center = [-0.2, 0.1, 0.2], radius = 0.1 }
        material = "grey"
        emission = { radiance = [4, 3, 8] }
        [[shape]]
        plane = { point = [0, -0.6, 0], normal = [0, 1, 0] }
        material = { type = "plastic", reflectance = [0.6, 0.4, 0.2], roughness = 0.2 }
        [[shape]]
        mesh = { vertices = [[0.6, -0.5, 0.6], [0.9, -0.5, 0.8], [0.8, -0.5, 0.3], [0.8, 0, 0.6]], triangles = [[0, 1, 3], [1, 2, 3], [2, 0, 3], [0, 2, 1]] }
        material = "grey"
        emission = { radiance = [2, 1, 1] }
        [[shape]]
        sphere = { center = [0.5, 0.3, 0], radius = 0.3 }
        material = "glass"
        "#;
    assert_agree("a ball of fog", furnished(CAMERA, objects));
}

#[test]
fn thin_fog_around_points_under_the_sun_and_a_room_without_fog() {
    let points = r#"
        [medium]
        mu_t = 0.7
        albedo = [0.9, 0.8, 0.95]
        [[light]]
        type = "point"
        position = [-0.3, 0.3, 0.4]
        intensity = [0.3, 0.5, 0.2]
        [[light]]
        type = "spot"
        position = [0.9, 0.9, 0.5]
        direction = [-1, -1, -0.5]
        intensity = [2, 1, 3]
        angle = 30
        inner_angle = 15
        [[light]]
        type = "distant"
        direction = [-1, -1, -0.4]
        irradiance = [0.5, 0.3, 0.1]
        [[shape]]
        rectangle = { corner = [-0.8, -0.5, 0.8], u = [1.6, 0, 0], v = [0, 0, -1.6] }
        material = "chequered"
        "#;
    // At collisions alone light of points in the fog has no finite variance, and no t test holds.
    let equiangular = Estimators { distance: Some(DistanceSampler::Equiangular), ..Estimators::default() };
    assert_agree_with("points in fog", furnished(CAMERA, points), equiangular);
    let clear = r#"
        [[light]]
        type = "point"
        position = [-0.3, 0.3, 0.4]
        intensity = [0.3, 0.5, 0.2]
        [[shape]]
        sphere = { center = [0.4, 0.3, 0.2], radius = 0.3 }
        material = "grey"
        emission = { radiance = [1, 2, 3] }
        [[shape]]
        sphere = { center = [-0.4, -0.4, 0.1], radius = 0.4 }
        material = "mirror"
        "#;
    assert_agree("no fog", furnished(CAMERA, &format!("{WALLS}{clear}")));
}

/// A shining plane has no end, and a deformed sphere no known area: only paths find their light.
#[test]
fn lamps_that_cannot_be_drawn_are_found_by_paths() {
    let lamps = r#"
        [[shape]]
        plane = { point = [0, -1.5, 0], normal = [0, 1, 0] }
        material = "grey"
        emission = { radiance = [0.4, 0.5, 0.3] }
        [[shape]]
        sphere = { center = [0, 0, 0], radius = 0.4 }
        transform = { scale = [1, 1.5, 1] }
        material = "grey"
        emission = { radiance = [1, 2, 3] }
        "#;
    let fog = r#"
        [medium]
        mu_t = 0.6
        albedo = [0.9, 0.8, 0.95]
        "#;
    for (name, fog) in [("lamps without area in fog", fog), ("lamps without area", "")] {
        let scene = furnished(CAMERA, &format!("{fog}{lamps}"));
        assert_eq!(render(&scene, Integrator::Fast, 93, 0..16).rejected(), 0, "{name}");
        assert_agree(name, scene);
    }
}
