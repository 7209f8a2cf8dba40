//! A quantity that is grey, has three channels, or depends on the wavelength.
//!
//! `0.9`, `[0.9, 0.8, 0.7]` (linear Rec. 709), `{ wavelengths = [450, 550], values = [1, 2] }` in nm,
//! `{ blackbody = 3000 }` in kelvin, `{ power_law = -4, at = 550, value = 0.1 }`.

use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::{Deserialize, Serialize};
use tyndall_optics::Spectrum;

use glam::DVec3;

/// A quantity for each colour.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(untagged)]
pub enum SpectrumDescription {
    /// The same for all: of light, the white of the picture.
    Grey(f64),
    /// Red, green, blue.
    Channels([f64; 3]),
    /// By wavelength.
    Table(SpectrumTable),
}

/// A quantity by wavelength: exactly one of `wavelengths` with `values`, `blackbody`, `power_law` with `at` and `value`.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct SpectrumTable {
    /// Wavelengths in nm, increasing; the values between them are interpolated, those beyond are the nearest.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(inner(range(min = 1)))]
    pub wavelengths: Option<Vec<f64>>,
    /// A value for each of the wavelengths.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(inner(range(min = 0)))]
    pub values: Option<Vec<f64>>,
    /// Temperature in kelvin of a black body whose light this is.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 200, max = 1000000))]
    pub blackbody: Option<f64>,
    /// Luminance of the black body's light; 1, unless given, is that of the white [1, 1, 1].
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 0))]
    pub luminance: Option<f64>,
    /// Instead of the luminance: factor on Planck's radiance in W/(m² sr nm).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 0))]
    pub scale: Option<f64>,
    /// Power of the wavelength; molecules scatter with -4.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = -20, max = 20))]
    pub power_law: Option<f64>,
    /// Wavelength, in nm, at which the power law has its value.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 100, max = 10000))]
    pub at: Option<f64>,
    /// Value of the power law there.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 0))]
    pub value: Option<f64>,
}

