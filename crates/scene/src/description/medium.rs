//! The optical properties of a medium: coefficients, phase function, emission.
//!
//! `mu_t = mu_a + mu_s` [1/length], `albedo = mu_s / mu_t`, mean free path `1 / mu_t`. For a grid the
//! coefficients are those where the grid's value is 1; elsewhere they are multiplied by the value.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use tyndall_optics::Spectrum;
use tyndall_optics::albedo_inversion::albedo_of_reflectance;
use tyndall_optics::presets::{MEASURED_MEDIA, MeasuredMedium, measured_medium};

use super::PhaseDescription;
use super::particles::ParticlesDescription;
use super::spectrum::{KeyProblem, SpectrumDescription, fraction, positive};
use super::units::unit_in_metres;
use crate::SpectralCoefficients;

/// The optical properties of a medium. Coefficients are given in exactly one way: `mu_t` and `albedo`, `mu_a` and
/// `mu_s`, `mean_free_path` and `albedo`, `mean_free_path` and `reflectance`, a `preset`, or
/// `particles`.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct MediumDescription {
    /// Extinction coefficient, per scene unit.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub mu_t: Option<SpectrumDescription>,
    /// Mean free path `1 / mu_t`, scene units.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(schema_with = "positive")]
    pub mean_free_path: Option<SpectrumDescription>,
    /// Single-scattering albedo `mu_s / mu_t`: the fraction of the light taken from a ray that is scattered.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(schema_with = "fraction")]
    pub albedo: Option<SpectrumDescription>,
    /// Fraction of diffuse light that a thick layer of the medium reflects; the albedo is computed from it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(schema_with = "fraction")]
    pub reflectance: Option<SpectrumDescription>,
    /// Absorption coefficient, per scene unit.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub mu_a: Option<SpectrumDescription>,
    /// Scattering coefficient, per scene unit.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub mu_s: Option<SpectrumDescription>,
    /// Name of a measured medium (Jensen et al. 2001, Narasimhan et al. 2006), such as `skimmilk`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub preset: Option<String>,
    /// Spheres by Lorenz-Mie theory, which gives the phase function too.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub particles: Option<ParticlesDescription>,
    /// Factor on the coefficients.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 0))]
    pub scale: Option<f64>,
    /// How scattered light is spread over directions; equally unless given, or as the preset was measured.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub phase: Option<PhaseDescription>,
    /// Radiance Le of the glowing medium; the source term is `mu_a Le`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub emission: Option<SpectrumDescription>,
    /// Radiance per scene unit that the medium adds to a ray, whatever it absorbs; multiplied by the density, or by the
    /// `emission_grid` if there is one (inside a shape; beside a density grid as well).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub emission_per_length: Option<SpectrumDescription>,
}

/// The ways to give coefficients, for messages.
const WAYS: &str = "give exactly one of the pairs `mu_t` + `albedo`, `mean_free_path` + `albedo`, \
                    `mean_free_path` + `reflectance`, `mu_a` + `mu_s`, a `preset`, or `particles`";

/// Greatest extinction: products of a few such numbers stay finite.
const GREATEST: f64 = 1e30;

