//! A place on a surface where a path turns.

use glam::{DVec3, DVec4};
use tyndall_lanes::Random;
use tyndall_optics::bsdf::Bsdf;
use tyndall_scene::surface::Presence;
use tyndall_scene::{Channels, Hit, Ray, Scene};

use crate::path_layers::FirstMet;

/// A place on a surface where a path turns, seen by light that arrives along a ray.
#[derive(Debug, Clone)]
pub(crate) struct SurfaceVertex {
    hit: Hit,
    /// The direction of the ray that arrived.
    before: DVec3,
    /// Tangent, bitangent, shading normal.
    frame: [DVec3; 3],
    bsdf: Bsdf,
}

/// How a path goes on from a surface.
#[derive(Debug, Clone, Copy)]
pub(crate) struct SurfaceTurn {
    /// The direction.
    pub direction: DVec3,
    /// f |cos θ| over the density, in each channel.
    pub weight: DVec4,
    /// Density over solid angle, 1/sr; none if only sampling finds the direction.
    pub pdf: Option<f64>,
    /// The part of the weight that is due to refraction and no loss of light.
    pub radiance_scale: f64,
}

impl SurfaceVertex {
    /// The place where a ray in the direction `before` meets a surface.
    pub fn new(scene: &Scene, hit: &Hit, before: DVec3, channels: &Channels) -> Self {
        let bsdf = scene.surfaces.material(hit).bsdf(hit, channels);
        Self { hit: *hit, before, frame: hit.frame(), bsdf }
    }

    /// The place.
    pub fn position(&self) -> DVec3 {
        self.hit.position
    }

    /// What the film is told of the surface, whose albedo is `albedo`.
    pub fn first_met(&self, scene: &Scene, albedo: DVec3) -> FirstMet {
        let object = scene.surfaces.shape(&self.hit).id;
        FirstMet { distance: self.hit.t, albedo, normal: self.hit.shading_normal, object, caught: None }
    }

    /// Whether only the shadows on the surface are wanted.
    pub fn is_shadow_catcher(&self, scene: &Scene) -> bool {
        scene.surfaces.shape(&self.hit).is_shadow_catcher
    }

    /// The surface's reflectance or so, for the film.
    pub fn albedo(&self) -> DVec4 {
        self.bsdf.albedo()
    }

    /// Whether there is no use in looking for lights.
    pub fn is_delta(&self) -> bool {
        self.bsdf.is_delta()
    }

    /// Whether light is only reflected, and into all directions.
    pub fn is_matte(&self) -> bool {
        matches!(self.bsdf, Bsdf::Diffuse { .. } | Bsdf::RoughDiffuse(_))
    }

    /// f |cos θ| towards `direction` in each channel, without mirrors.
    pub fn value(&self, direction: DVec3) -> DVec4 {
        if self.is_two_faced(direction) {
            return DVec4::ZERO;
        }
        self.bsdf.value(self.local(-self.before), self.local(direction))
    }

    /// Density with which paths go on towards `direction`, 1/sr.
    pub fn pdf(&self, direction: DVec3) -> f64 {
        self.bsdf.pdf(self.local(-self.before), self.local(direction))
    }

    /// Draws how the path goes on; `None` if it does not.
    pub fn sample(&self, random: &mut Random) -> Option<SurfaceTurn> {
        self.sample_by(random.f64(), [random.f64(), random.f64()])
    }

    /// The same by these numbers: one that chooses, and two for the direction.
    pub fn sample_by(&self, choice: f64, u: [f64; 2]) -> Option<SurfaceTurn> {
        let sample = self.bsdf.sample(self.local(-self.before), choice, u)?;
        let [x, y, z] = self.frame;
        let direction = (x * sample.wi.x + y * sample.wi.y + z * sample.wi.z).normalize();
        if self.is_two_faced(direction) {
            return None;
        }
        Some(SurfaceTurn {
            direction,
            weight: sample.weight,
            pdf: (!sample.is_delta).then_some(sample.pdf),
            radiance_scale: sample.radiance_scale,
        })
    }

    /// A ray from the surface in `direction`, and the volumes that are present where it begins; `presence` are those
    /// where the path arrived.
    pub fn leave(&self, scene: &Scene, direction: DVec3, presence: &Presence) -> (Ray, Presence) {
        let mut presence = presence.clone();
        let goes_through = direction.dot(self.hit.normal) * self.before.dot(self.hit.normal) > 0.0;
        if goes_through {
            scene.boundaries.cross(&mut presence, &scene.surfaces, &self.hit, direction);
        }
        (self.depart(direction), presence)
    }

    /// A ray from the surface in `direction`, where no volumes begin or end.
    pub fn depart(&self, direction: DVec3) -> Ray {
        Ray { origin: self.hit.leave(direction), direction }
    }

    /// Whether `direction` is on one side of the surface and on the other of the bent one that shading sees. No light goes
    /// there, or it would leak through the surface (Veach 1997, section 5.3).
    fn is_two_faced(&self, direction: DVec3) -> bool {
        direction.dot(self.hit.normal) * direction.dot(self.hit.shading_normal) <= 0.0
    }

    fn local(&self, direction: DVec3) -> DVec3 {
        let [x, y, z] = self.frame;
        DVec3::new(direction.dot(x), direction.dot(y), direction.dot(z))
    }
}
