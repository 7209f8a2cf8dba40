//! The unit cube [0, 1]³, as the intersection of three slabs.
//!
//! The faces are numbered -x, +x, -y, +y, -z, +z. Texture coordinates of the faces across x are (y, z), of those across y
//! (z, x), of those across z (x, y).

use glam::DVec3;

use super::local::{LocalHit, LocalPoint, nearest_end};
use crate::Ray;

pub(super) fn intersect(ray: &Ray, end: f64) -> Option<LocalHit> {
    let (mut enter, mut leave) = ((f64::NEG_INFINITY, 0), (f64::INFINITY, 0));
    for axis in 0..3 {
        let (origin, direction) = (ray.origin[axis], ray.direction[axis]);
        if direction == 0.0 {
            if !(0.0..=1.0).contains(&origin) {
                return None;
            }
            continue;
        }
        let face = 2 * axis as u32;
        let (low, high) = ((-origin / direction, face), ((1.0 - origin) / direction, face + 1));
        let (first, last) = if direction > 0.0 { (low, high) } else { (high, low) };
        if first.0 > enter.0 {
            enter = first;
        }
        if last.0 < leave.0 {
            leave = last;
        }
    }
    nearest_end(enter, leave, end)
}

/// The place where a ray is at `t`, on a face, at least `margin` from its edges.
pub(super) fn point(ray: &Ray, t: f64, face: u32, margin: f64) -> LocalPoint {
    let axis = face as usize / 2;
    let is_high = face % 2 == 1;
    let margin = margin.min(0.25);
    let mut position = ray.at(t).clamp(DVec3::splat(margin), DVec3::splat(1.0 - margin));
    position[axis] = f64::from(u8::from(is_high));
    let mut normal = DVec3::ZERO;
    normal[axis] = if is_high { 1.0 } else { -1.0 };
    let (first, second) = ((axis + 1) % 3, (axis + 2) % 3);
    let tangent = DVec3::AXES[first];
    LocalPoint { position, normal, shading_normal: None, tangent, uv: [position[first], position[second]] }
}
