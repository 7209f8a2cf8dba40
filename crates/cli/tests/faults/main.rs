//! What goes wrong around Tyndall costs no more than the time since the last checkpoint, and is said in one line: disks that
//! are full, folders that are gone, kills, damaged checkpoints, two of a kind, and limits of the machine.
#![cfg(unix)]

#[path = "../command/mod.rs"]
mod command;

mod damaged_checkpoints;
mod disk;
mod files;
mod kills;
mod limits;
mod signals;

use std::process::{Command, Stdio};

use command::{Folder, Run};

/// Runs a script of `sh` in which `tyndall` is the command under test.
fn shell(folder: &Folder, script: &str) -> Run {
    let run = Run::from(shell_command(folder, script).output().unwrap());
    assert!(!run.err.contains("panicked"), "{script}: {}", run.err);
    run
}

fn shell_command(folder: &Folder, script: &str) -> Command {
    let mut command = Command::new("sh");
    let script = script.replace("tyndall ", concat!(env!("CARGO_BIN_EXE_tyndall"), " "));
    command.args(["-c", &script]).current_dir(folder.path("")).stdin(Stdio::null());
    command.env("TYNDALL_CACHE", folder.path("cache")).env("TMPDIR", folder.path(""));
    command
}

/// Runs a script that must fail with one line, and returns that.
fn refused(folder: &Folder, script: &str) -> String {
    let run = shell(folder, script);
    assert_eq!(run.code, Some(1), "{script}: {}", run.err);
    assert_eq!(run.out, "", "{script}");
    let errors: Vec<&str> = run.err.lines().filter(|line| line.starts_with("error: ")).collect();
    assert_eq!(errors.len(), 1, "{script}: {}", run.err);
    errors[0].to_owned()
}
