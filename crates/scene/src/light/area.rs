//! A surface that shines: the same radiance L from each of its points in all directions on its outer side.
//!
//! A point of it is drawn uniformly by area, whose density over solid angle is d² / (A cos θ), with the angle θ between the
//! normal there and the way to the receiver at the distance d. A sphere seen from outside is drawn uniformly over the cone
//! it fills instead (Shirley, Wang & Zimmerman 1996, "Monte Carlo techniques for direct lighting calculations"): with
//! sin²α = r²/d², pdf = 1 / (2π (1 − cos α)). A rectangle is drawn uniformly over the solid angle it fills, see
//! `spherical_rectangle.rs`.

use std::f64::consts::{PI, TAU};

use glam::DVec3;

use super::LightSample;
use super::spherical_rectangle::{Rectangle, SphericalRectangle};
use crate::surface::{SurfacePoint, WorldPrimitive};

/// A surface that shines.
#[derive(Debug, Clone)]
pub struct AreaLight {
    primitives: Vec<WorldPrimitive>,
    /// The only primitive, if that is a rectangle.
    rectangle: Option<Rectangle>,
    middle: DVec3,
    /// Area of all primitives up to and with each.
    cumulative_area: Vec<f64>,
    radiance: DVec3,
    two_sided: bool,
}

/// How much nearer than the lamp a shadow ray ends, relative to the distance and to the coordinates: roundings must not
/// let the lamp shadow itself.
const SHORT: f64 = 1e-9;

impl AreaLight {
    /// A lamp that consists of `primitives` and sends out `radiance` on its outer side, and on the inner one too if it is
    /// `two_sided`. Without any primitives (or area) it is never sampled, and only paths that meet it by chance find it.
    pub fn new(primitives: Vec<WorldPrimitive>, radiance: DVec3, two_sided: bool) -> Self {
        let mut area = 0.0;
        let mut cumulative_area: Vec<f64> = primitives
            .iter()
            .map(|primitive| {
                area += primitive.area();
                area
            })
            .collect();
        if !(area.is_finite() && area > 0.0) {
            cumulative_area.clear();
        }
        let rectangle = match primitives.as_slice() {
            [WorldPrimitive::Parallelogram { corner, u, v }] => Rectangle::new(*corner, *u, *v),
            _ => None,
        };
        let empty = [DVec3::INFINITY, DVec3::NEG_INFINITY];
        let [min, max] = primitives.iter().fold(empty, |[least, most], primitive| {
            let [min, max] = primitive.bounds();
            [least.min(min), most.max(max)]
        });
        let middle = (min + max) * 0.5;
        Self { primitives, rectangle, middle, cumulative_area, radiance, two_sided }
    }

    /// The area, in squared scene units; 0 for a lamp that cannot be sampled.
    pub fn area(&self) -> f64 {
        self.cumulative_area.last().copied().unwrap_or(0.0)
    }

    /// The middle of a box around it.
    pub fn middle(&self) -> DVec3 {
        self.middle
    }

    /// The pieces of its surface.
    pub fn primitives(&self) -> &[WorldPrimitive] {
        &self.primitives
    }

    /// Whether the inner side shines too.
    pub fn is_two_sided(&self) -> bool {
        self.two_sided
    }

    /// Radiance that it sends out.
    pub fn radiance(&self) -> DVec3 {
        self.radiance
    }

    /// Radiance that arrives along a ray in the unit vector `direction` which meets the lamp where its normal to the outer
    /// side is `normal`.
    pub fn radiance_from(&self, normal: DVec3, direction: DVec3) -> DVec3 {
        if self.two_sided || direction.dot(normal) < 0.0 { self.radiance } else { DVec3::ZERO }
    }

    /// Density over solid angle, 1/sr, with which [`sample`](super::Light::sample) at `from` draws the point `position`, a
    /// ray from there in the unit vector `direction` away, where the lamp's normal is `normal`.
    pub fn pdf_of_hit(&self, from: DVec3, direction: DVec3, position: DVec3, normal: DVec3) -> f64 {
        match self.view(from) {
            View::Nothing => 0.0,
            View::Sphere(cone) => {
                // Only the nearer half is drawn.
                if (position - cone.center).dot(direction) < 0.0 { cone.pdf() } else { 0.0 }
            }
            View::Rectangle(rectangle) => rectangle.pdf(),
            View::Area(area) => {
                let cos = direction.dot(normal).abs();
                if cos > 0.0 { position.distance_squared(from) / (cos * area) } else { 0.0 }
            }
        }
    }

    /// As [`Light::sample`](super::Light::sample).
    pub fn sample(&self, from: DVec3, u: [f64; 2]) -> LightSample {
        match self.view(from) {
            View::Nothing => LightSample::NONE,
            View::Sphere(cone) => {
                let (toward, distance) = cone.sample(u);
                let inward = matches!(self.primitives[0], WorldPrimitive::Sphere { inward, .. } if inward);
                let radiance = if self.two_sided || !inward { self.radiance } else { DVec3::ZERO };
                found(from, toward, distance, radiance, cone.pdf())
            }
            View::Rectangle(rectangle) => {
                let offset = rectangle.sample(u) - from;
                let distance = offset.length();
                let toward = offset / distance;
                let normal = self.rectangle.as_ref().map_or(DVec3::ZERO, Rectangle::normal);
                found(from, toward, distance, self.radiance_from(normal, toward), rectangle.pdf())
            }
            View::Area(area) => self.see(from, &self.uniform_point(area, u)),
        }
    }

