//! Points of lights as they are seen from places along rays, side by side: `N` places on each of `W` ways.
//!
//! In f32 and from the ray's origin, which is enough for what they bring; the shadow ray to the one that is chosen is made in
//! f64.

use glam::{DVec3, Vec3};
use tyndall_scene::light::{AreaLight, SpotLight};
use tyndall_scene::{Hit, Light, LightSample, Ray};

use super::stretch::Fog;

/// Points of one light on each way.
pub(super) struct Points<const W: usize, const N: usize> {
    /// Unit vectors to them, by component.
    pub toward: [[[f32; W]; N]; 3],
    pub distance: [[f32; W]; N],
    /// Densities over solid angle; 0 if the light is a point.
    pub pdf: [[f32; W]; N],
    /// Radiance over density, or irradiance, of the brightest channel.
    pub arriving: [[f32; W]; N],
    /// The lights' colours: the brightest channel is 1.
    pub colour: [Vec3; W],
    /// The points themselves; nothing at infinity.
    places: [Option<[DVec3; N]>; W],
    /// Of lamps, the normals there.
    normal: [[[f32; W]; N]; 3],
    /// Area of a lamp.
    area: [f32; W],
    /// Whether the light is a point, or a spot light, and has none.
    is_point: [bool; W],
    /// Of a lamp, 1 if its inner side shines too, and 0 otherwise.
    shines_behind: [f32; W],
    /// Radiance or intensity of the brightest channel.
    strength: [f32; W],
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
    // A shining plane, or a deformed sphere: only paths find it.
    if lamp.area() <= 0.0 {
        return 0.0;
    }
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

impl<const W: usize, const N: usize> Points<W, N> {
    /// None on any way yet.
    #[inline(always)]
    pub fn new() -> Self {
        let zero = [[0.0; W]; N];
        Self {
            toward: [zero; 3],
            distance: zero,
            pdf: zero,
            arriving: zero,
            colour: [Vec3::ZERO; W],
            places: [None; W],
            normal: [zero; 3],
            area: [0.0; W],
            is_point: [true; W],
            shines_behind: [0.0; W],
            strength: [0.0; W],
        }
    }

    /// Draws points of this light for way `w`.
    #[inline(always)]
    pub fn set(&mut self, w: usize, light: &Light, u: [f32; 2]) {
        let (mut places, mut brightness) = ([DVec3::ZERO; N], DVec3::ZERO);
        match light {
            Light::Area(lamp) => {
                for (k, place) in places.iter_mut().enumerate() {
                    if let Some(point) = lamp.point(spread(u, k)) {
                        *place = point.position;
                        for axis in 0..3 {
                            self.normal[axis][k][w] = point.normal[axis] as f32;
                        }
                    }
                }
                brightness = lamp.radiance();
                self.area[w] = lamp.area() as f32;
                self.shines_behind[w] = if lamp.is_two_sided() { 1.0 } else { 0.0 };
                self.is_point[w] = false;
            }
            Light::Point(point) => {
                places = [point.position(); N];
                brightness = point.intensity();
            }
            Light::Spot(spot) => {
                places = [spot.position(); N];
                brightness = spot.intensity(spot.axis());
            }
            Light::Constant(_) | Light::Image(_) | Light::Sun(_) | Light::Distant(_) => {}
            Light::Volume(_) => {}
        }
        self.places[w] = Some(places);
        (self.strength[w], self.colour[w]) = strength_and_colour(brightness);
    }

    /// Sees them from the places at the distances `t` of rays.
    #[inline(always)]
    pub fn see(&mut self, rays: &[Ray; W], direction: &[[f32; W]; 3], t: &[[f32; W]; N]) {
        let mut offset = [[[0.0; W]; N]; 3];
        for (w, places) in self.places.iter().enumerate() {
            for (k, place) in places.iter().flatten().enumerate() {
                let from_origin = *place - rays[w].origin;
                for axis in 0..3 {
                    offset[axis][k][w] = from_origin[axis] as f32;
                }
            }
        }
        for k in 0..N {
            for w in 0..W {
                let x = offset[0][k][w] - direction[0][w] * t[k][w];
                let y = offset[1][k][w] - direction[1][w] * t[k][w];
                let z = offset[2][k][w] - direction[2][w] * t[k][w];
                let length = (x * x + y * y + z * z).sqrt();
                let inverse = 1.0 / length;
                let (x, y, z) = (x * inverse, y * inverse, z * inverse);
                let [nx, ny, nz] = [&self.normal[0][k], &self.normal[1][k], &self.normal[2][k]];
                let cos = -(x * nx[w] + y * ny[w] + z * nz[w]);
                let shines = if cos > 0.0 { 1.0 } else { self.shines_behind[w] };
                let squared = length * length;
                let by_area = squared / (cos.abs() * self.area[w]);
                let is_point = self.is_point[w];
                let over = if is_point { squared } else { by_area };
                let strength = if is_point { self.strength[w] } else { self.strength[w] * shines };
                self.pdf[k][w] = if is_point { 0.0 } else { by_area };
                self.arriving[k][w] = strength / over;
                self.distance[k][w] = length;
                (self.toward[0][k][w], self.toward[1][k][w], self.toward[2][k][w]) = (x, y, z);
            }
        }
    }

