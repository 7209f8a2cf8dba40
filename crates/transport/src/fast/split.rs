//! Paths that split where they turn first.
//!
//! Where a fire is looked at, or a floor beside it, most of the noise is of light that turns more than once: few directions lead
//! to where the smoke is bright, while the first turn is drawn evenly over the pixel. So a path goes on from there in several
//! branches, one after the other, each with its share of the weight (Arvo & Kirk 1990, "Particle transport and image synthesis").
//!
//! With v₁ and c₁ the variance and cost of the way to the first turn and v₂ and c₂ those of one branch, n branches make
//! variance times cost (v₁ + v₂/n)(c₁ + n c₂), least at n = √(v₂ c₁/(v₁ c₂)).

use glam::Vec3;
use tyndall_scene::surface::Presence;
use tyndall_scene::{Light, Ray, Scene, Volume};

use super::{Engine, Next};
use crate::first_draws::FirstDraws;
use crate::surface_vertex::SurfaceVertex;

/// Branches where it pays: in scene D they leave 0.42 of the variance for 1.8 times the time; 2, 6 and 8 gain less.
const BRANCHES: u32 = 4;

/// Albedo up to which it pays: paths that are scattered often are most of the cost.
const GREATEST_ALBEDO: f64 = 0.9;

/// Throughput below which paths play roulette, had they not split. 0.25 leaves a quarter more of the variance of scene D; by 0.025
/// paths cost more time than they bring.
pub(super) const ROULETTE_THROUGHPUT: f32 = 0.125;

/// Where a path has split.
#[derive(Clone, Copy, Default)]
pub(super) struct Fork {
    /// Branches that are still to come.
    left: u32,
    /// Volume of the collision, if it was one.
    volume: usize,
    position: Vec3,
    direction: Vec3,
    throughput: Vec3,
    scatterings: u32,
    draws: FirstDraws,
}

/// The rest of that, in scenes with surfaces.
#[derive(Debug, Clone)]
pub(super) struct SidedFork {
    /// The surface, if it was one.
    vertex: Option<SurfaceVertex>,
    ray: Ray,
    presence: Presence,
    refraction: f64,
}

/// Into how many branches the paths of a scene split: more than one where media glow and are not scattered in for long.
pub(super) fn branches(scene: &Scene) -> u32 {
    let glows = scene.lights.iter().any(|light| matches!(light, Light::Volume(_)));
    let absorbs = |volume: &Volume| volume.medium.albedo.max_element() <= GREATEST_ALBEDO;
    if glows && scene.volumes.iter().all(absorbs) { BRANCHES } else { 1 }
}

impl Engine<'_, '_> {
    /// Splits the path before it goes on from its collision in the volume of this number, or from a surface.
    #[inline(always)]
    pub(super) fn split(&mut self, slot: usize, volume: usize, vertex: Option<&SurfaceVertex>) {
        let branches = self.scene.branches;
        if branches < 2 {
            return;
        }
        let path = &mut self.paths[slot];
        path.throughput /= branches as f32;
        let left = branches - 1;
        let (position, direction) = (path.position, path.direction);
        let (throughput, scatterings) = (path.throughput, path.scatterings);
        path.fork = Fork { left, volume, position, direction, throughput, scatterings, draws: path.draws };
        path.draws = path.draws.of_branch(left, branches);
        if let Some(sided) = self.sided.get_mut(slot) {
            let (ray, presence, refraction) = (sided.ray, sided.presence.clone(), sided.refraction);
            let fork = SidedFork { vertex: vertex.cloned(), ray, presence, refraction };
            match &mut sided.fork {
                Some(place) => **place = fork,
                None => sided.fork = Some(Box::new(fork)),
            }
        }
    }

    /// Goes on with the path's next branch, if there is one.
    #[inline(always)]
    pub(super) fn branch(&mut self, slot: usize) -> Option<Next> {
        let path = &mut self.paths[slot];
        if path.fork.left == 0 {
            return None;
        }
        path.fork.left -= 1;
        let Fork { left, volume, position, direction, throughput, scatterings, draws } = path.fork;
        path.draws = draws.of_branch(left, self.scene.branches);
        (path.position, path.direction, path.throughput) = (position, direction, throughput);
        (path.turns, path.scatterings) = (1, scatterings);
        match self.sided.get_mut(slot) {
            None => self.turn_in(slot, volume, self.scene.to_world(position)),
            Some(sided) => {
                let fork = sided.fork.take()?;
                sided.presence.clone_from(&fork.presence);
                (sided.ray, sided.refraction) = (fork.ray, fork.refraction);
                match &fork.vertex {
                    Some(vertex) => self.turn_at(slot, vertex),
                    None => self.turn_in(slot, volume, fork.ray.origin),
                }
                self.sided[slot].fork = Some(fork);
            }
        }
        Some(self.turned(slot, false))
    }
}
