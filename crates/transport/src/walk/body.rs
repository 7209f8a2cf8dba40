//! A body of finite size in a parallel beam: what it absorbs, and where what it scatters goes.
//!
//! Packets start evenly over the body's projection along the beam and are followed until they are absorbed or escape; each
//! that escapes after a scattering is counted by the cosine between its direction and the beam's. All results are fractions
//! of the light that falls on the projection, so that a fraction times the projected area is a cross-section (Bohren &
//! Huffman 1983, "Absorption and scattering of light by small particles", section 3.4).

use glam::DVec3;
use tyndall_lanes::Random;
use tyndall_scene::{Ray, Volume};

use super::photon::{Photon, first_collision};
use super::run::{Walk, fraction_error};
use super::tally::{Estimate, Scores, Tallies};

/// Volumes in a beam.
#[derive(Debug, Clone)]
pub struct Body {
    /// In one channel.
    volumes: Vec<Volume>,
    direction: DVec3,
    /// A rectangle across the beam, before the body: a corner and two edges.
    corner: DVec3,
    edges: [DVec3; 2],
    bins: usize,
}

/// What a body does, as fractions of the light that falls on its projection.
#[derive(Debug, Clone, PartialEq)]
pub struct BodyPowers {
    /// What it absorbs.
    pub absorbed: Estimate,
    /// What passes it without a scattering.
    pub unscattered: Estimate,
    /// What it scatters, in all.
    pub scattered: Estimate,
    /// What it scatters, by the cosine to the beam, in equal bins from −1 to 1.
    pub bins: Vec<Estimate>,
    /// Number of photons.
    pub samples: u64,
}

/// Places tried before a photon is given up.
const TRIES: u32 = 1 << 20;

/// Of so many places some must be on the body, or the beam will not be sent.
const FIRST_TRIES: u64 = 1 << 14;

const ABSORBED: usize = 0;
const UNSCATTERED: usize = 1;
const SCATTERED: usize = 2;
const FIRST_BIN: usize = 3;

impl Body {
    /// The volumes, which are grey, in a beam along the unit vector `direction`.
    ///
    /// # Errors
    /// A sentence, if a volume is unbounded or the volumes are too sparse for their box.
    pub fn new(volumes: Vec<Volume>, direction: DVec3, bins: usize) -> Result<Self, String> {
        let (across, along) = direction.any_orthonormal_pair();
        let mut least = DVec3::INFINITY;
        let mut greatest = DVec3::NEG_INFINITY;
        for volume in &volumes {
            let Some([low, high]) = volume.local_box() else {
                return Err(format!("`{}` is unbounded; a body is of finite size", volume.name));
            };
            let to_world = volume.world_to_local.inverse();
            for corner in 0..8 {
                let pick = |axis: usize| if corner >> axis & 1 == 0 { low[axis] } else { high[axis] };
                let corner = to_world.transform_point3(DVec3::new(pick(0), pick(1), pick(2)));
                let place = DVec3::new(corner.dot(across), corner.dot(along), corner.dot(direction));
                least = least.min(place);
                greatest = greatest.max(place);
            }
        }
        let size = greatest - least;
        if !size.is_finite() {
            return Err("there is no volume in the beam".into());
        }
        // Well before the body, so that rounding does not start a photon in it.
        let corner = across * least.x + along * least.y + direction * (least.z - 0.01 * size.max_element());
        let body = Self { volumes, direction, corner, edges: [across * size.x, along * size.y], bins };
        let is_met = (0..FIRST_TRIES).any(|i| body.is_hit(&body.place(&mut Random::new(0, u64::MAX, i))));
        if is_met {
            Ok(body)
        } else {
            Err("the beam hardly meets the volumes, so thin are they across it".into())
        }
    }

    /// The results that tallies of this body hold.
    pub fn powers(&self, tallies: &Tallies) -> BodyPowers {
        BodyPowers {
            absorbed: tallies.fraction(ABSORBED),
            unscattered: tallies.fraction(UNSCATTERED),
            scattered: tallies.fraction(SCATTERED),
            bins: (FIRST_BIN..self.tallies()).map(|bin| tallies.fraction(bin)).collect(),
            samples: tallies.photons(),
        }
    }

    fn place(&self, random: &mut Random) -> Ray {
        let origin = self.corner + self.edges[0] * random.f64() + self.edges[1] * random.f64();
        Ray { origin, direction: self.direction }
    }

    fn is_hit(&self, ray: &Ray) -> bool {
        self.volumes
            .iter()
            .any(|volume| volume.interval(&volume.local_ray(ray), (0.0, f64::INFINITY)).is_some())
    }
}

impl Walk for Body {
    fn tallies(&self) -> usize {
        FIRST_BIN + self.bins
    }

    fn walk(&self, random: &mut Random, scores: &mut Scores) {
        let mut start = self.place(random);
        for _ in 0..TRIES {
            if self.is_hit(&start) {
                break;
            }
            start = self.place(random);
        }
        let mut photon = Photon::new(start.origin, start.direction);
        while let Some((distance, volume)) =
            first_collision(&self.volumes, &photon.ray, f64::INFINITY, random)
        {
            photon.ray.origin = photon.ray.at(distance);
            scores.add(ABSORBED, photon.absorb(volume.albedo_at(photon.ray.origin).x));
            if !photon.survives_roulette(random) {
                return;
            }
            photon.scatter(volume, random);
        }
        if photon.is_unscattered {
            return scores.add(UNSCATTERED, photon.weight);
        }
        let cosine = photon.ray.direction.dot(self.direction);
        let bin = (0.5 * (cosine + 1.0) * self.bins as f64) as usize;
        scores.add(SCATTERED, photon.weight);
        scores.add(FIRST_BIN + bin.min(self.bins - 1), photon.weight);
    }

    fn relative_error(&self, tallies: &Tallies) -> f64 {
        let errors = [ABSORBED, SCATTERED].map(|tally| fraction_error(tallies.fraction(tally), tallies));
        errors[0].max(errors[1])
    }
}
