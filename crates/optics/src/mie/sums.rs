//! Sums over spheres of different radii, shared out among threads.

use rayon::prelude::*;
use std::f64::consts::PI;

use super::MieError;
use super::sphere::Sphere;
use crate::refractive_index::RefractiveIndex;

/// Radii whose sums are joined by one thread. The order of sums does not depend on the number of threads.
const CHUNK: usize = 16;

/// What all spheres have in common.
pub(super) struct Spheres {
    /// Refractive index relative to the medium around.
    pub m: RefractiveIndex,
    /// 2π/λ, 1/µm.
    pub wave_number: f64,
}

/// Integrals over the particles, times their number.
pub(super) struct Sums {
    /// Number of particles.
    pub number: f64,
    /// Area πr², µm².
    pub area: f64,
    /// Volume, µm³.
    pub volume: f64,
    /// Cross section of scattering, µm².
    pub scattering: f64,
    /// Cross section of absorption, µm².
    pub absorption: f64,
    /// Cross section of scattering times g, µm².
    pub forward: f64,
    /// Differential cross section at each cosine, and at that of the opposite sign, µm²/sr.
    pub differential: [Vec<f64>; 2],
    /// Number of terms in all series.
    pub terms: f64,
}

impl Spheres {
    /// Sums over radii in µm, given with the number of their particles, by all threads.
    pub(super) fn parallel_sums(&self, radii: &[(f64, f64)], cosines: &[f64]) -> Result<Sums, MieError> {
        let parts: Result<Vec<Sums>, MieError> =
            radii.par_chunks(CHUNK).map(|radii| self.sums(radii, cosines)).collect();
        let mut sums = Sums::zero(cosines.len());
        parts?.iter().for_each(|part| sums.add(part));
        Ok(sums)
    }

    /// Sums over radii, given with the number of their particles.
    pub(super) fn sums(&self, radii: &[(f64, f64)], cosines: &[f64]) -> Result<Sums, MieError> {
        let mut sums = Sums::zero(cosines.len());
        for &(r, number) in radii {
            let sphere = Sphere::new(self.m, self.wave_number * r)?;
            let area = PI * r * r;
            sums.number += number;
            sums.area += number * area;
            sums.volume += number * area * r * 4.0 / 3.0;
            sums.scattering += number * area * sphere.q_sca;
            sums.absorption += number * area * sphere.q_abs;
            sums.forward += number * area * sphere.q_sca * sphere.g;
            let [there, opposite] = &mut sums.differential;
            sphere.add_intensities(cosines, number / self.wave_number.powi(2), there, opposite);
            sums.terms += sphere.terms() as f64;
        }
        Ok(sums)
    }
}

impl Sums {
    fn zero(angles: usize) -> Self {
        let differential = [vec![0.0; angles], vec![0.0; angles]];
        Self {
            number: 0.0,
            area: 0.0,
            volume: 0.0,
            scattering: 0.0,
            absorption: 0.0,
            forward: 0.0,
            differential,
            terms: 0.0,
        }
    }

    fn integrals(&mut self) -> impl Iterator<Item = &mut f64> {
        let single = [
            &mut self.number,
            &mut self.area,
            &mut self.volume,
            &mut self.scattering,
            &mut self.absorption,
            &mut self.forward,
        ];
        single.into_iter().chain(self.differential.iter_mut().flatten())
    }

    /// All integrals times a factor.
    pub(super) fn times(mut self, factor: f64) -> Self {
        self.integrals().for_each(|integral| *integral *= factor);
        self
    }

    /// Adds the integrals of other spheres.
    pub(super) fn add(&mut self, other: &Self) {
        let single =
            [other.number, other.area, other.volume, other.scattering, other.absorption, other.forward];
        let others = single.iter().chain(other.differential.iter().flatten());
        self.integrals().zip(others).for_each(|(sum, part)| *sum += part);
        self.terms += other.terms;
    }
}
