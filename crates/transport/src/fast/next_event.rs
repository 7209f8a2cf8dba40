//! Next-event estimation at a collision, with roulette before a shadow ray is paid for.
//!
//! A shadow ray whose contribution would be small is traced with a small probability and weighs the more. What the
//! [light cache](super::light_cache) knows of its transmittance is added instead of it, and the ray only corrects that. Where it knows
//! all lights, what it knows of all is added, and one is corrected.

use glam::{DVec3, Vec3};
use tyndall_lanes::Random;

use super::gather;
use super::pool::Path;
use super::sided::{Direct, draw_light, light_of};
use super::volume::{FastScene, Phase};
use crate::counters::{self, Event};
use crate::first_draws::FirstDraws;

/// A shadow ray is traced for certain if its contribution is this share of what the unweakened light would bring
/// by isotropic scattering, and in proportion below. Efficiency 1/(error²·time) of the built-in cumulus and the
/// Disney cloud is level to 5 % between 0.5 and 1; 2 loses a quarter to variance, 0.25 a tenth to time.
const CERTAIN_CONTRIBUTION: f32 = 0.7;

/// Where the light cache knows a transmittance T_c, the probability of a shadow ray is multiplied by this and by
/// √(T_c (1 − T_c)) + [`LEAST_DOUBT`]. Variance of scene A is level between 0.5
/// and 2 and rises by a tenth at 0.25.
const CERTAIN_DOUBT: f32 = 0.5;

/// What the probability of a shadow ray is multiplied by where the cache knows all lights. Variance times time of scene B is level
/// between 4 and 12.
const CERTAIN_CORRECTION: f32 = 4.0;

/// What the cache is trusted with at most: it holds for a place some voxels wide.
const LEAST_DOUBT: f32 = 0.05;

/// Draws a light for the place `from`, and what it would bring by the next event; its direction and distance, or `None`
/// if there is nothing to trace or roulette, played on the contribution before the shadow ray is paid for, ended it.
#[inline(always)]
pub(super) fn choose_direct(
    scene: &FastScene<'_>,
    from: DVec3,
    path: &mut Path,
    phase: Phase<'_>,
    gathered: bool,
    random: &mut Random,
) -> Option<(DVec3, f64)> {
    let direct = draw_light(scene, from, phase.turning(path.direction), path.draws, random);
    let Direct { light, unshadowed, arriving, is_glow, toward, distance } = direct?;
    let direct = path.throughput * unshadowed;
    let strength = direct.max_element();
    if strength <= 0.0 {
        return None;
    }
    let isotropic = arriving.max_element() * 0.25 * std::f32::consts::FRAC_1_PI;
    let mut traced = strength / (CERTAIN_CONTRIBUTION * isotropic);
    let cached = scene.light_cache.as_ref();
    let cached = cached.and_then(|cache| cache.transmittance(light, path.position));
    if let Some(cached) = cached {
        traced *= CERTAIN_DOUBT * doubt(cached);
        if !gathered {
            path.add_in_scattered(direct * cached);
        }
    }
    if gathered {
        traced *= gather::CERTAINTY;
    }
    // What a branch brings is small because there are several.
    if path.turns > 1 {
        traced *= scene.branches as f32;
    }
    let cached = cached.unwrap_or(0.0);
    let mut boost = 1.0;
    if traced < 1.0 {
        if random.f32() >= traced {
            counters::count(Event::ShadowSpared, 1);
            return None;
        }
        boost = 1.0 / traced;
    }
    path.add_in_scattered(direct * (-cached * boost));
    path.look(direct * boost, is_glow, (toward, distance));
    Some((toward, distance))
}

/// Where the light cache knows every light, and none is more than a point or a direction: adds what it knows of all of them, unless
/// that was gathered on the way, and draws one of them, in proportion to what the cache may be wrong by, to be corrected by a shadow ray. Its direction
/// and distance, or `None` if roulette ended it. `value` gives f or the phase function at the place `from`.
///
/// To draw a light first, and ask the cache for that one alone, is 1.7 times as much variance in scene B, for 0.95 of the time.
#[inline(always)]
pub(super) fn choose_correction(
    scene: &FastScene<'_>,
    from: DVec3,
    path: &mut Path,
    value: impl Fn(DVec3) -> (DVec3, f64),
    gathered: bool,
    random: &mut Random,
) -> Option<(DVec3, f64)> {
    let cache = scene.light_cache.as_ref()?;
    let (mut known, mut doubts, mut isotropic) = (Vec3::ZERO, 0.0, 0.0);
    let mut chosen = None;
    for number in cache.lights() {
        let draws = FirstDraws::Independent;
        let Some(light) = light_of(scene, (number, 1.0), from, &value, draws, random) else { continue };
        let cached = cache.transmittance(number, path.position).unwrap_or_default();
        let direct = path.throughput * light.unshadowed;
        known += direct * cached;
        isotropic += light.arriving.max_element() * 0.25 * std::f32::consts::FRAC_1_PI;
        let doubt = direct.max_element() * doubt(cached);
        doubts += doubt;
        if random.f32() * doubts < doubt {
            chosen = Some((direct, cached, doubt, (light.toward, light.distance)));
        }
    }
    if !gathered {
        path.add_in_scattered(known);
    }
    let (direct, cached, doubt, way) = chosen?;
    let traced = (CERTAIN_CORRECTION * doubts / isotropic).min(1.0);
    if traced < 1.0 && random.f32() >= traced {
        counters::count(Event::ShadowSpared, 1);
        return None;
    }
    let direct = direct * (doubts / (doubt * traced));
    path.add_in_scattered(direct * -cached);
    path.look(direct, false, way);
    Some(way)
}

/// About the spread of what a shadow ray may find where the cache knows of the transmittance `cached`.
#[inline(always)]
fn doubt(cached: f32) -> f32 {
    (cached * (1.0 - cached)).max(0.0).sqrt() + LEAST_DOUBT
}
