//! The fuzz targets on stable Rust: all files that fuzzing began with or stumbled over, and some thousand mutations.
//!
//! Memory is that of the whole process, so the tests take turns.

mod seeds;

use std::fs;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::{Path, PathBuf};

use tyndall_fuzz::memory::alone;
use tyndall_fuzz::mutation::{Random, mutated};
use tyndall_fuzz::{Outcome, TARGETS, Target};

/// Mutations of each target; twenty times as many with `TYNDALL_PROOF=full`.
const MUTATIONS: usize = 400;

/// The files of a target in `corpus` or `regressions`, by name.
fn files(kind: &str, target: &Target) -> Vec<(PathBuf, Vec<u8>)> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join(kind).join(target.name);
    let entries = fs::read_dir(folder).into_iter().flatten();
    let mut paths: Vec<PathBuf> = entries.map(|entry| entry.unwrap().path()).collect();
    paths.sort();
    paths.into_iter().map(|path| (path.clone(), fs::read(path).unwrap())).collect()
}

/// What the target makes of `bytes`; if it breaks on them they are kept in a file, and the message says where and that they
/// are from `what`.
fn outcome(target: &Target, bytes: &[u8], what: &str) -> Result<Outcome, String> {
    let figures = catch_unwind(AssertUnwindSafe(|| target.within_memory(bytes)));
    figures.map(|figures| figures.outcome).map_err(|_| {
        let kept = Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("{}-broken", target.name));
        fs::write(&kept, bytes).unwrap();
        format!("{}: {what} breaks it; see {}", target.name, kept.display())
    })
}

/// What went wrong with any of the targets.
fn each_target(check: impl Fn(&Target) -> Result<(), String>) {
    let _turn = alone();
    let wrong: Vec<String> = TARGETS.iter().filter_map(|target| check(target).err()).collect();
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn every_file_of_the_corpus_is_read() {
    each_target(|target| {
        let corpus = files("corpus", target);
        assert!(!corpus.is_empty(), "{} has no corpus", target.name);
        corpus.iter().try_for_each(|(path, bytes)| {
            let path = path.display().to_string();
            match outcome(target, bytes, &path)? {
                Outcome::Read(_) => Ok(()),
                Outcome::Refused => Err(format!("{path} is refused")),
            }
        })
    });
}

#[test]
fn no_file_that_once_broke_a_reader_breaks_it() {
    each_target(|target| {
        files("regressions", target)
            .iter()
            .try_for_each(|(path, bytes)| outcome(target, bytes, &path.display().to_string()).map(drop))
    });
}

#[test]
fn mutated_files_are_read_or_refused() {
    let full = std::env::var("TYNDALL_PROOF").is_ok_and(|effort| effort == "full");
    let rounds = if full { 20 * MUTATIONS } else { MUTATIONS };
    each_target(|target| {
        let corpus = files("corpus", target);
        let mut random =
            Random(target.name.bytes().fold(1871, |seed, byte| seed.wrapping_mul(31) + u64::from(byte)));
        let mut refused = 0;
        for round in 0..rounds {
            let [(_, file), (_, other)] = [0, 1].map(|_| &corpus[random.below(corpus.len())]);
            let bytes = mutated(file, other, &mut random);
            if outcome(target, &bytes, &format!("mutation {round}"))? == Outcome::Refused {
                refused += 1;
            }
        }
        // Some damage is found out, and some lets the reader go on to what comes later.
        let is_mixed = (rounds / 20..rounds).contains(&refused);
        is_mixed.then_some(()).ok_or_else(|| format!("{}: {refused} of {rounds} refused", target.name))
    });
}

#[test]
fn a_reader_that_takes_more_than_it_may_is_noticed() {
    let _turn = alone();
    let hoarder = Target {
        name: "hoarder",
        read: |_| {
            std::hint::black_box(vec![1u8; 80 << 20]);
            Outcome::Refused
        },
        densest: 1,
    };
    assert!(catch_unwind(|| hoarder.within_memory(b"small")).is_err());
    let large = vec![0; 5 << 20];
    assert!(hoarder.within_memory(&large).memory >= 80 << 20);
}

/// `TYNDALL_FUZZ_FILES="vdb a.vdb b.vdb"` replays files and tells what they took.
#[test]
#[ignore = "for files at hand"]
fn replay() {
    let _turn = alone();
    let files = std::env::var("TYNDALL_FUZZ_FILES").unwrap_or_default();
    let mut words = files.split_whitespace();
    let Some(target) = words.next().and_then(|name| TARGETS.iter().find(|target| target.name == name)) else {
        panic!("TYNDALL_FUZZ_FILES must hold the name of a target and files")
    };
    for path in words {
        let bytes = fs::read(path).unwrap();
        let figures = target.within_memory(&bytes);
        println!("{path}: {} bytes, {figures:?}", bytes.len());
    }
}
