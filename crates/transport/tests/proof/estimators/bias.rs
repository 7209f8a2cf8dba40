//! Ray marching is biased as it says, and its bias vanishes at the stated order.
//!
//! On a ramp of the extinction from μ₀ to μ₁ over a ray of length L, a march of n steps from a random offset ξ finds
//! τ + (μ₁ − μ₀)(L/n)(ξ − ½), whose exponential has the mean exp(−τ)·sinh(a)/a with a = (μ₁ − μ₀)L/(2n): the relative bias is
//! a²/6 + …, of the second order in the step.

use tyndall_transport::along_ray::{AlongRay, Profile};
use tyndall_transport::{DistanceSampler, TransmittanceEstimator, repeat_distance, repeat_transmittance};

use super::effort;
use crate::fresh;
use crate::statistics::two_sided_quantile;

const RAMP: f64 = 6.0;

fn ramp() -> AlongRay<'static> {
    AlongRay::with_profile(Profile::PiecewiseLinear(vec![(0.0, 0.0), (1.0, RAMP)]), 1.0, 1)
}

fn biased_mean(steps: u32) -> f64 {
    let a = RAMP / (2.0 * f64::from(steps));
    (-0.5 * RAMP).exp() * a.sinh() / a
}

/// At a level of 1e-3 for all numbers of steps together.
#[test]
fn ray_marched_transmittance_has_the_bias_of_the_second_order() {
    let truth = f64::exp(-0.5 * RAMP);
    let mut points = Vec::new();
    for steps in [2, 4, 8, 16] {
        let estimator = TransmittanceEstimator::RayMarching { steps };
        let found = repeat_transmittance(estimator, &ramp(), 200_000 * effort(), fresh::seed(1));
        let z = found.z(biased_mean(steps));
        assert!(z.abs() < two_sided_quantile(1e-3 / 4.0), "{steps} steps: {found:?}, z = {z}");
        assert_eq!(found.lookups, f64::from(steps));
        points.push((f64::from(steps).ln(), (found.mean / truth - 1.0).ln()));
    }
    let slope = slope(&points);
    // sinh grows faster than its second order, which is seen at two steps.
    assert!((slope + 2.0).abs() < 0.15, "order {slope}");
}

/// At a level of 1e-3 for all together.
#[test]
fn ray_marched_distances_escape_with_the_biased_transmittance() {
    for steps in [1, 2, 4, 64] {
        let sampler = DistanceSampler::RayMarching { steps };
        let found =
            repeat_distance(sampler, &ramp(), 100_000 * effort(), fresh::seed(2), |flight| flight.escape);
        let z = found.z(biased_mean(steps));
        assert!(z.abs() < two_sided_quantile(1e-3 / 4.0), "{steps} steps: {found:?}, z = {z}");
    }
}

/// Least-squares slope.
fn slope(points: &[(f64, f64)]) -> f64 {
    let n = points.len() as f64;
    let (mean_x, mean_y) =
        (points.iter().map(|p| p.0).sum::<f64>() / n, points.iter().map(|p| p.1).sum::<f64>() / n);
    let covariance: f64 = points.iter().map(|p| (p.0 - mean_x) * (p.1 - mean_y)).sum();
    covariance / points.iter().map(|p| (p.0 - mean_x).powi(2)).sum::<f64>()
}
