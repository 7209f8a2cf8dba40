//! A point that shines into a cone: irradiance I f(θ) / d² at distance d, θ away from the axis.
//!
//! f is 1 up to the inner angle i, 0 from the angle o of the cone's edge on, and between them either
//!
//!   smooth: f = x² (3 − 2x), x = (cos θ − cos o)/(cos i − cos o);      linear: f = (o − θ)/(o − i).
//!
//! The smooth one is pbrt's (Pharr, Jakob & Humphreys 2023, section 12.2.1), the linear one that of other renderers. With
//! either, the power 2π I ∫ f sin θ dθ has a closed form:
//!
//!   smooth: 2π I (1 − (cos i + cos o)/2);      linear: 2π I (1 − (sin o − sin i)/(o − i)).

use std::f64::consts::TAU;

use glam::DVec3;

use super::{LightSample, PointLight};
use crate::angle_between;
use crate::description::SpotFalloff;

/// A point that shines into a cone.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SpotLight {
    position: DVec3,
    axis: DVec3,
    intensity: DVec3,
    /// Angles from the axis up to which the light is undiminished, and to the edge, radians.
    inner: f64,
    edge: f64,
    falloff: SpotFalloff,
}

impl SpotLight {
    /// A light at `position` that shines along `direction` (any length) with `intensity` (power per solid angle) on the
    /// axis, undiminished up to `inner_angle` from the axis and nothing beyond `angle`, both in degrees.
    pub fn new(
        position: DVec3,
        direction: DVec3,
        intensity: DVec3,
        [inner_angle, angle]: [f64; 2],
        falloff: SpotFalloff,
    ) -> Self {
        let edge = angle.to_radians();
        Self {
            position,
            axis: direction.normalize_or(DVec3::NEG_Y),
            intensity,
            inner: inner_angle.to_radians().min(edge),
            edge,
            falloff,
        }
    }

    /// Where the light is.
    pub fn position(&self) -> DVec3 {
        self.position
    }

    /// Unit vector along the middle of the cone, the way the light travels.
    pub fn axis(&self) -> DVec3 {
        self.axis
    }

    /// Angle between the axis and the edge of the cone, radians.
    pub fn edge(&self) -> f64 {
        self.edge
    }

    /// Power per solid angle that is sent along the unit vector `direction`.
    pub fn intensity(&self, direction: DVec3) -> DVec3 {
        self.intensity * self.diminution(angle_between(self.axis, direction))
    }

    /// What is left of the intensity on the axis at this angle from it.
    fn diminution(&self, angle: f64) -> f64 {
        if angle <= self.inner {
            return 1.0;
        }
        if angle >= self.edge {
            return 0.0;
        }
        match self.falloff {
            SpotFalloff::Linear => (self.edge - angle) / (self.edge - self.inner),
            SpotFalloff::Smooth => {
                let cos_edge = libm::cos(self.edge);
                let x = ((libm::cos(angle) - cos_edge) / (libm::cos(self.inner) - cos_edge)).clamp(0.0, 1.0);
                x * x * (3.0 - 2.0 * x)
            }
        }
    }

    pub(super) fn sample(&self, from: DVec3) -> LightSample {
        let sample = PointLight::new(self.position, self.intensity).sample(from);
        let diminution = self.diminution(angle_between(self.axis, -sample.toward));
        LightSample { radiance_over_pdf: sample.radiance_over_pdf * diminution, ..sample }
    }

    /// Power in all directions.
    pub(super) fn power(&self) -> DVec3 {
        let (inner, edge) = (self.inner, self.edge);
        let mean_cos = match self.falloff {
            SpotFalloff::Linear if edge - inner > 1e-6 => {
                (libm::sin(edge) - libm::sin(inner)) / (edge - inner)
            }
            _ => 0.5 * (libm::cos(inner) + libm::cos(edge)),
        };
        TAU * self.intensity * (1.0 - mean_cos)
    }
}
