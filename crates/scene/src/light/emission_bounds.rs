//! Where a group of lights is, how strong, and into which directions it shines: enough to guess what it brings to a point.
//!
//! Conty Estevez & Kulla 2018, "Importance sampling of many lights with adaptive tree splitting": a box, the power Φ, and a
//! cone about an axis within which all normals lie (half angle θo), with light up to θe away from each normal. At a point
//! d away from the box's centre, in the direction θ from the axis, and seeing the box's sphere under the half angle θu,
//!
//!   importance = Φ max(cos θ′, c) / d²,   θ′ = max(0, θ − θo − θu),   and 0 if θ′ > θe.
//!
//! d is taken for at least the sphere's radius, and the cosine for at least a small c, so that whatever is lit at all may
//! be drawn.

use std::f64::consts::{FRAC_PI_2, PI};

use glam::DVec3;

use super::{AreaLight, Light};
use crate::{angle_between, rotation};

/// Bounds of the emission of a group of lights.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct EmissionBounds {
    pub(super) min: DVec3,
    pub(super) max: DVec3,
    pub(super) power: f64,
    axis: DVec3,
    /// θo, radians.
    spread: f64,
    /// θe, radians.
    reach: f64,
}

/// Least cosine that counts.
const LEAST_COS: f64 = 0.02;

/// Room for roundings, radians.
const MARGIN: f64 = 1e-6;

impl EmissionBounds {
    /// Those of a light of this power. None for lights at infinity.
    pub(super) fn of_light(light: &Light, power: f64) -> Option<Self> {
        let everywhere =
            |[min, max]: [DVec3; 2]| Self { min, max, power, axis: DVec3::Y, spread: PI, reach: FRAC_PI_2 };
        match light {
            Light::Constant(_) | Light::Image(_) | Light::Sun(_) | Light::Distant(_) => None,
            Light::Point(point) => Some(everywhere([point.position(); 2])),
            Light::Volume(volume) => Some(everywhere(volume.bounds())),
            Light::Spot(spot) => {
                let bounds = everywhere([spot.position(); 2]);
                Some(Self { axis: spot.axis(), spread: 0.0, reach: spot.edge(), ..bounds })
            }
            Light::Area(lamp) => {
                let pieces = lamp.primitives().iter().map(|primitive| primitive.bounds());
                let bounds = everywhere(pieces.reduce(|[a, b], [c, d]| [a.min(c), b.max(d)])?);
                let normals = if lamp.is_two_sided() { None } else { cone_of_normals(lamp) };
                Some(normals.map_or(bounds, |(axis, spread)| Self { axis, spread, ..bounds }))
            }
        }
    }

    pub(super) fn center(&self) -> DVec3 {
        0.5 * (self.min + self.max)
    }

    /// The bounds of both groups.
    pub(super) fn union(&self, other: &Self) -> Self {
        let (wide, narrow) = if self.spread >= other.spread { (self, other) } else { (other, self) };
        let apart = angle_between(wide.axis, narrow.axis);
        let (mut axis, mut spread) = (wide.axis, wide.spread);
        if (apart + narrow.spread).min(PI) > wide.spread {
            spread = 0.5 * (wide.spread + apart + narrow.spread);
            let around = wide.axis.cross(narrow.axis).try_normalize();
            let around = around.unwrap_or_else(|| wide.axis.any_orthonormal_vector());
            axis = rotation(around, spread - wide.spread) * wide.axis;
        }
        Self {
            min: self.min.min(other.min),
            max: self.max.max(other.max),
            power: self.power + other.power,
            axis: axis.normalize(),
            spread: spread.min(PI),
            reach: self.reach.max(other.reach),
        }
    }

    /// Roughly what the group brings to `from`, in proportion; 0 only where it brings nothing. Finite.
    pub(super) fn importance(&self, from: DVec3) -> f64 {
        let offset = from - self.center();
        let distance_squared = offset.length_squared();
        let radius_squared = 0.25 * (self.max - self.min).length_squared();
        let nearness = self.power / distance_squared.max(radius_squared).max(f64::MIN_POSITIVE);
        let nearness = nearness.min(f64::MAX / 4.0);
        if distance_squared <= radius_squared || distance_squared == 0.0 || self.spread >= PI {
            return nearness;
        }
        let seen_under = libm::asin((radius_squared / distance_squared).sqrt());
        let away = (angle_between(self.axis, offset) - self.spread - seen_under).max(0.0);
        if away > self.reach + MARGIN { 0.0 } else { nearness * libm::cos(away).max(LEAST_COS) }
    }

    /// What splits of a group are judged by: power, extent, and the solid angle shone into.
    pub(super) fn cost(&self) -> f64 {
        let extent = self.max - self.min;
        let area = extent.x * extent.y + extent.y * extent.z + extent.z * extent.x + extent.length_squared();
        let widest = (self.spread + self.reach).min(PI);
        let (sin, cos) = libm::sincos(self.spread);
        // 2π ∫ sin θ max(0, cos(θ − θo)) dθ, the inside of the cone at full weight.
        let orientation = 2.0 * PI * (1.0 - cos)
            + FRAC_PI_2
                * (2.0 * widest * sin - libm::cos(self.spread - 2.0 * widest) - 2.0 * self.spread * sin
                    + cos);
        self.power * area * orientation
    }
}

/// The axis and the half angle of a cone around the normals of a lamp; None if it has curved pieces.
fn cone_of_normals(lamp: &AreaLight) -> Option<(DVec3, f64)> {
    let normal = |k: usize| lamp.primitives()[k].flat_normal();
    let pieces = || (0..lamp.primitives().len()).filter(|&k| lamp.primitives()[k].area() > 0.0);
    let mut sum = DVec3::ZERO;
    for piece in pieces() {
        sum += normal(piece)? * lamp.primitives()[piece].area();
    }
    let axis = sum.try_normalize()?;
    let least_cos = pieces().filter_map(normal).fold(1.0_f64, |least, normal| least.min(axis.dot(normal)));
    Some((axis, libm::acos(least_cos.clamp(-1.0, 1.0)) + MARGIN))
}
