//! The plane-parallel slab: reflectance and transmittance against adding-doubling, in 323 media.
//!
//! By reciprocity the reflectance for light that comes in at an angle is the radiance seen along that angle when the
//! surroundings above have radiance 1 and those below 0; the transmittance, when those below have 1. Red is the
//! light from above here and green that from below, so that one path tells both.
//!
//! The truth, `truth/slab_matched.json`, is known to 1e-6, a hundredth of the smallest standard error here.

use glam::DVec3;
use tyndall_lanes::Random;
use tyndall_scene::description::Integrator;
use tyndall_scene::{Ray, Scene};
use tyndall_transport::trace;

use crate::fresh;
use crate::rendering::render;
use crate::scenes::{scene, two_halves, with_next_event};
use crate::statistics::{confirmed, kolmogorov_smirnov, normal_cdf};

/// Paths for each medium and incidence.
const PATHS: u64 = 4096;

/// Fewer paths than this that bring something, on average, make no normal law.
const FEWEST_FOR_NORMAL_LAW: f64 = 300.0;

pub struct Row {
    pub albedo: f64,
    pub tau: f64,
    pub g: f64,
    /// Reflectance and transmittance for normal incidence, for 60 degrees and for diffuse light.
    pub truth: [[f64; 2]; 3],
}

pub fn rows() -> Vec<Row> {
    let table: serde_json::Value =
        serde_json::from_str(include_str!("../truth/slab_matched.json")).expect("the table is JSON");
    let rows = table["rows"].as_array().expect("the table has rows");
    let number = |row: &serde_json::Value, column: usize| row[column].as_f64().expect("a number");
    rows.iter()
        .map(|row| Row {
            albedo: number(row, 0),
            tau: number(row, 1),
            g: number(row, 2),
            truth: [3, 5, 7].map(|column| [number(row, column), number(row, column + 1)]),
        })
        .collect()
}

