//! A rough matte surface of diffuse facets in V-shaped grooves, on both sides (Oren & Nayar 1994, "Generalization of
//! Lambert's reflectance model", the qualitative model, eq. 30):
//!
//!   f = ρ/π (A + B max(0, cos(φ − φ′)) sin α tan β),   A = 1 − σ²/2/(σ² + 0.33),   B = 0.45 σ²/(σ² + 0.09),
//!
//! with α the greater and β the lesser of the angles to the normal and σ the standard deviation of the facets' slope angle.
//! It is reciprocal. At grazing angles its albedo grows to ρ (A + B/2), up to 1.5 % above ρ for σ near 11°; there f is
//! divided by A + B/2, so that no surface sends out more than it receives.

use std::f64::consts::PI;

use glam::{DVec3, DVec4};

use super::{BsdfSample, diffuse};

/// A rough matte surface.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RoughDiffuse {
    reflectance: DVec4,
    a: f64,
    b: f64,
}

impl RoughDiffuse {
    /// Of facets of reflectance ρ whose slope angle has the standard deviation `sigma`, in degrees.
    pub fn new(reflectance: DVec4, sigma: f64) -> RoughDiffuse {
        let variance = sigma.to_radians().powi(2);
        let a = 1.0 - 0.5 * variance / (variance + 0.33);
        let b = 0.45 * variance / (variance + 0.09);
        let greatest = (a + 0.5 * b).max(1.0);
        RoughDiffuse { reflectance, a: a / greatest, b: b / greatest }
    }

    pub(super) fn sample(&self, wo: DVec3, u: [f64; 2]) -> Option<BsdfSample> {
        let wi = diffuse::sample_cosine(wo, u);
        let pdf = diffuse::pdf(wo, wi);
        (pdf > 0.0).then(|| BsdfSample {
            wi,
            weight: self.value(wo, wi) / pdf,
            pdf,
            is_delta: false,
            radiance_scale: 1.0,
        })
    }

    pub(super) fn value(&self, wo: DVec3, wi: DVec3) -> DVec4 {
        if wo.z * wi.z <= 0.0 {
            return DVec4::ZERO;
        }
        // cos(φ − φ′) sin θ sin θ′, and tan β/sin β = 1/cos β with the greater of the cosines.
        let along = (wo.x * wi.x + wo.y * wi.y).max(0.0);
        let grooves = along / wo.z.abs().max(wi.z.abs());
        self.reflectance * ((self.a + self.b * grooves) * wi.z.abs() / PI)
    }

    pub(super) fn albedo(&self) -> DVec4 {
        self.reflectance * self.a
    }
}
