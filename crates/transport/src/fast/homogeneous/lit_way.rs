//! Light that is scattered once, on a ray's way through the medium, towards the ray's origin:
//!
//!   ∫ μs T(t) ∫ f_p(ω,ω′) V T′ Le cos θ/d² dA dt
//!
//! over [distances](super::distances) t and points of a lamp, estimated from a few stratified pairs of them. The integrand
//! but for the visibility V costs little; so V is asked for once, of a pair drawn in proportion to it, which stands for all
//! (Talbot, Cline & Egbert 2005, "Importance resampling for global illumination"). Unbiased. Paths that scatter and then hit
//! the lamp are another way to find the same light; the balance heuristic (Veach 1997, section 9.2) joins both by their
//! densities in distance and solid angle.

use glam::{DVec3, Vec3};
use tyndall_lanes::Random;
use tyndall_scene::{Light, LightSample, Ray, Scene};

use super::distances::{Distances, Place};
use super::stretch::{Fog, Stretch};

/// Pairs of distances and points that are looked at.
const CANDIDATES: usize = 4;

/// s² of a lamp over its area.
const SOFTNESS: f64 = 0.1;

/// How each light of the scene is looked for along rays.
pub(super) struct Lamps(Vec<Lamp>);

struct Lamp {
    /// Where it is; none at infinity.
    place: Option<Place>,
    /// Whether the medium fills all of the way from a place in it to the lamp.
    is_in_fog: bool,
}

/// What a pair may bring.
#[derive(Clone, Copy)]
struct Candidate {
    t: f64,
    toward: DVec3,
    distance: f64,
    colour: Vec3,
    strength: f32,
}

impl Lamps {
    pub fn new(scene: &Scene, fog: Option<&Fog>) -> Self {
        let lamp = |light: &Light| {
            let bounds = match light {
                Light::Point(point) => [point.position(); 2],
                Light::Spot(spot) => [spot.position(); 2],
                Light::Area(lamp) if lamp.area() > 0.0 => {
                    let empty = [DVec3::INFINITY, DVec3::NEG_INFINITY];
                    lamp.primitives().iter().fold(empty, |[a, b], primitive| {
                        let [min, max] = primitive.bounds();
                        [a.min(min), b.max(max)]
                    })
                }
                _ => return Lamp { place: None, is_in_fog: false },
            };
            let softening = match light {
                Light::Area(lamp) => lamp.area() * SOFTNESS,
                _ => 0.0,
            };
            let place = Some(Place { center: (bounds[0] + bounds[1]) * 0.5, softening });
            Lamp { place, is_in_fog: fog.is_some_and(|fog| fog.holds(bounds)) }
        };
        Self(scene.lights.iter().map(lamp).collect())
    }

    /// The light of one lamp that is scattered once on the stretch of `ray`.
    #[inline(always)]
    pub fn in_scattered(
        &self,
        scene: &Scene,
        fog: &Fog,
        stretch: &Stretch,
        ray: &Ray,
        random: &mut Random,
    ) -> Vec3 {
        if stretch.end <= stretch.start {
            return Vec3::ZERO;
        }
        let Some((number, probability)) = scene.choose_light(ray.origin, random.f64()) else {
            return Vec3::ZERO;
        };
        let (light, lamp) = (&scene.lights[number], &self.0[number]);
        let distances = Distances::new(lamp.place.as_ref(), ray, stretch);
        let before = ray.direction.as_vec3();
        let u_distance = random.f32x2();
        let u_light = random.f32x2();
        let count = CANDIDATES as f32;

        let candidate = |k: usize| {
            let t = distances.draw(k, CANDIDATES, u_distance);
            let position = ray.at(t);
            let sample = point_of(light, position, spread(u_light, k));
            let phase = fog.phase.value(before, sample.toward.as_vec3());
            let collisions = (stretch.mu_t as f32) * stretch.transmittance(t);
            let density = distances.pdf(t) as f32 * probability as f32;
            let weight = if sample.is_delta {
                1.0
            } else {
                let by_way = count * density * sample.pdf as f32;
                by_way / (by_way + collisions * phase)
            };
            let to_lamp = if lamp.is_in_fog {
                tyndall_lanes::exp((-stretch.mu_t * sample.distance) as f32)
            } else {
                let shadow_ray = Ray { origin: position, direction: sample.toward };
                Stretch::new(Some(fog), &shadow_ray, sample.distance).through()
            };
            let factor = collisions * phase * weight * to_lamp / (count * density);
            let colour = sample.radiance_over_pdf.as_vec3() * factor;
            let strength = colour.max_element();
            let strength = if strength > 0.0 && strength.is_finite() { strength } else { 0.0 };
            Candidate { t, toward: sample.toward, distance: sample.distance, colour, strength }
        };
        let mut chosen = candidate(0);
        let mut all = chosen.strength;
        let mut u = random.f32();
        for k in 1..CANDIDATES {
            let next = candidate(k);
            all += next.strength;
            // A reservoir of one; what decides for it or against it leaves a number as good as new.
            let share = if all > 0.0 { next.strength / all } else { 0.0 };
            if u < share {
                u /= share;
                chosen = next;
            } else {
                u = (u - share) / (1.0 - share);
            }
        }
        if all <= 0.0 || chosen.strength <= 0.0 {
            return Vec3::ZERO;
        }
        let shadow_ray = Ray { origin: ray.at(chosen.t), direction: chosen.toward };
        if scene.surfaces.stand_in(&shadow_ray, chosen.distance) {
            return Vec3::ZERO;
        }
        fog.albedo * chosen.colour * (all / chosen.strength)
    }

    /// Weight of a path that collided at the distance `t` of a way, went on with the density `pdf` over solid angle and found
    /// the light of this number, of which the way's points have the density `light_pdf`.
    #[inline(never)]
    pub fn path_weight(
        &self,
        scene: &Scene,
        number: usize,
        (ray, stretch): (&Ray, &Stretch),
        t: f64,
        [pdf, light_pdf]: [f64; 2],
    ) -> f64 {
        let distances = Distances::new(self.0[number].place.as_ref(), ray, stretch);
        let density = distances.pdf(t) * scene.light_probability(number, ray.origin);
        let by_way = CANDIDATES as f64 * density * light_pdf;
        let by_path = stretch.mu_t * f64::from(stretch.transmittance(t)) * pdf;
        by_path / (by_way + by_path)
    }
}

/// A point of the light, uniform by area if it is a lamp, as it is seen from `from`.
#[inline(always)]
fn point_of(light: &Light, from: DVec3, u: [f64; 2]) -> LightSample {
    match light {
        Light::Area(lamp) => match lamp.point(u) {
            Some(point) => lamp.see(from, &point),
            None => light.sample(from, u),
        },
        _ => light.sample(from, u),
    }
}

/// The numbers of candidate `k`: `u` moved on by multiples of the inverse of the plastic number and its square, which spreads
/// them evenly (Roberts 2018, the sequence R₂).
#[inline(always)]
fn spread(u: [f32; 2], k: usize) -> [f64; 2] {
    let moved = |u: f32, step: f64| {
        let u = f64::from(u) + step * k as f64;
        u - u.floor()
    };
    [moved(u[0], 0.754_877_666_246_693), moved(u[1], 0.569_840_290_998_053)]
}
