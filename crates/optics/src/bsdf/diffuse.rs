//! A matte surface: f = ρ/π on both sides (Lambert 1760), drawn in proportion to the cosine.

use std::f64::consts::{PI, TAU};

use glam::{DVec3, DVec4};

use super::BsdfSample;

pub(super) fn sample(reflectance: DVec4, wo: DVec3, u: [f64; 2]) -> Option<BsdfSample> {
    let wi = sample_cosine(wo, u);
    let pdf = pdf(wo, wi);
    (pdf > 0.0).then_some(BsdfSample { wi, weight: reflectance, pdf, is_delta: false, radiance_scale: 1.0 })
}

pub(super) fn value(reflectance: DVec4, wo: DVec3, wi: DVec3) -> DVec4 {
    reflectance * pdf(wo, wi)
}

/// |cos θ|/π on the side of `wo`.
pub(super) fn pdf(wo: DVec3, wi: DVec3) -> f64 {
    if wo.z * wi.z > 0.0 { wi.z.abs() / PI } else { 0.0 }
}

/// A direction on the side of `wo`, with the density [`pdf`].
pub(super) fn sample_cosine(wo: DVec3, u: [f64; 2]) -> DVec3 {
    let (radius, phi) = (u[0].sqrt(), TAU * u[1]);
    let z = (1.0 - u[0]).max(0.0).sqrt().copysign(wo.z);
    let (sin, cos) = libm::sincos(phi);
    DVec3::new(radius * cos, radius * sin, z)
}
