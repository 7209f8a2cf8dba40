//! `tyndall measure`: the meters of a scene, with their standard errors.

mod table;

use std::path::PathBuf;
use std::sync::atomic::Ordering;

use miette::IntoDiagnostic;
use tyndall_session::{read_meters, readings_report};

use crate::Done;
use crate::effort::Effort;
use crate::input_args::{ImportArgs, RawArgs, open};
use crate::interrupt::cancel_on_signals;
use crate::terminal::{answer, tell};

/// Measure fluxes and radiances in a scene: the values of its `[[meter]]` tables, with their standard errors
///
/// Meters are of the types layer (reflectance, transmittance, absorptance, radiance, also by column), body (a thing of
/// finite size in a beam), irradiance and radiance (in the scene's own light); `tyndall schema` describes their keys.
#[derive(Debug, Clone, clap::Args)]
#[command(after_help = "\
Examples:
  tyndall measure cloud.toml
  tyndall measure cloud.toml --error 0.1% --json
  tyndall measure cloud.toml --set meter.0.ground_albedo=0.3 --samples 100000

A meter in a scene file, for the layer between y = 0 and 1 under a beam:
  [[meter]]
  type = \"layer\"
  bottom = 0
  top = 1
  direction = [0, -1, 0]")]
pub struct Args {
    /// Scene file (.toml, or .pbrt and Mitsuba's .xml)
    input: PathBuf,
    #[command(flatten)]
    effort: Effort,
    /// Change one value of the scene, such as volume.0.mu_t=3
    #[arg(long, value_name = "KEY=VALUE")]
    set: Vec<String>,
    /// Answer in JSON
    #[arg(long)]
    json: bool,
    #[command(flatten)]
    import: ImportArgs,
}

/// Measures with one meter after the other, and prints.
pub fn run(args: Args) -> miette::Result<Done> {
    let input = open(Some(&args.input), &args.set, &RawArgs::default(), &args.import)?;
    let built = input.build()?;
    input.notes().iter().chain(&built.notes).for_each(|note| tell(format!("note: {note}")));
    let cancel = cancel_on_signals()?;
    let options = |number| args.effort.options(number);
    let readings = read_meters(input.name(), input.description(), &built.scene, options, &cancel)?;
    for reading in &readings {
        reading.doubts.iter().for_each(|doubt| tell(format!("warning: {}: {doubt}", reading.name)));
    }
    if args.json {
        answer(serde_json::to_string(&readings_report(&readings)).into_diagnostic()? + "\n")?;
    } else {
        readings.iter().try_for_each(|reading| answer(table::table(reading)))?;
    }
    Ok(if cancel.load(Ordering::Relaxed) { Done::Interrupted } else { Done::All })
}