/// The row's slab, its top at y = 0, seen along `direction`. Half of the slabs are lit with next-event estimation.
fn slab(row: &Row, direction: DVec3, next_event: bool) -> Scene {
    let Row { albedo, tau, g, .. } = row;
    let DVec3 { x, y, z } = -direction;
    let mut scene = scene(&format!(
        "camera = {{ position = [{x}, {y}, {z}], target = [0, 0, 0], up = [0, 0, 1], vertical_fov = 1e-6 }}
         film = {{ resolution = [1, 1] }}
         [[volume]]
         slab = {{ bottom = -2, top = 0 }}
         mu_t = {}
         albedo = {albedo}
         phase = {{ type = \"hg\", g = {g} }}",
        tau / 2.0
    ));
    scene.lights = vec![two_halves([1.0, 0.0, 0.0], [0.0, 1.0, 0.0])];
    with_next_event(scene, &[f64::from(u8::from(next_event))])
}

/// z scores of a family of results, each checked by itself; then whether all follow the normal law.
#[derive(Default)]
struct Family {
    z: [Vec<f64>; 2],
}

impl Family {
    /// Takes mean and standard error of reflectance and transmittance, which `results` gives of so many paths by a seed moved on
    /// by its second argument. Where a score is doubtful more paths are asked: of few that bring anything, mean and spread are
    /// small together.
    fn add(&mut self, name: &str, truth: [f64; 2], results: impl Fn(u64, u64) -> [(f64, f64); 2]) {
        let is_normal = |i: usize| truth[i] * PATHS as f64 >= FEWEST_FOR_NORMAL_LAW;
        let scored = |times: u64, seed: u64| {
            let paths = times * PATHS;
            let found = results(paths, seed);
            [0, 1].map(|i| {
                let (mean, error) = found[i];
                // With few paths that bring anything their own spread is no guide; at most they bring 1 each.
                let paths = paths as f64;
                let least = if is_normal(i) { 0.0 } else { (truth[i] / paths).sqrt().max(1.5 / paths) };
                let error = error.max(least);
                (mean, error, (mean - truth[i]) / error)
            })
        };
        let found = confirmed(scored(1, 0), |found| found.map(|(.., z)| z), scored);
        for (i, (mean, error, z)) in found.into_iter().enumerate() {
            assert!(z.abs() < 4.0, "{name} {}: {mean} +- {error}, not {}, z = {z}", ["R", "T"][i], truth[i]);
            if is_normal(i) {
                self.z[i].push(z);
            }
        }
    }

    /// Reflectance and transmittance apart, as they come from the same paths. For other seeds each would fail once
    /// in a thousand times.
    fn assert_normal(&self) {
        for z in &self.z {
            assert!(z.len() > 100, "{} results are no family", z.len());
            let p = kolmogorov_smirnov(z, normal_cdf);
            eprintln!("{} z scores: Kolmogorov-Smirnov p = {p}", z.len());
            assert!(p > 1e-3, "z scores do not follow the normal law: p = {p} {z:?}");
        }
    }
}

const NORMAL: DVec3 = DVec3::NEG_Y;

fn at_60_degrees() -> DVec3 {
    let (sin, cos) = 60.0_f64.to_radians().sin_cos();
    DVec3::new(sin, -cos, 0.0)
}

/// Downward directions with density cos θ/π: diffuse light.
fn cosine_weighted(random: &mut Random) -> DVec3 {
    let (sin_azimuth, cos_azimuth) = (std::f64::consts::TAU * random.f64()).sin_cos();
    let sin_squared = random.f64();
    let sin = sin_squared.sqrt();
    DVec3::new(sin * cos_azimuth, -(1.0 - sin_squared).sqrt(), sin * sin_azimuth)
}

#[test]
fn the_step_between_the_two_halves_is_at_the_horizon() {
    let light = two_halves([1.0, 0.0, 0.0], [0.0, 1.0, 0.0]);
    let mut random = fresh::random(1, 0, 0);
    for _ in 0..10_000 {
        let sample = light.sample(DVec3::ZERO, [random.f64(), random.f64()]);
        let above = if sample.toward.y > 0.0 { DVec3::X } else { DVec3::Y };
        assert_eq!(light.radiance(sample.toward), above, "{}", sample.toward);
        assert!((light.pdf(sample.toward) * 4.0 * std::f64::consts::PI - 1.0).abs() < 1e-9);
    }
    for azimuth in 0..360 {
        let (sin, cos) = f64::from(azimuth).to_radians().sin_cos();
        for tilt in [1e-15, 1e-9, 1e-3] {
            assert_eq!(light.radiance(DVec3::new(sin, tilt, cos)), DVec3::X);
            assert_eq!(light.radiance(DVec3::new(sin, -tilt, cos)), DVec3::Y);
        }
    }
}

#[test]
fn the_reference_reflects_and_transmits_what_adding_doubling_says() {
    let mut families = [Family::default(), Family::default(), Family::default()];
    for (number, row) in rows().iter().enumerate() {
        let scene = slab(row, NORMAL, number % 2 == 0);
        for (incidence, family) in families.iter_mut().enumerate() {
            let results = |paths: u64, seed: u64| {
                let (mut sum, mut squares) = ([0.0; 2], [0.0; 2]);
                for path in 0..paths {
                    let mut random = fresh::random(11 + incidence as u64 + seed, number as u64, path);
                    let direction = match incidence {
                        0 => NORMAL,
                        1 => at_60_degrees(),
                        _ => cosine_weighted(&mut random),
                    };
                    let ray = Ray { origin: -direction, direction };
                    let [above, below, _] = trace(&scene, ray, &mut random).radiance;
                    for (i, x) in [above, below].map(f64::from).into_iter().enumerate() {
                        sum[i] += x;
                        squares[i] += x * x;
                    }
                }
                let n = paths as f64;
                [0, 1].map(|i| {
                    let mean: f64 = sum[i] / n;
                    (mean, ((squares[i] / n - mean * mean).max(0.0) / (n - 1.0)).sqrt())
                })
            };
            let name = format!("albedo {} tau {} g {} incidence {incidence}", row.albedo, row.tau, row.g);
            family.add(&name, row.truth[incidence], results);
        }
    }
    families.iter().for_each(Family::assert_normal);
}

#[test]
fn the_fast_engine_reflects_and_transmits_what_adding_doubling_says() {
    let mut families = [Family::default(), Family::default()];
    for (number, row) in rows().iter().enumerate() {
        for (incidence, direction) in [NORMAL, at_60_degrees()].into_iter().enumerate() {
            let scene = slab(row, direction, number % 2 == 1);
            let results = |paths: u64, seed: u64| {
                let film =
                    render(&scene, Integrator::Fast, 21 + (2 * number + incidence) as u64 + seed, 0..paths);
                let (mean, error) = (film.mean(0, 0), film.standard_error(0, 0));
                [0, 1].map(|i| (mean[i], error[i]))
            };
            let name = format!("albedo {} tau {} g {} incidence {incidence}", row.albedo, row.tau, row.g);
            families[incidence].add(&name, row.truth[incidence], results);
        }
    }
    families.iter().for_each(Family::assert_normal);
}
