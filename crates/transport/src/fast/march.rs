//! The march: every ray of the pool one cell further, or to its next tentative collision.
//!
//! The arithmetic runs in loops over [`WIDTH`] rays that hold nothing but arithmetic, which the compiler turns into
//! vector code; between them stand the loads, which do not depend on each other and so overlap. Distance sampling
//! is delta tracking and shadow rays are ratio tracking (see `distance` and `transmittance` for the sources), both
//! under the majorants of the grid's cells. At a tentative collision one voxel, drawn with its trilinear weight,
//! stands for the interpolated value: the law of delta tracking is the same, and the mean of ratio tracking too,
//! since each factor is linear in the value and drawn independently.

use super::pool::{POOL, Rays};
use super::volume::{FastGrid, FastVolume, Kind};
use crate::slots::Slots;
use glam::Vec3;

/// Rays in a group of vector arithmetic: two AVX2 registers of f32.
const WIDTH: usize = 16;

/// Weight below which a shadow ray plays roulette; survivors get this weight.
const ROULETTE_WEIGHT: f32 = 0.2;

/// How far, in voxels, a point is carried into the next cell along each axis: well above f32's resolution at the
/// grid's far corner `max`. Inside that sliver the next cell's majorant is used for the last cell's values, which
/// differ by the slope of the field over so short a way. Carried along the ray instead, one that runs nearly in the
/// plane of a face would not get across it and crawl.
pub(super) fn nudge(max: glam::Vec3) -> f32 {
    (max.max_element() * (1.0 / (1 << 20) as f32)).max(1.0 / 4096.0)
}

/// Takes every ray a step. Rays that reached a tentative collision are appended to `tentative`, those that reached
/// the end of their volume to `left`.
#[inline(always)]
pub(super) fn step(rays: &mut Rays, volumes: &[FastVolume], tentative: &mut List, left: &mut List) {
    tentative.clear();
    left.clear();
    for base in (0..POOL).step_by(WIDTH) {
        // While a pool runs empty there are few rays left in it.
        if is_any_under_way(&group(&rays.end, base)) {
            step_group(rays, base, volumes, tentative, left);
        }
    }
}

/// Whether any of these ends belongs to a ray.
#[inline(always)]
fn is_any_under_way(ends: &[f32; WIDTH]) -> bool {
    let mut is_any = false;
    for &end in ends {
        is_any |= end > 0.0;
    }
    is_any
}

/// Rays of the pool.
pub(super) type List = Slots<{ POOL + 1 }>;

#[inline(always)]
fn group(values: &[f32; POOL], base: usize) -> [f32; WIDTH] {
    let mut lanes = [0.0; WIDTH];
    lanes.copy_from_slice(&values[base..base + WIDTH]);
    lanes
}

#[inline(always)]
fn smaller(a: f32, b: f32) -> f32 {
    if a < b { a } else { b }
}

