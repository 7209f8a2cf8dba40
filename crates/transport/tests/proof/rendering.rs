//! Films of a scene by either integrator.

use std::ops::Range;

use tyndall_film::{Film, Layers};
use tyndall_scene::Scene;
use tyndall_scene::description::{Integrator, Sampler};
use tyndall_transport::{Control, Estimators, Outcome, RenderOptions, Renderer, render_pass};

use crate::fresh;

pub const BOTH: [Integrator; 2] = [Integrator::Reference, Integrator::Fast];

/// One thread and the default estimators.
pub fn options(integrator: Integrator, seed: u64) -> RenderOptions {
    let (sampler, estimators) = (Sampler::Independent, Estimators::default());
    RenderOptions { integrator, sampler, seed, threads: 1, estimators }
}

/// A film of `samples` of every pixel, rendered on one thread; no sample was refused.
pub fn render(scene: &Scene, integrator: Integrator, seed: u64, samples: Range<u64>) -> Film {
    render_with(scene, options(integrator, seed), samples)
}

/// The same with other options.
pub fn render_with(scene: &Scene, options: RenderOptions, samples: Range<u64>) -> Film {
    render_of_seed(scene, with_fresh_seed(options), samples)
}

/// The same by the very seed of the options, whichever is asked for.
pub fn render_of_seed(scene: &Scene, options: RenderOptions, samples: Range<u64>) -> Film {
    let mut film = empty(scene);
    add_pass_of_seed(scene, &mut film, samples, options);
    assert_eq!(film.rejected(), 0, "{options:?} made samples that are no numbers");
    film
}

fn empty(scene: &Scene) -> Film {
    let [width, height] = scene.resolution;
    Film::new(width, height, Layers::ALL).expect("test pictures are small")
}

/// A film without samples whose pixels get as many as a pilot tells.
pub fn empty_adaptive(scene: &Scene, options: RenderOptions) -> Film {
    let mut film = empty(scene);
    let renderer = Renderer::new(scene, options.integrator);
    let rates = renderer.rates(&film, &with_fresh_seed(options), &Control::default());
    film.set_rates(rates.expect("test pictures are small").expect("nobody cancels"));
    film
}

/// Adds the samples to the film.
pub fn add_pass(scene: &Scene, film: &mut Film, samples: Range<u64>, options: RenderOptions) {
    add_pass_of_seed(scene, film, samples, with_fresh_seed(options));
}

fn with_fresh_seed(options: RenderOptions) -> RenderOptions {
    RenderOptions { seed: fresh::seed(options.seed), ..options }
}

fn add_pass_of_seed(scene: &Scene, film: &mut Film, samples: Range<u64>, options: RenderOptions) {
    film.open_range(samples.start).expect("passes follow each other");
    let outcome = render_pass(scene, film, samples.end, &options, &Control::default());
    assert_eq!(outcome, Outcome::Complete);
    film.complete_through(samples.end).expect("a complete pass holds all its samples");
}
