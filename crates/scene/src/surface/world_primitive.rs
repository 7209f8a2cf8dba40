//! Pieces of a surface in world space, of which points can be drawn uniformly by area.
//!
//! Triangles by the square root map (Turk 1990, "Generating random points in triangles"); spheres and cylinders by
//! Archimedes' theorem that equal heights have equal areas; discs and rings by r² uniform between the radii's squares.

use std::f64::consts::{PI, TAU};

use glam::DVec3;

/// A piece of a surface. What is in here is as it lies in the scene: transforms, mirroring ones and `flip` among them, are
/// already in the order of vertices, in normals, and in `inward`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum WorldPrimitive {
    /// The outer side is the one from which the vertices run counter-clockwise.
    Triangle([DVec3; 3]),
    /// The points `corner + s u + t v` for s and t in [0, 1]; the outer side is that of u × v.
    Parallelogram {
        /// One of the corners.
        corner: DVec3,
        /// The first edge.
        u: DVec3,
        /// The second edge.
        v: DVec3,
    },
    /// A sphere.
    Sphere {
        /// The centre.
        center: DVec3,
        /// The radius.
        radius: f64,
        /// Whether the outer side is that of the centre.
        inward: bool,
    },
    /// A disc, or a ring.
    Disc {
        /// The centre.
        center: DVec3,
        /// Unit vector to the outer side.
        normal: DVec3,
        /// The radius.
        radius: f64,
        /// Radius of the hole.
        inner_radius: f64,
    },
    /// A cylinder without caps.
    Cylinder {
        /// Centre of one end.
        from: DVec3,
        /// Centre of the other end.
        to: DVec3,
        /// The radius.
        radius: f64,
        /// Whether the outer side is that of the axis.
        inward: bool,
    },
}

/// A point of a surface.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SurfacePoint {
    /// Where it is.
    pub position: DVec3,
    /// Unit normal to the outer side; zero on a primitive without area.
    pub normal: DVec3,
}

impl WorldPrimitive {
    /// The area, in squared scene units.
    pub fn area(&self) -> f64 {
        match *self {
            Self::Triangle([a, b, c]) => 0.5 * (b - a).cross(c - a).length(),
            Self::Parallelogram { u, v, .. } => u.cross(v).length(),
            Self::Sphere { radius, .. } => 4.0 * PI * radius * radius,
            Self::Disc { radius, inner_radius, .. } => {
                PI * (radius - inner_radius).max(0.0) * (radius + inner_radius)
            }
            Self::Cylinder { from, to, radius, .. } => TAU * radius * from.distance(to),
        }
    }

    /// A point uniform in area for `u` uniform in [0, 1)².
    pub fn sample(&self, u: [f64; 2]) -> SurfacePoint {
        match *self {
            Self::Triangle([a, b, c]) => {
                let root = u[0].sqrt();
                let position = a + (b - a) * (root * (1.0 - u[1])) + (c - a) * (root * u[1]);
                SurfacePoint { position, normal: self.flat_normal().unwrap_or(DVec3::ZERO) }
            }
            Self::Parallelogram { corner, u: first, v: second } => SurfacePoint {
                position: corner + first * u[0] + second * u[1],
                normal: self.flat_normal().unwrap_or(DVec3::ZERO),
            },
            Self::Sphere { center, radius, inward } => {
                let z = 1.0 - 2.0 * u[1];
                let across = (1.0 - z * z).max(0.0).sqrt();
                let (sin, cos) = libm::sincos(TAU * u[0]);
                let outwards = DVec3::new(across * cos, across * sin, z);
                SurfacePoint { position: center + outwards * radius, normal: facing(outwards, inward) }
            }
            Self::Disc { center, normal, radius, inner_radius } => {
                let inner = inner_radius * inner_radius;
                let distance = (inner + u[1] * (radius * radius - inner)).max(0.0).sqrt();
                let (sin, cos) = libm::sincos(TAU * u[0]);
                let (first, second) = normal.any_orthonormal_pair();
                SurfacePoint { position: center + (first * cos + second * sin) * distance, normal }
            }
            Self::Cylinder { from, to, radius, inward } => {
                let (first, second) = (to - from).normalize_or(DVec3::Y).any_orthonormal_pair();
                let (sin, cos) = libm::sincos(TAU * u[0]);
                let outwards = first * cos + second * sin;
                let position = from + (to - from) * u[1] + outwards * radius;
                SurfacePoint { position, normal: facing(outwards, inward) }
            }
        }
    }

