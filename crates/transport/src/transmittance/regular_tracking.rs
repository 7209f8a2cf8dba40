//! Regular tracking: T = exp(−Σ τᵢ), with the optical thickness τᵢ of every voxel along the ray.
//!
//! Source: Amanatides & Woo 1987 (the walk); Novák et al. 2018,
//! section 3.2.1. Trilinear voxels are integrated exactly by two-point Gauss-Legendre quadrature, as the field in one is a
//! cubic polynomial along a ray. Exact; no variance. Cost: two lookups for each voxel that is not empty.

use crate::along_ray::{AlongRay, Lookups};
use crate::properties::{MajorantUse, Need, Properties};

pub(super) const PROPERTIES: Properties = Properties {
    name: "regular-tracking",
    unbiased: true,
    majorant: MajorantUse::None,
    needs: &[Need::ExactThickness],
    source: "Amanatides & Woo 1987",
};

pub(super) fn transmittance(ray: &AlongRay, lookups: &mut Lookups) -> f64 {
    libm::exp(-ray.thickness(f64::INFINITY, lookups))
}
