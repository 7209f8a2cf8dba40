//! Draine's phase function, which joins Henyey-Greenstein (α = 0), Cornette-Shanks (α = 1) and Rayleigh (g = 0, α = 1):
//!
//!   (1 − g²)(1 + α cos² θ) / (4π K (1 + g² − 2 g cos θ)^{3/2}),   K = 1 + α (1 + 2 g²)/3
//!
//! Sources: Draine 2003, "Scattering by interstellar dust grains. I", eq. 8; Cornette & Shanks 1992, "Physically
//! reasonable analytic expression for the single-scattering phase function", eq. 8.
//!
//! Its mean cosine is g (1 + α (3 + 2 g²)/5)/K. With v and s as in [`super::henyey_greenstein`], integration by parts of
//! cos² θ against the Henyey-Greenstein distribution gives the cumulative distribution
//!
//!   F = (1 − g)/(2K) · [ (1 + α cos² θ) v/s + α v² (1 − (2/3)(1 + g) v + g v²/4) ],
//!
//! which, again, does not divide by g. F = u is a quartic in v. It is solved by Newton's method between bounds, to the
//! last digits: its closed-form roots cancel badly for small g.

use std::f64::consts::PI;

use super::henyey_greenstein::{cosine, sample_v, squared_distance};

pub(super) fn value(g: f64, alpha: f64, cos_theta: f64) -> f64 {
    let s2 = squared_distance(g, cos_theta);
    (1.0 - g * g) * (1.0 + alpha * cos_theta * cos_theta) / (4.0 * PI * norm(g, alpha) * s2 * s2.sqrt())
}

fn norm(g: f64, alpha: f64) -> f64 {
    1.0 + alpha * (1.0 + 2.0 * g * g) / 3.0
}

pub(super) fn mean_cosine(g: f64, alpha: f64) -> f64 {
    g * (1.0 + alpha * (3.0 + 2.0 * g * g) / 5.0) / norm(g, alpha)
}

pub(super) fn sample(g: f64, alpha: f64, u: f64) -> f64 {
    let (mut low, mut high) = (0.0, 2.0);
    let mut v = sample_v(g, u);
    // Bisection alone would take 53; Newton takes about five.
    for _ in 0..100 {
        let excess = cumulative(g, alpha, v) - u;
        if excess > 0.0 {
            high = v
        } else {
            low = v
        }
        let newton = v - excess / derivative(g, alpha, v);
        let next = if low < newton && newton < high { newton } else { 0.5 * (low + high) };
        if (next - v).abs() <= 1e-15 {
            break;
        }
        v = next;
    }
    cosine(g, v)
}

/// F at v.
fn cumulative(g: f64, alpha: f64, v: f64) -> f64 {
    let s = 1.0 + g - g * v;
    let cos = cosine(g, v);
    let polynomial = v * v * (1.0 - 2.0 / 3.0 * (1.0 + g) * v + 0.25 * g * v * v);
    (1.0 - g) / (2.0 * norm(g, alpha)) * ((1.0 + alpha * cos * cos) * v / s + alpha * polynomial)
}

/// dF/dv = 2π f_p d(cos θ)/dv, with d(cos θ)/dv = s.
fn derivative(g: f64, alpha: f64, v: f64) -> f64 {
    let s = 1.0 + g - g * v;
    let cos = cosine(g, v);
    (1.0 - g * g) * (1.0 + alpha * cos * cos) / (2.0 * norm(g, alpha) * s * s)
}
