//! Killed at any time, without a chance to save, and resumed until done, a render has the bits of one that was left alone.

use std::os::unix::process::ExitStatusExt;
use std::process::{Child, Stdio};
use std::time::Duration;

use crate::command::Folder;
use tyndall_film::comparison::Picture;

/// A ball of fog, which is quick to build, for some tenths of a second.
const BALL: &str = r#"
camera = { position = [0, 0, 4], target = [0, 0, 0] }
film = { resolution = [64, 48] }
render = { spp = 10 }
volume = [{ sphere = { center = [0, 0, 0], radius = 1 }, mu_t = 4, albedo = 0.9 }]
light = [{ type = "point", position = [2, 2, 2], intensity = 9 }]
"#;

/// A folder with the ball, and its picture made without interruption.
fn folder() -> Folder {
    let folder = Folder::new();
    folder.write("ball.toml", BALL);
    folder.done("render ball.toml -o whole.acc -o whole.exr");
    folder
}

/// Starts the render from the checkpoint, if there is one.
fn resume(folder: &Folder) -> Child {
    let line =
        "render ball.toml --checkpoint check.acc --checkpoint-every 0.02s --resume -o part.acc -o part.exr";
    folder.command(line).stdout(Stdio::null()).stderr(Stdio::null()).spawn().unwrap()
}

/// Whether it was killed; all that is not killed succeeds.
fn was_killed(mut child: Child) -> bool {
    child.kill().unwrap();
    let status = child.wait().unwrap();
    assert!(status.success() || status.signal() == Some(9), "{status}");
    !status.success()
}

/// The finished picture is the one that was left alone, and nothing else is there; then away with it.
fn compare_and_clear(folder: &Folder) {
    for [part, whole] in [["part.acc", "whole.acc"], ["check.acc", "whole.acc"]] {
        assert!(folder.accumulation(part).film == folder.accumulation(whole).film, "{part}");
    }
    let pixels = |name: &str| Picture::read(&folder.path(name)).unwrap();
    assert!(pixels("part.exr") == pixels("whole.exr"));
    assert_eq!(parts(folder), 0, "{:?}", folder.names());
    for name in ["part.acc", "part.exr", "check.acc"] {
        std::fs::remove_file(folder.path(name)).unwrap();
    }
}

/// Temporary files.
fn parts(folder: &Folder) -> usize {
    folder.names().iter().filter(|name| name.ends_with(".part")).count()
}

#[test]
fn fifty_kills_at_random_times_change_no_bit() {
    let folder = folder();
    let (mut kills, mut pictures) = (0, 0);
    let mut state = 6_u64;
    while kills < 50 || pictures == 0 {
        let child = resume(&folder);
        // Most ends of these times fall into the render, some before it and some after.
        std::thread::sleep(Duration::from_micros(20_000 + next(&mut state) % 180_000));
        if was_killed(child) {
            kills += 1;
            assert!(kills < 1000, "no render gets to its end between two kills");
            // Whatever it was about: a checkpoint is whole, and of the leftovers of each target one at most remains.
            assert!(
                !folder.path("check.acc").exists() || folder.accumulation("check.acc").film.width() == 64
            );
            assert!(parts(&folder) <= 3, "{:?}", folder.names());
        } else {
            pictures += 1;
            compare_and_clear(&folder);
        }
    }
    assert!(resume(&folder).wait().unwrap().success());
    compare_and_clear(&folder);
}

/// Steps of a generator of numbers that look random.
fn next(state: &mut u64) -> u64 {
    *state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
    *state >> 33
}

#[test]
fn a_kill_while_outputs_are_written_leaves_each_the_old_one_or_the_new_one() {
    let folder = folder();
    let names = ["out.exr", "out.png", "out.acc", "out.json"];
    let merge = "merge whole.acc -o out.exr -o out.png -o out.acc -o out.json";
    folder.done(merge);
    let new = names.map(|name| folder.read(name));
    let (mut kills, mut replaced, mut state) = (0, 0, 7);
    while kills < 25 || replaced == 0 {
        names.iter().for_each(|name| folder.write(name, "old"));
        let child = folder.command(merge).stdout(Stdio::null()).stderr(Stdio::null()).spawn().unwrap();
        std::thread::sleep(Duration::from_micros(5_000 + next(&mut state) % 60_000));
        kills += u32::from(was_killed(child));
        for (name, new) in names.iter().zip(&new) {
            let found = folder.read(name);
            assert!(found == b"old" || found == *new, "{name} is neither");
            replaced += u32::from(found == *new);
        }
    }
    // The next run clears away what they left.
    folder.done(merge);
    assert_eq!(parts(&folder), 0, "{:?}", folder.names());
}

#[test]
fn a_kill_while_the_checkpoint_is_written_leaves_the_one_before_and_nothing_that_stays() {
    let folder = folder();
    let (mut rounds, mut caught) = (0, 0);
    while rounds < 5 {
        let mut child = resume(&folder);
        while parts(&folder) == 0 && child.try_wait().unwrap().is_none() {}
        if was_killed(child) {
            rounds += 1;
            caught += parts(&folder);
            if folder.path("check.acc").exists() {
                assert!(folder.accumulation("check.acc").film.complete().count() > 0);
            }
            // It goes on for long enough to write further checkpoints, and clears up first.
            let child = resume(&folder);
            std::thread::sleep(Duration::from_millis(60));
            if !was_killed(child) {
                compare_and_clear(&folder);
            }
        } else {
            compare_and_clear(&folder);
        }
    }
    assert!(caught > 0, "no kill met a temporary file");
    assert!(resume(&folder).wait().unwrap().success());
    compare_and_clear(&folder);
}
