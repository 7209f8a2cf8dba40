//! The part of a ray that runs through the homogeneous medium, and Beer's law on it: T(t) = exp(−μt (t − start)).

use glam::{DVec3, Vec3};
use tyndall_lanes::Random;
use tyndall_scene::{Density, Ray, Volume};

use crate::fast::volume::Phase;

/// The medium.
pub(super) struct Fog<'a> {
    pub volume: &'a Volume,
    pub albedo: Vec3,
    pub phase: Phase<'a>,
}

/// A part of a ray through it. Empty where start = end.
#[derive(Debug, Clone, Copy)]
pub(super) struct Stretch {
    /// Distances along the ray.
    pub start: f64,
    pub end: f64,
    /// Extinction coefficient μt.
    pub mu_t: f64,
    /// T(end).
    through: f32,
}

impl<'a> Fog<'a> {
    pub fn new(volume: &'a Volume) -> Self {
        let medium = &volume.medium;
        Self { volume, albedo: medium.albedo.as_vec3(), phase: Phase::new(&medium.phase_function) }
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
}

impl Stretch {
    /// The stretch of `ray` in the fog, if there is any, before the distance `end`.
    #[inline(always)]
    pub fn new(fog: Option<&Fog>, ray: &Ray, end: f64) -> Self {
        const EMPTY: Stretch = Stretch { start: 0.0, end: 0.0, mu_t: 0.0, through: 1.0 };
        let Some(fog) = fog else { return EMPTY };
        let Some((start, end)) = fog.volume.interval(&fog.volume.local_ray(ray), (0.0, end)) else {
            return EMPTY;
        };
        let mu_t = fog.volume.medium.mu_t;
        Self { start, end, mu_t, through: tyndall_lanes::exp((mu_t * (start - end)) as f32) }
    }

    /// Transmittance of the whole stretch.
    #[inline(always)]
    pub fn through(&self) -> f32 {
        self.through
    }

    /// Transmittance from the ray's origin to the distance `t` in the stretch.
    #[inline(always)]
    pub fn transmittance(&self, t: f64) -> f32 {
        tyndall_lanes::exp((self.mu_t * (self.start - t)) as f32)
    }

    /// The distance of a collision, drawn with density μt T; `None` if the ray gets through.
    #[inline(always)]
    pub fn collision(&self, random: &mut Random) -> Option<f64> {
        if self.end <= self.start {
            return None;
        }
        let t = self.start + f64::from(random.exponential()) / self.mu_t;
        (t < self.end).then_some(t)
    }
}
