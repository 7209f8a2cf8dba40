//! The slowest input and the most memory of a run, for the table of `fuzz/run`.
//!
//! They are kept in the file that the environment variable `TYNDALL_FUZZ_REPORT` names, as `seconds bytes memory` with the
//! slowest input's length, and written whenever they grow: a run may end at any time.

use std::path::PathBuf;
use std::sync::{LazyLock, Mutex};

use crate::Figures;

struct Greatest {
    seconds: f64,
    bytes: usize,
    memory: usize,
}

static FILE: LazyLock<Option<PathBuf>> =
    LazyLock::new(|| std::env::var_os("TYNDALL_FUZZ_REPORT").map(PathBuf::from));
static GREATEST: Mutex<Greatest> = Mutex::new(Greatest { seconds: 0.0, bytes: 0, memory: 0 });

/// Notes what an input took.
pub(crate) fn note(input: &[u8], figures: &Figures) {
    let (Some(path), Ok(mut greatest)) = (FILE.as_ref(), GREATEST.lock()) else { return };
    let is_slower = figures.seconds > greatest.seconds * 1.05;
    if !is_slower && figures.memory <= greatest.memory + (64 << 10) {
        return;
    }
    if is_slower {
        (greatest.seconds, greatest.bytes) = (figures.seconds, input.len());
    }
    greatest.memory = greatest.memory.max(figures.memory);
    let line = format!("{:.3} {} {}\n", greatest.seconds, greatest.bytes, greatest.memory);
    // Figures that cannot be kept are no reason to stop.
    let _ = std::fs::write(path, line);
    if is_slower {
        let _ = std::fs::write(path.with_extension("slowest"), input);
    }
}
