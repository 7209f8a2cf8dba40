//! Samplers against densities: directions drawn, counted in cells of the sphere, against the integral of the density over
//! the cells; what is no direction of a lobe (a mirror's, or absorbed) is a cell too.

use std::f64::consts::{PI, TAU};

use glam::DVec3;
use tyndall_lanes::Random;
use tyndall_optics::bsdf::Bsdf;

use super::chi_squared::{chi_squared_z, is_full, upper_quantile};
use super::kinds::{direction, directions, mirrors, scattering};

/// Chance of a false alarm in all tests of this file together.
const LEVEL: f64 = 1e-3;

const RINGS: usize = 24;
const SECTORS: usize = 16;

fn samples() -> usize {
    if is_full() { 400_000 } else { 40_000 }
}

/// Expected counts of all cells and of what is in none.
fn expected(bsdf: &Bsdf, wo: DVec3) -> Vec<f64> {
    let n = samples() as f64;
    let cells =
        (0..RINGS * SECTORS).map(|cell| expected_in_cell(bsdf, wo, cell / SECTORS, cell % SECTORS, n));
    let mut cells: Vec<f64> = cells.collect();
    let all: f64 = cells.iter().sum();
    assert!(all < n * (1.0 + 2e-3), "{bsdf:?} from {wo}: {}", all / n);
    cells.push((n - all).max(0.0));
    cells
}

/// By midpoint rules of more and more steps, until the next differs by less than a tenth of the noise of the counts.
fn expected_in_cell(bsdf: &Bsdf, wo: DVec3, ring: usize, sector: usize, n: f64) -> f64 {
    let with = |steps: usize| {
        let (height, width) = (PI / (RINGS * steps) as f64, TAU / (SECTORS * steps) as f64);
        let mut sum = 0.0;
        for i in 0..steps {
            let theta = height * ((ring * steps + i) as f64 + 0.5);
            for j in 0..steps {
                let wi = direction(theta.cos(), width * ((sector * steps + j) as f64 + 0.5));
                sum += bsdf.pdf(wo, wi) * theta.sin();
            }
        }
        // The difference of the cosines of a step's ends is 2 sin θ sin(height/2).
        sum * 2.0 * (0.5 * height).sin() * width * n
    };
    let mut steps = 16;
    let mut expected = with(steps);
    while steps < 300 {
        steps *= 2;
        let finer = with(steps);
        let is_enough = (finer - expected).abs() < 0.1 * finer.sqrt() + 1e-3;
        expected = finer;
        if is_enough {
            break;
        }
    }
    expected
}

fn counts(bsdf: &Bsdf, wo: DVec3, seed: u64) -> Vec<usize> {
    let mut random = Random::new(seed, 0, 0);
    let mut counts = vec![0; RINGS * SECTORS + 1];
    for _ in 0..samples() {
        let sample = bsdf.sample(wo, random.f64(), [random.f64(), random.f64()]);
        let cell = match sample {
            Some(sample) if !sample.is_delta => cell(sample.wi),
            _ => RINGS * SECTORS,
        };
        counts[cell] += 1;
    }
    counts
}

fn cell(wi: DVec3) -> usize {
    let ring = (wi.z.clamp(-1.0, 1.0).acos() / PI * RINGS as f64) as usize;
    let sector = ((wi.y.atan2(wi.x) / TAU).rem_euclid(1.0) * SECTORS as f64) as usize;
    ring.min(RINGS - 1) * SECTORS + sector.min(SECTORS - 1)
}

#[test]
fn samples_fill_the_sphere_as_their_density_says() {
    let critical = upper_quantile(LEVEL / (scattering().len() * directions().len()) as f64);
    for (kind, bsdf) in scattering().iter().enumerate() {
        for (number, wo) in directions().into_iter().enumerate() {
            let seed = (100 * kind + number) as u64;
            let z = chi_squared_z(&counts(bsdf, wo, seed), &expected(bsdf, wo));
            assert!(z < critical, "{bsdf:?} from {wo}: z = {z}");
        }
    }
}

