//! What geometries answer in their own coordinates.

use glam::DVec3;

/// Where a ray meets a geometry.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct LocalHit {
    /// Distance along the ray, in lengths of its direction.
    pub t: f64,
    /// Number of the primitive.
    pub primitive: u32,
    /// Whether the ray comes from the outer side. Decided together with the hit: the dot product of direction and normal may
    /// round to the other sign.
    pub enters: bool,
    /// Of a triangle, the weights of its second and third vertex.
    pub weights: [f64; 2],
}

impl LocalHit {
    /// One on a geometry that is not made of triangles.
    pub fn new(t: f64, primitive: u32, enters: bool) -> Self {
        Self { t, primitive, enters, weights: [0.0; 2] }
    }
}

/// A place on a geometry. Normals are of any length.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct LocalPoint {
    /// Where it is.
    pub position: DVec3,
    /// Normal to the outer side.
    pub normal: DVec3,
    /// Normal that it is lit by, if that is another.
    pub shading_normal: Option<DVec3>,
    /// Direction in which the first texture coordinate grows.
    pub tangent: DVec3,
    /// Texture coordinates.
    pub uv: [f64; 2],
}

/// The nearer end before `end` of the part of a ray, from `enter` to `leave`, that is inside something closed; with the
/// numbers of the primitives there.
pub(super) fn nearest_end(enter: (f64, u32), leave: (f64, u32), end: f64) -> Option<LocalHit> {
    if enter.0 >= leave.0 {
        return None;
    }
    let hit = if enter.0 > 0.0 {
        LocalHit::new(enter.0, enter.1, true)
    } else {
        LocalHit::new(leave.0, leave.1, false)
    };
    (hit.t > 0.0 && hit.t < end).then_some(hit)
}

/// An angle about the z axis from +x towards +y, in turns from 0 to 1.
pub(super) fn turn(x: f64, y: f64) -> f64 {
    let turn = libm::atan2(y, x) / std::f64::consts::TAU;
    if turn < 0.0 { turn + 1.0 } else { turn }
}
