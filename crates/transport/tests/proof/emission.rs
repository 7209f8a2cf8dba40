//! Media that shine of themselves: line integrals of emission, Kirchhoff's law in scattering slabs, black bodies.
//!
//! Each is asked with light given by absorption, μa·Le, and with the same light given per length. The truths,
//! `truth/emission.json` and, by Kirchhoff, `truth/slab_matched.json`, have no noise. For other seeds each test would fail once in
//! a thousand times: z-tests share that level by Bonferroni.

use std::path::Path;
use std::sync::Arc;

use glam::DVec3;
use tyndall_optics::{cie, planck};
use tyndall_scene::description::Integrator;
use tyndall_scene::{ChromaticMedium, Ray, Scene};
use tyndall_transport::{DistanceSampler, Estimators, trace, trace_with};

use crate::agreement::{HEAD, assert_same};
use crate::fresh;
use crate::rendering::{BOTH, render};
use crate::scenes::{scene, scene_in, write_npy, write_random_npy};
use crate::slab::rows;
use crate::statistics::{kolmogorov_smirnov, mean_and_error, normal_cdf, two_sided_quantile};

const PATHS: u64 = 4096;

fn table(name: &str) -> Vec<serde_json::Value> {
    let truth: serde_json::Value =
        serde_json::from_str(include_str!("../truth/emission.json")).expect("the table is JSON");
    truth[name].as_array().expect("rows").clone()
}

fn number(value: &serde_json::Value) -> f64 {
    value.as_f64().expect("a number")
}

/// Means that should be truths, to be judged together.
#[derive(Default)]
struct Claims {
    scores: Vec<(String, f64)>,
}

impl Claims {
    fn add(&mut self, name: String, (mean, error): (f64, f64), truth: f64) {
        // What f32 rounds, where there is next to no noise.
        let z = (mean - truth) / error.max(2e-6 * truth);
        self.scores.push((format!("{name}: {mean} +- {error}, not {truth}"), z));
    }

    /// Red of a scene's only pixel. Paths that none of these may happen to be, but each is with probability `rare` and brings
    /// up to 1, do not show in the standard error.
    fn add_picture(&mut self, name: &str, scene: &Scene, truth: f64, rare: f64) {
        let unseen = (rare * (1.0 - rare) / PATHS as f64).sqrt();
        for integrator in BOTH {
            let film = render(scene, integrator, 41 + self.scores.len() as u64, 0..PATHS);
            let error = film.standard_error(0, 0)[0];
            let result = (film.mean(0, 0)[0], if rare < 1e-2 { error.max(unseen) } else { error });
            self.add(format!("{name}, {integrator:?}"), result, truth);
        }
    }

    fn hold(&self) {
        let limit = two_sided_quantile(1e-3 / self.scores.len() as f64);
        for (name, z) in &self.scores {
            assert!(z.abs() < limit, "{name}, z = {z}");
        }
    }
}

/// Light of the source term `mu`, by absorption or per length.
fn emission_keys(mu: f64, per_length: bool) -> String {
    if per_length { format!("emission_per_length = {mu}") } else { "emission = 1".to_owned() }
}

/// A cube of edge 1 without scattering, seen along z through its middle. Its emission is multiplied by the grid `file`.
fn cube(folder: &Path, tau: f64, per_length: bool, file: &str) -> Scene {
    scene_in(
        folder,
        &format!(
            r#"camera = {{ position = [0.0625, 0.0625, -1], direction = [0, 0, 1], vertical_fov = 1e-6 }}
            film = {{ resolution = [1, 1] }}
            [[volume]]
            box = {{ min = [0, 0, 0], max = [1, 1, 8] }}
            transform = {{ scale = 0.125 }}
            mu_t = {tau}
            albedo = 0
            {}
            emission_grid = {{ file = "{file}" }}
            "#,
            emission_keys(tau, per_length)
        ),
    )
}

