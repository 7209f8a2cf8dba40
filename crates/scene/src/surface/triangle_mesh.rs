//! A mesh ready to trace: its nearest triangle along a ray.
//!
//! Which triangles a ray meets is decided exactly (see `triangle.rs`), but their distances are rounded: at a silhouette,
//! and where the ray runs in the plane of a triangle, the way in and the way out may come in the wrong order. Therefore hits
//! near an edge, and of uncertain distance, are looked at together with all that rounding cannot tell apart from them: if as
//! many lead in as out, the ray has only touched the mesh and goes on; else it meets one that leads the way of the majority.

use std::cmp::Ordering;

use glam::DVec3;

use super::Mesh;
use super::bvh::Bvh;
use super::local::{LocalHit, LocalPoint};
use super::triangle::{ShearedRay, TriangleHit};
use crate::Ray;

/// Weights of vertices below this are near an edge.
const NEAR_EDGE: f64 = 1e-6;
/// Distances less certain than this, relative to the lengths that they are computed from, are looked into.
const UNCERTAIN: f64 = 1e-10;

/// Triangles with their tree.
#[derive(Debug, Clone)]
pub(super) struct TriangleMesh {
    mesh: Mesh,
    bvh: Bvh,
    /// The greatest coordinate.
    size: f64,
}

impl TriangleMesh {
    pub fn new(mesh: Mesh) -> Self {
        let size = mesh.positions.iter().fold(0.0_f64, |size, p| size.max(p.abs().max_element()));
        let bvh = Bvh::new(mesh.triangles.iter().map(|triangle| {
            let [a, b, c] = triangle.map(|corner| mesh.positions[corner as usize]);
            [a.min(b).min(c), a.max(b).max(c)]
        }));
        Self { mesh, bvh, size }
    }

    /// The triangles.
    pub fn mesh(&self) -> &Mesh {
        &self.mesh
    }

    /// The box around it.
    pub fn bounds(&self) -> [DVec3; 2] {
        self.bvh.bounds().unwrap_or([DVec3::ZERO; 2])
    }

    /// The corners of a triangle.
    #[inline]
    pub fn corners(&self, triangle: u32) -> [DVec3; 3] {
        self.mesh.triangles[triangle as usize].map(|corner| self.mesh.positions[corner as usize])
    }

    /// The nearest triangle before `end`.
    pub fn intersect(&self, ray: &Ray, end: f64) -> Option<LocalHit> {
        let sheared = ShearedRay::new(ray);
        let mut begin = 0.0;
        loop {
            let mut nearest = None;
            self.bvh.traverse(ray, end, |triangle, end| match sheared.intersect(self.corners(triangle)) {
                Some(hit) if hit.t > begin && hit.t < end => {
                    nearest = Some((triangle, hit));
                    hit.t
                }
                _ => end,
            });
            let (triangle, hit) = nearest?;
            let reach = self.size + ray.origin.abs().max_element();
            let certain = UNCERTAIN * reach / ray.direction.length();
            if hit.spread < certain && hit.weights.iter().all(|weight| *weight > NEAR_EDGE) {
                return Some(local(triangle, &hit));
            }
            match self.among_equals(ray, &sheared, begin, hit.t + hit.spread, certain) {
                (Some(hit), _) => return Some(hit).filter(|hit| hit.t < end),
                (None, last) => begin = last,
            }
        }
    }

