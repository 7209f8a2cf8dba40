//! Spheres for Lorenz-Mie theory: what they are made of and how large they are.

use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::{Deserialize, Serialize};
use tyndall_optics::mie::{SizeDistribution, SizeLaw};
use tyndall_optics::{Material, RefractiveIndex};

use super::quantity::{LENGTHS, Quantity};

/// A material whose refractive index is built in.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum MaterialName {
    /// Liquid water (Segelstein 1981).
    Water,
    /// Ice (Warren and Brandt 2008).
    Ice,
    /// Soot (Hess, Koepke and Schult 1998, as are those that follow).
    Soot,
    /// Mineral dust.
    Dust,
    /// Dry sea salt.
    SeaSalt,
    /// Sulphates, nitrates, organic matter; dry.
    WaterSoluble,
    /// Soil with organic matter.
    Insoluble,
    /// Droplets of 75 % sulphuric acid.
    Sulfate,
}

impl From<MaterialName> for Material {
    fn from(name: MaterialName) -> Self {
        match name {
            MaterialName::Water => Self::Water,
            MaterialName::Ice => Self::Ice,
            MaterialName::Soot => Self::Soot,
            MaterialName::Dust => Self::Dust,
            MaterialName::SeaSalt => Self::SeaSalt,
            MaterialName::WaterSoluble => Self::WaterSoluble,
            MaterialName::Insoluble => Self::Insoluble,
            MaterialName::Sulfate => Self::Sulfate,
        }
    }
}

/// A refractive index n + ik relative to the medium around: `1.33`, `[1.33, 1e-5]` or `"1.33+1e-5i"`; k > 0 absorbs.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(untagged)]
pub enum IndexDescription {
    /// n alone.
    Real(f64),
    /// n and k.
    Pair([f64; 2]),
    /// n + ik as text.
    Text(String),
}

impl IndexDescription {
    /// The refractive index, or what is wrong.
    pub fn value(&self) -> Result<RefractiveIndex, String> {
        let index = match self {
            Self::Real(n) => RefractiveIndex { n: *n, k: 0.0 },
            Self::Pair([n, k]) => RefractiveIndex { n: *n, k: *k },
            Self::Text(text) => {
                complex(text).ok_or(format!("\"{text}\" is no complex number such as \"1.33+1e-5i\""))?
            }
        };
        index.check().map(|()| index).map_err(|error| error.to_string())
    }
}

/// `1.33`, `1.33+1e-5i`.
fn complex(text: &str) -> Option<RefractiveIndex> {
    let plain = text.replace(' ', "");
    let Some(body) = plain.strip_suffix(['i', 'j']) else {
        return Some(RefractiveIndex { n: plain.parse().ok()?, k: 0.0 });
    };
    // The sign between the two parts is the last that is not that of an exponent.
    let is_sign =
        |(at, c): &(usize, char)| matches!(c, '+' | '-') && *at > 0 && !body[..*at].ends_with(['e', 'E']);
    let (at, _) = body.char_indices().rev().find(is_sign)?;
    Some(RefractiveIndex { n: body[..at].parse().ok()?, k: body[at..].parse().ok()? })
}

impl JsonSchema for IndexDescription {
    fn schema_name() -> std::borrow::Cow<'static, str> {
        "IndexDescription".into()
    }

    fn json_schema(_: &mut SchemaGenerator) -> Schema {
        json_schema!({ "anyOf": [
            { "type": "number" },
            { "type": "array", "items": { "type": "number" }, "minItems": 2, "maxItems": 2 },
            { "type": "string" }
        ]})
    }
}

/// What particles are made of; the file's name is as it stands in the scene file.
#[derive(Debug, Clone, PartialEq)]
pub enum SubstanceChoice<'a> {
    /// A material that is built in.
    Material(Material),
    /// One refractive index.
    Constant(RefractiveIndex),
    /// A table.
    File(&'a str),
}

/// The one of `material`, `m` and `material_file` that is given; or the key that is wrong and the mend.
pub fn substance<'a>(
    material: Option<MaterialName>,
    m: Option<&IndexDescription>,
    material_file: Option<&'a str>,
) -> Result<SubstanceChoice<'a>, (&'static str, String)> {
    match (material, m, material_file) {
        (Some(material), None, None) => Ok(SubstanceChoice::Material(material.into())),
        (None, Some(m), None) => m.value().map(SubstanceChoice::Constant).map_err(|message| ("m", message)),
        (None, None, Some(file)) => Ok(SubstanceChoice::File(file)),
        (None, None, None) => {
            Err(("", "the particles are of nothing: give `material`, `m` or `material_file`".into()))
        }
        _ => {
            let key = if material_file.is_some() { "material_file" } else { "m" };
            Err((key, "give only one of `material`, `m` and `material_file`".into()))
        }
    }
}

