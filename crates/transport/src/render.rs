//! One pass over the film, by any integrator, on many threads.
//!
//! Which thread renders which [block](crate::work), and in which order, changes nothing: every path has random numbers of its own
//! and the film adds exactly.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use tyndall_film::{Film, Sample};
use tyndall_lanes::Random;
use tyndall_scene::description::{Integrator, Sampler};
use tyndall_scene::{Ray, Scene};

use crate::beginning::Beginning;
use crate::counters::SharedCounters;
use crate::estimators::Estimators;
use crate::fast::{self, FastScene};
use crate::fast_spectral::{self, FastSpectralScene};
use crate::reference;
use crate::spectral::SpectralIntegrator;
use crate::threads;
use crate::work::{Pass, Work};

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
    /// Set to stop soon; tiles under way are given up.
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

/// A scene made ready for an integrator, for as many passes as are wanted.
pub struct Renderer<'a> {
    scene: &'a Scene,
    engine: Engine<'a>,
}

/// Renders the samples that the film's open pass lacks before sample number `end`, with a [`Renderer`] for this pass alone.
/// A film without an open pass (see [`Film::open_range`]) gets none.
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
    /// A film without an open pass (see [`Film::open_range`]) gets none.
    pub fn render_pass(
        &self,
        film: &mut Film,
        end: u64,
        options: &RenderOptions,
        control: &Control,
    ) -> Outcome {
        let scene = self.scene;
        let pass = Pass::new(film, end, control);
        threads::share(options.threads, || {
            let work = Work::new(&pass);
            match &self.engine {
                Engine::Fast(fast_scene) => fast::render(fast_scene, work, options),
                Engine::FastSpectral(fast_scene) => fast_spectral::render(fast_scene, work, options),
                Engine::Reference => trace_paths(scene, work, options, |ray, random| {
                    reference::trace_with(scene, options.estimators, ray, random)
                }),
                Engine::Spectral(spectral) => {
                    trace_paths(scene, work, options, |ray, random| spectral.trace(ray, random));
                }
            }
            control.counters.collect();
        });
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

/// What a sample took whose random numbers are now those.
#[inline(always)]
pub(crate) fn effort(begun: &Random, now: &Random) -> u32 {
    now.draws_since(begun).try_into().unwrap_or(u32::MAX)
}

/// One path after the other, each by `trace`.
#[inline(always)]
fn trace_paths(
    scene: &Scene,
    mut work: Work,
    options: &RenderOptions,
    trace: impl Fn(Ray, &mut Random) -> Sample,
) {
    while !work.is_cancelled()
        && let Some((pixel, sample)) = work.next()
    {
        let Beginning { begun, mut random, ray, .. } = Beginning::new(scene, options, (pixel, sample), true);
        let sample = trace(ray, &mut random);
        work.add(pixel, &Sample { effort: effort(&begun, &random), ..sample });
    }
}
