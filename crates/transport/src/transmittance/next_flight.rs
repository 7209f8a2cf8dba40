//! Next-flight estimation: from the start, and from every tentative collision, what is expected to get through in one flight.
//!
//!   X = Σ wᵢ exp(−∫ μ̄ from tᵢ to the end),   i = 0 the start, w₀ = 1
//!
//! Weighted, wᵢ is the product of (1 − μt/μ̄) so far, as in ratio tracking; analog, wᵢ is 1 until the first real collision
//! ends the walk. Source: Cramer 1978, "Application of the fictitious scattering model for deep-penetration problems";
//! Novák et al. 2018, section 4.2. Unbiased; the weighted form also where the majorant does not bound. Without variance where
//! μ̄ = μt, but worse than ratio tracking under a loose majorant. Expected lookups: ∫ μ̄ (analog: ∫ μ̄ T).

use std::ops::ControlFlow;

use tyndall_lanes::Random;

use crate::along_ray::{AlongRay, Lookups, tentative_collisions};
use crate::properties::{MajorantUse, Properties};

pub(super) const PROPERTIES: Properties = Properties {
    name: "next-flight",
    unbiased: true,
    majorant: MajorantUse::NonBounding,
    needs: &[],
    source: "Cramer 1978",
};

pub(super) const ANALOG: Properties =
    Properties { name: "next-flight-analog", majorant: MajorantUse::Bounding, ..PROPERTIES };

pub(super) fn estimate(ray: &AlongRay, random: &mut Random, lookups: &mut Lookups) -> f64 {
    let whole = ray.majorant_thickness();
    let (mut sum, mut weight) = (libm::exp(-whole), 1.0);
    let _ = tentative_collisions(
        ray,
        |piece| piece.majorant,
        random,
        |at, _| {
            weight *= 1.0 - ray.mu_t(at.t, lookups) / at.rate;
            sum += weight * libm::exp(at.depth - whole);
            if at.is_hopeless(weight) { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
        },
    );
    sum
}

pub(super) fn estimate_analog(ray: &AlongRay, random: &mut Random, lookups: &mut Lookups) -> f64 {
    let whole = ray.majorant_thickness();
    let mut sum = libm::exp(-whole);
    let _ = tentative_collisions(
        ray,
        |piece| piece.majorant,
        random,
        |at, random| {
            if random.f64() * at.rate < ray.mu_t(at.t, lookups) {
                return ControlFlow::Break(());
            }
            sum += libm::exp(at.depth - whole);
            ControlFlow::Continue(())
        },
    );
    sum
}
