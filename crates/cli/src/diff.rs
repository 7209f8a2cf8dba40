//! `tyndall diff`: how far two pictures are apart, and whether noise explains it.

use std::path::PathBuf;

use miette::{IntoDiagnostic, miette};
use tyndall_film::comparison::{Comparison, ErrorSource, Picture, compare};
use tyndall_session::check_input;

use crate::terminal::answer;

/// Compare two EXR pictures: errors, means, and whether they differ by more than noise
///
/// B is the reference. Standard errors are taken from the StandardError layers if both pictures have them, and
/// from the scatter of the differences between pixels if not.
#[derive(Debug, clap::Args)]
#[command(after_help = "\
Examples:
  tyndall diff cloud.exr reference.exr
  tyndall diff cloud.exr reference.exr --json")]
pub struct Args {
    /// The picture to judge
    #[arg(value_name = "A.exr")]
    a: PathBuf,
    /// The reference
    #[arg(value_name = "B.exr")]
    b: PathBuf,
    /// Answer in JSON
    #[arg(long)]
    json: bool,
}

/// Compares and prints.
pub fn run(args: Args) -> miette::Result<()> {
    check_input(&args.a)?;
    check_input(&args.b)?;
    let a = Picture::read(&args.a).into_diagnostic()?;
    let b = Picture::read(&args.b).into_diagnostic()?;
    let comparison =
        compare(&a, &b).map_err(|what| miette!("{} and {}: {what}", args.a.display(), args.b.display()))?;
    if args.json {
        answer(serde_json::to_string(&comparison).into_diagnostic()? + "\n")
    } else {
        answer(table(&comparison))
    }
}

fn table(c: &Comparison) -> String {
    let row = |name: &str, values: [f64; 3]| {
        let [r, g, b] = values.map(|x| format!("{x:>13.6}"));
        format!("{name:<16}{r}{g}{b}\n")
    };
    let source = match c.standard_error_from {
        ErrorSource::StandardErrorLayers => "from the StandardError layers",
        ErrorSource::PixelDifferences => "from the scatter of the differences",
    };
    let verdict = if c.significant {
        "The pictures differ by more than noise"
    } else {
        "Noise explains the difference of the pictures"
    };
    let non_finite = match c.non_finite_pixels {
        0 => String::new(),
        n => format!("{n} pixels are not finite; such values count as 0\n"),
    };
    format!(
        "relMSE          {:>13.4e}   without the worst 0.1 % of pixels {:.4e}\n\
         MSE             {:>13.4e}\n\
         FLIP-like error {:>13.4}\n\n\
         {:<16}{:>13}{:>13}{:>13}\n{}{}{}{}{}\
         \nstandard error {source}\n\
         blocks of {}x{}: {} of {} means beyond 3 sigma, {:.1} expected; largest |z| {:.2}\n{non_finite}\
         {verdict} (level {}, |z| > {:.2}).\n",
        c.relmse,
        c.relmse_trimmed,
        c.mse,
        c.flip_like,
        "",
        "red",
        "green",
        "blue",
        row("mean of A", c.mean_a),
        row("mean of B", c.mean_b),
        row("difference", c.mean_difference),
        row("standard error", c.standard_error),
        row("z", c.z),
        c.blocks.edge,
        c.blocks.edge,
        c.blocks.beyond_3_sigma,
        c.blocks.tests,
        c.blocks.expected_beyond_3_sigma,
        c.blocks.largest_z,
        c.significance_level,
        c.critical_z,
    )
}
