//! A metal: a mirror, or a rough surface of mirrors as microfacets, on both sides.
//!
//!   f = F(ω·h) D(h) G2(ω, ω′)/(4 |cos θ cos θ′|),   h = (ω + ω′)/|ω + ω′|   (Torrance & Sparrow 1967)
//!
//! with [`fresnel`]'s F in each channel and [`Ggx`]'s D and G2. Light reflected more than once among the
//! facets is lost.

use glam::{DVec3, DVec4};

use super::ggx::Ggx;
use super::{BsdfSample, fresnel};

/// A metal at a point.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Conductor {
    /// Real part of the refractive index over that of the outside.
    pub eta: DVec4,
    /// Imaginary part of it.
    pub k: DVec4,
    /// Factor on what is reflected; 0 in lanes that are no channel.
    pub tint: DVec4,
    /// Its microfacets; none if it is a mirror.
    pub facets: Option<Ggx>,
}

impl Conductor {
    pub(super) fn sample(&self, wo: DVec3, u: [f64; 2]) -> Option<BsdfSample> {
        if wo.z == 0.0 {
            return None;
        }
        let Some(facets) = &self.facets else {
            let wi = DVec3::new(-wo.x, -wo.y, wo.z);
            return Some(BsdfSample::delta(wi, self.reflectance(wo.z.abs())));
        };
        let wi = facets.sample_mirror(wo, u)?;
        let mirrored = facets.mirror(wo, wi)?;
        let weight = self.reflectance(mirrored.cos) * (mirrored.value / mirrored.pdf);
        BsdfSample::if_sound(wi, weight, mirrored.pdf, 1.0)
    }

    pub(super) fn value(&self, wo: DVec3, wi: DVec3) -> DVec4 {
        let mirrored = self.facets.as_ref().and_then(|facets| facets.mirror(wo, wi));
        mirrored.map_or(DVec4::ZERO, |mirrored| self.reflectance(mirrored.cos) * mirrored.value)
    }

    pub(super) fn pdf(&self, wo: DVec3, wi: DVec3) -> f64 {
        let mirrored = self.facets.as_ref().and_then(|facets| facets.mirror(wo, wi));
        mirrored.map_or(0.0, |mirrored| mirrored.pdf)
    }

    /// That at normal incidence.
    pub(super) fn albedo(&self) -> DVec4 {
        self.reflectance(1.0)
    }

    fn reflectance(&self, cos: f64) -> DVec4 {
        self.tint * fresnel::conductor_channels(cos, self.eta, self.k)
    }
}