#[test]
fn even_and_linear_sources_shine_as_their_line_integrals() {
    let folder = tempfile::tempdir().expect("a folder for test files");
    let file = |name: &str| folder.path().join(name);
    write_npy(&file("even.npy"), [2, 2, 9], |_| 1.0);
    write_npy(&file("rises.npy"), [2, 2, 9], |[_, _, k]| k as f32 / 8.0);
    write_npy(&file("falls.npy"), [2, 2, 9], |[_, _, k]| 1.0 - k as f32 / 8.0);
    let mut claims = Claims::default();
    let rows = table("emission_slab");
    assert!(rows.len() >= 5);
    for row in &rows {
        let values: Vec<f64> = row.as_array().expect("a row").iter().map(number).collect();
        let &[tau, even, rises, falls, _] = &values[..] else { panic!("{row}") };
        for (name, truth) in [("even.npy", even), ("rises.npy", rises), ("falls.npy", falls)] {
            for per_length in [false, true] {
                let scene = cube(folder.path(), tau, per_length, name);
                let name = format!("{name} of tau {tau}, per length {per_length}");
                claims.add_picture(&name, &scene, truth, if per_length { 0.0 } else { (-tau).exp() });
            }
        }
    }
    claims.hold();
}

#[test]
fn a_layer_shines_over_the_hemisphere_with_its_emissivity() {
    let mut claims = Claims::default();
    for row in table("emission_slab") {
        let (tau, emissivity) = (number(&row[0]), number(&row[4]));
        for per_length in [false, true] {
            let layer = scene(&format!(
                "camera = {{ position = [0, 1, 0], target = [0, 0, 0], up = [0, 0, 1] }}
                 [[volume]]
                 slab = {{ bottom = -1, top = 0 }}
                 mu_t = {tau}
                 albedo = 0
                 {}",
                emission_keys(tau, per_length)
            ));
            let values: Vec<f64> = (0..PATHS)
                .map(|path| {
                    let mut random = fresh::random(43 + u64::from(per_length), (tau * 100.0) as u64, path);
                    let down = (1.0 - random.f64()).sqrt();
                    let (sin, cos) = (std::f64::consts::TAU * random.f64()).sin_cos();
                    let across = (1.0 - down * down).sqrt();
                    let direction = DVec3::new(across * cos, -down, across * sin);
                    let ray = Ray { origin: -direction, direction };
                    f64::from(trace(&layer, ray, &mut random).radiance[0])
                })
                .collect();
            claims.add(format!("tau {tau}, per length {per_length}"), mean_and_error(&values), emissivity);
        }
    }
    claims.hold();
}

/// μa(s) of the table's name for it, at a distance s from the viewer.
fn bump(name: &str, s: f64) -> f64 {
    let (height, centre, width) = match name {
        "3.0*exp(-(s-1.0)^2/(2*0.3^2))" => (3.0, 1.0, 0.3),
        "10.0*exp(-(s-0.2)^2/(2*0.1^2))" => (10.0, 0.2, 0.1),
        _ => panic!("another profile: {name}"),
    };
    height * (-((s - centre) / width).powi(2) / 2.0).exp()
}

