//! A rectangle drawn uniformly over the solid angle that it fills as seen from a point.
//!
//! Ureña, Fajardo & King 2013, "An area-preserving parametrization for spherical rectangles": in a frame along the
//! rectangle's edges with the point at the origin it spans [x₀, x₁] × [y₀, y₁] at z₀ < 0. Its great-circle edges meet at
//! inner angles γ whose excess over 2π is the solid angle Ω. The first number chooses how much of Ω lies to the left of the
//! point, which gives its x in closed form; the second its y.
//!
//! Where Ω is too small to be computed that way, as the difference of angles near π/2, or where the point is nearly in the
//! rectangle's plane, the rectangle is to be drawn by area.

use std::f64::consts::TAU;

use glam::DVec3;

/// A rectangle as seen from a point.
pub(super) struct SphericalRectangle {
    from: DVec3,
    /// Unit vectors along the edges, and away from the rectangle.
    frame: [DVec3; 3],
    /// Extents in the frame.
    x: [f64; 2],
    y: [f64; 2],
    z: f64,
    /// z components of the normals of the planes through the point and the edges at y₀ and y₁.
    lower: f64,
    upper: f64,
    /// 2π less the inner angles at x₁.
    rest: f64,
    solid_angle: f64,
}

/// Least solid angle for which the differences of angles keep enough digits: a relative error of 1e-10.
const LEAST_SOLID_ANGLE: f64 = 1e-5;

/// Greatest cosine between edges that count as perpendicular.
const PERPENDICULAR: f64 = 1e-12;

impl SphericalRectangle {
    /// The rectangle with `corner` and edges `u` and `v` as seen from `from`. None if its edges are not perpendicular, or
    /// where it is better drawn by area.
    pub(super) fn new(from: DVec3, corner: DVec3, u: DVec3, v: DVec3) -> Option<Self> {
        let (width, height) = (u.length(), v.length());
        let (first, second) = (u.try_normalize()?, v.try_normalize()?);
        if first.dot(second).abs() > PERPENDICULAR {
            return None;
        }
        let offset = corner - from;
        let normal = first.cross(second);
        let depth = offset.dot(normal);
        let third = if depth > 0.0 { -normal } else { normal };
        let z = -depth.abs();
        let x0 = offset.dot(first);
        let y0 = offset.dot(second);
        let (x, y) = ([x0, x0 + width], [y0, y0 + height]);
        if depth.abs() < 1e-6 * (width + height + offset.length()) {
            return None;
        }
        // Normals of the planes through the edges, of which only the components that matter are kept: the edge at y₀ has
        // (0, z, −y₀), the one at x₁ (−z, 0, x₁), and so on round the rectangle.
        let component = |edge: f64| edge / edge.hypot(z);
        let (lower, right, upper, left) =
            (-component(y[0]), component(x[1]), component(y[1]), -component(x[0]));
        let inner_angle = |one: f64, other: f64| (-one * other).clamp(-1.0, 1.0).acos();
        let right_angles = inner_angle(lower, right) + inner_angle(right, upper);
        let left_angles = inner_angle(upper, left) + inner_angle(left, lower);
        let solid_angle = right_angles + left_angles - TAU;
        (solid_angle > LEAST_SOLID_ANGLE).then_some(Self {
            from,
            frame: [first, second, third],
            x,
            y,
            z,
            lower,
            upper,
            rest: TAU - left_angles,
            solid_angle,
        })
    }

    /// Density over solid angle, 1/sr.
    pub(super) fn pdf(&self) -> f64 {
        1.0 / self.solid_angle
    }

    /// The point of the rectangle for `u` in [0, 1)².
    pub(super) fn sample(&self, u: [f64; 2]) -> DVec3 {
        // The part of the rectangle to the left of the x sought has the solid angle u₀ Ω; its inner angles at the cut fill
        // up `phi` to 2π.
        let phi = u[0] * self.solid_angle + self.rest;
        let (sin, cos) = phi.sin_cos();
        let f = (cos * self.lower - self.upper) / sin;
        let cut = (1.0 / f.hypot(self.lower)).copysign(f).clamp(-1.0, 1.0);
        let x = (-cut * self.z / (1.0 - cut * cut).max(f64::MIN_POSITIVE).sqrt()).clamp(self.x[0], self.x[1]);
        // Along the cut, heights over the distance to the eye are uniform in the sine of the elevation.
        let near = x.hypot(self.z);
        let sine = |y: f64| y / y.hypot(near);
        let [low, high] = self.y.map(sine);
        let sine = low + u[1] * (high - low);
        let y = (sine * near / ((1.0 - sine) * (1.0 + sine)).max(f64::MIN_POSITIVE).sqrt())
            .clamp(self.y[0], self.y[1]);
        let [first, second, third] = self.frame;
        self.from + first * x + second * y + third * self.z
    }
}
