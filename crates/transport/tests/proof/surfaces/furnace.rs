//! Furnaces with surfaces: where everything is in equilibrium with radiance 1, nothing can be told from anything else.
//!
//! White: in surroundings of radiance 1, bodies that absorb nothing. Without next-event estimation each path carries exactly
//! 1, by the reference and the fast engine.
//!
//! Glowing (Kirchhoff's law): inside a closed unlit box whatever absorbs the fraction a of what arrives sends out a: walls of
//! reflectance ρ have Le = 1 − ρ, media have Le = 1 wherever they absorb. Then L = 1. Inside of glass it is n² instead, as
//! L/n² is what refraction keeps.

use glam::DVec3;
use tyndall_film::Film;
use tyndall_scene::Scene;
use tyndall_scene::description::Integrator;

use super::{MATERIALS, effort, for_all_integrators};
use crate::rendering::render;
use crate::scenes::{scene, scene_in, with_next_event, write_random_npy};
use crate::statistics::two_sided_quantile;

/// Columns and rows of the pictures, and the edge of the regions that are looked at one by one.
const EDGE: u32 = 20;
const REGION: u32 = 5;

/// Thin fog around the bodies. (In fog without end no path would.)
const THIN_FOG: &str = r#"
    [[volume]]
    name = "air"
    sphere = { center = [0, 0, 0], radius = 2 }
    mu_t = 0.1
    albedo = 1
    phase = { type = "hg", g = 0.6 }
    "#;

/// Bodies that absorb nothing, near the origin.
const WHITE_BODIES: [(&str, &str); 7] = [
    (
        "matt shapes of all kinds on a plane",
        r#"
        [[shape]]
        plane = { point = [0, -0.8, 0], normal = [0, 1, 0] }
        material = "white"
        [[shape]]
        sphere = { center = [-0.6, 0.2, 0], radius = 0.5 }
        material = "white"
        [[shape]]
        box = { min = [0, -0.8, -0.5], max = [0.6, -0.2, 0.3] }
        transform = { rotate = [0, 25, 0] }
        material = "white"
        [[shape]]
        mesh = { vertices = [[0.2, 0, 0], [0.9, 0, 0.2], [0.5, 0, -0.5], [0.5, 0.9, 0]], triangles = [[0, 1, 3], [1, 2, 3], [2, 0, 3], [0, 2, 1]] }
        material = "white"
        [[shape]]
        disc = { center = [-0.5, 0.9, 0], normal = [0.2, 1, 0.4], radius = 0.4, inner_radius = 0.1 }
        material = "white"
        [[shape]]
        cylinder = { from = [-0.2, -0.7, 0.6], to = [0.1, -0.4, 0.9], radius = 0.2, capped = true }
        material = "white"
        [[shape]]
        rectangle = { corner = [-1.4, -0.8, -0.8], u = [0.9, 0, 0], v = [0, 1, 0.2] }
        material = "white"
        "#,
    ),
    (
        "glass bodies",
        r#"
        [[shape]]
        sphere = { center = [-0.5, 0, 0], radius = 0.7 }
        material = "glass"
        [[shape]]
        box = { min = [0.2, -0.6, -0.5], max = [0.9, 0.5, 0.3] }
        transform = { rotate = [10, 25, 5] }
        material = "glass"
        "#,
    ),
    (
        "panes, mirrors and lattices",
        r#"
        [[shape]]
        rectangle = { corner = [-1, -0.9, 0.6], u = [1.6, 0, 0.3], v = [0, 1.5, 0] }
        material = "pane"
        [[shape]]
        sphere = { center = [-0.4, 0.1, -0.6], radius = 0.6 }
        material = "mirror"
        [[shape]]
        disc = { center = [0.7, 0.1, -0.5], normal = [-0.4, 0, 1], radius = 0.6 }
        material = "lattice"
        [[shape]]
        plane = { point = [0, 0, -1.5], normal = [0, 0, 1] }
        material = "white"
        "#,
    ),
    (
        "a medium in a ball that is no surface, over a floor",
        r#"
        [[volume]]
        name = "smoke"
        mu_t = 4
        albedo = 1
        phase = { type = "hg", g = 0.5 }
        [[shape]]
        sphere = { center = [0, 0.1, 0], radius = 0.8 }
        material = "none"
        interior = "smoke"
        exterior = "air"
        [[shape]]
        plane = { point = [0, -0.8, 0], normal = [0, 1, 0] }
        material = "white"
        "#,
    ),
    (
        "glass filled with a medium",
        r#"
        [[volume]]
        name = "milk"
        mu_t = 3
        albedo = 1
        [[shape]]
        sphere = { center = [-0.4, 0, 0], radius = 0.7 }
        material = "glass"
        interior = "milk"
        exterior = "air"
        [[shape]]
        box = { min = [0.4, -0.6, -0.5], max = [1, 0.5, 0.3] }
        material = "glass"
        interior = "milk"
        exterior = "air"
        "#,
    ),
    (
        "overlapping and nested volumes",
        r#"
        [[volume]]
        name = "thin"
        mu_t = 1
        albedo = 1
        phase = { type = "hg", g = -0.4 }
        [[volume]]
        name = "thick"
        mu_t = 6
        albedo = 1
        phase = { type = "hg", g = 0.8 }
        [[volume]]
        name = "free"
        sphere = { center = [0.6, 0.6, 0], radius = 0.5 }
        mu_t = 2
        albedo = 1
        [[shape]]
        sphere = { center = [-0.4, 0, 0], radius = 0.7 }
        material = "none"
        interior = "thin"
        [[shape]]
        sphere = { center = [0.3, 0, 0.2], radius = 0.6 }
        material = "none"
        interior = ["thin", "thick"]
        [[shape]]
        sphere = { center = [-0.5, 0, 0.1], radius = 0.35 }
        material = "glass"
        interior = "thick"
        exterior = "thin"
        [[shape]]
        sphere = { center = [0.4, 0.1, 0.3], radius = 0.25 }
        material = "white"
        "#,
    ),
    (
        "a cloud that fills a box of glass",
        r#"
        [[volume]]
        name = "cloud"
        file = "random.npy"
        mu_t = 8
        albedo = 1
        transform = { scale = 0.15, translate = [-0.9, -0.9, -0.9] }
        [[shape]]
        box = { min = [-0.7, -0.6, -0.5], max = [0.6, 0.5, 0.6] }
        transform = { rotate = [10, 25, 5] }
        material = "glass"
        interior = "cloud"
        "#,
    ),
];

