//! The plots of the report, one beneath the other on a sheet or each on its own.

mod convergence;
mod efficiency;
mod histograms;
mod variance;

use super::Report;
use super::comparison::RayComparison;
use super::trial::Kind;
use crate::plot::{Anchor, Look, Svg, styled_legend};

/// A plot of the report.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Figure {
    /// Relative variance against optical thickness.
    Variance,
    /// Error against the number of samples.
    Convergence,
    /// How the values of single samples are spread.
    Values,
    /// How collision distances are spread.
    Collisions,
    /// Efficiencies as bars.
    Efficiency,
    /// Lookups as bars.
    Lookups,
    /// Efficiencies of whole pictures as bars.
    Pictures,
}

/// Width of every plot, pixels.
pub const WIDTH: f64 = 960.0;
/// Height of a title with the caption below.
const HEAD: f64 = 54.0;

impl Figure {
    /// Those that there are for the report.
    pub fn all(report: &Report) -> Vec<Figure> {
        let mut all = vec![
            Self::Efficiency,
            Self::Variance,
            Self::Convergence,
            Self::Values,
            Self::Collisions,
            Self::Lookups,
        ];
        all.extend(report.pictures.is_some().then_some(Self::Pictures));
        all
    }

    /// Its title.
    pub fn title(self) -> &'static str {
        match self {
            Self::Variance => "Variance against optical thickness",
            Self::Convergence => "Convergence",
            Self::Values => "Values of single transmittance estimates",
            Self::Collisions => "Where collisions are sampled",
            Self::Efficiency => "Efficiency",
            Self::Lookups => "Lookups of the extinction",
            Self::Pictures => "Efficiency in whole pictures",
        }
    }

    /// What is shown.
    pub fn caption(self, report: &Report) -> String {
        let main = main_ray(report).map_or(String::new(), |(number, ray)| {
            format!("ray {number}, optical thickness {}", super::table::short(ray.optical_thickness))
        });
        match self {
            Self::Variance => {
                "Variance of a sample over the squared truth. Lines: homogeneous media under twice their extinction as \
                               majorant. Dots: this scene's rays. Doubtful ones are left out."
                    .into()
            }
            Self::Convergence => format!(
                "Root mean square of mean - truth over batches of n samples, with its standard error; faint: what the \
                 variance predicts. On {main}."
            ),
            Self::Values => {
                format!("Share of the samples by value (the middle 99 %); the line is the truth. On {main}.")
            }
            Self::Collisions => {
                format!(
                    "Weight of the sampled collisions by distance; the line is the truth, the integral of mu_t T. On {main}."
                )
            }
            Self::Efficiency => {
                "1/(variance x seconds a sample), a bar a ray; longer is better, * is biased.".into()
            }
            Self::Lookups => {
                "Mean number of times that a sample asks for the extinction at a place, a bar a ray.".into()
            }
            Self::Pictures => {
                "1/(relMSE x seconds); the other choice is the default. Longer is better.".into()
            }
        }
    }

    /// Draws it below `top`, and says where it ends.
    fn draw(self, svg: &mut Svg, top: f64, report: &Report) -> f64 {
        match self {
            Self::Variance => variance::draw(svg, top, report),
            Self::Convergence => convergence::draw(svg, top, report),
            Self::Values => histograms::draw_values(svg, top, report),
            Self::Collisions => histograms::draw_collisions(svg, top, report),
            Self::Efficiency => efficiency::draw_efficiency(svg, top, report),
            Self::Lookups => efficiency::draw_lookups(svg, top, report),
            Self::Pictures => efficiency::draw_pictures(svg, top, report),
        }
    }

    /// The plot alone as SVG.
    pub fn svg(self, report: &Report) -> String {
        let mut svg = Svg::new(WIDTH, 0.0);
        let bottom = self.draw(&mut svg, 4.0, report);
        svg.set_height(bottom.ceil());
        svg.finish()
    }
}

/// All plots with titles on one sheet.
pub fn sheet(report: &Report) -> String {
    let mut svg = Svg::new(WIDTH, 0.0);
    let mut top = 10.0;
    for figure in Figure::all(report) {
        svg.text("title", Anchor::Start, [20.0, top + 20.0], figure.title());
        svg.text("small", Anchor::Start, [20.0, top + 38.0], &figure.caption(report));
        top = figure.draw(&mut svg, top + HEAD, report) + 24.0;
    }
    svg.set_height(top.ceil());
    svg.finish()
}

/// The ray that is shown where one must do: that of an optical thickness nearest 1, and its number.
pub fn main_ray(report: &Report) -> Option<(usize, &RayComparison)> {
    let off = |ray: &RayComparison| ray.optical_thickness.ln().abs();
    (1..).zip(&report.rays).min_by(|a, b| off(a.1).total_cmp(&off(b.1)))
}

/// The look of an estimator, the same in all plots.
fn look(report: &Report, kind: Kind, name: &str) -> Look {
    let same_kind = report.properties.iter().filter(|declared| declared.kind == kind);
    Look::of(same_kind.take_while(|declared| declared.name != name).count())
}

/// Lists estimators of a kind with their looks.
fn legend_of(svg: &mut Svg, place: [f64; 2], report: &Report, kind: Kind, names: &[&'static str]) {
    styled_legend(svg, place, names.iter().map(|name| (*name, look(report, kind, name))));
}

/// The frame of a panel beside its legend.
fn panel(top: f64) -> [f64; 4] {
    [80.0, top + 24.0, 660.0, top + 304.0]
}

/// Height of a panel with names of its axes.
const PANEL_HEIGHT: f64 = 304.0 + 50.0;
/// Where its legend is.
const LEGEND_LEFT: f64 = 680.0;
