//! One number or three: a quantity that is grey or has red, green and blue channels.

use glam::DVec3;
use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::{Deserialize, Serialize};

/// A quantity for each colour channel (linear Rec. 709): `0.9` or `[0.9, 0.8, 0.7]`.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(untagged)]
pub enum Rgb {
    /// The same in all channels.
    Grey(f64),
    /// Red, green, blue.
    Channels([f64; 3]),
}

impl Rgb {
    /// The three channels.
    pub fn channels(self) -> DVec3 {
        match self {
            Self::Grey(value) => DVec3::splat(value),
            Self::Channels(channels) => DVec3::from_array(channels),
        }
    }
}

/// Without a stated range: at least 0, as radiances and coefficients are.
impl JsonSchema for Rgb {
    fn schema_name() -> std::borrow::Cow<'static, str> {
        "Rgb".into()
    }

    fn json_schema(_: &mut SchemaGenerator) -> Schema {
        json_schema!({ "anyOf": [
            { "type": "number", "minimum": 0 },
            { "type": "array", "items": { "type": "number", "minimum": 0 }, "minItems": 3, "maxItems": 3 }
        ]})
    }
}

/// Schema of an [`Rgb`] from 0 to 1, as albedos are.
pub(super) fn fraction(_: &mut SchemaGenerator) -> Schema {
    json_schema!({ "anyOf": [
        { "type": "number", "minimum": 0, "maximum": 1 },
        { "type": "array", "items": { "type": "number", "minimum": 0, "maximum": 1 }, "minItems": 3, "maxItems": 3 }
    ]})
}
