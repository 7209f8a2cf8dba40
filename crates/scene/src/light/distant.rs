//! Parallel light: a delta light at infinity.

use glam::DVec3;

use super::LightSample;

/// Parallel light.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DistantLight {
    toward: DVec3,
    irradiance: DVec3,
}

impl DistantLight {
    /// Light that travels along `direction` (any length) and gives `irradiance` on a surface that faces it.
    pub fn new(direction: DVec3, irradiance: DVec3) -> Self {
        Self { toward: -direction.normalize_or(DVec3::NEG_Y), irradiance }
    }

    /// Unit vector to where the light comes from.
    pub fn toward(&self) -> DVec3 {
        self.toward
    }

    pub(super) fn sample(&self) -> LightSample {
        LightSample {
            toward: self.toward,
            distance: f64::INFINITY,
            radiance_over_pdf: self.irradiance,
            pdf: 0.0,
            is_delta: true,
        }
    }

    pub(super) fn irradiance(&self) -> DVec3 {
        self.irradiance
    }
}
