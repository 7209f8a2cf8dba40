//! `[[meter]]`: what `tyndall measure` measures in a scene.
//!
//! Layers and bodies are lit by a light of their own, parallel or diffuse, and the scene's lights do not count; a meter for
//! irradiance or radiance stands in the scene's own light. y points up. Directions that light travels in are given by their
//! angle `theta` with +y and their azimuth `phi` about it: (sin θ cos φ, cos θ, sin θ sin φ). Where the literature on
//! atmospheres has z upwards and x along the sun, its x and z are x and y here.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// What is measured.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(tag = "type", rename_all = "snake_case")]
pub enum MeterDescription {
    /// Reflectance, transmittance and absorptance of a horizontal layer.
    Layer(LayerMeterDescription),
    /// What a body of finite size absorbs and scatters of a beam.
    Body(BodyMeterDescription),
    /// Irradiance at a point.
    Irradiance(IrradianceMeterDescription),
    /// Radiance along a ray.
    Radiance(RadianceMeterDescription),
}

/// Reflectance, transmittance and absorptance of the horizontal layer between two heights under light from above, over
/// black or grey ground. Volumes are cut off at the layer's faces.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[schemars(inline)]
pub struct LayerMeterDescription {
    /// A name for the answer.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub name: Option<String>,
    /// y of the lower face.
    pub bottom: f64,
    /// y of the upper face.
    pub top: f64,
    /// The way the light travels, downwards; without it light comes evenly from the whole upper hemisphere.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub direction: Option<[f64; 3]>,
    /// Least x and z, greatest x and z of the tile that the layer repeats without end. Layers that are not the same
    /// everywhere need it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub periodic: Option<[f64; 4]>,
    /// Columns of the tile along x and z for which results are given as well: the light that leaves by each, as a fraction
    /// of what falls on one of them.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(inner(range(min = 1, max = 4096)))]
    pub columns: Option<[u32; 2]>,
    /// Fraction of the light that the ground below reflects, evenly in all directions.
    #[serde(default, skip_serializing_if = "super::is_default")]
    #[schemars(range(min = 0, max = 1))]
    pub ground_albedo: f64,
    /// Directions in which the scattered light's radiance is measured, pairs of theta and phi in degrees: those with theta
    /// below 90 leave by the upper face (seen from above), others by the lower one.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    #[schemars(length(max = 64))]
    pub radiance: Vec<[f64; 2]>,
    /// Which colour is measured, where media depend on it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub channel: Option<Channel>,
}

/// What all volumes together, of finite size, absorb and scatter of a parallel beam, as fractions of the light that falls on
/// them (on the boxes around grids).
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[schemars(inline)]
pub struct BodyMeterDescription {
    /// A name for the answer.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub name: Option<String>,
    /// The way the light travels.
    pub direction: [f64; 3],
    /// Number of equal bins, from -1 to 1, of the cosine between the ways of the light before and after.
    #[serde(default = "default_bins")]
    #[schemars(range(min = 1, max = 10000))]
    pub bins: u32,
    /// Which colour is measured, where media depend on it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub channel: Option<Channel>,
}

/// Irradiance on a surface in the light of the scene.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[schemars(inline)]
pub struct IrradianceMeterDescription {
    /// A name for the answer.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub name: Option<String>,
    /// Where the surface is.
    pub position: [f64; 3],
    /// Its normal, on the side from which light counts.
    pub normal: [f64; 3],
}

/// Radiance that arrives along a ray in the light of the scene.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[schemars(inline)]
pub struct RadianceMeterDescription {
    /// A name for the answer.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub name: Option<String>,
    /// Where the meter is.
    pub position: [f64; 3],
    /// Where it looks.
    pub direction: [f64; 3],
}

/// A channel of a colour.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Channel {
    /// Red.
    Red,
    /// Green.
    Green,
    /// Blue.
    Blue,
}

/// Columns of one layer at most.
pub(super) const GREATEST_COLUMNS: u64 = 1 << 18;

/// Least cosine with the vertical of directions that matter: flatter light hardly gets anywhere.
pub(super) const LEAST_COSINE: f64 = 1e-3;

fn default_bins() -> u32 {
    20
}

impl MeterDescription {
    /// The name it was given.
    pub fn name(&self) -> Option<&str> {
        match self {
            Self::Layer(meter) => meter.name.as_deref(),
            Self::Body(meter) => meter.name.as_deref(),
            Self::Irradiance(meter) => meter.name.as_deref(),
            Self::Radiance(meter) => meter.name.as_deref(),
        }
    }
}
