//! Phase functions in pictures: a white furnace of the kinds that the engines hand on to `tyndall-optics`, and layers of
//! oriented particles, whose extinction depends on direction, against closed forms.
//!
//! A layer from y = −1 to 0 seen along ω from above, under a distant light of irradiance E from the direction ω′, with
//! cosines c and c′ to the vertical, has
//!
//!   transmittance exp(−μt σ(ω)/c),   L₁ = α μt σ(ω) f(ω → ω′) E (1 − exp(−k/c))/k,   k = μt (σ(ω) + σ(ω′) c/c′)
//!
//! with SGGX's projected area σ; L₁ is the light that was scattered once.

use std::path::Path;

use glam::DVec3;
use tyndall_scene::Scene;

use crate::effort::is_full;
use crate::rendering::{BOTH, render};
use crate::scenes::{scene, scene_in, with_next_event, write_random_npy};
use crate::statistics::two_sided_quantile;

/// Level of each test of this file, shared out among its cases.
const LEVEL: f64 = 1e-3;

const FIBRES: &str = r#"{ type = "sggx", kind = "fibre", roughness = 0.35, axis = [1, 0.6, -0.4] }"#;
const FLAKES: &str = r#"{ type = "sggx", kind = "surface", roughness = 0.3, axis = [0.2, 1, 0] }"#;

/// Ten times the samples under `TYNDALL_PROOF=full`.
fn samples(few: u64) -> u64 {
    if is_full() { 10 * few } else { few }
}

fn furnaces(folder: &Path, phase: &str) -> [Scene; 2] {
    let head = "camera = { position = [0, 0, 3], target = [0, 0, 0], vertical_fov = 40 }
        film = { resolution = [16, 16] }
        [[light]]
        type = \"constant\"
        radiance = 1
        [[volume]]
        albedo = 1\n";
    let sphere = "sphere = { center = [0, 0, 0], radius = 1 }\n mu_t = 5";
    let grid = "file = \"random.npy\"\n mu_t = 10
        transform = { scale = [0.1, 0.16, 0.07], rotate = [20, 35, -50], translate = [-0.6, -0.7, 0.4] }";
    [sphere, grid].map(|volume| scene_in(folder, &format!("{head}{volume}\nphase = {phase}")))
}

/// With next-event estimation, shadow rays and paths must see the same extinction, and samples the density's value.
#[test]
fn white_media_of_every_phase_function_look_white() {
    let folder = tempfile::tempdir().expect("a folder for test files");
    write_random_npy(&folder.path().join("random.npy"), [12, 9, 14], 5);
    std::fs::write(folder.path().join("table.txt"), "0 40\n10 4\n90 0.2\n140 1\n180 0.5\n").expect("written");
    let phases = [
        FIBRES,
        FLAKES,
        r#"{ type = "fog", droplet_diameter_um = 3 }"#,
        r#"{ type = "rayleigh" }"#,
        r#"{ type = "schlick", k = 0.7 }"#,
        r#"{ type = "tabulated", file = "table.txt" }"#,
    ];
    let limit = two_sided_quantile(LEVEL / (phases.len() * 4) as f64);
    for (number, phase) in phases.iter().enumerate() {
        for scene in furnaces(folder.path(), phase) {
            let scene = with_next_event(scene, &[1.0]);
            for integrator in BOTH {
                let film = render(&scene, integrator, 40 + number as u64, 0..samples(48));
                let [mean, ..] = film.image_mean();
                let z = (mean.mean - 1.0) / mean.standard_error;
                assert!(z.abs() < limit, "{phase}, {integrator:?}: {mean:?}, z = {z}");
                assert!(mean.standard_error < 0.02, "{phase}, {integrator:?}: {mean:?} says nothing");
            }
        }
    }
}

const MU_T: f64 = 0.8;
const ALBEDO: f64 = 0.9;

/// The layer, seen along `view` under light from `toward`; without a light if that is none.
fn layer(phase: &str, view: DVec3, toward: Option<DVec3>) -> Scene {
    let position = -5.0 * view;
    let light = toward.map_or(String::new(), |toward| {
        format!("[[light]]\ntype = \"distant\"\ndirection = {:?}\nirradiance = 1\n", (-toward).to_array())
    });
    scene(&format!(
        "camera = {{ position = {:?}, target = [0, 0, 0], up = [0, 0, 1], vertical_fov = 0.01 }}
         film = {{ resolution = [16, 16] }}
         render = {{ max_depth = 1 }}
         [[volume]]
         slab = {{ bottom = -1, top = 0 }}
         mu_t = {MU_T}
         albedo = {ALBEDO}
         phase = {phase}
         {light}",
        position.to_array()
    ))
}

fn views() -> [DVec3; 3] {
    [DVec3::new(0.1, -1.0, 0.0), DVec3::new(1.0, -1.0, -0.5), DVec3::new(-0.3, -0.5, 0.8)]
        .map(DVec3::normalize)
}

#[test]
fn layers_of_oriented_particles_let_through_what_their_area_leaves() {
    let limit = two_sided_quantile(LEVEL / 12.0);
    for phase in [FIBRES, FLAKES] {
        for view in views() {
            let scene = layer(phase, view, None);
            let area = scene.volumes[0].medium.phase_function.projected_area(view);
            let expected = (-MU_T * area / -view.y).exp();
            for integrator in BOTH {
                let film = render(&scene, integrator, 50, 0..samples(200));
                let n = 256.0 * samples(200) as f64;
                let channel = film.channels().into_iter().find(|channel| channel.name == "A");
                let coverage = channel.expect("coverage is always kept");
                let through = 1.0 - coverage.values.iter().map(|a| f64::from(*a)).sum::<f64>() / 256.0;
                let z = (through - expected) / (expected * (1.0 - expected) / n).sqrt();
                assert!(
                    z.abs() < limit,
                    "{phase}, {view}, {integrator:?}: {through}, not {expected}, z = {z}"
                );
            }
        }
    }
}

#[test]
fn light_scattered_once_by_oriented_particles_has_its_closed_form() {
    let limit = two_sided_quantile(LEVEL / 12.0);
    let toward = DVec3::new(0.5, 0.7, 0.4).normalize();
    for phase in [FIBRES, FLAKES] {
        for view in views() {
            let scene = layer(phase, view, Some(toward));
            let function = &scene.volumes[0].medium.phase_function;
            let [area, area_to_light] = [view, toward].map(|direction| function.projected_area(direction));
            let k = MU_T * (area + area_to_light * -view.y / toward.y);
            let source = ALBEDO * MU_T * area * function.value(view, toward);
            let expected = source * (1.0 - (-k / -view.y).exp()) / k;
            for integrator in BOTH {
                let [mean, ..] = render(&scene, integrator, 51, 0..samples(200)).image_mean();
                let z = (mean.mean - expected) / mean.standard_error;
                assert!(
                    z.abs() < limit,
                    "{phase}, {view}, {integrator:?}: {mean:?}, not {expected}, z = {z}"
                );
                assert!(mean.standard_error < 0.05 * expected, "{phase}, {view}: {mean:?} says nothing");
            }
        }
    }
}