/// How many particles there are of each radius. Radii have units: `"10 um"`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(tag = "type", rename_all = "snake_case")]
pub enum DistributionDescription {
    /// All alike.
    Single {
        /// Radius.
        r: Quantity,
    },
    /// Gamma distribution of droplets (Hansen and Travis 1974).
    Gamma {
        /// Effective radius.
        r_eff: Quantity,
        /// Effective variance.
        v_eff: f64,
    },
    /// Log-normal distribution of aerosols.
    LogNormal {
        /// Median radius.
        r_g: Quantity,
        /// Geometric standard deviation.
        sigma_g: f64,
        /// Least radius.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        r_min: Option<Quantity>,
        /// Greatest radius.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        r_max: Option<Quantity>,
    },
    /// Deirmendjian's distribution, r^alpha exp(-(alpha/gamma)(r/r_mode)^gamma).
    ModifiedGamma {
        /// Most frequent radius.
        r_mode: Quantity,
        /// Power of small radii.
        alpha: f64,
        /// Power in the exponential.
        gamma: f64,
    },
    /// r^-exponent between two radii.
    PowerLaw {
        /// How steeply it falls.
        exponent: f64,
        /// Least radius.
        r_min: Quantity,
        /// Greatest radius.
        r_max: Quantity,
    },
}

impl DistributionDescription {
    /// The distribution, or the key that is wrong and the mend.
    pub fn value(&self) -> Result<SizeDistribution, (&'static str, String)> {
        let length = |key: &'static str, quantity: &Quantity| {
            quantity.in_units(&LENGTHS).map_err(|message| (key, format!("`{key}`: {message}")))
        };
        let limit = |key, quantity: &Option<Quantity>, otherwise| {
            quantity.as_ref().map_or(Ok(otherwise), |quantity| length(key, quantity))
        };
        let distribution = match self {
            Self::Single { r } => SizeLaw::Single { r: length("r", r)? }.into(),
            Self::Gamma { r_eff, v_eff } => {
                SizeLaw::Gamma { r_eff: length("r_eff", r_eff)?, v_eff: *v_eff }.into()
            }
            Self::LogNormal { r_g, sigma_g, r_min, r_max } => SizeDistribution {
                law: SizeLaw::LogNormal { r_g: length("r_g", r_g)?, sigma_g: *sigma_g },
                r_min: limit("r_min", r_min, 0.0)?,
                r_max: limit("r_max", r_max, f64::INFINITY)?,
            },
            Self::ModifiedGamma { r_mode, alpha, gamma } => {
                SizeLaw::ModifiedGamma { r_mode: length("r_mode", r_mode)?, alpha: *alpha, gamma: *gamma }
                    .into()
            }
            Self::PowerLaw { exponent, r_min, r_max } => SizeDistribution {
                law: SizeLaw::PowerLaw { exponent: *exponent },
                r_min: length("r_min", r_min)?,
                r_max: length("r_max", r_max)?,
            },
        };
        distribution.check().map(|()| distribution).map_err(|error| ("", error.to_string()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn refractive_indices_are_read_in_all_forms() {
        for index in [
            IndexDescription::Pair([1.33, 1e-5]),
            IndexDescription::Text("1.33+1e-5i".into()),
            IndexDescription::Text(" 1.33 + 0.00001 j".into()),
            IndexDescription::Text("1.33e0+1e-5i".into()),
        ] {
            assert_eq!(index.value(), Ok(RefractiveIndex { n: 1.33, k: 1e-5 }));
        }
        assert_eq!(IndexDescription::Real(1.5).value(), IndexDescription::Text("1.5".into()).value());
        for (text, part) in [
            ("1.33-1e-5i", "k from 0"),
            ("water", "is no complex number"),
            ("i", "is no"),
            ("1e-5i", "is no"),
        ] {
            let message = IndexDescription::Text(text.into()).value().unwrap_err();
            assert!(message.contains(part), "{text}: {message}");
        }
    }
}
