//! Ray marching: T ≈ exp(−h Σ μt(tᵢ)) at equal steps h from a random offset, tᵢ = (i + ξ)·h.
//!
//! The sum is an unbiased estimate of τ, but the exponential of its mean is not the mean of its exponential: T is
//! overestimated, by about T·Var(τ̂)/2 (Jensen's inequality), which falls with h². Source: Perlin & Hoffert 1989; the common
//! offset Pauly, Kollig & Keller 2000. Biased. Cost: one lookup a step.

use tyndall_lanes::Random;

use crate::along_ray::{AlongRay, Lookups};
use crate::properties::{MajorantUse, Properties};

pub(super) const PROPERTIES: Properties = Properties {
    name: "ray-marching",
    unbiased: false,
    majorant: MajorantUse::None,
    needs: &[],
    source: "Perlin & Hoffert 1989",
};

/// Steps unless another number is asked for.
pub(super) const STEPS: u32 = 64;

pub(super) fn estimate(ray: &AlongRay, steps: u32, random: &mut Random, lookups: &mut Lookups) -> f64 {
    libm::exp(-marched_thickness(ray, steps.max(1).into(), random.f64(), lookups))
}

/// Optical thickness by `steps` equal steps, each looked at `offset` of the way through it.
pub(super) fn marched_thickness(ray: &AlongRay, steps: u64, offset: f64, lookups: &mut Lookups) -> f64 {
    let (start, end) = (ray.start(), ray.end());
    let step = (end - start) / steps as f64;
    let sum: f64 = (0..steps).map(|i| ray.mu_t(start + (i as f64 + offset) * step, lookups)).sum();
    sum * step
}
