//! GGX: the distribution of microfacet normals of a rough surface, its shadowing, and the sampling of the normals seen.
//!
//!   D(h) = 1/(π αx αy (hx²/αx² + hy²/αy² + hz²)²),   Λ(ω) = (√(1 + (αx² ωx² + αy² ωy²)/ωz²) − 1)/2,
//!   G1(ω) = 1/(1 + Λ(ω)),   G2(ω, ω′) = 1/(1 + Λ(ω) + Λ(ω′)),   D_ω(h) = G1(ω) |ω·h| D(h)/|ωz|
//!
//! G2 takes the heights at which light comes and goes as correlated; it is used for refraction too. Sources:
//! Trowbridge & Reitz 1975; Walter et al. 2007, "Microfacet models for refraction through rough surfaces"; Heitz 2014,
//! "Understanding the masking-shadowing function", eqs. 72 and 99; visible normals as in Heitz 2018, drawn by the spherical
//! caps of Dupuy & Benyoub 2023.

use std::f64::consts::{PI, TAU};

use glam::DVec3;

/// The distribution, about +z. Directions may be on either side.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ggx {
    alpha: [f64; 2],
}

/// A surface whose both widths are less looks smooth.
const SMOOTH: f64 = 1e-3;

/// The least width along one axis of a surface that is not smooth.
const LEAST: f64 = 1e-4;

/// Microfacets as perfect mirrors, between two directions.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Mirrored {
    /// Cosine between each direction and the normal of the facet.
    pub cos: f64,
    /// D G2/(4 |cos θ|): f |cos θ′|.
    pub value: f64,
    /// Density of ω′, 1/sr: D_ω(h)/(4 ω·h) = D G1/(4 |cos θ|).
    pub pdf: f64,
}

impl Ggx {
    /// The distribution of the widths αx and αy; `None` if the surface is as good as smooth.
    pub fn new(alpha: [f64; 2]) -> Option<Ggx> {
        let is_rough = alpha[0].max(alpha[1]) >= SMOOTH;
        is_rough.then(|| Ggx { alpha: alpha.map(|alpha| alpha.clamp(LEAST, 1e3)) })
    }

    /// D(h) in 1/sr; ∫ D(h) hz dω = 1 over the upper hemisphere.
    pub fn density(&self, h: DVec3) -> f64 {
        let [x, y] = self.alpha;
        let sum = (h.x / x).powi(2) + (h.y / y).powi(2) + h.z * h.z;
        1.0 / (PI * x * y * sum * sum)
    }

    /// Fraction of the facets that are seen from `w`: G1.
    pub fn seen(&self, w: DVec3) -> f64 {
        1.0 / (1.0 + self.lambda(w))
    }

    /// Fraction of the facets that are seen from both: G2.
    pub fn seen_from_both(&self, wo: DVec3, wi: DVec3) -> f64 {
        1.0 / (1.0 + self.lambda(wo) + self.lambda(wi))
    }

    /// Density in 1/sr of the normals that are seen from `w`.
    pub fn seen_density(&self, w: DVec3, h: DVec3) -> f64 {
        if w.z == 0.0 {
            return 0.0;
        }
        self.seen(w) * w.dot(h).abs() * self.density(h) / w.z.abs()
    }

    /// Draws one of the normals that are seen from `w` of wz > 0, with the density [`seen_density`](Self::seen_density).
    pub fn sample_seen(&self, w: DVec3, u: [f64; 2]) -> DVec3 {
        let scale = DVec3::new(self.alpha[0], self.alpha[1], 1.0);
        // Stretched so that the facets are those of a hemisphere, of which a mirror sees an even cap.
        let stretched = (w * scale).normalize();
        let z = (1.0 - u[1]) * (1.0 + stretched.z) - stretched.z;
        let sin = (1.0 - z * z).max(0.0).sqrt();
        let (sin_phi, cos_phi) = libm::sincos(TAU * u[0]);
        let h = DVec3::new(sin * cos_phi, sin * sin_phi, z) + stretched;
        (h * scale).normalize_or(DVec3::Z)
    }

    /// What the facets make of light that they mirror from `wi` to `wo`, on either side of the surface; `None` from one
    /// side to the other.
    pub(super) fn mirror(&self, wo: DVec3, wi: DVec3) -> Option<Mirrored> {
        if wo.z * wi.z <= 0.0 {
            return None;
        }
        let h = (wo + wi).try_normalize()?;
        let density = self.density(h) / (4.0 * wo.z.abs());
        Some(Mirrored {
            cos: wo.dot(h).clamp(0.0, 1.0),
            value: density * self.seen_from_both(wo, wi),
            pdf: density * self.seen(wo),
        })
    }

    /// Draws a direction with the density of [`mirror`](Self::mirror); `None` if it leads into the surface.
    pub(super) fn sample_mirror(&self, wo: DVec3, u: [f64; 2]) -> Option<DVec3> {
        if wo.z == 0.0 {
            return None;
        }
        // The facets are the same seen from below: D(−h) = D(h).
        let side = 1.0_f64.copysign(wo.z);
        let above = wo * side;
        let h = self.sample_seen(above, u);
        let wi = (2.0 * above.dot(h) * h - above).normalize();
        (wi.z > 0.0).then_some(wi * side)
    }

    fn lambda(&self, w: DVec3) -> f64 {
        let across = (self.alpha[0] * w.x).powi(2) + (self.alpha[1] * w.y).powi(2);
        if across == 0.0 {
            return 0.0;
        }
        0.5 * ((1.0 + across / (w.z * w.z)).sqrt() - 1.0)
    }
}
