//! What a picture says about its making, beside the pixels.

use serde::{Deserialize, Serialize};

use crate::colours::Colours;

/// Where a picture lies in a larger one, pixels.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub struct Crop {
    /// Its left column and top row there.
    pub corner: [u32; 2],
    /// Width and height of the larger one.
    pub full_size: [u32; 2],
}

/// How the samples of a film were made; kept in `.acc` and `.exr` files and in the summary.
///
/// Two films are estimates of the same picture, and can be merged, if all but `seconds` is equal.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct ImageMetadata {
    /// Hash of the scene and of all files that it names.
    pub scene_hash: String,
    /// Version of the program.
    pub version: String,
    /// The options that decide which samples are drawn (integrator, estimators, …), as one line of text.
    pub options: String,
    /// Seed of the random numbers.
    pub seed: u64,
    /// What the channels are.
    #[serde(default)]
    pub colours: Colours,
    /// Where the picture lies in a larger one, if it is a crop.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub crop: Option<Crop>,
    /// Time spent on rendering in seconds, summed over machines.
    pub seconds: f64,
}
