//! Chi-squared tests: directions drawn from each phase function, counted in cells of the sphere, against the integral
//! of its value over the cells. Azimuth is tested with the cosine.

use glam::DVec3;
use std::f64::consts::TAU;
use tyndall_lanes::Random;
use tyndall_optics::PhaseFunction;

use super::chi_squared::{chi_squared_z, is_full, upper_quantile};
use super::quadrature::{integrate, kinds, sggx_kinds};

const AZIMUTHS: usize = 8;

/// Chance of a false alarm in all tests of this file together.
const LEVEL: f64 = 1e-3;

/// Samples for each phase function; `TYNDALL_PROOF=full` takes thirty times as many.
fn samples() -> usize {
    if is_full() { 3_000_000 } else { 100_000 }
}

/// A frame about `before`: cells are counted in cos θ and the azimuth in it.
struct Frame {
    before: DVec3,
    across: [DVec3; 2],
}

impl Frame {
    fn new(before: DVec3) -> Frame {
        let (a, b) = before.any_orthonormal_pair();
        Frame { before, across: [a, b] }
    }

    fn direction(&self, cos: f64, phi: f64) -> DVec3 {
        let sin = ((1.0 - cos) * (1.0 + cos)).sqrt();
        self.before * cos + self.across[0] * (sin * phi.cos()) + self.across[1] * (sin * phi.sin())
    }

    /// Number of the cell that `after` is in, among `AZIMUTHS` for each interval between increasing `cosines`.
    fn cell(&self, cosines: &[f64], after: DVec3) -> usize {
        let cos = after.dot(self.before).clamp(-1.0, 1.0);
        let ring = cosines.partition_point(|bound| *bound <= cos).clamp(1, cosines.len() - 1) - 1;
        let turn = after.dot(self.across[1]).atan2(after.dot(self.across[0])) / TAU;
        let azimuth = (turn.rem_euclid(1.0) * AZIMUTHS as f64) as usize;
        ring * AZIMUTHS + azimuth.min(AZIMUTHS - 1)
    }
}

fn counts(phase: &PhaseFunction, frame: &Frame, cosines: &[f64], seed: u64) -> Vec<usize> {
    let mut random = Random::new(seed, 0, 0);
    let mut counts = vec![0; (cosines.len() - 1) * AZIMUTHS];
    for _ in 0..samples() {
        let after = phase.sample(frame.before, [random.f64(), random.f64()]);
        counts[frame.cell(cosines, after)] += 1;
    }
    counts
}

/// Rings of about the same probability: bounds at sampled quantiles, which need not be exact.
fn rings(phase: &PhaseFunction, n: usize) -> Vec<f64> {
    let mut bounds: Vec<f64> = (1..n).map(|i| phase.sample_cosine(i as f64 / n as f64)).collect();
    // A mixture's quantiles come in two runs, and may come twice.
    bounds.extend([-1.0, 1.0]);
    bounds.sort_by(f64::total_cmp);
    bounds.dedup_by(|a, b| *a - *b < 1e-9);
    bounds
}

#[test]
fn samples_fill_the_sphere_as_their_density_says() {
    let tests = kinds().len() + 4 * sggx_kinds().len();
    let critical = upper_quantile(LEVEL / tests as f64);
    for (number, phase) in kinds().iter().enumerate() {
        let frame = Frame::new(DVec3::new(0.48, -0.6, 0.64));
        let cosines = rings(phase, 24);
        let expected: Vec<f64> = cosines
            .windows(2)
            .flat_map(|ring| {
                let probability = integrate(phase, ring[0], ring[1], |_| 1.0) / AZIMUTHS as f64;
                [probability * samples() as f64; AZIMUTHS]
            })
            .collect();
        let z = chi_squared_z(&counts(phase, &frame, &cosines, number as u64), &expected);
        assert!(z < critical, "{phase:?}: z = {z}");
    }
}

/// The density over cells of cos θ and azimuth by a product of midpoint rules, fine enough beside the noise of the
/// counts.
#[test]
fn sggx_samples_fill_the_sphere_as_their_density_says() {
    let tests = kinds().len() + 4 * sggx_kinds().len();
    let critical = upper_quantile(LEVEL / tests as f64);
    const RINGS: usize = 16;
    const STEPS: usize = 60;
    let cosines: Vec<f64> = (0..=RINGS).map(|i| -1.0 + 2.0 * i as f64 / RINGS as f64).collect();
    for (number, phase) in sggx_kinds().iter().enumerate() {
        for before in [DVec3::X, DVec3::NEG_Z, DVec3::new(0.48, -0.6, 0.64), DVec3::new(0.0, 0.8, 0.6)] {
            let frame = Frame::new(before);
            let mut expected = vec![0.0; RINGS * AZIMUTHS];
            let solid_angle = 2.0 / (RINGS * STEPS) as f64 * TAU / (AZIMUTHS * STEPS) as f64;
            for i in 0..RINGS * STEPS {
                let cos = -1.0 + 2.0 * (i as f64 + 0.5) / (RINGS * STEPS) as f64;
                for j in 0..AZIMUTHS * STEPS {
                    let phi = TAU * (j as f64 + 0.5) / (AZIMUTHS * STEPS) as f64;
                    let value = phase.value(before, frame.direction(cos, phi));
                    expected[i / STEPS * AZIMUTHS + j / STEPS] += value * solid_angle * samples() as f64;
                }
            }
            let total: f64 = expected.iter().sum();
            assert!((total / samples() as f64 - 1.0).abs() < 1e-3, "{phase:?} from {before}: {total}");
            let z = chi_squared_z(&counts(phase, &frame, &cosines, 1000 + number as u64), &expected);
            assert!(z < critical, "{phase:?} from {before}: z = {z}");
        }
    }
}

/// The test itself: samples of a neighbouring phase function do not pass.
#[test]
fn the_chi_squared_test_tells_a_phase_function_from_its_neighbour() {
    let phase = PhaseFunction::HenyeyGreenstein { g: 0.85 };
    let frame = Frame::new(DVec3::X);
    let cosines = rings(&phase, 24);
    let expected = vec![samples() as f64 / (24 * AZIMUTHS) as f64; 24 * AZIMUTHS];
    let z = |g| {
        let counted = counts(&PhaseFunction::HenyeyGreenstein { g }, &frame, &cosines, 5);
        chi_squared_z(&counted, &expected)
    };
    assert!(z(0.85) < 3.0 && z(0.84) > 10.0, "{} {}", z(0.85), z(0.84));
}
