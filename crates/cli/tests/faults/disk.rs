//! A full disk, by a limit on the size of files, which anybody may set: writing beyond it fails as on a full disk.

use std::io::{BufRead, BufReader};
use std::process::Stdio;

use crate::command::{BALL, Folder};
use crate::{refused, shell, shell_command};

/// A folder with a ball of fog and a small volume.
fn folder() -> Folder {
    let folder = Folder::new();
    folder.write("ball.toml", BALL);
    folder.write("v_8x8x8_uint8.raw", (0..512).map(|i| i as u8).collect::<Vec<u8>>());
    folder
}

#[test]
fn what_cannot_be_written_is_named_and_the_old_file_stays_whole() {
    let folder = folder();
    folder.done("render ball.toml -o ball.acc");
    let before = |folder: &Folder| folder.names().len();
    for (line, name) in [
        ("render ball.toml -o a.exr", "a.exr"),
        ("render ball.toml -o a.png", "a.png"),
        ("render ball.toml -o a.acc", "a.acc"),
        ("render ball.toml -o a.json", "a.json"),
        ("merge ball.acc -o a.exr", "a.exr"),
        ("convert v_8x8x8_uint8.raw a.vdb", "a.vdb"),
        ("convert v_8x8x8_uint8.raw a.nvdb", "a.nvdb"),
        ("convert v_8x8x8_uint8.raw a.npy", "a.npy"),
        ("convert v_8x8x8_uint8.raw a.vol", "a.vol"),
        ("convert v_8x8x8_uint8.raw a.nii.gz", "a.nii.gz"),
        ("phase rayleigh -o a.svg", "a.svg"),
    ] {
        folder.write(name, "old");
        let names = before(&folder);
        let error = refused(&folder, &format!("ulimit -f 0; exec tyndall {line}"));
        assert!(error.starts_with(&format!("error: {name}: ")), "{line}: {error}");
        assert!(error.contains("File too large"), "{line}: {error}");
        assert_eq!(folder.read(name), b"old", "{line}");
        assert_eq!(before(&folder), names, "{line}: {:?}", folder.names());
        std::fs::remove_file(folder.path(name)).unwrap();
    }
}

#[test]
fn one_output_that_fails_does_not_keep_the_picture_from_the_others() {
    let folder = folder();
    let limited = "ulimit -f 8; exec tyndall render ball.toml --resolution 200x150 --spp 1";
    let error = refused(&folder, &format!("{limited} -o a.exr -o a.json"));
    assert!(error.starts_with("error: a.exr: "), "{error}");
    assert!(folder.path("a.json").exists() && !folder.path("a.exr").exists());
}

#[test]
fn a_picture_that_cannot_be_written_is_kept_in_the_checkpoint_or_among_temporary_files() {
    let folder = folder();
    std::fs::create_dir(folder.path("out")).unwrap();
    // The folder of the picture is gone when it is to be written.
    let render = |options: &str| {
        let line = format!(
            "tyndall render ball.toml --spp 1000000 --time 60s -o out/a.exr {options} --progress json"
        );
        let mut command = shell_command(&folder, &format!("exec {line}"));
        let mut child = command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
        let mut reports = BufReader::new(child.stdout.take().unwrap()).lines();
        let _ = (reports.next(), reports.next());
        std::fs::remove_dir(folder.path("out")).unwrap();
        std::process::Command::new("kill").args(["-INT", &child.id().to_string()]).status().unwrap();
        // Nobody reads further reports: whether anyone does is no matter.
        drop(reports);
        let output = child.wait_with_output().unwrap();
        std::fs::create_dir(folder.path("out")).unwrap();
        (output.status.code(), String::from_utf8(output.stderr).unwrap())
    };
    let (code, err) = render("--checkpoint c.acc");
    assert!(code == Some(1) && err.contains("what was rendered is in c.acc"), "{err}");
    assert!(folder.accumulation("c.acc").film.mean_sample_count() > 0.0);
    std::fs::remove_file(folder.path("c.acc")).unwrap();

    let (code, err) = render("");
    assert!(code == Some(1) && err.contains("tyndall-rescued-"), "{err}");
    assert!(err.contains("error: out/a.exr: the folder out does not exist"), "{err}");
    let names = folder.names();
    let rescued = names.iter().find(|name| name.starts_with("tyndall-rescued-")).unwrap();
    assert!(folder.accumulation(rescued).film.mean_sample_count() > 0.0);
}

#[test]
fn a_render_whose_checkpoint_cannot_be_written_goes_on_and_says_so_once() {
    let folder = folder();
    let line = "ulimit -f 8; exec tyndall render ball.toml --resolution 200x150 --spp 8 -o a.json";
    let run = shell(&folder, &format!("{line} --checkpoint c.acc --checkpoint-every 0.001s"));
    assert_eq!(run.code, Some(1), "{}", run.err);
    assert_eq!(run.err.matches("note: no checkpoint for now: c.acc: ").count(), 1, "{}", run.err);
    assert!(run.err.contains("error: c.acc: "), "{}", run.err);
    assert!(folder.path("a.json").exists() && !folder.path("c.acc").exists());
}

#[test]
fn checkpoints_that_can_be_written_again_are_and_that_is_said() {
    let folder = folder();
    std::fs::create_dir(folder.path("d")).unwrap();
    let line = "render ball.toml --resolution 64x48 --spp 1000000 --time 60s -o a.json";
    let mut command = folder.command(&format!("{line} --checkpoint d/c.acc --checkpoint-every 0.01s"));
    let mut child = command.stderr(Stdio::piped()).spawn().unwrap();
    let mut lines = BufReader::new(child.stderr.take().unwrap()).lines().map(Result::unwrap);
    while !folder.path("d/c.acc").exists() {
        assert!(child.try_wait().unwrap().is_none());
    }
    std::fs::rename(folder.path("d"), folder.path("e")).unwrap();
    assert!(
        lines.any(|line| line.starts_with("note: no checkpoint for now: d/c.acc: the folder d does not"))
    );
    std::fs::rename(folder.path("e"), folder.path("d")).unwrap();
    assert!(lines.any(|line| line == "note: checkpoints are written again"));
    std::process::Command::new("kill").args(["-TERM", &child.id().to_string()]).status().unwrap();
    assert_eq!(child.wait().unwrap().code(), Some(143));
    assert!(folder.accumulation("d/c.acc").film.mean_sample_count() > 0.0);
}
