//! The time a render has taken, and its pace.

use std::time::{Duration, Instant};

/// Runs from its making.
#[derive(Debug)]
pub(crate) struct Clock {
    start: Instant,
    /// Since when samples are made, which may be later.
    first_pass: Instant,
    /// Seconds of earlier runs that this one resumes.
    before: f64,
    /// Samples that were there at the start are not this run's work.
    first: u64,
}

impl Clock {
    /// A clock for a picture that already holds `samples` a pixel, which took `before` seconds.
    pub fn start(before: f64, samples: u64) -> Self {
        let start = Instant::now();
        Self { start, first_pass: start, before, first: samples }
    }

    /// Counts what has passed so far to no sample.
    pub fn begin_passes(&mut self) {
        self.first_pass = Instant::now();
    }

    /// Seconds in all runs.
    pub fn seconds(&self) -> f64 {
        self.before + self.start.elapsed().as_secs_f64()
    }

    /// Time in this run.
    pub fn elapsed(&self) -> Duration {
        self.start.elapsed()
    }

    /// Seconds that a sample of the whole picture takes, once one has been made and the picture holds `samples`.
    pub fn pace(&self, samples: u64) -> Option<f64> {
        let made = samples.checked_sub(self.first).filter(|&made| made > 0)?;
        Some(self.first_pass.elapsed().as_secs_f64() / made as f64)
    }
}
