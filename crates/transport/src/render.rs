//! One pass over the film: blocks of tiles shared out among threads, by any integrator.
//!
//! Which thread renders which block, and in which order, changes nothing: every path has random numbers of its own
//! and the film adds exactly.

use std::cmp::Reverse;
use std::sync::atomic::{AtomicBool, AtomicU64, AtomicUsize, Ordering};
use std::sync::{Arc, Mutex};
use tyndall_film::{Film, FilmTile, Sample, TILE_EDGE};
use tyndall_lanes::Random;
use tyndall_scene::description::{Integrator, Sampler};
use tyndall_scene::{Ray, Scene};

use crate::counters::{self, Event, SharedCounters};
use crate::estimators::Estimators;
use crate::fast::{self, FastScene};
use crate::fast_spectral::{self, FastSpectralScene};
use crate::first_draws::FirstDraws;
use crate::reference;
use crate::spectral::SpectralIntegrator;
use crate::threads;

/// How to render.
#[derive(Debug, Clone, Copy)]
pub struct RenderOptions {
    /// Which integrator. A [spectral](Scene::is_spectral) scene has the spectral one, or, if it is a single even medium
    /// and the fast one is asked for, a fast one of its own.
    pub integrator: Integrator,
    /// How the first random numbers of each path are drawn.
    pub sampler: Sampler,
    /// Seed of the random numbers.
    pub seed: u64,
    /// Number of threads, at least 1.
    pub threads: usize,
    /// Which estimators the reference integrator uses; the fast one has its own.
    pub estimators: Estimators,
}

/// What a render tells and is told while it runs.
#[derive(Debug, Default)]
pub struct Control {
    /// Set to stop soon; blocks under way are given up.
    pub cancel: Arc<AtomicBool>,
    /// Samples (paths) finished so far, over all passes.
    pub samples: AtomicU64,
    /// What all passes did, as far as it is [counted](crate::counters).
    pub counters: SharedCounters,
}

/// How a pass ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Outcome {
    /// Every tile holds its samples.
    Complete,
    /// Cancelled; the film holds the tiles that were done and knows which.
    Cancelled,
}

/// Tiles along each edge of a block: 32×32 pixels, neighbours that look into the same parts of the volumes.
const BLOCK_TILES: u32 = 2;

/// Paths that a thread takes at once, where there are enough to go round: while a pool runs empty, after the last of
/// them has begun, it does little.
const PATHS_AT_ONCE: u64 = 1 << 16;

/// A scene made ready for an integrator, for as many passes as are wanted.
pub struct Renderer<'a> {
    scene: &'a Scene,
    engine: Engine<'a>,
}

/// Renders the samples that the film's open pass lacks before sample number `end`, with a [`Renderer`] for this pass alone.
///
/// # Panics
/// If the film has no open pass (see [`Film::open_range`]).
pub fn render_pass(
    scene: &Scene,
    film: &mut Film,
    end: u64,
    options: &RenderOptions,
    control: &Control,
) -> Outcome {
    Renderer::new(scene, options.integrator).render_pass(film, end, options, control)
}

impl<'a> Renderer<'a> {
    /// Prepares a scene for the integrator; a [spectral](Scene::is_spectral) scene has the spectral one, whichever is asked for.
    pub fn new(scene: &'a Scene, integrator: Integrator) -> Self {
        Self { scene, engine: Engine::new(scene, integrator) }
    }

    /// Renders the samples that the film's open pass lacks before sample number `end`. The integrator is that of
    /// [`new`](Self::new), whatever the options say.
    ///
    /// # Panics
    /// If the film has no open pass (see [`Film::open_range`]).
    pub fn render_pass(
        &self,
        film: &mut Film,
        end: u64,
        options: &RenderOptions,
        control: &Control,
    ) -> Outcome {
        let scene = self.scene;
        let blocks = shares(blocks(film, end), film, end, options.threads);
        let next_block = AtomicUsize::new(0);
        let film = Mutex::new(film);
        let work = || {
            while let Some(block) = blocks.get(next_block.fetch_add(1, Ordering::Relaxed)) {
                let mut tiles = open_tiles(&lock(&film), block, end);
                let cancel = &control.cancel;
                let complete = match &self.engine {
                    Engine::Fast(fast_scene) => fast::render_tiles(fast_scene, &mut tiles, options, cancel),
                    Engine::FastSpectral(fast_scene) => {
                        fast_spectral::render_tiles(fast_scene, &mut tiles, options, cancel)
                    }
                    Engine::Reference => trace_tiles(scene, &mut tiles, options, cancel, |ray, random| {
                        reference::trace_with(scene, options.estimators, ray, random)
                    }),
                    Engine::Spectral(spectral) => {
                        trace_tiles(scene, &mut tiles, options, cancel, |ray, random| {
                            spectral.trace(ray, random)
                        })
                    }
                };
                if complete {
                    counters::count(Event::Path, tiles.iter().map(FilmTile::sample_count).sum());
                }
                control.counters.collect();
                if !complete {
                    return;
                }
                let mut film = lock(&film);
                for tile in &tiles {
                    film.merge_tile(tile);
                    control.samples.fetch_add(tile.sample_count(), Ordering::Relaxed);
                }
            }
        };
        threads::share(options.threads, work);
        if control.cancel.load(Ordering::Relaxed) { Outcome::Cancelled } else { Outcome::Complete }
    }
}

