//! `[[material]]`: what a surface does to light.

use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::{Deserialize, Serialize};

use super::spectrum::{SpectrumDescription, fraction};

/// A material with a name.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct NamedMaterial {
    /// What shapes call it by.
    pub name: String,
    /// The material.
    #[serde(flatten)]
    pub material: MaterialDescription,
}

impl JsonSchema for NamedMaterial {
    fn schema_name() -> std::borrow::Cow<'static, str> {
        "NamedMaterial".into()
    }

    /// Every kind of material has a name as well.
    fn json_schema(generator: &mut SchemaGenerator) -> Schema {
        let mut schema = MaterialDescription::json_schema(generator);
        let kinds = schema.get_mut("oneOf").and_then(|kinds| kinds.as_array_mut());
        for kind in kinds.into_iter().flatten() {
            kind["properties"]["name"] =
                serde_json::json!({ "description": "What shapes call it by.", "type": "string" });
            if let Some(required) = kind["required"].as_array_mut() {
                required.insert(0, "name".into());
            }
        }
        schema.insert("description".to_owned(), "A material with a name.".into());
        schema
    }
}

/// What a surface is made of: the name of a `[[material]]`, or a material given in place.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(untagged)]
pub enum MaterialChoice {
    /// The name of a `[[material]]`.
    Name(String),
    /// A material.
    Here(Box<MaterialDescription>),
}

/// What a surface does to light.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(tag = "type", rename_all = "snake_case")]
pub enum MaterialDescription {
    /// Reflects equally in all directions (Lambert), on both sides.
    Diffuse {
        /// Fraction of the light that is reflected.
        #[serde(default = "half")]
        reflectance: TextureDescription,
    },
    /// Reflects as a rough matte surface of many diffuse facets (Oren and Nayar 1994), on both sides.
    RoughDiffuse {
        /// Fraction of the light that the facets reflect.
        #[serde(default = "half")]
        reflectance: TextureDescription,
        /// Standard deviation of the facets' slope angle, degrees.
        #[schemars(range(min = 0, max = 90))]
        sigma: f64,
    },
    /// Metal: a mirror, or GGX microfacets.
    Conductor {
        /// Name of a measured metal, such as `copper`; or `eta` and `k`.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        metal: Option<String>,
        /// Real part of the refractive index relative to the outside.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        eta: Option<SpectrumDescription>,
        /// Imaginary part of it.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        k: Option<SpectrumDescription>,
        /// Instead of both: reflectance at normal incidence.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        reflectance: Option<SpectrumDescription>,
        /// Width of the distribution of microfacets; 0 is a mirror.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        roughness: Option<Roughness>,
        /// Factor on what is reflected.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        tint: Option<TextureDescription>,
    },
    /// Glass, water: reflects and refracts; smooth, or GGX microfacets.
    Dielectric {
        /// Refractive index of the inside over that of the outside, or the name of a substance, such as `bk7`.
        #[serde(default)]
        index: IndexChoice,
        /// Width of the distribution of microfacets; 0 is smooth.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        roughness: Option<Roughness>,
        /// Factor on what is reflected.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        reflection_tint: Option<TextureDescription>,
        /// Factor on what is let through.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        transmission_tint: Option<TextureDescription>,
    },
    /// A sheet of glass as one surface: reflects, and lets light through without bending it.
    ThinDielectric {
        /// Refractive index of the sheet over that around, or the name of a substance.
        #[serde(default)]
        index: IndexChoice,
        /// Factor on what is reflected.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        reflection_tint: Option<TextureDescription>,
        /// Factor on what is let through.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        transmission_tint: Option<TextureDescription>,
    },
    /// A diffuse base under a dielectric coat, as plastic and paint are, on both sides.
    Plastic {
        /// Fraction of the light that the base reflects.
        #[serde(default = "half")]
        reflectance: TextureDescription,
        /// Refractive index of the coat, or the name of a substance.
        #[serde(default)]
        index: IndexChoice,
        /// Width of the distribution of the coat's microfacets; 0 is smooth.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        roughness: Option<Roughness>,
        /// Factor on what the coat reflects.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        reflection_tint: Option<TextureDescription>,
        /// Whether light that goes to and fro under the coat takes the base's colour each time, as in nature: colours are
        /// deeper and darker. Otherwise the base looks as bright as its reflectance says.
        #[serde(default, skip_serializing_if = "super::is_default")]
        nonlinear: bool,
    },
    /// Two materials side by side, as a fine mosaic. With `null` as the first, `amount` is an opacity.
    Mix {
        /// The first and the second.
        materials: [MaterialChoice; 2],
        /// Share of the second.
        amount: TextureDescription,
    },
    /// Nothing: light goes through. For the boundaries of volumes.
    Null,
}