fn white_furnace(bodies: &str, fog: &str) -> Scene {
    let folder = tempfile::tempdir().expect("a folder for test files");
    write_random_npy(&folder.path().join("random.npy"), [12, 12, 12], 5);
    let text = format!(
        "camera = {{ position = [0.2, 0.4, 4], target = [0, 0, 0], vertical_fov = 36 }}
         film = {{ resolution = [{EDGE}, {EDGE}] }}
         {fog}
         [[light]]
         type = \"constant\"
         radiance = 1
         {MATERIALS} {bodies}"
    );
    scene_in(folder.path(), &text)
}

#[test]
fn every_path_among_white_bodies_brings_the_light_of_its_surroundings() {
    for (name, bodies) in WHITE_BODIES {
        // Where there is no fog nothing is said of it.
        let bodies = bodies.replace("exterior = \"air\"", "");
        let scene = white_furnace(&bodies, "");
        assert_eq!(scene.light_probabilities, [0.0], "constant light needs no next-event estimation");
        for integrator in [Integrator::Reference, Integrator::Fast] {
            let film = render(&scene, integrator, 1, 0..8 * effort());
            for (x, y) in (0..EDGE * EDGE).map(|i| (i % EDGE, i / EDGE)) {
                for channel in film.mean(x, y) {
                    assert!((channel - 1.0).abs() < 1e-4, "{name}, {integrator:?}: {channel} at {x}, {y}");
                }
            }
            let hits = film.channels().into_iter().find(|channel| channel.name == "A");
            let hits = hits.map_or(0.0, |channel| channel.values.iter().sum::<f32>());
            assert!(hits > 40.0, "{name}: the camera misses the bodies");
        }
    }
}

