//! A photon packet on its way: a position, a direction, and the fraction of its light that is still there.
//!
//! At a collision the fraction 1 − albedo is absorbed and the rest is scattered (implicit capture); a packet that has
//! become weak ends by Russian roulette. Source: Wang, Jacques & Zheng 1995, "MCML: Monte Carlo modeling of light
//! transport in multi-layered tissues".

use glam::DVec3;
use tyndall_lanes::Random;
use tyndall_scene::{Ray, Volume};

use crate::distance::sample_distance;

/// Weight below which roulette is played; survivors have twice as much.
const ROULETTE_WEIGHT: f64 = 0.1;

/// A photon packet.
#[derive(Debug, Clone, Copy)]
pub(super) struct Photon {
    /// Where it is, and where it goes.
    pub ray: Ray,
    /// The fraction of its light that is left.
    pub weight: f64,
    /// Whether it has not been scattered yet.
    pub is_unscattered: bool,
}

impl Photon {
    /// A packet that has not met anything yet.
    pub fn new(origin: DVec3, direction: DVec3) -> Self {
        Self { ray: Ray { origin, direction }, weight: 1.0, is_unscattered: true }
    }

    /// Takes off what is absorbed where the fraction `albedo` is left; the amount.
    pub fn absorb(&mut self, albedo: f64) -> f64 {
        let absorbed = self.weight * (1.0 - albedo);
        self.weight *= albedo;
        absorbed
    }

    /// Whether the packet goes on; a weak one does with a probability for which its weight makes up.
    pub fn survives_roulette(&mut self, random: &mut Random) -> bool {
        if self.weight >= ROULETTE_WEIGHT {
            return true;
        }
        let survivors = 2.0 * ROULETTE_WEIGHT;
        if random.f64() * survivors >= self.weight {
            return false;
        }
        self.weight = survivors;
        true
    }

    /// Turns the packet into a direction drawn from the phase function.
    pub fn scatter(&mut self, volume: &Volume, random: &mut Random) {
        let u = [random.f64(), random.f64()];
        self.ray.direction = volume.medium.phase_function.sample(self.ray.direction, u);
        self.is_unscattered = false;
    }
}

/// The nearest collision with any of the volumes before `end`: overlapping media are independent of each other, so the
/// first of their first collisions follows the sum of their extinctions.
pub(super) fn first_collision<'a>(
    volumes: &'a [Volume],
    ray: &Ray,
    mut end: f64,
    random: &mut Random,
) -> Option<(f64, &'a Volume)> {
    let mut nearest = None;
    for volume in volumes {
        if let Some(distance) = sample_distance(volume, ray, (0.0, end), random) {
            end = distance;
            nearest = Some((distance, volume));
        }
    }
    nearest
}

/// A downward direction with density cos θ/π: light of the same radiance from the whole upper hemisphere.
pub(super) fn diffuse_direction(random: &mut Random) -> DVec3 {
    let (sin_azimuth, cos_azimuth) = libm::sincos(std::f64::consts::TAU * random.f64());
    let cos_squared = 1.0 - random.f64();
    let sin = (1.0 - cos_squared).sqrt();
    DVec3::new(sin * cos_azimuth, -cos_squared.sqrt(), sin * sin_azimuth)
}
