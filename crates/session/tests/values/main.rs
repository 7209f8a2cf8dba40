//! Bad values: every key of the native scene file is given what nobody means, and each time the scene is refused by one
//! line that names the key, or renders a finite picture.
//!
//! The keys are those of the schema, so that a new one is tried as soon as it stands in a base scene, which
//! `every_key_stands_in_a_base_scene` asks for. What is not refused is rendered by one of the engines in turns. With
//! `TYNDALL_PROOF=full` each is rendered by all of them.

mod bad_values;
mod base_scenes;
mod files;
mod half_space;
mod judge;
mod schema;
mod special_scenes;
mod watch;

use std::collections::BTreeSet;
use std::panic::{AssertUnwindSafe, catch_unwind};

use bad_values::bad_values;
use base_scenes::{BASE_SCENES, REST};
use files::write_files;
use judge::{Engine, Fate, fate};
use schema::{Leaves, Node};
use special_scenes::{Expected, SPECIAL_SCENES, write_special_files};
use toml::{Table, Value};
use watch::Watch;

/// What is allowed and takes long.
const TOO_MUCH: [(&str, &str); 4] = [
    (".medium.phase(mie).x: number", "100000.0"),
    (".medium.phase(mie).x: number", "99999.99999999999"),
    (".volume[].procedural(cumulus).resolution: integer", "2047"),
    (".volume[].procedural(cumulus).resolution: integer", "2048"),
];

/// Base scenes that take long to build: of their keys only some bad values are rendered.
const SLOW: [&str; 5] = ["sky", "coloured ground", "fire", "plastic", "procedural cloud"];

/// Keys of light whose brightness in the picture depends on lengths, on angles, or on grids: a sample that is too bright
/// for the film is left out, and counted.
const BRIGHT: [&str; 6] =
    ["intensity", "emission_per_length", "emission_grid", "temperature", "angular_diameter", "luminance"];

#[test]
fn every_key_stands_in_a_base_scene() {
    let leaves = Leaves::new();
    let reached: BTreeSet<String> = BASE_SCENES
        .iter()
        .flat_map(|(_, text)| leaves.of_scene(&base_scene(text)))
        .map(|node| node.leaf)
        .collect();
    let missing: Vec<&String> = leaves.all.difference(&reached).collect();
    assert!(missing.is_empty(), "put these into a base scene, in tests/values/base_scenes.rs: {missing:#?}");
}

#[test]
fn base_scenes_render() {
    let folder = tempfile::tempdir().expect("a folder for test files");
    write_files(folder.path());
    for (name, text) in BASE_SCENES {
        let fate = fate(&base_scene(text).to_string(), folder.path(), &[], &[Engine::Fast]);
        assert!(matches!(fate, Ok(Fate::Rendered { left_out: 0, .. })), "{name}: {fate:?}");
    }
}

#[test]
fn bad_values_are_refused_with_their_key_or_render_finite_pictures() {
    let folder = tempfile::tempdir().expect("a folder for test files");
    write_files(folder.path());
    let is_full = std::env::var("TYNDALL_PROOF").is_ok_and(|proof| proof == "full");
    let leaves = Leaves::new();
    let mut tried = BTreeSet::new();
    let mut wrong = Vec::new();
    let watch = Watch::start();
    let mut turn = 0;
    for (name, text) in BASE_SCENES {
        let scene = base_scene(text);
        for node in leaves.of_scene(&scene) {
            if !tried.insert(node.leaf.clone()) {
                continue;
            }
            for bad in bad_values(&node, at(&scene, &node.path)) {
                if TOO_MUCH.contains(&(&*node.leaf, &*bad.to_string())) {
                    continue;
                }
                turn += 1;
                let engines = match turn % if SLOW.contains(name) { 24 } else { 3 } {
                    _ if is_full => &Engine::ALL[..],
                    number if number < 3 => &Engine::ALL[number..=number],
                    _ => &[],
                };
                let case = format!("{name}: {} = {bad}", node.path.join("."));
                watch.next(&case);
                let text = with_value(&scene, &node, bad);
                let names = names(&node, &scene, folder.path().to_str());
                let fate = catch_unwind(AssertUnwindSafe(|| fate(&text, folder.path(), &names, engines)));
                match fate {
                    Ok(Ok(Fate::Rendered { left_out, .. }))
                        if left_out > 0
                            && !BRIGHT.iter().any(|key| node.path.iter().any(|other| other == key)) =>
                    {
                        wrong.push(format!("{case}: {left_out} samples were left out\n"));
                    }
                    Ok(Ok(_)) => {}
                    Ok(Err(why)) => wrong.push(format!("{case}: {why}\n")),
                    Err(_) => wrong.push(format!("{case}: panicked\n")),
                }
            }
        }
    }
    assert!(wrong.is_empty(), "{} of {turn}:\n{}", wrong.len(), wrong.concat());
}

