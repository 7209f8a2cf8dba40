//! One vertex of every path of the pool: its flight, the lights it sees from there, its turn.
//!
//! The loops over the [`WIDTH`] paths of a group hold nothing but arithmetic, which the compiler turns into vector code.
//! The flight of the path's own channel ends where μt t = −ln u; all channels' densities follow it,
//!
//!   p_c ← p_c exp(−μ_c t) · μ_c at a collision,    p_c ← p_c f_c(ω,ω′) at a turn,
//!
//! and are divided by their sum, so that nothing underflows: what the path's own channel was likely to do has a density that
//! f32 can hold.

#![allow(clippy::needless_range_loop, reason = "all loops over lanes look alike, whatever arrays they touch")]

use super::pool::{Lanes, POOL};
use super::scene::{Boundary, CHANNELS, FastSpectralScene, Phases};

/// Paths in a group of vector arithmetic: two AVX2 registers of f32.
const WIDTH: usize = 128;

/// Share of its light below which a path plays roulette; survivors get twice this.
const ROULETTE_WEIGHT: f32 = 0.25;

/// Turns of a path after which it may end whatever it carries, and the probability that it does not: see
/// [`roulette`](crate::roulette).
const LONG_PATH: u32 = 1 << 14;
const LONG_PATH_SURVIVAL: f32 = 0.99;

/// Farther than any flight, and still a number when it is multiplied by a coefficient.
const FAR: f32 = 1e30;

type Group = [f32; WIDTH];

/// Takes every path through its next vertex; those that have ended there are listed in `ended`.
#[inline(always)]
pub(super) fn pass_all(scene: &FastSpectralScene, lanes: &mut Lanes, ended: &mut List) {
    ended.length = 0;
    for base in (0..POOL).step_by(WIDTH) {
        pass(scene, lanes, base, ended);
    }
}

/// Indices of paths, appended without branches.
pub(super) struct List {
    slots: [u16; POOL + 1],
    length: usize,
}

impl List {
    pub fn new() -> List {
        List { slots: [0; POOL + 1], length: 0 }
    }

    #[inline(always)]
    fn push_if(&mut self, slot: usize, condition: bool) {
        self.slots[self.length.min(POOL)] = slot as u16;
        self.length += usize::from(condition);
    }

    pub fn slots(&self) -> &[u16] {
        &self.slots[..self.length.min(POOL)]
    }
}

