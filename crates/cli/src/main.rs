//! The `tyndall` command: pictures of clouds, smoke, fire, fog, milk and air, with their error.

mod convert;
mod diff;
mod effort;
mod estimators;
mod input_args;
mod inspect;
mod interrupt;
mod measure;
mod measured;
mod merge;
mod phase;
mod plot;
mod render;
mod slab;
mod terminal;

use clap::{CommandFactory, Parser, Subcommand};
use std::process::ExitCode;

/// Light in clouds, smoke, fire, fog, milk and air: unbiased pictures of volumes, with their error
#[derive(Parser)]
#[command(
    version,
    after_help = "\
Examples:
  tyndall                                        renders the built-in cumulus to cloud.exr and cloud.png
  tyndall render smoke.vdb -o smoke.png          a picture of an OpenVDB file: light, camera, density are chosen
  tyndall render smoke.vdb --print-scene > smoke.toml    ... and the choices as a scene file, to go on from
  tyndall render smoke.toml -o smoke.exr --error 1%      renders until the error is 1 %
  tyndall diff a.exr b.exr                       whether two pictures differ beyond their noise
  tyndall slab --tau 2 --albedo 0.9 --g 0.75             what a layer reflects, transmits and absorbs
  tyndall estimators smoke.toml -o report.html           all distance samplers and transmittance estimators compared"
)]
struct Cli {
    #[command(subcommand)]
    command: Option<Command>,
}

#[derive(Subcommand)]
enum Command {
    Render(Box<render::Args>),
    Inspect(inspect::Args),
    Convert(convert::Args),
    Merge(merge::Args),
    Diff(diff::Args),
    Estimators(Box<estimators::Args>),
    Slab(Box<slab::Args>),
    Measure(measure::Args),
    Phase(phase::Args),
    /// Print a completion script for a shell
    Completions {
        /// The shell
        shell: clap_complete::Shell,
    },
    /// Print the JSON schema of scene files, for editors that complete and check them
    Schema,
}

/// What a command ended with, unless it failed.
enum Done {
    /// All that was asked for.
    All,
    /// Ctrl-C; what there was is saved.
    Interrupted,
}

fn main() -> ExitCode {
    match run(Cli::parse().command) {
        Ok(Done::All) => ExitCode::SUCCESS,
        Ok(Done::Interrupted) => ExitCode::from(130),
        Err(report) => {
            terminal::tell_error(&report);
            ExitCode::from(1)
        }
    }
}

fn run(command: Option<Command>) -> miette::Result<Done> {
    match command {
        None => return render::run(render::Args::default_scene()),
        Some(Command::Render(args)) => return render::run(*args),
        Some(Command::Slab(args)) => return slab::run(*args),
        Some(Command::Measure(args)) => return measure::run(args),
        Some(Command::Inspect(args)) => inspect::run(args)?,
        Some(Command::Convert(args)) => convert::run(args)?,
        Some(Command::Merge(args)) => merge::run(args)?,
        Some(Command::Diff(args)) => diff::run(args)?,
        Some(Command::Estimators(args)) => estimators::run(*args)?,
        Some(Command::Phase(args)) => phase::run(args)?,
        Some(Command::Completions { shell }) => {
            let mut script = Vec::new();
            clap_complete::generate(shell, &mut Cli::command(), "tyndall", &mut script);
            terminal::answer(String::from_utf8_lossy(&script))?;
        }
        Some(Command::Schema) => terminal::answer(format!("{:#}\n", tyndall_scene::json_schema()))?,
    }
    Ok(Done::All)
}
