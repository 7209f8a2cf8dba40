//! What a render does, counted if the crate is built with the feature `counters`.
//!
//! Every thread counts for itself, in plain numbers of its own, which are added to those of the render after each pass.
//! Without the feature counting compiles to nothing. The engine with rays in a pool counts everything,
//! the others what they share with it.
//!
//! A round of the march takes each ray of the pool through one cell or to a tentative collision; so the lane occupancy is
//! the cells visited over the room for rays. Visiting cells and looking densities up cost loads from random
//! places ([`Counters::loads`]), of which a machine has so many a second: its roof, which the example `roof` measures.

use std::sync::Mutex;
use std::time::Instant;

/// What is counted.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Event {
    /// A path, from the camera to its end.
    Path,
    /// A round of the march over the pool.
    Round,
    /// Room for a ray in a round of the march, whether there was one or not.
    Lane,
    /// A cell of a grid that a ray went through, or in a part of which it collided.
    Cell,
    /// A tentative collision of a path's own ray, for which a density was looked up.
    Tentative,
    /// Those of them that were real.
    Real,
    /// A tentative collision of a shadow ray, for which a density was looked up.
    ShadowStep,
    /// A shadow ray that roulette on what it could bring spared.
    ShadowSpared,
    /// A shadow ray that was traced.
    ShadowRay,
    /// A shadow ray that roulette ended on its way.
    ShadowEnded,
    /// A search for the next surface along a path's own ray.
    Intersection,
    /// A ray of a path that was followed to a collision, a surface, or out of the scene.
    Segment,
    /// A nanosecond in the march: cells and tentative collisions, and nothing else.
    MarchNanosecond,
}

impl Event {
    /// All of them with the keys they have in JSON.
    pub const ALL: [(Event, &str); 13] = [
        (Event::Path, "paths"),
        (Event::Round, "rounds"),
        (Event::Lane, "lanes"),
        (Event::Cell, "cells"),
        (Event::Tentative, "tentative_collisions"),
        (Event::Real, "real_collisions"),
        (Event::ShadowStep, "shadow_steps"),
        (Event::ShadowSpared, "shadow_rays_spared"),
        (Event::ShadowRay, "shadow_rays"),
        (Event::ShadowEnded, "shadow_rays_ended"),
        (Event::Intersection, "surface_intersections"),
        (Event::Segment, "segments"),
        (Event::MarchNanosecond, "march_nanoseconds"),
    ];
}

const COUNT: usize = Event::ALL.len();

/// How often each [`Event`] came about.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Counters {
    counts: [u64; COUNT],
}

#[cfg(feature = "counters")]
thread_local! {
    static OF_THREAD: std::cell::Cell<[u64; COUNT]> = const { std::cell::Cell::new([0; COUNT]) };
}

/// Whether anything is counted.
pub const COUNTED: bool = cfg!(feature = "counters");

/// Counts an event `times` times, on this thread.
#[inline(always)]
pub(crate) fn count(event: Event, times: u64) {
    #[cfg(feature = "counters")]
    OF_THREAD.with(|counts| {
        let mut all = counts.get();
        all[event as usize] += times;
        counts.set(all);
    });
    #[cfg(not(feature = "counters"))]
    let _ = (event, times);
}

/// What a clock shows, if anything is counted.
#[inline(always)]
pub(crate) fn clock() -> Option<Instant> {
    if COUNTED { Some(Instant::now()) } else { None }
}

/// Counts a round of the march, which began at `clock` with `active` rays: those of `tentative` have had a density
/// looked up, those of `happened` have collided, are shadow rays that roulette ended, or gather. `shadow` is above 0 for shadow
/// rays, and below for those that gather.
#[inline(always)]
pub(crate) fn count_round(
    clock: Option<Instant>,
    active: usize,
    shadow: &[f32],
    tentative: &[u16],
    happened: &[u16],
) {
    let Some(clock) = clock else { return };
    count(Event::MarchNanosecond, clock.elapsed().as_nanos() as u64);
    count(Event::Round, 1);
    count(Event::Lane, shadow.len() as u64);
    count(Event::Cell, active as u64);
    let shadows =
        |slots: &[u16]| slots.iter().filter(|&&slot| shadow[usize::from(slot)] > 0.0).count() as u64;
    let gathered = happened.iter().filter(|&&slot| shadow[usize::from(slot)] < 0.0).count() as u64;
    let (looked_up, ended) = (shadows(tentative), shadows(happened));
    count(Event::ShadowStep, looked_up);
    count(Event::Tentative, tentative.len() as u64 - looked_up);
    count(Event::ShadowEnded, ended);
    count(Event::Real, happened.len() as u64 - ended - gathered);
}

impl Counters {
    /// How often `event` came about; 0 if it is not counted.
    pub fn count(&self, event: Event) -> u64 {
        self.counts[event as usize]
    }

    /// Densities looked up.
    pub fn lookups(&self) -> u64 {
        self.count(Event::Tentative) + self.count(Event::ShadowStep)
    }

    /// Loads from random places: two for a cell, in the top table and in a node; three for a voxel, in a brick besides.
    pub fn loads(&self) -> u64 {
        2 * self.count(Event::Cell) + 3 * self.lookups()
    }

    /// Fraction of the march's lanes that had a ray to work on; NaN if there was none.
    pub fn occupancy(&self) -> f64 {
        self.count(Event::Cell) as f64 / self.count(Event::Lane) as f64
    }

    /// One JSON object, with what follows from the counts.
    pub fn json(&self) -> String {
        let counts = Event::ALL.iter().map(|&(event, key)| format!("\"{key}\": {}", self.count(event)));
        let mut fields: Vec<String> = counts.collect();
        fields.push(format!("\"density_lookups\": {}", self.lookups()));
        if self.count(Event::Lane) > 0 {
            fields.push(format!("\"lane_occupancy\": {:.4}", self.occupancy()));
        }
        format!("{{{}}}", fields.join(", "))
    }
}

/// The counters of a render, to which its threads add.
#[derive(Debug, Default)]
pub struct SharedCounters(Mutex<Counters>);

impl SharedCounters {
    /// What was counted so far.
    pub fn counters(&self) -> Counters {
        *self.0.lock().unwrap_or_else(std::sync::PoisonError::into_inner)
    }

    /// Moves here what this thread has counted.
    pub(crate) fn collect(&self) {
        #[cfg(feature = "counters")]
        {
            let mut all = self.0.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
            let of_thread = OF_THREAD.take();
            all.counts.iter_mut().zip(of_thread).for_each(|(sum, count)| *sum += count);
        }
    }
}

#[cfg(all(test, feature = "counters"))]
mod tests {
    use super::*;

    #[test]
    fn what_threads_count_is_added_once() {
        let shared = SharedCounters::default();
        std::thread::scope(|scope| {
            for _ in 0..3 {
                scope.spawn(|| {
                    count(Event::Path, 2);
                    count_round(clock(), 3, &[1.0, 0.0, 0.0, 0.0], &[0, 1, 2], &[1]);
                    shared.collect();
                    shared.collect();
                });
            }
        });
        let counters = shared.counters();
        assert_eq!(counters.count(Event::Path), 6);
        assert_eq!((counters.count(Event::ShadowStep), counters.count(Event::Tentative)), (3, 6));
        assert_eq!((counters.count(Event::ShadowEnded), counters.count(Event::Real)), (0, 3));
        assert_eq!((counters.lookups(), counters.loads()), (9, 2 * 9 + 3 * 9));
        assert_eq!(counters.occupancy(), 0.75);
    }
}