    /// Corrects on way `w`, along `ray`, what [`see`](Self::see) took for a lamp that is not near, or a point that shines evenly: lamps
    /// that are near, the cones of spots, lights at infinity.
    #[inline(always)]
    pub fn mend(&mut self, w: usize, light: &Light, ray: &Ray, t: &[[f32; W]; N], u: [f32; 2]) {
        match light {
            Light::Area(lamp) => {
                for (k, t) in t.iter().enumerate() {
                    let from = ray.at(f64::from(t[w]));
                    if is_near(lamp, from) {
                        self.draw_from(w, k, from, &lamp.sample(from, spread(u, k)));
                    }
                }
            }
            Light::Point(_) => {}
            Light::Spot(spot) => self.cone(w, spot),
            _ => self.at_infinity(w, &light.sample(ray.origin, u.map(f64::from))),
        }
    }

    /// Takes a sample for the point `k`, as it is seen from `from`.
    #[inline(never)]
    fn draw_from(&mut self, w: usize, k: usize, from: DVec3, sample: &LightSample) {
        for axis in 0..3 {
            self.toward[axis][k][w] = sample.toward[axis] as f32;
        }
        self.distance[k][w] = sample.distance as f32;
        self.pdf[k][w] = sample.pdf as f32;
        self.arriving[k][w] = sample.radiance_over_pdf.max_element() as f32;
        if let Some(places) = &mut self.places[w] {
            places[k] = from + sample.toward * sample.distance;
        }
    }

    #[inline(never)]
    fn cone(&mut self, w: usize, spot: &SpotLight) {
        for k in 0..N {
            let intensity = spot.intensity(-self.toward(w, k).as_dvec3()).max_element() as f32;
            self.arriving[k][w] = intensity / (self.distance[k][w] * self.distance[k][w]);
        }
    }

    #[inline(never)]
    fn at_infinity(&mut self, w: usize, sample: &LightSample) {
        let strength;
        (strength, self.colour[w]) = strength_and_colour(sample.radiance_over_pdf);
        for k in 0..N {
            for axis in 0..3 {
                self.toward[axis][k][w] = sample.toward[axis] as f32;
            }
            self.distance[k][w] = f32::INFINITY;
            self.pdf[k][w] = if sample.is_delta { 0.0 } else { sample.pdf as f32 };
            self.arriving[k][w] = strength;
        }
        self.places[w] = None;
    }

    fn toward(&self, w: usize, k: usize) -> Vec3 {
        Vec3::new(self.toward[0][k][w], self.toward[1][k][w], self.toward[2][k][w])
    }

    /// What of the light gets through the fog to the place at the distance `t` of `ray`, where the fog may end in between.
    #[inline(never)]
    pub fn transmittance(&self, fog: &Fog, ray: &Ray, t: f32, [w, k]: [usize; 2]) -> f32 {
        let origin = ray.at(f64::from(t));
        let (direction, distance) = self.seen_from([w, k], origin);
        fog.transmittance(&Ray { origin, direction }, distance)
    }

    /// Direction and distance of a point, up to just before it.
    #[inline(always)]
    pub fn seen_from(&self, [w, k]: [usize; 2], from: DVec3) -> (DVec3, f64) {
        match &self.places[w] {
            Some(places) => {
                let offset = places[k] - from;
                let distance = offset.length();
                let coordinates = from.abs().max_element() + distance;
                let toward = offset / distance;
                (toward, (distance - SHORT * (distance + 0.1 * coordinates)).max(0.0))
            }
            None => (self.toward(w, k).as_dvec3().normalize(), f64::INFINITY),
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
