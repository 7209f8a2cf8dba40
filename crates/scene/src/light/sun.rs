//! A far disc of uniform radiance, sampled uniformly over its cone.
//!
//! With the half angle α: solid angle Ω = 2π (1 - cos α) = 4π sin²(α/2), pdf = 1 / Ω. The irradiance of a
//! surface that faces the disc's centre is L ∫ cos θ dω = L π sin² α, which gives the radiance L. For the sun
//! Ω is 7e-5 sr, so 1 - cos is kept instead of cos.

use std::f64::consts::{PI, TAU};

use glam::DVec3;

use super::LightSample;

/// A far disc of uniform radiance, as the sun is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SunLight {
    toward: DVec3,
    /// Two unit vectors across `toward`.
    across: [DVec3; 2],
    irradiance: DVec3,
    radiance: DVec3,
    /// 1 - cos α.
    one_minus_cos: f64,
}

impl SunLight {
    /// A disc in the direction `toward` (any length), `angular_diameter` degrees across (above 0, at most
    /// 90), that gives `irradiance` on a surface facing it.
    pub fn new(toward: DVec3, irradiance: DVec3, angular_diameter: f64) -> Self {
        let toward = toward.normalize_or(DVec3::Y);
        let (first, second) = toward.any_orthonormal_pair();
        let half_angle = 0.5 * angular_diameter.to_radians();
        Self {
            toward,
            across: [first, second],
            irradiance,
            radiance: irradiance / (PI * libm::sin(half_angle).powi(2)),
            one_minus_cos: 2.0 * libm::sin(0.5 * half_angle).powi(2),
        }
    }

    /// Irradiance of a surface that faces the sun.
    pub fn irradiance(&self) -> DVec3 {
        self.irradiance
    }

    /// Unit vector to the centre of the disc.
    pub fn toward(&self) -> DVec3 {
        self.toward
    }

    fn solid_angle(&self) -> f64 {
        TAU * self.one_minus_cos
    }

    fn is_inside(&self, direction: DVec3) -> bool {
        // |d - t|² = 2 (1 - cos) for unit vectors, without cancellation.
        0.5 * (direction - self.toward).length_squared() <= self.one_minus_cos
    }

    pub(super) fn sample(&self, u: [f64; 2]) -> LightSample {
        let below_axis = u[1] * self.one_minus_cos;
        let sin = (below_axis * (2.0 - below_axis)).sqrt();
        let (sin_azimuth, cos_azimuth) = libm::sincos(TAU * u[0]);
        let sideways = self.across[0] * (sin * cos_azimuth) + self.across[1] * (sin * sin_azimuth);
        LightSample {
            toward: self.toward * (1.0 - below_axis) + sideways,
            distance: f64::INFINITY,
            radiance_over_pdf: self.radiance * self.solid_angle(),
            pdf: 1.0 / self.solid_angle(),
            is_delta: false,
        }
    }

    pub(super) fn radiance(&self, direction: DVec3) -> DVec3 {
        if self.is_inside(direction) { self.radiance } else { DVec3::ZERO }
    }

    pub(super) fn pdf(&self, direction: DVec3) -> f64 {
        if self.is_inside(direction) { 1.0 / self.solid_angle() } else { 0.0 }
    }
}
