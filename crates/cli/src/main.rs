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
use miette::IntoDiagnostic;
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
    /// Take no more memory than this, such as 4GB or 512MiB [default: TYNDALL_MAX_MEMORY, or what the machine or the
    /// control group of the job has]
    #[arg(long, global = true, value_name = "SIZE", value_parser = tyndall_machine::parse_size)]
    max_memory: Option<u64>,
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
    /// A signal such as that of Ctrl-C; what there was is saved.
    Interrupted,
}

fn main() -> ExitCode {
    save_address_space();
    let Cli { max_memory, command } = Cli::parse();
    match prepare(max_memory).and_then(|()| run(command)) {
        Ok(Done::All) => ExitCode::SUCCESS,
        Ok(Done::Interrupted) => ExitCode::from(interrupt::exit_code()),
        Err(report) => {
            terminal::tell_error(&report);
            ExitCode::from(1)
        }
    }
}

/// Starts the program anew without arenas for each thread, if `ulimit -v` limits address space: of that, glibc reserves 64 MiB
/// for each, whatever they use, and listens to this variable only when it starts (`mallopt(3)`).
#[cfg(all(target_os = "linux", target_env = "gnu"))]
fn save_address_space() {
    use std::os::unix::process::CommandExt;
    const VARIABLE: &str = "MALLOC_ARENA_MAX";
    if !tyndall_machine::memory::address_space_is_limited() || std::env::var_os(VARIABLE).is_some() {
        return;
    }
    let mut arguments = std::env::args_os();
    let (Ok(program), Some(name)) = (std::env::current_exe(), arguments.next()) else { return };
    // If it returns, it has failed, and all is as it was.
    let _ = std::process::Command::new(program).arg0(name).args(arguments).env(VARIABLE, "1").exec();
}

/// Elsewhere nothing is known of such a waste.
#[cfg(not(all(target_os = "linux", target_env = "gnu")))]
fn save_address_space() {}

/// What holds for every command: limits of the machine, which are to end in messages.
fn prepare(max_memory: Option<u64>) -> miette::Result<()> {
    tyndall_machine::memory::set_limit(max_memory).into_diagnostic()?;
    interrupt::survive_file_size_limit()?;
    // Helpers for tables and volumes: where the system gives no threads for them, this one does their work.
    if rayon::ThreadPoolBuilder::new().build_global().is_err() {
        let alone = rayon::ThreadPoolBuilder::new().num_threads(1).use_current_thread();
        alone.build_global().into_diagnostic()?;
    }
    Ok(())
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
