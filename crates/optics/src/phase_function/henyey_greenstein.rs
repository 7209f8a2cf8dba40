//! The phase function of Henyey and Greenstein: (1 − g²) / (4π (1 + g² − 2 g cos θ)^{3/2}).
//!
//! Source: Henyey & Greenstein 1941, "Diffuse radiation in the galaxy", eq. 2. `g` in (−1, 1) is the mean cosine.
//!
//! The inversion is written in v = (1 + cos θ)·2/(1 + g + s) with s² = 1 + g² − 2 g cos θ, which runs from 0 to 2:
//! then s = 1 + g − g v, cos θ = −1 + (1 + g) v − g v²/2, and the cumulative distribution is (1 − g) v/(2 s). None of
//! them divides by g, so that they keep their digits when g goes to 0.

use std::f64::consts::PI;

pub(super) fn value(g: f64, cos_theta: f64) -> f64 {
    let s2 = squared_distance(g, cos_theta);
    (1.0 - g * g) / (4.0 * PI * s2 * s2.sqrt())
}

/// s² = 1 + g² − 2 g cos θ, without cancellation at the peak.
pub(super) fn squared_distance(g: f64, cos_theta: f64) -> f64 {
    if g >= 0.0 {
        (1.0 - g) * (1.0 - g) + 2.0 * g * (1.0 - cos_theta)
    } else {
        (1.0 + g) * (1.0 + g) - 2.0 * g * (1.0 + cos_theta)
    }
}

pub(super) fn sample(g: f64, u: f64) -> f64 {
    cosine(g, sample_v(g, u))
}

/// v at which the cumulative distribution is `u`.
pub(super) fn sample_v(g: f64, u: f64) -> f64 {
    2.0 * u * (1.0 + g) / (1.0 - g + 2.0 * g * u)
}

/// cos θ at v.
pub(super) fn cosine(g: f64, v: f64) -> f64 {
    -1.0 + (1.0 + g) * v - 0.5 * g * v * v
}
