//! Materials ready to evaluate at a point.

use tyndall_optics::bsdf::Bsdf;

use super::Hit;
use crate::Channels;

/// What a surface is made of.
#[derive(Debug, Clone, Default, PartialEq)]
pub enum Material {
    /// Nothing: light goes through.
    #[default]
    Null,
}

impl Material {
    /// Whether light may cross the surface unbent somewhere: `null`, or a mixture with it.
    pub fn may_pass(&self) -> bool {
        matches!(self, Self::Null)
    }

    /// Probability that a ray passes the surface at `hit` as if it were not there.
    pub fn pass_probability(&self, hit: &Hit) -> f64 {
        let _ = hit;
        1.0
    }

    /// Whether nothing ever crosses the surface.
    pub fn is_opaque(&self) -> bool {
        false
    }

    /// The surface at `hit` in `channels`, for light that does not pass it unbent.
    pub fn bsdf(&self, hit: &Hit, channels: &Channels) -> Bsdf {
        let _ = (hit, channels);
        Bsdf::Black
    }
}