    /// A point of the lamp, uniform by area; none of a lamp that cannot be sampled.
    #[inline]
    pub fn point(&self, u: [f64; 2]) -> Option<SurfacePoint> {
        let area = self.area();
        (area > 0.0).then(|| self.uniform_point(area, u))
    }

    /// The light of a [`point`](Self::point) as it arrives at `from`: as a sample whose density is that of points uniform by
    /// area.
    pub fn see(&self, from: DVec3, point: &SurfacePoint) -> LightSample {
        let offset = point.position - from;
        let distance = offset.length();
        let toward = offset / distance;
        let cos = toward.dot(point.normal).abs();
        let pdf = distance * distance / (cos * self.area());
        let is_seen = cos > 0.0 && pdf > 0.0 && pdf.is_finite();
        // Edge on, or at the lamp itself, nothing comes from there.
        if !is_seen {
            return LightSample::NONE;
        }
        found(from, toward, distance, self.radiance_from(point.normal, toward), pdf)
    }

    /// Power in all directions, π L A from each side that shines.
    pub(super) fn power(&self) -> DVec3 {
        let sides = if self.two_sided { 2.0 } else { 1.0 };
        PI * self.radiance * (self.area() * sides)
    }

    #[inline]
    fn uniform_point(&self, area: f64, u: [f64; 2]) -> SurfacePoint {
        if let Some(rectangle) = &self.rectangle {
            return SurfacePoint { position: rectangle.at(u), normal: rectangle.normal() };
        }
        let target = u[0] * area;
        let last = self.primitives.len() - 1;
        let chosen = self.cumulative_area.partition_point(|&up_to| up_to <= target).min(last);
        let start = if chosen == 0 { 0.0 } else { self.cumulative_area[chosen - 1] };
        let inside = (target - start) / (self.cumulative_area[chosen] - start);
        let inside = if inside.is_finite() { inside.clamp(0.0, 1.0 - f64::EPSILON) } else { 0.5 };
        self.primitives[chosen].sample([inside, u[1]])
    }

    /// How the lamp is drawn from `from`.
    fn view(&self, from: DVec3) -> View {
        let area = self.area();
        if area <= 0.0 {
            return View::Nothing;
        }
        if let Some(rectangle) = &self.rectangle {
            return rectangle.seen_from(from).map_or(View::Area(area), View::Rectangle);
        }
        match self.primitives.as_slice() {
            [WorldPrimitive::Sphere { center, radius, .. }] => {
                ConeOfSphere::new(from, *center, *radius).map_or(View::Area(area), View::Sphere)
            }
            _ => View::Area(area),
        }
    }
}

enum View {
    Nothing,
    Sphere(ConeOfSphere),
    Rectangle(SphericalRectangle),
    /// Uniformly over this area.
    Area(f64),
}

fn found(from: DVec3, toward: DVec3, distance: f64, radiance: DVec3, pdf: f64) -> LightSample {
    let coordinates = from.abs().max_element() + distance;
    LightSample {
        toward,
        distance: (distance - SHORT * (distance + 0.1 * coordinates)).max(0.0),
        radiance_over_pdf: radiance / pdf,
        pdf,
        is_delta: false,
    }
}

/// The directions in which a sphere is seen from outside.
struct ConeOfSphere {
    center: DVec3,
    /// Unit vector to the centre.
    axis: DVec3,
    /// Distance of the centre.
    distance: f64,
    radius: f64,
    /// 1 − cos α.
    one_minus_cos: f64,
}

impl ConeOfSphere {
    /// None from inside.
    fn new(from: DVec3, center: DVec3, radius: f64) -> Option<Self> {
        let offset = center - from;
        let distance = offset.length();
        if distance <= radius {
            return None;
        }
        let sin = radius / distance;
        let cos = ((distance - radius) * (distance + radius)).sqrt() / distance;
        let one_minus_cos = sin * sin / (1.0 + cos);
        Some(Self { center, axis: offset / distance, distance, radius, one_minus_cos })
            .filter(|_| one_minus_cos > 0.0)
    }

    fn pdf(&self) -> f64 {
        1.0 / (TAU * self.one_minus_cos)
    }

    /// Unit vector and distance to the nearer side of the sphere.
    fn sample(&self, u: [f64; 2]) -> (DVec3, f64) {
        let below_axis = u[1] * self.one_minus_cos;
        let sin_squared = below_axis * (2.0 - below_axis);
        let (sin_azimuth, cos_azimuth) = libm::sincos(TAU * u[0]);
        let (first, second) = self.axis.any_orthonormal_pair();
        let sideways = (first * cos_azimuth + second * sin_azimuth) * sin_squared.sqrt();
        let half_chord = (self.radius * self.radius - self.distance * self.distance * sin_squared).max(0.0);
        let distance = self.distance * (1.0 - below_axis) - half_chord.sqrt();
        (self.axis * (1.0 - below_axis) + sideways, distance.max(0.0))
    }
}
