//! Stratified first numbers change the noise of a picture, not the picture.
//!
//! The samples of one seed depend on each other, so that every film of a batch has a seed of its own; the tests are those of
//! [`crate::agreement`].

use glam::DVec3;
use tyndall_film::Film;
use tyndall_scene::Scene;
use tyndall_scene::description::{Integrator, Sampler};
use tyndall_transport::RenderOptions;

use crate::agreement::{Batches, assert_same_batches, batches_of};
use crate::chromatic::chromatic;
use crate::effort::is_full;
use crate::rendering::{BOTH, options, render_with};
use crate::scenes::scene;

/// Samples of every pixel in each film.
const SAMPLES: u64 = 8;

/// A lens near a box and a grid, under lights of three kinds.
fn box_and_cumulus() -> Scene {
    scene(
        r#"
        camera = { position = [0.2, 0.3, 3], target = [0, 0, 0], vertical_fov = 40, aperture_radius = 0.2 }
        film = { resolution = [24, 24] }
        [[volume]]
        procedural = { type = "cumulus", seed = 3, resolution = 24, size = 1.2 }
        mu_t = 5
        albedo = [0.9, 0.8, 0.7]
        phase = { type = "hg", g = 0.5 }
        [[volume]]
        box = { min = [-0.3, -0.9, -0.4], max = [0.9, 0.1, 0.6] }
        mu_t = 0.8
        albedo = 0.9
        emission = [0.1, 0.05, 0.02]
        [[light]]
        type = "constant"
        radiance = [0.1, 0.15, 0.2]
        [[light]]
        type = "point"
        position = [-0.5, 0.9, 0.8]
        intensity = [1, 0.8, 0.6]
        [[light]]
        type = "sun"
        direction = [1, -1, -0.5]
        irradiance = 2
        angular_diameter = 8
        "#,
    )
}

fn films(scene: &Scene, options: RenderOptions, count: u64) -> Batches {
    let film = |seed: u64| -> Film {
        render_with(scene, RenderOptions { seed: options.seed + seed, ..options }, 0..SAMPLES)
    };
    batches_of((0..count).map(film))
}

#[test]
fn sobol_and_independent_samples_have_the_same_mean_and_sobol_less_noise() {
    let grey = box_and_cumulus();
    let spectral = chromatic(grey.clone(), DVec3::ONE, None);
    let count = if is_full() { 400 } else { 30 };
    let all = BOTH.map(|integrator| (&grey, integrator)).into_iter().chain([(&spectral, Integrator::Fast)]);
    for (number, (scene, integrator)) in all.enumerate() {
        let batches = [Sampler::Independent, Sampler::Sobol].map(|sampler| {
            let seed = 1000 * (2 * number as u64 + u64::from(sampler == Sampler::Sobol));
            films(scene, RenderOptions { sampler, ..options(integrator, seed) }, count)
        });
        assert_same_batches(&format!("samplers, scene {number}"), [integrator; 2], &batches);
        let [independent, sobol] = batches.map(|batches| log_variances(&batches));
        let ratios = sobol.iter().zip(&independent).map(|(sobol, independent)| sobol - independent);
        let lit: Vec<f64> = ratios.filter(|ratio| ratio.is_finite()).collect();
        let ratio = (lit.iter().sum::<f64>() / lit.len() as f64).exp();
        eprintln!("{integrator:?}, scene {number}: variance {ratio:.3} of that of independent samples");
        // Each ratio of two variances of 30 values is known to 37 %, their geometric mean over 27 to 10 % or better. The other
        // integrators take film and lens alone from the points.
        if number == 1 {
            assert!(ratio < 0.85, "variance {ratio} times that of independent samples");
        }
    }
}

/// Logarithms of the variances of light scattered once, by region; −∞ where there is none.
fn log_variances(batches: &Batches) -> Vec<f64> {
    let single = batches.iter().filter(|(name, _)| name.starts_with("Single"));
    let variances = single.map(|(_, values)| {
        let mean = values.iter().sum::<f64>() / values.len() as f64;
        values.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / (values.len() - 1) as f64
    });
    variances.map(f64::ln).collect()
}
