//! Transmittance estimation: what every estimator pays, in lookups, for how much noise, on one ray.
//!
//! Two estimators that are equally efficient have the same product of variance and lookups: they lie on one of the
//! slanting lines.

use tyndall_transport::{AlongRay, Lookups, Repeated, TransmittanceEstimator, repeat_transmittance};

use crate::distances::{LENGTH, profile};
use crate::plot::{Anchor, Axes, COLOURS, Kind, Scale, Svg};

const SAMPLES: u64 = 40_000;
/// The lower end of the scale of noise.
const LEAST: f64 = 0.001;

/// Draws the picture of the chapter.
pub fn draw() -> String {
    let mut svg = Svg::new(960.0, 430.0);
    svg.text("title", Anchor::Start, [70.0, 28.0], "One estimate of T: its noise and its cost");
    let frame = [70.0, 44.0, 560.0, 370.0];
    let x = Scale::new(Kind::Log, [1.0, 1000.0], [frame[0], frame[2]]);
    let axes = Axes::with_scales(frame, x, Scale::new(Kind::Log, [LEAST, 100.0], [frame[3], frame[1]]));
    axes.draw(&mut svg, "lookups", None, "standard deviation / T");
    for efficiency in [0.03, 0.3, 3.0, 30.0] {
        // From where the line is at the top, or at one lookup, to where it is at the bottom.
        let ends = [1.0, 1000.0_f64.min((efficiency / LEAST).powi(2))];
        axes.curve(&mut svg, "#ccc", ends.map(|lookups| (lookups, efficiency / lookups.sqrt())).into_iter());
    }
    let ray = AlongRay::with_profile(profile(), LENGTH, 8);
    let tau = ray.thickness(LENGTH, &mut Lookups::default());
    let title = format!("through two clouds, τ = {tau:.2}, T = {:.4}", (-tau).exp());
    svg.text("small", Anchor::Start, [600.0, 58.0], &title);
    let mut line = 84.0;
    for (number, estimator) in (1..).zip(TransmittanceEstimator::ALL) {
        let text = match estimator.check(&ray) {
            Ok(()) => {
                let result = repeat_transmittance(estimator, &ray, SAMPLES, 14);
                mark(&mut svg, &axes, number, &result);
                describe(estimator, &result)
            }
            Err(reason) => format!("{}: {reason}", estimator.name()),
        };
        svg.text("", Anchor::Start, [600.0, line], &format!("{number:2}  {text}"));
        line += 21.0;
    }
    svg.finish()
}

fn mark(svg: &mut Svg, axes: &Axes, number: u32, result: &Repeated) {
    let point = (result.lookups, result.variance.sqrt() / result.mean);
    axes.dot(svg, COLOURS[0], true, point);
    if let Some([x, y]) = axes.place(point.0, point.1) {
        svg.text("", Anchor::Start, [x + 6.0, y - 4.0], &number.to_string());
    }
}

fn describe(estimator: TransmittanceEstimator, result: &Repeated) -> String {
    let name = estimator.name();
    let noise = if result.variance.sqrt() < 1e-9 * result.mean { ": no noise" } else { "" };
    let bias = if estimator.properties().unbiased { "" } else { ", but biased" };
    format!("{name}{noise}{bias}")
}
