//! Paths side by side: in each round all of a thread's paths turn, then all follow their rays, then all look for light on
//! them, and so on.
//!
//! A path runs through more code from one turn to the next than a core's first cache of instructions holds; so each part of
//! it is done for [`TOGETHER`] paths before the next. Where arithmetic is most of a part, it is that of many paths at once: which surfaces rays
//! meet, and what light there is on their way. The paths do not touch each other, so that it does not matter which are together.

use glam::{DVec3, Vec3};
use tyndall_film::Sample;
use tyndall_lanes::Random;
use tyndall_scene::Ray;
use tyndall_scene::surface::{LANES, RayGroup, Surfaces};

use super::lit_way::{LitWays, Unshadowed};
use super::stretch::Stretch;
use super::{BRANCHES, FIRST, Homogeneous, LATER, Path, Reached};
use crate::beginning::Beginning;
use crate::first_draws::FirstDraws;
use crate::path_layers::PathLayers;
use crate::render::{RenderOptions, effort};
use crate::wide;
use crate::work::{Pixel, Work};

/// Paths in flight on a thread: whole groups of [`LANES`] and [`WAYS`].
const TOGETHER: usize = 32;
const _: () = assert!(TOGETHER.is_multiple_of(LANES) && TOGETHER.is_multiple_of(WAYS));

/// Ways on which light is looked for side by side. Loops over less the compiler unrolls, and makes no vector code of them.
const WAYS: usize = 16;

/// All samples that there are for a thread.
pub(in crate::fast) struct Paths<'a, 'f> {
    pub homogeneous: &'a Homogeneous<'a>,
    pub work: Work<'a, 'f>,
    pub options: &'a RenderOptions,
}

/// A sample under way.
struct Sampling {
    pixel: Pixel,
    random: Random,
    /// What those were before the first.
    begun: Random,
    draws: FirstDraws,
    layers: PathLayers<Vec3>,
    /// The camera's ray, and where it led.
    first: (Path, Reached),
    /// Number of the next branch.
    branch: u32,
    /// Whether one is under way, and that one.
    is_under_way: bool,
    path: Path,
    way: Reached,
}

impl wide::Task for Paths<'_, '_> {
    const GAINS_FROM_AVX512: bool = true;

    #[inline(always)]
    fn run(self) {
        let Paths { homogeneous, mut work, options } = self;
        let surfaces = &homogeneous.scene.surfaces;
        let mut samplings: Vec<Sampling> = Vec::with_capacity(TOGETHER);
        while samplings.len() < TOGETHER
            && let Some((pixel, sample)) = work.next()
        {
            samplings.push(Sampling::nothing());
            if let Some(sampling) = samplings.last_mut() {
                homogeneous.start(sampling, pixel, sample, options);
            }
        }
        while !samplings.is_empty() {
            if work.is_cancelled() {
                return;
            }
            for at in (0..samplings.len()).rev() {
                let sampling = &mut samplings[at];
                while !homogeneous.go_on(sampling) {
                    // Asked for each sample: where their paths end at once, all of them go by in a round.
                    if work.is_cancelled() {
                        return;
                    }
                    let pixel = sampling.pixel;
                    let layers = std::mem::take(&mut sampling.layers);
                    let sample = layers.into_sample(|colour| colour.as_dvec3());
                    let effort = effort(&sampling.begun, &sampling.random);
                    work.add(pixel, &Sample { effort, ..sample });
                    let Some((pixel, sample)) = work.next() else {
                        samplings.swap_remove(at);
                        break;
                    };
                    homogeneous.start(sampling, pixel, sample, options);
                }
            }
            let later = FirstDraws::Independent;
            for samplings in samplings.chunks_mut(LANES) {
                let mut rays = RayGroup::default();
                for (k, Sampling { path, .. }) in samplings.iter().enumerate() {
                    rays.set(k, &path.ray, f64::INFINITY);
                }
                let met = surfaces.meet_all(&rays);
                for (Sampling { path, way, layers, .. }, met) in samplings.iter_mut().zip(&met) {
                    homogeneous.reach(path, met.as_ref(), way, layers);
                }
            }
            let mut shadows = Shadows::default();
            if let Some(fog) = &homogeneous.fog {
                let lamps = (homogeneous.scene, &homogeneous.lamps);
                for (number, samplings) in samplings.chunks_mut(WAYS).enumerate() {
                    let mut ways = LitWays::<WAYS, LATER>::new(fog);
                    for (w, Sampling { path, way, random, .. }) in samplings.iter_mut().enumerate() {
                        if homogeneous.goes_on(path) {
                            ways.ask(w, lamps, &way.stretch, later.lit_way(random), random);
                        }
                    }
                    ways.look(lamps, fog);
                    for (w, Sampling { path, random, .. }) in samplings.iter_mut().enumerate() {
                        if let Some(lit) = ways.found(w, fog, random) {
                            let light = path.throughput * lit.light;
                            shadows.push(number * WAYS + w, path.scatterings + 1, light, &lit);
                        }
                    }
                }
            }
            shadows.add(surfaces, &mut samplings);
            let mut shadows = Shadows::default();
            for (slot, Sampling { path, way, random, .. }) in samplings.iter_mut().enumerate() {
                if homogeneous.goes_on(path)
                    && let Some(reflected) = homogeneous.arrive(path, way, later, random)
                {
                    shadows.push(slot, path.scatterings, reflected.light, &reflected);
                }
            }
            shadows.add(surfaces, &mut samplings);
        }
    }
}

