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

/// A rectangle that can be seen from points.
#[derive(Debug, Clone)]
pub(super) struct Rectangle {
    corner: DVec3,
    /// Unit vectors along the edges, and their normal u × v.
    axes: [DVec3; 3],
    /// Lengths of the edges.
    size: [f64; 2],
}

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
    /// Cosine and sine of the sum of the inner angles at x₀.
    left: [f64; 2],
    solid_angle: f64,
}

/// Least solid angle for which the differences of angles keep enough digits: a relative error of 1e-10.
const LEAST_SOLID_ANGLE: f64 = 1e-5;

/// Greatest cosine between edges that count as perpendicular.
const PERPENDICULAR: f64 = 1e-12;

impl Rectangle {
    /// The rectangle with `corner` and edges `u` and `v`. None if its edges are not perpendicular.
    pub(super) fn new(corner: DVec3, u: DVec3, v: DVec3) -> Option<Self> {
        let (first, second) = (u.try_normalize()?, v.try_normalize()?);
        let axes = [first, second, first.cross(second)];
        let is_right_angled = first.dot(second).abs() <= PERPENDICULAR;
        is_right_angled.then(|| Self { corner, axes, size: [u.length(), v.length()] })
    }

    /// The point that divides the edges like `u`.
    #[inline]
    pub(super) fn at(&self, u: [f64; 2]) -> DVec3 {
        self.corner + self.axes[0] * (self.size[0] * u[0]) + self.axes[1] * (self.size[1] * u[1])
    }

    /// Unit normal to the outer side.
    #[inline]
    pub(super) fn normal(&self) -> DVec3 {
        self.axes[2]
    }

    /// The rectangle as seen from `from`; none where it is better drawn by area.
    pub(super) fn seen_from(&self, from: DVec3) -> Option<SphericalRectangle> {
        let ([first, second, normal], [width, height]) = (self.axes, self.size);
        let offset = self.corner - from;
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
        let component = |edge: f64| edge / length(edge, z);
        let (lower, right, upper, left) =
            (-component(y[0]), component(x[1]), component(y[1]), -component(x[0]));
        // Angles as cosine and sine, which add up by a product: that takes one arc tangent for all four.
        let inner_angle = |one: f64, other: f64| {
            let cos = (-one * other).clamp(-1.0, 1.0);
            [cos, ((1.0 - cos) * (1.0 + cos)).sqrt()]
        };
        let right_angles = sum_of_angles(inner_angle(lower, right), inner_angle(right, upper));
        let left_angles = sum_of_angles(inner_angle(upper, left), inner_angle(left, lower));
        let [cos, sin] = sum_of_angles(right_angles, left_angles);
        let excess = libm::atan2(sin, cos);
        let solid_angle = if excess < -LEAST_SOLID_ANGLE { excess + TAU } else { excess };
        (solid_angle > LEAST_SOLID_ANGLE).then_some(SphericalRectangle {
            from,
            frame: [first, second, third],
            x,
            y,
            z,
            lower,
            upper,
            left: left_angles,
            solid_angle,
        })
    }
}

impl SphericalRectangle {
    /// Density over solid angle, 1/sr.
    pub(super) fn pdf(&self) -> f64 {
        1.0 / self.solid_angle
    }

    /// The point of the rectangle for `u` in [0, 1)².
    pub(super) fn sample(&self, u: [f64; 2]) -> DVec3 {
        // The part of the rectangle to the left of the x sought has the solid angle u₀ Ω; its inner angles at the cut fill
        // up `phi` to 2π.
        let (sin, cos) = libm::sincos(u[0] * self.solid_angle);
        let [cos, sin] = sum_of_angles([cos, sin], [self.left[0], -self.left[1]]);
        let f = (cos * self.lower - self.upper) / sin;
        let cut = (1.0 / length(f, self.lower)).copysign(f).clamp(-1.0, 1.0);
        let x = (-cut * self.z / (1.0 - cut * cut).max(f64::MIN_POSITIVE).sqrt()).clamp(self.x[0], self.x[1]);
        // Along the cut, heights over the distance to the eye are uniform in the sine of the elevation.
        let near = length(x, self.z);
        let sine = |y: f64| y / length(y, near);
        let (low, high) = (sine(self.y[0]), sine(self.y[1]));
        let sine = low + u[1] * (high - low);
        let y = (sine * near / ((1.0 - sine) * (1.0 + sine)).max(f64::MIN_POSITIVE).sqrt())
            .clamp(self.y[0], self.y[1]);
        let [first, second, third] = self.frame;
        self.from + first * x + second * y + third * self.z
    }
}

/// Cosine and sine of the sum of two angles, given by theirs.
fn sum_of_angles([cos_a, sin_a]: [f64; 2], [cos_b, sin_b]: [f64; 2]) -> [f64; 2] {
    [cos_a * cos_b - sin_a * sin_b, sin_a * cos_b + cos_a * sin_b]
}

/// √(a² + b²) of lengths in a scene, whose squares are in the range of numbers.
fn length(a: f64, b: f64) -> f64 {
    (a * a + b * b).sqrt()
}