/// Every region of every channel and the means of the picture are within their standard errors of 1, at a level of 1e-4 for
/// the picture, and the standard error says something. Gives the greatest |z|.
fn assert_one(name: &str, film: &Film, greatest_error: f64) {
    let per_row = EDGE / REGION;
    let limit = two_sided_quantile(1e-4 / f64::from(3 * (per_row * per_row + 1)));
    for region in 0..per_row * per_row {
        let (left, top) = (region % per_row * REGION, region / per_row * REGION);
        let (mut sums, mut variances) = ([0.0; 3], [0.0; 3]);
        for (x, y) in (0..REGION * REGION).map(|i| (left + i % REGION, top + i / REGION)) {
            let (mean, error) = (film.mean(x, y), film.standard_error(x, y));
            for c in 0..3 {
                sums[c] += mean[c] - 1.0;
                variances[c] += error[c].powi(2);
            }
        }
        for (sum, variance) in sums.into_iter().zip(variances) {
            // Where nothing is drawn there is no error; f32 rounds in the sixth place.
            assert!(
                sum.abs() < limit * variance.sqrt() + 1e-3,
                "{name}: the region at {left}, {top} is off by {sum} +- {}, z = {}",
                variance.sqrt(),
                sum / variance.sqrt()
            );
        }
    }
    let means = film.image_mean();
    eprintln!("{name}: {:.4} +- {:.4}", means[0].mean, means[0].standard_error);
    for mean in means {
        let z = (mean.mean - 1.0) / mean.standard_error;
        assert!(z.abs() < limit, "{name}: the mean is {mean:?}, z = {z}");
        assert!(mean.standard_error < greatest_error, "{name}: {mean:?} says nothing");
    }
}

/// In thin fog, so that there is something for the spectral integrator everywhere. Its weights vary from path to path.
#[test]
fn next_event_estimation_keeps_white_bodies_in_fog_white() {
    for (number, (name, bodies)) in WHITE_BODIES.into_iter().enumerate() {
        let scene = with_next_event(white_furnace(bodies, THIN_FOG), &[1.0]);
        for (integrator, scene, kind) in for_all_integrators(&scene, DVec3::new(0.5, 2.0, 1.0)) {
            let film = render(&scene, kind, 100 + number as u64, 0..32 * effort());
            assert_one(&format!("{name}, {integrator}"), &film, 0.02);
        }
    }
}

#[test]
fn paths_alone_keep_white_bodies_in_chromatic_fog_white() {
    for (number, (name, bodies)) in WHITE_BODIES.into_iter().enumerate() {
        let scene = white_furnace(bodies, THIN_FOG);
        let [_, _, (_, spectral, kind)] = for_all_integrators(&scene, DVec3::new(0.5, 2.0, 1.0));
        let film = render(&spectral, kind, 200 + number as u64, 0..32 * effort());
        assert_one(&format!("{name}, spectral"), &film, 0.02);
    }
}

/// Plastic of a white base lets out all that it lets in, which the lobes' probabilities need not show path by path.
#[test]
fn white_plastic_is_white() {
    for nonlinear in [false, true] {
        let body = format!(
            r#"
            [[shape]]
            sphere = {{ center = [0, 0, 0], radius = 0.9 }}
            material = {{ type = "plastic", reflectance = 1, index = 1.5, nonlinear = {nonlinear} }}
            "#
        );
        for probability in [0.0, 1.0] {
            let scene = with_next_event(white_furnace(&body, THIN_FOG), &[probability]);
            for (integrator, scene, kind) in for_all_integrators(&scene, DVec3::ONE) {
                let film = render(&scene, kind, 300, 0..16 * effort());
                let name = format!("nonlinear {nonlinear}, next event {probability}, {integrator}");
                assert_one(&name, &film, 0.02);
            }
        }
    }
}

/// From the middle of a ball of glass, whose light is n² times as strong.
#[test]
fn inside_of_glass_light_is_stronger_by_the_square_of_its_index() {
    let text = format!(
        "camera = {{ position = [0, 0, 0.3], target = [0, 0, 0], vertical_fov = 60 }}
         film = {{ resolution = [{EDGE}, {EDGE}] }}
         [[light]]
         type = \"constant\"
         radiance = 1
         {MATERIALS}
         [[volume]]
         name = \"milk\"
         mu_t = 0.5
         albedo = 1
         [[shape]]
         sphere = {{ center = [0, 0, 0], radius = 1 }}
         material = \"glass\"
         interior = \"milk\""
    );
    for (integrator, scene, kind) in for_all_integrators(&scene(&text), DVec3::ONE) {
        let film = render(&scene, kind, 1, 0..8);
        for (x, y) in (0..EDGE * EDGE).map(|i| (i % EDGE, i / EDGE)) {
            for channel in film.mean(x, y) {
                assert!((channel / 2.25 - 1.0).abs() < 1e-4, "{integrator}: {channel} at {x}, {y}");
            }
        }
    }
}