    /// Of the hits that may be before `last`, and those that may be before these, the nearest that leads the way of the
    /// majority, if there is one, rather one of a distance that is `certain`; and the end of them all.
    #[cold]
    fn among_equals(
        &self,
        ray: &Ray,
        sheared: &ShearedRay,
        begin: f64,
        last: f64,
        certain: f64,
    ) -> (Option<LocalHit>, f64) {
        let mut last = last;
        loop {
            let (mut balance, mut end) = (0, last);
            let mut nearest: [Option<(bool, LocalHit)>; 2] = [None; 2];
            self.bvh.traverse(ray, last, |triangle, last| {
                if let Some(hit) = sheared.intersect(self.corners(triangle))
                    && hit.t > begin
                    && hit.t - hit.spread <= last
                {
                    balance += if hit.enters { 1 } else { -1 };
                    end = end.max(hit.t + hit.spread);
                    let slot = &mut nearest[usize::from(hit.enters)];
                    let rank = (hit.spread >= certain, hit.t);
                    if slot.is_none_or(|(is_uncertain, slot)| rank < (is_uncertain, slot.t)) {
                        *slot = Some((rank.0, local(triangle, &hit)));
                    }
                }
                last
            });
            if end > last {
                last = end;
                continue;
            }
            let majority = match balance.cmp(&0) {
                Ordering::Greater => nearest[1],
                Ordering::Less => nearest[0],
                Ordering::Equal => None,
            };
            return (majority.map(|(_, hit)| hit), last);
        }
    }

    /// The greatest coordinates of a triangle.
    pub fn size(&self, triangle: u32) -> DVec3 {
        let [a, b, c] = self.corners(triangle);
        a.abs().max(b.abs()).max(c.abs())
    }

    /// The place of a hit, at least `margin` from the edges of its triangle, so that what is near it is on the side of
    /// that triangle where it seems to be. `smooth` uses the normals of the mesh.
    pub fn point(&self, hit: &LocalHit, margin: f64, smooth: bool) -> LocalPoint {
        let corners = self.corners(hit.primitive);
        let [a, b, c] = corners;
        let normal = (b - a).cross(c - a);
        let [second, third] = hit.weights;
        let weights = inside(corners, normal.length(), [1.0 - second - third, second, third], margin);
        let vertices = self.mesh.triangles[hit.primitive as usize].map(|corner| corner as usize);
        let mixed = |values: &[DVec3]| -> DVec3 {
            vertices.iter().zip(weights).map(|(&vertex, weight)| values[vertex] * weight).sum()
        };
        let normals = self.mesh.normals.as_ref().filter(|_| smooth);
        let shading_normal = normals.map(|normals| mixed(normals)).filter(|mixed| *mixed != DVec3::ZERO);
        let position = a * weights[0] + b * weights[1] + c * weights[2];
        let Some(uvs) = &self.mesh.uvs else {
            // Those of the triangle itself: 0 at the first corner, 1 at the second and the third.
            let uv = [weights[1], weights[2]];
            return LocalPoint { position, normal, shading_normal, tangent: b - a, uv };
        };
        let [uv_a, uv_b, uv_c] = vertices.map(|vertex| glam::DVec2::from_array(uvs[vertex]));
        let (first, second) = (uv_b - uv_a, uv_c - uv_a);
        let determinant = first.perp_dot(second);
        // Where all of a triangle has one colour there is no direction in which that changes.
        let tangent = ((b - a) * second.y - (c - a) * first.y) * determinant.signum();
        let tangent = if determinant == 0.0 || tangent == DVec3::ZERO { b - a } else { tangent };
        let uv = (uv_a * weights[0] + uv_b * weights[1] + uv_c * weights[2]).to_array();
        LocalPoint { position, normal, shading_normal, tangent, uv }
    }
}

fn local(triangle: u32, hit: &TriangleHit) -> LocalHit {
    let [_, second, third] = hit.weights;
    LocalHit { t: hit.t, primitive: triangle, enters: hit.enters, weights: [second, third] }
}

/// Weights moved towards the centre until the place is `margin` from each edge, or half way to the centre.
fn inside([a, b, c]: [DVec3; 3], twice_area: f64, weights: [f64; 3], margin: f64) -> [f64; 3] {
    let edges = [b.distance(c), c.distance(a), a.distance(b)];
    let mut way = 0.0_f64;
    for (weight, edge) in weights.into_iter().zip(edges) {
        let least = (margin * edge / twice_area).min(1.0 / 6.0);
        way = way.max((least - weight) / (1.0 / 3.0 - weight.min(0.2)));
    }
    weights.map(|weight| weight + way.min(1.0) * (1.0 / 3.0 - weight))
}