impl MaterialDescription {
    /// What it takes from place to place, by key.
    pub fn textures(&self) -> Vec<(&'static str, &TextureDescription)> {
        let given: Vec<(&'static str, Option<&TextureDescription>)> = match self {
            Self::Diffuse { reflectance } | Self::RoughDiffuse { reflectance, .. } => {
                vec![("reflectance", Some(reflectance))]
            }
            Self::Conductor { tint, .. } => vec![("tint", tint.as_ref())],
            Self::Dielectric { reflection_tint, transmission_tint, .. }
            | Self::ThinDielectric { reflection_tint, transmission_tint, .. } => vec![
                ("reflection_tint", reflection_tint.as_ref()),
                ("transmission_tint", transmission_tint.as_ref()),
            ],
            Self::Plastic { reflectance, reflection_tint, .. } => {
                vec![("reflectance", Some(reflectance)), ("reflection_tint", reflection_tint.as_ref())]
            }
            Self::Mix { amount, .. } => vec![("amount", Some(amount))],
            Self::Null => vec![],
        };
        given.into_iter().filter_map(|(key, texture)| texture.map(|texture| (key, texture))).collect()
    }

    /// The names of the pictures that it and the materials in it take.
    pub fn pictures_mut(&mut self) -> Vec<&mut String> {
        let textures = match self {
            Self::Diffuse { reflectance } | Self::RoughDiffuse { reflectance, .. } => {
                vec![Some(reflectance)]
            }
            Self::Conductor { tint, .. } => vec![tint.as_mut()],
            Self::Dielectric { reflection_tint, transmission_tint, .. }
            | Self::ThinDielectric { reflection_tint, transmission_tint, .. } => {
                vec![reflection_tint.as_mut(), transmission_tint.as_mut()]
            }
            Self::Plastic { reflectance, reflection_tint, .. } => {
                vec![Some(reflectance), reflection_tint.as_mut()]
            }
            Self::Mix { materials, amount } => {
                let inner = materials.iter_mut().flat_map(MaterialChoice::pictures_mut);
                return inner.chain(amount.picture_mut()).collect();
            }
            Self::Null => vec![],
        };
        textures.into_iter().flatten().filter_map(TextureDescription::picture_mut).collect()
    }
}

impl MaterialChoice {
    /// The names of the pictures of a material given in place.
    pub fn pictures_mut(&mut self) -> Vec<&mut String> {
        match self {
            Self::Name(_) => vec![],
            Self::Here(material) => material.pictures_mut(),
        }
    }
}

impl TextureDescription {
    fn picture_mut(&mut self) -> Option<&mut String> {
        match self {
            Self::Image(texture) => Some(&mut texture.image),
            Self::Constant(_) | Self::Checker(_) => None,
        }
    }
}

/// A quantity that may vary over a surface: a number, three numbers, a spectrum, a picture or a checkerboard.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(untagged)]
pub enum TextureDescription {
    /// A picture. It and the checkerboard come first: they are known by a key that they need, which spectra, having none,
    /// would leave aside.
    Image(ImageTexture),
    /// Two values in turns.
    Checker(CheckerTexture),
    /// The same everywhere.
    Constant(SpectrumDescription),
}

