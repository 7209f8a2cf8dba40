//! Efficiencies and lookups as bars, the best estimator first.

use super::WIDTH;
use crate::estimators::Report;
use crate::estimators::table::{by_efficiency, by_picture_efficiency, kind_name, short, starred};
use crate::estimators::trial::{Kind, Trial};
use crate::plot::{Anchor, Bar, Bars, COLOURS, Svg};

/// Where bars start.
const LEFT: f64 = 250.0;
const RIGHT: f64 = WIDTH - 30.0;
/// Where those of pictures do, whose names are longer.
const LEFT_OF_PICTURES: f64 = 290.0;

pub fn draw_efficiency(svg: &mut Svg, top: f64, report: &Report) -> f64 {
    let bar = |trial: &Trial| match trial.efficiency {
        _ if trial.exact => Bar::Words("exact"),
        Some(efficiency) => Bar::Number(efficiency),
        None => Bar::Words("no sample differs"),
    };
    both_kinds(svg, top, report, "efficiency, 1/s", bar)
}

pub fn draw_lookups(svg: &mut Svg, top: f64, report: &Report) -> f64 {
    let bar = |trial: &Trial| match trial.lookups {
        0.0 => Bar::Words("none"),
        lookups => Bar::Number(lookups),
    };
    both_kinds(svg, top, report, "lookups a sample", bar)
}

fn both_kinds(svg: &mut Svg, top: f64, report: &Report, x_name: &str, bar: impl Fn(&Trial) -> Bar) -> f64 {
    let mut x = LEFT;
    for (number_of_ray, (ray, colour)) in (1..).zip(report.rays.iter().zip(COLOURS.iter().cycle())) {
        svg.bar(colour, [x, top + 2.0], [x + 14.0, top + 12.0]);
        let name = format!("ray {number_of_ray}, optical thickness {}", short(ray.optical_thickness));
        svg.text("small", Anchor::Start, [x + 20.0, top + 11.0], &name);
        x += 210.0;
    }
    let mut top = top + 40.0;
    for kind in [Kind::Distance, Kind::Transmittance] {
        svg.text("", Anchor::Start, [LEFT, top - 8.0], kind_name(kind));
        let rows = rows(report, kind, &bar);
        let numbers = rows.iter().flat_map(|row| &row.1).filter_map(|bar| match bar {
            Bar::Number(number) => Some(*number),
            Bar::Words(_) => None,
        });
        let bars = Bars::new([LEFT, top, RIGHT], report.rays.len(), numbers);
        bars.draw(svg, x_name, &COLOURS, &rows);
        top += bars.height(rows.len()) + 26.0;
    }
    top - 22.0
}

/// Estimators by their efficiency on the first ray, those refused everywhere left out.
fn rows(report: &Report, kind: Kind, bar: &impl Fn(&Trial) -> Bar) -> Vec<(String, Vec<Bar>)> {
    let Some(main) = super::main_ray(report) else { return Vec::new() };
    let sorted = by_efficiency(main.1.estimators.iter().filter(|trial| trial.kind == kind));
    let of_rays = |name: &str| {
        let of_ray = |ray: &crate::estimators::comparison::RayComparison| {
            let trial = ray.estimators.iter().find(|trial| (trial.kind, trial.name) == (kind, name));
            trial.map_or(Bar::Words("refused"), bar)
        };
        report.rays.iter().map(of_ray).collect()
    };
    sorted.into_iter().map(|trial| (starred(trial.name, trial.unbiased), of_rays(trial.name))).collect()
}

pub fn draw_pictures(svg: &mut Svg, top: f64, report: &Report) -> f64 {
    let Some(pictures) = &report.pictures else { return top };
    let rows: Vec<(String, Vec<Bar>)> = by_picture_efficiency(&pictures.estimators)
        .into_iter()
        .map(|picture| {
            let kind = match picture.kind {
                Some(Kind::Distance) => "dist. ",
                Some(Kind::Transmittance) => "trans. ",
                None => "",
            };
            let bar = picture.efficiency.map_or(Bar::Words("no noise"), Bar::Number);
            (format!("{kind}{}", starred(picture.name, picture.unbiased)), vec![bar])
        })
        .collect();
    let numbers = pictures.estimators.iter().filter_map(|picture| picture.efficiency);
    let bars = Bars::new([LEFT_OF_PICTURES, top + 4.0, RIGHT], 1, numbers);
    bars.draw(svg, "efficiency, 1/s", &COLOURS, &rows);
    top + 4.0 + bars.height(rows.len())
}