#[test]
fn odd_scenes_are_rendered_or_refused_in_words() {
    let folder = tempfile::tempdir().expect("a folder for test files");
    write_files(folder.path());
    write_special_files(folder.path());
    let watch = Watch::start();
    let mut wrong = String::new();
    for (name, text, expected) in SPECIAL_SCENES {
        watch.next(name);
        let words = match expected {
            Expected::Refused(words) => *words,
            _ => "(none)",
        };
        let fate = fate(&base_scene(text).to_string(), folder.path(), &[words], &Engine::ALL);
        let is_as_expected = match (&fate, expected) {
            (Ok(Fate::Rendered { left_out: 0, .. }), Expected::Rendered) => true,
            (Ok(Fate::Rendered { left_out: 0, notes }), Expected::Noted(words)) => {
                notes.iter().any(|note| note.contains(words))
            }
            (Ok(Fate::Refused(_)), Expected::Refused(_)) => true,
            _ => false,
        };
        if !is_as_expected {
            wrong += &format!("{name}: {fate:?}\n");
        }
    }
    assert!(wrong.is_empty(), "{wrong}");
}

/// The base scene of this text, with what it leaves out.
fn base_scene(text: &str) -> Table {
    let mut scene: Table = REST.parse().expect("TOML");
    let tables: Table = text.parse().unwrap_or_else(|error| panic!("{error}\n{text}"));
    scene.extend(tables);
    scene
}

/// The scene with a bad value in the place of a sound one.
fn with_value(scene: &Table, node: &Node<'_>, bad: Value) -> String {
    let mut scene = Value::Table(scene.clone());
    let place = node.path.iter().fold(&mut scene, |value, key| match value {
        Value::Array(items) => &mut items[key.parse::<usize>().expect("a number")],
        value => &mut value[key.as_str()],
    });
    *place = bad;
    toml::to_string(&scene).expect("a table")
}

/// What a refusal may be known by: the keys that lead to the value, those beside it, which it may contradict, what
/// those name, or the folder of a file.
fn names<'a>(node: &'a Node<'_>, scene: &'a Table, folder: Option<&'a str>) -> Vec<&'a str> {
    let keys = node.path.iter().map(String::as_str).filter(|key| key.parse::<usize>().is_err());
    let mut names: Vec<&str> = keys.chain(folder).collect();
    for length in 1..node.path.len() {
        if let Value::Table(table) = at(scene, &node.path[..length]) {
            names.extend(table.keys().map(String::as_str));
            names.extend(table.values().filter_map(Value::as_str));
        }
    }
    names
}

fn at<'a>(scene: &'a Table, path: &[String]) -> &'a Value {
    let (first, rest) = path.split_first().expect("a path");
    rest.iter().fold(&scene[first.as_str()], |value, key| match value {
        Value::Array(items) => &items[key.parse::<usize>().expect("a number")],
        value => &value[key.as_str()],
    })
}
