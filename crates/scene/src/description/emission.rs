//! Grids that a glowing or coloured volume is described by, beside its density.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// A grid that multiplies the emission, such as the flames of a fire.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct EmissionGridDescription {
    /// Volume file, relative to the scene file; the volume's own unless given.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub file: Option<String>,
    /// Name of the grid; `flame`, `flames` or `heat` unless given.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub grid: Option<String>,
    /// Factor on the grid's values.
    #[serde(default = "one")]
    #[schemars(range(min = 0))]
    pub scale: f64,
}

/// A grid of temperatures: the medium glows as a black body does, with `kelvin = scale * value + offset`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct TemperatureDescription {
    /// Volume file, relative to the scene file; the volume's own unless given.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub file: Option<String>,
    /// Name of the grid; `temperature` unless given.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub grid: Option<String>,
    /// Kelvin for each unit of the grid's values.
    #[serde(default = "one")]
    pub scale: f64,
    /// Kelvin where the grid's value is 0.
    #[serde(default, skip_serializing_if = "super::is_default")]
    pub offset: f64,
    /// Whether every black body's spectrum is scaled to 1 where it is greatest, so that colour is by temperature and
    /// brightness by `emission_scale` and the density alone.
    #[serde(default, skip_serializing_if = "super::is_default")]
    pub normalised: bool,
}

/// A grid of colours that multiplies the albedo.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct AlbedoGridDescription {
    /// Volume file, relative to the scene file; the volume's own unless given.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub file: Option<String>,
    /// Name of the grid, of vectors or of numbers; `Cd` or `color` unless given.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub grid: Option<String>,
}

fn one() -> f64 {
    1.0
}
