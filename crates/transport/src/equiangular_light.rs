//! Lights nearby, sampled along each stretch of a path beside next-event estimation at its collision.
//!
//! In-scattered light of a point light along a ray is ∫ μs T f_p I T′/d² dt. The collision samples it with density
//! p_d = P′ μt T, a second, equiangular place with p_e, which takes up 1/d²; P and P′ are the probabilities with which the
//! light is chosen for the stretch and at the collision. Of a lamp with a surface both take a uniform point, to which the
//! same applies; paths that hit the lamp are a third way, of density p_h. The balance heuristic joins them, in the measure
//! of distance along the ray times solid angle (or alone, for lights that are points):
//!
//!   w_e = p_e/(p_e + p_d + p_h) and so on.
//!
//! They add up to 1 at every t, so that the sum is unbiased whatever the densities really are (Veach 1997, section 9.2);
//! here they are exact to rounding, with T by regular tracking. A sample is at most of the order of 1/D, D being the
//! distance of the light from the ray, in place of 1/d²: the variance of light scattered once towards the camera is finite.
//! (That of light scattered again near the light still grows as the logarithm of the number of samples, as D is random
//! there: Kalos 1963.) Source: Kulla & Fajardo 2012.

use glam::DVec3;
use tyndall_lanes::Random;
use tyndall_scene::{Light, LightSample, Ray, Scene};

use crate::along_ray::{AlongRay, LightBeside, Lookups};
use crate::distance::Equiangular;
use crate::estimators::Estimators;
use crate::way::Way;

/// A stretch of a path that crosses media.
pub(crate) struct LitSegment<'a> {
    ray: Ray,
    along: AlongRay<'a>,
    way: Way,
}

/// How a place of a light is found from a distance along the ray.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Found {
    /// Number of the light.
    pub light: usize,
    /// Where on the light.
    pub place: DVec3,
    /// Density of the place over solid angle, if it is uniform on a lamp, 1/sr; 1 for points.
    pub place_pdf: f64,
    /// The same by scattering; 0 for points, which no path hits.
    pub path_pdf: f64,
}

impl<'a> LitSegment<'a> {
    /// The stretch along the way of `ray`; none if there are no media.
    pub fn new(scene: &'a Scene, ray: &Ray, way: &Way) -> Option<Self> {
        let along = AlongRay::through_spans(&scene.volumes, &way.spans, ray)?;
        Some(Self { ray: *ray, along, way: way.clone() })
    }

    /// Whether lights of this kind are sampled along stretches.
    pub fn samples(light: &Light) -> bool {
        matches!(light, Light::Point(_) | Light::Spot(_) | Light::Area(_))
    }

    /// Weight of next-event estimation at the collision at the distance `t`.
    pub fn collision_weight(&self, scene: &Scene, found: &Found, t: f64) -> f64 {
        let [by_segment, by_light, by_path] = self.densities(scene, found, t);
        by_light / (by_segment + by_light + by_path)
    }

    /// Weight of a path that scatters at the distance `t` and then hits the lamp.
    pub fn path_weight(&self, scene: &Scene, found: &Found, t: f64) -> f64 {
        let [by_segment, by_light, by_path] = self.densities(scene, found, t);
        by_path / (by_segment + by_light + by_path)
    }

    /// The light that next-event estimation draws from a collision on the stretch.
    pub fn sample(light: &Light, from: DVec3, u: [f64; 2]) -> LightSample {
        match light {
            Light::Area(lamp) => match lamp.point(u) {
                Some(point) => lamp.see(from, &point),
                None => light.sample(from, u),
            },
            _ => light.sample(from, u),
        }
    }

    /// The share w_e of the light of one lamp that is scattered once, along this ray, towards its origin.
    pub fn in_scattered(&self, scene: &Scene, estimators: Estimators, random: &mut Random) -> DVec3 {
        let Some((number, _)) = scene.choose_light(self.ray.origin, random.f64()) else {
            return DVec3::ZERO;
        };
        let light = &scene.lights[number];
        let u = [random.f64(), random.f64()];
        let (place, point) = match light {
            Light::Point(point) => (point.position(), None),
            Light::Spot(spot) => (spot.position(), None),
            Light::Area(lamp) => match lamp.point(u) {
                Some(point) => (point.position, Some((lamp, point))),
                None => return DVec3::ZERO,
            },
            _ => return DVec3::ZERO,
        };
        let Some(distribution) = self.distribution(place) else { return DVec3::ZERO };
        let t = distribution.sample(random.f64());
        let collision = self.collision_density(t);
        if collision <= 0.0 {
            return DVec3::ZERO;
        }
        let volume = &scene.volumes[self.along.volume_at(t, random.f64())];
        let position = self.ray.at(t);
        let sample = match &point {
            Some((lamp, point)) => lamp.see(position, point),
            None => light.sample(position, u),
        };
        if sample.radiance_over_pdf == DVec3::ZERO {
            return DVec3::ZERO;
        }
        let phase = volume.medium.phase_function.value(self.ray.direction, sample.toward);
        let (place_pdf, path_pdf) = if sample.is_delta { (1.0, 0.0) } else { (sample.pdf, phase) };
        let found = Found { light: number, place, place_pdf, path_pdf };
        let [by_segment, by_light, by_path] = self.densities(scene, &found, t);
        let shadow_ray = Ray { origin: position, direction: sample.toward };
        let presence = self.way.presence_at(scene, self.ray.direction, t);
        let Some(way) = Way::connect(scene, &shadow_ray, sample.distance, &presence, random) else {
            return DVec3::ZERO;
        };
        let transmittance = estimators.transmittance(scene, &shadow_ray, &way, random);
        // μs T f_p L T′ over the density of this way, times its weight.
        let weighted =
            volume.albedo_at(position) * (collision * place_pdf / (by_segment + by_light + by_path));
        weighted * sample.radiance_over_pdf * (phase * transmittance)
    }

    fn distribution(&self, place: DVec3) -> Option<Equiangular> {
        Equiangular::new(LightBeside::new(&self.ray, place), (self.along.start(), self.along.end()))
    }

    /// μt T: density of collisions at the distance `t`.
    fn collision_density(&self, t: f64) -> f64 {
        let lookups = &mut Lookups::default();
        self.along.mu_t(t, lookups) * libm::exp(-self.along.thickness(t, lookups))
    }

    /// Densities with which the three ways find the light from the distance `t`: a place along the stretch, next-event
    /// estimation from a collision, scattering at it.
    fn densities(&self, scene: &Scene, found: &Found, t: f64) -> [f64; 3] {
        let collision = self.collision_density(t);
        let chosen = scene.light_probability(found.light, self.ray.origin);
        let along = self.distribution(found.place).map_or(0.0, |distribution| distribution.pdf(t));
        let chosen_there = scene.light_probability(found.light, self.ray.at(t));
        [
            chosen * along * found.place_pdf,
            collision * chosen_there * found.place_pdf,
            collision * found.path_pdf,
        ]
    }
}
