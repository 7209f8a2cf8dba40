//! Histograms as small multiples: the values of single transmittance estimates, and collision distances by weight.

use super::{WIDTH, look, main_ray};
use crate::estimators::Report;
use crate::estimators::comparison::DENSITY_STEPS;
use crate::estimators::table::{short, starred};
use crate::estimators::trial::{Kind, Trial};
use crate::plot::{Anchor, Svg};

const COLUMNS: usize = 4;
const PANEL: [f64; 2] = [WIDTH / COLUMNS as f64, 150.0];
/// Bars of a histogram; divides the steps of the true density.
const BINS: usize = 25;
/// Share of the samples that may lie outside at either end.
const OUTSIDE: f64 = 0.005;

/// One small histogram.
struct Histogram<'a> {
    name: String,
    colour: &'a str,
    /// Between which numbers the bars lie.
    range: [f64; 2],
    /// Height of each; may be below 0.
    bars: Vec<f64>,
    /// The truth: a number on the axis, or heights.
    truth: Truth,
}

enum Truth {
    Number(f64),
    Heights(Vec<f64>),
}

pub fn draw_values(svg: &mut Svg, top: f64, report: &Report) -> f64 {
    let Some((_, ray)) = main_ray(report) else { return top };
    let trials = ray.estimators.iter().filter(|trial| trial.kind == Kind::Transmittance && !trial.exact);
    let histograms: Vec<Histogram> = trials.map(|trial| of_values(report, trial)).collect();
    draw(svg, top, &histograms, "estimate")
}

pub fn draw_collisions(svg: &mut Svg, top: f64, report: &Report) -> f64 {
    let Some((_, ray)) = main_ray(report) else { return top };
    let trials = ray.estimators.iter().filter(|trial| trial.kind == Kind::Distance);
    let range = [ray.start, ray.end];
    let per_bin = DENSITY_STEPS / BINS;
    let heights: Vec<f64> = ray.collision_density.chunks(per_bin).map(|steps| steps.iter().sum()).collect();
    let histograms: Vec<Histogram> = trials
        .map(|trial| {
            let share = 1.0 / trial.samples as f64;
            let weighted = trial.collisions.iter().map(|(t, weight)| (*t, weight * share));
            Histogram {
                name: starred(trial.name, trial.unbiased),
                colour: look(report, trial.kind, trial.name).colour,
                range,
                bars: binned(range, weighted),
                truth: Truth::Heights(heights.clone()),
            }
        })
        .collect();
    draw(svg, top, &histograms, "distance")
}

fn of_values<'a>(report: &Report, trial: &Trial) -> Histogram<'a> {
    let mut sorted = trial.values.clone();
    sorted.sort_by(f64::total_cmp);
    let outside = (OUTSIDE * sorted.len() as f64) as usize;
    let [low, high] =
        [sorted.get(outside), sorted.iter().rev().nth(outside)].map(|x| *x.unwrap_or(&trial.truth));
    let (low, high) = (low.min(trial.truth), high.max(trial.truth));
    // So that bars at the ends, such as those of 0 and 1, are seen whole.
    let margin = 0.04 * (high - low).max(1e-12 * high.abs()).max(f64::MIN_POSITIVE);
    let range = [low - margin, high + margin];
    let share = 1.0 / sorted.len() as f64;
    Histogram {
        name: starred(trial.name, trial.unbiased),
        colour: look(report, trial.kind, trial.name).colour,
        range,
        bars: binned(range, sorted.into_iter().map(|value| (value, share))),
        truth: Truth::Number(trial.truth),
    }
}

fn binned([low, high]: [f64; 2], weighted: impl Iterator<Item = (f64, f64)>) -> Vec<f64> {
    let mut bars = vec![0.0; BINS];
    for (x, weight) in weighted {
        let place = (x - low) / (high - low) * BINS as f64;
        // The end belongs to the last bar.
        if (0.0..=BINS as f64).contains(&place) {
            bars[(place as usize).min(BINS - 1)] += weight;
        }
    }
    bars
}

fn draw(svg: &mut Svg, top: f64, histograms: &[Histogram], x_name: &str) -> f64 {
    for (number, histogram) in histograms.iter().enumerate() {
        let place = [(number % COLUMNS) as f64 * PANEL[0], top + (number / COLUMNS) as f64 * PANEL[1]];
        histogram.draw(svg, place, x_name);
    }
    top + histograms.len().div_ceil(COLUMNS) as f64 * PANEL[1] + 6.0
}

impl Histogram<'_> {
    fn draw(&self, svg: &mut Svg, [left, top]: [f64; 2], x_name: &str) {
        let (left, right) = (left + 16.0, left + PANEL[0] - 10.0);
        let (ceiling, floor) = (top + 22.0, top + PANEL[1] - 34.0);
        let heights = match &self.truth {
            Truth::Heights(heights) => heights.as_slice(),
            Truth::Number(_) => &[],
        };
        let tallest =
            self.bars.iter().chain(heights).fold(f64::MIN_POSITIVE, |most, height| most.max(*height));
        let y = |height: f64| floor - (height / tallest).clamp(0.0, 1.0) * (floor - ceiling);
        let step = (right - left) / BINS as f64;
        for (bin, bar) in self.bars.iter().enumerate().filter(|(_, bar)| **bar > 0.0) {
            let x = left + step * bin as f64;
            svg.bar(self.colour, [x + 0.5, y(*bar)], [x + step - 0.5, floor]);
        }
        match &self.truth {
            Truth::Number(truth) => {
                let x = left + (truth - self.range[0]) / (self.range[1] - self.range[0]) * (right - left);
                svg.styled_curve("#000", "stroke-width=\"1\"", [Some([x, ceiling - 3.0]), Some([x, floor])]);
            }
            Truth::Heights(heights) => {
                let steps = heights.iter().enumerate().flat_map(|(bin, height)| {
                    [bin, bin + 1].map(|edge| Some([left + step * edge as f64, y(*height)]))
                });
                svg.styled_curve("#000", "stroke-width=\"1\"", steps);
            }
        }
        svg.line("tick", [left, floor], [right, floor]);
        svg.text("small", Anchor::Start, [left, ceiling - 8.0], &self.name);
        svg.text("small", Anchor::Start, [left, floor + 14.0], &short(self.range[0]));
        svg.text("small", Anchor::End, [right, floor + 14.0], &short(self.range[1]));
        svg.text("small", Anchor::Middle, [0.5 * (left + right), floor + 14.0], x_name);
    }
}
