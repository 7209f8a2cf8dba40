//! The `tyndall` command.

mod convert;
mod diff;
mod inspect;
mod merge;
mod output;
mod volume_input;

use clap::Parser;

/// Light in clouds, smoke, fire, fog, milk and air.
#[derive(Parser)]
#[command(version)]
enum Command {
    Convert(convert::Args),
    Diff(diff::Args),
    Inspect(inspect::Args),
    Merge(merge::Args),
}

fn main() -> miette::Result<()> {
    match Command::parse() {
        Command::Convert(args) => convert::run(args),
        Command::Diff(args) => diff::run(args),
        Command::Inspect(args) => inspect::run(args),
        Command::Merge(args) => merge::run(args),
    }
}