/// The test itself: a density of a neighbouring roughness does not pass.
#[test]
fn the_chi_squared_test_tells_a_surface_from_its_neighbour() {
    let wo = direction(0.8, 2.0);
    let z = |alpha: f64| {
        let counted = counts(&super::kinds::glass(1.5, [alpha; 2]), wo, 5);
        chi_squared_z(&counted, &expected(&super::kinds::glass(1.5, [0.3; 2]), wo))
    };
    assert!(z(0.3) < 3.5 && z(0.33) > 8.0, "{} {}", z(0.3), z(0.33));
}

#[test]
fn weights_are_value_over_density() {
    let mut random = Random::new(1, 0, 0);
    for bsdf in scattering() {
        for wo in directions() {
            for _ in 0..500 {
                let Some(sample) = bsdf.sample(wo, random.f64(), [random.f64(), random.f64()]) else {
                    continue;
                };
                assert!((sample.wi.length() - 1.0).abs() < 1e-9 && sample.weight.w == 0.0, "{bsdf:?}");
                assert!(sample.weight.min_element() >= 0.0, "{bsdf:?}");
                if sample.is_delta {
                    assert_eq!(sample.pdf, 0.0);
                    continue;
                }
                let (pdf, value) = (bsdf.pdf(wo, sample.wi), bsdf.value(wo, sample.wi));
                assert!((sample.pdf / pdf - 1.0).abs() < 1e-6, "{bsdf:?} {wo}: {} {pdf}", sample.pdf);
                let error = (sample.weight * pdf - value).abs().max_element();
                assert!(error < 1e-6 * value.max_element() + 1e-12, "{bsdf:?} {wo} {}: {error}", sample.wi);
            }
        }
    }
}

#[test]
fn mirrors_have_neither_value_nor_density() {
    let mut random = Random::new(2, 0, 0);
    for bsdf in mirrors() {
        assert!(bsdf.is_delta());
        for wo in directions() {
            for _ in 0..100 {
                let Some(sample) = bsdf.sample(wo, random.f64(), [random.f64(), random.f64()]) else {
                    continue;
                };
                assert!(sample.is_delta && sample.pdf == 0.0, "{bsdf:?}");
                let (value, pdf) = (bsdf.value(wo, sample.wi), bsdf.pdf(wo, sample.wi));
                assert!(value.max_element() == 0.0 && pdf == 0.0, "{bsdf:?}");
            }
        }
    }
    assert!(scattering().iter().all(|bsdf| !bsdf.is_delta()));
}

/// Whatever direction and random numbers, nothing that is no number comes out.
#[test]
fn extreme_directions_and_numbers_give_finite_values() {
    let edges = [0.0, 1e-300, 0.5, 1.0 - f64::EPSILON / 2.0];
    let mut grazing = directions();
    for cos in [0.0, -0.0, 1e-300, 1e-17, -1e-17, 1e-9, -1e-9, 1.0, -1.0] {
        grazing.push(direction(cos, 0.3));
    }
    for bsdf in scattering().iter().chain(&mirrors()) {
        for &wo in &grazing {
            for choice in edges {
                for u in edges {
                    for v in edges {
                        let Some(sample) = bsdf.sample(wo, choice, [u, v]) else { continue };
                        assert!(
                            sample.weight.is_finite() && sample.pdf.is_finite(),
                            "{bsdf:?} {wo}: {sample:?}"
                        );
                        assert!((sample.wi.length() - 1.0).abs() < 1e-6, "{bsdf:?} {wo}: {sample:?}");
                    }
                }
            }
            for &wi in &grazing {
                let (value, pdf) = (bsdf.value(wo, wi), bsdf.pdf(wo, wi));
                assert!(value.is_finite() && value.min_element() >= 0.0, "{bsdf:?} {wo} {wi}: {value}");
                assert!(pdf.is_finite() && pdf >= 0.0, "{bsdf:?} {wo} {wi}: {pdf}");
            }
        }
    }
}
