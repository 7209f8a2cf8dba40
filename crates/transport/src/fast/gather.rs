//! The camera's ray through a grid: light is gathered at every tentative collision, not at a real one alone.
//!
//! A tentative collision of delta tracking is real with the probability p = μt/μ̄. In place of that choice, with the weight
//! W = ∏ (1 − p) of those before it, each brings the part W p of what a real collision would
//! (Galtier et al. 2013, "Integral formulation of null-collision Monte Carlo algorithms", section 3):
//!
//!   L ≈ Σ W p [ (1 − albedo) Le + albedo Ls ] + W_end L(end)
//!
//! Of Ls, what the [light cache](super::light_cache) knows is added at all of them; the rest, which is what the cache is wrong
//! by and light that was scattered more often, at one that is drawn in proportion to W p. What lies behind the
//! grid is met with the weight W_end. In thin media, where whether a ray collides at all is most of the noise, that noise is
//! gone; and a majorant above the least brings more places to gather at. Of a fire it is the glow that is gathered so: without,
//! a quarter of the variance of scene D is whether the camera's ray collides.
//!
//! What the film is told of the first collision, its distance and albedo, is decided as in delta tracking.

use glam::Vec3;
use tyndall_scene::{Ray, Scene};

use super::light_cache::LightCache;
use super::pool::OWN;
use super::sided::{Direct, light_of};
use super::volume::{FastVolume, Kind};
use super::{Engine, Next};
use crate::counters::{self, Event};
use crate::first_draws::FirstDraws;
use crate::path_layers::FirstMet;

/// Weight below which what is left of the ray plays roulette; survivors get this weight.
const ROULETTE_WEIGHT: f32 = 0.1;

/// What majorants of gathering rays are multiplied by. 1 leaves a third more of the variance of scene B, and 4 costs more
/// time than it brings.
pub(super) const RATE: f32 = 2.0;

/// What the probability of a shadow ray from the collision that is drawn is multiplied by: for most it is certain. Without,
/// what the cache is wrong by is half of the variance of scene B.
pub(super) const CERTAINTY: f32 = 16.0;

/// Throughput below which paths play roulette where rays gather: the weights of what they draw are small for good reason.
pub(super) const ROULETTE_THROUGHPUT: f32 = 0.05;

/// Mean optical thickness from which a grid does not count as thin.
const GREATEST_THICKNESS: f32 = 4.0;

/// What a camera ray has gathered so far.
#[derive(Clone, Copy, Default)]
pub(super) struct Gathered {
    /// Σ W p.
    weight: f32,
    /// Distance of the collision that is drawn.
    distance: f32,
    /// Whether delta tracking would have collided.
    has_collided: bool,
    /// The collision to go on from, once there is nothing else to do.
    pending: Option<Pending>,
}

/// A collision to go on from.
#[derive(Clone, Copy)]
struct Pending {
    position: Vec3,
    direction: Vec3,
    distance: f32,
    weight: f32,
    draws: FirstDraws,
}

/// Whether it pays that the camera's rays gather: if the scene is one grid, amid plain surfaces or none, that is thin and of which
/// something is known of the light that arrives there, or a fire around which paths split. In thick media what is gathered
/// far inside brings less than it costs.
pub(super) fn pays(scene: &Scene, volumes: &[FastVolume], cache: Option<&LightCache>, branches: u32) -> bool {
    let is_grid = |volume: &FastVolume| matches!(volume.kind, Kind::Grid(_)) && volume.shines.is_none();
    let catches = scene.surfaces.shapes.iter().any(|shape| shape.is_shadow_catcher);
    let is_thin = cache.is_some_and(|cache| cache.mean_thickness() < GREATEST_THICKNESS);
    matches!(volumes, [volume] if is_grid(volume)) && !catches && (is_thin || branches > 1)
}

impl Engine<'_, '_> {
    /// The ray has come to a tentative collision; whether it goes on from there.
    #[inline(always)]
    pub(super) fn gather_at(&mut self, slot: usize) -> bool {
        let rays = &mut *self.rays;
        let [null, u] = rays.null[slot];
        let share = rays.transmittance[slot] * (1.0 - null);
        let rest = rays.transmittance[slot] * null;
        let random = &mut rays.random[slot];
        let distance = rays.t[slot];
        let path = &mut self.paths[slot];
        let volume = &self.scene.volumes[rays.volume[slot] as usize];
        if share > 0.0 {
            let position = path.position + path.direction * distance;
            let (albedo, emission) = self.scene.albedo_and_emission(volume, position, random);
            if !path.gathered.has_collided && u >= null {
                path.gathered.has_collided = true;
                let (distance, albedo) = (f64::from(distance), albedo.as_dvec3());
                path.first = Some(FirstMet { distance, albedo, ..FirstMet::default() });
            }
            path.emission += share * emission;
            path.gathered.weight += share;
            if random.f32() * path.gathered.weight < share {
                path.gathered.distance = distance;
            }
            if let Some(cache) = &self.scene.light_cache
                && self.scene.scene.max_depth != Some(0)
            {
                let value = volume.phase.turning(path.direction);
                let here = self.scene.to_world(position);
                let scene = self.scene.scene;
                for number in cache.lights() {
                    let probability = scene.light_probability(number, here);
                    let chosen = (number, probability);
                    let direct = light_of(self.scene, chosen, here, &value, FirstDraws::Independent, random);
                    if let Some(Direct { unshadowed, .. }) = direct.filter(|_| probability > 0.0) {
                        let through = cache.transmittance(number, position).unwrap_or_default();
                        path.single += (share * through * probability as f32) * albedo * unshadowed;
                    }
                }
            }
        }
        let rays = &mut *self.rays;
        if rest >= ROULETTE_WEIGHT || !path.gathered.has_collided {
            rays.transmittance[slot] = rest;
            return true;
        }
        let survives = rays.random[slot].f32() * ROULETTE_WEIGHT < rest;
        rays.transmittance[slot] = if survives { ROULETTE_WEIGHT } else { 0.0 };
        survives
    }

    /// The ray is through the grid, or has gathered all there is: what lies behind is met, and then the path goes on from its
    /// collision.
    #[inline(always)]
    pub(super) fn finish_gathering(&mut self, slot: usize) -> Next {
        counters::count(Event::Segment, 1);
        let behind = self.rays.transmittance[slot];
        self.rays.shadow[slot] = OWN;
        let path = &mut self.paths[slot];
        let Gathered { weight, distance, .. } = path.gathered;
        path.gathered.pending = (weight > 0.0).then_some(Pending {
            position: path.position,
            direction: path.direction,
            distance,
            weight,
            draws: path.draws,
        });
        path.throughput = Vec3::splat(behind);
        if behind <= 0.0 {
            return Next::Record;
        }
        if self.scene.is_sided { self.arrive(slot) } else { self.escape(slot) }
    }

    /// Goes on from the collision that the camera's ray has left behind, if there is one.
    #[inline(always)]
    pub(super) fn resume(&mut self, slot: usize) -> Option<Next> {
        let path = &mut self.paths[slot];
        let Pending { position, direction, distance, weight, draws } = path.gathered.pending.take()?;
        (path.position, path.direction, path.throughput, path.draws) =
            (position, direction, Vec3::splat(weight), draws);
        (path.turns, path.scatterings, path.turned) = (0, 0, None);
        if let Some(sided) = self.sided.get_mut(slot) {
            let direction = direction.as_dvec3().normalize();
            (sided.ray, sided.refraction) = (Ray { origin: self.scene.to_world(position), direction }, 1.0);
        }
        Some(self.scatter(slot, 0, distance, true))
    }
}
