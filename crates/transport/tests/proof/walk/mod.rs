//! Forward walks against tables: layers, half-spaces, bodies, clouds.

mod bodies;
mod calibration;
mod clouds;
mod half_space;
mod infinite_medium;
mod phase_functions;
mod slab;
mod slab_radiance;

use std::sync::atomic::AtomicBool;

use glam::DVec3;
use tyndall_optics::PhaseFunction;
use tyndall_transport::walk::{Estimate, Goal, Incidence, LayerFluxes, Slab, WalkOptions};

use crate::effort::is_full;
use crate::fresh;
use crate::statistics::{kolmogorov_smirnov, normal_cdf, two_sided_quantile};

/// `photons`, or sixteen times as many if `TYNDALL_PROOF` is `full`.
pub fn photons(photons: u64) -> u64 {
    if is_full() { 16 * photons } else { photons }
}

/// So many photons on two threads.
pub fn options(seed: u64, samples: u64) -> WalkOptions {
    let goal = Goal { samples, error: None, time: None };
    WalkOptions { seed: fresh::seed(seed), stream: 0, threads: 2, goal }
}

/// Rows of numbers of a table; an absent one is NaN.
pub fn rows(text: &str, key: &str) -> Vec<Vec<f64>> {
    let table: serde_json::Value = serde_json::from_str(text).expect("the table is JSON");
    let rows = table[key].as_array().expect("the table has these rows");
    let row = |row: &serde_json::Value| -> Vec<f64> {
        row.as_array().expect("a row").iter().map(|x| x.as_f64().unwrap_or(f64::NAN)).collect()
    };
    rows.iter().map(row).collect()
}

/// A matched slab over black ground, lit along the normal.
pub fn slab(tau: f64, albedo: f64, phase_function: PhaseFunction) -> Slab {
    Slab {
        tau,
        albedo,
        phase_function,
        incidence: Incidence::Beam(DVec3::NEG_Y),
        refractive_index: 1.0,
        ground_albedo: 0.0,
        views: vec![],
    }
}

pub fn henyey_greenstein(g: f64) -> PhaseFunction {
    PhaseFunction::HenyeyGreenstein { g }
}

/// A beam whose cosine with the normal is `mu`.
pub fn beam(mu: f64) -> Incidence {
    Incidence::Beam(DVec3::new((1.0 - mu * mu).sqrt(), -mu, 0.0))
}

/// A direction of the cosine `mu` with the vertical, across to slanted beams.
pub fn view(mu: f64) -> DVec3 {
    DVec3::new(0.0, mu, (1.0 - mu * mu).sqrt())
}

pub fn measure(slab: &Slab, seed: u64, photons: u64) -> LayerFluxes {
    slab.measure(&options(seed, photons), &AtomicBool::new(false))
}

/// z scores of a family of independent results.
#[derive(Default)]
pub struct Family {
    z: Vec<f64>,
    names: Vec<String>,
}

impl Family {
    /// Takes a result whose true value is known within `tolerance`.
    pub fn add(&mut self, name: String, truth: f64, tolerance: f64, result: Estimate) {
        let error = result.standard_error.hypot(tolerance);
        let z = if result.mean == truth { 0.0 } else { (result.mean - truth) / error };
        self.names
            .push(format!("{name}: {} +- {}, not {truth}, z = {z}", result.mean, result.standard_error));
        self.z.push(z);
    }

    /// Takes a fraction of the light that `photons` carried. Of small ones that few photons have made the own spread is
    /// no guide, and they make no normal law; their error is that of a number of photons, which bring 1 each at most. So it is
    /// with those of which few photons are missing, which take 1 each at most.
    pub fn add_fraction(
        &mut self,
        name: String,
        truth: f64,
        result: Estimate,
        photons: u64,
        rare: &mut Family,
    ) {
        let n = photons as f64;
        if truth * n > 300.0 && (1.0 - truth) * n > 50.0 {
            return self.add(name, truth, 1e-6, result);
        }
        let few = truth.min(1.0 - truth).max(0.0);
        let error = result.standard_error.max((few / n).sqrt()).max(1.5 / n);
        rare.add(name, truth, 1e-6, Estimate { standard_error: error, ..result });
    }

    /// None is farther off than one of so many is once in a thousand families, and, if `is_normal` (the results are
    /// independent of each other), all of them follow the normal law at the level 1/1000.
    pub fn assert(&self, name: &str, is_normal: bool) {
        assert!(!self.z.is_empty(), "{name}: no results");
        let limit = two_sided_quantile(1e-3 / self.z.len() as f64);
        for (z, name) in self.z.iter().zip(&self.names) {
            assert!(z.abs() < limit, "{name}, limit {limit}");
        }
        if is_normal {
            let p = kolmogorov_smirnov(&self.z, normal_cdf);
            eprintln!("{name}: {} z scores, Kolmogorov-Smirnov p = {p}", self.z.len());
            assert!(p > 1e-3, "{name}: z scores do not follow the normal law: p = {p} {:?}", self.z);
        }
    }
}
