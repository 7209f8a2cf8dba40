//! Distance sampling in closed form: t at which τ(t) = −ln(1 − ξ); in a homogeneous medium t = −ln(1 − ξ)/μt.
//!
//! Source: Novák, Georgiev, Hanika & Jarosz 2018, "Monte Carlo methods for volumetric light transport simulation",
//! section 3.1. Unbiased, analog. No lookups but one or two for each voxel of a grid that is not interpolated.

use tyndall_lanes::Random;

use super::Flight;
use crate::along_ray::{AlongRay, Lookups};
use crate::properties::{MajorantUse, Need, Properties};

pub(super) const PROPERTIES: Properties = Properties {
    name: "closed-form",
    unbiased: true,
    majorant: MajorantUse::None,
    needs: &[Need::ClosedForm],
    source: "inversion of Beer's law",
};

pub(super) fn sample(ray: &AlongRay, random: &mut Random, lookups: &mut Lookups) -> Flight {
    Flight::analog(ray.distance_at(random.exponential_f64(), lookups))
}