    /// The unit normal to the outer side, if it is the same everywhere.
    pub fn flat_normal(&self) -> Option<DVec3> {
        match *self {
            Self::Triangle([a, b, c]) => (b - a).cross(c - a).try_normalize(),
            Self::Parallelogram { u, v, .. } => u.cross(v).try_normalize(),
            Self::Disc { normal, .. } => Some(normal),
            Self::Sphere { .. } | Self::Cylinder { .. } => None,
        }
    }

    /// Least and greatest corner of a box around it, with faces across the axes.
    pub fn bounds(&self) -> [DVec3; 2] {
        match *self {
            Self::Triangle([a, b, c]) => [a.min(b).min(c), a.max(b).max(c)],
            Self::Parallelogram { corner, u, v } => [
                corner + u.min(DVec3::ZERO) + v.min(DVec3::ZERO),
                corner + u.max(DVec3::ZERO) + v.max(DVec3::ZERO),
            ],
            Self::Sphere { center, radius, .. } => [center - radius, center + radius],
            Self::Disc { center, normal, radius, .. } => {
                let reach = disc_reach(normal) * radius;
                [center - reach, center + reach]
            }
            Self::Cylinder { from, to, radius, .. } => {
                let reach = disc_reach((to - from).normalize_or(DVec3::Y)) * radius;
                [from.min(to) - reach, from.max(to) + reach]
            }
        }
    }
}

fn facing(outwards: DVec3, inward: bool) -> DVec3 {
    if inward { -outwards } else { outwards }
}

/// How far a disc of radius 1 reaches along each axis.
fn disc_reach(normal: DVec3) -> DVec3 {
    (DVec3::ONE - normal * normal).max(DVec3::ZERO).map(f64::sqrt)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn all() -> Vec<WorldPrimitive> {
        let (center, normal) = (DVec3::new(1.0, -2.0, 0.5), DVec3::new(1.0, 2.0, -2.0) / 3.0);
        vec![
            WorldPrimitive::Triangle([center, center + DVec3::X * 2.0, DVec3::new(0.0, 3.0, 1.0)]),
            WorldPrimitive::Parallelogram { corner: center, u: DVec3::new(1.0, 1.0, 0.0), v: DVec3::Y * 3.0 },
            WorldPrimitive::Sphere { center, radius: 1.5, inward: false },
            WorldPrimitive::Disc { center, normal, radius: 2.0, inner_radius: 0.7 },
            WorldPrimitive::Cylinder { from: center, to: center + normal * 3.0, radius: 0.4, inward: true },
        ]
    }

    /// The flux through a surface of a field with constant gradient M is ∫ M x · n dA: the mean over points uniform in
    /// area, times the area, has to be that of a fine sum over the map from the square, whose Jacobian is measured.
    #[test]
    fn points_are_uniform_in_area_inside_the_bounds_and_on_the_surface() {
        let field = |p: SurfacePoint| (p.position * DVec3::new(1.0, -2.0, 3.0) + 1.0).dot(p.normal);
        for primitive in all() {
            let n = 400;
            let (mut uniform, mut by_jacobian, mut area) = (0.0, 0.0, 0.0);
            let step = 1e-6;
            for i in 0..n * n {
                let u = [f64::from(i % n), f64::from(i / n)].map(|k| (k + 0.5) / f64::from(n));
                let point = primitive.sample(u);
                let along = |axis: usize| {
                    let mut other = u;
                    other[axis] += step;
                    let mut before = u;
                    before[axis] -= step;
                    (primitive.sample(other).position - primitive.sample(before).position) / (2.0 * step)
                };
                let (first, second) = (along(0), along(1));
                let jacobian = first.cross(second).length();
                uniform += field(point);
                by_jacobian += field(point) * jacobian;
                area += jacobian;
                let scale = first.length() * second.length();
                assert!(first.cross(second).cross(point.normal).length() < 1e-6 * scale, "{primitive:?}");
                let [min, max] = primitive.bounds();
                assert!(point.position.cmpge(min - 1e-12).all() && point.position.cmple(max + 1e-12).all());
            }
            let count = f64::from(n * n);
            assert!((area / count / primitive.area() - 1.0).abs() < 1e-4, "{primitive:?}");
            let difference = (uniform * primitive.area() - by_jacobian) / count;
            assert!(difference.abs() < 1e-3 * primitive.area(), "{primitive:?}: {difference}");
        }
    }
}
