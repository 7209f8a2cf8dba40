//! The time that reading a file takes.
//!
//! It is the wall clock's, but no more than the time that this process has spent on all cores, where the system tells that: a run at
//! the lowest priority waits for others most of the time. A reader that waits for something itself is ended by libFuzzer's
//! own limit, on the wall clock.

use std::time::Instant;

/// Ticks a second of the times in `/proc`, the same on all Linux systems of today.
const TICKS: f64 = 100.0;

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
        let cores = self.cores.zip(seconds_on_cores()).map(|(begin, end)| end - begin + 1.0 / TICKS);
        cores.map_or(wall, |cores| cores.min(wall))
    }
}

/// Seconds that this process has spent on all cores.
fn seconds_on_cores() -> Option<f64> {
    let stat = std::fs::read_to_string("/proc/self/stat").ok()?;
    let fields: Vec<&str> = stat.rsplit_once(')')?.1.split_whitespace().collect();
    let ticks = fields.get(11)?.parse::<f64>().ok()? + fields.get(12)?.parse::<f64>().ok()?;
    Some(ticks / TICKS)
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
