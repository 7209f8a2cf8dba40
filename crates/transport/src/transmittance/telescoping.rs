//! Debiased ray marching: the bias of coarse steps is taken off by a telescoping sum, of which one term is drawn.
//!
//! ```text
//! T = E[I₀] + Σⱼ E[Iⱼ₊₁ − Iⱼ],   Iⱼ = exp(−τ marched with 2ʲ steps),   X = I₀ + (Iⱼ₊₁ − Iⱼ)/pⱼ
//! ```
//!
//! A march of 2ʲ⁺¹ equal steps from a random offset is two marches of 2ʲ, at its even and its odd places, so that the
//! difference of the first from the mean of the exponentials of the two needs no more lookups and is of second order. It
//! falls as 4⁻ʲ where the extinction is smooth (16⁻ʲ in the square) while the cost grows as 2ʲ; pⱼ = (1 − r)rʲ with
//! r = 2^(−3/2) keeps variance and expected cost both finite, also where steps in the extinction slow the fall. The coarsest
//! march has as many steps as the optical thickness of the majorant asks for, one at least.
//!
//! Source: Misso, Bitterli, Georgiev & Jarosz 2022, "Unbiased and consistent rendering using biased estimators", section 5;
//! the pairing of halves Blanchet & Glynn 2015. Unbiased; may be negative. Cost: 5.4 times the coarsest march.

use tyndall_lanes::Random;

use super::ray_marching::marched_thickness;
use crate::along_ray::{AlongRay, Lookups};
use crate::properties::{MajorantUse, Properties};

pub(super) const PROPERTIES: Properties = Properties {
    name: "telescoping-ray-marching",
    unbiased: true,
    majorant: MajorantUse::None,
    needs: &[],
    source: "Misso et al. 2022",
};

/// r: probability that the next finer level is drawn.
const FINER: f64 = 0.353_553_390_593_273_8;
/// Most steps of the coarsest march.
const MOST_STEPS: f64 = 1e5;

pub(super) fn estimate(ray: &AlongRay, random: &mut Random, lookups: &mut Lookups) -> f64 {
    let coarsest = ray.majorant_thickness().ceil().clamp(1.0, MOST_STEPS) as u64;
    let base = libm::exp(-marched_thickness(ray, coarsest, random.f64(), lookups));
    let (mut steps, mut probability) = (coarsest, 1.0 - FINER);
    while random.f64() < FINER {
        steps *= 2;
        probability *= FINER;
    }
    let offset = random.f64();
    // The halves of a march of 2·steps from `offset` are marches of `steps` from half of it, and from that and a half.
    let even = marched_thickness(ray, steps, 0.5 * offset, lookups);
    let odd = marched_thickness(ray, steps, 0.5 * (offset + 1.0), lookups);
    let fine = libm::exp(-0.5 * (even + odd));
    let coarse = 0.5 * (libm::exp(-even) + libm::exp(-odd));
    base + (fine - coarse) / probability
}
