//! What a surface does to light at a point: the bidirectional scattering distribution functions f(ω,ω′).
//!
//! All directions are in the local frame of the shading normal, which is +z on the outer side of the surface, and point
//! away from the surface: `wo` to where the path came from, `wi` to where it goes and light comes from. Colours are in
//! the four lanes of a path's channels (red, green, blue and nothing, or four wavelengths); densities are the same for all
//! of them, so that any channel could have drawn a direction.

use glam::{DVec3, DVec4};

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
    /// (η_wi/η_wo)² by which `weight` is scaled because the light is refracted; 1 otherwise. Roulette leaves it out.
    pub radiance_scale: f64,
}

impl Bsdf {
    /// Draws a direction; `u` is uniform in [0, 1)², and so is `choice` in [0, 1), which chooses among lobes. `None` if
    /// the path is absorbed.
    pub fn sample(&self, wo: DVec3, choice: f64, u: [f64; 2]) -> Option<BsdfSample> {
        let _ = choice;
        match self {
            Self::Black => None,
            Self::Diffuse { reflectance } => {
                let (r, phi) = (u[0].sqrt(), std::f64::consts::TAU * u[1]);
                let z = (1.0 - u[0]).max(0.0).sqrt().copysign(wo.z);
                let wi = DVec3::new(r * phi.cos(), r * phi.sin(), z);
                let pdf = z.abs() / std::f64::consts::PI;
                (pdf > 0.0).then_some(BsdfSample {
                    wi,
                    weight: *reflectance,
                    pdf,
                    is_delta: false,
                    radiance_scale: 1.0,
                })
            }
        }
    }

    /// f(ω,ω′) |cos θ| of `wi`, without mirrors.
    pub fn value(&self, wo: DVec3, wi: DVec3) -> DVec4 {
        match self {
            Self::Black => DVec4::ZERO,
            Self::Diffuse { reflectance } if wo.z * wi.z > 0.0 => {
                *reflectance * (wi.z.abs() / std::f64::consts::PI)
            }
            Self::Diffuse { .. } => DVec4::ZERO,
        }
    }

    /// Density with which [`sample`](Self::sample) draws `wi`, 1/sr, without mirrors.
    pub fn pdf(&self, wo: DVec3, wi: DVec3) -> f64 {
        match self {
            Self::Black => 0.0,
            Self::Diffuse { .. } if wo.z * wi.z > 0.0 => wi.z.abs() / std::f64::consts::PI,
            Self::Diffuse { .. } => 0.0,
        }
    }

    /// Whether there is nothing but mirrors, so that [`value`](Self::value) is 0 everywhere.
    pub fn is_delta(&self) -> bool {
        matches!(self, Self::Black)
    }

    /// Roughly the fraction of light that is not absorbed, for the film's albedo layer.
    pub fn albedo(&self) -> DVec4 {
        match self {
            Self::Black => DVec4::ZERO,
            Self::Diffuse { reflectance } => *reflectance,
        }
    }
}
