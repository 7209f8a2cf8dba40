//! Many spheres of different radii: cross sections and phase function of the mean particle.
//!
//! ```text
//! C = ∫ C(r) n(r) dr / ∫ n(r) dr        Q = ∫ C(r) n(r) dr / ∫ πr² n(r) dr
//! g = ∫ g(r) Csca(r) n(r) dr / ∫ Csca(r) n(r) dr        f_p = ∫ (dCsca/dΩ)(r) n(r) dr / ∫ Csca(r) n(r) dr
//! ```
//!
//! (Hansen & Travis 1974, section 2.4). Steps of the quadrature are halved, which keeps all radii computed before, until
//! nothing changes: resonances of single spheres, far narrower than a step, otherwise leave some percent of noise in the
//! phase function.

use std::f64::consts::{PI, TAU};
use std::sync::Arc;

use super::angle_grid::{forward_angles, refined};
use super::radius_grid::RadiusGrid;
use super::sums::{Spheres, Sums};
use super::{MieError, SizeDistribution, SizeLaw};
use crate::PhaseFunction;
use crate::phase_function::TabulatedPhase;
use crate::refractive_index::RefractiveIndex;

/// Optical properties, at one wavelength, of the mean particle of a size distribution.
#[derive(Debug, Clone, PartialEq)]
pub struct MieAverage {
    /// Wavelength, nm.
    pub wavelength: f64,
    /// Extinction efficiency.
    pub q_ext: f64,
    /// Scattering efficiency.
    pub q_sca: f64,
    /// Absorption efficiency.
    pub q_abs: f64,
    /// Asymmetry: mean cosine of the scattering angle.
    pub g: f64,
    /// Mean of πr², µm².
    pub area: f64,
    /// Mean of 4πr³/3, µm³.
    pub volume: f64,
    /// Scattering angles, radians, from 0 to π.
    pub angles: Vec<f64>,
    /// Phase function at `angles`, 1/sr.
    pub values: Vec<f64>,
    /// The greatest relative change when the number of radii was doubled last, of the efficiencies and of the phase
    /// function; 0 for a single radius.
    pub change: [f64; 2],
}

/// Changes at which radii are enough: of efficiencies and g, and of any value of the phase function.
const ENOUGH: [f64; 2] = [7e-5, 8e-3];

/// Steps of ln r to begin with.
const FIRST_STEPS: usize = 128;

/// Halving ends, at the latest, where the terms of series summed so far exceed this (some ten seconds).
const MOST_TERMS: f64 = 8e9;

impl MieAverage {
    /// Averages spheres of refractive index `m`, relative to the medium around, over `distribution`, in light of
    /// `wavelength` nm in that medium.
    pub fn new(
        m: RefractiveIndex,
        wavelength: f64,
        distribution: &SizeDistribution,
    ) -> Result<Self, MieError> {
        distribution.check()?;
        let spheres = Spheres { m, wave_number: TAU / (wavelength * 1e-3) };
        if let SizeLaw::Single { r } = distribution.law {
            let angles = forward_angles(spheres.wave_number * r, 0.0);
            let sums = spheres.sums(&[(r, 1.0)], &cosines(&angles))?;
            return Ok(Self::from_sums(&sums, wavelength, &angles).refined());
        }
        let grid = RadiusGrid::new(distribution);
        // Both ends are tried first, before the work begins: if they can be solved, all others can.
        spheres.sums(&[grid.node(0, 1), grid.node(1, 1)], &[])?;
        let [r, sigma] = forward_radius(&grid);
        let angles = forward_angles(spheres.wave_number * r, sigma);
        let cosines = cosines(&angles);

        let mut steps = FIRST_STEPS;
        let mut sums = spheres.parallel_sums(&nodes(&grid, steps, 1), &cosines)?;
        let mut average = Self { change: [f64::INFINITY; 2], ..Self::from_sums(&sums, wavelength, &angles) };
        loop {
            steps *= 2;
            // The radii of the coarser grid are every other one of the finer, where each stands for half as many.
            let between = spheres.parallel_sums(&nodes(&grid, steps, 2), &cosines)?;
            sums = sums.times(0.5);
            sums.add(&between);
            let finer = Self::from_sums(&sums, wavelength, &angles);
            let change = finer.change_from(&average);
            // A resonance that two grids miss, or hit, alike makes one change small by chance.
            let efficiency = change[0].max(0.5 * average.change[0]);
            average = Self { change, ..finer };
            let is_enough = efficiency < ENOUGH[0] && change[1] < ENOUGH[1];
            if is_enough || 4.0 * sums.terms * cosines.len() as f64 > MOST_TERMS {
                return Ok(average.refined());
            }
        }
    }

