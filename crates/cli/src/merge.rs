//! `tyndall merge`: the exact union of renders of disjoint samples.

mod missing;

use std::path::PathBuf;

use miette::IntoDiagnostic;
use tyndall_film::{Accumulation, warnings};
use tyndall_session::{Output, check_input, check_writable, write_all};

use crate::render::parse_exposure;
use crate::terminal::{answer, tell};

/// Join renders of the same scene with disjoint samples into one picture
///
/// The result has the same bits as one render of all the samples, whatever their order and split.
#[derive(Debug, clap::Args)]
#[command(after_help = "\
Examples:
  tyndall render cloud.toml --samples 0..64 -o a.acc
  tyndall render cloud.toml --samples 64..128 -o b.acc      (on another machine)
  tyndall merge a.acc b.acc -o cloud.exr -o cloud.png -o cloud.acc
  tyndall merge parts/*.acc --missing --of 1024              what is still to be rendered, as commands
  tyndall merge parts/*.acc --missing --of 1024 | sed 's/INPUT/cloud.toml/' | sh")]
pub struct Args {
    /// Renders to join, as .acc files
    #[arg(required = true, value_name = "FILE.acc")]
    inputs: Vec<PathBuf>,
    /// Where to write the result: .exr, .png, .acc or .json; may be given several times
    #[arg(short, long, required_unless_present = "missing", value_name = "FILE")]
    output: Vec<Output>,
    /// Join nothing, but print the commands that would render the samples that no file holds, one a line; INPUT stands for
    /// the scene with its --set options, which .acc files know by its hash only
    #[arg(long, conflicts_with_all = ["output", "exposure"])]
    missing: bool,
    /// How many samples a pixel there are to be in all [default: as many as the greatest one held]
    #[arg(long, value_name = "N", conflicts_with = "output")]
    of: Option<u64>,
    /// Brighten the .png by 2^STOPS
    #[arg(long, default_value = "0", value_name = "STOPS", allow_negative_numbers = true, value_parser = parse_exposure)]
    exposure: f64,
}

/// Merges, writes, and says what the result holds.
pub fn run(args: Args) -> miette::Result<()> {
    let Some((first, others)) = args.inputs.split_first() else { return Ok(()) };
    check_writable(args.output.iter().map(Output::path))?;
    args.inputs.iter().try_for_each(|path| check_input(path))?;
    if args.missing {
        return missing::run(&args.inputs, args.of);
    }
    let mut sum = Accumulation::read(first).into_diagnostic()?;
    for path in others {
        let other = Accumulation::read(path).into_diagnostic()?;
        sum.merge(first, &other, path).into_diagnostic()?;
    }
    for output in &args.output {
        output.check_colours(&sum.metadata.colours, 1)?;
    }
    write_all(&args.output, std::slice::from_ref(&sum), args.exposure as f32)?;
    let film = &sum.film;
    let error = film.median_relative_error().filter(|e| e.is_finite());
    let error = error.map_or("unknown".into(), |e| format!("{:.3} %", 100.0 * e));
    for warning in warnings([film]) {
        tell(format!("warning: {warning}"));
    }
    let written: String =
        args.output.iter().map(|output| format!("wrote {}\n", output.path().display())).collect();
    answer(format!(
        "{}x{} pixels, samples {}, median relative error {error}\n{written}",
        film.width(),
        film.height(),
        film.complete()
    ))
}
