//! The part of a ray that runs through the homogeneous medium, and Beer's law on it: T(t) = exp(−μt t).
//!
//! Distances are measured from where the ray enters the medium. So f32 is enough for them, however far away that is.

use glam::{DVec3, Vec3};
use tyndall_scene::{Density, Ray, Volume};

use crate::fast::volume::Phase;

/// The medium.
pub(super) struct Fog<'a> {
    volume: &'a Volume,
    pub mu_t: f32,
    pub albedo: Vec3,
    pub phase: Phase<'a>,
}

/// A part of a ray through it.
#[derive(Debug, Clone, Copy)]
pub(super) struct Stretch {
    /// From where it enters the medium.
    pub ray: Ray,
    /// Distance of that place from the origin of the whole ray.
    pub start: f64,
    /// Length; 0 if the ray misses the medium.
    pub length: f32,
    /// Extinction coefficient μt.
    pub mu_t: f32,
    /// T of the whole length.
    pub through: f32,
}

impl<'a> Fog<'a> {
    pub fn new(volume: &'a Volume) -> Self {
        let medium = &volume.medium;
        let (albedo, phase) = (medium.albedo.as_vec3(), Phase::new(&medium.phase_function));
        Self { volume, mu_t: medium.mu_t as f32, albedo, phase }
    }

    /// Whether the box between two corners is in the medium, which is convex.
    pub fn holds(&self, [min, max]: [DVec3; 2]) -> bool {
        (0..8).all(|corner| {
            let place = DVec3::from_array(std::array::from_fn(|axis| [min, max][(corner >> axis) & 1][axis]));
            let local = self.volume.world_to_local.transform_point3(place);
            match &self.volume.density {
                Density::Everywhere => true,
                Density::Box { min, max } => local.cmpge(*min).all() && local.cmple(*max).all(),
                Density::Sphere => local.length_squared() <= 1.0,
                Density::Slab { bottom, top } => (*bottom..=*top).contains(&local.y),
                Density::Atmosphere { .. } | Density::Grid(_) => false,
            }
        })
    }

    /// The distances between which `ray` is in the medium before the distance `end`.
    #[inline(always)]
    fn interval(&self, ray: &Ray, end: f64) -> Option<(f64, f64)> {
        // The medium is convex: between two places in it a ray does not leave it. A ray without end has no second place.
        if let Density::Box { min, max } = &self.volume.density
            && end > 0.0
            && end.is_finite()
        {
            let to_local = &self.volume.world_to_local;
            let (from, to) = (to_local.transform_point3(ray.origin), to_local.transform_point3(ray.at(end)));
            let [least, greatest] = [from.min(to), from.max(to)];
            let is_inside = least.x > min.x
                && least.y > min.y
                && least.z > min.z
                && greatest.x < max.x
                && greatest.y < max.y
                && greatest.z < max.z;
            if is_inside {
                return Some((0.0, end));
            }
        }
        self.volume.interval(&self.volume.local_ray(ray), (0.0, end))
    }

    /// Transmittance of `ray` up to the distance `end`.
    #[inline(always)]
    pub fn transmittance(&self, ray: &Ray, end: f64) -> f32 {
        self.interval(ray, end).map_or(1.0, |(start, end)| beer(self.mu_t, (end - start) as f32))
    }
}

impl Stretch {
    /// The stretch of `ray` in the fog, if there is any, before the distance `end`.
    #[inline(always)]
    pub fn new(fog: Option<&Fog>, ray: &Ray, end: f64) -> Self {
        let empty = Self { ray: *ray, start: 0.0, length: 0.0, mu_t: 0.0, through: 1.0 };
        let Some(fog) = fog else { return empty };
        let Some((start, end)) = fog.interval(ray, end) else { return empty };
        let (length, mu_t) = ((end - start) as f32, fog.mu_t);
        let ray = Ray { origin: ray.at(start), direction: ray.direction };
        Self { ray, start, length, mu_t, through: beer(mu_t, length) }
    }

    /// The distance of a collision, for `u` uniform in (0, 1], drawn with density μt T; `None` if the ray gets through.
    #[inline(always)]
    pub fn collision(&self, u: f32) -> Option<f32> {
        if self.length <= 0.0 {
            return None;
        }
        let t = -tyndall_lanes::ln(u) / self.mu_t;
        (t < self.length).then_some(t)
    }
}

/// T = exp(−μt t) at each distance.
#[inline(always)]
pub(super) fn transmittances<const W: usize, const N: usize>(mu_t: f32, t: &[[f32; W]; N]) -> [[f32; W]; N] {
    let mut transmittance = [[0.0; W]; N];
    for k in 0..N {
        for w in 0..W {
            transmittance[k][w] = beer(mu_t, t[k][w]);
        }
    }
    transmittance
}

/// exp(−μt t)
#[inline(always)]
fn beer(mu_t: f32, t: f32) -> f32 {
    tyndall_lanes::exp(-mu_t * t)
}
