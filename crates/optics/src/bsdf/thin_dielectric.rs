//! A thin sheet of glass as one surface: with R of one face, light that is reflected to and fro between the two faces adds
//! up to
//!
//!   R′ = R + (1 − R)² R/(1 − R²) = 2R/(1 + R),   T′ = 1 − R′
//!
//! (Stokes 1860), without interference, and goes on unbent. Light is unpolarised at each face.

use glam::{DVec3, DVec4};

use super::{BsdfSample, fresnel};

/// A sheet at a point.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ThinDielectric {
    /// Refractive index over that around.
    pub index: f64,
    /// Factor on what is reflected; 0 in lanes that are no channel.
    pub reflection_tint: DVec4,
    /// Factor on what is let through; likewise.
    pub transmission_tint: DVec4,
}

impl ThinDielectric {
    pub(super) fn sample(&self, wo: DVec3, choice: f64) -> Option<BsdfSample> {
        if wo.z == 0.0 {
            return None;
        }
        let (face, _) = fresnel::dielectric(wo.z.abs(), self.index);
        let reflected = 2.0 * face / (1.0 + face);
        let reflection = self.reflection_tint * reflected;
        let transmission = self.transmission_tint * (1.0 - reflected);
        let all = reflection.element_sum() + transmission.element_sum();
        let probability = reflection.element_sum() / all;
        if all <= 0.0 {
            None
        } else if choice < probability {
            Some(BsdfSample::delta(DVec3::new(-wo.x, -wo.y, wo.z), reflection / probability))
        } else {
            Some(BsdfSample::delta(-wo, transmission / (1.0 - probability)))
        }
    }

    pub(super) fn albedo(&self) -> DVec4 {
        let (face, _) = fresnel::dielectric(1.0, self.index);
        let reflected = 2.0 * face / (1.0 + face);
        self.reflection_tint * reflected + self.transmission_tint * (1.0 - reflected)
    }
}
