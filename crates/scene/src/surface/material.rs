//! Materials ready to evaluate at a point: [`Bsdf`]s whose parameters vary over the surface.
//!
//! A surface may be `null` here and there: a ray then passes as if it were not there, with a probability that is the same for
//! all colours, and what is left is a BSDF as if there were nothing else.

use glam::DVec4;
use tyndall_optics::bsdf::{
    Bsdf, Coat, Conductor, Dielectric, Ggx, Mix, Plastic, RoughDiffuse, ThinDielectric, fresnel,
};

use super::Hit;
use super::texture::{Colour, Texture};
use crate::Channels;

/// What a surface is made of.
#[derive(Debug, Clone, Default, PartialEq)]
pub enum Material {
    /// Nothing: light goes through.
    #[default]
    Null,
    /// Matte.
    Diffuse {
        /// Fraction of the light that is reflected.
        reflectance: Texture,
    },
    /// Rough and matte.
    RoughDiffuse {
        /// Fraction of the light that the facets reflect.
        reflectance: Texture,
        /// Standard deviation of the facets' slope angle, degrees.
        sigma: f64,
    },
    /// Metal.
    Conductor {
        /// What it does to light.
        index: ConductorIndex,
        /// Its microfacets; none if it is a mirror.
        facets: Option<Ggx>,
        /// Factor on what is reflected.
        tint: Option<Texture>,
    },
    /// Boundary of glass or water.
    Dielectric {
        /// Refractive index of the inside over that of the outside.
        index: f64,
        /// Its microfacets; none if it is smooth.
        facets: Option<Ggx>,
        /// Factor on what is reflected.
        reflection_tint: Option<Texture>,
        /// Factor on what is let through.
        transmission_tint: Option<Texture>,
    },
    /// A sheet of glass.
    ThinDielectric {
        /// Refractive index of the sheet over that around.
        index: f64,
        /// Factor on what is reflected.
        reflection_tint: Option<Texture>,
        /// Factor on what is let through.
        transmission_tint: Option<Texture>,
    },
    /// A coat over a diffuse base.
    Plastic {
        /// Fraction of the light that the base reflects.
        reflectance: Texture,
        /// The coat.
        coat: Box<Coat>,
        /// Factor on what the coat reflects.
        reflection_tint: Option<Texture>,
        /// Whether light between base and coat takes the base's colour each time.
        nonlinear: bool,
    },
    /// Two materials side by side.
    Mix {
        /// The first and the second.
        materials: Box<[Material; 2]>,
        /// Share of the second.
        amount: Texture,
    },
}

/// The refractive index of a metal over that of the outside.
#[derive(Debug, Clone, PartialEq)]
pub enum ConductorIndex {
    /// n + ik.
    Complex {
        /// n.
        eta: Box<Colour>,
        /// k.
        k: Box<Colour>,
    },
    /// That of n = 1 with this reflectance at normal incidence.
    Reflectance(Box<Colour>),
}

impl Material {
    /// Whether light may cross the surface unbent somewhere: `null`, or a mixture with it.
    pub fn may_pass(&self) -> bool {
        match self {
            Self::Null => true,
            Self::Mix { materials, .. } => materials.iter().any(Self::may_pass),
            _ => false,
        }
    }

    /// Probability that a ray passes the surface at `hit` as if it were not there: of a mixture with `null`, its share,
    /// the mean over red, green and blue.
    pub fn pass_probability(&self, hit: &Hit) -> f64 {
        match self {
            Self::Null => 1.0,
            Self::Mix { materials, amount } if self.may_pass() => {
                let amount = amount.grey_at(hit.uv);
                let [first, second] = materials.each_ref().map(|material| material.pass_probability(hit));
                first + (second - first) * amount
            }
            _ => 0.0,
        }
    }

    /// Whether nothing ever crosses the surface.
    pub fn is_opaque(&self) -> bool {
        match self {
            Self::Null | Self::Dielectric { .. } | Self::ThinDielectric { .. } => false,
            Self::Diffuse { .. }
            | Self::RoughDiffuse { .. }
            | Self::Conductor { .. }
            | Self::Plastic { .. } => true,
            Self::Mix { materials, .. } => materials.iter().all(Self::is_opaque),
        }
    }

    /// The surface at `hit` in `channels`, for light that does not pass it unbent.
    pub fn bsdf(&self, hit: &Hit, channels: &Channels) -> Bsdf {
        let value = |texture: &Texture| texture.at(hit.uv, channels);
        let tint = |texture: &Option<Texture>| texture.as_ref().map_or(channels.ones(), value);
        match self {
            Self::Null => Bsdf::Black,
            Self::Diffuse { reflectance } => Bsdf::Diffuse { reflectance: value(reflectance) },
            Self::RoughDiffuse { reflectance, sigma } => {
                Bsdf::RoughDiffuse(RoughDiffuse::new(value(reflectance), *sigma))
            }
            Self::Conductor { index, facets, tint: factor } => {
                let [eta, k] = index.in_channels(channels);
                Bsdf::Conductor(Conductor { eta, k, tint: tint(factor), facets: *facets })
            }
            Self::Dielectric { index, facets, reflection_tint, transmission_tint } => {
                Bsdf::Dielectric(Dielectric {
                    index: *index,
                    reflection_tint: tint(reflection_tint),
                    transmission_tint: tint(transmission_tint),
                    facets: *facets,
                })
            }
            Self::ThinDielectric { index, reflection_tint, transmission_tint } => {
                Bsdf::ThinDielectric(ThinDielectric {
                    index: *index,
                    reflection_tint: tint(reflection_tint),
                    transmission_tint: tint(transmission_tint),
                })
            }
            Self::Plastic { reflectance, coat, reflection_tint, nonlinear } => {
                Bsdf::Plastic(Plastic::new(**coat, value(reflectance), tint(reflection_tint), *nonlinear))
            }
            Self::Mix { materials, amount } => self.mixture(materials, amount, hit, channels),
        }
    }

    /// What is left of two materials where neither lets a ray pass.
    fn mixture(&self, materials: &[Material; 2], amount: &Texture, hit: &Hit, channels: &Channels) -> Bsdf {
        let ones = channels.ones();
        let mut shares = if self.may_pass() {
            let amount = amount.grey_at(hit.uv);
            let stay = materials.each_ref().map(|material| 1.0 - material.pass_probability(hit));
            let (first, second) = ((1.0 - amount) * stay[0], amount * stay[1]);
            let all = first + second;
            if all <= 0.0 {
                return Bsdf::Black;
            }
            [ones * (first / all), ones * (second / all)]
        } else {
            let amount = amount.at(hit.uv, channels);
            [ones - amount, amount]
        };
        // Where a mask is black or white there is only one material.
        for part in [0, 1] {
            if shares[1 - part] == DVec4::ZERO {
                return materials[part].bsdf(hit, channels);
            }
            shares[part] = shares[part].max(DVec4::ZERO);
        }
        let parts = materials.each_ref().map(|material| material.bsdf(hit, channels));
        Bsdf::Mix(Box::new(Mix { parts, shares }))
    }
}

impl ConductorIndex {
    fn in_channels(&self, channels: &Channels) -> [DVec4; 2] {
        match self {
            Self::Complex { eta, k } => [eta.in_channels(channels), k.in_channels(channels)],
            Self::Reflectance(reflectance) => {
                let k = reflectance.in_channels(channels).map(fresnel::k_of_reflectance);
                [DVec4::ONE, k]
            }
        }
    }
}
