//! Checkpoints: the exact sums of a render under way, from which another one goes on to the same bits.

use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use tyndall_film::{Accumulation, FileError, remove_leftovers};

/// A file that takes the sums every now and then.
#[derive(Debug)]
pub struct Checkpoint {
    path: PathBuf,
    every: Duration,
    last: Instant,
}

impl Checkpoint {
    /// A checkpoint to be written `every` so often, counted from now. What killed runs have left of writing it is cleared
    /// away.
    pub fn new(path: impl Into<PathBuf>, every: Duration) -> Self {
        let path = path.into();
        remove_leftovers(&path);
        Self { path, every, last: Instant::now() }
    }

    /// Where it is.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Writes the picture, replacing what was there in one step.
    ///
    /// # Errors
    /// If the file cannot be written; what was there stays.
    pub fn save(&mut self, picture: &Accumulation) -> Result<(), FileError> {
        self.last = Instant::now();
        picture.write(&self.path)
    }

    /// The same, if it is time for that.
    ///
    /// # Errors
    /// As [`save`](Self::save).
    pub fn save_if_due(&mut self, picture: &Accumulation) -> Result<(), FileError> {
        if self.last.elapsed() < self.every { Ok(()) } else { self.save(picture) }
    }
}
