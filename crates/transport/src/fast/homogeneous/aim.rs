//! Directions towards the light that hangs in the medium around lamps.
//!
//! In a thin medium what a ray gathers of a lamp goes as 1/D with the least distance D = r sin γ between them, where γ is the
//! angle at the ray's origin between the ray and the lamp at the distance r. So far as a path is to find that light it should
//! choose γ uniformly, with the density over solid angle
//!
//!   p_a(ω) = 1/(π² sin γ)   for γ < π/2
//!
//! (the direction's part in the joint sampling of Georgiev et al. 2013, "Joint importance sampling of low-order volumetric
//! scattering"). A share of the directions does, in proportion to the transmittance towards the lamp; the others follow the
//! phase function or the surface, and all are weighted by the density of the mixture (Veach 1997, section 9.2).

use std::f32::consts::PI;

use glam::{DVec3, Vec3};
use tyndall_lanes::sin_cos_turns;

use super::distances::Place;

/// Share of the directions that aim at lamps from where nothing is in between.
const SHARE: f32 = 0.5;

/// Lamps that are aimed at.
pub(super) struct Targets(Vec<(DVec3, f32)>);

/// Most lamps: the density of a direction is a sum over all of them.
const MOST: usize = 4;

/// Shares of the lamps, and the directions to them, from one place.
pub(super) struct Aim {
    count: usize,
    share: [f32; MOST],
    toward: [Vec3; MOST],
}

impl Targets {
    /// Of these places and the probabilities of their lights; none if they are many.
    pub fn new(lamps: &[(Place, f64)], is_foggy: bool) -> Self {
        let all: f64 = lamps.iter().map(|(_, probability)| probability).sum();
        if !is_foggy || all <= 0.0 || lamps.len() > MOST {
            return Self(Vec::new());
        }
        Self(lamps.iter().map(|(place, probability)| (place.center, (probability / all) as f32)).collect())
    }

    /// What is aimed at from `from`.
    #[inline(always)]
    pub fn from(&self, from: DVec3, mu_t: f32) -> Aim {
        let mut aim = Aim { count: self.0.len(), share: [0.0; MOST], toward: [Vec3::Y; MOST] };
        for (k, (place, probability)) in self.0.iter().enumerate() {
            let offset = (*place - from).as_vec3();
            let distance = offset.length();
            if distance > 0.0 {
                aim.share[k] = SHARE * probability * tyndall_lanes::exp(-mu_t * distance);
                aim.toward[k] = offset / distance;
            }
        }
        aim
    }
}

impl Aim {
    /// A direction at a lamp; `None` for the share of the others.
    #[inline(always)]
    pub fn sample(&self, choice: f32, u: [f32; 2]) -> Option<Vec3> {
        if self.count == 0 {
            return None;
        }
        let mut rest = choice;
        for k in 0..self.count {
            if rest < self.share[k] {
                let [u, v] = u;
                let (sin, cos) = sin_cos_turns(0.25 * u);
                let (sin_azimuth, cos_azimuth) = sin_cos_turns(v);
                let (first, second) = self.toward[k].any_orthonormal_pair();
                let across = first * cos_azimuth + second * sin_azimuth;
                return Some(self.toward[k] * cos + across * sin);
            }
            rest -= self.share[k];
        }
        None
    }

    /// Density of a direction that had the density `pdf` without the lamps.
    #[inline(always)]
    pub fn pdf(&self, direction: Vec3, pdf: f32) -> f32 {
        let (mut sum, mut rest) = (0.0, 1.0);
        for k in 0..self.count {
            let cos = self.toward[k].dot(direction);
            if cos > 0.0 {
                let sin = (1.0 - cos * cos).max(1e-12).sqrt();
                sum += self.share[k] / (PI * PI * sin);
            }
            rest -= self.share[k];
        }
        sum + rest * pdf
    }
}
