//! `tyndall merge`: what belongs together adds up, what does not is refused, what is missing is told.

mod command;

use command::{BALL, Folder};

fn folder() -> Folder {
    let folder = Folder::new();
    folder.write("scene.toml", BALL);
    folder
}

#[test]
fn what_does_not_belong_together_is_refused_by_name() {
    let folder = folder();
    folder.done("render scene.toml --samples 0..4 -o a.acc");
    let mut newer = folder.accumulation("a.acc");
    newer.metadata.version = "9.9.9".into();
    newer.write(&folder.path("version.acc")).unwrap();
    folder.done("render scene.toml --samples 2..6 -o overlap.acc");
    for (name, options) in [
        ("seed", "--seed 3"),
        ("scene", "--set volume.0.mu_t=3"),
        ("size", "--resolution 8x8"),
        ("options", "--integrator reference"),
        ("layers", "--set film.layers=[\"depth\"]"),
    ] {
        folder.done(&format!("render scene.toml --samples 4..8 {options} -o {name}.acc"));
    }
    folder.write("cut.acc", &folder.read("a.acc")[..100]);
    for (name, word) in [
        ("overlap", "both hold samples 2..4"),
        ("version", "another version of tyndall (`9.9.9`"),
        ("seed", "another seed (`3`, not `0`)"),
        ("scene", "another scene"),
        ("size", "another scene"),
        ("options", "another options (`integrator=reference`"),
        ("layers", "different layers"),
        ("cut", "is damaged or cut short"),
    ] {
        let run = folder.run(&format!("merge a.acc {name}.acc -o refused.exr"));
        let names_it = run.error().starts_with(&format!("{name}.acc: "));
        assert!(run.code == Some(1) && names_it && run.error().contains(word), "{name}: {}", run.err);
        assert_eq!(run.err.lines().count(), 1, "{}", run.err);
    }
    assert!(!folder.path("refused.exr").exists());
}

/// The commands for what is missing, with the scene's name in place.
fn commands(folder: &Folder, line: &str) -> Vec<String> {
    let out = folder.done(line).out;
    out.lines().map(|line| line.strip_prefix("tyndall ").unwrap().replace("INPUT", "scene.toml")).collect()
}

#[test]
fn the_commands_for_what_is_missing_complete_the_picture() {
    let folder = Folder::new();
    let options = "--seed 4 --sampler sobol --adaptive --integrator reference";
    folder.done(&format!("render scene.toml --spp 16 {options} -o whole.acc"));
    std::fs::create_dir(folder.path("parts")).unwrap();
    for (start, end) in [(0, 3), (5, 6), (8, 12)] {
        let name = format!("parts/samples-{start}-{end}.acc");
        folder.done(&format!("render scene.toml --samples {start}..{end} {options} -o {name}"));
    }
    let parts = |folder: &Folder| {
        let entries = std::fs::read_dir(folder.path("parts")).unwrap();
        let names = entries.map(|entry| format!("parts/{} ", entry.unwrap().file_name().display()));
        names.collect::<String>()
    };
    assert_eq!(commands(&folder, &format!("merge {} --missing", parts(&folder))).len(), 2);
    // A part that was cut short on its way has to be made again.
    folder.write("parts/samples-5-6.acc", &folder.read("parts/samples-5-6.acc")[..99]);
    let run = folder.run(&format!("merge {} --missing --of 16", parts(&folder)));
    assert!(run.err.contains("note: parts/samples-5-6.acc: is damaged"), "{}", run.err);
    assert!(run.err.contains("these are missing: 3..8,12..16"), "{}", run.err);
    std::fs::remove_file(folder.path("parts/samples-5-6.acc")).unwrap();

    let commands = commands(&folder, &format!("merge {} --missing --of 16", parts(&folder)));
    assert!(commands[0].ends_with("-o parts/samples-3-8.acc"), "{commands:?}");
    commands.iter().for_each(|command| drop(folder.done(command)));
    let run = folder.done(&format!("merge {} --missing --of 16", parts(&folder)));
    assert!(run.out.is_empty() && run.err.contains("none is missing"), "{} {}", run.out, run.err);
    folder.done(&format!("merge {} -o merged.acc", parts(&folder)));
    assert!(folder.accumulation("merged.acc").film == folder.accumulation("whole.acc").film);
}

#[test]
fn what_is_missing_is_not_told_of_files_that_do_not_belong_together() {
    let folder = folder();
    folder.done("render scene.toml --samples 0..2 -o a.acc");
    folder.done("render scene.toml --samples 4..6 --seed 1 -o b.acc");
    folder.write("c.acc", "");
    for (line, code, word) in [
        ("merge a.acc b.acc --missing", 1, "another seed"),
        ("merge a.acc a.acc --missing", 1, "both hold samples 0..2"),
        ("merge c.acc --missing", 1, "no file is whole"),
        ("merge a.acc --missing -o b.exr", 2, "--output"),
        ("merge a.acc -o b.exr --of 9", 2, "--of"),
    ] {
        let run = folder.run(line);
        assert!(run.code == Some(code) && run.err.contains(word), "{line}: {}", run.err);
    }
}
