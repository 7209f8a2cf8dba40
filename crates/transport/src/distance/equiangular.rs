//! Equiangular sampling: distances in proportion to the light of a point light, as if there were no medium.
//!
//! Seen from the light, the angle θ along the ray is uniform: t = t₀ + D tan θ, where t₀ is the point nearest the light and D
//! its distance from there, so that the density
//!
//!   p(t) = D / ((θ_end − θ_start)(D² + (t − t₀)²))
//!
//! takes up the 1/d² of the light, which makes the variance of other samplers infinite for D → 0. The collision's weight is
//! μt T/p, with the exact optical thickness; the escape is the exact T.
//!
//! Source: Kulla & Fajardo 2012, "Importance sampling techniques for path tracing in participating media". Unbiased. Without a
//! light beside the ray it is delta tracking. Cost: as regular tracking to the end of the ray.

use tyndall_lanes::Random;

use super::{Flight, delta_tracking};
use crate::along_ray::{AlongRay, LightBeside, Lookups};
use crate::properties::{MajorantUse, Need, Properties};

pub(super) const PROPERTIES: Properties = Properties {
    name: "equiangular",
    unbiased: true,
    majorant: MajorantUse::None,
    needs: &[Need::PointLight, Need::ExactThickness],
    source: "Kulla & Fajardo 2012",
};

/// The distribution of distances between two ends.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Equiangular {
    light: LightBeside,
    range: (f64, f64),
    angles: (f64, f64),
}

impl Equiangular {
    /// None if the light is so near the ray that angles do not tell places on it.
    pub fn new(light: LightBeside, range: (f64, f64)) -> Option<Self> {
        let angle = |t: f64| libm::atan2(t - light.nearest, light.distance);
        let angles = (angle(range.0), angle(range.1));
        let is_usable = light.distance > 1e-12 * (range.1 - range.0) && angles.0 < angles.1;
        is_usable.then_some(Self { light, range, angles })
    }

    pub fn sample(&self, u: f64) -> f64 {
        let angle = self.angles.0 + (self.angles.1 - self.angles.0) * u;
        let t = self.light.nearest + self.light.distance * libm::tan(angle);
        t.clamp(self.range.0, self.range.1)
    }

    /// Density per length.
    pub fn pdf(&self, t: f64) -> f64 {
        let (along, distance) = (t - self.light.nearest, self.light.distance);
        distance / ((self.angles.1 - self.angles.0) * (distance * distance + along * along))
    }
}

pub(super) fn sample(ray: &AlongRay, random: &mut Random, lookups: &mut Lookups) -> Flight {
    let distribution = ray.light().and_then(|light| Equiangular::new(light, (ray.start(), ray.end())));
    let Some(distribution) = distribution else { return delta_tracking::sample(ray, random, lookups) };
    let t = distribution.sample(random.f64());
    let transmittance = libm::exp(-ray.thickness(t, lookups));
    let weight = ray.mu_t(t, lookups) * transmittance / distribution.pdf(t);
    Flight { t: Some(t), weight, escape: libm::exp(-ray.thickness(f64::INFINITY, lookups)) }
}
