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
    /// Whether the camera path collided with a medium or met a surface other than a shadow catcher.
    pub hit: bool,
    /// Distance from the camera to the first collision or surface in scene units; read only if `hit`.
    pub depth: f32,
    /// Scattering albedo μs/μt at the first collision, or of the first surface, 0 to 1; read only if `hit`.
    pub albedo: [f32; 3],
    /// Unit normal of the first surface in world space, or 0; read only if `hit`.
    pub normal: [f32; 3],
    /// Number of the object that the first surface belongs to, a shadow catcher's too; 0 of media and of nothing.
    pub object: u32,
    /// Luminance that the shadow catcher at the end of the camera ray reflects: as it is, and as it would be if nothing
    /// stood between it and the lights. Read only if the sample [is on a catcher](Self::is_on_catcher).
    pub catcher: [f32; 2],
    /// Light emitted by media.
    pub emission: [f32; 3],
    /// Light scattered once by media.
    pub single: [f32; 3],
    /// Light scattered more than once by media.
    pub multiple: [f32; 3],
    /// Random numbers that its paths took, but for evenly spread ones: how long it was under way, in a unit that does not depend on
    /// the machine, but on the integrator.
    pub effort: u32,
}

impl Sample {
    /// Whether the camera ray ended on a shadow catcher: it met an object, and this is no hit.
    pub fn is_on_catcher(&self) -> bool {
        !self.hit && self.object != 0
    }
}

/// Which layers a film keeps beside radiance, its error and coverage, which are always kept.
///
/// Each costs memory in every pixel (see [`Film`](crate::Film)), but only once something other than zero arrives.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Layers {
    /// Mean distance to the first collision or surface, `Depth.Z`.
    pub depth: bool,
    /// Mean albedo there, `Albedo.R`…
    pub albedo: bool,
    /// Light emitted by media, `Emission.R`…
    pub emission: bool,
    /// Light scattered once, `Single.R`…
    pub single: bool,
    /// Light scattered more than once, `Multiple.R`…
    pub multiple: bool,
    /// Mean normal of the first surfaces, `Normal.X`…
    #[serde(default)]
    pub normal: bool,
    /// Greatest number of the objects seen, `ObjectId.Id`.
    #[serde(default)]
    pub object_id: bool,
    /// Opacity of the shadows on shadow catchers, `ShadowCatcher.A`. Without it they are missing from the picture's own
    /// alpha too.
    #[serde(default)]
    pub shadow_catcher: bool,
    /// Mean number of random numbers that a sample took, `Effort`.
    #[serde(default)]
    pub effort: bool,
}

impl Layers {
    /// Everything that can be seen: all but the effort.
    pub const ALL: Self = Self::each(true);
    /// Only radiance, its error and coverage.
    pub const NONE: Self = Self::each(false);

    const fn each(keep: bool) -> Self {
        Self {
            depth: keep,
            albedo: keep,
            emission: keep,
            single: keep,
            multiple: keep,
            normal: keep,
            object_id: keep,
            shadow_catcher: keep,
            effort: false,
        }
    }
}
