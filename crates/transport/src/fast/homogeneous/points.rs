//! Points of a light as they are seen from places along a ray, side by side.
//!
//! In f32 and from the ray's origin, which is enough for what they bring; the shadow ray to the one that is chosen is made in
//! f64.

use glam::{DVec3, Vec3};
use tyndall_scene::light::{AreaLight, SpotLight};
use tyndall_scene::{Hit, Light, LightSample, Ray};

use super::stretch::Fog;

/// Points of one light.
pub(super) struct Points<const N: usize> {
    /// Unit vectors to them, by component.
    pub toward: [[f32; N]; 3],
    pub distance: [f32; N],
    /// Densities over solid angle; 0 if the light is a point.
    pub pdf: [f32; N],
    /// Radiance over density, or irradiance, of the brightest channel.
    pub arriving: [f32; N],
    /// The light's colour: its brightest channel is 1.
    pub colour: Vec3,
    /// The points themselves; nothing at infinity.
    places: Option<[DVec3; N]>,
}

/// How much nearer than the point a shadow ray ends, relative to the coordinates: roundings must not let a lamp shadow
/// itself.
const SHORT: f64 = 1e-9;

/// Squared distance to the middle of a lamp over its area, below which the lamp is near.
const NEAR: f64 = 0.5;

/// Whether a lamp is so near that points of it are better drawn by solid angle than by area.
#[inline(always)]
fn is_near(lamp: &AreaLight, from: DVec3) -> bool {
    lamp.middle().distance_squared(from) < NEAR * lamp.area()
}

/// Density over solid angle with which the point of a lamp at `hit` is drawn from `from`, in the `direction` to it.
pub(super) fn lamp_pdf(lamp: &AreaLight, from: DVec3, direction: DVec3, hit: &Hit) -> f64 {
    if is_near(lamp, from) {
        return lamp.pdf_of_hit(from, direction, hit.position, hit.normal);
    }
    let cos = direction.dot(hit.normal).abs();
    hit.position.distance_squared(from) / (cos * lamp.area())
}

/// A direction to the light from `from`: uniform by area of lamps that are not near.
#[inline(always)]
pub(super) fn sample(light: &Light, from: DVec3, u: [f64; 2]) -> LightSample {
    if let Light::Area(lamp) = light
        && !is_near(lamp, from)
        && let Some(point) = lamp.point(u)
    {
        return lamp.see(from, &point);
    }
    light.sample(from, u)
}

impl<const N: usize> Points<N> {
    /// Points of a lamp, uniform by area.
    #[inline(always)]
    pub fn of_lamp(lamp: &AreaLight, ray: &Ray, t: &[f32; N], u: [f32; 2]) -> Self {
        let mut places = [DVec3::ZERO; N];
        let mut normal = [[0.0; N]; 3];
        for k in 0..N {
            if let Some(point) = lamp.point(spread(u, k)) {
                places[k] = point.position;
                let n = point.normal.as_vec3();
                (normal[0][k], normal[1][k], normal[2][k]) = (n.x, n.y, n.z);
            }
        }
        let (strength, colour) = strength_and_colour(lamp.radiance());
        let area = lamp.area() as f32;
        let backwards = if lamp.is_two_sided() { 1.0 } else { 0.0 };
        let mut points = Self::at(places, colour, ray, t);
        for k in 0..N {
            let [x, y, z] = &points.toward;
            let cos = -(x[k] * normal[0][k] + y[k] * normal[1][k] + z[k] * normal[2][k]);
            let shines = if cos > 0.0 { 1.0 } else { backwards };
            let pdf = points.distance[k] * points.distance[k] / (cos.abs() * area);
            points.pdf[k] = pdf;
            points.arriving[k] = strength * shines / pdf;
        }
        for (k, &t) in t.iter().enumerate() {
            let from = ray.at(f64::from(t));
            if is_near(lamp, from) {
                points.draw_from(k, from, &lamp.sample(from, spread(u, k)));
            }
        }
        points
    }

    /// Takes a sample for the point `k`, as it is seen from `from`.
    #[inline(never)]
    fn draw_from(&mut self, k: usize, from: DVec3, sample: &LightSample) {
        let toward = sample.toward.as_vec3();
        (self.toward[0][k], self.toward[1][k], self.toward[2][k]) = (toward.x, toward.y, toward.z);
        self.distance[k] = sample.distance as f32;
        self.pdf[k] = sample.pdf as f32;
        self.arriving[k] = sample.radiance_over_pdf.max_element() as f32;
        if let Some(places) = &mut self.places {
            places[k] = from + sample.toward * sample.distance;
        }
    }