impl From<f64> for TextureDescription {
    fn from(value: f64) -> Self {
        Self::Constant(value.into())
    }
}

impl From<[f64; 3]> for TextureDescription {
    fn from(value: [f64; 3]) -> Self {
        Self::Constant(value.into())
    }
}

impl JsonSchema for TextureDescription {
    fn schema_name() -> std::borrow::Cow<'static, str> {
        "Texture".into()
    }

    fn json_schema(generator: &mut SchemaGenerator) -> Schema {
        let constant = fraction(generator);
        let image = generator.subschema_for::<ImageTexture>();
        let checker = generator.subschema_for::<CheckerTexture>();
        let mut branches = constant.as_value()["anyOf"].as_array().cloned().unwrap_or_default();
        branches.push(image.into());
        branches.push(checker.into());
        json_schema!({ "anyOf": branches })
    }
}

/// A picture laid on the surface: texture coordinates (0, 0) are its left lower corner, (1, 1) its right upper one.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct ImageTexture {
    /// The picture (.png, .exr, .hdr, .jpg), relative to the scene file.
    pub image: String,
    /// Whether the picture's numbers are sRGB-coded; by default those of .png and .jpg are.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub srgb: Option<bool>,
    /// How values between the centres of texels are found.
    #[serde(default, skip_serializing_if = "super::is_default")]
    pub filter: super::ImageFilter,
    /// What lies beyond the picture.
    #[serde(default, skip_serializing_if = "super::is_default")]
    pub wrap: TextureWrap,
    /// Factors on the texture coordinates.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub scale: Option<[f64; 2]>,
    /// What is added to them afterwards.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub offset: Option<[f64; 2]>,
    /// Factor on the values.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 0))]
    pub factor: Option<f64>,
}

/// What lies beyond a picture.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum TextureWrap {
    /// The picture again.
    #[default]
    Repeat,
    /// Its border.
    Clamp,
    /// The picture mirrored.
    Mirror,
}

/// Squares of one unit of the texture coordinates, of two values in turns.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct CheckerTexture {
    /// The value of the square from (0, 0) to (1, 1), and the other.
    pub checker: [SpectrumDescription; 2],
    /// Factors on the texture coordinates.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub scale: Option<[f64; 2]>,
    /// What is added to them afterwards.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub offset: Option<[f64; 2]>,
}

/// Width α of the GGX distribution of microfacets: one number, or one along u and one along v.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(untagged)]
pub enum Roughness {
    /// The same along both.
    Equal(f64),
    /// Along u and v.
    Pair([f64; 2]),
}

impl Roughness {
    /// α along u and v.
    pub fn alphas(self) -> [f64; 2] {
        match self {
            Self::Equal(alpha) => [alpha; 2],
            Self::Pair(alphas) => alphas,
        }
    }
}

impl JsonSchema for Roughness {
    fn schema_name() -> std::borrow::Cow<'static, str> {
        "Roughness".into()
    }

    fn json_schema(_: &mut SchemaGenerator) -> Schema {
        json_schema!({ "anyOf": [
            { "type": "number", "minimum": 0, "maximum": 1 },
            { "type": "array", "items": { "type": "number", "minimum": 0, "maximum": 1 }, "minItems": 2, "maxItems": 2 }
        ]})
    }
}

/// A refractive index, or the name of a substance.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(untagged)]
pub enum IndexChoice {
    /// The index.
    Number(f64),
    /// A substance, such as `water`, `bk7`, `diamond`.
    Name(String),
}

impl Default for IndexChoice {
    fn default() -> Self {
        Self::Number(1.5)
    }
}

impl JsonSchema for IndexChoice {
    fn schema_name() -> std::borrow::Cow<'static, str> {
        "Index".into()
    }

    fn json_schema(_: &mut SchemaGenerator) -> Schema {
        json_schema!({ "anyOf": [
            { "type": "number", "exclusiveMinimum": 0 },
            { "type": "string" }
        ]})
    }
}

fn half() -> TextureDescription {
    0.5.into()
}
