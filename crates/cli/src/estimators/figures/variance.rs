//! Relative variance against optical thickness: of homogeneous media as lines, of the scene's rays as dots.

use super::{LEGEND_LEFT, PANEL_HEIGHT, legend_of, look, panel};
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
    let dots: Vec<(f64, &Trial, f64)> = report
        .rays
        .iter()
        .flat_map(|ray| ray.estimators.iter().map(|trial| (ray.optical_thickness, trial)))
        .filter(|(_, trial)| trial.kind == kind && !trial.exact && trial.variance_is_known())
        .map(|(tau, trial)| (tau, trial, trial.variance / trial.truth.powi(2)))
        .collect();
    let names: Vec<&'static str> = report
        .properties
        .iter()
        .filter(|declared| declared.kind == kind)
        .map(|declared| declared.name)
        .filter(|name| {
            line(report, kind, name).any(|(_, y)| shown(y)) || dots.iter().any(|dot| dot.1.name == *name)
        })
        .collect();
    let lines = names.iter().flat_map(|name| line(report, kind, name));
    let points: Vec<(f64, f64)> =
        lines.chain(dots.iter().map(|dot| (dot.0, dot.2))).filter(|(_, y)| shown(*y)).collect();
    let axes = Axes::around(
        frame,
        (Scale::Log, points.iter().map(|point| point.0)),
        (Scale::Log, points.iter().map(|point| point.1)),
    );
    axes.draw(svg, "optical thickness", None, "variance / truth²");
    svg.text("", Anchor::Start, [frame[0], frame[1] - 8.0], kind_name(kind));
    for name in &names {
        let look = look(report, kind, name);
        axes.styled_curve(svg, look.colour, look.dashes, line(report, kind, name).filter(|(_, y)| shown(*y)));
    }
    for (tau, trial, y) in dots.into_iter().filter(|dot| shown(dot.2)) {
        let look = look(report, kind, trial.name);
        axes.dot(svg, look.colour, look.filled, (tau, y));
    }
    legend_of(svg, [LEGEND_LEFT, frame[1] + 12.0], report, kind, &names);
    top + PANEL_HEIGHT
}

/// Less is as good as exact, and more as good as none.
fn shown(relative_variance: f64) -> bool {
    (1e-7..1e5).contains(&relative_variance)
}

/// (optical thickness, relative variance) in homogeneous media.
fn line<'a>(report: &'a Report, kind: Kind, name: &'a str) -> impl Iterator<Item = (f64, f64)> + 'a {
    report.homogeneous.iter().filter_map(move |medium| {
        let of_name = medium.estimators.iter().find(|found| (found.kind, found.name) == (kind, name))?;
        Some((medium.optical_thickness, of_name.relative_variance?))
    })
}
