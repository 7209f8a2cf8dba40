//! How soon the built-in scene can be looked at: the first picture of 640x360, and pictures of 320x180 while the camera
//! moves, one sample a pixel each, from a scene that is built.
//!
//!     cargo run --release -p tyndall-transport --example interactive -- [SCENE.toml]
//!
//! Times are from the order to the mean image; `cpu` is the time of all cores over their number, which other work on the
//! machine disturbs less.

use std::path::Path;
use std::time::Instant;

use tyndall_film::{Film, Layers};
use tyndall_machine::seconds_on_cores;
use tyndall_scene::description::{CameraDescription, Integrator, Sampler};
use tyndall_scene::{Camera, Scene, SceneDocument, build};
use tyndall_transport::{Control, Estimators, RenderOptions, render_pass};

const STEPS: u32 = 20;

fn main() {
    let built_in = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenes/cloud.toml");
    let path = std::env::args().nth(1).map_or(built_in, Into::into);
    let document = SceneDocument::read(&path).expect("the scene can be read");
    let description = document.description().expect("the scene is valid");
    let mut scene = build(&description, document.folder()).expect("the scene can be built").scene;

    println!("                             seconds    cpu");
    for picture in ["first", "second", "third"] {
        let (seconds, cpu) = look(&mut scene, &description.camera, [640, 360]);
        println!("{picture:6} picture of 640x360   {seconds:7.3}  {cpu:6.3}");
    }

    let (mut total, mut cpu, mut longest) = (0.0, 0.0, 0.0_f64);
    for step in 0..STEPS {
        let camera = turned(&description.camera, 0.03 * f64::from(step));
        let (seconds, cpu_seconds) = look(&mut scene, &camera, [320, 180]);
        total += seconds;
        cpu += cpu_seconds;
        longest = longest.max(seconds);
    }
    let [mean, cpu] = [total, cpu].map(|sum| sum / f64::from(STEPS));
    println!("moving at 320x180           {mean:7.3}  {cpu:6.3}  (longest {longest:.3})");
    println!("pictures a second           {:7.1}  {:6.1}", 1.0 / mean, 1.0 / cpu);
}

/// Renders one sample a pixel; seconds, and seconds of each core.
fn look(scene: &mut Scene, camera: &CameraDescription, [width, height]: [u32; 2]) -> (f64, f64) {
    let (start, cpu_start) = (Instant::now(), seconds_on_cores().unwrap_or_default());
    scene.camera = Camera::new(camera, [width, height], None);
    scene.resolution = [width, height];
    let threads = std::thread::available_parallelism().map_or(1, usize::from);
    let options = RenderOptions {
        integrator: Integrator::Fast,
        sampler: Sampler::Independent,
        seed: 0,
        threads,
        estimators: Estimators::default(),
    };
    let mut film = Film::new(width, height, Layers::NONE).expect("the picture is small");
    film.open_range(0).expect("an empty film holds no samples");
    render_pass(scene, &mut film, 1, &options, &Control::default());
    film.complete_through(1).expect("the pass was not cancelled");
    let image = film.mean_image();
    assert!(image.iter().flatten().all(|channel| channel.is_finite()));
    (start.elapsed().as_secs_f64(), (seconds_on_cores().unwrap_or_default() - cpu_start) / threads as f64)
}

/// The camera on its way around the vertical axis through its target, by an angle in radians.
fn turned(camera: &CameraDescription, angle: f64) -> CameraDescription {
    let [tx, _, tz] = camera.target.unwrap_or_default();
    let [x, y, z] = camera.position;
    let (sin, cos) = angle.sin_cos();
    let [x, z] = [x - tx, z - tz];
    let position = [tx + cos * x + sin * z, y, tz - sin * x + cos * z];
    CameraDescription { position, ..camera.clone() }
}
