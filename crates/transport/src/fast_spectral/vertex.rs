//! One vertex of every path of the pool: its flight, the lights it sees from there, its turn.
//!
//! The loops over the paths of the pool hold nothing but arithmetic, which the compiler turns into vector code: each with few
//! arrays, none of them written under a condition, and long enough not to be unrolled.
//! The flight of the path's own channel ends where μt t = −ln u; all channels' densities follow it,
//!
//!   p_c ← p_c exp(−μ_c t) · μ_c at a collision,    p_c ← p_c f_c(ω,ω′) at a turn,
//!
//! and are divided by their sum, so that nothing underflows: what the path's own channel was likely to do has a density that
//! f32 can hold.

#![allow(clippy::needless_range_loop, reason = "all loops over lanes look alike, whatever arrays they touch")]

use tyndall_lanes::Random;

use super::connect::connect;
use super::pool::{Group, Lanes, PARTS, POOL};
use super::scene::{CHANNELS, FastSpectralScene};
use super::turn::turn;
use super::way_out::way_out;
use crate::slots::Slots;

/// Share of its light below which a path plays roulette; survivors get twice this.
const ROULETTE_WEIGHT: f32 = 0.25;

/// Turns of a path after which it may end whatever it carries, and the probability that it does not: see
/// [`roulette`](crate::roulette).
const LONG_PATH: u32 = 1 << 14;
const LONG_PATH_SURVIVAL: f32 = 0.99;

/// Takes every path through its next vertex; those that have ended there are listed in `ended`.
#[inline(always)]
pub(super) fn pass_all(scene: &FastSpectralScene, lanes: &mut Lanes, ended: &mut List) {
    let draws = Draws::new(&mut lanes.random, scene.lights.len() > 1);
    let collides = fly(scene, lanes, &draws.flight);

    // What the path finds: even light where it leaves, the lights seen from where it stays.
    let mut found = [[0.0; POOL]; CHANNELS];
    for c in 0..CHANNELS {
        for l in 0..POOL {
            let escaped = lanes.weight[c][l] * lanes.density[c][l] * scene.even[c];
            found[c][l] = if collides[l] != 0 { 0.0 } else { escaped };
        }
    }
    let survives = survive(scene, lanes, &draws.roulette);
    let mut goes_on = [0_u32; POOL];
    for l in 0..POOL {
        goes_on[l] = collides[l] & survives[l];
    }
    if !scene.lights.is_empty() {
        let direct = connect(scene, &lanes.position, &lanes.direction, &lanes.density, &draws.light);
        for c in 0..CHANNELS {
            let mut seen = [0.0; POOL];
            for l in 0..POOL {
                let light = lanes.weight[c][l] * direct[c][l];
                seen[l] = if goes_on[l] != 0 { light } else { 0.0 };
            }
            for l in 0..POOL {
                found[c][l] += seen[l];
            }
        }
    }
    let mut once = [0.0; POOL];
    for l in 0..POOL {
        lanes.scatterings[l] += collides[l];
        once[l] = if lanes.scatterings[l] < 2 { 1.0 } else { 0.0 };
    }
    for c in 0..CHANNELS {
        for l in 0..POOL {
            lanes.single[c][l] += found[c][l] * once[l];
        }
        for l in 0..POOL {
            lanes.multiple[c][l] += found[c][l] * (1.0 - once[l]);
        }
    }

    turn(scene, &mut lanes.direction, &mut lanes.density, &lanes.g, &draws.turn);

    ended.clear();
    for l in 0..POOL {
        ended.push_if(l, (lanes.active[l] != 0) & (goes_on[l] == 0));
    }
}

/// Takes every path to its next collision, or to where it leaves; 1 for those that collide.
#[inline(always)]
fn fly(scene: &FastSpectralScene, lanes: &mut Lanes, u: &Group) -> [u32; POOL] {
    let leave = way_out(scene, &lanes.position, &lanes.direction);
    let mut length = [0.0; POOL];
    let mut collides = [0_u32; POOL];
    for l in 0..POOL {
        let floor = lanes.floor[l];
        let flight = -tyndall_lanes::ln(floor + u[l] * lanes.span[l]) * lanes.free_path[l];
        let stays = (flight < leave[l]) | (lanes.scatterings[l] == 0);
        length[l] = if flight < leave[l] { flight } else { leave[l] };
        collides[l] = u32::from(stays);
    }
    (lanes.floor, lanes.span) = ([0.0; POOL], [1.0; POOL]);
    let greatest = scene.mu_t.iter().fold(f32::MIN_POSITIVE, |a, &b| a.max(b));
    for c in 0..CHANNELS {
        let (mu_t, ratio) = (scene.mu_t[c], scene.mu_t[c] / greatest);
        let transmitted = transmittance(mu_t, &length);
        let mut factor = [0.0; POOL];
        for l in 0..POOL {
            factor[l] = transmitted[l] * if collides[l] != 0 { ratio } else { 1.0 };
        }
        for l in 0..POOL {
            lanes.density[c][l] *= factor[l];
        }
    }
    normalise(&mut lanes.density);
    for axis in 0..3 {
        for l in 0..POOL {
            lanes.position[axis][l] += lanes.direction[axis][l] * length[l];
        }
    }
    for l in 0..POOL {
        let first = lanes.first[l];
        lanes.first[l] = if lanes.scatterings[l] == 0 { length[l] } else { first };
    }
    collides
}

