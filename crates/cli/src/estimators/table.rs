//! The answer for people: plain tables of at most 100 columns, the most efficient estimators first.

use std::cmp::Ordering;
use std::fmt::Write as _;

use super::Report;
use super::comparison::{Declared, RayComparison, Refused};
use super::pictures::{PictureTrial, Pictures};
use super::trial::{Kind, Trial};

/// Columns of a terminal that are filled.
const WIDTH: usize = 98;

const FOOTNOTE: &str = "* biased. +- standard error of the mean; n lookups a sample; us microseconds a sample; efficiency \
    1/(variance x seconds), 1/(v s), and 1/(variance x lookups), 1/(v n), without a bound where there is no variance: exact. z is \
    (mean - truth)/error; with ? the error itself is uncertain by more than 30 %, with - no sample has met what would make up \
    the difference.";

/// The whole report. (Writing to a string cannot fail.)
pub fn table(report: &Report) -> String {
    let mut text = String::new();
    for (number, ray) in (1..).zip(&report.rays) {
        text.push_str(&wrapped(&format!("ray {number} of {}: {}", report.rays.len(), heading(ray))));
        for kind in [Kind::Distance, Kind::Transmittance] {
            text.push_str(&trials(ray, kind));
        }
        text.push('\n');
    }
    text.push_str(&refused(report.rays.iter().flat_map(|ray| &ray.refused)));
    if let Some(pictures) = &report.pictures {
        text.push_str(&picture_table(pictures));
    }
    text.push_str(&declarations(&report.properties));
    text.push('\n');
    text.push_str(&wrapped(FOOTNOTE));
    text
}

/// Where the ray is and what there is to be estimated.
pub fn heading(ray: &RayComparison) -> String {
    let place = match ray.pixel {
        Some([x, y]) => format!("pixel {x},{y}"),
        None => {
            let triple = |numbers: [f64; 3]| numbers.map(|x| number(x).trim().to_owned()).join(", ");
            format!("from ({}) along ({})", triple(ray.origin), triple(ray.direction))
        }
    };
    format!(
        "{place}, distances {} to {}, optical thickness {} (majorant {}), T {}",
        number(ray.start).trim(),
        number(ray.end).trim(),
        number(ray.optical_thickness).trim(),
        number(ray.majorant_thickness).trim(),
        number(ray.transmittance).trim()
    )
}

/// What the estimators of a kind estimate on the ray.
pub fn quantity(ray: &RayComparison, kind: Kind) -> String {
    let of_distance = match ray.test_function {
        "depth" => "mean depth of the collision in the ray, 0 to 1",
        _ => "mean light of the point light at the collision",
    };
    match kind {
        Kind::Distance => format!("distance: {of_distance}, truly {}", number(ray.collision_mean).trim()),
        Kind::Transmittance => {
            format!("transmittance, truly {}", number(ray.transmittance).trim())
        }
    }
}

fn trials(ray: &RayComparison, kind: Kind) -> String {
    let mut text = format!(
        "  {}\n  {:<31} {:>9} {:>7} {:>8} {:>7} {:>7} {:>7} {:>7} {:>6}\n",
        quantity(ray, kind),
        "",
        "mean",
        "+-",
        "variance",
        "n",
        "us",
        "1/(v s)",
        "1/(v n)",
        "z"
    );
    for trial in by_efficiency(ray.estimators.iter().filter(|trial| trial.kind == kind)) {
        let efficiency = |value: Option<f64>| match value {
            _ if trial.exact => "exact".to_owned(),
            Some(value) => short(value),
            None => "-".to_owned(),
        };
        let _ = writeln!(
            text,
            "  {:<31} {:>9} {:>7} {:>8} {:>7} {:>7} {:>7} {:>7} {:>6}",
            starred(trial.name, trial.unbiased),
            number(trial.mean),
            short(if trial.exact { 0.0 } else { trial.standard_error }),
            short(if trial.exact { 0.0 } else { trial.variance }),
            short(trial.lookups),
            short(1e6 * trial.seconds / trial.samples as f64),
            efficiency(trial.efficiency),
            efficiency(trial.efficiency_per_lookup),
            z(trial)
        );
    }
    text
}

/// The best first: without variance by time, then by efficiency.
pub fn by_efficiency<'a>(trials: impl Iterator<Item = &'a Trial>) -> Vec<&'a Trial> {
    let mut trials: Vec<&Trial> = trials.collect();
    let time = |trial: &Trial| trial.seconds / trial.samples as f64;
    trials.sort_by(|a, b| match (a.exact, b.exact) {
        (true, true) => time(a).total_cmp(&time(b)),
        (true, false) => Ordering::Less,
        (false, true) => Ordering::Greater,
        (false, false) => b.efficiency.unwrap_or(0.0).total_cmp(&a.efficiency.unwrap_or(0.0)),
    });
    trials
}

/// The name, marked if it is biased.
pub fn starred(name: &str, unbiased: bool) -> String {
    format!("{name}{}", if unbiased { "" } else { "*" })
}

/// z, with a mark if its error is not well known.
pub fn z(trial: &Trial) -> String {
    let mark = if trial.error_is_doubtful() { "?" } else { "" };
    match trial.z {
        Some(z) if z.abs() >= 1000.0 => format!("{}{mark}", short(z)),
        // Rounding is no deviation, and no negative one.
        Some(z) => format!("{:.2}{mark}", if z.abs() < 0.005 { 0.0 } else { z }),
        None => "-".to_owned(),
    }
}

