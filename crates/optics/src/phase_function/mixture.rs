//! A mixture of two phase functions: w f₁ + (1 − w) f₂.
//!
//! It is sampled exactly by choosing the first with probability w. The random number that chooses is stretched and
//! used again, so that one is enough.

use super::PhaseFunction;

/// Two phase functions and the probability of the first.
#[derive(Debug, Clone, PartialEq)]
pub struct Mixture {
    weight: f64,
    parts: [PhaseFunction; 2],
}

impl Mixture {
    pub(super) fn new(weight: f64, parts: [PhaseFunction; 2]) -> Mixture {
        debug_assert!(!parts.iter().any(|part| matches!(part, PhaseFunction::Sggx(_))));
        Mixture { weight, parts }
    }

    /// Probability of the first part.
    pub fn weight(&self) -> f64 {
        self.weight
    }

    /// The two parts.
    pub fn parts(&self) -> &[PhaseFunction; 2] {
        &self.parts
    }

    pub(super) fn value(&self, cos_theta: f64) -> f64 {
        self.mean(|part| part.value_at_cosine(cos_theta))
    }

    pub(super) fn mean_cosine(&self) -> f64 {
        self.mean(PhaseFunction::mean_cosine)
    }

    fn mean(&self, quantity: impl Fn(&PhaseFunction) -> f64) -> f64 {
        self.weight * quantity(&self.parts[0]) + (1.0 - self.weight) * quantity(&self.parts[1])
    }

    pub(super) fn sample(&self, u: f64) -> f64 {
        if u < self.weight {
            self.parts[0].sample_cosine(u / self.weight)
        } else {
            self.parts[1].sample_cosine((u - self.weight) / (1.0 - self.weight))
        }
    }
}
