//! The boundary of glass or water: reflects and refracts, smooth or with microfacets.
//!
//! Smooth: the fraction F ([`fresnel`]) is reflected and 1 − F refracted. Rough (Walter et al. 2007, eqs. 20 and 21), with
//! η = (index on the side of ω′)/(that on the side of ω):
//!
//!   f_r = F D(h) G2/(4 |cos θ cos θ′|),                                    h ∝ ω + ω′,
//!   f_t = (1 − F) D(h) G2 |ω·h ω′·h|/(|cos θ cos θ′| (ω·h + η ω′·h)²),      h ∝ ω + η ω′.
//!
//! ω points to where radiance goes and ω′ to where it comes from: as what stays the same in refraction is the radiance
//! over the squared index, η² f_t(ω, ω′) = f_t(ω′, ω), and smooth refraction multiplies radiance by (1 − F)/η². F is that
//! of [`fresnel`], D and G2 are those of [`Ggx`].

use glam::{DVec3, DVec4};

use super::ggx::Ggx;
use super::{BsdfSample, fresnel};

/// A boundary at a point.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Dielectric {
    /// Refractive index on the side of −z over that on the side of +z.
    pub index: f64,
    /// Factor on what is reflected; 0 in lanes that are no channel.
    pub reflection_tint: DVec4,
    /// Factor on what is refracted; likewise.
    pub transmission_tint: DVec4,
    /// Its microfacets; none if it is smooth.
    pub facets: Option<Ggx>,
}

/// What one facet does to light, seen from above it.
struct Facet {
    reflection: DVec4,
    transmission: DVec4,
    /// Probability that a path is reflected.
    probability: f64,
    /// Cosine to the facet's normal beyond it.
    beyond: f64,
}

impl Dielectric {
    pub(super) fn sample(&self, wo: DVec3, choice: f64, u: [f64; 2]) -> Option<BsdfSample> {
        if wo.z == 0.0 {
            return None;
        }
        let side = 1.0_f64.copysign(wo.z);
        let (above, eta) = (wo * side, self.eta(wo));
        let facets = self.rough();
        let h = facets.map_or(DVec3::Z, |facets| facets.sample_seen(above, u));
        let cos = above.dot(h);
        let facet = self.facet(cos, eta)?;
        let is_reflected = choice < facet.probability;
        let (wi, weight, probability, scale) = if is_reflected {
            (2.0 * cos * h - above, facet.reflection, facet.probability, 1.0)
        } else {
            let refracted = (cos / eta - facet.beyond) * h - above / eta;
            (refracted, facet.transmission, 1.0 - facet.probability, 1.0 / (eta * eta))
        };
        let weight = weight * (scale / probability);
        let wi = wi.normalize();
        let Some(facets) = facets else {
            return Some(BsdfSample { radiance_scale: scale, ..BsdfSample::delta(wi * side, weight) });
        };
        if wi.z == 0.0 || (wi.z > 0.0) != is_reflected {
            return None;
        }
        let weight = weight * (facets.seen_from_both(above, wi) / facets.seen(above));
        let pdf = self.pdf(wo, wi * side);
        BsdfSample::if_sound(wi * side, weight, pdf, scale)
    }

    pub(super) fn value(&self, wo: DVec3, wi: DVec3) -> DVec4 {
        let Some(at) = self.lobe(wo, wi) else { return DVec4::ZERO };
        let Lobe { facets, h, cos, cos_beyond, eta, facet } = at;
        let common = facets.density(h) * facets.seen_from_both(wo, wi) / wo.z.abs();
        if wo.z * wi.z > 0.0 {
            return facet.reflection * (common / 4.0);
        }
        let stretch = cos + eta * cos_beyond;
        facet.transmission * (common * (cos * cos_beyond).abs() / (stretch * stretch))
    }

    pub(super) fn pdf(&self, wo: DVec3, wi: DVec3) -> f64 {
        let Some(at) = self.lobe(wo, wi) else { return 0.0 };
        let Lobe { facets, h, cos, cos_beyond, eta, facet } = at;
        let seen = facets.seen_density(wo, h);
        if wo.z * wi.z > 0.0 {
            return facet.probability * seen / (4.0 * cos.abs());
        }
        let stretch = cos + eta * cos_beyond;
        (1.0 - facet.probability) * seen * (eta * eta * cos_beyond.abs()) / (stretch * stretch)
    }

    pub(super) fn is_delta(&self) -> bool {
        self.rough().is_none()
    }

    pub(super) fn albedo(&self) -> DVec4 {
        let (reflected, _) = fresnel::dielectric(1.0, self.index);
        self.reflection_tint * reflected + self.transmission_tint * (1.0 - reflected)
    }

    /// Index on the other side over that on the side of `wo`.
    fn eta(&self, wo: DVec3) -> f64 {
        if wo.z > 0.0 { self.index } else { 1.0 / self.index }
    }

    /// The facets. Where the indices are equal there are none to be seen.
    fn rough(&self) -> Option<&Ggx> {
        self.facets.as_ref().filter(|_| (self.index - 1.0).abs() > 1e-6)
    }

    fn facet(&self, cos: f64, eta: f64) -> Option<Facet> {
        let (reflected, beyond) = fresnel::dielectric(cos.min(1.0), eta);
        let reflection = self.reflection_tint * reflected;
        let transmission = self.transmission_tint * (1.0 - reflected);
        let all = reflection.element_sum() + transmission.element_sum();
        let probability = reflection.element_sum() / all;
        (all > 0.0).then_some(Facet { reflection, transmission, probability, beyond })
    }

    /// The facet that turns light from `wi` to `wo`, if there is one and it faces both.
    fn lobe(&self, wo: DVec3, wi: DVec3) -> Option<Lobe<'_>> {
        let facets = self.rough()?;
        if wo.z * wi.z == 0.0 {
            return None;
        }
        let eta = if wo.z * wi.z > 0.0 { 1.0 } else { self.eta(wo) };
        let h = (wo + eta * wi).try_normalize()?;
        // On the side of `wo`, as seen from which the facet is looked at.
        let h = if h.z * wo.z < 0.0 { -h } else { h };
        let (cos, cos_beyond) = (wo.dot(h), wi.dot(h));
        if cos <= 0.0 || cos_beyond * wi.z * wo.z <= 0.0 {
            return None;
        }
        let facet = self.facet(cos, self.eta(wo))?;
        Some(Lobe { facets, h, cos, cos_beyond, eta, facet })
    }
}

/// A facet between two directions.
struct Lobe<'a> {
    facets: &'a Ggx,
    h: DVec3,
    cos: f64,
    cos_beyond: f64,
    eta: f64,
    facet: Facet,
}
