//! The unit sphere about the origin: |x|² = 1.
//!
//! The roots of the quadratic are taken so that neither the distance from afar nor that of a near root cancels (Haines,
//! Günther & Akenine-Möller 2019, "Precision improvements for ray/sphere intersection"). Texture coordinates: u is the
//! angle about z from +x towards +y, in turns; v runs from 0 at -z to 1 at +z in equal angles.

use std::f64::consts::PI;

use glam::DVec3;

use super::local::{LocalHit, LocalPoint, nearest_end, turn};
use crate::Ray;

pub(super) fn intersect(ray: &Ray, end: f64) -> Option<LocalHit> {
    let (a, b) = (ray.direction.length_squared(), ray.origin.dot(ray.direction));
    let closest = ray.origin - ray.direction * (b / a);
    let [enter, leave] = chord(a, b, ray.origin.length_squared() - 1.0, closest.length_squared())?;
    nearest_end((enter, 0), (leave, 0), end)
}

/// The place where a ray is at `t`.
pub(super) fn point(ray: &Ray, t: f64) -> LocalPoint {
    let position = ray.at(t).normalize_or(DVec3::Z);
    let [x, y, z] = position.to_array();
    let tangent = if x == 0.0 && y == 0.0 { DVec3::X } else { DVec3::new(-y, x, 0.0) };
    let uv = [turn(x, y), 1.0 - libm::acos(z.clamp(-1.0, 1.0)) / PI];
    LocalPoint { position, normal: position, shading_normal: None, tangent, uv }
}

/// The two roots of a t² + 2 b t + c = 0, where `closest` is the least square of the distance from the centre of a circle or
/// sphere of radius 1 and c the square at t = 0, less 1.
pub(super) fn chord(a: f64, b: f64, c: f64, closest: f64) -> Option<[f64; 2]> {
    let rest = 1.0 - closest;
    if rest.is_nan() || rest <= 0.0 {
        return None;
    }
    let q = -(b + (a * rest).sqrt().copysign(b));
    let (first, second) = (q / a, c / q);
    Some([first.min(second), first.max(second)])
}
