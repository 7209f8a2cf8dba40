//! Ray marching: optical thickness is spent by equal steps h, in each of which the extinction is taken for constant.
//!
//! Each step is looked at the same random part of the way through it (Pauly, Kollig & Keller 2000). Source: Perlin & Hoffert
//! 1989; Novák et al. 2018, section 3.2. Biased: distances follow the extinction of the steps, with an error that falls with
//! h² for the mean transmittance and with h for the place within a step. Cost: one lookup a step up to the collision.

use tyndall_lanes::Random;

use super::Flight;
use crate::along_ray::{AlongRay, Lookups};
use crate::properties::{MajorantUse, Properties};

pub(super) const PROPERTIES: Properties = Properties {
    name: "ray-marching",
    unbiased: false,
    majorant: MajorantUse::None,
    needs: &[],
    source: "Perlin & Hoffert 1989",
};

/// Steps unless another number is asked for.
pub(super) const STEPS: u32 = 64;

pub(super) fn sample(ray: &AlongRay, steps: u32, random: &mut Random, lookups: &mut Lookups) -> Flight {
    let steps = steps.max(1);
    let (start, end) = (ray.start(), ray.end());
    let step = (end - start) / f64::from(steps);
    let offset = random.f64();
    let mut rest = random.exponential_f64();
    for i in 0..steps {
        let before = start + f64::from(i) * step;
        let mu_t = ray.mu_t(before + offset * step, lookups);
        if rest < mu_t * step {
            return Flight::analog(Some(before + rest / mu_t));
        }
        rest -= mu_t * step;
    }
    Flight::analog(None)
}
