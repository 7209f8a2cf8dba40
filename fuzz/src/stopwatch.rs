//! The time that reading a file takes.
//!
//! It is the wall clock's, but no more than the time that this process has spent on all cores, where the system tells that: a run at
//! the lowest priority waits for others most of the time. A reader that waits for something itself is ended by libFuzzer's
//! own limit, on the wall clock.

use std::time::Instant;

use tyndall_machine::seconds_on_cores;

/// Seconds to which the time on cores is told.
const TICK: f64 = 0.01;

/// When it began.
pub(crate) struct Stopwatch {
    wall: Instant,
    cores: Option<f64>,
}

impl Stopwatch {
    pub fn start() -> Self {
        Self { wall: Instant::now(), cores: seconds_on_cores() }
    }

    /// Seconds since then.
    pub fn seconds(&self) -> f64 {
        let wall = self.wall.elapsed().as_secs_f64();
        // Counted in ticks, of which one may have been begun.
        let cores = self.cores.zip(seconds_on_cores()).map(|(begin, end)| end - begin + TICK);
        cores.map_or(wall, |cores| cores.min(wall))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn waiting_for_others_does_not_count_and_work_does() {
        let stopwatch = Stopwatch::start();
        std::thread::sleep(std::time::Duration::from_millis(300));
        if seconds_on_cores().is_some() {
            assert!(stopwatch.seconds() < 0.3);
        }
        let begin = stopwatch.seconds();
        while stopwatch.seconds() < begin + 0.05 {
            std::hint::black_box(0);
        }
    }
}
