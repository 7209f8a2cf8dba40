//! The integrators agree on scenes that nobody thought of: media, lights, cameras, surfaces drawn at random.
//!
//! Each scene is drawn from a number; what fails can be looked at alone, with `TYNDALL_RANDOM_SCENE=NUMBER` in the
//! environment. The tests are those of [`crate::agreement`], Welch's t by region and quantity; the level of 1e-3 is that of
//! all scenes together. With `TYNDALL_PROOF=full` there are 50 scenes in place of 6, with five times the samples.

mod draw;

use tyndall_scene::Scene;
use tyndall_scene::description::{Integrator, Sampler};
use tyndall_transport::RenderOptions;

use crate::agreement::{Batches, batches_of, difference};
use crate::effort::is_full;
use crate::fresh;
use crate::rendering::{options, render_with};
use crate::scenes::{scene_in, write_random_npy};
use crate::surfaces::whole;

/// The variable that chooses one scene, which is printed.
const CHOSEN: &str = "TYNDALL_RANDOM_SCENE";

const LEVEL: f64 = 1e-3;

/// Independent films of each integrator, and samples of every pixel in each.
const FILMS: u64 = 20;
const SAMPLES: u64 = 4;

#[test]
fn random_scenes_look_the_same_to_all_integrators() {
    let chosen = std::env::var(CHOSEN).ok().and_then(|number| number.parse().ok());
    let first = 50 * fresh::number();
    let numbers = match chosen {
        Some(number) => number..number + 1,
        None if is_full() => first..first + 50,
        None => first..first + 6,
    };
    let level = LEVEL / numbers.clone().count() as f64;
    let differences: Vec<String> =
        numbers.filter_map(|number| compare(level, number).err().map(|why| format!("{why}\n"))).collect();
    assert!(differences.is_empty(), "{}", differences.concat());
}

fn compare(level: f64, number: u64) -> Result<(), String> {
    let folder = tempfile::tempdir().expect("a folder for test files");
    write_random_npy(&folder.path().join("random.npy"), [12, 10, 14], number);
    let text = draw::scene(number);
    if std::env::var_os(CHOSEN).is_some() {
        eprintln!("{text}");
    }
    let scene = scene_in(folder.path(), &text);

    let integrators = [Integrator::Reference, Integrator::Fast];
    // Both samplers take part, in turns.
    let sampler = if number.is_multiple_of(2) { Sampler::Independent } else { Sampler::Sobol };
    let pair =
        integrators.map(|integrator| films(&scene, RenderOptions { sampler, ..options(integrator, 0) }));
    let wholes = [0, 1].map(|i| whole(&pair[i]));
    let name = format!("random scene {number}");
    difference(0.5 * level, &name, integrators, &pair)
        .and_then(|_| difference(0.5 * level, &format!("{name}, on the whole"), integrators, &wholes))
        .map(drop)
        .map_err(|why| format!("{why}\n{text}"))
}

/// Films of seeds of their own, as the samples of one seed depend on each other if they are stratified.
fn films(scene: &Scene, options: RenderOptions) -> Batches {
    let samples = if is_full() { 5 * SAMPLES } else { SAMPLES };
    let first = if options.integrator == Integrator::Fast { 1000 } else { 0 };
    let film = |seed| render_with(scene, RenderOptions { seed, ..options }, 0..samples);
    let mut batches = batches_of((first..first + FILMS).map(film));
    // The greatest number of a pixel is no mean: how often it is met depends on how samples depend on each other.
    batches.retain(|(name, _)| !name.starts_with("ObjectId"));
    batches
}
