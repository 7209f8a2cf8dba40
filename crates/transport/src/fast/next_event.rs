//! Next-event estimation at a collision, with roulette before a shadow ray is paid for.
//!
//! A shadow ray whose contribution would be small is traced with a small probability and weighs the more. What the
//! [light cache](super::light_cache) knows of its transmittance is added instead of it, and the ray only corrects that.

use glam::DVec3;
use tyndall_lanes::Random;

use super::gather;
use super::pool::Path;
use super::sided::{Direct, draw_light};
use super::volume::{FastScene, Phase};
use crate::counters::{self, Event};

/// A shadow ray is traced for certain if its contribution is this share of what the unweakened light would bring
/// by isotropic scattering, and in proportion below. Efficiency 1/(error²·time) of the built-in cumulus and the
/// Disney cloud is level to 5 % between 0.5 and 1; 2 loses a quarter to variance, 0.25 a tenth to time.
const CERTAIN_CONTRIBUTION: f32 = 0.7;

/// Where the light cache knows a transmittance T_c, the probability of a shadow ray is multiplied by this and by
/// √(T_c (1 − T_c)), about the spread of what it may find, plus [`LEAST_DOUBT`]. Variance of scene A is level between 0.5
/// and 2 and rises by a tenth at 0.25.
const CERTAIN_DOUBT: f32 = 0.5;

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
    let direct = draw_light(scene.scene, from, phase.turning(path.direction), path.draws, random);
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
        traced *= CERTAIN_DOUBT * ((cached * (1.0 - cached)).max(0.0).sqrt() + LEAST_DOUBT);
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
    path.direct = direct * boost;
    path.direct_is_glow = is_glow;
    path.shadow_direction = toward.as_vec3();
    path.light_distance = distance as f32;
    Some((toward, distance))
}
