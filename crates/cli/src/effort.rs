//! How much work a measurement is given, and which random numbers.

use std::time::Duration;

use tyndall_transport::walk::{Goal, WalkOptions};

use crate::render::stop::{parse_error, parse_time};

/// How many photons
#[derive(Debug, Clone, clap::Args)]
pub struct Effort {
    /// Number of photons [default: 1000000, or as many as --error and --time need]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=1 << 31))]
    samples: Option<u32>,
    /// Stop when the relative standard errors of the results (reflectance and transmittance) are below this, such as
    /// 0.1%; fractions below 0.0001 count as 0.0001
    #[arg(long, value_name = "REL", value_parser = parse_error)]
    error: Option<f64>,
    /// Stop after this time, such as 90s, 10min, 2h
    #[arg(long, value_name = "TIME", value_parser = parse_time)]
    time: Option<Duration>,
    /// Seed of the random numbers
    #[arg(long, value_name = "N", default_value_t = 0)]
    seed: u32,
    /// Number of threads; as many as there are cores by default. The result does not depend on it
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..))]
    threads: Option<u16>,
}

/// Photons if nothing else is asked for.
const DEFAULT_SAMPLES: u64 = 1_000_000;

impl Effort {
    /// As the transport takes it; `stream` tells meters apart.
    pub fn options(&self, stream: u64) -> WalkOptions {
        let is_open_ended = self.error.is_some() || self.time.is_some();
        let samples = match self.samples {
            Some(samples) => u64::from(samples),
            None if is_open_ended => u64::MAX,
            None => DEFAULT_SAMPLES,
        };
        let cores = std::thread::available_parallelism().map_or(1, usize::from);
        WalkOptions {
            seed: u64::from(self.seed),
            stream,
            threads: self.threads.map_or(cores, usize::from),
            goal: Goal { samples, error: self.error, time: self.time },
        }
    }
}
