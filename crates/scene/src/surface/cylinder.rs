//! The cylinder x² + y² = 1 for z from 0 to 1, open, or closed by discs.
//!
//! Primitives: 0 is the mantle, 1 the disc at z = 0, 2 that at z = 1. Texture coordinates of the mantle: u is the angle from
//! +x towards +y, in turns, v is z; of the discs as those of a disc.

use glam::DVec3;

use super::local::{LocalHit, LocalPoint, nearest_end, turn};
use super::sphere::chord;
use crate::Ray;

/// Where a ray meets the mantle of the cylinder without ends; from -∞ to ∞ for one along it inside.
fn mantle(ray: &Ray) -> Option<[f64; 2]> {
    let (origin, direction) = (ray.origin.truncate(), ray.direction.truncate());
    let (a, b) = (direction.length_squared(), origin.dot(direction));
    let c = origin.length_squared() - 1.0;
    if a == 0.0 {
        return (c < 0.0).then_some([f64::NEG_INFINITY, f64::INFINITY]);
    }
    chord(a, b, c, (origin - direction * (b / a)).length_squared())
}

pub(super) fn intersect_open(ray: &Ray, end: f64) -> Option<LocalHit> {
    let [enter, leave] = mantle(ray)?;
    [(enter, true), (leave, false)]
        .into_iter()
        .find(|(t, _)| *t > 0.0 && *t < end && (0.0..=1.0).contains(&(ray.origin.z + ray.direction.z * t)))
        .map(|(t, enters)| LocalHit::new(t, 0, enters))
}

pub(super) fn intersect_capped(ray: &Ray, end: f64) -> Option<LocalHit> {
    let [enter, leave] = mantle(ray)?;
    let (mut enter, mut leave) = ((enter, 0), (leave, 0));
    let (origin, direction) = (ray.origin.z, ray.direction.z);
    if direction == 0.0 {
        if !(0.0..=1.0).contains(&origin) {
            return None;
        }
    } else {
        let (low, high) = ((-origin / direction, 1), ((1.0 - origin) / direction, 2));
        let (first, last) = if direction > 0.0 { (low, high) } else { (high, low) };
        enter = if first.0 > enter.0 { first } else { enter };
        leave = if last.0 < leave.0 { last } else { leave };
    }
    nearest_end(enter, leave, end)
}

/// The place where a ray is at `t`, on a primitive, at least `margin` from the edge between mantle and disc.
pub(super) fn point(ray: &Ray, t: f64, primitive: u32, margin: f64) -> LocalPoint {
    let place = ray.at(t);
    let margin = margin.min(0.25);
    let across = place.truncate();
    let u = turn(across.x, across.y);
    let around = if across.length_squared() > 0.0 { DVec3::new(-across.y, across.x, 0.0) } else { DVec3::X };
    if primitive == 0 {
        let normal = across.normalize_or(glam::DVec2::X).extend(0.0);
        let z = place.z.clamp(margin, 1.0 - margin);
        let position = normal + DVec3::Z * z;
        return LocalPoint { position, normal, shading_normal: None, tangent: around, uv: [u, place.z] };
    }
    let is_top = primitive == 2;
    let across = across.clamp_length_max(1.0 - margin);
    LocalPoint {
        position: across.extend(f64::from(u8::from(is_top))),
        normal: if is_top { DVec3::Z } else { DVec3::NEG_Z },
        shading_normal: None,
        tangent: around,
        uv: [u, 1.0 - across.length()],
    }
}
