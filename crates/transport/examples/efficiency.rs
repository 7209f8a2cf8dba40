//! How efficient the integrators are on the benchmark's scenes: 1 / ((relMSE − own noise of the reference) · seconds).
//!
//!     cargo run --release -p tyndall-transport --example efficiency -- [SCENE[:SAMPLES[*SEEDS]]]... [--integrator reference] [--sampler sobol]
//!     [--adaptive]
//!
//! SCENE is a letter of `benchmarks/scenes`; without any, all are rendered, 16 samples a pixel, 2 seeds. The reference
//! pictures by other renderers are looked for in `../shared/bench/references` beside the checkout. `seconds` is the
//! time of rendering alone, on as many threads as there are cores; `cpu` is the time that the cores spent on it, over
//! their number, which other work on the machine disturbs less, and by which `efficiency` is computed.

use std::path::Path;
use std::time::Instant;

use tyndall_film::comparison::{Picture, compare};
use tyndall_film::{Film, Layers};
use tyndall_machine::seconds_on_cores;
use tyndall_scene::description::{Integrator, Sampler};
use tyndall_scene::{Scene, SceneDocument, build};
use tyndall_transport::{Control, Estimators, RenderOptions, Renderer};

/// Letter, scene file, relMSE of the reference picture by its own noise (its README).
const SCENES: [(&str, &str, f64); 6] = [
    ("A", "A_cloud", 8.2e-4),
    ("B", "B_smoke", 4.6e-5),
    ("C", "C_fogbox", 5.8e-4),
    ("D", "D_fire", 2.0e-4),
    ("E", "E_milk", 1.8e-4),
    ("G", "G_wdas", 1.2e-3),
];

fn main() {
    let mut arguments: Vec<String> = std::env::args().skip(1).collect();
    let mut option = |name: &str| {
        let at = arguments.iter().position(|argument| argument == name)?;
        arguments.drain(at..(at + 2).min(arguments.len())).nth(1)
    };
    let integrator = match option("--integrator").as_deref() {
        Some("reference") => Integrator::Reference,
        _ => Integrator::Fast,
    };
    let sampler = match option("--sampler").as_deref() {
        Some("sobol") => Sampler::Sobol,
        _ => Sampler::Independent,
    };
    let is_adaptive = arguments.iter().any(|argument| argument == "--adaptive");
    arguments.retain(|argument| argument != "--adaptive");
    if arguments.is_empty() {
        arguments = SCENES.iter().map(|(letter, ..)| (*letter).to_owned()).collect();
    }
    println!(
        "scene  spp  relMSE      trimmed     seconds  cpu     efficiency  variance  us/sample  z of the means"
    );
    for argument in &arguments {
        let (letter, effort) = argument.split_once(':').unwrap_or((argument, "16"));
        let (samples, seeds) = effort.split_once('*').unwrap_or((effort, "2"));
        let number = |text: &str| text.parse().unwrap_or_else(|_| panic!("{argument}: no number: {text}"));
        let Some((_, file, noise)) = SCENES.iter().find(|(known, ..)| *known == letter) else {
            panic!("{argument}: no scene of this letter");
        };
        measure(letter, file, *noise, number(samples), number(seeds), (integrator, sampler, is_adaptive));
    }
}

fn measure(
    letter: &str,
    file: &str,
    noise: f64,
    samples: u64,
    seeds: u64,
    (integrator, sampler, is_adaptive): (Integrator, Sampler, bool),
) {
    let benchmarks = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../benchmarks");
    let references = benchmarks.join("../../shared/bench/references");
    let scene = read(&benchmarks.join("scenes").join(format!("{file}.toml")));
    let reference = Picture::read(&references.join(format!("{letter}.exr"))).expect("the reference is there");

    let (mut relmse, mut trimmed, mut seconds, mut cpu, mut z) = (0.0, 0.0, 0.0, 0.0, [0.0; 3]);
    for seed in 1..=seeds {
        let threads = std::thread::available_parallelism().map_or(1, usize::from);
        let options = RenderOptions { integrator, sampler, seed, threads, estimators: Estimators::default() };
        let (start, cpu_start) = (Instant::now(), seconds_on_cores());
        let film = render(&scene, samples, &options, is_adaptive);
        seconds += start.elapsed().as_secs_f64();
        cpu += cpu_start
            .zip(seconds_on_cores())
            .map_or(start.elapsed().as_secs_f64(), |(a, b)| (b - a) / threads as f64);
        let [width, height] = scene.resolution.map(|edge| edge as usize);
        let picture = Picture { width, height, rgb: film.mean_image(), standard_error: None };
        let comparison = compare(&picture, &reference).expect("the sizes agree");
        relmse += comparison.relmse - noise;
        trimmed += comparison.relmse_trimmed - noise;
        for (sum, one) in z.iter_mut().zip(comparison.z) {
            *sum += one / (seeds as f64).sqrt();
        }
    }
    let [relmse, trimmed, seconds, cpu] = [relmse, trimmed, seconds, cpu].map(|sum| sum / seeds as f64);
    let pixels = f64::from(scene.resolution[0] * scene.resolution[1]);
    println!(
        "{letter:5} {samples:4}  {relmse:.4e}  {trimmed:.4e}  {seconds:7.3}  {cpu:6.3}  {:10.4}  {:8.4}  {:9.4}  {:.1} {:.1} {:.1}",
        1.0 / (relmse * cpu),
        relmse * samples as f64,
        cpu / samples as f64 / pixels * 1e6,
        z[0],
        z[1],
        z[2],
    );
}

fn read(path: &Path) -> Scene {
    let document = SceneDocument::read(path).expect("the scene can be read");
    let description = document.description().expect("the scene is valid");
    build(&description, document.folder()).expect("the scene can be built").scene
}

fn render(scene: &Scene, samples: u64, options: &RenderOptions, is_adaptive: bool) -> Film {
    let [width, height] = scene.resolution;
    let mut film = Film::new(width, height, Layers::ALL).expect("the picture is small");
    let (renderer, control) = (Renderer::new(scene, options.integrator), Control::default());
    if is_adaptive {
        let rates = renderer.rates(&film, options, &control).expect("the picture is small");
        film.set_rates(rates.expect("nobody cancels"));
    }
    film.open_range(0).expect("an empty film holds no samples");
    renderer.render_pass(&mut film, samples, options, &control);
    film.complete_through(samples).expect("the pass was not cancelled");
    film
}