    /// Single-scattering albedo.
    pub fn albedo(&self) -> f64 {
        self.q_sca / self.q_ext
    }

    /// Mean extinction cross section, µm².
    pub fn c_ext(&self) -> f64 {
        self.q_ext * self.area
    }

    /// The phase function, to be sampled.
    pub fn phase_function(&self) -> Result<PhaseFunction, MieError> {
        Ok(PhaseFunction::Tabulated(Arc::new(TabulatedPhase::from_cosines(&self.rows())?)))
    }

    /// Rows of cos θ, from 1 to −1, and the phase function there, as tables of phase functions take them.
    pub fn rows(&self) -> Vec<(f64, f64)> {
        let mut rows: Vec<(f64, f64)> =
            self.angles.iter().map(|a| libm::cos(*a)).zip(self.values.iter().copied()).collect();
        // Angles so close that their cosines are the same number.
        rows.dedup_by_key(|row| row.0);
        rows
    }

    /// From sums at `angles` in the forward half, and at those opposite.
    fn from_sums(sums: &Sums, wavelength: f64, angles: &[f64]) -> Self {
        let [forward, backward] = &sums.differential;
        // 90° is in both halves.
        let backward = angles.iter().zip(backward).rev().skip(1);
        let [q_sca, q_abs] = [sums.scattering, sums.absorption].map(|c| c / sums.area);
        Self {
            wavelength,
            q_ext: q_sca + q_abs,
            q_sca,
            q_abs,
            g: sums.forward / sums.scattering,
            area: sums.area / sums.number,
            volume: sums.volume / sums.number,
            angles: angles.iter().copied().chain(backward.clone().map(|(angle, _)| PI - angle)).collect(),
            values: forward
                .iter()
                .chain(backward.map(|(_, value)| value))
                .map(|v| v / sums.scattering)
                .collect(),
            change: [0.0; 2],
        }
    }

    fn refined(self) -> Self {
        let (angles, values) = refined(&self.angles, &self.values);
        Self { angles, values, ..self }
    }

    fn change_from(&self, coarser: &Self) -> [f64; 2] {
        let relative = |a: f64, b: f64| ((a - b) / a).abs();
        let efficiencies = relative(self.q_ext, coarser.q_ext)
            .max(relative(self.q_sca, coarser.q_sca))
            .max((self.g - coarser.g).abs());
        let pairs = self.values.iter().zip(&coarser.values);
        [efficiencies, pairs.map(|(a, b)| relative(*a, *b)).fold(0.0, f64::max)]
    }
}

fn cosines(angles: &[f64]) -> Vec<f64> {
    angles.iter().map(|angle| libm::cos(*angle)).collect()
}

/// All radii of a grid, or, with a `stride` of 2, those that are not in a grid of half as many steps.
fn nodes(grid: &RadiusGrid, steps: usize, stride: usize) -> Vec<(f64, f64)> {
    (stride - 1..=steps).step_by(stride).map(|i| grid.node(i, steps)).collect()
}

/// Mean and relative deviation of the radii that make the forward peak, by their weight r⁴.
fn forward_radius(grid: &RadiusGrid) -> [f64; 2] {
    let mut moments = [0.0; 3];
    for (r, number) in nodes(grid, 256, 1) {
        for (power, moment) in moments.iter_mut().enumerate() {
            *moment += number * r.powi(4 + power as i32);
        }
    }
    let r = moments[1] / moments[0];
    let variance = moments[2] / moments[0] - r * r;
    [r, (variance.max(0.0).sqrt() / r).max(1e-9)]
}
