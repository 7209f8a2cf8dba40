//! How many photons a measurement sends, with which random numbers and threads: the same as of the command.

use std::time::Duration;

use pyo3::FromPyObject;
use tyndall_transport::walk::{Goal, WalkOptions};

/// Photons if nothing else is asked for.
const DEFAULT_SAMPLES: u64 = 1_000_000;

/// As Python gives it, checked there.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub(crate) struct Effort {
    samples: Option<u64>,
    error: Option<f64>,
    seconds: Option<f64>,
    seed: u64,
    threads: Option<usize>,
}

impl Effort {
    /// As the transport takes it; `stream` tells layers and meters apart.
    pub(crate) fn options(&self, stream: u64) -> WalkOptions {
        let is_open_ended = self.error.is_some() || self.seconds.is_some();
        let samples = self.samples.unwrap_or(if is_open_ended { u64::MAX } else { DEFAULT_SAMPLES });
        let cores = std::thread::available_parallelism().map_or(1, usize::from);
        // A time too long to be one is no limit.
        let time = self.seconds.and_then(|seconds| Duration::try_from_secs_f64(seconds).ok());
        let threads = self.threads.unwrap_or(cores).clamp(1, usize::from(u16::MAX));
        WalkOptions { seed: self.seed, stream, threads, goal: Goal { samples, error: self.error, time } }
    }
}
