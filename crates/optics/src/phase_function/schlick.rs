//! Schlick's phase function: (1 − k²) / (4π (1 − k cos θ)²), close to Henyey and Greenstein's at k = 1.55 g − 0.55 g³
//! and cheaper to evaluate.
//!
//! Source: Blasi, Le Saëc & Schlick 1993, "A rendering algorithm for discrete volume density objects", with the sign of
//! k such that k > 0 is forward.

use std::f64::consts::PI;

pub(super) fn value(k: f64, cos_theta: f64) -> f64 {
    // 1 − k cos θ without cancellation at the peak.
    let denominator = 1.0 - k.abs() + k.abs() * (1.0 - cos_theta * k.signum());
    (1.0 - k * k) / (4.0 * PI * denominator * denominator)
}

pub(super) fn sample(k: f64, u: f64) -> f64 {
    (2.0 * u + k - 1.0) / (2.0 * k * u - k + 1.0)
}

/// 1/k − (1 − k²) artanh(k)/k² = Σ 2 k^{2n−1}/((2n − 1)(2n + 1)); the sum where the closed form would cancel.
pub(super) fn mean_cosine(k: f64) -> f64 {
    if k.abs() > 0.1 {
        return 1.0 / k - (1.0 - k * k) * libm::atanh(k) / (k * k);
    }
    (1..10).map(|n| 2.0 * k.powi(2 * n - 1) / f64::from((2 * n - 1) * (2 * n + 1))).sum()
}
