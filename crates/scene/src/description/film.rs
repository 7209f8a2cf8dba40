//! `[film]` and `[render]`: the picture that is made, and how.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// The picture that is made.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default)]
pub struct FilmDescription {
    /// Width and height, pixels.
    #[schemars(inner(range(min = 1, max = 65536)))]
    pub resolution: [u32; 2],
    /// The part of the picture that is rendered and kept: left column, top row, width and height, pixels. All of it
    /// unless given.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub crop: Option<[u32; 4]>,
    /// Exposure of pictures for the screen, stops; 0 shows radiance 1 as white.
    #[schemars(range(min = -100, max = 100))]
    pub exposure: f64,
    /// Further layers of the EXR file.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub layers: Option<Vec<Layer>>,
    /// What the three channels of the picture are.
    #[serde(skip_serializing_if = "super::is_default")]
    pub output: FilmOutput,
    /// Instead of colours: the radiance at each of these wavelengths, nm. Needs `render.mode = "spectral"`.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(inner(range(min = 100, max = 10000)))]
    pub bands: Option<Vec<f64>>,
}

/// What the three channels of the picture are.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Hash, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum FilmOutput {
    /// Linear Rec. 709.
    #[default]
    Rgb,
    /// CIE 1931 XYZ. Needs `render.mode = "spectral"`.
    Xyz,
}

impl Default for FilmDescription {
    fn default() -> Self {
        Self {
            resolution: [1280, 720],
            crop: None,
            exposure: 0.0,
            layers: None,
            output: FilmOutput::Rgb,
            bands: None,
        }
    }
}

impl FilmDescription {
    /// Width and height of the picture, pixels: those of the crop, if there is one.
    pub fn picture_size(&self) -> [u32; 2] {
        self.crop.map_or(self.resolution, |[_, _, width, height]| [width, height])
    }
}

/// A layer of the EXR file beside the picture itself.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Layer {
    /// Standard error of each pixel and channel.
    StandardError,
    /// Number of samples of each pixel.
    SampleCount,
    /// Mean distance to the first scattering event or surface.
    Depth,
    /// Albedo at the first scattering event or surface.
    Albedo,
    /// Fraction of the background that is seen.
    Transmittance,
    /// Light emitted by media, whether it was scattered afterwards or not.
    Emission,
    /// Light scattered once.
    Single,
    /// Light scattered more than once.
    Multiple,
    /// Normal of the first surface, 0 where a medium or nothing comes first.
    Normal,
    /// Number of the object seen; of several in a pixel the greatest.
    ObjectId,
    /// Opacity of the shadows that fall on shadow catchers.
    ShadowCatcher,
    /// Random numbers that a sample took, on average: where the time goes. Only kept if asked for.
    Effort,
}

/// How the picture is rendered.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default)]
pub struct RenderDescription {
    /// Samples for each pixel.
    #[schemars(range(min = 1))]
    pub spp: u32,
    /// Which random numbers are used; the same seed gives the same picture.
    pub seed: u32,
    /// Greatest number of scattering events of a path; unlimited when absent.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub max_depth: Option<u32>,
    /// Which implementation of the transport renders.
    pub integrator: Integrator,
    /// How the first random numbers of paths are drawn.
    #[serde(skip_serializing_if = "super::is_default")]
    pub sampler: Sampler,
    /// Whether pixels get different numbers of samples, `spp` on average: more where the picture is noisy, and where they cost
    /// little. A pilot of four samples a pixel decides it, which are no part of the picture.
    #[serde(skip_serializing_if = "super::is_default")]
    pub adaptive: bool,
    /// What colours are computed with.
    #[serde(skip_serializing_if = "super::is_default")]
    pub mode: ColourMode,
}

/// What colours are computed with.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Hash, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum ColourMode {
    /// Red, green and blue.
    #[default]
    Rgb,
    /// Wavelengths.
    Spectral,
}

impl Default for RenderDescription {
    fn default() -> Self {
        Self {
            spp: 64,
            seed: 0,
            max_depth: None,
            integrator: Integrator::Fast,
            sampler: Sampler::Independent,
            adaptive: false,
            mode: ColourMode::Rgb,
        }
    }
}

/// Which implementation of the transport renders; all estimate the same picture.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Hash, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Integrator {
    /// Many paths in flight.
    #[default]
    Fast,
    /// One path at a time, to be read beside the equations.
    Reference,
}

/// How the first random numbers of the paths of a pixel are drawn; all give the same expected picture.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Hash, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Sampler {
    /// Each path for itself, so that standard errors are those of the picture.
    #[default]
    Independent,
    /// Evenly over the paths of a pixel, by Owen-scrambled Sobol points: less noise, and standard errors that are upper
    /// estimates, since they take paths for independent.
    Sobol,
}
