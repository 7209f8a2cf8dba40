//! A grid through which camera rays gather light on their way, or hide lights from a floor: the fast engine's pictures are those
//! of the reference, light, layers and all.
//!
//! The tests are those of [`crate::agreement`]: Welch's t by region and quantity, at a level of 1e-3 for each picture.

use crate::agreement::{HEAD, assert_same};
use crate::scenes::{scene_in, write_random_npy};
use tyndall_scene::Scene;
use tyndall_scene::description::Integrator;

/// A scene with a grid of so much extinction in a box from −0.8 to 0.8.
fn smoke(mu_t: f64, medium: &str, objects: &str) -> Scene {
    let folder = tempfile::tempdir().expect("a folder for test files");
    write_random_npy(&folder.path().join("random.npy"), [16, 16, 16], 61);
    let text = format!(
        r#"{HEAD}
        [[volume]]
        file = "random.npy"
        transform = {{ scale = 0.1, translate = [-0.8, -0.8, -0.8] }}
        mu_t = {mu_t}
        {medium}
        {objects}
        "#
    );
    scene_in(folder.path(), &text)
}

fn assert_integrators_agree(name: &str, scene: &Scene) {
    assert_same(name, (scene, Integrator::Reference), (scene, Integrator::Fast));
}

const FLOOR_AND_LAMPS: &str = r#"
    [[shape]]
    rectangle = { corner = [-2, -0.9, 2], u = [4, 0, 0], v = [0, 0, -4] }
    material = { type = "diffuse", reflectance = [0.8, 0.5, 0.3] }
    [[light]]
    type = "point"
    position = [1.5, 1.6, 0.5]
    intensity = [8, 7, 5]
    [[light]]
    type = "point"
    position = [-0.4, 0.9, -0.3]
    intensity = [2, 3, 6]
"#;

#[test]
fn glowing_smoke_under_a_sun_a_sky_and_a_lamp() {
    let mut smoke = smoke(
        1.5,
        r#"albedo = [0.9, 0.7, 0.5]
        phase = { type = "hg", g = 0.5 }
        emission = [0.2, 0.1, 0.05]"#,
        r#"
        [[light]]
        type = "sun"
        direction = [-1, -1, -0.5]
        irradiance = [3, 2.5, 2]
        angular_diameter = 12
        [[light]]
        type = "constant"
        radiance = [0.1, 0.2, 0.3]
        [[light]]
        type = "point"
        position = [1.2, 1.4, 1]
        intensity = [4, 5, 6]
        "#,
    );
    for max_depth in [Some(0), Some(1), None] {
        smoke.max_depth = max_depth;
        assert_integrators_agree(&format!("glowing smoke to depth {max_depth:?}"), &smoke);
    }
}

#[test]
fn smoke_over_a_floor_with_a_wall_before_a_lamp() {
    let wall = r#"
        [[shape]]
        rectangle = { corner = [0.9, -0.5, -0.5], u = [0, 1.2, 0], v = [0, 0, 1.2] }
        material = { type = "diffuse", reflectance = 0.4 }
    "#;
    let mut smoke = smoke(
        2.5,
        r#"albedo = [0.9, 0.7, 0.5]
        phase = { type = "hg", g = -0.3 }"#,
        &format!("{FLOOR_AND_LAMPS} {wall}"),
    );
    for max_depth in [Some(1), Some(2), None] {
        smoke.max_depth = max_depth;
        assert_integrators_agree(&format!("smoke over a floor to depth {max_depth:?}"), &smoke);
    }
}

/// Where roulette ends most of the shadow rays, the floor still looks at each of its lamps once.
#[test]
fn thick_smoke_over_a_floor_under_two_lamps() {
    let smoke = smoke(25.0, "albedo = 0.3", FLOOR_AND_LAMPS);
    assert_integrators_agree("thick smoke over a floor", &smoke);
}
