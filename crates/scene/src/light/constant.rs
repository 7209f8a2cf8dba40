//! The same radiance from every direction, sampled uniformly over the sphere: pdf = 1 / 4π.

use std::f64::consts::{PI, TAU};

use glam::DVec3;

use super::LightSample;

/// The same radiance from every direction.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ConstantLight {
    radiance: DVec3,
}

impl ConstantLight {
    /// A light of this radiance.
    pub fn new(radiance: DVec3) -> Self {
        Self { radiance }
    }

    pub(super) fn sample(&self, u: [f64; 2]) -> LightSample {
        let y = 1.0 - 2.0 * u[1];
        let horizontal = (1.0 - y * y).max(0.0).sqrt();
        let (sin_azimuth, cos_azimuth) = libm::sincos(TAU * u[0]);
        LightSample {
            toward: DVec3::new(horizontal * cos_azimuth, y, horizontal * sin_azimuth),
            distance: f64::INFINITY,
            radiance_over_pdf: self.radiance / self.pdf(),
            pdf: self.pdf(),
            is_delta: false,
        }
    }

    pub(super) fn radiance(&self) -> DVec3 {
        self.radiance
    }

    pub(super) fn pdf(&self) -> f64 {
        1.0 / (4.0 * PI)
    }

    /// Integral of the radiance over the sphere.
    pub(super) fn total(&self) -> DVec3 {
        4.0 * PI * self.radiance
    }
}