/// Light that is added where nothing stands in its way.
struct Shadows {
    rays: [RayGroup; TOGETHER / LANES],
    /// Of each ray the place of its sample, how often its light was scattered, and the light.
    light: [(usize, u32, Vec3); TOGETHER],
    count: usize,
}

impl Default for Shadows {
    #[inline(always)]
    fn default() -> Self {
        let rays = [RayGroup::default(); TOGETHER / LANES];
        Self { rays, light: [(0, 0, Vec3::ZERO); TOGETHER], count: 0 }
    }
}

impl Shadows {
    #[inline(always)]
    fn push(&mut self, slot: usize, scatterings: u32, light: Vec3, unshadowed: &Unshadowed) {
        self.light[self.count] = (slot, scatterings, light);
        self.rays[self.count / LANES].set(self.count % LANES, &unshadowed.ray, unshadowed.distance);
        self.count += 1;
    }

    #[inline(always)]
    fn add(&self, surfaces: &Surfaces, samplings: &mut [Sampling]) {
        for (rays, light) in self.rays.iter().zip(self.light[..self.count].chunks(LANES)) {
            let hidden = surfaces.stand_in_all(rays);
            for ((slot, scatterings, light), hidden) in light.iter().zip(hidden) {
                if !hidden {
                    samplings[*slot].layers.add(*scatterings, *light);
                }
            }
        }
    }
}

impl Sampling {
    /// One that has not begun.
    fn nothing() -> Self {
        let path = Path::from_camera(Ray { origin: DVec3::ZERO, direction: DVec3::Z }, 1.0);
        let stretch = Stretch::new(None, &path.ray, 0.0);
        let way = Reached { stretch, hit: None, arrives: false, vertex: None };
        Self {
            pixel: Pixel::default(),
            random: Random::default(),
            begun: Random::default(),
            draws: FirstDraws::Independent,
            layers: PathLayers::default(),
            first: (path, way.clone()),
            branch: BRANCHES,
            is_under_way: false,
            path,
            way,
        }
    }
}

impl Homogeneous<'_> {
    /// Begins a sample: from the camera to the end of its ray.
    #[inline(always)]
    fn start(&self, sampling: &mut Sampling, pixel: Pixel, sample: u64, options: &RenderOptions) {
        let scene = self.scene;
        let Beginning { begun, mut random, draws, ray } =
            Beginning::new(scene, options, (pixel, sample), true);
        let path = Path::from_camera(ray, draws.collision(&mut random));
        let Sampling { layers, first: (_, way), .. } = sampling;
        let met = scene.surfaces.meet(&path.ray, f64::INFINITY);
        self.reach(&path, met.as_ref(), way, layers);
        let mut branch = BRANCHES;
        if self.goes_on(&path) {
            let is_seen = |light: &Unshadowed| !scene.surfaces.stand_in(&light.ray, light.distance);
            if let Some(fog) = &self.fog {
                let mut ways = LitWays::<1, FIRST>::new(fog);
                ways.ask(0, (scene, &self.lamps), &way.stretch, draws.lit_way(&mut random), &mut random);
                ways.look((scene, &self.lamps), fog);
                if let Some(lit) = ways.found(0, fog, &mut random).filter(is_seen) {
                    layers.add(path.scatterings + 1, path.throughput * lit.light);
                }
            }
            if let Some(reflected) = self.arrive(&path, way, draws, &mut random).filter(is_seen) {
                layers.add(path.scatterings, reflected.light);
            }
            branch = 0;
        }
        sampling.first.0 = path;
        (sampling.is_under_way, sampling.branch) = (false, branch);
        (sampling.pixel, sampling.draws) = (pixel, draws);
        (sampling.begun, sampling.random) = (begun, random);
    }

    /// Turns the sample's path, or goes on with its next branch; `false` if there is none left.
    #[inline(always)]
    fn go_on(&self, sampling: &mut Sampling) -> bool {
        let Sampling { random, draws, first, branch, is_under_way, path, way, .. } = sampling;
        let later = FirstDraws::Independent;
        if *is_under_way
            && self.goes_on(path)
            && self.turn(path, (&way.stretch, way.vertex.as_ref()), 0, later, random)
        {
            return true;
        }
        let (first, end) = (&first.0, (&first.1.stretch, first.1.vertex.as_ref()));
        *is_under_way = true;
        while *branch < BRANCHES {
            let number = *branch;
            *branch += 1;
            *path = *first;
            if self.turn(path, end, number, draws.of_branch(number, BRANCHES), random) {
                return true;
            }
        }
        false
    }
}
