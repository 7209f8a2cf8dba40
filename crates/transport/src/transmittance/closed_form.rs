//! Transmittance in closed form: T = exp(−τ) (Bouguer 1729, Beer 1852), with τ = μt·length in a homogeneous medium and a
//! formula for τ in others.
//!
//! Exact; no variance. No lookups but one for each voxel of a grid that is not interpolated.

use crate::along_ray::{AlongRay, Lookups};
use crate::properties::{MajorantUse, Need, Properties};

pub(super) const PROPERTIES: Properties = Properties {
    name: "closed-form",
    unbiased: true,
    majorant: MajorantUse::None,
    needs: &[Need::ClosedForm],
    source: "Beer 1852",
};

pub(super) fn transmittance(ray: &AlongRay, lookups: &mut Lookups) -> f64 {
    libm::exp(-ray.thickness(f64::INFINITY, lookups))
}