#[test]
fn uneven_matter_with_uneven_sources_shines_as_its_line_integral() {
    const VOXELS: usize = 400;
    let folder = tempfile::tempdir().expect("a folder for test files");
    let mut claims = Claims::default();
    for row in table("emission_heterogeneous") {
        let (name, source) = (row["mu_a"].as_str().expect("text"), row["source"].as_str().expect("text"));
        let (length, truth) = (number(&row["L"]), number(&row["value"]));
        let step = length / VOXELS as f64;
        let place = |k: usize| k as f64 * step;
        let rises = |s: f64| if source == "S=1" { 1.0 } else { 1.0 + s };
        let shape = [2, 2, VOXELS + 1];
        let file = |name: &str| folder.path().join(name);
        write_npy(&file("density.npy"), shape, |[_, _, k]| bump(name, place(k)) as f32);
        write_npy(&file("source.npy"), shape, |[_, _, k]| rises(place(k)) as f32);
        write_npy(&file("both.npy"), shape, |[_, _, k]| (bump(name, place(k)) * rises(place(k))) as f32);
        for (keys, emission) in [("emission = 1", "source.npy"), ("emission_per_length = 1", "both.npy")] {
            let scene = scene_in(
                folder.path(),
                &format!(
                    r#"camera = {{ position = [{half}, {half}, -1], direction = [0, 0, 1], vertical_fov = 1e-6 }}
                    film = {{ resolution = [1, 1] }}
                    [[volume]]
                    file = "density.npy"
                    storage = "f32"
                    transform = {{ scale = {step} }}
                    mu_t = 1
                    albedo = 0
                    {keys}
                    emission_grid = {{ file = "{emission}" }}
                    "#,
                    half = 0.5 * step
                ),
            );
            let name = format!("{name}, {source}, {keys}");
            claims.add_picture(&name, &scene, truth, 1.0);
            // Flights that carry weights gather light per length along others that do not.
            let forced = Estimators { distance: Some(DistanceSampler::ForcedCollision), transmittance: None };
            let values: Vec<f64> = (0..PATHS)
                .map(|path| {
                    let mut random = fresh::random(47, 0, path);
                    let ray = scene.camera.ray([0, 0], [0.5, 0.5], [0.5, 0.5]);
                    f64::from(trace_with(&scene, forced, ray, &mut random).radiance[0])
                })
                .collect();
            claims.add(format!("{name}, forced collisions"), mean_and_error(&values), truth);
        }
    }
    claims.hold();
}

