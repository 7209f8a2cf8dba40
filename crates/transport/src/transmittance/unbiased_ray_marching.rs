//! Unbiased ray marching: the power series of exp(−τ) about ray-marched estimates of τ.
//!
//!   T = e^(−p) Σₖ (p − τ)ᵏ/k!
//!
//! N + 1 independent estimates X of τ are marched, each by M lookups at equal steps from a random offset. Each takes its turn
//! as the pivot p; the powers (p − τ)ᵏ are estimated without bias by elementary symmetric means (U-statistics) of the other
//! N, and the mean over the turns is taken. The order N at which the series is cut is drawn by the roulette of Bhanot &
//! Kennedy (1985): N = 0 with probability 0.9, as the pivot alone is nearly right; else at least 2, and past k − 1 with
//! probability 2/k.
//!
//! Source: Kettunen, d'Eon, Pantaleoni & Novák 2021, "An unbiased ray-marching transmittance estimator"; M from their fit to
//! the cost of the p-series estimator, by the optical thickness of the majorant. Unbiased; may be negative or above 1.
//! Cost: about 1.3·M lookups.

use tyndall_lanes::Random;

use super::ray_marching::marched_thickness;
use crate::along_ray::{AlongRay, Lookups};
use crate::properties::{MajorantUse, Properties};

pub(super) const PROPERTIES: Properties = Properties {
    name: "unbiased-ray-marching",
    unbiased: true,
    majorant: MajorantUse::NonBounding,
    needs: &[],
    source: "Kettunen et al. 2021",
};

/// Probability that the series goes beyond the pivot.
const PROBABILITY_OF_A_SERIES: f64 = 0.1;
/// Order up to which a series goes for certain, and the numerator of the later probabilities of going on.
const CERTAIN_ORDER: usize = 2;
/// Mean of the order N: 0.1·(2 + Σ over k > 2 of 2^(k−2)·2!/k!) = 0.1·(2 + (e² − 5)/2).
const MEAN_ORDER: f64 = 0.319_452_804_946_532_5;
/// Most lookups of a march: there e^(−τ) is 0, or the majorant much too loose.
const MOST_STEPS: f64 = 1e5;

pub(super) fn estimate(ray: &AlongRay, random: &mut Random, lookups: &mut Lookups) -> f64 {
    let steps = steps(ray.majorant_thickness());
    let inverse_probabilities = draw_order(random);
    let estimates: Vec<f64> = (0..inverse_probabilities.len())
        .map(|_| marched_thickness(ray, steps, random.f64(), lookups))
        .collect();
    let turns = estimates.iter().enumerate().map(|(pivot_index, &pivot)| {
        let others = estimates.iter().enumerate().filter(|(i, _)| *i != pivot_index);
        let means = elementary_symmetric_means(others.map(|(_, x)| pivot - x));
        let mut factorial = 1.0;
        let series: f64 = means
            .iter()
            .zip(&inverse_probabilities)
            .enumerate()
            .map(|(k, (mean, inverse_probability))| {
                factorial *= k.max(1) as f64;
                mean * inverse_probability / factorial
            })
            .sum();
        libm::exp(-pivot) * series
    });
    turns.sum::<f64>() / estimates.len() as f64
}

/// Lookups of each march under the optical thickness `tau` of the majorant.
fn steps(tau: f64) -> u64 {
    let p_series_cost = libm::cbrt((0.015 + tau) * (0.65 + tau) * (60.3 + tau)).ceil();
    (p_series_cost / (1.0 + MEAN_ORDER)).round().clamp(1.0, MOST_STEPS) as u64
}

/// One over the probability that the series reaches order k, for k = 0 … N.
fn draw_order(random: &mut Random) -> Vec<f64> {
    let mut inverse_probabilities = vec![1.0];
    let mut probability = PROBABILITY_OF_A_SERIES;
    let u = random.f64();
    while u < probability {
        inverse_probabilities.push(1.0 / probability);
        let next = inverse_probabilities.len();
        if next > CERTAIN_ORDER {
            probability *= CERTAIN_ORDER as f64 / next as f64;
        }
    }
    inverse_probabilities
}

/// For k = 0 … n the mean, over all choices of k of the n values, of their product.
fn elementary_symmetric_means(values: impl Iterator<Item = f64>) -> Vec<f64> {
    let mut means = vec![1.0];
    for (n, value) in (1..).zip(values) {
        means.push(0.0);
        for k in (1..=n).rev() {
            let share = k as f64 / n as f64;
            means[k] += share * (value * means[k - 1] - means[k]);
        }
    }
    means
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn elementary_symmetric_means_are_those_of_their_definition() {
        let [a, b, c] = [2.0, -1.0, 5.0];
        let means = elementary_symmetric_means([a, b, c].into_iter());
        let truth = [1.0, (a + b + c) / 3.0, (a * b + a * c + b * c) / 3.0, a * b * c];
        assert!(means.iter().zip(truth).all(|(mean, truth)| (mean - truth).abs() < 1e-14), "{means:?}");
    }

    /// At a level of 1e-4: mean and variance of N are known to a few per mille.
    #[test]
    fn orders_have_the_stated_mean() {
        let mut random = Random::new(1, 0, 0);
        let orders: Vec<f64> = (0..200_000).map(|_| draw_order(&mut random).len() as f64 - 1.0).collect();
        let mean = orders.iter().sum::<f64>() / 2e5;
        let variance = orders.iter().map(|n| (n - mean).powi(2)).sum::<f64>() / 2e5;
        assert!((mean - MEAN_ORDER).abs() < 3.9 * (variance / 2e5).sqrt(), "{mean}");
    }
}
