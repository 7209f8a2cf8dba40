//! A point that shines equally in all directions: irradiance I / d² at distance d.

use std::f64::consts::PI;

use glam::DVec3;

use super::LightSample;

/// A point that shines equally in all directions.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PointLight {
    position: DVec3,
    intensity: DVec3,
}

impl PointLight {
    /// A light at `position` of `intensity` (power per solid angle).
    pub fn new(position: DVec3, intensity: DVec3) -> Self {
        Self { position, intensity }
    }

    /// Where the light is.
    pub fn position(&self) -> DVec3 {
        self.position
    }

    /// Power per solid angle.
    pub fn intensity(&self) -> DVec3 {
        self.intensity
    }

    pub(super) fn sample(&self, from: DVec3) -> LightSample {
        let offset = self.position - from;
        let distance = offset.length();
        // At the light itself there is no direction to it; the single point carries no weight in any
        // integral.
        let (toward, irradiance) = match offset.try_normalize() {
            Some(toward) => (toward, self.intensity / (distance * distance)),
            None => (DVec3::Y, DVec3::ZERO),
        };
        LightSample { toward, distance, radiance_over_pdf: irradiance, pdf: 0.0, is_delta: true }
    }

    /// Power in all directions.
    pub(super) fn power(&self) -> DVec3 {
        4.0 * PI * self.intensity
    }
}
