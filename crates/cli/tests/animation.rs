//! `render --frames`: one picture a frame, with the bits of the frame alone; resumable; nothing flickers.

mod command;

#[cfg(unix)]
use std::io::{BufRead, BufReader};
#[cfg(unix)]
use std::process::Stdio;

use command::Folder;
use serde_json::Value;

/// A NumPy file of 8³ voxels with a ball in it.
fn ball(radius: f32, value: f32) -> Vec<u8> {
    let header = format!("{:<117}\n", "{'descr': '<f4', 'fortran_order': False, 'shape': (8, 8, 8), }");
    let mut file = b"\x93NUMPY\x01\x00".to_vec();
    file.extend((header.len() as u16).to_le_bytes());
    file.extend(header.as_bytes());
    for i in 0..512 {
        let from_centre = [i % 8, i / 8 % 8, i / 64].map(|x| x as f32 - 3.5);
        let distance = from_centre.iter().map(|x| x * x).sum::<f32>().sqrt();
        file.extend((if distance < radius { value } else { 0.0 }).to_le_bytes());
    }
    file
}

/// A scene with the ball of each frame.
const SCENE: &str = r#"
camera = { position = [4, 4, 24], target = [4, 4, 4] }
film = { resolution = [24, 16] }
render = { spp = 4 }
volume = [{ file = "ball.##.npy", mu_t = 1, albedo = 0.9 }]
light = [{ type = "constant", radiance = 1 }]
"#;

/// A folder with a sequence of five balls that grow, and the scene.
fn folder() -> Folder {
    let folder = Folder::new();
    folder.write("scene.toml", SCENE);
    for frame in 1..=5 {
        folder.write(&format!("ball.0{frame}.npy"), ball(0.8 * frame as f32, 0.5 * frame as f32));
    }
    folder
}

fn same_film(folder: &Folder, a: &str, b: &str) {
    assert!(folder.accumulation(a).film == folder.accumulation(b).film, "{a} and {b} differ");
}

#[test]
fn each_frame_has_the_bits_of_a_render_of_its_own() {
    let folder = folder();
    let run = folder.done("render scene.toml --frames 1..5:2 -o out.###.acc -o out.png");
    assert!(run.err.contains("frame 3 (2 of 3): 24x16, 4 samples"), "{}", run.err);
    for frame in [1, 3, 5] {
        folder.write("alone.toml", SCENE.replace("##", &format!("0{frame}")));
        folder.done("render alone.toml -o alone.acc -o alone.png");
        same_film(&folder, &format!("out.00{frame}.acc"), "alone.acc");
        assert!(folder.read(&format!("out.000{frame}.png")) == folder.read("alone.png"));
        let hash = |name: &str| folder.accumulation(name).metadata.scene_hash;
        assert_eq!(hash(&format!("out.00{frame}.acc")), hash("alone.acc"));
    }
    assert!(!folder.path("out.002.acc").exists());
    folder.done("render scene.toml --frames 2 -o single.exr");
    assert!(folder.path("single.0002.exr").exists());
}

#[test]
fn what_is_chosen_for_a_bare_volume_is_chosen_from_the_first_frame_and_kept() {
    let folder = folder();
    let options = "--resolution 24x16 --set render.spp=2";
    folder.done(&format!("render ball.##.npy --frames 2..4 {options} -o a.acc"));
    let scene = folder.done(&format!("render ball.##.npy --frames 2..4 {options} --print-scene")).out;
    assert!(scene.contains("ball.##.npy"), "{scene}");
    let first = folder.done(&format!("render ball.02.npy {options} --print-scene")).out;
    for frame in [2, 3, 4] {
        folder.write("kept.toml", first.replace("ball.02", &format!("ball.0{frame}")));
        folder.done("render kept.toml -o kept.acc");
        same_film(&folder, &format!("a.000{frame}.acc"), "kept.acc");
    }
    // Of its own, another frame would choose another density.
    folder.done(&format!("render ball.04.npy {options} -o own.acc"));
    assert!(folder.accumulation("own.acc").film != folder.accumulation("a.0004.acc").film);
    folder.write("printed.toml", scene);
    folder.done("render printed.toml --frames 4 -o printed.acc");
    same_film(&folder, "printed.0004.acc", "a.0004.acc");
}

#[test]
fn frames_may_have_scene_files_and_values_of_their_own() {
    let folder = folder();
    for frame in 1..=2 {
        folder.write(&format!("view.{frame}.toml"), SCENE.replace("24]", &format!("2{frame}]")));
    }
    folder.done("render view.#.toml --frames 1..2 --set render.seed=# -o a.acc");
    folder.done("render scene.toml --frames 2 --seed 2 --set camera.position=[4,4,22] -o b.acc");
    same_film(&folder, "a.0002.acc", "b.0002.acc");
    assert_eq!(folder.accumulation("a.0001.acc").metadata.seed, 1);
}

