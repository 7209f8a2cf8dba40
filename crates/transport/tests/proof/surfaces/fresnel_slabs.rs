//! Slabs with smooth dielectric faces, seen along the normal, against adding-doubling with Fresnel boundaries.
//!
//! By reciprocity the reflectance of a slab for light along its normal is the radiance seen along the normal when the
//! surroundings above have radiance 1 and those below 0; the transmittance, when it is those below. The truth,
//! `truth/slab_fresnel.json`, is known to 1e-6.

use glam::DVec3;
use tyndall_scene::Scene;
use tyndall_scene::description::Integrator;

use super::effort;
use crate::chromatic::chromatic;
use crate::rendering::render;
use crate::scenes::{scene, two_halves, with_next_event};
use crate::statistics::two_sided_quantile;

/// Paths for each picture.
const PATHS: u64 = 4096;

/// Level of all pictures of a test together.
const LEVEL: f64 = 1e-3;

struct Row {
    index: f64,
    albedo: f64,
    tau: f64,
    g: f64,
    /// Reflectance and transmittance.
    truth: [f64; 2],
}

/// Every fifth of the rows that are no thicker than 4.
fn rows() -> Vec<Row> {
    let table: serde_json::Value =
        serde_json::from_str(include_str!("../../truth/slab_fresnel.json")).expect("the table is JSON");
    let rows = table["rows"].as_array().expect("the table has rows");
    let number = |row: &serde_json::Value, column: usize| row[column].as_f64().expect("a number");
    let step = if crate::effort::is_full() { 1 } else { 5 };
    let all = rows.iter().map(|row| Row {
        index: number(row, 0),
        albedo: number(row, 1),
        tau: number(row, 2),
        g: number(row, 3),
        truth: [number(row, 4), number(row, 5)],
    });
    all.filter(|row| row.tau <= 4.0).step_by(step).collect()
}

/// A slab between two infinite planes.
fn slab(row: &Row) -> Scene {
    let Row { index, albedo, tau, g, .. } = row;
    scene(&format!(
        "camera = {{ position = [0, 3, 0], target = [0, 0, 0], up = [0, 0, 1], projection = \"orthographic\", height = 1 }}
         film = {{ resolution = [1, 1] }}
         [[volume]]
         name = \"slab\"
         mu_t = {tau}
         albedo = {albedo}
         phase = {{ type = \"hg\", g = {g} }}
         [[material]]
         name = \"face\"
         type = \"dielectric\"
         index = {index}
         [[shape]]
         plane = {{ point = [0, 0, 0], normal = [0, 1, 0] }}
         material = \"face\"
         interior = \"slab\"
         [[shape]]
         plane = {{ point = [0, -1, 0], normal = [0, -1, 0] }}
         material = \"face\"
         interior = \"slab\""
    ))
}

/// Fails if the mean is significantly different from the truth, by a test that is one of `tests`.
fn assert_true(name: &str, truth: f64, mean: f64, error: f64, greatest: f64, tests: usize) {
    let paths = (PATHS * effort()) as f64;
    // With few paths that bring anything their own spread is no guide.
    let floor = if truth * paths > 300.0 { 0.0 } else { (greatest * truth / paths).sqrt() };
    let z = (mean - truth) / error.max(floor);
    assert!(
        z.abs() < two_sided_quantile(LEVEL / tests as f64),
        "{name}: {mean} +- {error}, not {truth}, z = {z}"
    );
}

/// Red is the light from above, green that from below.
#[test]
fn slabs_with_fresnel_faces_reflect_and_transmit_what_adding_doubling_says() {
    let rows = rows();
    assert!(
        rows.len() > 10
            && rows.iter().any(|row| row.index == 1.33)
            && rows.iter().any(|row| row.index == 1.5)
    );
    for integrator in [Integrator::Reference, Integrator::Fast] {
        for (number, row) in rows.iter().enumerate() {
            let lights = vec![two_halves([1.0, 0.0, 0.0], [0.0, 1.0, 0.0])];
            let scene = with_next_event(Scene { lights, ..slab(row) }, &[0.0]);
            let film = render(&scene, integrator, 500 + number as u64, 0..PATHS * effort());
            let (mean, error) = (film.mean(0, 0), film.standard_error(0, 0));
            let Row { index, albedo, tau, g, truth } = row;
            for i in 0..2 {
                let name =
                    format!("{integrator:?}: n {index} albedo {albedo} tau {tau} g {g} {}", ["R", "T"][i]);
                assert_true(&name, truth[i], mean[i], error[i], 1.0, 4 * rows.len());
            }
        }
    }
}

/// The spectral integrator has three slabs of one index at once, one in each channel, lit from above or from below.
#[test]
fn slabs_of_three_media_reflect_and_transmit_what_adding_doubling_says_of_each() {
    let rows = rows();
    for index in [1.33, 1.5] {
        let rows: Vec<&Row> = rows.iter().filter(|row| row.index == index).collect();
        for (number, triple) in rows.chunks_exact(3).enumerate() {
            for (side, [above, below]) in [[1.0_f32, 0.0], [0.0, 1.0]].into_iter().enumerate() {
                let channels =
                    |value: fn(&Row) -> f64| DVec3::from_array([0, 1, 2].map(|i| value(triple[i])));
                let mut scene = slab(triple[0]);
                let factors = channels(|row| row.tau) / triple[0].tau;
                scene.volumes[0].medium.albedo = channels(|row| row.albedo);
                scene = chromatic(scene, factors, Some([0, 1, 2].map(|i| triple[i].g)));
                scene.lights = vec![two_halves([above; 3], [below; 3])];
                let scene = with_next_event(scene, &[0.0]);
                let film = render(&scene, Integrator::Fast, 600 + number as u64, 0..PATHS * effort());
                let (mean, error) = (film.mean(0, 0), film.standard_error(0, 0));
                for (channel, row) in triple.iter().enumerate() {
                    let Row { albedo, tau, g, truth, .. } = row;
                    let name = format!("n {index} albedo {albedo} tau {tau} g {g} {}", ["R", "T"][side]);
                    assert_true(&name, truth[side], mean[channel], error[channel], 3.0, 2 * rows.len());
                }
            }
        }
    }
}
