//! Point lights sampled along each stretch of a path, beside next-event estimation at its collision.
//!
//! In-scattered light of a point light along a ray is ∫ μs T f_p I T′/d² dt. The collision samples it with density
//! p_d = μt T, a second, equiangular place with p_e, which takes up 1/d². The balance heuristic joins them:
//!
//!   w_e(t) = p_e/(p_e + p_d),   w_d(t) = p_d/(p_e + p_d)
//!
//! They add up to 1 at every t, so that the sum is unbiased whatever the two densities really are (Veach 1997, section 9.2);
//! here they are exact to rounding, with T by regular tracking. A sample is at most of the order of 1/D, D being the
//! distance of the light from the ray, in place of 1/d²: the variance of light scattered once towards the camera is finite.
//! (That of light scattered again near the light still grows as the logarithm of the number of samples, as D is random
//! there: Kalos 1963.) Source: Kulla & Fajardo 2012.

use glam::DVec3;
use tyndall_lanes::Random;
use tyndall_scene::light::PointLight;
use tyndall_scene::{Light, Ray, Scene};

use crate::along_ray::{AlongRay, LightBeside, Lookups};
use crate::distance::Equiangular;
use crate::estimators::Estimators;

/// A stretch of a path that crosses media.
pub(crate) struct LitSegment<'a> {
    ray: Ray,
    along: AlongRay<'a>,
}

impl<'a> LitSegment<'a> {
    pub fn new(scene: &'a Scene, ray: &Ray) -> Option<Self> {
        Some(Self { ray: *ray, along: AlongRay::through(&scene.volumes, ray, f64::INFINITY)? })
    }

    fn distribution(&self, light: &PointLight) -> Option<Equiangular> {
        let beside = LightBeside::new(&self.ray, light.position());
        Equiangular::new(beside, (self.along.start(), self.along.end()))
    }

    /// p_d: density of collisions at the distance `t`.
    fn collision_density(&self, t: f64) -> f64 {
        let lookups = &mut Lookups::default();
        self.along.mu_t(t, lookups) * (-self.along.thickness(t, lookups)).exp()
    }

    /// w_d: the share of next-event estimation towards `light` from a collision at the distance `t`.
    pub fn collision_weight(&self, light: &PointLight, t: f64) -> f64 {
        let Some(distribution) = self.distribution(light) else { return 1.0 };
        let collision = self.collision_density(t);
        collision / (collision + distribution.pdf(t))
    }

    /// The share w_e of the light of a point light that is scattered once, along this ray, towards its origin.
    pub fn in_scattered(&self, scene: &Scene, estimators: Estimators, random: &mut Random) -> DVec3 {
        let Some((number, probability)) = scene.choose_light(self.ray.origin, random.f64()) else {
            return DVec3::ZERO;
        };
        let Light::Point(light) = &scene.lights[number] else { return DVec3::ZERO };
        let Some(distribution) = self.distribution(light) else { return DVec3::ZERO };
        let t = distribution.sample(random.f64());
        let collision = self.collision_density(t);
        if collision <= 0.0 {
            return DVec3::ZERO;
        }
        let volume = &scene.volumes[self.along.volume_at(t, random.f64())];
        let position = self.ray.at(t);
        let sample = Light::Point(*light).sample(position, [0.0; 2]);
        let phase = volume.medium.phase_function.value(self.ray.direction, sample.toward);
        let shadow_ray = Ray { origin: position, direction: sample.toward };
        let transmittance = estimators.transmittance(scene, &shadow_ray, sample.distance, random);
        // μs T/p_e · w_e
        let weighted = volume.albedo_at(position) * (collision / (collision + distribution.pdf(t)));
        weighted * sample.radiance_over_pdf * (phase * transmittance / probability)
    }
}
