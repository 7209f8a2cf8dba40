//! Sends photons, shared out among threads, until there are enough of them.
//!
//! Photon i has random numbers of its own, those of (seed, stream, i), and tallies add exactly, so that a result
//! depends on the seed and the number of photons alone.

use std::ops::Range;
use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::time::{Duration, Instant};

use tyndall_lanes::Random;

use crate::threads;

use super::tally::{Estimate, MAX_PHOTONS, Scores, Tallies};

/// Something that photons can be sent through.
pub trait Walk: Sync {
    /// Number of tallies.
    fn tallies(&self) -> usize;

    /// One photon, from its birth to its end.
    fn walk(&self, random: &mut Random, scores: &mut Scores);

    /// The relative standard error by which a run may be stopped.
    fn relative_error(&self, tallies: &Tallies) -> f64;
}

/// When to stop; whichever comes first.
#[derive(Debug, Clone, Copy)]
pub struct Goal {
    /// Number of photons at most; 2^31 at most.
    pub samples: u64,
    /// Relative standard error that is to be reached. Fractions below 10⁻⁴ count as 10⁻⁴.
    pub error: Option<f64>,
    /// Time after which no further pass is begun.
    pub time: Option<Duration>,
}

/// How photons are sent.
#[derive(Debug, Clone, Copy)]
pub struct WalkOptions {
    /// Seed of the random numbers.
    pub seed: u64,
    /// Which of the seed's families of random numbers: meters of one scene are independent with different ones.
    pub stream: u64,
    /// Number of threads, at least 1.
    pub threads: usize,
    /// When to stop.
    pub goal: Goal,
}

/// Photons that a thread takes at a time.
const CHUNK: u64 = 256;

/// Photons of the first pass. The error of fewer is not to be relied upon.
const FIRST_PASS: u64 = 1 << 13;

/// What counts for the relative error of a fraction that is smaller.
const LEAST_FRACTION: f64 = 1e-4;

/// Sends photons until the goal is reached, or until `cancel` is set: then the photons of the pass under way are given
/// up.
pub fn run(walk: &impl Walk, options: &WalkOptions, cancel: &AtomicBool) -> Tallies {
    let WalkOptions { goal, .. } = options;
    let start = Instant::now();
    let limit = goal.samples.min(MAX_PHOTONS);
    let mut tallies = Tallies::new(walk.tallies());
    while tallies.photons() < limit {
        let done = tallies.photons();
        let late = || goal.time.is_some_and(|time| start.elapsed() >= time);
        let accurate = || goal.error.is_some_and(|error| walk.relative_error(&tallies) <= error);
        if done > 0 && (late() || accurate()) {
            break;
        }
        // Passes grow with what there is, so that goals are met to within a part of the work.
        let pass = done..limit.min(done + (done / 4).max(FIRST_PASS));
        match send(walk, pass, options, cancel) {
            Some(sent) => tallies.merge(&sent),
            None => break,
        }
    }
    tallies
}

/// The relative error of a fraction of the light.
pub(super) fn fraction_error(fraction: Estimate, tallies: &Tallies) -> f64 {
    // What no photon has brought anything to yet may still be as much as 1/n.
    let error = fraction.standard_error.max(1.0 / tallies.photons() as f64);
    error / fraction.mean.abs().max(LEAST_FRACTION)
}

/// The relative error of the greatest of values that are in the tallies from number 0 on; infinite as long as few photons
/// tell it.
pub(super) fn values_error(values: &[Estimate], tallies: &Tallies) -> f64 {
    let greatest = |pick: fn(&Estimate) -> f64| values.iter().map(pick).fold(0.0, f64::max);
    let (error, mean) = (greatest(|value| value.standard_error), greatest(|value| value.mean));
    if !(0..values.len()).all(|tally| tallies.is_error_known(tally)) {
        return f64::INFINITY;
    }
    // Darkness is accepted after so many paths into it.
    if mean > 0.0 { error / mean } else { 100.0 / tallies.photons() as f64 }
}

/// The photons with the numbers `pass`; `None` if cancelled.
fn send(walk: &impl Walk, pass: Range<u64>, options: &WalkOptions, cancel: &AtomicBool) -> Option<Tallies> {
    let next = AtomicU64::new(pass.start);
    let sum = Mutex::new(Tallies::new(walk.tallies()));
    let work = || {
        let mut tallies = Tallies::new(walk.tallies());
        let mut scores = Scores::new(walk.tallies());
        loop {
            let first = next.fetch_add(CHUNK, Ordering::Relaxed);
            if first >= pass.end || cancel.load(Ordering::Relaxed) {
                break;
            }
            for photon in first..pass.end.min(first + CHUNK) {
                walk.walk(&mut Random::new(options.seed, options.stream, photon), &mut scores);
                tallies.take(&mut scores);
            }
        }
        sum.lock().unwrap_or_else(std::sync::PoisonError::into_inner).merge(&tallies);
    };
    threads::share(options.threads, work);
    let sum = sum.into_inner().unwrap_or_else(std::sync::PoisonError::into_inner);
    (!cancel.load(Ordering::Relaxed)).then_some(sum)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Light 1 with little noise, and as much again that one photon in 10,000 brings.
    struct RarePath;

    impl Walk for RarePath {
        fn tallies(&self) -> usize {
            1
        }

        fn walk(&self, random: &mut Random, scores: &mut Scores) {
            scores.add(0, 0.9 + 0.2 * random.f64() + if random.f64() < 1e-4 { 1e4 } else { 0.0 });
        }

        fn relative_error(&self, tallies: &Tallies) -> f64 {
            values_error(&[tallies.estimate(0)], tallies)
        }
    }

    #[test]
    fn an_error_is_not_reached_while_one_photon_makes_most_of_it() {
        // 40 % is there after two events, whose error is known to a third at best.
        for seed in 0..20 {
            let goal = Goal { samples: u64::MAX, error: Some(0.4), time: None };
            let options = WalkOptions { seed, stream: 0, threads: 1, goal };
            let tallies = run(&RarePath, &options, &AtomicBool::new(false));
            let Estimate { mean, standard_error } = tallies.estimate(0);
            // Without a single event nobody can know of it: that is a chance of exp(-0.82) in the first pass.
            let is_met = mean > 1.1;
            assert!(!is_met || tallies.photons() > 40_000 && standard_error > 0.1, "{seed}: {mean}");
            assert!(!is_met || (mean - 2.0).abs() < 4.0 * standard_error, "{seed}: {mean} {standard_error}");
        }
    }
}
