//! Irradiance and radiance in a scene's own light, by paths from the meter to the lights.
//!
//!   E = ∫ L(ω) cos θ dω over the half-space before the surface
//!
//! What the media send comes along directions drawn with density cos θ/π, traced as camera rays are; what arrives from the
//! lights themselves is found by drawing a direction to each light. Source: Veach 1997, "Robust Monte Carlo methods for
//! light transport simulation", chapters 8 and 9. Unbiased.

use glam::DVec3;
use tyndall_lanes::Random;
use tyndall_scene::{Channels, Ray, Scene};

use super::run::{Walk, values_error};
use super::tally::{Estimate, Scores, Tallies};
use crate::reference::trace;
use crate::spectral::SpectralScene;
use crate::transmittance::estimate_transmittance;

/// A meter in the scene's light.
#[derive(Debug, Clone, Copy)]
pub struct LightMeter<'a> {
    /// The scene; for irradiance, its media's extinction does not depend on colour.
    pub scene: &'a Scene,
    /// What is measured.
    pub kind: LightMeterKind,
}

/// What a light meter measures.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum LightMeterKind {
    /// Irradiance at a point, on the side of the unit normal.
    Irradiance {
        /// The point.
        position: DVec3,
        /// The normal.
        normal: DVec3,
    },
    /// Radiance that arrives against the ray.
    Radiance(Ray),
}

impl LightMeter<'_> {
    /// Red, green and blue.
    pub fn values(&self, tallies: &Tallies) -> [Estimate; 3] {
        [0, 1, 2].map(|channel| tallies.estimate(channel))
    }

    fn irradiance(&self, position: DVec3, normal: DVec3, random: &mut Random) -> DVec3 {
        let lights = self.scene.lights.iter().map(|light| {
            let sample = light.sample(position, [random.f64(), random.f64()]);
            let cosine = sample.toward.dot(normal);
            if cosine <= 0.0 || sample.radiance_over_pdf == DVec3::ZERO {
                return DVec3::ZERO;
            }
            let ray = Ray { origin: position, direction: sample.toward };
            let transmittance = self
                .scene
                .volumes
                .iter()
                .map(|volume| estimate_transmittance(volume, &ray, (0.0, sample.distance), random));
            sample.radiance_over_pdf * cosine * transmittance.product::<f64>()
        });
        let direct: DVec3 = lights.sum();
        let (tangent, bitangent) = normal.any_orthonormal_pair();
        let (sin_azimuth, cos_azimuth) = libm::sincos(std::f64::consts::TAU * random.f64());
        let sin_squared = random.f64();
        let direction = (tangent * cos_azimuth + bitangent * sin_azimuth) * sin_squared.sqrt()
            + normal * (1.0 - sin_squared).sqrt();
        let sample = trace(self.scene, Ray { origin: position, direction }, random);
        let from_media = [sample.emission, sample.single, sample.multiple]
            .map(|part| DVec3::from_array(part.map(f64::from)));
        direct + std::f64::consts::PI * from_media.into_iter().sum::<DVec3>()
    }
}

impl Walk for LightMeter<'_> {
    fn tallies(&self) -> usize {
        3
    }

    fn walk(&self, random: &mut Random, scores: &mut Scores) {
        let value = match self.kind {
            LightMeterKind::Irradiance { position, normal } => self.irradiance(position, normal, random),
            LightMeterKind::Radiance(ray) => {
                let sample = if self.scene.is_chromatic() {
                    SpectralScene::new(self.scene, Channels::Rgb).trace(ray, random)
                } else {
                    trace(self.scene, ray, random)
                };
                DVec3::from_array(sample.radiance.map(f64::from))
            }
        };
        value.to_array().into_iter().enumerate().for_each(|(channel, x)| scores.add(channel, x));
    }

    fn relative_error(&self, tallies: &Tallies) -> f64 {
        values_error(&self.values(tallies), tallies)
    }
}
