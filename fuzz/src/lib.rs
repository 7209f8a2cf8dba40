//! Hostile files for every reader of Tyndall.
//!
//! A [`Target`] is a reader as a plain function of bytes, followed by what a render would first do with the result.
//! Whatever the bytes, it must come back: with what they say, or with one line that tells what is wrong with them. It is
//! held to [`limits`] that follow from the size of its input. libFuzzer searches for bytes that break them (`fuzz_targets/`), and a
//! test on stable Rust goes through all that was found and some thousand mutations (`tests/smoke/`). README.md tells how.

mod folder;
pub mod limits;
pub mod memory;
mod meshes;
pub mod mutation;
mod pictures;
mod report;
mod scenes;
mod stopwatch;
mod sums;
mod tables;
mod volumes;

use crate::stopwatch::Stopwatch;

/// A reader, and the folder of `corpus/` and `regressions/` with its files.
#[derive(Debug, Clone, Copy)]
pub struct Target {
    /// Name of the target and of its folders.
    pub name: &'static str,
    /// Reads a file of these bytes.
    pub read: fn(&[u8]) -> Outcome,
    /// Bytes of content that each byte of a file may honestly stand for, where that shows only when it is unpacked whole.
    pub densest: usize,
}

/// What a reader made of a file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Outcome {
    /// It was read, and what it holds takes so many bytes of memory; 0 if that is less than the file.
    Read(usize),
    /// It was refused in one line.
    Refused,
}

impl Outcome {
    /// A refusal, if its message is one that a user can be shown.
    fn refused(error: &impl ToString) -> Self {
        assert_message(&error.to_string());
        Self::Refused
    }
}

/// An error or a note is one line of a length that can be read.
fn assert_message(message: &str) {
    assert!(!message.trim().is_empty(), "an empty message");
    assert!(!message.contains(['\n', '\r']), "a message of several lines: {message}");
    assert!(message.len() < 4000, "a message of {} bytes: {message}", message.len());
}

macro_rules! targets {
    ($($name:ident: $read:path $(, densest $densest:expr)?;)*) => {
        /// Every reader.
        pub const TARGETS: &[Target] =
            &[$(Target { name: stringify!($name), read: $read, densest: 1 $(* $densest)? }),*];
    };
}

targets! {
    vdb: volumes::vdb;
    nvdb: volumes::nvdb;
    pbrt: scenes::pbrt;
    mitsuba: scenes::mitsuba;
    toml: scenes::toml;
    option: scenes::option;
    phase_spec: scenes::phase_spec;
    acc: sums::acc;
    summary: sums::summary;
    exr: pictures::exr;
    hdr: pictures::hdr, densest 16 * size_of::<[f32; 3]>();
    png: pictures::png;
    jpeg: pictures::jpeg, densest 256 * size_of::<[u8; 3]>();
    ply: meshes::ply;
    obj: meshes::obj;
    nifti: volumes::nifti;
    npy: volumes::npy;
    vol: volumes::vol;
    raw: volumes::raw;
    phase_table: tables::phase_table;
    index_table: tables::index_table;
}

/// What reading a file took.
#[derive(Debug, Clone, Copy)]
pub struct Figures {
    /// What the reader made of it.
    pub outcome: Outcome,
    /// The most memory that was held at any time, bytes.
    pub memory: usize,
    /// How long it took, without waiting for others that are at work on the machine.
    pub seconds: f64,
}

/// Reads `bytes` by the target of this name, within all limits.
///
/// # Panics
/// If the reader does, breaks a limit, or there is no such target.
pub fn fuzz(name: &str, bytes: &[u8]) {
    match TARGETS.iter().find(|target| target.name == name) {
        Some(target) => target.within_limits(bytes),
        None => panic!("there is no target `{name}`"),
    }
}

impl Target {
    /// Reads `bytes` within the limit of memory.
    ///
    /// # Panics
    /// If the reader does, or takes more memory.
    pub fn within_memory(&self, bytes: &[u8]) -> Figures {
        let stopwatch = Stopwatch::start();
        let (outcome, memory) = memory::peak_of(|| (self.read)(bytes));
        let seconds = stopwatch.seconds();
        let content = match outcome {
            Outcome::Read(content) => content,
            Outcome::Refused => 0,
        };
        let most = limits::memory((self.densest * bytes.len()).max(content));
        assert!(
            memory <= most,
            "{}: {} bytes, which hold {content}, took {memory} bytes of memory, more than {most}",
            self.name,
            bytes.len()
        );
        Figures { outcome, memory, seconds }
    }

    /// Reads `bytes` within all limits and notes what it took.
    fn within_limits(&self, bytes: &[u8]) {
        let most = limits::seconds(bytes.len());
        let mut figures = self.within_memory(bytes);
        // Only what is slow again and again is so by itself, and not because the machine has other things to do.
        for _ in 0..2 {
            if figures.seconds > most {
                figures.seconds = figures.seconds.min(self.within_memory(bytes).seconds);
            }
        }
        report::note(bytes, &figures);
        assert!(figures.seconds <= most, "{}: {} bytes took {} s", self.name, bytes.len(), figures.seconds);
    }
}
