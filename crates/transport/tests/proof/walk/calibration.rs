//! Error bars keep their word: the interval mean ± 1.96 SE holds the truth in 95 of 100 measurements.
//!
//! Of 1,000 measurements 95 ± 2 % have to: with exact error bars that fails in three of a thousand cases for each value.

use super::{henyey_greenstein, measure, slab};
use crate::rendering::{BOTH, render};
use crate::scenes::{scene, two_halves};

const MEASUREMENTS: u64 = 1000;
const TRUTH: [f64; 2] = [0.097_394_6, 0.660_957_7];

/// Counts intervals that hold the truth.
struct Coverage {
    truth: f64,
    held: u32,
    taken: u32,
}

impl Coverage {
    fn new(truth: f64) -> Self {
        Self { truth, held: 0, taken: 0 }
    }

    fn add(&mut self, mean: f64, standard_error: f64) {
        self.taken += 1;
        self.held += u32::from((mean - self.truth).abs() <= 1.959_964 * standard_error);
    }

    fn assert(&self, name: &str) {
        let share = f64::from(self.held) / f64::from(self.taken);
        eprintln!("{name}: {share}");
        assert!((share - 0.95).abs() < 0.02, "{name}: {share} of the intervals hold the truth");
    }
}

#[test]
fn intervals_of_slab_runs_hold_the_truth_in_95_of_100() {
    let slab = slab(2.0, 0.9, henyey_greenstein(0.75));
    let mut coverage = [TRUTH[0], TRUTH[1], 1.0 - TRUTH[0] - TRUTH[1]].map(Coverage::new);
    for seed in 0..MEASUREMENTS {
        let fluxes = measure(&slab, seed, 1000);
        for (coverage, result) in
            coverage.iter_mut().zip([fluxes.reflectance, fluxes.transmittance, fluxes.absorptance])
        {
            coverage.add(result.mean, result.standard_error);
        }
    }
    for (name, coverage) in ["reflectance", "transmittance", "absorptance"].iter().zip(&coverage) {
        coverage.assert(name);
    }
}

/// The same slab as a picture of 2x2 pixels, seen along its normal: red is its reflectance, green its transmittance.
#[test]
fn intervals_of_pixels_hold_the_truth_in_95_of_100() {
    let mut scene = scene(
        r#"
        camera = { position = [0, 1, 0], target = [0, 0, 0], up = [0, 0, 1], vertical_fov = 1e-6 }
        film = { resolution = [2, 2] }
        [[volume]]
        slab = { bottom = -2, top = 0 }
        mu_t = 1
        albedo = 0.9
        phase = { type = "hg", g = 0.75 }
        "#,
    );
    scene.lights = vec![two_halves([1.0, 0.0, 0.0], [0.0, 1.0, 0.0])];
    scene.set_light_probabilities(vec![0.0]);
    for integrator in BOTH {
        let mut coverage = TRUTH.map(Coverage::new);
        for seed in 0..MEASUREMENTS {
            let film = render(&scene, integrator, seed, 0..256);
            for pixel in 0..4 {
                let (mean, error) =
                    (film.mean(pixel % 2, pixel / 2), film.standard_error(pixel % 2, pixel / 2));
                for (channel, coverage) in coverage.iter_mut().enumerate() {
                    coverage.add(mean[channel], error[channel]);
                }
            }
        }
        for (name, coverage) in ["reflectance", "transmittance"].iter().zip(&coverage) {
            coverage.assert(&format!("{integrator:?}: {name}"));
        }
    }
}