/// The refused ones, each reason once.
pub fn refusals<'a>(all: impl Iterator<Item = &'a Refused>) -> Vec<&'a Refused> {
    let mut seen: Vec<&Refused> = Vec::new();
    for refused in all {
        if !seen.iter().any(|other| (other.kind, &other.reason) == (refused.kind, &refused.reason)) {
            seen.push(refused);
        }
    }
    seen
}

fn refused<'a>(all: impl Iterator<Item = &'a Refused>) -> String {
    let lines: String = refusals(all)
        .iter()
        .map(|refused| wrapped(&format!("  {}: {}", kind_name(refused.kind), refused.reason)))
        .collect();
    if lines.is_empty() { lines } else { format!("refused\n{lines}\n") }
}

fn picture_table(pictures: &Pictures) -> String {
    let [width, height] = pictures.resolution;
    let mut text = format!(
        "pictures of {width}x{height}, {} samples a pixel, {} threads\n  {:<13} {:<31} {:>9} {:>7} {:>8} {:>7} {:>8} {:>6}\n",
        pictures.spp, pictures.threads, "", "", "mean", "+-", "relMSE", "s", "1/(r s)", "z"
    );
    for picture in by_picture_efficiency(&pictures.estimators) {
        let _ = writeln!(
            text,
            "  {:<13} {:<31} {:>9} {:>7} {:>8} {:>7} {:>8} {:>6}",
            picture.kind.map_or("", kind_name),
            starred(picture.name, picture.unbiased),
            number(picture.mean),
            short(picture.standard_error),
            short(picture.relmse),
            short(picture.seconds),
            picture.efficiency.map_or("-".to_owned(), short),
            picture.z.map_or(String::new(), |z| format!("{z:.2}"))
        );
    }
    format!("{text}\n{}", refused(pictures.refused.iter()))
}

/// The best first.
pub fn by_picture_efficiency(pictures: &[PictureTrial]) -> Vec<&PictureTrial> {
    let mut pictures: Vec<&PictureTrial> = pictures.iter().collect();
    pictures.sort_by(|a, b| b.efficiency.unwrap_or(0.0).total_cmp(&a.efficiency.unwrap_or(0.0)));
    pictures
}

fn declarations(properties: &[Declared]) -> String {
    let mut text =
        format!("{:<33} {:<8} {:<14} {}\n", "properties", "unbiased", "majorant", "needs, or source");
    for declared in properties {
        let needs = if declared.needs.is_empty() {
            declared.source.to_owned()
        } else {
            format!("needs {}", declared.needs.join(", "))
        };
        let unbiased = if declared.unbiased { "yes" } else { "no" };
        let line = format!("  {:<31} {unbiased:<8} {:<14} {needs}", declared.name, declared.majorant);
        let _ = writeln!(text, "{}", line.trim_end());
    }
    text
}

/// How reports call a kind.
pub fn kind_name(kind: Kind) -> &'static str {
    match kind {
        Kind::Distance => "distance",
        Kind::Transmittance => "transmittance",
    }
}

/// A number in at most 9 characters, if it is no smaller or larger than those that come up.
pub fn number(x: f64) -> String {
    match x.abs() {
        0.0 => "0".to_owned(),
        size if (1e-3..1e3).contains(&size) => {
            let digits = (5.0 - size.log10().floor()).clamp(0.0, 7.0) as usize;
            format!("{x:.digits$}").chars().take(9).collect()
        }
        _ => format!("{x:.2e}"),
    }
}

/// The same in at most 7.
pub fn short(x: f64) -> String {
    match x.abs() {
        0.0 => "0".to_owned(),
        size if (0.01..999.5).contains(&size) => {
            let digits = (2.0 - size.log10().floor()).clamp(0.0, 4.0) as usize;
            format!("{x:.digits$}")
        }
        _ => format!("{x:.1e}"),
    }
}

/// The text in lines of the width of a terminal, later ones indented.
fn wrapped(text: &str) -> String {
    let indent = text.len() - text.trim_start().len();
    let mut lines = vec![" ".repeat(indent)];
    for word in text.split_whitespace() {
        let line = lines.last_mut().filter(|line| line.len() + word.len() < WIDTH || line.trim().is_empty());
        match line {
            Some(line) if line.trim().is_empty() => line.push_str(word),
            Some(line) => {
                line.push(' ');
                line.push_str(word);
            }
            None => lines.push(format!("{}{word}", " ".repeat(indent + 2))),
        }
    }
    lines.join("\n") + "\n"
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_keep_to_their_columns() {
        for power in -99..100 {
            for digit in [1.0, 9.999_999, -3.456_789] {
                let x = digit * 10_f64.powi(power);
                assert!(
                    number(x).len() <= 9 && short(x.abs()).len() <= 7,
                    "{x:e}: {} {}",
                    number(x),
                    short(x)
                );
            }
        }
        assert_eq!([number(0.367_879_441), number(12.5), short(0.012_34)], ["0.367879", "12.5000", "0.0123"]);
    }

    #[test]
    fn long_lines_are_wrapped_at_words() {
        let text = wrapped(&format!("  {}", "word ".repeat(60)));
        assert!(text.lines().all(|line| line.len() <= WIDTH && line.starts_with("  ")));
        assert_eq!(text.split_whitespace().count(), 60);
    }
}