/// The key of a table that is wrong (empty for the table itself), and the mend.
pub type KeyProblem = (&'static str, String);

impl From<f64> for SpectrumDescription {
    fn from(value: f64) -> Self {
        Self::Grey(value)
    }
}

impl From<[f64; 3]> for SpectrumDescription {
    fn from(channels: [f64; 3]) -> Self {
        Self::Channels(channels)
    }
}

impl SpectrumDescription {
    /// The spectrum of a number that multiplies light.
    pub fn coefficient(&self) -> Result<Spectrum, KeyProblem> {
        match self {
            Self::Grey(value) => Ok(Spectrum::Constant(*value)),
            Self::Channels(channels) => Ok(Spectrum::Rgb(DVec3::from_array(*channels))),
            Self::Table(table) => match table.spectrum()? {
                Spectrum::Blackbody { .. } => Err((
                    "blackbody",
                    "a black body is light and no coefficient: give `wavelengths` and `values`".into(),
                )),
                spectrum => Ok(spectrum),
            },
        }
    }

    /// The spectrum of a number from 0 to 1, as albedos are.
    pub fn fraction(&self) -> Result<Spectrum, KeyProblem> {
        let spectrum = self.coefficient()?;
        match &spectrum {
            // A single number or three: the schema says so too where every value is a fraction.
            Spectrum::Constant(value) if *value > 1.0 => Err(("", FRACTION.into())),
            Spectrum::Rgb(channels) if channels.max_element() > 1.0 => Err(("", FRACTION.into())),
            Spectrum::Sampled { values, .. } if values.iter().any(|value| *value > 1.0) => {
                Err(("values", "the `values` must be numbers from 0 to 1".into()))
            }
            // A power law is greatest at an end.
            Spectrum::PowerLaw { .. } if spectrum.at(360.0).max(spectrum.at(830.0)) > 1.0 => Err((
                "value",
                "the power law must be from 0 to 1 between 360 and 830 nm: give a smaller `value`".into(),
            )),
            _ => Ok(spectrum),
        }
    }

    /// The spectrum of light.
    pub fn light(&self) -> Result<Spectrum, KeyProblem> {
        match self {
            Self::Grey(value) => Ok(Spectrum::RgbLight(DVec3::splat(*value))),
            Self::Channels(channels) => Ok(Spectrum::RgbLight(DVec3::from_array(*channels))),
            Self::Table(table) => table.spectrum(),
        }
    }
}

const FRACTION: &str = "must be from 0 to 1, as fractions of light are";

const FORMS: &str = "give `wavelengths` with `values`, or `blackbody`, or `power_law` with `at` and `value`";

impl SpectrumTable {
    fn spectrum(&self) -> Result<Spectrum, KeyProblem> {
        let sampled = self.wavelengths.is_some() || self.values.is_some();
        let body = self.blackbody.is_some() || self.luminance.is_some() || self.scale.is_some();
        let power = self.power_law.is_some() || self.at.is_some() || self.value.is_some();
        match (sampled, body, power) {
            (true, false, false) => self.samples(),
            (false, true, false) => self.black_body(),
            (false, false, true) => self.power(),
            (false, false, false) => Err(("", format!("the spectrum is empty: {FORMS}"))),
            _ => Err(("", format!("the spectrum is given in several ways: {FORMS}"))),
        }
    }

    fn samples(&self) -> Result<Spectrum, KeyProblem> {
        let (Some(wavelengths), Some(values)) = (&self.wavelengths, &self.values) else {
            return Err(("", "`wavelengths` and `values` belong together: give both".into()));
        };
        Spectrum::sampled(wavelengths.clone(), values.clone())
            .map_err(|problem| ("wavelengths", format!("the spectrum {problem}")))
    }

    fn black_body(&self) -> Result<Spectrum, KeyProblem> {
        let Some(kelvin) = self.blackbody else {
            return Err(("", "`luminance` and `scale` are for a `blackbody`: give its temperature".into()));
        };
        match (self.luminance, self.scale) {
            (Some(_), Some(_)) => {
                Err(("scale", "the black body has both `luminance` and `scale`: keep one".into()))
            }
            (None, Some(scale)) => Ok(Spectrum::Blackbody { kelvin, scale }),
            (luminance, None) => Ok(Spectrum::blackbody_of_luminance(kelvin, luminance.unwrap_or(1.0))),
        }
    }

    fn power(&self) -> Result<Spectrum, KeyProblem> {
        match (self.power_law, self.at, self.value) {
            (Some(exponent), Some(at_nm), Some(value)) => {
                let spectrum = Spectrum::PowerLaw { at_nm, value, exponent };
                if !spectrum.is_sound() {
                    return Err(("power_law", "the power law is too steep to compute with".into()));
                }
                Ok(spectrum)
            }
            _ => Err(("", "`power_law`, `at` and `value` belong together: give all three".into())),
        }
    }
}

/// Without a stated range: at least 0, as radiances and coefficients are.
impl JsonSchema for SpectrumDescription {
    fn schema_name() -> std::borrow::Cow<'static, str> {
        "Spectrum".into()
    }

    fn json_schema(generator: &mut SchemaGenerator) -> Schema {
        let table = generator.subschema_for::<SpectrumTable>();
        json_schema!({ "anyOf": [
            { "type": "number", "minimum": 0 },
            { "type": "array", "items": { "type": "number", "minimum": 0 }, "minItems": 3, "maxItems": 3 },
            table
        ]})
    }
}

/// Schema of a [`SpectrumDescription`] from 0 to 1, as albedos are.
pub(super) fn fraction(generator: &mut SchemaGenerator) -> Schema {
    let table = generator.subschema_for::<SpectrumTable>();
    json_schema!({ "anyOf": [
        { "type": "number", "minimum": 0, "maximum": 1 },
        { "type": "array", "items": { "type": "number", "minimum": 0, "maximum": 1 }, "minItems": 3, "maxItems": 3 },
        table
    ]})
}

/// Schema of a [`SpectrumDescription`] above 0, as lengths are.
pub(super) fn positive(generator: &mut SchemaGenerator) -> Schema {
    let table = generator.subschema_for::<SpectrumTable>();
    json_schema!({ "anyOf": [
        { "type": "number", "exclusiveMinimum": 0 },
        { "type": "array", "items": { "type": "number", "exclusiveMinimum": 0 }, "minItems": 3, "maxItems": 3 },
        table
    ]})
}
