//! Two materials side by side, as a mosaic too fine to be seen: f = w₁ f₁ + w₂ f₂, drawn from one of them with the
//! probability of its mean share.

use glam::{DVec3, DVec4};

use super::{Bsdf, BsdfSample};

/// Two materials and their shares.
#[derive(Debug, Clone, PartialEq)]
pub struct Mix {
    /// The two.
    pub parts: [Bsdf; 2],
    /// What each is multiplied by, in each channel; 0 in lanes that are no channel.
    pub shares: [DVec4; 2],
}

impl Mix {
    pub(super) fn sample(&self, wo: DVec3, choice: f64, u: [f64; 2]) -> Option<BsdfSample> {
        let [first, second] = self.probabilities();
        let (part, choice) =
            if choice < first { (0, choice / first) } else { (1, (choice - first) / second) };
        // Rounding must not lead out of [0, 1).
        let choice = choice.clamp(0.0, 1.0 - f64::EPSILON);
        let sample = self.parts[part].sample(wo, choice, u)?;
        if sample.is_delta {
            let weight = sample.weight * self.shares[part] / self.probabilities()[part];
            return Some(BsdfSample { weight, ..sample });
        }
        let pdf = self.pdf(wo, sample.wi);
        BsdfSample::if_sound(sample.wi, self.value(wo, sample.wi) / pdf, pdf, sample.radiance_scale)
    }

    pub(super) fn value(&self, wo: DVec3, wi: DVec3) -> DVec4 {
        self.shares[0] * self.parts[0].value(wo, wi) + self.shares[1] * self.parts[1].value(wo, wi)
    }

    pub(super) fn pdf(&self, wo: DVec3, wi: DVec3) -> f64 {
        let [first, second] = self.probabilities();
        first * self.parts[0].pdf(wo, wi) + second * self.parts[1].pdf(wo, wi)
    }

    pub(super) fn is_delta(&self) -> bool {
        self.parts.iter().all(Bsdf::is_delta)
    }

    pub(super) fn albedo(&self) -> DVec4 {
        self.shares[0] * self.parts[0].albedo() + self.shares[1] * self.parts[1].albedo()
    }

    fn probabilities(&self) -> [f64; 2] {
        let [first, second] = self.shares.map(DVec4::element_sum);
        let all = first + second;
        if all > 0.0 { [first / all, second / all] } else { [1.0, 0.0] }
    }
}
