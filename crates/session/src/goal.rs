//! When a render is done: a number of samples, an error, a time, whichever comes first.

use std::ops::Range;
use std::time::Duration;

use tyndall_film::{Accumulation, Film, SampleRanges};

use crate::clock::Clock;

/// When to stop. What is not given does not matter; if nothing is, the scene's number of samples decides.
#[derive(Debug, Clone, Default)]
pub struct Goal {
    /// Samples for each pixel.
    pub spp: Option<u32>,
    /// Only these samples of each pixel; `spp` does not matter then.
    pub samples: Option<Range<u64>>,
    /// A median relative standard error of the pixels, which is reached once no more light than that can be
    /// [unseen](Film::unseen_light).
    pub error: Option<f64>,
    /// A time from the start of this run.
    pub time: Option<Duration>,
}

impl Goal {
    /// The plan for a scene that asks for `scene_spp` samples a pixel.
    pub fn plan(&self, scene_spp: u32) -> Plan {
        let is_open_ended = self.error.is_some() || self.time.is_some();
        let spp = match self.spp {
            Some(spp) => u64::from(spp),
            None if is_open_ended => u64::MAX,
            None => u64::from(scene_spp),
        };
        let samples = self.samples.clone().unwrap_or(0..spp);
        Plan { samples, error: self.error, time: self.time, longest_pass: None, in_one_pass: false }
    }
}

/// Samples of a pass at most. Passes are what a render can be stopped between.
const LARGEST_PASS: u64 = 16;

/// Which samples to render, in which passes.
#[derive(Debug, Clone)]
pub struct Plan {
    samples: Range<u64>,
    error: Option<f64>,
    time: Option<Duration>,
    longest_pass: Option<Duration>,
    in_one_pass: bool,
}

impl Plan {
    /// The same, with passes of about this time at most, but of at least one sample a pixel.
    pub fn with_passes_up_to(self, time: Duration) -> Self {
        Self { longest_pass: Some(time), ..self }
    }

    /// The same in one pass, if the number of samples is known beforehand: for a picture that nobody looks at before it is
    /// done. Each pass costs a turn of the film, and threads wait for each other at its end.
    pub fn in_one_pass(self) -> Self {
        Self { in_one_pass: self.spp().is_some() && self.error.is_none() && self.time.is_none(), ..self }
    }

    /// Samples of each pixel in all, if that is known beforehand.
    pub fn spp(&self) -> Option<u64> {
        (self.samples.end < u64::MAX).then(|| self.samples.end - self.samples.start)
    }

    /// Whether a written picture of these samples is all that is asked for. An error or time that was to be reached is
    /// taken to be so in whatever was written.
    pub(crate) fn is_fulfilled_by(&self, samples: &SampleRanges) -> bool {
        let is_open_ended = self.error.is_some() || self.time.is_some();
        let Range { start, end } = self.samples;
        let is_part = |held: &Range<u64>| held.start <= start && held.end >= end;
        if is_open_ended { samples.count() > 0 } else { samples.as_slice().iter().any(is_part) }
    }

    /// The next samples to render of all films of a picture, which hold the same samples; `None` when it is done.
    pub(crate) fn next_pass(&self, pictures: &[Accumulation], clock: &Clock) -> Option<Range<u64>> {
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
        let mut pass = if self.in_one_pass { u64::MAX } else { (held.count() / 4).clamp(1, LARGEST_PASS) };
        if let Some(pace) = clock.pace(held.count()) {
            if let Some(longest) = self.longest_pass {
                pass = pass.min((longest.as_secs_f64() / pace) as u64).max(1);
            }
            if let Some(limit) = self.time {
                let left = limit.saturating_sub(clock.elapsed());
                pass = pass.min((left.as_secs_f64() / pace) as u64);
                if pass == 0 {
                    return None;
                }
            }
        }
        let next_held = held.as_slice().iter().map(|range| range.start).find(|&held| held > start);
        let end = self.samples.end.min(start.saturating_add(pass)).min(next_held.unwrap_or(u64::MAX));
        Some(start..end)
    }

    fn error_is_reached(&self, pictures: &[Accumulation]) -> bool {
        let is_below =
            |film: &Film, goal: f64| film.believed_error_against(goal).is_some_and(|error| error <= goal);
        self.error.is_some_and(|goal| pictures.iter().all(|picture| is_below(&picture.film, goal)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use tyndall_film::Layers;

    #[test]
    fn passes_follow_each_other_to_the_end_of_the_range() {
        let plan = Goal { samples: Some(10..51), ..Goal::default() }.plan(64);
        let clock = Clock::start(0.0, 0);
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

    #[test]
    fn one_pass_goes_to_the_end_of_the_range() {
        let film = Film::new(1, 1, Layers::NONE).unwrap();
        let pictures = [Accumulation { film, metadata: Default::default() }];
        let plan = Goal { samples: Some(10..51), ..Goal::default() }.plan(64).in_one_pass();
        assert_eq!(plan.next_pass(&pictures, &Clock::start(0.0, 0)), Some(10..51));
        let plan = Goal { spp: Some(51), error: Some(0.1), ..Goal::default() }.plan(64).in_one_pass();
        assert_eq!(plan.next_pass(&pictures, &Clock::start(0.0, 0)), Some(0..1));
    }

    #[test]
    fn a_written_picture_fulfils_a_plan_of_its_samples() {
        let held = |text: &str| text.parse::<SampleRanges>().unwrap();
        let plan = Goal { samples: Some(4..8), ..Goal::default() }.plan(64);
        assert!(plan.is_fulfilled_by(&held("4..8")) && plan.is_fulfilled_by(&held("0..9")));
        assert!(!plan.is_fulfilled_by(&held("4..7")) && !plan.is_fulfilled_by(&held("0..5,6..9")));
        let plan = Goal { error: Some(0.1), spp: Some(64), ..Goal::default() }.plan(64);
        assert!(plan.is_fulfilled_by(&held("0..20")) && !plan.is_fulfilled_by(&held("none")));
    }

    #[test]
    fn the_scene_decides_how_many_samples_if_nothing_else_does() {
        let spp = |goal: Goal| goal.plan(64).spp();
        assert_eq!(spp(Goal::default()), Some(64));
        assert_eq!(spp(Goal { spp: Some(3), error: Some(0.1), ..Goal::default() }), Some(3));
        assert_eq!(spp(Goal { error: Some(0.1), ..Goal::default() }), None);
        assert_eq!(spp(Goal { samples: Some(4..9), ..Goal::default() }), Some(5));
    }
}
