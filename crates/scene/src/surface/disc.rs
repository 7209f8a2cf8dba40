//! The disc, or ring, of radius 1 about the origin in the plane z = 0, its outer side towards +z.
//!
//! Texture coordinates: u is the angle from +x towards +y, in turns; v is 0 at the rim and 1 at the centre, or at the hole.

use glam::DVec3;

use super::local::{LocalHit, LocalPoint, turn};
use super::square::plane_hit;
use crate::Ray;

pub(super) fn intersect(ray: &Ray, end: f64, inner_radius: f64) -> Option<LocalHit> {
    let hit = plane_hit(ray, end)?;
    let place = ray.at(hit.t).truncate().length_squared();
    (place <= 1.0 && place >= inner_radius * inner_radius).then_some(hit)
}

/// The place where a ray is at `t`.
pub(super) fn point(ray: &Ray, t: f64, inner_radius: f64) -> LocalPoint {
    let place = ray.at(t).truncate();
    let tangent = if place.length_squared() > 0.0 { DVec3::new(-place.y, place.x, 0.0) } else { DVec3::X };
    let v = ((1.0 - place.length()) / (1.0 - inner_radius).max(f64::MIN_POSITIVE)).clamp(0.0, 1.0);
    LocalPoint {
        position: place.extend(0.0),
        normal: DVec3::Z,
        shading_normal: None,
        tangent,
        uv: [turn(place.x, place.y), v],
    }
}
