//! The same bits on every processor: small pictures of the gallery's scenes against recorded hashes, as this processor
//! makes them, and as ones without vectors and without fused multiplication would.
//!
//! A hash changes if the picture of a scene changes in its last bit: then either that was wanted, and
//! `UPDATE_GOLDEN=1 cargo test -p tyndall-transport --test proof golden` records it anew, or it is a bug.

use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::process::Command;

use tyndall_film::Film;
use tyndall_scene::{Scene, SceneDocument};

use crate::rendering::{BOTH, options, render_of_seed};

const SAMPLES: u64 = 3;

fn recorded() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/proof/golden.txt")
}

/// The scene files of the gallery, by their names within it.
fn gallery() -> Vec<(String, PathBuf)> {
    let examples = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples");
    let folders = std::fs::read_dir(&examples).expect("the gallery is there");
    let folders = folders.map(|entry| entry.expect("it can be listed").path()).filter(|path| path.is_dir());
    let files = folders.flat_map(|folder| std::fs::read_dir(folder).expect("a chapter is a folder"));
    let files = files.map(|entry| entry.expect("it can be listed").path());
    let scenes = files.filter(|path| path.extension().is_some_and(|extension| extension == "toml"));
    let name = |path: &PathBuf| path.strip_prefix(&examples).expect("it is within").display().to_string();
    let mut scenes: Vec<_> = scenes.map(|path| (name(&path).replace('\\', "/"), path)).collect();
    scenes.sort();
    scenes
}

/// The scene with a small picture, little procedural detail, and droplets that are soon summed up.
fn small(path: &Path) -> Scene {
    let mut document = SceneDocument::read(path).expect("the gallery's scenes can be read");
    document.set("film.resolution=[12, 8]").expect("a film has a resolution");
    let text = std::fs::read_to_string(path).expect("it was read just now");
    for (number, volume) in text.split("[[volume]]").skip(1).enumerate() {
        if volume.contains("procedural") {
            document.set(&format!("volume.{number}.procedural.resolution=16")).expect("it is procedural");
        }
        if volume.contains("r_eff") {
            document.set(&format!("volume.{number}.phase.distribution.r_eff=\"0.5um\"")).expect("droplets");
        }
    }
    let description = document.description().expect("a scene of the gallery is sound");
    tyndall_scene::build(&description, document.folder()).expect("and can be built").scene
}

/// A hash of every number that the film tells (FNV-1a, 64 bits).
fn hash(film: &Film) -> u64 {
    let mut hash = 0xcbf2_9ce4_8422_2325_u64;
    let mut take = |number: f64| {
        for byte in number.to_bits().to_le_bytes() {
            hash = (hash ^ u64::from(byte)).wrapping_mul(0x100_0000_01b3);
        }
    };
    for y in 0..film.height() {
        for x in 0..film.width() {
            film.mean(x, y).into_iter().chain(film.standard_error(x, y)).for_each(&mut take);
        }
    }
    hash
}

/// A line a scene, by a seed that fresh ones do not change: its hash by the reference and by the fast integrator, or both by the spectral ones.
fn hashes() -> String {
    let mut lines = String::new();
    for (name, path) in gallery() {
        let scene = small(&path);
        let [reference, fast] =
            BOTH.map(|integrator| hash(&render_of_seed(&scene, options(integrator, 7), 0..SAMPLES)));
        writeln!(lines, "{reference:016x} {fast:016x} {name}").expect("text takes text");
    }
    lines
}

#[test]
fn pictures_have_the_recorded_bits() {
    let hashes = hashes();
    if std::env::var_os("UPDATE_GOLDEN").is_some() {
        std::fs::write(recorded(), &hashes).expect("the tests' folder can be written to");
    }
    let recorded = std::fs::read_to_string(recorded()).expect("hashes were recorded");
    for (now, before) in hashes.lines().zip(recorded.lines()) {
        assert_eq!(now, before, "other bits than recorded");
    }
    assert_eq!(hashes.lines().count(), recorded.lines().count(), "scenes came or went");
}

#[test]
fn a_processor_without_vectors_or_fused_multiplication_makes_the_same_bits() {
    check_again("none", "glibc.cpu.hwcaps=-AVX512F,-AVX2,-AVX,-FMA,-FMA4");
}

/// Where the processor has AVX-512; elsewhere it is what the test of the recorded bits does.
#[test]
fn a_processor_without_avx512_makes_the_same_bits() {
    check_again("avx2", "glibc.cpu.hwcaps=-AVX512F");
}

fn check_again(vectors: &str, tunables: &str) {
    let plain = Command::new(std::env::current_exe().expect("this test runs"))
        .args(["--exact", "golden::pictures_have_the_recorded_bits"])
        .env("TYNDALL_VECTORS", vectors)
        .env("GLIBC_TUNABLES", tunables)
        .env_remove("UPDATE_GOLDEN")
        .output()
        .expect("it runs once more");
    let output = String::from_utf8_lossy(&plain.stdout);
    assert!(plain.status.success() && output.contains("1 passed"), "{output}");
}
