//! Where rays from inside the medium leave it: the farther intersection with a sphere or a box.
//!
//! As they begin inside, or but for rounding there, only that one is looked for; what matters of it is its absolute
//! precision, as it is to be multiplied by a coefficient.

#![allow(clippy::needless_range_loop, reason = "all loops over lanes look alike, whatever arrays they touch")]

use super::pool::{Group, POOL};
use super::scene::{Boundary, FastSpectralScene};

/// Farther than any flight, and still a number when it is multiplied by a coefficient.
pub(super) const FAR: f32 = 1e30;

/// The distance to where a ray from inside leaves the medium, at most [`FAR`].
#[inline(always)]
pub(super) fn way_out(scene: &FastSpectralScene, position: &[Group; 3], direction: &[Group; 3]) -> Group {
    let (mut origin, mut along) = ([[0.0; POOL]; 3], [[0.0; POOL]; 3]);
    for axis in 0..3 {
        let [x, y, z] = scene.columns.map(|column| column[axis]);
        let centre = scene.local_centre[axis];
        for l in 0..POOL {
            origin[axis][l] = x * position[0][l] + y * position[1][l] + z * position[2][l] + centre;
            along[axis][l] = x * direction[0][l] + y * direction[1][l] + z * direction[2][l];
        }
    }
    let mut leave = [FAR; POOL];
    match scene.boundary {
        // The farther root of |o + t d|² = 1.
        Boundary::Sphere => {
            for l in 0..POOL {
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
                for l in 0..POOL {
                    let d = along[axis][l];
                    let far = if d > 0.0 { max } else { min };
                    let t = (far - origin[axis][l]) / if d.abs() > 1e-12 { d } else { 1e-12_f32.copysign(d) };
                    leave[l] = if t < leave[l] { t } else { leave[l] };
                }
            }
            for l in 0..POOL {
                leave[l] = if leave[l] > 0.0 { leave[l] } else { 0.0 };
            }
        }
    }
    leave
}
