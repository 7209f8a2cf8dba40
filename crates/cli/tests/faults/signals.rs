//! Signals: what is not asked to stop goes on, and what is asked twice stops at once.

use std::io::{BufRead, BufReader};
use std::process::Stdio;

use crate::command::{BALL, Folder};
use crate::{shell, shell_command};

/// Starts `sh` with a long render, after `before`, and sends it signals once it reports; its exit code.
fn signalled(folder: &Folder, before: &str, names: &[&str]) -> Option<i32> {
    folder.write("ball.toml", BALL);
    let line = "exec tyndall render ball.toml --spp 100000000 --time 60s -o a.acc --progress json";
    let mut command = shell_command(folder, &format!("{before}{line}"));
    let mut child = command.stdout(Stdio::piped()).stderr(Stdio::null()).spawn().unwrap();
    let mut reports = BufReader::new(child.stdout.take().unwrap()).lines();
    for name in names {
        // The next report shows that it is still there; the first but one that samples are.
        let _ = (reports.next(), reports.next());
        std::process::Command::new("kill").args([*name, &child.id().to_string()]).status().unwrap();
    }
    child.wait().unwrap().code()
}

#[test]
fn what_is_ignored_from_the_start_stays_so() {
    let folder = Folder::new();
    // As `nohup` starts programs, and shells those in the background.
    assert_eq!(signalled(&folder, "trap '' HUP; ", &["-HUP", "-TERM"]), Some(143));
    assert!(folder.accumulation("a.acc").film.mean_sample_count() > 0.0);
}

#[test]
fn a_second_signal_ends_the_program_and_harms_no_file() {
    let folder = Folder::new();
    folder.write("ball.toml", BALL);
    let line = "render ball.toml --resolution 1000x1000 --spp 1000 --time 60s -o a.exr --progress json";
    folder.write("a.exr", "old");
    let mut command = folder.command(line);
    let mut child = command.stdout(Stdio::piped()).stderr(Stdio::null()).spawn().unwrap();
    let mut reports = BufReader::new(child.stdout.take().unwrap()).lines();
    let _ = (reports.next(), reports.next());
    for _ in 0..2 {
        std::process::Command::new("kill").args(["-INT", &child.id().to_string()]).status().unwrap();
    }
    assert_eq!(child.wait().unwrap().code(), Some(130));
    let found = folder.read("a.exr");
    assert!(found == b"old" || tyndall_film::comparison::Picture::read(&folder.path("a.exr")).is_ok());
}

#[test]
fn a_reader_that_has_seen_enough_is_no_error() {
    let folder = Folder::new();
    for line in ["tyndall schema", "tyndall inspect scene.toml", "tyndall phase rayleigh"] {
        let run = shell(&folder, &format!("{{ {line} ; echo $? >&2; }} | head -n 1"));
        assert_eq!((run.out.lines().count(), run.err.as_str()), (1, "0\n"), "{line}");
    }
}
