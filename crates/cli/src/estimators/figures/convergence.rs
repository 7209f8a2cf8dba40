//! The error of the mean against the number of samples, on one ray, beside what the variance predicts: σ/√n.

use super::{LEGEND_LEFT, PANEL_HEIGHT, legend_of, look, main_ray, panel};
use crate::estimators::Report;
use crate::estimators::table::kind_name;
use crate::estimators::trial::{Kind, Trial};
use crate::plot::{Anchor, Axes, Kind as Scale, Svg};

pub fn draw(svg: &mut Svg, top: f64, report: &Report) -> f64 {
    let mut top = top;
    for kind in [Kind::Distance, Kind::Transmittance] {
        top = draw_kind(svg, top, report, kind);
    }
    top
}

fn draw_kind(svg: &mut Svg, top: f64, report: &Report, kind: Kind) -> f64 {
    let frame = panel(top);
    let Some((_, ray)) = main_ray(report) else { return top };
    let trials: Vec<&Trial> =
        ray.estimators.iter().filter(|trial| trial.kind == kind && !trial.convergence.is_empty()).collect();
    let steps = || trials.iter().flat_map(|trial| &trial.convergence);
    let axes = Axes::around(
        frame,
        (Scale::Log, steps().map(|step| step.n as f64)),
        (Scale::Log, steps().map(|step| step.rms_error)),
    );
    axes.draw(svg, "samples n", None, "error of the mean");
    svg.text("", Anchor::Start, [frame[0], frame[1] - 8.0], kind_name(kind));
    for trial in &trials {
        let look = look(report, kind, trial.name);
        let predicted = |n: u64| (n as f64, (trial.variance / n as f64).sqrt());
        let faint = "stroke-opacity=\"0.35\"";
        axes.styled_curve(svg, look.colour, faint, trial.convergence.iter().map(|step| predicted(step.n)));
        let errors = trial.convergence.iter().map(|step| (step.n as f64, step.rms_error));
        axes.styled_curve(svg, look.colour, look.dashes, errors.clone());
        for step in &trial.convergence {
            let [low, high] = [-1.0, 1.0].map(|sign| step.rms_error + sign * step.rms_uncertainty);
            axes.error_bar(svg, look.colour, step.n as f64, [low, high]);
        }
        errors.for_each(|point| axes.dot(svg, look.colour, look.filled, point));
    }
    let names: Vec<&'static str> = trials.iter().map(|trial| trial.name).collect();
    legend_of(svg, [LEGEND_LEFT, frame[1] + 12.0], report, kind, &names);
    top + PANEL_HEIGHT
}
