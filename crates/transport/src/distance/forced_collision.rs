//! Forced collision, or normalised distance sampling: every ray collides, with the weight that it should have.
//!
//!   p(t) = μt T/(1 − T_end),   weight 1 − T_end,   escape T_end:   τ(t) = −ln(1 − ξ (1 − T_end))
//!
//! Source: Spanier & Gelbard 1969, "Monte Carlo principles and neutron transport problems"; Novák et al. 2018, section 3.1.
//! Unbiased. Good in thin media, where most flights would otherwise meet nothing. Cost: as regular tracking, once to the end of
//! the ray and once to the collision.

use tyndall_lanes::Random;

use super::Flight;
use crate::along_ray::{AlongRay, Lookups};
use crate::properties::{MajorantUse, Need, Properties};

pub(super) const PROPERTIES: Properties = Properties {
    name: "forced-collision",
    unbiased: true,
    majorant: MajorantUse::None,
    needs: &[Need::ExactThickness],
    source: "Spanier & Gelbard 1969",
};

pub(super) fn sample(ray: &AlongRay, random: &mut Random, lookups: &mut Lookups) -> Flight {
    let whole = ray.thickness(f64::INFINITY, lookups);
    // 1 − T without cancellation in thin media.
    let weight = -libm::expm1(-whole);
    let tau = -libm::log1p(-random.f64() * weight);
    match ray.distance_at(tau, lookups) {
        Some(t) => Flight { t: Some(t), weight, escape: libm::exp(-whole) },
        // The medium is empty, or rounding went past its end.
        None => Flight { t: (weight > 0.0).then(|| ray.end()), weight, escape: libm::exp(-whole) },
    }
}
