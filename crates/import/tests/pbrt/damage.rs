//! Whatever the bytes, a scene is read or refused: no panic, no hang, no memory that the file does not account for.

use std::path::{Path, PathBuf};

use crate::import;

/// A small generator of random numbers (Marsaglia 2003, xorshift).
struct Random(u64);

impl Random {
    fn below(&mut self, end: usize) -> usize {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 % end.max(1) as u64) as usize
    }
}

/// What damage puts in.
const SCRAPS: [&str; 24] = [
    "\"",
    "[",
    "]",
    "#",
    "\\",
    "\n",
    "-",
    "1e308",
    "nan",
    "0",
    "\"float x\"",
    "\"rgb L\" [ 1 1",
    "AttributeBegin ",
    "AttributeEnd ",
    "ObjectBegin \"o\" ",
    "ObjectEnd ",
    "ObjectInstance \"o\" ",
    "WorldBegin ",
    "Include \"scene.pbrt\" ",
    "MediumInterface \"vol\" \"fog\" ",
    "Scale 0 1 1 ",
    "Shape \"sphere\" ",
    "ReverseOrientation ",
    "\"texture alpha\" \"t\" ",
];

fn damaged(text: &[u8], random: &mut Random) -> Vec<u8> {
    let mut bytes = text.to_vec();
    for _ in 0..=random.below(3) {
        let place = random.below(bytes.len());
        // Mostly whole words are hit, so that some of the damage is found later than by the parser.
        let is_blank = |&byte: &u8| byte == b' ' || byte == b'\n';
        let blank = bytes[place..].iter().position(is_blank).map_or(place, |length| place + length);
        match random.below(6) {
            0 => bytes[place] = random.below(256) as u8,
            1 => bytes[place] = b"0123456789.-"[random.below(12)],
            2 if random.below(8) == 0 => bytes.truncate(place.max(1)),
            2 | 3 => {
                let line =
                    |from: usize| bytes[from..].iter().position(|&byte| byte == b'\n').map(|n| from + n);
                if let Some(begin) = line(place) {
                    let end = line(begin + 1).unwrap_or(bytes.len());
                    let copy = bytes[begin..end].to_vec();
                    match random.below(2) {
                        0 => drop(bytes.drain(begin..end)),
                        _ => drop(bytes.splice(begin..begin, copy)),
                    }
                }
            }
            4 => {
                let end = (place + random.below(40)).min(bytes.len());
                bytes.drain(place..end);
                bytes.push(b' ');
            }
            _ => {
                let scrap = SCRAPS[random.below(SCRAPS.len())];
                bytes.splice(blank..blank, [b" ", scrap.as_bytes(), b" "].concat());
            }
        }
    }
    bytes
}

/// A scene with a little of everything.
const EVERYTHING: &str = include_str!("everything.pbrt");

fn bench(name: &str) -> Option<Vec<u8>> {
    let folder = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../../../shared/bench/pbrt");
    let found = std::fs::read(folder.join(name)).ok();
    if found.is_none() {
        println!("skipped: {name} of the benchmark is not there");
    }
    found
}

fn survives(texts: &[Vec<u8>], rounds: usize, folder: &Path) {
    let mut random = Random(0x9e37_79b9_7f4a_7c15);
    let mut read = 0;
    for round in 0..rounds {
        let bytes = damaged(&texts[round % texts.len()], &mut random);
        let text = String::from_utf8_lossy(&bytes);
        match import(&text, folder) {
            Ok(imported) => {
                read += 1;
                assert!(imported.description.violations().is_empty(), "{text}");
            }
            Err(error) => assert!(!error.to_string().contains('\n'), "{error}"),
        }
    }
    // Damage that leaves some scenes sound also reaches what comes after the words.
    assert!(read > rounds / 20, "{read} of {rounds}");
}

#[test]
fn damaged_scenes_are_read_or_refused() {
    let folder = tempfile::tempdir().unwrap();
    let benches = ["C.pbrt", "E.pbrt", "F_R.pbrt"].into_iter().filter_map(bench);
    let texts: Vec<Vec<u8>> = std::iter::once(EVERYTHING.as_bytes().to_vec()).chain(benches).collect();
    let rounds =
        if std::env::var("TYNDALL_PROOF").is_ok_and(|effort| effort == "full") { 50_000 } else { 3000 };
    survives(&texts, rounds, folder.path());
}

#[test]
fn the_scene_with_a_little_of_everything_is_sound() {
    let scene = crate::scene(EVERYTHING);
    assert!(scene.is_whole(), "{:?}", scene.imported.notes);
    assert_eq!(scene.imported.description.shapes.len(), 11);
}

#[test]
fn deep_and_wide_scenes_are_bounded() {
    let folder = tempfile::tempdir().unwrap();
    let deep = format!("WorldBegin {}", "AttributeBegin ".repeat(100_000));
    let wide = format!("WorldBegin {}", "Attribute \"shape\" \"float radius\" 1 ".repeat(100_000));
    let many = format!(
        "WorldBegin ObjectBegin \"o\" {} ObjectEnd {}",
        "Shape \"sphere\" ".repeat(10_000),
        "ObjectInstance \"o\" ".repeat(10_000)
    );
    for (text, word) in [(deep, "1000 attribute blocks"), (wide, "1000 attributes"), (many, "2,000,000")] {
        let error = import(&text, folder.path()).map(|_| ()).unwrap_err().to_string();
        assert!(error.contains(word), "{error}");
    }
}