/// What stands in the glowing room: everything in equilibrium with radiance 1.
const GLOWING_BODIES: [(&str, &str); 4] = [
    ("an empty room of fog", ""),
    (
        "matt lamps and a mirror",
        r#"
        [[shape]]
        sphere = { center = [-0.4, -0.2, 0], radius = 0.4 }
        material = { type = "diffuse", reflectance = [0.2, 0.6, 0.9] }
        emission = { radiance = [0.8, 0.4, 0.1] }
        [[shape]]
        mesh = { vertices = [[0.2, -0.6, 0], [0.8, -0.6, 0.2], [0.5, -0.6, -0.5], [0.5, 0.4, 0]], triangles = [[0, 1, 3], [1, 2, 3], [2, 0, 3], [0, 2, 1]] }
        material = "grey"
        emission = { radiance = 0.5, two_sided = true }
        [[shape]]
        disc = { center = [0, 0.6, -0.3], normal = [0.2, -1, 0.4], radius = 0.3 }
        material = "mirror"
        [[shape]]
        sphere = { center = [0.1, 0.1, 0.3], radius = 0.15 }
        material = "glass"
        "#,
    ),
    (
        "media that glow",
        r#"
        [[volume]]
        sphere = { center = [-0.4, 0, 0], radius = 0.5 }
        mu_t = 3
        albedo = [0.2, 0.5, 0.8]
        emission = 1
        phase = { type = "hg", g = 0.5 }
        [[volume]]
        box = { min = [0.1, -0.5, -0.4], max = [0.7, 0.4, 0.4] }
        mu_t = 2
        albedo = 0.25
        emission_per_length = 1.5
        [[volume]]
        name = "cloud"
        file = "random.npy"
        mu_t = 4
        albedo = [0.9, 0.5, 0.1]
        emission = 1
        transform = { scale = 0.08, translate = [-0.4, -0.8, -0.4] }
        [[volume]]
        name = "white"
        mu_t = 5
        albedo = 1
        [[shape]]
        sphere = { center = [0, 0.5, 0.1], radius = 0.3 }
        material = "none"
        interior = "white"
        "#,
    ),
    (
        "glass whose inside glows n squared times as much",
        r#"
        [[volume]]
        name = "embers"
        mu_t = 2
        albedo = 0.5
        emission = 2.25
        [[shape]]
        sphere = { center = [0, 0, 0], radius = 0.5 }
        material = "glass"
        interior = "embers"
        exterior = "medium"
        "#,
    ),
];

/// The camera is inside of a box whose walls glow.
fn glowing_furnace(bodies: &str) -> Scene {
    let folder = tempfile::tempdir().expect("a folder for test files");
    write_random_npy(&folder.path().join("random.npy"), [10, 10, 10], 6);
    let text = format!(
        "camera = {{ position = [0.2, 0.1, 0.9], target = [0, 0, 0], vertical_fov = 70 }}
         film = {{ resolution = [{EDGE}, {EDGE}] }}
         [medium]
         mu_t = 0.2
         albedo = [1, 0.8, 0.5]
         emission = 1
         {MATERIALS} {bodies}
         [[shape]]
         box = {{ min = [-1, -1, -1], max = [1, 1, 1] }}
         flip = true
         material = \"grey\"
         emission = {{ radiance = 0.5 }}"
    );
    scene_in(folder.path(), &text)
}

#[test]
fn everything_in_a_glowing_room_looks_the_same() {
    for (number, (name, bodies)) in GLOWING_BODIES.into_iter().enumerate() {
        let scene = glowing_furnace(bodies);
        assert!(!scene.lights.is_empty() && scene.light_probabilities.iter().sum::<f64>() > 0.99);
        let none = vec![0.0; scene.lights.len()];
        let alone = with_next_event(scene.clone(), &none);
        for (way, scene) in [("next event", scene), ("paths alone", alone)] {
            for (integrator, scene, kind) in for_all_integrators(&scene, DVec3::ONE) {
                let film = render(&scene, kind, 400 + number as u64, 0..24 * effort());
                assert_one(&format!("{name}, {way}, {integrator}"), &film, 0.02);
            }
        }
    }
}
