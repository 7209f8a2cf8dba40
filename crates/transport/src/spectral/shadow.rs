//! A shadow ray of the hero: transmittance of all channels by ratio tracking with the hero's tentative collisions.
//!
//! All of the N tentative collisions in the grids are taken for null; for a channel c their density and transmittance are,
//! up to what all channels have in common,
//!
//!   q_c = μt_c^N exp(−μt_c ∫D̄),    T_c = q_c Π(1 − ρ) · exp(−μt_c ∫D) in volumes with a closed form.
//!
//! Source: Novák, Selle & Jarosz 2014 (ratio tracking); Miller, Georgiev & Jarosz 2019 (its densities). Roulette is on
//! Π(1 − ρ), which does not depend on the channel.

use std::ops::ControlFlow;

use glam::DVec4;
use tyndall_lanes::Random;
use tyndall_scene::{ChannelMedium, Density, Ray, Volume};

use super::flight::{bound_integral, ln, optical_thickness, tentative_collisions};
use crate::way::Way;

/// Weight below which roulette is played, and the weight of survivors.
const ROULETTE_WEIGHT: f64 = 0.1;

/// What a shadow ray met.
#[derive(Debug, Clone, Copy)]
pub(super) struct ShadowRay {
    /// ln q_c, up to a constant.
    pub log_density: DVec4,
    /// Of the volumes with a closed form.
    pub optical_thickness: DVec4,
    /// Π(1 − ρ) over the tentative collisions.
    pub null_fraction: f64,
    /// What roulette makes up for.
    pub roulette: f64,
}

impl ShadowRay {
    /// Tracks `ray` on its way with the tentative collisions of channel `hero`; none if nothing gets through.
    pub(super) fn track(
        volumes: &[Volume],
        media: &[ChannelMedium],
        ray: &Ray,
        way: &Way,
        hero: usize,
        random: &mut Random,
    ) -> Option<ShadowRay> {
        let mut shadow = ShadowRay {
            log_density: DVec4::ZERO,
            optical_thickness: DVec4::ZERO,
            null_fraction: 1.0,
            roulette: 1.0,
        };
        for span in &way.spans {
            let volume = &volumes[span.volume];
            let mu_t = media[span.volume].mu_t_along(ray.direction);
            let local = volume.local_ray(ray);
            let range = (span.start, span.end);
            let thickness = optical_thickness(mu_t, bound_integral(volume, &local, range));
            let Density::Grid(grid) = &volume.density else {
                shadow.optical_thickness += thickness;
                continue;
            };
            shadow.log_density -= thickness;
            if mu_t[hero] <= 0.0 {
                continue;
            }
            let walk = tentative_collisions(grid, &local, range, mu_t[hero], random, |_, rho, random| {
                shadow.log_density += ln(mu_t);
                shadow.null_fraction *= 1.0 - rho;
                shadow.survives_roulette(random)
            });
            if walk.is_break() {
                return None;
            }
        }
        Some(shadow)
    }

    fn survives_roulette(&mut self, random: &mut Random) -> ControlFlow<()> {
        let weight = self.null_fraction * self.roulette;
        if weight < ROULETTE_WEIGHT {
            if random.f64() * ROULETTE_WEIGHT >= weight {
                return ControlFlow::Break(());
            }
            self.roulette *= ROULETTE_WEIGHT / weight;
        }
        ControlFlow::Continue(())
    }
}
