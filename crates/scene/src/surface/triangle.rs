//! Where a ray meets a triangle, so that of triangles that share an edge or a vertex it meets just the right ones.
//!
//! In coordinates in which the ray is the z axis a triangle is hit if the origin is inside its projection, on the same side
//! of all three edges (Woop, Benthin & Wald 2013, "Watertight ray/triangle intersection"). The projected vertices do not
//! depend on the triangle, so the projections fit together if the sides are decided exactly: where a cross product rounds to
//! 0, by its rounding errors, and where it is 0, as if the ray were shifted by (ε, ε²), ε → 0 (Edelsbrunner & Mücke
//! 1990, "Simulation of simplicity"). Along any line the passages into and out of a closed mesh then balance.

use glam::DVec3;

use crate::Ray;

/// A bound, with some margin, on the relative errors of sums of a few products.
const ROUNDING: f64 = 64.0 * f64::EPSILON;

/// A ray with the axes in which it points along +z.
pub(super) struct ShearedRay {
    origin: DVec3,
    /// Numbers of the axes that become x, y and z.
    axes: [usize; 3],
    /// What z takes from x and y, and the factor that makes it the distance.
    shear: [f64; 3],
}

/// Where a triangle is met.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct TriangleHit {
    /// Distance along the ray, in lengths of its direction.
    pub t: f64,
    /// How far rounding may have moved it along the ray: up to the length of the triangle, if the ray runs in its plane.
    pub spread: f64,
    /// Weights of the three vertices; their sum is 1.
    pub weights: [f64; 3],
    /// Whether the ray comes from the outer side.
    pub enters: bool,
}

impl ShearedRay {
    pub fn new(ray: &Ray) -> Self {
        let d = ray.direction.to_array();
        let size = ray.direction.abs();
        let z = if size.z >= size.x.max(size.y) { 2 } else { usize::from(size.y >= size.x) };
        let (mut x, mut y) = ((z + 1) % 3, (z + 2) % 3);
        if d[z] < 0.0 {
            // So that the turning sense stays.
            std::mem::swap(&mut x, &mut y);
        }
        Self { origin: ray.origin, axes: [x, y, z], shear: [d[x] / d[z], d[y] / d[z], 1.0 / d[z]] }
    }

    /// Where the line meets the triangle, before or behind the origin.
    #[inline]
    pub fn intersect(&self, corners: [DVec3; 3]) -> Option<TriangleHit> {
        let [sx, sy, sz] = self.shear;
        let [x, y, z] = self.axes;
        let [a, b, c] = corners.map(|corner| {
            let p = (corner - self.origin).to_array();
            [p[x] - sx * p[z], p[y] - sy * p[z], sz * p[z]]
        });
        let sides = [cross(c, b), cross(a, c), cross(b, a)];
        let (is_inside, enters) = if sides.iter().all(|side| *side != 0.0) {
            let enters = sides[0] > 0.0;
            (sides.iter().all(|side| (*side > 0.0) == enters), enters)
        } else {
            let exact = [exact_side(c, b), exact_side(a, c), exact_side(b, a)];
            (exact[0] != 0 && exact == [exact[0]; 3], exact[0] > 0)
        };
        if !is_inside {
            return None;
        }
        let sum = sides[0] + sides[1] + sides[2];
        // Where the projection is too narrow for numbers the middle is as good as any place.
        let weights = if sum == 0.0 { [1.0 / 3.0; 3] } else { sides.map(|side| side / sum) };
        let t = weights[0] * a[2] + weights[1] * b[2] + weights[2] * c[2];
        // The weights are as uncertain as the products that they are differences of, relative to their sum.
        let greatest = |axis: usize| a[axis].abs().max(b[axis].abs()).max(c[axis].abs());
        let (low, high) = (a[2].min(b[2]).min(c[2]), a[2].max(b[2]).max(c[2]));
        let uncertainty = ROUNDING * greatest(0) * greatest(1) / sum.abs();
        let spread = uncertainty.min(1.0) * (high - low) + ROUNDING * greatest(2);
        Some(TriangleHit { t, spread, weights, enters })
    }
}

/// z of the cross product of the projections: on which side of the edge the ray is.
#[inline]
fn cross(p: [f64; 3], q: [f64; 3]) -> f64 {
    p[0] * q[1] - p[1] * q[0]
}

/// Its exact sign, or that for the shifted ray; 0 only if the projections coincide.
#[cold]
fn exact_side(p: [f64; 3], q: [f64; 3]) -> i8 {
    let sign = |x: f64| if x > 0.0 { 1 } else { i8::from(x < 0.0).wrapping_neg() };
    let (first, second) = (p[0] * q[1], p[1] * q[0]);
    if first != second {
        return sign(first - second);
    }
    // What the rounding of each product took away.
    let (first, second) = (p[0].mul_add(q[1], -first), p[1].mul_add(q[0], -second));
    if first != second {
        return sign(first - second);
    }
    if p[1] != q[1] { sign(p[1] - q[1]) } else { sign(q[0] - p[0]) }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Of the triangles of a fan around a point, a ray through that point, or through a common edge, meets exactly one,
    /// from whichever direction it comes.
    #[test]
    fn of_the_triangles_around_a_vertex_or_along_an_edge_just_one_is_met() {
        let rim = [[1.0, 0.2], [0.3, 1.1], [-0.7, 0.9], [-1.0, -0.4], [-0.1, -1.3], [0.8, -0.6]]
            .map(|[x, y]| DVec3::new(x, y, 0.1 * x - 0.3 * y));
        let fan: Vec<[DVec3; 3]> = (0..6).map(|n| [DVec3::ZERO, rim[n], rim[(n + 1) % 6]]).collect();
        for direction in [
            DVec3::Z,
            DVec3::NEG_Z,
            DVec3::new(0.1, 0.2, -1.0),
            DVec3::new(0.6, 0.5, 0.62),
            DVec3::new(1.0, 0.1, 0.4),
            DVec3::new(0.3, -1.0, -0.9),
        ] {
            let targets = std::iter::once(DVec3::ZERO).chain(rim.map(|corner| corner * 0.5));
            for target in targets {
                let ray = ShearedRay::new(&Ray { origin: target - direction * 4.0, direction });
                let hits: Vec<TriangleHit> =
                    fan.iter().filter_map(|corners| ray.intersect(*corners)).collect();
                assert_eq!(hits.len(), 1, "{direction} {target}");
                assert!((hits[0].t - 4.0).abs() < 1e-14, "{}", hits[0].t);
                let normal = DVec3::new(-0.1, 0.3, 1.0);
                assert_eq!(hits[0].enters, direction.dot(normal) < 0.0);
            }
        }
    }

    /// 1 + 2⁻³⁰ squared differs from 1 + 2⁻²⁹ by 2⁻⁶⁰, which an f64 cannot hold.
    #[test]
    fn sides_that_round_to_nothing_are_told_apart() {
        let step = 2_f64.powi(-30);
        let (p, q) = ([1.0 + step, 1.0, 0.0], [1.0 + 2.0 * step, 1.0 + step, 0.0]);
        assert_eq!(cross(p, q), 0.0);
        assert_eq!((exact_side(p, q), exact_side(q, p)), (1, -1));
        let (p, q) = ([1.0, 2.0, 0.0], [2.0, 4.0, 0.0]);
        assert_eq!((exact_side(p, q), exact_side(q, p), exact_side(p, p)), (-1, 1, 0));
    }
}
