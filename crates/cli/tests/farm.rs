//! The recipes of `docs/farm.md`, run as they stand there: parts, merged, are the whole.
#![cfg(unix)]

mod command;

use std::path::Path;
use std::process::Command;

use command::{BALL, Folder};

/// The first block of code in `docs/farm.md` with these words.
fn recipe(words: &str) -> String {
    let text = include_str!("../../../docs/farm.md");
    let mut blocks = text.split("\n```").skip(1).step_by(2);
    let block = blocks.find(|block| block.contains(words)).unwrap_or_else(|| panic!("{words}"));
    block.split_once('\n').unwrap().1.to_owned()
}

/// Runs a script where `tyndall` is the command under test.
fn shell(folder: &Folder, script: &str, variables: &[(&str, &str)]) {
    let programs = Path::new(env!("CARGO_BIN_EXE_tyndall")).parent().unwrap();
    let path = format!("{}:{}", programs.display(), std::env::var("PATH").unwrap());
    let output = Command::new("sh")
        .args(["-e", "-c", script])
        .current_dir(folder.path(""))
        .env("PATH", path)
        .envs(variables.iter().copied())
        .output()
        .unwrap();
    assert!(output.status.success(), "{script}: {}", String::from_utf8_lossy(&output.stderr));
}

#[test]
fn every_recipe_renders_parts_of_the_same_picture() {
    let folder = Folder::new();
    folder.write("cloud.toml", BALL);
    folder.done("render cloud.toml --spp 1024 -o whole.acc");
    let whole = || folder.accumulation("whole.acc").film;

    shell(&folder, &recipe("xargs -P"), &[]);
    assert!(folder.accumulation("cloud.acc").film == whole());
    assert!(folder.path("cloud.exr").exists() && folder.path("cloud.png").exists());

    // Parts that have got lost are made by the other recipes.
    let part = |first: u32| format!("parts/{first}.acc");
    let lost = |first: u32| {
        let film = folder.accumulation(&part(first)).film;
        std::fs::remove_file(folder.path(&part(first))).unwrap();
        film
    };
    let task = 5;
    let film = lost(task * 64);
    shell(&folder, &recipe("SLURM_ARRAY_TASK_ID"), &[("SLURM_ARRAY_TASK_ID", "5")]);
    assert!(folder.accumulation(&part(task * 64)).film == film);

    let film = lost(task * 64);
    let job = recipe("JOB_COMPLETION_INDEX");
    let (_, arguments) = job.split_once("- first").unwrap();
    let (arguments, _) = arguments.split_once("volumeMounts").unwrap();
    shell(&folder, &format!("first{}", arguments.replace('\n', " ")), &[("JOB_COMPLETION_INDEX", "5")]);
    assert!(folder.accumulation(&part(task * 64)).film == film);

    for (first, last, command) in [
        ("<STARTFRAME>", "<ENDFRAME>", format!("tyndall {}", recipe("<STARTFRAME>..="))),
        ("#FRAME_START#", "#FRAME_END#", recipe("#FRAME_START#")),
    ] {
        let film = lost(task * 64);
        shell(&folder, &command.replace(first, "320").replace(last, "383"), &[]);
        assert!(folder.accumulation(&part(task * 64)).film == film);
    }

    for first in [128, 192, 960] {
        lost(first);
    }
    shell(&folder, &recipe("s/INPUT/"), &[]);
    shell(&folder, "tyndall merge parts/*.acc -o merged.acc", &[]);
    assert!(folder.accumulation("merged.acc").film == whole());
}