impl MediumDescription {
    /// The coefficients, per scene unit, in whichever way they were given; or the path of the key that is wrong (empty
    /// for the medium itself) and the mend.
    ///
    /// Those of particles are computed when the scene is built, see [`particles_violation`](Self::particles_violation).
    ///
    /// `unit` is the name of the scene's unit, which measured media need; `g` is the mean cosine of the phase function,
    /// which a reflectance needs.
    pub fn coefficients(
        &self,
        unit: &str,
        g: f64,
    ) -> Result<SpectralCoefficients, (Vec<&'static str>, String)> {
        if self.particles.is_some() {
            return Err(self.wrong_pair());
        }
        type Form = Option<SpectrumDescription>;
        let read = |key: &'static str,
                    form: &Form,
                    role: fn(&SpectrumDescription) -> Result<Spectrum, KeyProblem>| {
            let spectrum = form.as_ref().map(role).transpose();
            spectrum.map_err(|(inner, message)| {
                let inner = Some(inner).filter(|inner| !inner.is_empty());
                (std::iter::once(key).chain(inner).collect::<Vec<_>>(), format!("`{key}`: {message}"))
            })
        };
        let mu_t = read("mu_t", &self.mu_t, SpectrumDescription::coefficient)?;
        let path = read("mean_free_path", &self.mean_free_path, SpectrumDescription::coefficient)?;
        let albedo = read("albedo", &self.albedo, SpectrumDescription::fraction)?;
        let reflectance = read("reflectance", &self.reflectance, SpectrumDescription::fraction)?;
        let mu_a = read("mu_a", &self.mu_a, SpectrumDescription::coefficient)?;
        let mu_s = read("mu_s", &self.mu_s, SpectrumDescription::coefficient)?;
        let coefficients = match (mu_t, path, albedo, reflectance, mu_a, mu_s, &self.preset) {
            (Some(mu_t), None, Some(albedo), None, None, None, None) => {
                SpectralCoefficients::ExtinctionAndAlbedo { mu_t, albedo }
            }
            (None, Some(path), Some(albedo), None, None, None, None) => {
                SpectralCoefficients::ExtinctionAndAlbedo { mu_t: reciprocal(&path)?, albedo }
            }
            (None, Some(path), None, Some(reflectance), None, None, None) => {
                let albedo = reflectance.map(|reflectance| albedo_of_reflectance(reflectance, g));
                SpectralCoefficients::ExtinctionAndAlbedo { mu_t: reciprocal(&path)?, albedo }
            }
            (None, None, None, None, Some(mu_a), Some(mu_s), None) => {
                SpectralCoefficients::AbsorptionAndScattering { mu_a, mu_s }
            }
            (None, None, None, None, None, None, Some(_)) => {
                let per_mm = 1e3
                    * unit_in_metres(unit).map_err(|message| {
                        (vec!["preset"], format!("a preset is in physical units: {message}"))
                    })?;
                let measured =
                    self.measured().map_err(|message| (vec!["preset"], format!("`preset`: {message}")))?;
                let [mu_a, mu_s] = [measured.mu_a, measured.mu_s].map(|rgb| Spectrum::Rgb(rgb * per_mm));
                SpectralCoefficients::AbsorptionAndScattering { mu_a, mu_s }
            }
            _ => return Err(self.wrong_pair()),
        };
        let coefficients = coefficients.scaled(self.scale.unwrap_or(1.0));
        let greatest = coefficients.mu_t_rgb().max_element();
        if !greatest.is_finite() || greatest > GREATEST {
            let keys = [
                ("scale", self.scale.is_some()),
                ("mean_free_path", self.mean_free_path.is_some()),
                ("mu_t", self.mu_t.is_some()),
                ("mu_s", self.mu_s.is_some()),
            ];
            let key =
                keys.into_iter().find_map(|(key, is_given)| is_given.then_some(key)).unwrap_or("preset");
            let message = format!(
                "`{key}` makes the extinction {greatest:e}: numbers beyond 1e30 are not computed with"
            );
            return Err((vec![key], message));
        }
        Ok(coefficients)
    }

    /// The path of the key of `particles` that is wrong, or that is given beside them, and the mend.
    pub fn particles_violation(&self, unit: &str) -> Option<(Vec<&'static str>, String)> {
        let particles = self.particles.as_ref()?;
        let ways =
            [&self.mu_t, &self.mean_free_path, &self.albedo, &self.reflectance, &self.mu_a, &self.mu_s];
        if ways.into_iter().any(Option::is_some) || self.preset.is_some() {
            return Some(self.wrong_pair());
        }
        if let Err(message) = unit_in_metres(unit) {
            return Some((vec!["particles"], format!("particles are in physical units: {message}")));
        }
        let (key, message) = particles.violation()?;
        let path = ["particles", key].into_iter().filter(|key| !key.is_empty()).collect();
        Some((path, message))
    }

    /// Mean cosine of the preset's phase function, if it was measured and `phase` does not say otherwise.
    pub fn preset_g(&self) -> Option<Spectrum> {
        let measured = self.measured().ok().filter(|_| self.phase.is_none())?;
        (measured.g.max_element() > 0.0).then_some(Spectrum::Rgb(measured.g))
    }

    fn measured(&self) -> Result<&'static MeasuredMedium, String> {
        let name = self.preset.as_deref().unwrap_or_default();
        measured_medium(name).ok_or_else(|| {
            let distance = |medium: &&MeasuredMedium| {
                strsim::damerau_levenshtein(&name.to_lowercase(), &medium.name.to_lowercase())
            };
            match MEASURED_MEDIA.iter().min_by_key(distance) {
                Some(nearest) if 2 * distance(&nearest) < nearest.name.len() => {
                    format!("there is no measured medium `{name}`, did you mean `{}`?", nearest.name)
                }
                _ => {
                    let names: Vec<String> =
                        MEASURED_MEDIA.iter().map(|medium| format!("`{}`", medium.name)).collect();
                    format!("there is no measured medium `{name}`; there is {}", names.join(", "))
                }
            }
        })
    }

    fn wrong_pair(&self) -> (Vec<&'static str>, String) {
        let given: Vec<&'static str> = [
            ("mu_t", self.mu_t.is_some()),
            ("mean_free_path", self.mean_free_path.is_some()),
            ("albedo", self.albedo.is_some()),
            ("reflectance", self.reflectance.is_some()),
            ("mu_a", self.mu_a.is_some()),
            ("mu_s", self.mu_s.is_some()),
            ("preset", self.preset.is_some()),
            ("particles", self.particles.is_some()),
        ]
        .into_iter()
        .filter_map(|(key, is_given)| is_given.then_some(key))
        .collect();
        match given.as_slice() {
            [] => (vec![], format!("the medium has no coefficients: {WAYS}")),
            [one] => (vec![], format!("`{one}` alone does not say the coefficients: {WAYS}")),
            [.., last] => {
                let list: Vec<String> = given.iter().map(|key| format!("`{key}`")).collect();
                (vec![last], format!("the coefficients are given as {}: {WAYS}", list.join(" and ")))
            }
        }
    }
}

