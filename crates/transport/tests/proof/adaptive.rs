//! Adaptive sampling moves samples between pixels, and changes neither the expected picture nor what its errors say.

use glam::DVec3;
use tyndall_film::Film;
use tyndall_scene::Scene;
use tyndall_scene::description::Integrator;

use crate::agreement::{Batches, HEAD, batches_of, difference};
use crate::chromatic::chromatic;
use crate::rendering::{add_pass, empty_adaptive, options, render};
use crate::scenes::scene;

/// Samples of a pixel, on average or each.
const SAMPLES: u64 = 12;
/// Films, each of its own seed.
const FILMS: u64 = 60;

fn adaptive(scene: &Scene, integrator: Integrator, seed: u64) -> Film {
    let mut film = empty_adaptive(scene, options(integrator, seed));
    add_pass(scene, &mut film, 0..SAMPLES, options(integrator, seed));
    film
}

/// A small thin grid and a glowing ball in much empty space, under a lamp and a faint sky.
fn grid_and_ball() -> Scene {
    scene(&format!(
        r#"{HEAD}
        [[volume]]
        procedural = {{ type = "cumulus", seed = 3, resolution = 24, size = 1 }}
        mu_t = 3
        albedo = [0.9, 0.8, 0.7]
        [[volume]]
        sphere = {{ center = [0.8, -0.5, 0.4], radius = 0.2 }}
        mu_t = 2
        albedo = 0.5
        emission = [1, 0.5, 0.2]
        [[light]]
        type = "point"
        position = [-0.5, 0.9, 0.8]
        intensity = [1, 0.8, 0.6]
        [[light]]
        type = "constant"
        radiance = 0.02
        "#
    ))
}

/// Fog in a box, for the engine without a march.
fn fog() -> Scene {
    scene(&format!(
        r#"{HEAD}
        [[volume]]
        box = {{ min = [-0.7, -0.6, -0.5], max = [0.5, 0.5, 0.5] }}
        mu_t = 2
        albedo = 0.9
        [[light]]
        type = "point"
        position = [-0.5, 0.9, 0.8]
        intensity = [1, 0.8, 0.6]
        [[light]]
        type = "constant"
        radiance = 0.05
        "#
    ))
}

#[test]
fn adaptive_pictures_have_the_same_means_and_true_errors() {
    let (grey, even) = (grid_and_ball(), fog());
    let milk = chromatic(even.clone(), DVec3::new(1.0, 2.0, 4.0), None);
    let fast = Integrator::Fast;
    for (number, (scene, integrator)) in
        [(&grey, fast), (&even, fast), (&milk, fast), (&grey, Integrator::Reference)].into_iter().enumerate()
    {
        let seed = |film: u64| 10_000 * (number as u64 + 1) + film;
        let films: Vec<Film> = (0..FILMS).map(|film| adaptive(scene, integrator, seed(film))).collect();
        let means =
            films.iter().map(|film| film.image_mean().map(|estimate| estimate.mean)).collect::<Vec<_>>();
        let stated =
            films.iter().map(|film| film.image_mean().map(|estimate| estimate.standard_error.powi(2)));
        let stated = stated.collect::<Vec<_>>();
        for c in 0..3 {
            let average = |values: &[[f64; 3]]| values.iter().map(|v| v[c]).sum::<f64>() / FILMS as f64;
            let mean = average(&means);
            let variance = means.iter().map(|m| (m[c] - mean).powi(2)).sum::<f64>() / (FILMS - 1) as f64;
            let ratio = variance / average(&stated);
            eprintln!("scene {number}: variance of channel {c} over the stated one {ratio:.2}");
            // Of 60 films it is known to 18 %; the limits are those of the chi-squared distribution at 1e-4 on each side.
            assert!((0.42..1.90).contains(&ratio), "scene {number}, channel {c}: {ratio}");
        }
        let uniform = (0..FILMS).map(|film| render(scene, integrator, seed(film) + 5000, 0..SAMPLES));
        let batches: [Batches; 2] = [batches_of(films.into_iter()), batches_of(uniform)];
        // Much is empty, and not lit.
        let lit = difference(1e-3, &format!("adaptive, scene {number}"), [integrator; 2], &batches).unwrap();
        assert!(lit > 0.1, "scene {number}: only {lit} of all quantities are lit");
    }
}

#[test]
fn as_many_samples_make_less_noise_where_much_is_empty() {
    let scene = grid_and_ball();
    let variance = |film: Film| -> f64 {
        let pixels = (0..24).flat_map(|y| (0..24).map(move |x| (x, y)));
        pixels.map(|(x, y)| film.standard_error(x, y)[1].powi(2)).sum()
    };
    let (mut even, mut uneven, mut samples) = (0.0, 0.0, 0.0);
    for seed in 0..8 {
        even += variance(render(&scene, Integrator::Fast, seed, 0..32));
        let mut film = empty_adaptive(&scene, options(Integrator::Fast, seed));
        add_pass(&scene, &mut film, 0..32, options(Integrator::Fast, seed));
        samples += film.mean_sample_count() / 8.0;
        uneven += variance(film);
    }
    assert!((31.5..=32.5).contains(&samples), "{samples} samples a pixel");
    assert!(uneven < 0.7 * even, "{} of the variance", uneven / even);
}
