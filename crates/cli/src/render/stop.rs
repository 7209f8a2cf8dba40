//! When a render is done: a number of samples, an error, a time, whichever comes first.

use std::ops::Range;
use std::sync::Mutex;
use std::time::{Duration, Instant};

use tyndall_film::{Accumulation, Film};

/// When to stop
#[derive(Debug, Clone, Default, clap::Args)]
pub struct Goal {
    /// Samples for each pixel [default: what the scene says, or 64]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..))]
    pub spp: Option<u32>,
    /// Stop when the median relative standard error of the pixels is below this, such as 1%
    #[arg(long, value_name = "REL", value_parser = parse_error)]
    pub error: Option<f64>,
    /// Stop after this time, such as 90s, 10min, 2h
    #[arg(long, value_name = "TIME", value_parser = parse_time)]
    pub time: Option<Duration>,
}

/// Samples of a pass at most. Passes are what a render can be stopped between.
const LARGEST_PASS: u64 = 16;

/// Samples that an error estimate needs before it is believed: with fewer, pixels whose few samples happen to agree
/// pass for converged.
const LEAST_SAMPLES_FOR_ERROR: u64 = 16;

/// Which samples to render, in which passes.
pub struct Plan {
    samples: Range<u64>,
    error: Option<f64>,
    time: Option<Duration>,
}

impl Plan {
    pub fn new(goal: &Goal, samples: Option<Range<u64>>, scene_spp: u64) -> Plan {
        let open_ended = goal.error.is_some() || goal.time.is_some();
        let spp = match goal.spp {
            Some(spp) => u64::from(spp),
            None if open_ended => u64::MAX,
            None => scene_spp,
        };
        Plan { samples: samples.unwrap_or(0..spp), error: goal.error, time: goal.time }
    }

    /// Samples of each pixel in all, if that is known beforehand.
    pub fn spp(&self) -> Option<u64> {
        (self.samples.end < u64::MAX).then(|| self.samples.end - self.samples.start)
    }

    /// The next samples to render of all films of a picture, which hold the same samples; `None` when it is done.
    pub fn next_pass(&self, pictures: &[Accumulation], clock: &Clock) -> Option<Range<u64>> {
        let film = &pictures.first()?.film;
        let held = film.complete();
        let first_gap = held
            .as_slice()
            .iter()
            .find(|range| range.contains(&self.samples.start))
            .map_or(self.samples.start, |range| range.end);
        let start = film.open_start().unwrap_or(first_gap);
        if start >= self.samples.end || self.error_is_reached(pictures) {
            return None;
        }
        // Passes grow with what is there, so that a stop rule is met to within a part of the work.
        let mut pass = (held.count() / 4).clamp(1, LARGEST_PASS);
        if let (Some(limit), Some(pace)) = (self.time, clock.pace(held.count())) {
            let left = limit.saturating_sub(clock.elapsed());
            pass = pass.min((left.as_secs_f64() / pace) as u64);
            if pass == 0 {
                return None;
            }
        }
        let next_held = held.as_slice().iter().map(|range| range.start).find(|&held| held > start);
        let end = self.samples.end.min(start.saturating_add(pass)).min(next_held.unwrap_or(u64::MAX));
        Some(start..end)
    }

    fn error_is_reached(&self, pictures: &[Accumulation]) -> bool {
        let is_below = |film: &Film, goal: f64| {
            film.complete().count() >= LEAST_SAMPLES_FOR_ERROR
                && film.median_relative_error().is_some_and(|error| error <= goal)
        };
        self.error.is_some_and(|goal| pictures.iter().all(|picture| is_below(&picture.film, goal)))
    }
}

/// The time a render has taken.
pub struct Clock {
    start: Instant,
    /// Seconds of earlier runs that this one resumes.
    before: f64,
    /// Samples that were there at the start are not this run's work.
    pace: Mutex<Option<(u64, Instant)>>,
    last_checkpoint: Instant,
}