/// 1 over a mean free path.
fn reciprocal(path: &Spectrum) -> Result<Spectrum, (Vec<&'static str>, String)> {
    if let Spectrum::Sampled { values, .. } = path
        && values.contains(&0.0)
    {
        return Err((vec!["mean_free_path", "values"], "a mean free path must be above 0".into()));
    }
    match *path {
        Spectrum::PowerLaw { value: 0.0, .. } => {
            Err((vec!["mean_free_path", "value"], "a mean free path must be above 0".into()))
        }
        Spectrum::PowerLaw { at_nm, value, exponent } => {
            Ok(Spectrum::PowerLaw { at_nm, value: 1.0 / value, exponent: -exponent })
        }
        _ => Ok(path.map(|path| 1.0 / path)),
    }
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::*;

    const ALBEDO: [f64; 3] = [0.75, 0.5, 0.25];

    fn coefficients(medium: &MediumDescription) -> Result<SpectralCoefficients, (Vec<&'static str>, String)> {
        medium.coefficients("m", 0.0)
    }

    #[test]
    fn all_ways_say_the_same_medium() {
        let albedo = Some(ALBEDO.into());
        let by_extinction = MediumDescription { mu_t: Some(4.0.into()), albedo, ..Default::default() };
        let by_path =
            MediumDescription { mean_free_path: Some(0.25.into()), mu_t: None, ..by_extinction.clone() };
        let by_parts = MediumDescription {
            mu_a: Some([1.0, 2.0, 3.0].into()),
            mu_s: Some([3.0, 2.0, 1.0].into()),
            ..Default::default()
        };
        let scaled = MediumDescription { mu_t: Some(2.0.into()), scale: Some(2.0), ..by_extinction.clone() };
        for medium in [by_extinction, by_path, by_parts, scaled] {
            let spectra = coefficients(&medium).unwrap();
            assert_eq!(spectra.mu_t_rgb(), DVec3::splat(4.0));
            assert_eq!(spectra.albedo_rgb(), DVec3::from_array(ALBEDO));
            assert!((spectra.mu_t(500.0) - 4.0).abs() < 1e-14);
        }
    }

    #[test]
    fn the_albedo_of_a_reflectance_reflects_it() {
        let medium = MediumDescription {
            mean_free_path: Some(2.0.into()),
            reflectance: Some([0.9, 0.5, 0.0].into()),
            ..Default::default()
        };
        let albedo = medium.coefficients("m", 0.6).unwrap().albedo_rgb();
        for (channel, reflectance) in [0.9, 0.5, 0.0].into_iter().enumerate() {
            let back = tyndall_optics::albedo_inversion::reflectance_of_albedo(albedo[channel], 0.6);
            assert!((back - reflectance).abs() < 1e-6, "{channel}: {back}");
        }
    }

    #[test]
    fn presets_are_in_the_unit_of_the_scene() {
        let milk = MediumDescription { preset: Some("Skim milk".into()), ..Default::default() };
        for (unit, factor) in [("mm", 1.0), ("cm", 10.0), ("m", 1e3)] {
            let spectra = milk.coefficients(unit, 0.0).unwrap();
            assert!((spectra.mu_t_rgb().x / factor - 0.7014).abs() < 1e-12, "{unit}");
        }
        assert_eq!(milk.coefficients("furlong", 0.0).unwrap_err().0, ["preset"]);
        let half = MediumDescription { scale: Some(0.5), ..milk };
        assert!((half.coefficients("mm", 0.0).unwrap().mu_t_rgb().x - 0.3507).abs() < 1e-12);
        let unknown = MediumDescription { preset: Some("skinmilk".into()), ..Default::default() };
        assert!(coefficients(&unknown).unwrap_err().1.ends_with("did you mean `Skimmilk`?"));
    }

    #[test]
    fn mixed_pairs_are_refused() {
        let mixed = MediumDescription {
            mu_t: Some(1.0.into()),
            albedo: Some(0.5.into()),
            mu_a: Some(0.5.into()),
            ..Default::default()
        };
        assert_eq!(coefficients(&mixed).unwrap_err().0, ["mu_a"]);
        assert!(coefficients(&MediumDescription::default()).unwrap_err().0.is_empty());
        let preset_too = MediumDescription { preset: Some("coke".into()), mu_a: None, ..mixed };
        assert_eq!(coefficients(&preset_too).unwrap_err().0, ["preset"]);
    }
}
