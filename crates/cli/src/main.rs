//! The `tyndall` command.

mod diff;
mod merge;
mod output;

use clap::Parser;

/// Light in clouds, smoke, fire, fog, milk and air.
#[derive(Parser)]
#[command(version)]
enum Command {
    Diff(diff::Args),
    Merge(merge::Args),
}

fn main() -> miette::Result<()> {
    match Command::parse() {
        Command::Diff(args) => diff::run(args),
        Command::Merge(args) => merge::run(args),
    }
}
