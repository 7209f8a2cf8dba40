//! The unit square [0, 1]² in the plane z = 0, its outer side towards +z. Texture coordinates are (x, y).

use glam::DVec3;

use super::local::{LocalHit, LocalPoint};
use crate::Ray;

pub(super) fn intersect(ray: &Ray, end: f64) -> Option<LocalHit> {
    let hit = plane_hit(ray, end)?;
    let place = ray.at(hit.t);
    let is_inside = |x: f64| (0.0..=1.0).contains(&x);
    (is_inside(place.x) && is_inside(place.y)).then_some(hit)
}

/// The place where a ray is at `t`.
pub(super) fn point(ray: &Ray, t: f64) -> LocalPoint {
    let place = ray.at(t);
    let (position, uv) = (DVec3::new(place.x, place.y, 0.0), [place.x, place.y]);
    LocalPoint { position, normal: DVec3::Z, shading_normal: None, tangent: DVec3::X, uv }
}

/// Where a ray meets the plane z = 0.
pub(super) fn plane_hit(ray: &Ray, end: f64) -> Option<LocalHit> {
    let t = -ray.origin.z / ray.direction.z;
    (t > 0.0 && t < end).then(|| LocalHit::new(t, 0, ray.direction.z < 0.0))
}