#[inline(always)]
fn step_group(rays: &mut Rays, base: usize, volumes: &[FastVolume], tentative: &mut List, left: &mut List) {
    let t = group(&rays.t, base);
    let nudge = group(&rays.nudge, base);
    let end = group(&rays.end, base);
    let (ox, oy, oz) = (group(&rays.ox, base), group(&rays.oy, base), group(&rays.oz, base));
    let (dx, dy, dz) = (group(&rays.dx, base), group(&rays.dy, base), group(&rays.dz, base));

    let (mut x, mut y, mut z) = ([0_i32; WIDTH], [0_i32; WIDTH], [0_i32; WIDTH]);
    let (ax, ay, az) = (group(&rays.ax, base), group(&rays.ay, base), group(&rays.az, base));
    for l in 0..WIDTH {
        x[l] = (ax[l] + t[l] * dx[l]) as i32;
        y[l] = (ay[l] + t[l] * dy[l]) as i32;
        z[l] = (az[l] + t[l] * dz[l]) as i32;
    }

    let (mut cx, mut cy, mut cz) = ([0.0_f32; WIDTH], [0.0_f32; WIDTH], [0.0_f32; WIDTH]);
    let (mut edge, mut max) = ([0.0_f32; WIDTH], [0.0_f32; WIDTH]);
    for l in 0..WIDTH {
        if let Kind::Grid(FastGrid { grid, .. }) = &volumes[rays.volume[base + l] as usize].kind {
            let cell = grid.cell([x[l] as u32, y[l] as u32, z[l] as u32]);
            cx[l] = cell.corner[0] as f32;
            cy[l] = cell.corner[1] as f32;
            cz[l] = cell.corner[2] as f32;
            edge[l] = (1_u32 << cell.shift) as f32;
            max[l] = cell.max;
        }
    }

    let (ix, iy, iz) = (group(&rays.ix, base), group(&rays.iy, base), group(&rays.iz, base));
    let tau = group(&rays.tau, base);
    let rate = group(&rays.rate, base);
    let mut next_t = [0.0_f32; WIDTH];
    let mut next_tau = [0.0_f32; WIDTH];
    let mut majorant = [0.0_f32; WIDTH];
    let mut collides = [0_u32; WIDTH];
    let mut leaves = [0_u32; WIDTH];
    for l in 0..WIDTH {
        let far_x = cx[l] + if dx[l] > 0.0 { edge[l] } else { 0.0 };
        let far_y = cy[l] + if dy[l] > 0.0 { edge[l] } else { 0.0 };
        let far_z = cz[l] + if dz[l] > 0.0 { edge[l] } else { 0.0 };
        let exit_x = (far_x - ox[l]) * ix[l];
        let exit_y = (far_y - oy[l]) * iy[l];
        let exit_z = (far_z - oz[l]) * iz[l];
        let exit = smaller(smaller(exit_x, exit_y), exit_z);
        let least = t[l] + nudge[l];
        let exit = if exit > least { exit } else { least };
        let exit = smaller(exit, end[l]);
        let m = rate[l] * if max[l] > 0.0 { max[l] } else { 0.0 };
        let optical_thickness = m * (exit - t[l]);
        // Not `t < end`: a null collision may stand at the very end.
        let active = end[l] > 0.0;
        let hit = tau[l] < optical_thickness && active;
        let hit_t = smaller(t[l] + tau[l] / m, exit);
        next_t[l] = if hit { hit_t } else { exit };
        next_tau[l] = if hit { tau[l] } else { tau[l] - optical_thickness };
        majorant[l] = m;
        collides[l] = u32::from(hit);
        leaves[l] = u32::from(!hit && active && exit >= end[l]);
    }
    rays.t[base..base + WIDTH].copy_from_slice(&next_t);
    rays.tau[base..base + WIDTH].copy_from_slice(&next_tau);
    rays.majorant[base..base + WIDTH].copy_from_slice(&majorant);
    for l in 0..WIDTH {
        tentative.push_if(base + l, collides[l] != 0);
        left.push_if(base + l, leaves[l] != 0);
    }
}

/// Decides each tentative collision: real ones, and shadow rays that roulette has ended, are appended to `happened`.
#[inline(always)]
pub(super) fn collide(rays: &mut Rays, volumes: &[FastVolume], tentative: &List, happened: &mut List) {
    happened.clear();
    for &slot in tentative.slots() {
        let i = usize::from(slot) % POOL;
        let Kind::Grid(grid) = &volumes[rays.volume[i] as usize].kind else {
            continue;
        };
        let t = rays.t[i];
        let place =
            Vec3::new(rays.ox[i] + t * rays.dx[i], rays.oy[i] + t * rays.dy[i], rays.oz[i] + t * rays.dz[i]);
        let density = grid.tap(place, rays.random[i].f32x3());
        let null = 1.0 - rays.mu_t[i] * density / rays.majorant[i];
        let null = if null > 0.0 { null } else { 0.0 };

        let bits = rays.random[i].bits();
        let u = (bits >> 40) as f32 * (1.0 / (1_u32 << 24) as f32);
        let v = ((bits & 0xffff_ffff) + 1) as f32 * (1.0 / (1_u64 << 32) as f32);
        rays.tau[i] = -tyndall_lanes::ln(v);

        if rays.shadow[i] < 0.0 {
            rays.null[i] = [null, u];
            happened.push_if(i, true);
            continue;
        }
        let is_shadow = rays.shadow[i] > 0.0;
        let weight = rays.transmittance[i] * if is_shadow { null } else { 1.0 };
        let weak = weight < ROULETTE_WEIGHT;
        let survives = u * ROULETTE_WEIGHT < weight;
        rays.transmittance[i] = match (weak, survives) {
            (false, _) => weight,
            (true, true) => ROULETTE_WEIGHT,
            (true, false) => 0.0,
        };
        let ended = if is_shadow { weak && !survives } else { u >= null };
        happened.push_if(i, ended);
    }
}
