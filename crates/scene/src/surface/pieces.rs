//! The pieces of a placed geometry in world space, in the order of its primitives.

use glam::{DMat3, DVec3};

use super::WorldPrimitive;
use super::placed::{Geometry, Placed};

/// How much a round shape may be out of round.
const TOLERANCE: f64 = 1e-9;

/// `None` if a round shape is no longer round, and for planes, which have no end.
pub(super) fn world_primitives(placed: &Placed) -> Option<Vec<WorldPrimitive>> {
    let to_world = placed.to_world;
    let DMat3 { x_axis: x, y_axis: y, z_axis: z } = to_world.matrix3;
    let center = to_world.translation;
    let inward = placed.flip;
    // A map that mirrors keeps an outer side outside and thus turns the order of vertices round.
    let is_turned = (to_world.matrix3.determinant() < 0.0) != placed.flip;
    let flat = |corner: DVec3, u: DVec3, v: DVec3| {
        let (u, v) = if is_turned { (v, u) } else { (u, v) };
        WorldPrimitive::Parallelogram { corner, u, v }
    };
    let disc = |center: DVec3, outwards: f64, inner: f64| {
        let normal = x.cross(y).normalize_or(DVec3::Z) * if is_turned { -outwards } else { outwards };
        let radius = x.length();
        WorldPrimitive::Disc { center, normal, radius, inner_radius: inner * radius }
    };
    let size = x.length_squared();
    let is_round = (y.length_squared() / size - 1.0).abs() < TOLERANCE && x.dot(y).abs() < TOLERANCE * size;
    let is_upright = x.dot(z).abs().max(y.dot(z).abs()) < TOLERANCE * x.length() * z.length();
    match &placed.geometry {
        Geometry::Mesh { mesh, .. } => {
            let count = mesh.mesh().triangles.len() as u32;
            let triangle = |number| {
                let [a, b, c] = mesh.corners(number).map(|corner| to_world.transform_point3(corner));
                WorldPrimitive::Triangle(if is_turned { [a, c, b] } else { [a, b, c] })
            };
            Some((0..count).map(triangle).collect())
        }
        Geometry::Sphere => {
            let is_ball = is_round && is_upright && (z.length_squared() / size - 1.0).abs() < TOLERANCE;
            is_ball.then(|| vec![WorldPrimitive::Sphere { center, radius: x.length(), inward }])
        }
        Geometry::Cuboid => Some(vec![
            flat(center, z, y),
            flat(center + x, y, z),
            flat(center, x, z),
            flat(center + y, z, x),
            flat(center, y, x),
            flat(center + z, x, y),
        ]),
        Geometry::Square => Some(vec![flat(center, x, y)]),
        Geometry::Disc { inner_radius } => is_round.then(|| vec![disc(center, 1.0, *inner_radius)]),
        Geometry::Cylinder { capped } => (is_round && is_upright).then(|| {
            let (from, to) = (center, center + z);
            let mantle = WorldPrimitive::Cylinder { from, to, radius: x.length(), inward };
            if *capped { vec![mantle, disc(from, -1.0, 0.0), disc(to, 1.0, 0.0)] } else { vec![mantle] }
        }),
        Geometry::Plane => None,
    }
}