    /// A light that is a point.
    #[inline(always)]
    pub fn of_point(place: DVec3, intensity: DVec3, ray: &Ray, t: &[f32; N]) -> Self {
        let (strength, colour) = strength_and_colour(intensity);
        let mut points = Self::at([place; N], colour, ray, t);
        for k in 0..N {
            points.arriving[k] = strength / (points.distance[k] * points.distance[k]);
        }
        points
    }

    /// A spot light.
    pub fn of_spot(spot: &SpotLight, ray: &Ray, t: &[f32; N]) -> Self {
        let (_, colour) = strength_and_colour(spot.intensity(spot.axis()));
        let mut points = Self::at([spot.position(); N], colour, ray, t);
        for k in 0..N {
            let toward = DVec3::from_array(std::array::from_fn(|axis| f64::from(points.toward[axis][k])));
            let intensity = spot.intensity(-toward).max_element() as f32;
            points.arriving[k] = intensity / (points.distance[k] * points.distance[k]);
        }
        points
    }

    /// A direction to a light at infinity.
    pub fn at_infinity(sample: &LightSample) -> Self {
        let (strength, colour) = strength_and_colour(sample.radiance_over_pdf);
        let toward = sample.toward.as_vec3();
        Self {
            toward: [[toward.x; N], [toward.y; N], [toward.z; N]],
            distance: [f32::INFINITY; N],
            pdf: [if sample.is_delta { 0.0 } else { sample.pdf as f32 }; N],
            arriving: [strength; N],
            colour,
            places: None,
        }
    }

    #[inline(always)]
    fn at(places: [DVec3; N], colour: Vec3, ray: &Ray, t: &[f32; N]) -> Self {
        let direction = ray.direction.as_vec3();
        let (mut toward, mut distance) = ([[0.0; N]; 3], [0.0; N]);
        for k in 0..N {
            let offset = (places[k] - ray.origin).as_vec3();
            (toward[0][k], toward[1][k], toward[2][k]) = (offset.x, offset.y, offset.z);
        }
        for k in 0..N {
            let x = toward[0][k] - direction.x * t[k];
            let y = toward[1][k] - direction.y * t[k];
            let z = toward[2][k] - direction.z * t[k];
            let length = (x * x + y * y + z * z).sqrt();
            let inverse = 1.0 / length;
            (toward[0][k], toward[1][k], toward[2][k]) = (x * inverse, y * inverse, z * inverse);
            distance[k] = length;
        }
        Self { toward, distance, pdf: [0.0; N], arriving: [0.0; N], colour, places: Some(places) }
    }

    /// What of the light gets through the fog to the places at the distances `t` of `ray`.
    pub fn transmittances(&self, fog: &Fog, ray: &Ray, t: &[f32; N]) -> [f32; N] {
        std::array::from_fn(|k| {
            let origin = ray.at(f64::from(t[k]));
            let (direction, distance) = self.seen_from(k, origin);
            fog.transmittance(&Ray { origin, direction }, distance)
        })
    }

    /// Direction and distance of a point, up to just before it.
    #[inline(always)]
    pub fn seen_from(&self, k: usize, from: DVec3) -> (DVec3, f64) {
        match &self.places {
            Some(places) => {
                let offset = places[k] - from;
                let distance = offset.length();
                let coordinates = from.abs().max_element() + distance;
                let toward = offset / distance;
                (toward, (distance - SHORT * (distance + 0.1 * coordinates)).max(0.0))
            }
            None => {
                let [x, y, z] = &self.toward;
                let toward = Vec3::new(x[k], y[k], z[k]).as_dvec3();
                (toward.normalize(), f64::INFINITY)
            }
        }
    }
}

fn strength_and_colour(light: DVec3) -> (f32, Vec3) {
    let strength = light.max_element();
    let colour = if strength > 0.0 { light / strength } else { DVec3::ZERO };
    (strength as f32, colour.as_vec3())
}

/// The numbers of point `k`: `u` moved on by multiples of the inverse of the plastic number and its square, which spreads
/// them evenly (Roberts 2018, the sequence R₂).
#[inline(always)]
fn spread(u: [f32; 2], k: usize) -> [f64; 2] {
    let moved = |u: f32, step: f64| {
        let u = f64::from(u) + step * k as f64;
        u - u as u32 as f64
    };
    [moved(u[0], 0.754_877_666_246_693), moved(u[1], 0.569_840_290_998_053)]
}
