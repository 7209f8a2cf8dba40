//! Half-spaces that absorb next to nothing: the deep part of a walk, which would take for ever, in closed form.
//!
//! In a half-space of albedo 1 the number of scatterings before a photon comes back has no mean. But far below the
//! surface only the slowest mode of the transport equation is left, which falls off as exp(−z/L): a packet at the depth
//! z > D leaves the surface as one at the depth D does, with the weight exp(−(z − D)/L). What is neglected are the
//! other modes, which fall off with the transport mean free path l* = 1/(μt (1 − albedo·g)), or with 1/μt if that is
//! longer, or faster; at D = 24 such lengths they are below e⁻²⁴ = 4·10⁻¹¹. In the diffusion limit L = l*/√(3 (1 − albedo)/(1 − albedo g)), whose relative error is of
//! the order of 1 − albedo; where this is below 10⁻⁶ (the only half-spaces so treated), the error in a packet's weight
//! stays below 10⁻⁶ in all. Both are far below the noise of 2³¹ photons. Source for the modes: Case & Zweifel 1967,
//! "Linear transport theory", chapter 4.
//!
//! A walk then takes some 100/(1 − g) scatterings at most, on average.

use glam::DVec3;

/// Greatest absorbed share 1 − albedo at which walks are lifted.
const GREATEST_ABSORPTION: f64 = 1e-6;

/// Depth of the limit in transport mean free paths, or in mean free paths if those are longer.
const DEPTH: f64 = 24.0;

/// Where packets are lifted to that have gone deeper.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DepthLimit {
    depth: f64,
    /// 1/L.
    attenuation: f64,
}

impl DepthLimit {
    /// The limit in a half-space of extinction `mu_t` and mean cosine `g`; none where absorption alone ends walks.
    pub fn new(mu_t: f64, albedo: f64, g: f64) -> Option<Self> {
        let transport = mu_t * (1.0 - albedo * g);
        let attenuation = (3.0 * (1.0 - albedo) * mu_t * transport).sqrt();
        (1.0 - albedo < GREATEST_ABSORPTION)
            .then_some(Self { depth: DEPTH / transport.min(mu_t), attenuation })
    }

    /// Lifts a position that is too far below `surface`; the factor on the weight.
    pub(super) fn lift(&self, position: &mut DVec3, surface: f64) -> f64 {
        let excess = surface - self.depth - position.y;
        if excess <= 0.0 {
            return 1.0;
        }
        position.y += excess;
        libm::exp(-excess * self.attenuation)
    }
}
