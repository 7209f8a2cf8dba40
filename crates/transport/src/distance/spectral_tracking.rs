//! Spectral tracking: one flight for all channels of a chromatic medium, with a weight for each.
//!
//! Tentative collisions have the rate μ̄ of the densest channel. One is real with the same probability for all,
//!
//!   P = Σ|wᵢ μt,ᵢ| / Σ(|wᵢ μt,ᵢ| + |wᵢ μn,ᵢ|),    real: wᵢ ← wᵢ μt,ᵢ/(μ̄ P),    null: wᵢ ← wᵢ μn,ᵢ/(μ̄ (1 − P))
//!
//! with μn,ᵢ = μ̄ − μt,ᵢ, where the weights so far (and the path's throughput) keep the channels that count from growing
//! ("history-aware" probabilities). Source: Kutz, Habel, Li & Novák 2017. Unbiased. In a grey medium the weights stay equal
//! and it is delta tracking. Expected lookups: ∫ μ̄ along the flight.

use std::ops::ControlFlow;

use glam::DVec3;
use tyndall_lanes::Random;

use super::Flight;
use crate::along_ray::{AlongRay, Lookups, tentative_collisions};
use crate::properties::{MajorantUse, Properties};

pub(super) const PROPERTIES: Properties = Properties {
    name: "spectral-tracking",
    unbiased: true,
    majorant: MajorantUse::Bounding,
    needs: &[],
    source: "Kutz et al. 2017",
};

/// A [`Flight`] with a weight for each of three channels.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ChromaticFlight {
    /// Distance of the collision.
    pub t: Option<f64>,
    /// Weights of the collision; 0 if there is none.
    pub weight: DVec3,
    /// Weights of what arrives from beyond the ray's end.
    pub escape: DVec3,
}

impl ChromaticFlight {
    /// One flight along a ray where the extinction of each channel is that of `ray` times its `tint`, which is nowhere
    /// negative; `throughput` is what the weights will be multiplied by.
    pub fn sample(
        ray: &AlongRay,
        tint: DVec3,
        throughput: DVec3,
        random: &mut Random,
        lookups: &mut Lookups,
    ) -> Self {
        let densest = tint.max_element();
        let mut weight = DVec3::ONE;
        let flight = tentative_collisions(
            ray,
            |piece| densest * piece.majorant,
            random,
            |at, random| {
                let real = tint * ray.mu_t(at.t, lookups) / at.rate;
                let null = DVec3::ONE - real;
                let counts = |part: DVec3| (weight * throughput * part).abs().element_sum();
                let (real_counts, null_counts) = (counts(real), counts(null));
                let whole = real_counts + null_counts;
                if whole <= 0.0 {
                    weight = DVec3::ZERO;
                    return ControlFlow::Break(at.t);
                }
                if random.f64() * whole < real_counts {
                    weight *= real * (whole / real_counts);
                    ControlFlow::Break(at.t)
                } else {
                    weight *= null * (whole / null_counts);
                    ControlFlow::Continue(())
                }
            },
        );
        match flight.break_value() {
            Some(t) => Self { t: Some(t), weight, escape: DVec3::ZERO },
            None => Self { t: None, weight: DVec3::ZERO, escape: weight },
        }
    }
}

pub(super) fn sample_grey(ray: &AlongRay, random: &mut Random, lookups: &mut Lookups) -> Flight {
    let flight = ChromaticFlight::sample(ray, DVec3::ONE, DVec3::ONE, random, lookups);
    Flight { t: flight.t, weight: flight.weight.x, escape: flight.escape.x }
}
