//! Regular tracking: optical thickness is spent voxel by voxel until −ln(1 − ξ) of it is gone.
//!
//! In the voxel where that happens the cubic that trilinear interpolation makes of the extinction is integrated exactly and
//! inverted by Newton's method. Source: Amanatides & Woo 1987 (the walk); Novák et al. 2018, section 3.2. Unbiased, analog.
//! Cost: two lookups for each voxel up to the collision that is not empty, and about ten in the last.

use tyndall_lanes::Random;

use super::Flight;
use crate::along_ray::{AlongRay, Lookups};
use crate::properties::{MajorantUse, Need, Properties};

pub(super) const PROPERTIES: Properties = Properties {
    name: "regular-tracking",
    unbiased: true,
    majorant: MajorantUse::None,
    needs: &[Need::ExactThickness],
    source: "Amanatides & Woo 1987",
};

pub(super) fn sample(ray: &AlongRay, random: &mut Random, lookups: &mut Lookups) -> Flight {
    Flight::analog(ray.distance_at(random.exponential_f64(), lookups))
}
