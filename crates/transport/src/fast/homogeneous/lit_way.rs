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
use tyndall_scene::{Light, Ray, Scene};

use super::aim::Targets;
use super::distances::{Distances, Place};
use super::points::Points;
use super::stretch::{Fog, Stretch};

/// s² of a lamp over its area.
const SOFTNESS: f64 = 0.1;

/// How each light of the scene is looked for along rays.
pub(super) struct Lamps {
    all: Vec<Lamp>,
    pub targets: Targets,
}

struct Lamp {
    /// Where it is; none at infinity.
    place: Option<Place>,
    /// Whether the medium fills all of the way from a place in it to the lamp.
    is_in_fog: bool,
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
        let all: Vec<Lamp> = scene.lights.iter().map(lamp).collect();
        let places = all.iter().zip(&scene.light_probabilities);
        let places: Vec<(Place, f64)> =
            places.filter_map(|(lamp, probability)| Some((lamp.place?, *probability))).collect();
        Self { all, targets: Targets::new(&places, fog.is_some()) }
    }

    /// The light of one lamp that is scattered once on the stretch of `ray`.
    #[inline(always)]
    pub fn in_scattered<const N: usize>(
        &self,
        scene: &Scene,
        fog: &Fog,
        stretch: &Stretch,
        [along, u]: [[f32; 2]; 2],
        random: &mut Random,
    ) -> Vec3 {
        let ray = &stretch.ray;
        if stretch.length <= 0.0 {
            return Vec3::ZERO;
        }
        let Some((number, probability)) = scene.choose_light(ray.origin, random.f64()) else {
            return Vec3::ZERO;
        };
        let light = &scene.lights[number];
        let lamp = &self.all[number];
        let distances = Distances::new(lamp.place.as_ref(), stretch);
        let t = distances.draw::<N>(along);
        let points = match light {
            Light::Area(area) => Points::of_lamp(area, ray, &t, u),
            Light::Point(point) => Points::of_point(point.position(), point.intensity(), ray, &t),
            Light::Spot(spot) => Points::of_spot(spot, ray, &t),
            _ => Points::at_infinity(&light.sample(ray.origin, u.map(f64::from))),
        };
        let phase = fog.phase.values(ray.direction.as_vec3(), &points.toward);
        let to_light = if lamp.is_in_fog {
            stretch.transmittances(&points.distance)
        } else {
            points.transmittances(fog, ray, &t)
        };
        let to_origin = stretch.transmittances(&t);
        let density = distances.pdfs(&t, &to_origin);
        let (count, probability) = (N as f32, probability as f32);
        let mut strength = [0.0; N];
        for k in 0..N {
            let by_way = count * probability * density[k] * points.pdf[k];
            let by_path = stretch.mu_t * to_origin[k] * phase[k];
            // Over the density of distances alone: that of the point is in what arrives from there.
            let weight = if points.pdf[k] > 0.0 { by_way / (by_way + by_path) } else { 1.0 };
            let brought =
                points.arriving[k] * by_path * to_light[k] * weight / (count * probability * density[k]);
            strength[k] = if brought > 0.0 && brought < f32::INFINITY { brought } else { 0.0 };
        }
        let all: f32 = strength.iter().sum();
        let Some(chosen) = choose(&strength, all, random.f32()) else { return Vec3::ZERO };
        let origin = ray.at(f64::from(t[chosen]));
        let (toward, distance) = points.seen_from(chosen, origin);
        if scene.surfaces.stand_in(&Ray { origin, direction: toward }, distance) {
            return Vec3::ZERO;
        }
        fog.albedo * points.colour * all
    }

    /// Weight of a path that collided at the distance `t` of a way, went on with the density `pdf` over solid angle and found
    /// the light of this number, of which the way's points have the density `light_pdf`.
    #[inline(never)]
    pub fn path_weight(
        &self,
        scene: &Scene,
        number: usize,
        stretch: &Stretch,
        t: f32,
        [pdf, light_pdf, candidates]: [f64; 3],
    ) -> f64 {
        let distances = Distances::new(self.all[number].place.as_ref(), stretch);
        let transmittance = stretch.transmittances(&[t]);
        let [density] = distances.pdfs(&[t], &transmittance);
        let chosen = scene.light_probability(number, stretch.ray.origin);
        let by_way = candidates * f64::from(density) * chosen * light_pdf;
        let by_path = f64::from(stretch.mu_t * transmittance[0]) * pdf;
        by_path / (by_way + by_path)
    }
}

/// A number in proportion to the strengths, whose sum is `all`; `None` if that is 0.
#[inline(always)]
fn choose<const N: usize>(strength: &[f32; N], all: f32, u: f32) -> Option<usize> {
    let (mut rest, mut chosen) = (u * all, None);
    for (k, &strength) in strength.iter().enumerate() {
        if strength > 0.0 {
            chosen = Some(k);
            if rest < strength {
                break;
            }
            rest -= strength;
        }
    }
    chosen
}
