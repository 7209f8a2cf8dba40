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
use super::stretch::{Fog, Stretch, transmittances};

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

/// Light that arrives unless something stands in its way.
pub(super) struct Unshadowed {
    pub light: Vec3,
    /// The way to where it comes from.
    pub ray: Ray,
    pub distance: f64,
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
        let mut distances = Distances::<1>::new(stretch.mu_t);
        distances.set(0, self.all[number].place.as_ref(), stretch);
        let transmittance = transmittances(stretch.mu_t, &[[t]]);
        let [[density]] = distances.pdfs(&[[t]], &transmittance);
        let chosen = scene.light_probability(number, stretch.ray.origin);
        let by_way = candidates * f64::from(density) * chosen * light_pdf;
        let by_path = f64::from(stretch.mu_t * transmittance[0][0]) * pdf;
        by_path / (by_way + by_path)
    }
}

/// `W` ways on which light is looked for, side by side, at `N` places each: first [`ask`](Self::ask) for some of them, then
/// [`look`](Self::look) once, then see what was [`found`](Self::found). Those that were not asked for run through the arithmetic,
/// and bring nothing whatever comes out.
pub(super) struct LitWays<const W: usize, const N: usize> {
    /// The light, if any is looked for on the way.
    light: [Option<usize>; W],
    /// With which it was drawn of all lights.
    probability: [f32; W],
    rays: [Ray; W],
    direction: [[f32; W]; 3],
    /// Numbers by which distances are drawn, and points of the light.
    along: [[f32; W]; 2],
    u: [[f32; 2]; W],
    distances: Distances<W>,
    points: Points<W, N>,
    /// Distances of the places.
    t: [[f32; W]; N],
    /// What each place brings.
    strength: [[f32; W]; N],
}

impl<const W: usize, const N: usize> LitWays<W, N> {
    /// None yet.
    #[inline(always)]
    pub fn new(fog: &Fog) -> Self {
        Self {
            light: [None; W],
            probability: [1.0; W],
            rays: [Ray { origin: DVec3::ZERO, direction: DVec3::Z }; W],
            direction: [[0.0; W]; 3],
            along: [[0.0; W]; 2],
            u: [[0.0; 2]; W],
            distances: Distances::new(fog.mu_t),
            points: Points::new(),
            t: [[0.0; W]; N],
            strength: [[0.0; W]; N],
        }
    }

    /// Looks for light of one lamp on way `w`.
    #[inline(always)]
    pub fn ask(
        &mut self,
        w: usize,
        (scene, lamps): (&Scene, &Lamps),
        stretch: &Stretch,
        [along, u]: [[f32; 2]; 2],
        random: &mut Random,
    ) {
        if stretch.length <= 0.0 {
            return;
        }
        let Some((number, probability)) = scene.choose_light(stretch.ray.origin, random.f64()) else {
            return;
        };
        self.light[w] = Some(number);
        self.probability[w] = probability as f32;
        self.rays[w] = stretch.ray;
        for axis in 0..3 {
            self.direction[axis][w] = stretch.ray.direction[axis] as f32;
        }
        (self.along[0][w], self.along[1][w]) = (along[0], along[1]);
        self.u[w] = u;
        self.distances.set(w, lamps.all[number].place.as_ref(), stretch);
        self.points.set(w, &scene.lights[number], u);
    }

    /// Finds out what each place would bring.
    #[inline(always)]
    pub fn look(&mut self, (scene, lamps): (&Scene, &Lamps), fog: &Fog) {
        let t = self.distances.draw::<N>(&self.along);
        self.points.see(&self.rays, &self.direction, &t);
        for w in 0..W {
            if let Some(number) = self.light[w] {
                self.points.mend(w, &scene.lights[number], &self.rays[w], &t, self.u[w]);
            }
        }
        let phase = fog.phase.values(&self.direction, &self.points.toward);
        let mut to_light = transmittances(fog.mu_t, &self.points.distance);
        for w in 0..W {
            if self.light[w].is_some_and(|number| !lamps.all[number].is_in_fog) {
                for k in 0..N {
                    to_light[k][w] = self.points.transmittance(fog, &self.rays[w], t[k][w], [w, k]);
                }
            }
        }
        let to_origin = transmittances(fog.mu_t, &t);
        let density = self.distances.pdfs(&t, &to_origin);
        for k in 0..N {
            for w in 0..W {
                let by_distance = N as f32 * self.probability[w] * density[k][w];
                let by_way = by_distance * self.points.pdf[k][w];
                let by_path = fog.mu_t * to_origin[k][w] * phase[k][w];
                // Over the density of distances alone: that of the point is in what arrives from there.
                let weight = if self.points.pdf[k][w] > 0.0 { by_way / (by_way + by_path) } else { 1.0 };
                let brought = self.points.arriving[k][w] * by_path * to_light[k][w] * weight / by_distance;
                let is_some = (brought > 0.0) & (brought < f32::INFINITY);
                self.strength[k][w] = if is_some { brought } else { 0.0 };
            }
        }
        self.t = t;
    }

    /// What way `w` has brought, unless something stands in its way.
    #[inline(always)]
    pub fn found(&self, w: usize, fog: &Fog, random: &mut Random) -> Option<Unshadowed> {
        self.light[w]?;
        let mut strength = [0.0; N];
        for (one, ways) in strength.iter_mut().zip(&self.strength) {
            *one = ways[w];
        }
        let all: f32 = strength.iter().sum();
        let chosen = choose(&strength, all, random.f32())?;
        let origin = self.rays[w].at(f64::from(self.t[chosen][w]));
        let (direction, distance) = self.points.seen_from([w, chosen], origin);
        let light = fog.albedo * self.points.colour[w] * all;
        Some(Unshadowed { light, ray: Ray { origin, direction }, distance })
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