#[test]
fn frames_that_are_there_are_skipped_and_others_are_not() {
    let folder = folder();
    folder.done("render scene.toml --frames 1..4 -o a.exr -o a.png -o a.json -o a.acc");
    let before = |frame: u32| {
        ["exr", "png", "json", "acc"].map(|extension| folder.read(&format!("a.000{frame}.{extension}")))
    };
    let first = before(1);
    folder.write("a.0002.exr", &folder.read("a.0002.exr")[..900]);
    std::fs::remove_file(folder.path("a.0003.png")).unwrap();
    folder.write("ball.04.npy", ball(1.0, 1.0));
    let resume = "render scene.toml --frames 1..4 -o a.exr -o a.png -o a.json -o a.acc --resume";
    let run = folder.done(resume);
    assert!(run.err.ends_with("1 of 4 frames were there already\n"), "{}", run.err);
    for frame in 2..=4 {
        assert!(run.err.contains(&format!("wrote a.000{frame}.exr")), "{}", run.err);
    }
    assert!(before(1) == first && folder.path("a.0003.png").exists());
    let again = folder.done(resume);
    assert_eq!(again.err, "4 of 4 frames were there already\n");
    let more = folder.done(&format!("{resume} --spp 5"));
    assert!(more.err.contains("wrote a.0001.exr"), "{}", more.err);
}

#[test]
fn frames_that_cannot_be_rendered_are_told_before_the_first_is() {
    let folder = folder();
    std::fs::remove_file(folder.path("ball.04.npy")).unwrap();
    folder.write("still.toml", SCENE.replace("##", "01"));
    folder.write("a.0002.acc", "");
    for (line, words) in [
        ("scene.toml --frames 1..5 -o b.png", ["ball.04.npy", "frame 4"]),
        ("ball.##.npy --frames 1..5 -o b.png", ["ball.04.npy", "frame 4"]),
        ("view.##.toml --frames 1..5 -o b.png", ["view.01.toml", "no such file"]),
        ("still.toml --frames 1..2 -o b.png", ["still.toml", "all frames would be the same"]),
        ("--frames 1..2 -o b.png", ["--frames", "built-in"]),
        ("scene.toml --frames 1..2 -o b.png --checkpoint a.acc", ["a.0002.acc", "--resume"]),
        ("scene.toml --frames 1..2 -o no/b.png", ["no/b.0001.png", "create it"]),
    ] {
        let run = folder.run(&format!("render {line}"));
        assert!(run.code == Some(1) && run.err.lines().count() == 1, "{line}: {}", run.err);
        assert!(words.iter().all(|word| run.error().contains(word)), "{line}: {}", run.err);
    }
    assert_eq!(folder.run("render scene.toml --frames 3..1").code, Some(2));
    assert!(!folder.names().iter().any(|name| name.starts_with("b.")));
}

#[test]
fn a_damaged_frame_ends_the_animation_after_those_before_it() {
    let folder = folder();
    folder.write("ball.03.npy", &ball(1.0, 1.0)[..200]);
    let run = folder.run("render scene.toml --frames 1..5 -o a.acc");
    assert!(run.code == Some(1) && run.err.contains("error: ball.03.npy: "), "{}", run.err);
    assert!(folder.path("a.0002.acc").exists() && !folder.path("a.0004.acc").exists());
}

#[test]
fn progress_names_the_frame() {
    let folder = folder();
    let run = folder.done("render scene.toml --frames 2..3 --progress json -o a.png");
    let lines: Vec<Value> = run.out.lines().map(|line| serde_json::from_str(line).unwrap()).collect();
    let frames: Vec<&Value> = lines.iter().map(|line| &line["frame"]).collect();
    assert!(frames.contains(&&Value::from(2)) && frames.last() == Some(&&Value::from(3)), "{}", run.out);
    assert_eq!(lines.last().unwrap()["samples"], 4.0);
}

#[cfg(unix)]
#[test]
fn an_interrupted_frame_goes_on_from_its_checkpoint_and_leaves_no_half_picture() {
    let folder = folder();
    // Of the second frame samples that take many minutes, or the time if the test fails.
    let long = "render scene.toml --frames 2..3 --spp 1000000 --time 60s -o a.acc --checkpoint c.acc";
    let mut child = folder
        .command(&format!("{long} --checkpoint-every 0.05s --progress json"))
        .stdout(Stdio::piped())
        .stderr(Stdio::null())
        .spawn()
        .unwrap();
    let lines = BufReader::new(child.stdout.take().unwrap()).lines();
    assert_eq!(lines.take(2).filter(Result::is_ok).count(), 2);
    let id = child.id().to_string();
    assert!(std::process::Command::new("kill").args(["-INT", &id]).status().unwrap().success());
    assert_eq!(child.wait().unwrap().code(), Some(130));
    assert!(!folder.path("a.0002.acc").exists() && !folder.path("c.0003.acc").exists());
    // Beyond what any tile may have reached.
    let end = folder.accumulation("c.0002.acc").film.complete().count() + 20;
    let short = format!("render scene.toml --frames 2..3 --spp {end}");
    folder.done(&format!("{short} -o a.acc --checkpoint c.acc --resume"));
    folder.done(&format!("{short} -o whole.acc"));
    same_film(&folder, "a.0002.acc", "whole.0002.acc");
    assert!(!folder.names().iter().any(|name| name.starts_with("c.")), "{:?}", folder.names());
}
