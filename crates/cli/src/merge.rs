//! `tyndall merge`: the exact union of renders of disjoint samples.

use std::path::PathBuf;

use miette::IntoDiagnostic;
use tyndall_film::Accumulation;

use crate::output::Output;

/// Join renders of the same scene with disjoint samples into one picture
///
/// The result has the same bits as one render of all the samples, whatever their order and split.
#[derive(Debug, clap::Args)]
#[command(after_help = "\
Examples:
  tyndall render cloud.toml --samples 0..64 -o a.acc
  tyndall render cloud.toml --samples 64..128 -o b.acc      (on another machine)
  tyndall merge a.acc b.acc -o cloud.exr -o cloud.png -o cloud.acc")]
pub struct Args {
    /// Renders to join, as .acc files
    #[arg(required = true, value_name = "FILE.acc")]
    inputs: Vec<PathBuf>,
    /// Where to write the result: .exr, .png, .acc or .json; may be given several times
    #[arg(short, long, required = true, value_name = "FILE")]
    output: Vec<Output>,
    /// Brighten the .png by 2^STOPS
    #[arg(long, default_value_t = 0.0, value_name = "STOPS", allow_negative_numbers = true)]
    exposure: f32,
}

/// Merges, writes, and says what the result holds.
pub fn run(args: Args) -> miette::Result<()> {
    let Some((first, others)) = args.inputs.split_first() else { return Ok(()) };
    let mut sum = Accumulation::read(first).into_diagnostic()?;
    for path in others {
        let other = Accumulation::read(path).into_diagnostic()?;
        sum.merge(first, &other, path).into_diagnostic()?;
    }
    for output in &args.output {
        output.write(&sum, args.exposure)?;
    }
    let film = &sum.film;
    let error = film.median_relative_error().filter(|e| e.is_finite());
    let error = error.map_or("unknown".into(), |e| format!("{:.3} %", 100.0 * e));
    println!(
        "{}x{} pixels, samples {}, median relative error {error}",
        film.width(),
        film.height(),
        film.complete()
    );
    if film.rejected() > 0 {
        println!("{} samples were not finite or too large and count as black", film.rejected());
    }
    for output in &args.output {
        println!("wrote {}", output.path().display());
    }
    Ok(())
}