/// By Kirchhoff's law a slab of one temperature shines with what it would have absorbed: 1 − R − T.
#[test]
fn scattering_slabs_of_one_temperature_shine_as_kirchhoff_says() {
    let mut scores = Vec::new();
    for (number, row) in rows().iter().enumerate() {
        let [reflectance, transmittance] = row.truth[0];
        let truth = 1.0 - reflectance - transmittance;
        let per_length = number % 2 == 1;
        let source = row.tau * (1.0 - row.albedo);
        let slab = scene(&format!(
            "camera = {{ position = [0, 1, 0], target = [0, 0, 0], up = [0, 0, 1], vertical_fov = 1e-6 }}
             film = {{ resolution = [1, 1] }}
             [[volume]]
             slab = {{ bottom = -1, top = 0 }}
             mu_t = {}
             albedo = {}
             phase = {{ type = \"hg\", g = {} }}
             {}",
            row.tau,
            row.albedo,
            row.g,
            emission_keys(source, per_length)
        ));
        let integrator = BOTH[number / 2 % 2];
        let film = render(&slab, integrator, 53 + number as u64, 0..PATHS / 2);
        let (mean, error) = (film.mean(0, 0)[0], film.standard_error(0, 0)[0]);
        if row.albedo == 1.0 {
            assert_eq!(mean, 0.0, "nothing shines that absorbs nothing");
            continue;
        }
        // Few paths that bring something make no normal law, nor does light per length, hardly any of which is noise.
        let expected = truth * (PATHS / 2) as f64;
        let z = (mean - truth) / error.max(2e-6);
        let name = format!("albedo {} tau {} g {}, {integrator:?}", row.albedo, row.tau, row.g);
        if expected > 300.0 {
            assert!(z.abs() < 4.2, "{name}: {mean} +- {error}, not {truth}, z = {z}");
            if error > 1e-4 {
                scores.push(z);
            }
        } else {
            assert!(
                (mean - truth).abs() < 6.0 * error.max((truth / (PATHS / 2) as f64).sqrt()),
                "{name}: {mean}"
            );
        }
    }
    assert!(scores.len() > 150, "{} results are no family", scores.len());
    let p = kolmogorov_smirnov(&scores, normal_cdf);
    assert!(p > 1e-3, "z scores do not follow the normal law: p = {p} {scores:?}");
}

#[test]
fn an_opaque_body_shines_as_a_black_one_of_its_temperature() {
    let folder = tempfile::tempdir().expect("a folder for test files");
    write_npy(&folder.path().join("half.npy"), [2, 2, 9], |_| 0.5);
    for kelvin in [1000.0, 1500.0, 3000.0, 6500.0] {
        let text = |mode: &str| {
            format!(
                r#"camera = {{ position = [0.0625, 0.0625, -1], direction = [0, 0, 1], vertical_fov = 1e-6 }}
                film = {{ resolution = [1, 1] }}
                render = {{ mode = "{mode}" }}
                [[volume]]
                box = {{ min = [0, 0, 0], max = [1, 1, 8] }}
                transform = {{ scale = 0.125 }}
                mu_t = 1e4
                albedo = 0
                emission_scale = {}
                temperature = {{ file = "half.npy", scale = {}, offset = 273 }}
                "#,
                1.0 / planck::luminance(kelvin),
                2.0 * (kelvin - 273.0)
            )
        };
        let colour = planck::rgb(kelvin) / planck::luminance(kelvin);
        let body = scene_in(folder.path(), &text("rgb"));
        for integrator in BOTH {
            let mean = DVec3::from_array(render(&body, integrator, 5, 0..16).mean(0, 0));
            let error = (mean - cie::into_gamut(colour)).abs().max_element();
            assert!(error < 5e-4 * colour.max_element(), "{kelvin} K by {integrator:?}: {mean}");
        }
        let body = scene_in(folder.path(), &text("spectral"));
        let film = render(&body, Integrator::Reference, 6, 0..PATHS);
        for channel in 0..3 {
            let (mean, error) = (film.mean(0, 0)[channel], film.standard_error(0, 0)[channel]);
            let z = (mean - colour[channel]) / error;
            assert!(
                z.abs() < two_sided_quantile(1e-3 / 12.0),
                "{kelvin} K: {mean} +- {error}, {colour}, z = {z}"
            );
        }
    }
}

#[test]
fn uneven_light_and_colour_agree_among_the_integrators() {
    let folder = tempfile::tempdir().expect("a folder for test files");
    for (name, seed) in [("density", 1), ("flame", 2), ("heat", 3), ("paint", 4)] {
        write_random_npy(&folder.path().join(format!("{name}.npy")), [12, 12, 12], seed);
    }
    let fire = scene_in(
        folder.path(),
        &format!(
            r#"{HEAD}
            [[volume]]
            file = "density.npy"
            transform = {{ scale = 0.12, rotate = [10, 20, 30], translate = [-0.5, -0.8, -0.6] }}
            mu_t = 3
            albedo = [0.9, 0.6, 0.3]
            phase = {{ type = "hg", g = 0.5 }}
            temperature = {{ file = "heat.npy", scale = 3000, offset = 500 }}
            emission_scale = 0.01
            emission_grid = {{ file = "flame.npy", scale = 2 }}
            albedo_grid = {{ file = "paint.npy" }}
            [[volume]]
            file = "flame.npy"
            transform = {{ scale = 0.1, translate = [-0.9, -0.4, -0.4] }}
            mu_t = 1
            albedo = 0.8
            emission_per_length = [0.5, 0.2, 0.1]
            [[volume]]
            atmosphere = {{ bottom = -1, top = 1, scale_height = 0.5 }}
            mu_t = 0.2
            albedo = 0.5
            emission_per_length = [0.02, 0.03, 0.1]
            [[light]]
            type = "constant"
            radiance = 0.1
            "#
        ),
    );
    assert_same("fire", (&fire, Integrator::Reference), (&fire, Integrator::Fast));
    let mut chromatic = fire.clone();
    for volume in &mut chromatic.volumes {
        let mu_t = DVec3::splat(volume.medium.mu_t);
        volume.medium.chromatic = Some(Arc::new(ChromaticMedium { mu_t, phase_functions: None }));
    }
    assert_same("fire in channels", (&fire, Integrator::Fast), (&chromatic, Integrator::Reference));
}
