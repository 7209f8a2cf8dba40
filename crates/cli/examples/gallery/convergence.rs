//! Monte Carlo integration: the mean of n samples and its error, which falls as 1/√n.
//!
//!   L ≈ X̄ = 1/n Σ X_k,   SE = √(s²/n),   s² = 1/(n−1) Σ (X_k − X̄)²
//!
//! X is one path of the reference integrator along one ray through a ball of τ = 2 that glows: Le if it collides, else
//! 0. So L = Le (1 − e^−2) and the standard deviation of one sample, √(T (1 − T)) Le, are known.

use std::error::Error;
use std::path::Path;

use glam::DVec3;
use tyndall_lanes::Random;
use tyndall_scene::{Ray, Scene, SceneDocument, build};
use tyndall_transport::trace;

use crate::plot::{Anchor, Axes, COLOURS, Kind, Scale, Svg, legend};

/// Optical thickness of the ball along the ray.
const TAU: f64 = 2.0;
/// Runs over which the error is averaged.
const RUNS: u64 = 64;
/// The greatest number of samples is 4^STEPS.
const STEPS: u32 = 7;

/// Means of 1, 4, 16, … samples, each with its standard error.
type Run = Vec<(f64, f64)>;

/// Draws the picture of the chapter.
pub fn draw(folder: &Path) -> Result<String, Box<dyn Error>> {
    let description = SceneDocument::read(&folder.join("scene.toml"))?.description()?;
    let scene = build(&description, folder)?.scene;
    let runs: Vec<Run> = (0..RUNS).map(|seed| run(&scene, seed)).collect();
    let truth = 1.0 - (-TAU).exp();

    let mut svg = Svg::new(960.0, 400.0);
    svg.text("title", Anchor::Start, [70.0, 28.0], "The mean of n samples, with one standard error");
    let frame = [70.0, 44.0, 450.0, 340.0];
    let axes = axes(frame, Scale::new(Kind::Linear, [0.2, 1.2], [frame[3], frame[1]]));
    axes.draw(&mut svg, "samples n", None, "radiance");
    axes.curve(&mut svg, COLOURS[6], [1.0, samples(STEPS)].map(|n| (n, truth)).into_iter());
    for (colour, run) in COLOURS.iter().zip(&runs[..4]) {
        for (step, (mean, error)) in (0..).zip(run).skip(1) {
            // Beside each other, so that the bars do not hide each other.
            let beside = 1.0 + 0.12 * (COLOURS.iter().position(|c| c == colour).unwrap_or(0) as f64 - 1.5);
            let n = samples(step) * beside;
            axes.error_bar(&mut svg, colour, n, [mean - error, mean + error]);
            axes.dot(&mut svg, colour, true, (n, *mean));
        }
    }
    legend(&mut svg, [320.0, 256.0], ["one run", "another", "a third", "a fourth"].into_iter());

    svg.text("title", Anchor::Start, [560.0, 28.0], "Its error, root mean square of 64 runs");
    let frame = [560.0, 44.0, 930.0, 340.0];
    let axes = self::axes(frame, Scale::new(Kind::Log, [1e-3, 1.0], [frame[3], frame[1]]));
    axes.draw(&mut svg, "samples n", None, "error");
    let sigma = (truth * (1.0 - truth)).sqrt();
    axes.curve(&mut svg, COLOURS[6], [1.0, samples(STEPS)].map(|n| (n, sigma / n.sqrt())).into_iter());
    for step in 0..=STEPS {
        let over_runs = |square: &dyn Fn(&(f64, f64)) -> f64| {
            (runs.iter().map(|run| square(&run[step as usize])).sum::<f64>() / RUNS as f64).sqrt()
        };
        let n = samples(step);
        axes.dot(&mut svg, COLOURS[0], true, (n, over_runs(&|(mean, _)| (mean - truth).powi(2))));
        if step > 0 {
            axes.dot(&mut svg, COLOURS[1], false, (n, over_runs(&|(_, error)| error.powi(2))));
        }
    }
    legend(
        &mut svg,
        [590.0, 290.0],
        ["error of the mean", "standard error, as the samples tell it"].into_iter(),
    );
    svg.text("", Anchor::Start, [730.0, 128.0], "σ/√n");
    Ok(svg.finish())
}

fn axes(frame: [f64; 4], y: Scale) -> Axes {
    Axes::with_scales(frame, Scale::new(Kind::Log, [1.0, 1e5], [frame[0], frame[2]]), y)
}

fn samples(step: u32) -> f64 {
    4_f64.powi(step as i32)
}

/// One run: a sequence of samples, looked at after 1, 4, 16, … of them.
fn run(scene: &Scene, seed: u64) -> Run {
    let ray = Ray { origin: DVec3::new(0.0, 0.0, 4.0), direction: DVec3::NEG_Z };
    let (mut sum, mut sum_of_squares, mut looked) = (0.0, 0.0, Vec::new());
    for n in 1..=samples(STEPS) as u64 {
        let x = f64::from(trace(scene, ray, &mut Random::new(seed, 0, n)).radiance[1]);
        sum += x;
        sum_of_squares += x * x;
        if n as f64 == samples(looked.len() as u32) {
            let (count, mean) = (n as f64, sum / n as f64);
            let variance = (sum_of_squares - count * mean * mean) / (count - 1.0).max(1.0);
            looked.push((mean, (variance.max(0.0) / count).sqrt()));
        }
    }
    looked
}