/// Time between two checkpoints.
const CHECKPOINT_INTERVAL: Duration = Duration::from_secs(60);

impl Clock {
    pub fn start(before: f64) -> Clock {
        let now = Instant::now();
        Clock { start: now, before, pace: Mutex::new(None), last_checkpoint: now }
    }

    pub fn seconds(&self) -> f64 {
        self.before + self.start.elapsed().as_secs_f64()
    }

    fn elapsed(&self) -> Duration {
        self.start.elapsed()
    }

    /// Seconds a sample of the whole picture takes, once one has been made.
    fn pace(&self, samples: u64) -> Option<f64> {
        let mut pace = self.pace.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
        let (first, since) = *pace.get_or_insert((samples, self.start));
        (samples > first).then(|| since.elapsed().as_secs_f64() / (samples - first) as f64)
    }

    pub fn checkpoint_is_due(&mut self) -> bool {
        let due = self.last_checkpoint.elapsed() >= CHECKPOINT_INTERVAL;
        if due {
            self.last_checkpoint = Instant::now();
        }
        due
    }
}

/// A share, such as 1% or 0.01.
pub fn parse_error(text: &str) -> Result<f64, String> {
    let (number, scale) = match text.strip_suffix('%') {
        Some(percent) => (percent.trim(), 0.01),
        None => (text, 1.0),
    };
    let error = number.parse::<f64>().ok().map(|number| number * scale);
    error.filter(|e| e.is_finite() && *e > 0.0).ok_or("write a share above 0, such as 1% or 0.01".into())
}

/// A time, such as 90s, 10min or 2h.
pub fn parse_time(text: &str) -> Result<Duration, String> {
    let split = text.find(|c: char| c.is_ascii_alphabetic()).unwrap_or(text.len());
    let (number, unit) = text.split_at(split);
    let seconds = match unit {
        "" | "s" | "sec" => 1.0,
        "m" | "min" => 60.0,
        "h" => 3600.0,
        _ => return Err("write a number and s, min or h, such as 90s".into()),
    };
    let time = number.trim().parse::<f64>().ok().map(|number| number * seconds);
    time.and_then(|s| Duration::try_from_secs_f64(s).ok())
        .filter(|time| !time.is_zero())
        .ok_or("write a time above 0, such as 90s, 10min or 2h".into())
}

#[cfg(test)]
mod tests {
    use super::*;
    use tyndall_film::Layers;

    #[test]
    fn errors_and_times_are_read_with_their_units() {
        assert_eq!(parse_error("1%"), Ok(0.01));
        assert_eq!(parse_error("0.05"), Ok(0.05));
        assert!(parse_error("-1%").is_err() && parse_error("nan").is_err() && parse_error("").is_err());
        assert_eq!(parse_time("90s"), Ok(Duration::from_secs(90)));
        assert_eq!(parse_time("1.5min"), Ok(Duration::from_secs(90)));
        assert!(parse_time("10 parsecs").is_err() && parse_time("0").is_err() && parse_time("-3s").is_err());
    }

    #[test]
    fn passes_follow_each_other_to_the_end_of_the_range() {
        let plan = Plan::new(&Goal::default(), Some(10..51), 64);
        let clock = Clock::start(0.0);
        let film = Film::new(1, 1, Layers::NONE).unwrap();
        let mut pictures = [Accumulation { film, metadata: Default::default() }];
        let mut next = 10;
        while let Some(pass) = plan.next_pass(&pictures, &clock) {
            let film = &mut pictures[0].film;
            assert_eq!(pass.start, next);
            next = pass.end;
            film.open_range(pass.start).unwrap();
            let mut tile = tyndall_film::FilmTile::new(film.tile_rect(0), pass.clone(), film.layers());
            pass.clone().for_each(|_| tile.add(0, 0, &Default::default()));
            film.merge_tile(&tile);
            film.complete_through(pass.end).unwrap();
        }
        assert_eq!(next, 51);
    }
}
