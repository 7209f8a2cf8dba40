//! What a surface does to light at a point: the bidirectional scattering distribution functions f(ω,ω′).
//!
//! All directions are in the local frame of the shading normal, which is +z on the outer side of the surface, and point
//! away from the surface: `wo` to where the path came from, `wi` to where it goes and light comes from. Colours are in
//! the four lanes of a path's channels (red, green, blue and nothing, or four wavelengths); densities are the same for all
//! of them, so that any channel could have drawn a direction.

mod conductor;
mod dielectric;
mod diffuse;
pub mod fresnel;
mod ggx;
mod mix;
mod plastic;
mod rough_diffuse;
mod thin_dielectric;

use glam::{DVec3, DVec4};

pub use self::conductor::Conductor;
pub use self::dielectric::Dielectric;
pub use self::ggx::Ggx;
pub use self::mix::Mix;
pub use self::plastic::{Coat, Plastic};
pub use self::rough_diffuse::RoughDiffuse;
pub use self::thin_dielectric::ThinDielectric;

/// A surface at a point, ready to evaluate.
#[derive(Debug, Clone, PartialEq)]
pub enum Bsdf {
    /// Absorbs all light.
    Black,
    /// Lambert's: f = ρ/π on the side of `wo`.
    Diffuse {
        /// Reflectance ρ.
        reflectance: DVec4,
    },
    /// A matte surface of diffuse facets.
    RoughDiffuse(RoughDiffuse),
    /// A metal.
    Conductor(Conductor),
    /// A boundary of glass or water.
    Dielectric(Dielectric),
    /// A sheet of glass.
    ThinDielectric(ThinDielectric),
    /// A coat over a diffuse base.
    Plastic(Plastic),
    /// Two of them side by side.
    Mix(Box<Mix>),
}

/// A direction in which a path goes on.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BsdfSample {
    /// The direction.
    pub wi: DVec3,
    /// f(ω,ω′) |cos θ| over the density; of a mirror, the factor on the radiance. Radiance is scaled by the squared ratio of
    /// indices where light is refracted.
    pub weight: DVec4,
    /// Density over solid angle, 1/sr; 0 if `is_delta`.
    pub pdf: f64,
    /// Whether only sampling finds this direction, as that of a mirror.
    pub is_delta: bool,
    /// (η_wo/η_wi)² by which `weight` is scaled because the light is refracted: it shines less into the thinner medium.
    /// 1 otherwise, and altogether for light that goes in and out again. Roulette leaves it out.
    pub radiance_scale: f64,
}

impl BsdfSample {
    /// A mirror's.
    fn delta(wi: DVec3, weight: DVec4) -> Self {
        Self { wi, weight, pdf: 0.0, is_delta: true, radiance_scale: 1.0 }
    }

    /// A sample, unless its density is 0 or beyond all numbers, as may happen at grazing angles by rounding.
    fn if_sound(wi: DVec3, weight: DVec4, pdf: f64, radiance_scale: f64) -> Option<Self> {
        let sound = pdf > 0.0 && pdf.is_finite() && weight.is_finite();
        sound.then_some(Self { wi, weight, pdf, is_delta: false, radiance_scale })
    }
}

impl Bsdf {
    /// Draws a direction; `u` is uniform in [0, 1)², and so is `choice` in [0, 1), which chooses among lobes. `None` if
    /// the path is absorbed.
    pub fn sample(&self, wo: DVec3, choice: f64, u: [f64; 2]) -> Option<BsdfSample> {
        match self {
            Self::Black => None,
            Self::Diffuse { reflectance } => diffuse::sample(*reflectance, wo, u),
            Self::RoughDiffuse(surface) => surface.sample(wo, u),
            Self::Conductor(surface) => surface.sample(wo, u),
            Self::Dielectric(surface) => surface.sample(wo, choice, u),
            Self::ThinDielectric(surface) => surface.sample(wo, choice),
            Self::Plastic(surface) => surface.sample(wo, choice, u),
            Self::Mix(mix) => mix.sample(wo, choice, u),
        }
    }

    /// f(ω,ω′) |cos θ| of `wi`, without mirrors.
    pub fn value(&self, wo: DVec3, wi: DVec3) -> DVec4 {
        match self {
            Self::Black | Self::ThinDielectric(_) => DVec4::ZERO,
            Self::Diffuse { reflectance } => diffuse::value(*reflectance, wo, wi),
            Self::RoughDiffuse(surface) => surface.value(wo, wi),
            Self::Conductor(surface) => surface.value(wo, wi),
            Self::Dielectric(surface) => surface.value(wo, wi),
            Self::Plastic(surface) => surface.value(wo, wi),
            Self::Mix(mix) => mix.value(wo, wi),
        }
    }

    /// Density with which [`sample`](Self::sample) draws `wi`, 1/sr, without mirrors: its integral is the probability
    /// that the sample is one and no mirror's.
    pub fn pdf(&self, wo: DVec3, wi: DVec3) -> f64 {
        match self {
            Self::Black | Self::ThinDielectric(_) => 0.0,
            Self::Diffuse { .. } | Self::RoughDiffuse(_) => diffuse::pdf(wo, wi),
            Self::Conductor(surface) => surface.pdf(wo, wi),
            Self::Dielectric(surface) => surface.pdf(wo, wi),
            Self::Plastic(surface) => surface.pdf(wo, wi),
            Self::Mix(mix) => mix.pdf(wo, wi),
        }
    }

    /// Whether there is nothing but mirrors, so that [`value`](Self::value) is 0 everywhere.
    pub fn is_delta(&self) -> bool {
        match self {
            Self::Black | Self::ThinDielectric(_) => true,
            Self::Diffuse { .. } | Self::RoughDiffuse(_) | Self::Plastic(_) => false,
            Self::Conductor(surface) => surface.facets.is_none(),
            Self::Dielectric(surface) => surface.is_delta(),
            Self::Mix(mix) => mix.is_delta(),
        }
    }

    /// Roughly the fraction of light that is not absorbed, for the film's albedo layer.
    pub fn albedo(&self) -> DVec4 {
        match self {
            Self::Black => DVec4::ZERO,
            Self::Diffuse { reflectance } => *reflectance,
            Self::RoughDiffuse(surface) => surface.albedo(),
            Self::Conductor(surface) => surface.albedo(),
            Self::Dielectric(surface) => surface.albedo(),
            Self::ThinDielectric(surface) => surface.albedo(),
            Self::Plastic(surface) => surface.albedo(),
            Self::Mix(mix) => mix.albedo(),
        }
    }
}