/// The albedo's share of every path's weight, and roulette; 1 for paths that may turn, if they have collided.
#[inline(always)]
fn survive(scene: &FastSpectralScene, lanes: &mut Lanes, u: &Group) -> [u32; POOL] {
    let mut strength = [0.0; POOL];
    for c in 0..CHANNELS {
        for l in 0..POOL {
            lanes.weight[c][l] *= scene.albedo[c];
        }
        let mut light = [0.0; POOL];
        for l in 0..POOL {
            light[l] = lanes.weight[c][l] * lanes.density[c][l];
        }
        strength = greater(&strength, &light);
    }
    let mut probability = [0.0; POOL];
    for l in 0..POOL {
        let by_strength = strength[l] * (0.5 * PARTS as f32 / ROULETTE_WEIGHT);
        // Survivors get twice the least that lives on for certain, and so the probability leaps from 1/2 to 1 there.
        let by_strength = if by_strength < 0.5 { by_strength } else { 1.0 };
        let at_most = if lanes.scatterings[l] < LONG_PATH { 1.0 } else { LONG_PATH_SURVIVAL };
        probability[l] = if by_strength < at_most { by_strength } else { at_most };
    }
    let mut survives = [0_u32; POOL];
    for l in 0..POOL {
        let is_lucky = u32::from(u[l] < probability[l]);
        let may_turn = u32::from(lanes.scatterings[l] < scene.max_depth);
        survives[l] = is_lucky & may_turn;
    }
    let mut reward = [0.0; POOL];
    for l in 0..POOL {
        reward[l] = 1.0 / if probability[l] > 0.0 { probability[l] } else { 1.0 };
    }
    for c in 0..CHANNELS {
        for l in 0..POOL {
            lanes.weight[c][l] *= reward[l];
        }
    }
    survives
}

#[inline(always)]
fn greater(a: &Group, b: &Group) -> Group {
    let mut greater = [0.0; POOL];
    for l in 0..POOL {
        greater[l] = if a[l] > b[l] { a[l] } else { b[l] };
    }
    greater
}

/// exp(−μt t).
#[inline(always)]
pub(super) fn transmittance(mu_t: f32, length: &Group) -> Group {
    let mut transmittance = [0.0; POOL];
    for l in 0..POOL {
        transmittance[l] = tyndall_lanes::exp(-mu_t * length[l]);
    }
    transmittance
}

/// Divides the densities by their sum.
#[inline(always)]
pub(super) fn normalise(density: &mut [Group; CHANNELS]) {
    // Not 0, so that places without a path divide by something.
    let mut sum = [1e-37; POOL];
    for c in 0..CHANNELS {
        for l in 0..POOL {
            sum[l] += density[c][l];
        }
    }
    let mut scale = [0.0; POOL];
    for l in 0..POOL {
        scale[l] = 1.0 / sum[l];
    }
    for c in 0..CHANNELS {
        for l in 0..POOL {
            density[c][l] *= scale[l];
        }
    }
}

/// The uniform numbers of a vertex.
struct Draws {
    /// In (0, 1], multiples of 2^-31.
    flight: Group,
    roulette: Group,
    turn: [Group; 2],
    /// 0 if there is nothing to choose.
    light: Group,
}

impl Draws {
    #[inline(always)]
    fn new(random: &mut [Random; POOL], chooses_light: bool) -> Draws {
        let zero = [0.0; POOL];
        let mut draws = Draws { flight: zero, roulette: zero, turn: [zero; 2], light: zero };
        const STEP: f32 = 1.0 / (1_u32 << 24) as f32;
        let (mut first, mut second) = ([0_u64; POOL], [0_u64; POOL]);
        for l in 0..POOL {
            first[l] = random[l].bits();
            second[l] = random[l].bits();
        }
        for l in 0..POOL {
            draws.flight[l] = ((first[l] & 0x7fff_ffff) as i32 as f32 + 1.0) * (1.0 / (1_u32 << 31) as f32);
            draws.roulette[l] = (first[l] >> 40) as i32 as f32 * STEP;
            draws.turn[0][l] = (second[l] >> 40) as i32 as f32 * STEP;
            draws.turn[1][l] = ((second[l] >> 8) & 0xff_ffff) as i32 as f32 * STEP;
        }
        if chooses_light {
            for l in 0..POOL {
                draws.light[l] = (random[l].bits() >> 40) as i32 as f32 * STEP;
            }
        }
        draws
    }
}

/// Paths of the pool.
pub(super) type List = Slots<{ POOL + 1 }>;
