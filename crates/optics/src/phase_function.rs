//! Phase functions f_p(cos θ): the density, per unit solid angle, of the direction after a scattering event.
//!
//! cos θ is taken between the directions that light travels before and after: +1 is forward, g > 0 is forward.
//! Each integrates to 1 over the sphere, and each is sampled exactly, so a sample's weight is 1.

use glam::DVec3;
use std::f64::consts::{PI, TAU};

/// A phase function.
#[derive(Debug, Clone, PartialEq)]
pub enum PhaseFunction {
    /// 1/(4π).
    Isotropic,
    /// Henyey & Greenstein 1941, "Diffuse radiation in the galaxy", eq. 2, with mean cosine `g` in (−1, 1):
    /// (1 − g²) / (4π (1 + g² − 2 g cos θ)^{3/2}).
    HenyeyGreenstein {
        /// Mean cosine.
        g: f64,
    },
}

impl PhaseFunction {
    /// Value in 1/sr for light that travels along the unit vector `before` and then along `after`, which is also the
    /// density with which [`PhaseFunction::sample`] gives that direction.
    pub fn value(&self, before: DVec3, after: DVec3) -> f64 {
        self.value_at_cosine(before.dot(after))
    }

    /// Value in 1/sr at cos θ.
    pub fn value_at_cosine(&self, cos_theta: f64) -> f64 {
        match *self {
            PhaseFunction::Isotropic => 0.25 / PI,
            PhaseFunction::HenyeyGreenstein { g } => {
                let denominator = 1.0 + g * g - 2.0 * g * cos_theta;
                (1.0 - g * g) / (4.0 * PI * denominator * denominator.sqrt())
            }
        }
    }

    /// cos θ by inverting the cumulative distribution at `u` in [0, 1).
    pub fn sample_cosine(&self, u: f64) -> f64 {
        match *self {
            PhaseFunction::HenyeyGreenstein { g } if g.abs() > 1e-4 => {
                let ratio = (1.0 - g * g) / (1.0 - g + 2.0 * g * u);
                ((1.0 + g * g - ratio * ratio) / (2.0 * g)).clamp(-1.0, 1.0)
            }
            // Below |g| = 1e-4 the inverse loses its digits: to that order f_p = (1 + 3 g cos θ)/(4π), whose
            // cumulative distribution is inverted to first order in g.
            PhaseFunction::HenyeyGreenstein { g } => {
                let isotropic = 2.0 * u - 1.0;
                (isotropic + 1.5 * g * (1.0 - isotropic * isotropic)).clamp(-1.0, 1.0)
            }
            PhaseFunction::Isotropic => 2.0 * u - 1.0,
        }
    }

    /// A direction after scattering of light that travels along the unit vector `before`.
    pub fn sample(&self, before: DVec3, u: [f64; 2]) -> DVec3 {
        let cos_theta = self.sample_cosine(u[0]);
        let sin_theta = (1.0 - cos_theta * cos_theta).max(0.0).sqrt();
        let (sin_phi, cos_phi) = (TAU * u[1]).sin_cos();
        let (tangent, bitangent) = before.any_orthonormal_pair();
        (tangent * (sin_theta * cos_phi) + bitangent * (sin_theta * sin_phi) + before * cos_theta).normalize()
    }

    /// ∫ f_p cos θ dω.
    pub fn mean_cosine(&self) -> f64 {
        match *self {
            PhaseFunction::Isotropic => 0.0,
            PhaseFunction::HenyeyGreenstein { g } => g,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const KINDS: [PhaseFunction; 7] = [
        PhaseFunction::Isotropic,
        PhaseFunction::HenyeyGreenstein { g: 0.0 },
        PhaseFunction::HenyeyGreenstein { g: 5e-5 },
        PhaseFunction::HenyeyGreenstein { g: -0.6 },
        PhaseFunction::HenyeyGreenstein { g: 0.3 },
        PhaseFunction::HenyeyGreenstein { g: 0.85 },
        PhaseFunction::HenyeyGreenstein { g: 0.98 },
    ];

    /// ∫ f(cos θ) f_p dω over cos θ > `limit`, by the midpoint rule in v where cos θ = 1 − 2 v² crowds the
    /// forward peak.
    fn integrate(phase: &PhaseFunction, limit: f64, f: impl Fn(f64) -> f64) -> f64 {
        let n = 100_000;
        let end = ((1.0 - limit) / 2.0).sqrt();
        (0..n)
            .map(|i| {
                let v = (i as f64 + 0.5) / n as f64 * end;
                let cos = 1.0 - 2.0 * v * v;
                f(cos) * phase.value_at_cosine(cos) * TAU * 4.0 * v * end / n as f64
            })
            .sum()
    }

    #[test]
    fn phase_functions_integrate_to_one_with_mean_cosine_g() {
        for phase in &KINDS {
            assert!((integrate(phase, -1.0, |_| 1.0) - 1.0).abs() < 1e-7, "{phase:?}");
            assert!((integrate(phase, -1.0, |c| c) - phase.mean_cosine()).abs() < 1e-7, "{phase:?}");
        }
    }

    /// At each sampled cosine the cumulative distribution, by quadrature, must give u back.
    #[test]
    fn sampling_inverts_the_cumulative_distribution() {
        for phase in &KINDS {
            for i in 1..100 {
                let u = i as f64 / 100.0;
                let limit = phase.sample_cosine(u);
                let above = integrate(phase, limit, |_| 1.0);
                assert!((1.0 - above - u).abs() < 1e-7, "{phase:?} at {u}: {above}");
            }
        }
    }

    #[test]
    fn sampled_directions_are_unit_and_turn_by_the_sampled_angle() {
        let phase = PhaseFunction::HenyeyGreenstein { g: 0.7 };
        for before in [DVec3::X, DVec3::NEG_Z, DVec3::new(0.6, -0.64, 0.48)] {
            for i in 0..50 {
                let u = [(i as f64 + 0.5) / 50.0, (i as f64 * 0.618_034).fract()];
                let after = phase.sample(before, u);
                assert!((after.length() - 1.0).abs() < 1e-12);
                assert!((after.dot(before) - phase.sample_cosine(u[0])).abs() < 1e-12);
            }
        }
    }
}