#[inline(always)]
fn pass(scene: &FastSpectralScene, lanes: &mut Lanes, base: usize, ended: &mut List) {
    let draws = Draws::new(lanes, base, scene.lights.len() > 1);
    let mut position = group3(&lanes.position, base);
    let mut direction = group3(&lanes.direction, base);
    let mut density = group3(&lanes.density, base);
    let mut weight = group3(&lanes.weight, base);
    let free_path = group(&lanes.free_path, base);
    let floor = group(&lanes.floor, base);
    let mut scatterings = [0_u32; WIDTH];
    let mut active = [0_u32; WIDTH];
    scatterings.copy_from_slice(&lanes.scatterings[base..base + WIDTH]);
    active.copy_from_slice(&lanes.active[base..base + WIDTH]);

    // The flight.
    let leave = way_out(scene, &position, &direction);
    let mut length = [0.0; WIDTH];
    let mut collides = [0_u32; WIDTH];
    for l in 0..WIDTH {
        let flight = -tyndall_lanes::ln(floor[l] + draws.flight[l] * (1.0 - floor[l])) * free_path[l];
        let stays = (flight < leave[l]) | (floor[l] > 0.0);
        length[l] = if flight < leave[l] { flight } else { leave[l] };
        collides[l] = u32::from(stays);
    }
    let greatest = scene.mu_t.iter().fold(f32::MIN_POSITIVE, |a, &b| a.max(b));
    for c in 0..CHANNELS {
        let (mu_t, ratio) = (scene.mu_t[c], scene.mu_t[c] / greatest);
        let transmitted = transmittance(mu_t, &length);
        let mut factor = [0.0; WIDTH];
        for l in 0..WIDTH {
            factor[l] = transmitted[l] * if collides[l] != 0 { ratio } else { 1.0 };
        }
        for l in 0..WIDTH {
            density[c][l] *= factor[l];
        }
    }
    let sum = sum_of_channels(&density);
    normalise(&mut density, &sum);
    for axis in 0..3 {
        for l in 0..WIDTH {
            position[axis][l] += direction[axis][l] * length[l];
        }
    }
    for l in 0..WIDTH {
        let first = lanes.first[base + l];
        lanes.first[base + l] = if scatterings[l] == 0 { length[l] } else { first };
    }

    // What the path finds: even light where it leaves, the lights seen from where it stays.
    let mut found = [[0.0; WIDTH]; CHANNELS];
    for c in 0..CHANNELS {
        for l in 0..WIDTH {
            let escaped = weight[c][l] * density[c][l] * scene.even[c];
            found[c][l] = if collides[l] != 0 { 0.0 } else { escaped };
        }
    }
    for c in 0..CHANNELS {
        for l in 0..WIDTH {
            weight[c][l] *= scene.albedo[c];
        }
    }
    let mut strength = [0.0; WIDTH];
    for c in 0..CHANNELS {
        let mut light = [0.0; WIDTH];
        for l in 0..WIDTH {
            light[l] = weight[c][l] * density[c][l];
        }
        strength = greater(&strength, &light);
    }
    let mut probability = [0.0; WIDTH];
    for l in 0..WIDTH {
        let by_strength = strength[l] * (0.5 * CHANNELS as f32 / ROULETTE_WEIGHT);
        // Survivors get twice the least that lives on for certain, and so the probability leaps from 1/2 to 1 there.
        let by_strength = if by_strength < 0.5 { by_strength } else { 1.0 };
        let at_most = if scatterings[l] < LONG_PATH { 1.0 } else { LONG_PATH_SURVIVAL };
        probability[l] = if by_strength < at_most { by_strength } else { at_most };
    }
    let mut goes_on = [0_u32; WIDTH];
    for l in 0..WIDTH {
        let survives = if draws.roulette[l] < probability[l] { 1 } else { 0 };
        let may_turn = if scatterings[l] < scene.max_depth { 1 } else { 0 };
        goes_on[l] = collides[l] & survives & may_turn;
    }
    let mut reward = [0.0; WIDTH];
    for l in 0..WIDTH {
        reward[l] = 1.0 / if probability[l] > 0.0 { probability[l] } else { 1.0 };
    }
    for c in 0..CHANNELS {
        for l in 0..WIDTH {
            weight[c][l] *= reward[l];
        }
    }
    if !scene.lights.is_empty() {
        let direct = connect(scene, &position, &direction, &density, &draws.light);
        for c in 0..CHANNELS {
            for l in 0..WIDTH {
                found[c][l] += if goes_on[l] != 0 { weight[c][l] * direct[c][l] } else { 0.0 };
            }
        }
    }
    let mut once = [0.0; WIDTH];
    for l in 0..WIDTH {
        scatterings[l] += collides[l];
        once[l] = if scatterings[l] < 2 { 1.0 } else { 0.0 };
    }
    for c in 0..CHANNELS {
        for l in 0..WIDTH {
            lanes.single[c][base + l] += found[c][l] * once[l];
        }
        for l in 0..WIDTH {
            lanes.multiple[c][base + l] += found[c][l] * (1.0 - once[l]);
        }
    }

    turn(scene, &mut direction, &mut density, &group(&lanes.g, base), &draws);

    store3(&mut lanes.position, base, &position);
    store3(&mut lanes.direction, base, &direction);
    store3(&mut lanes.density, base, &density);
    store3(&mut lanes.weight, base, &weight);
    lanes.floor[base..base + WIDTH].copy_from_slice(&[0.0; WIDTH]);
    lanes.scatterings[base..base + WIDTH].copy_from_slice(&scatterings);
    for l in 0..WIDTH {
        ended.push_if(base + l, (active[l] != 0) & (goes_on[l] == 0));
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
    fn new(lanes: &mut Lanes, base: usize, chooses_light: bool) -> Draws {
        let zero = [0.0; WIDTH];
        let mut draws = Draws { flight: zero, roulette: zero, turn: [zero; 2], light: zero };
        const STEP: f32 = 1.0 / (1_u32 << 24) as f32;
        let random = &mut lanes.random[base..base + WIDTH];
        let (mut first, mut second) = ([0_u64; WIDTH], [0_u64; WIDTH]);
        for l in 0..WIDTH {
            first[l] = random[l].bits();
            second[l] = random[l].bits();
        }
        for l in 0..WIDTH {
            draws.flight[l] = ((first[l] & 0x7fff_ffff) as i32 as f32 + 1.0) * (1.0 / (1_u32 << 31) as f32);
            draws.roulette[l] = (first[l] >> 40) as i32 as f32 * STEP;
            draws.turn[0][l] = (second[l] >> 40) as i32 as f32 * STEP;
            draws.turn[1][l] = ((second[l] >> 8) & 0xff_ffff) as i32 as f32 * STEP;
        }
        if chooses_light {
            for l in 0..WIDTH {
                draws.light[l] = (random[l].bits() >> 40) as i32 as f32 * STEP;
            }
        }
        draws
    }
}

/// The distance to where a ray from inside leaves the medium, at most [`FAR`].
#[inline(always)]
fn way_out(scene: &FastSpectralScene, position: &[Group; 3], direction: &[Group; 3]) -> Group {
    let (mut origin, mut along) = ([[0.0; WIDTH]; 3], [[0.0; WIDTH]; 3]);
    for axis in 0..3 {
        let [x, y, z] = scene.columns.map(|column| column[axis]);
        let centre = scene.local_centre[axis];
        for l in 0..WIDTH {
            origin[axis][l] = x * position[0][l] + y * position[1][l] + z * position[2][l] + centre;
            along[axis][l] = x * direction[0][l] + y * direction[1][l] + z * direction[2][l];
        }
    }
    let mut leave = [FAR; WIDTH];
    match scene.boundary {
        // The farther root of |o + t d|² = 1; what matters of it is its absolute precision.
        Boundary::Sphere => {
            for l in 0..WIDTH {
                let [ox, oy, oz] = [origin[0][l], origin[1][l], origin[2][l]];
                let [dx, dy, dz] = [along[0][l], along[1][l], along[2][l]];
                let scale = 1.0 / (dx * dx + dy * dy + dz * dz);
                let nearest = -(ox * dx + oy * dy + oz * dz) * scale;
                let (nx, ny, nz) = (ox + nearest * dx, oy + nearest * dy, oz + nearest * dz);
                let rest = (1.0 - (nx * nx + ny * ny + nz * nz)) * scale;
                let half = (if rest > 0.0 { rest } else { 0.0 }).sqrt();
                let t = nearest + half;
                leave[l] = if t > 0.0 { t } else { 0.0 };
            }
        }
        Boundary::Box { min, max } => {
            for axis in 0..3 {
                let (min, max) = (min[axis], max[axis]);
                for l in 0..WIDTH {
                    let d = along[axis][l];
                    let far = if d > 0.0 { max } else { min };
                    let t = (far - origin[axis][l]) / if d.abs() > 1e-12 { d } else { 1e-12_f32.copysign(d) };
                    leave[l] = if t < leave[l] { t } else { leave[l] };
                }
            }
            for l in 0..WIDTH {
                leave[l] = if leave[l] > 0.0 { leave[l] } else { 0.0 };
            }
        }
    }
    leave
}

/// Next-event estimation: p_λ/Σp f_λ T_λ E_λ of a light.
#[inline(always)]
fn connect(
    scene: &FastSpectralScene,
    position: &[Group; 3],
    direction: &[Group; 3],
    density: &[Group; CHANNELS],
    choice: &Group,
) -> [Group; CHANNELS] {
    let first = scene.lights[0];
    let (mut toward, mut is_point) = (first.toward.map(|x| [x; WIDTH]), [first.is_point; WIDTH]);
    let mut bright = first.brightness.map(|x| [x; WIDTH]);
    for (before, light) in scene.lights.iter().zip(&scene.lights[1..]) {
        for l in 0..WIDTH {
            let chosen = choice[l] >= before.cumulative;
            is_point[l] = if chosen { light.is_point } else { is_point[l] };
            for axis in 0..3 {
                toward[axis][l] = if chosen { light.toward[axis] } else { toward[axis][l] };
            }
            for c in 0..CHANNELS {
                bright[c][l] = if chosen { light.brightness[c] } else { bright[c][l] };
            }
        }
    }
    let (mut distance, mut falloff, mut cosine) = ([0.0; WIDTH], [0.0; WIDTH], [0.0; WIDTH]);
    for l in 0..WIDTH {
        let x = toward[0][l] - is_point[l] * position[0][l];
        let y = toward[1][l] - is_point[l] * position[1][l];
        let z = toward[2][l] - is_point[l] * position[2][l];
        let square = x * x + y * y + z * z;
        let inverse_square = if square > 1e-30 { 1.0 / square } else { 0.0 };
        let inverse = inverse_square.sqrt();
        (toward[0][l], toward[1][l], toward[2][l]) = (x * inverse, y * inverse, z * inverse);
        distance[l] = if is_point[l] > 0.0 { square * inverse } else { FAR };
        falloff[l] = if is_point[l] > 0.0 { inverse_square } else { 1.0 };
        cosine[l] = (direction[0][l] * x + direction[1][l] * y + direction[2][l] * z) * inverse;
    }
    let leave = way_out(scene, position, &toward);
    let mut length = [0.0; WIDTH];
    for l in 0..WIDTH {
        length[l] = if distance[l] < leave[l] { distance[l] } else { leave[l] };
    }
    let mut phase = phase_values(scene.g(0), &cosine);
    let mut direct = [[0.0; WIDTH]; CHANNELS];
    for c in 0..CHANNELS {
        if let (Phases::Each(g), 1..) = (scene.phases, c) {
            phase = phase_values(g[c], &cosine);
        }
        let transmitted = transmittance(scene.mu_t[c], &length);
        for l in 0..WIDTH {
            let arriving = transmitted[l] * bright[c][l] * falloff[l];
            direct[c][l] = density[c][l] * phase[l] * arriving;
        }
    }
    direct
}

#[inline(always)]
fn greater(a: &Group, b: &Group) -> Group {
    let mut greater = [0.0; WIDTH];
    for l in 0..WIDTH {
        greater[l] = if a[l] > b[l] { a[l] } else { b[l] };
    }
    greater
}

#[inline(always)]
fn transmittance(mu_t: f32, length: &Group) -> Group {
    let mut transmittance = [0.0; WIDTH];
    for l in 0..WIDTH {
        transmittance[l] = tyndall_lanes::exp(-mu_t * length[l]);
    }
    transmittance
}

/// Henyey and Greenstein's phase function, 1/sr. (1 − g)² + 2g(1 − cos) keeps its digits at the forward peak.
#[inline(always)]
fn phase_values(g: f32, cosine: &Group) -> Group {
    const INVERSE_SPHERE: f32 = 0.25 * std::f32::consts::FRAC_1_PI;
    let mut values = [0.0; WIDTH];
    for l in 0..WIDTH {
        let denominator = (1.0 - g) * (1.0 - g) + 2.0 * g * (1.0 - cosine[l]);
        values[l] = INVERSE_SPHERE * (1.0 - g * g) / (denominator * denominator.sqrt());
    }
    values
}

/// Draws new directions from the phase functions of the paths' own channels.
#[inline(always)]
fn turn(
    scene: &FastSpectralScene,
    direction: &mut [Group; 3],
    density: &mut [Group; CHANNELS],
    g: &Group,
    draws: &Draws,
) {
    let mut cosine = [0.0; WIDTH];
    for l in 0..WIDTH {
        let (g, u) = (g[l], draws.turn[0][l]);
        let is_isotropic = g == 0.0;
        let divisor = if is_isotropic { 1.0 } else { 2.0 * g };
        let ratio = (1.0 - g * g) / (1.0 - g + 2.0 * g * u);
        let peaked = (1.0 + g * g - ratio * ratio) / divisor;
        let cos = if is_isotropic { 2.0 * u - 1.0 } else { peaked };
        let cos = if cos < 1.0 { cos } else { 1.0 };
        cosine[l] = if cos > -1.0 { cos } else { -1.0 };
    }
    let (mut across, mut aside) = ([0.0; WIDTH], [0.0; WIDTH]);
    for l in 0..WIDTH {
        let sine = (1.0 - cosine[l] * cosine[l]).sqrt();
        let (sin_phi, cos_phi) = tyndall_lanes::sin_cos_turns(draws.turn[1][l]);
        (across[l], aside[l]) = (sine * cos_phi, sine * sin_phi);
    }
    for l in 0..WIDTH {
        let (across, aside, ahead) = (across[l], aside[l], cosine[l]);
        // Two vectors at right angles to the direction (Duff et al. 2017, "Building an orthonormal basis, revisited").
        let (x, y, z) = (direction[0][l], direction[1][l], direction[2][l]);
        let sign = 1.0_f32.copysign(z);
        let a = -1.0 / (sign + z);
        let b = x * y * a;
        let nx = across * (1.0 + sign * x * x * a) + aside * b + ahead * x;
        let ny = across * sign * b + aside * (sign + y * y * a) + ahead * y;
        let nz = across * -sign * x - aside * y + ahead * z;
        // One Newton step of the inverse square root about 1 keeps thousands of turns at unit length.
        let unit = 1.5 - 0.5 * (nx * nx + ny * ny + nz * nz);
        (direction[0][l], direction[1][l], direction[2][l]) = (nx * unit, ny * unit, nz * unit);
    }
    if let Phases::Each(g) = scene.phases {
        for c in 0..CHANNELS {
            let phase = phase_values(g[c], &cosine);
            for l in 0..WIDTH {
                density[c][l] *= phase[l];
            }
        }
        let sum = sum_of_channels(density);
        normalise(density, &sum);
    }
}

/// Never 0, so that places without a path divide by something.
#[inline(always)]
fn sum_of_channels(density: &[Group; CHANNELS]) -> Group {
    let mut sum = [1e-37; WIDTH];
    for channel in density {
        for l in 0..WIDTH {
            sum[l] += channel[l];
        }
    }
    sum
}

#[inline(always)]
fn normalise(density: &mut [Group; CHANNELS], sum: &Group) {
    let mut scale = [0.0; WIDTH];
    for l in 0..WIDTH {
        scale[l] = 1.0 / sum[l];
    }
    for channel in density {
        for l in 0..WIDTH {
            channel[l] *= scale[l];
        }
    }
}

#[inline(always)]
fn group(values: &[f32; POOL], base: usize) -> Group {
    let mut lanes = [0.0; WIDTH];
    lanes.copy_from_slice(&values[base..base + WIDTH]);
    lanes
}

#[inline(always)]
fn group3(values: &[[f32; POOL]; 3], base: usize) -> [Group; 3] {
    [group(&values[0], base), group(&values[1], base), group(&values[2], base)]
}

#[inline(always)]
fn store3(values: &mut [[f32; POOL]; 3], base: usize, groups: &[Group; 3]) {
    for (values, group) in values.iter_mut().zip(groups) {
        values[base..base + WIDTH].copy_from_slice(group);
    }
}
