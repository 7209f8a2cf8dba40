//! The optical properties of a medium: coefficients, phase function, emission.
//!
//! `mu_t = mu_a + mu_s` [1/length], `albedo = mu_s / mu_t`, mean free path `1 / mu_t`. For a grid the
//! coefficients are those where the grid's value is 1; elsewhere they are multiplied by the value.

use glam::DVec3;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::PhaseDescription;
use super::rgb::{Rgb, fraction};

/// The optical properties of a medium. Coefficients are given as exactly one of the pairs `mu_t` and
/// `albedo`, `mu_a` and `mu_s`, `mean_free_path` and `albedo`.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct MediumDescription {
    /// Extinction coefficient, per scene unit; grey.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 0))]
    pub mu_t: Option<f64>,
    /// Mean free path `1 / mu_t`, scene units.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub mean_free_path: Option<f64>,
    /// Single-scattering albedo `mu_s / mu_t`: the fraction of the light taken from a ray that is scattered.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(schema_with = "fraction")]
    pub albedo: Option<Rgb>,
    /// Absorption coefficient, per scene unit.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub mu_a: Option<Rgb>,
    /// Scattering coefficient, per scene unit.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub mu_s: Option<Rgb>,
    /// How scattered light is spread over directions.
    #[serde(default, skip_serializing_if = "super::is_default")]
    pub phase: PhaseDescription,
    /// Radiance Le of the glowing medium; the source term is `mu_a Le`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub emission: Option<Rgb>,
}

/// Coefficients ready for use: grey extinction, coloured albedo.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Coefficients {
    /// Extinction coefficient, per scene unit.
    pub mu_t: f64,
    /// Single-scattering albedo of each channel, 0 to 1.
    pub albedo: DVec3,
}

/// Relative difference of the channels of `mu_a + mu_s` that still counts as grey: decimals that were
/// rounded.
const GREY_TOLERANCE: f64 = 1e-6;

impl MediumDescription {
    /// The coefficients, whichever pair they were given as; or the key that is wrong and the mend.
    pub fn coefficients(&self) -> Result<Coefficients, (&'static str, String)> {
        match (self.mu_t, self.mean_free_path, self.albedo, self.mu_a, self.mu_s) {
            (Some(mu_t), None, Some(albedo), None, None) => {
                Ok(Coefficients { mu_t, albedo: albedo.channels() })
            }
            (None, Some(path), Some(albedo), None, None) => {
                Ok(Coefficients { mu_t: 1.0 / path, albedo: albedo.channels() })
            }
            (None, None, None, Some(mu_a), Some(mu_s)) => from_absorption_and_scattering(mu_a, mu_s),
            _ => Err(self.wrong_pair()),
        }
    }

    fn wrong_pair(&self) -> (&'static str, String) {
        let given: Vec<&str> = [
            ("mu_t", self.mu_t.is_some()),
            ("mean_free_path", self.mean_free_path.is_some()),
            ("albedo", self.albedo.is_some()),
            ("mu_a", self.mu_a.is_some()),
            ("mu_s", self.mu_s.is_some()),
        ]
        .into_iter()
        .filter_map(|(key, is_given)| is_given.then_some(key))
        .collect();
        let pairs =
            "give exactly one of the pairs `mu_t` + `albedo`, `mean_free_path` + `albedo`, `mu_a` + `mu_s`";
        match given.as_slice() {
            [] => ("", format!("the medium has no coefficients: {pairs}")),
            [one] => ("", format!("`{one}` alone does not say the coefficients: {pairs}")),
            [.., last] => {
                let list: Vec<String> = given.iter().map(|key| format!("`{key}`")).collect();
                (last, format!("the coefficients are given as {}: {pairs}", list.join(" and ")))
            }
        }
    }
}

fn from_absorption_and_scattering(mu_a: Rgb, mu_s: Rgb) -> Result<Coefficients, (&'static str, String)> {
    let sum = mu_a.channels() + mu_s.channels();
    if sum.max_element() - sum.min_element() > GREY_TOLERANCE * sum.max_element() {
        return Err((
            "mu_s",
            format!(
                "`mu_a` + `mu_s` is {}, {}, {} in red, green, blue: extinction that depends on colour is not \
                 rendered yet; make the sum equal in all channels",
                sum.x, sum.y, sum.z
            ),
        ));
    }
    let mu_t = sum.element_sum() / 3.0;
    let albedo = if mu_t > 0.0 { (mu_s.channels() / mu_t).min(DVec3::ONE) } else { DVec3::ZERO };
    Ok(Coefficients { mu_t, albedo })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn all_pairs_say_the_same_medium() {
        let albedo = Some(Rgb::Channels([0.75, 0.5, 0.25]));
        let by_extinction = MediumDescription { mu_t: Some(4.0), albedo, ..Default::default() };
        let by_path = MediumDescription { mean_free_path: Some(0.25), albedo, ..Default::default() };
        let by_parts = MediumDescription {
            mu_a: Some(Rgb::Channels([1.0, 2.0, 3.0])),
            mu_s: Some(Rgb::Channels([3.0, 2.0, 1.0])),
            ..Default::default()
        };
        let expected = Coefficients { mu_t: 4.0, albedo: DVec3::new(0.75, 0.5, 0.25) };
        for medium in [by_extinction, by_path, by_parts] {
            assert_eq!(medium.coefficients(), Ok(expected));
        }
    }

    #[test]
    fn coloured_extinction_and_mixed_pairs_are_refused() {
        let coloured = MediumDescription {
            mu_a: Some(Rgb::Grey(1.0)),
            mu_s: Some(Rgb::Channels([3.0, 2.0, 1.0])),
            ..Default::default()
        };
        assert_eq!(coloured.coefficients().unwrap_err().0, "mu_s");
        let mixed = MediumDescription {
            mu_t: Some(1.0),
            albedo: Some(Rgb::Grey(0.5)),
            mu_a: Some(Rgb::Grey(0.5)),
            ..Default::default()
        };
        assert_eq!(mixed.coefficients().unwrap_err().0, "mu_a");
        assert_eq!(MediumDescription::default().coefficients().unwrap_err().0, "");
    }
}
