//! The report as one HTML page that needs nothing else: tables, and plots as inline SVG.

use std::fmt::Write as _;

use super::Report;
use super::comparison::RayComparison;
use super::figures::Figure;
use super::pictures::Pictures;
use super::table::{
    by_efficiency, by_picture_efficiency, heading, kind_name, number, quantity, refusals, short, starred, z,
};
use super::trial::{Kind, Trial};
use crate::plot::escaped;

const STYLE: &str = "\
body{font:15px/1.5 system-ui,sans-serif;color:#222;background:#fff;max-width:980px;margin:2em auto;padding:0 1em}\
h1{font-size:1.5em}h2{font-size:1.15em;margin:2em 0 .3em}p{margin:.3em 0 .8em}\
table{border-collapse:collapse;font-size:13px;margin:.6em 0 1.4em;width:100%}\
th{text-align:right;font-weight:600;border-bottom:1px solid #444}td{text-align:right;border-bottom:1px solid #e5e5e5}\
th,td{padding:2px 8px}td:first-child{white-space:nowrap}th:first-child,td:first-child,.left td,.left th{text-align:left}\
caption{text-align:left;font-weight:600;padding:4px 8px}.off{color:#b33c00;font-weight:600}\
figure{margin:1em 0}figure svg{max-width:100%;height:auto}";

/// The page. (Writing to a string cannot fail.)
pub fn page(report: &Report) -> String {
    let title = format!("Estimators on {}", escaped(&report.scene));
    let mut html = format!(
        "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n<title>{title}</title>\n\
         <style>{STYLE}</style>\n</head>\n<body>\n<h1>{title}</h1>\n\
         <p>Each estimator was sampled many times on {} of the scene (seed {}), and held against the exact optical thickness \
         and a quadrature. Distance samplers are judged by the mean, over their weighted collisions, of a function of the \
         distance.</p>\n",
        match report.rays.len() {
            1 => "one ray".to_owned(),
            rays => format!("{rays} rays"),
        },
        report.seed
    );
    for note in &report.notes {
        let _ = writeln!(html, "<p>Note: {}.</p>", escaped(note));
    }
    for (number, ray) in (1..).zip(&report.rays) {
        html.push_str(&ray_section(number, ray));
    }
    html.push_str(
        "<p>* is biased. Efficiency is 1/(variance · seconds) and 1/(variance · lookups); without variance it has no bound. z is \
         (mean − truth)/error, beyond ±3 hardly noise; with ? the error itself is uncertain by more than 30 %; with - no sample \
         has met what would make up the difference.</p>\n",
    );
    html.push_str(&refused_section(report));
    report.pictures.iter().for_each(|pictures| html.push_str(&picture_section(pictures)));
    for figure in Figure::all(report) {
        let _ = writeln!(
            html,
            "<h2>{}</h2>\n<p>{}</p>\n<figure>\n{}</figure>",
            figure.title(),
            escaped(&figure.caption(report)),
            figure.svg(report)
        );
    }
    html.push_str(&properties_section(report));
    html + "</body>\n</html>\n"
}

fn row(tag: &str, cells: &[String]) -> String {
    let cells: String = cells.iter().map(|cell| format!("<{tag}>{cell}</{tag}>")).collect();
    format!("<tr>{cells}</tr>\n")
}

fn head(cells: &[&str]) -> String {
    row("th", &cells.iter().map(ToString::to_string).collect::<Vec<_>>())
}

fn ray_section(number: usize, ray: &RayComparison) -> String {
    let mut html = format!("<h2>Ray {number}</h2>\n<p>{}</p>\n", escaped(&heading(ray)));
    for kind in [Kind::Distance, Kind::Transmittance] {
        let _ = write!(html, "<table>\n<caption>{}</caption>\n", escaped(&quantity(ray, kind)));
        html.push_str(&head(&[
            "",
            "mean",
            "± error",
            "variance",
            "lookups",
            "µs",
            "1/(var·s)",
            "1/(var·lookups)",
            "z",
        ]));
        for trial in by_efficiency(ray.estimators.iter().filter(|trial| trial.kind == kind)) {
            html.push_str(&row("td", &cells(trial)));
        }
        html.push_str("</table>\n");
    }
    html
}

fn cells(trial: &Trial) -> [String; 9] {
    let efficiency = |value: Option<f64>| match value {
        _ if trial.exact => "exact".to_owned(),
        Some(value) => short(value),
        None => "-".to_owned(),
    };
    let error = |value: f64| short(if trial.exact { 0.0 } else { value });
    let is_off = trial.z.is_some_and(|z| z.abs() > 4.0);
    let z = if is_off { format!("<span class=\"off\">{}</span>", z(trial)) } else { z(trial) };
    [
        starred(trial.name, trial.unbiased),
        number(trial.mean),
        error(trial.standard_error),
        error(trial.variance),
        short(trial.lookups),
        short(1e6 * trial.seconds / trial.samples as f64),
        efficiency(trial.efficiency),
        efficiency(trial.efficiency_per_lookup),
        z,
    ]
}

fn refused_section(report: &Report) -> String {
    let of_pictures = report.pictures.iter().flat_map(|pictures| &pictures.refused);
    let refused = refusals(report.rays.iter().flat_map(|ray| &ray.refused).chain(of_pictures));
    if refused.is_empty() {
        return String::new();
    }
    let items: String = refused
        .iter()
        .map(|refused| format!("<li>{}: {}</li>\n", kind_name(refused.kind), escaped(&refused.reason)))
        .collect();
    format!("<h2>Refused</h2>\n<ul>\n{items}</ul>\n")
}

fn picture_section(pictures: &Pictures) -> String {
    let [width, height] = pictures.resolution;
    let mut html = format!(
        "<h2>Whole pictures</h2>\n<p>{width}×{height} pixels, {} samples a pixel, {} threads, the reference integrator. relMSE \
         is from the pictures' own standard errors; z compares the mean luminance with the default's.</p>\n<table>\n",
        pictures.spp, pictures.threads
    );
    html.push_str(&head(&["", "for", "mean", "± error", "relMSE", "s", "1/(relMSE·s)", "z"]));
    for picture in by_picture_efficiency(&pictures.estimators) {
        let cells = [
            starred(picture.name, picture.unbiased),
            picture.kind.map_or("", kind_name).to_owned(),
            number(picture.mean),
            short(picture.standard_error),
            short(picture.relmse),
            short(picture.seconds),
            picture.efficiency.map_or("-".to_owned(), short),
            picture.z.map_or(String::new(), |z| format!("{z:.2}")),
        ];
        html.push_str(&row("td", &cells));
    }
    html + "</table>\n"
}

fn properties_section(report: &Report) -> String {
    let mut html = "<h2>Properties</h2>\n<table class=\"left\">\n".to_owned();
    html.push_str(&head(&["", "for", "unbiased", "majorant", "needs", "source"]));
    for declared in &report.properties {
        let unbiased = if declared.unbiased { "yes" } else { "no" };
        let cells = [
            declared.name.to_owned(),
            kind_name(declared.kind).to_owned(),
            unbiased.to_owned(),
            declared.majorant.clone(),
            declared.needs.join(", "),
            escaped(declared.source),
        ];
        html.push_str(&row("td", &cells));
    }
    html + "</table>\n"
}