/// The integrator that renders a scene, and the scene as it wants it.
enum Engine<'a> {
    Fast(Box<FastScene<'a>>),
    FastSpectral(Box<FastSpectralScene<'a>>),
    Reference,
    Spectral(Box<SpectralIntegrator<'a>>),
}

impl<'a> Engine<'a> {
    /// The engines with many paths in flight compute in single precision: what is too dense for them is left to the others.
    fn new(scene: &'a Scene, integrator: Integrator) -> Self {
        let is_dense = scene.too_dense_for_single_precision().is_some();
        let integrator = if is_dense { Integrator::Reference } else { integrator };
        if scene.is_spectral() {
            let fast = if integrator == Integrator::Fast { FastSpectralScene::new(scene) } else { None };
            return match fast {
                Some(fast_scene) => Self::FastSpectral(Box::new(fast_scene)),
                None => Self::Spectral(Box::new(SpectralIntegrator::new(scene))),
            };
        }
        match integrator {
            Integrator::Fast => Self::Fast(Box::new(FastScene::new(scene))),
            Integrator::Reference => Self::Reference,
        }
    }
}

/// A thread that panicked holding the lock has ended the render anyway.
fn lock<'a, 'f>(film: &'a Mutex<&'f mut Film>) -> std::sync::MutexGuard<'a, &'f mut Film> {
    film.lock().unwrap_or_else(std::sync::PoisonError::into_inner)
}

/// Number of samples that some tiles still need.
fn lacking(film: &Film, tiles: &[usize], end: u64) -> u64 {
    tiles.iter().map(|&tile| film.lacking(tile, end)).sum()
}

/// Numbers of the film's tiles, by block; where pixels have different numbers of samples, those with most first.
fn blocks(film: &Film, end: u64) -> Vec<Vec<usize>> {
    let columns = film.width().div_ceil(TILE_EDGE);
    let block_columns = columns.div_ceil(BLOCK_TILES) as usize;
    let block_rows = film.height().div_ceil(TILE_EDGE * BLOCK_TILES) as usize;
    let mut blocks = vec![Vec::new(); block_columns * block_rows];
    for tile in 0..film.tile_count() {
        let rect = film.tile_rect(tile);
        let along = |pixels: u32| (pixels / (TILE_EDGE * BLOCK_TILES)) as usize;
        blocks[along(rect.y) * block_columns + along(rect.x)].push(tile);
    }
    if film.rates().is_some() {
        blocks.sort_by_cached_key(|block| Reverse(lacking(film, block, end)));
    }
    blocks
}

/// Blocks joined to what a thread takes at once: [`PATHS_AT_ONCE`] and towards the end, where threads would have to wait
/// for the last one, half a thread's part of what is left (guided self-scheduling, Polychronopoulos & Kuck 1987).
fn shares(blocks: Vec<Vec<usize>>, film: &Film, end: u64, threads: usize) -> Vec<Vec<usize>> {
    let paths = |block: &[usize]| lacking(film, block, end);
    let mut left: u64 = blocks.iter().map(|block| paths(block)).sum();
    let mut shares = Vec::new();
    let mut blocks = blocks.into_iter().peekable();
    while let Some(mut share) = blocks.next() {
        let limit = PATHS_AT_ONCE.min(left / (2 * threads.max(1) as u64));
        let mut taken = paths(&share);
        while let Some(block) = blocks.next_if(|block| taken + paths(block) <= limit) {
            taken += paths(&block);
            share.extend(block);
        }
        left -= taken;
        shares.push(share);
    }
    shares
}

/// Empty tiles for the samples that the tiles of the share still need.
fn open_tiles(film: &Film, share: &[usize], end: u64) -> Vec<FilmTile> {
    share.iter().filter_map(|&tile| film.open_tile(tile, end)).collect()
}

/// What a sample took whose random numbers are now those.
#[inline(always)]
pub(crate) fn effort(begun: &Random, now: &Random) -> u32 {
    now.draws_since(begun).try_into().unwrap_or(u32::MAX)
}

/// Some tiles, one path after the other, each by `trace`; `false` if cancelled.
#[inline(always)]
fn trace_tiles(
    scene: &Scene,
    tiles: &mut [FilmTile],
    options: &RenderOptions,
    cancel: &AtomicBool,
    trace: impl Fn(Ray, &mut Random) -> Sample,
) -> bool {
    for tile in tiles {
        let rect = tile.rect();
        for y in rect.y..rect.y + rect.height {
            for x in rect.x..rect.x + rect.width {
                let pixel = u64::from(y) * u64::from(scene.resolution[0]) + u64::from(x);
                for sample in tile.samples_of(x, y, tile.rounds()) {
                    if cancel.load(Ordering::Relaxed) {
                        return false;
                    }
                    let begun = Random::new(options.seed, pixel, sample);
                    let mut random = begun;
                    let draws = FirstDraws::new(options.sampler, options.seed, pixel, sample);
                    let film_u = draws.film(&mut random);
                    let lens_u = draws.lens(&mut random);
                    let ray = scene.camera.ray([x, y], film_u, lens_u);
                    let sample = trace(ray, &mut random);
                    tile.add(x, y, &Sample { effort: effort(&begun, &random), ..sample });
                }
            }
        }
    }
    true
}
