//! A homogeneous plane-parallel layer in optical units: extinction 1 between y = −τ and y = 0, τ possibly infinite.
//!
//! Its unscattered transmittance is known. With the reflectance F of the faces at the cosine μ of the incident light
//! and μ′ = √(1 − (1 − μ²)/n²) inside,
//!
//!   T₀(μ) = (1 − F)² e^(−τ/μ′) / (1 − F² e^(−2τ/μ′)),   and for diffuse light   ∫₀¹ T₀(μ) 2μ dμ,
//!
//! which is 2 E₃(τ) without reflection (van de Hulst 1980, "Multiple light scattering", section 2.1).

use std::sync::atomic::AtomicBool;

use glam::{DAffine3, DVec3};
use tyndall_optics::PhaseFunction;
use tyndall_scene::{Density, Medium, Volume};

use super::fresnel::reflectance;
use super::half_space::DepthLimit;
use super::layer::{Incidence, Layer, LayerFluxes};
use super::run::{WalkOptions, run};
use super::tally::Estimate;

/// A homogeneous plane-parallel layer.
#[derive(Debug, Clone)]
pub struct Slab {
    /// Optical thickness τ; infinite for a half-space.
    pub tau: f64,
    /// Single-scattering albedo, 0 to 1.
    pub albedo: f64,
    /// The phase function.
    pub phase_function: PhaseFunction,
    /// The light from above.
    pub incidence: Incidence,
    /// Refractive index of the layer, at least 1; air is outside.
    pub refractive_index: f64,
    /// Fraction of the light that the ground below reflects.
    pub ground_albedo: f64,
    /// Unit vectors along which radiance is asked for, as the light travels; see [`Layer::views`].
    pub views: Vec<DVec3>,
}

impl Slab {
    /// Sends photons until the goal is reached or `cancel` is set.
    pub fn measure(&self, options: &WalkOptions, cancel: &AtomicBool) -> LayerFluxes {
        let volumes = self.volumes();
        let layer = self.layer(&volumes);
        let tallies = run(&layer, options, cancel);
        let fluxes = layer.fluxes(&tallies);
        // Of oriented particles the extinction depends on the direction; τ is that of the most hindered.
        let is_isotropic = DVec3::AXES.iter().all(|&axis| self.phase_function.projected_area(axis) == 1.0);
        if is_isotropic {
            LayerFluxes { unscattered: Estimate::exact(self.unscattered()), ..fluxes }
        } else {
            fluxes
        }
    }

    fn volumes(&self) -> Vec<Volume> {
        if self.tau == 0.0 {
            return Vec::new();
        }
        let medium = Medium::grey(1.0, self.albedo, self.phase_function.clone());
        let density = Density::Slab { bottom: -self.tau, top: 0.0 };
        vec![Volume {
            name: "slab".into(),
            world_to_local: DAffine3::IDENTITY,
            density,
            medium,
            fields: None,
        }]
    }

    fn layer<'a>(&self, volumes: &'a [Volume]) -> Layer<'a> {
        let depth_limit = if self.tau.is_finite() {
            None
        } else {
            DepthLimit::new(1.0, self.albedo, self.phase_function.mean_cosine())
        };
        Layer {
            volumes,
            faces: [-self.tau, 0.0],
            tile: None,
            incidence: self.incidence,
            refractive_index: self.refractive_index,
            ground_albedo: self.ground_albedo,
            columns: None,
            views: self.views.clone(),
            depth_limit,
        }
    }

    /// The unscattered transmittance T₀ for the slab's light.
    pub fn unscattered(&self) -> f64 {
        match self.incidence {
            Incidence::Beam(direction) => self.unscattered_at(-direction.y),
            Incidence::Diffuse => {
                // Simpson's rule; the integrand is smooth, and its error below 1e-12.
                let n = 4096;
                let term = |i: u32| {
                    let mu = f64::from(i) / f64::from(n);
                    let weight = f64::from(if i == 0 || i == n { 1 } else { 2 + 2 * (i % 2) });
                    weight * 2.0 * mu * self.unscattered_at(mu)
                };
                (0..=n).map(term).sum::<f64>() / (3.0 * f64::from(n))
            }
        }
    }

    fn unscattered_at(&self, mu: f64) -> f64 {
        if mu == 0.0 {
            return 0.0;
        }
        let (reflected, inside) = match self.refractive_index {
            1.0 => (0.0, mu),
            index => reflectance(mu, 1.0, index),
        };
        let through = libm::exp(-self.tau / inside);
        (1.0 - reflected).powi(2) * through / (1.0 - (reflected * through).powi(2))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn unscattered_diffuse_light_is_twice_the_third_exponential_integral() {
        // 2 E3(τ): Abramowitz & Stegun 1964, table 5.1 and the limit at 0.
        for (tau, expected) in [(0.0, 1.0), (0.5, 2.0 * 0.221_604_364), (1.0, 2.0 * 0.109_691_967)] {
            let slab = Slab {
                tau,
                albedo: 0.5,
                phase_function: PhaseFunction::Isotropic,
                incidence: Incidence::Diffuse,
                refractive_index: 1.0,
                ground_albedo: 0.0,
                views: vec![],
            };
            assert!((slab.unscattered() - expected).abs() < 2e-9, "{tau}: {}", slab.unscattered());
        }
    }
}
