//! What transport hands to the film: one sample of one pixel.
//!
//! A sample is one estimate of the light through one point of a pixel. The light is split by its way,
//!
//! ```text
//! radiance = emission + single + multiple + unscattered background
//! ```
//!
//! so that a picture can show each part; [`Layers`] says which of the parts a film keeps.

use serde::{Deserialize, Serialize};

/// One estimate of the light that arrives at a pixel, and what its camera path met.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Sample {
    /// All light, linear Rec.709; in the scene's unit of radiance.
    pub radiance: [f32; 3],
    /// Whether the camera path collided with a medium.
    pub hit: bool,
    /// Distance from the camera to the first collision in scene units; read only if `hit`.
    pub depth: f32,
    /// Scattering albedo μs/μt at the first collision, 0 to 1; read only if `hit`.
    pub albedo: [f32; 3],
    /// Light emitted by media.
    pub emission: [f32; 3],
    /// Light scattered once by media.
    pub single: [f32; 3],
    /// Light scattered more than once by media.
    pub multiple: [f32; 3],
}

/// Which layers a film keeps beside radiance, its error and coverage, which are always kept.
///
/// Each costs memory in every pixel (see [`Film`](crate::Film)), but only once something other than zero arrives.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Layers {
    /// Mean distance to the first collision, `Depth.Z`.
    pub depth: bool,
    /// Mean albedo at the first collision, `Albedo.R`…
    pub albedo: bool,
    /// Light emitted by media, `Emission.R`…
    pub emission: bool,
    /// Light scattered once, `Single.R`…
    pub single: bool,
    /// Light scattered more than once, `Multiple.R`…
    pub multiple: bool,
}

impl Layers {
    /// Everything.
    pub const ALL: Self = Self { depth: true, albedo: true, emission: true, single: true, multiple: true };
    /// Only radiance, its error and coverage.
    pub const NONE: Self =
        Self { depth: false, albedo: false, emission: false, single: false, multiple: false };
}
