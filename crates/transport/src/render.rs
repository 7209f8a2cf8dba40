//! One pass over the film: blocks of tiles shared out among threads, by any integrator.
//!
//! Which thread renders which block, and in which order, changes nothing: every path has random numbers of its own
//! and the film adds exactly.

use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, AtomicU64, AtomicUsize, Ordering};
use tyndall_film::{Film, FilmTile, Sample, TILE_EDGE};
use tyndall_lanes::Random;
use tyndall_scene::description::Integrator;
use tyndall_scene::{Ray, Scene};

use crate::counters::{self, Event, SharedCounters};
use crate::estimators::Estimators;
use crate::fast::{self, FastScene};
use crate::reference;
use crate::spectral::SpectralIntegrator;

/// How to render.
#[derive(Debug, Clone, Copy)]
pub struct RenderOptions {
    /// Which integrator; a [spectral](Scene::is_spectral) scene has the spectral one, whatever stands here.
    pub integrator: Integrator,
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
    pub cancel: AtomicBool,
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

/// Tiles along each edge of a block: 64×64 pixels, enough work to keep a pool full.
const BLOCK_TILES: u32 = 4;

/// Renders the samples that the film's open pass lacks before sample number `end`.
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
    let blocks = blocks(film);
    let engine = Engine::new(scene, options.integrator);
    let next_block = AtomicUsize::new(0);
    let film = Mutex::new(film);
    let work = || {
        while let Some(block) = blocks.get(next_block.fetch_add(1, Ordering::Relaxed)) {
            let mut tiles = open_tiles(&lock(&film), block, end);
            let (seed, cancel) = (options.seed, &control.cancel);
            let complete = match &engine {
                Engine::Fast(fast_scene) => fast::render_tiles(fast_scene, &mut tiles, seed, cancel),
                Engine::Reference => trace_tiles(scene, &mut tiles, seed, cancel, |ray, random| {
                    reference::trace_with(scene, options.estimators, ray, random)
                }),
                Engine::Spectral(spectral) => {
                    trace_tiles(scene, &mut tiles, seed, cancel, |ray, random| spectral.trace(ray, random))
                }
            };
            if complete {
                counters::count(Event::Path, tiles.iter().map(sample_count).sum());
            }
            control.counters.collect();
            if !complete {
                return;
            }
            let mut film = lock(&film);
            for tile in &tiles {
                film.merge_tile(tile);
                control.samples.fetch_add(sample_count(tile), Ordering::Relaxed);
            }
        }
    };
    std::thread::scope(|scope| {
        for _ in 1..options.threads.max(1) {
            scope.spawn(work);
        }
        work();
    });
    if control.cancel.load(Ordering::Relaxed) { Outcome::Cancelled } else { Outcome::Complete }
}

/// The integrator that renders a scene, and the scene as it wants it.
enum Engine<'a> {
    Fast(FastScene<'a>),
    Reference,
    Spectral(Box<SpectralIntegrator<'a>>),
}

impl<'a> Engine<'a> {
    fn new(scene: &'a Scene, integrator: Integrator) -> Self {
        match integrator {
            _ if scene.is_spectral() => Self::Spectral(Box::new(SpectralIntegrator::new(scene))),
            Integrator::Fast => Self::Fast(FastScene::new(scene)),
            Integrator::Reference => Self::Reference,
        }
    }
}

/// A thread that panicked holding the lock has ended the render anyway.
fn lock<'a, 'f>(film: &'a Mutex<&'f mut Film>) -> std::sync::MutexGuard<'a, &'f mut Film> {
    film.lock().unwrap_or_else(std::sync::PoisonError::into_inner)
}

/// Numbers of the film's tiles, by block.
fn blocks(film: &Film) -> Vec<Vec<usize>> {
    let columns = film.width().div_ceil(TILE_EDGE);
    let block_columns = columns.div_ceil(BLOCK_TILES) as usize;
    let block_rows = film.height().div_ceil(TILE_EDGE * BLOCK_TILES) as usize;
    let mut blocks = vec![Vec::new(); block_columns * block_rows];
    for tile in 0..film.tile_count() {
        let rect = film.tile_rect(tile);
        let along = |pixels: u32| (pixels / (TILE_EDGE * BLOCK_TILES)) as usize;
        blocks[along(rect.y) * block_columns + along(rect.x)].push(tile);
    }
    blocks
}

/// Empty tiles for the samples that each tile of the block still needs.
fn open_tiles(film: &Film, block: &[usize], end: u64) -> Vec<FilmTile> {
    block
        .iter()
        .filter_map(|&tile| {
            let start = film.next_sample(tile).expect("a pass is open");
            (start < end).then(|| FilmTile::new(film.tile_rect(tile), start..end, film.layers()))
        })
        .collect()
}

fn sample_count(tile: &FilmTile) -> u64 {
    let (rect, samples) = (tile.rect(), tile.samples());
    u64::from(rect.width) * u64::from(rect.height) * (samples.end - samples.start)
}

/// Some tiles, one path after the other, each by `trace`; `false` if cancelled.
fn trace_tiles(
    scene: &Scene,
    tiles: &mut [FilmTile],
    seed: u64,
    cancel: &AtomicBool,
    trace: impl Fn(Ray, &mut Random) -> Sample,
) -> bool {
    for tile in tiles {
        let rect = tile.rect();
        for y in rect.y..rect.y + rect.height {
            for x in rect.x..rect.x + rect.width {
                if cancel.load(Ordering::Relaxed) {
                    return false;
                }
                let pixel = u64::from(y) * u64::from(scene.resolution[0]) + u64::from(x);
                for sample in tile.samples() {
                    let mut random = Random::new(seed, pixel, sample);
                    let film_u = [random.f64(), random.f64()];
                    let lens_u = [random.f64(), random.f64()];
                    let ray = scene.camera.ray([x, y], film_u, lens_u);
                    tile.add(x, y, &trace(ray, &mut random));
                }
            }
        }
    }
    true
}
