//! Energy: no surface sends out more light than it receives, and those that absorb nothing send out all.

use glam::{DVec3, DVec4};
use tyndall_lanes::Random;
use tyndall_optics::bsdf::{Bsdf, Coat, Plastic, RoughDiffuse, fresnel};

use super::chi_squared::{is_full, upper_quantile};
use super::kinds::{
    ORANGE, WHITE, direction, directions, glass, mirror, mirrors, plastic, scattering, sheet,
};

/// Chance of a false alarm in all tests of this file together.
const LEVEL: f64 = 1e-3;

/// Comparisons in this file, at most.
const TESTS: f64 = 1000.0;

/// Mean and standard error of what is sent towards `wo` under light of radiance 1 from everywhere, radiance over the
/// squared index.
fn furnace(bsdf: &Bsdf, wo: DVec3, seed: u64) -> (DVec4, DVec4) {
    let n = if is_full() { 400_000 } else { 20_000 };
    let mut random = Random::new(seed, 0, 0);
    let (mut sum, mut squares) = (DVec4::ZERO, DVec4::ZERO);
    for _ in 0..n {
        let sample = bsdf.sample(wo, random.f64(), [random.f64(), random.f64()]);
        let weight = sample.map_or(DVec4::ZERO, |sample| sample.weight / sample.radiance_scale);
        sum += weight;
        squares += weight * weight;
    }
    let n = f64::from(n);
    let mean = sum / n;
    let variance = ((squares / n - mean * mean) / n).max(DVec4::ZERO);
    (mean, variance.map(f64::sqrt))
}

#[test]
fn no_surface_sends_out_more_than_it_receives() {
    let critical = upper_quantile(LEVEL / TESTS);
    for (kind, bsdf) in scattering().iter().chain(&mirrors()).enumerate() {
        for wo in directions() {
            let (mean, error) = furnace(bsdf, wo, kind as u64);
            let excess = mean - DVec4::ONE - error * critical;
            assert!(excess.max_element() < 1e-12, "{bsdf:?} from {wo}: {mean} ± {error}");
        }
    }
}

/// Of these every single sample has weight 1, tints and masks apart.
#[test]
fn what_absorbs_nothing_sends_out_all_light() {
    let mut random = Random::new(3, 0, 0);
    for bsdf in [
        Bsdf::Diffuse { reflectance: WHITE },
        mirror([0.0, 0.0]),
        glass(1.5, [0.0, 0.0]),
        glass(0.7, [0.0, 0.0]),
        sheet(1.5),
    ] {
        for wo in directions() {
            for _ in 0..50 {
                let sample =
                    bsdf.sample(wo, random.f64(), [random.f64(), random.f64()]).expect("nothing is lost");
                let weight = sample.weight / sample.radiance_scale;
                assert!((weight - WHITE).abs().max_element() < 1e-5, "{bsdf:?} from {wo}: {weight}");
            }
        }
    }
}

/// Facets that hide each other lose light, but none gains any: G2 ≤ G1.
#[test]
fn microfacets_only_lose() {
    let mut random = Random::new(4, 0, 0);
    for bsdf in [mirror([0.2, 0.2]), mirror([0.1, 0.9]), glass(1.5, [0.3, 0.3]), glass(0.7, [0.9, 0.2])] {
        for wo in directions() {
            for _ in 0..500 {
                let sample = bsdf.sample(wo, random.f64(), [random.f64(), random.f64()]);
                let Some(sample) = sample else { continue };
                let weight = (sample.weight / sample.radiance_scale).max_element();
                assert!(weight <= 1.0 + 1e-6, "{bsdf:?} from {wo}: {weight}");
            }
        }
    }
    // Fine ones lose next to nothing, and split light as a smooth face does.
    for wo in [direction(0.9, 0.0), direction(0.5, 1.0), direction(-0.9, 1.0)] {
        let bsdf = glass(1.5, [0.005, 0.005]);
        let eta = if wo.z > 0.0 { 1.5 } else { 1.0 / 1.5 };
        let (mut up, n) = (0.0, 100_000);
        for k in 0..n {
            let choice = (f64::from(k) + 0.5) / f64::from(n);
            let sample = bsdf.sample(wo, choice, [random.f64(), random.f64()]);
            let Some(sample) = sample else { continue };
            up += if sample.wi.z * wo.z > 0.0 { sample.weight.x / f64::from(n) } else { 0.0 };
        }
        let expected = fresnel::dielectric(wo.z.abs(), eta).0;
        assert!((up - expected).abs() < 2e-4, "from {wo}: {up}, of a smooth face {expected}");
    }
}

/// A white base under a coat gives back all light, whatever the coat.
#[test]
fn white_plastic_is_white() {
    let critical = upper_quantile(LEVEL / TESTS);
    for nonlinear in [false, true] {
        for (index, alpha, tolerance) in [
            (1.5, [0.0, 0.0], 1e-6),
            (1.9, [0.0, 0.0], 1e-6),
            (1.5, [0.1, 0.1], 2e-3),
            (1.5, [0.5, 0.5], 2e-3),
            (2.2, [0.3, 0.3], 2e-3),
        ] {
            for wo in directions() {
                let (mean, error) = furnace(&plastic(index, alpha, WHITE, nonlinear), wo, 11);
                let away = (mean.x - 1.0).abs() - critical * error.x;
                assert!(away < tolerance, "{index} {alpha:?} from {wo}: {} ± {}", mean.x, error.x);
            }
        }
    }
}

/// R + T T̄/η² ρ/(1 − ρ r), T̄ from a quadrature of Fresnel's equations.
#[test]
fn smooth_plastic_has_the_albedo_of_its_series() {
    let critical = upper_quantile(LEVEL / TESTS);
    let index = 1.5;
    let n = 100_000;
    let mean_transmittance: f64 = (0..n)
        .map(|k| (f64::from(k) + 0.5) / f64::from(n))
        .map(|cos| 2.0 * cos * (1.0 - fresnel::dielectric(cos, index).0) / f64::from(n))
        .sum();
    // Published: 59.6 % of diffuse light in glass is thrown back by its surface (e.g. Egan & Hilgeman 1979).
    let thrown_back = 1.0 - mean_transmittance / (index * index);
    assert!((thrown_back - 0.5964).abs() < 2e-4, "{thrown_back}");
    for (nonlinear, reflectance) in [(true, 0.5), (false, 0.5), (true, 0.9)] {
        let bsdf = plastic(index, [0.0, 0.0], WHITE * reflectance, nonlinear);
        for wo in directions() {
            let (reflected, _) = fresnel::dielectric(wo.z.abs(), index);
            let each_time = if nonlinear { reflectance } else { 1.0 };
            let base = reflectance / (1.0 - each_time * thrown_back) * mean_transmittance / (index * index);
            let expected = reflected + (1.0 - reflected) * base;
            let (mean, error) = furnace(&bsdf, wo, 13);
            let away = (mean.x - expected).abs() - critical * error.x;
            assert!(away < 1e-6, "{reflectance} from {wo}: {} ± {}, not {expected}", mean.x, error.x);
        }
    }
}

/// The albedo of a rough matte surface, in closed form over the integral of the grooves' term.
#[test]
fn a_rough_matte_surface_reflects_at_most_its_reflectance() {
    for sigma in [0.0, 5.0, 11.0, 30.0, 60.0, 90.0] {
        let bsdf = Bsdf::RoughDiffuse(RoughDiffuse::new(WHITE, sigma));
        for cos in [1.0, 0.7, 0.3, 0.05, 1e-3] {
            let wo = direction(cos, 0.4);
            let n = 200;
            let mut albedo = 0.0;
            for i in 0..n * n {
                let u = [i / n, i % n].map(|k| (f64::from(k) + 0.5) / f64::from(n));
                albedo += bsdf.sample(wo, 0.5, u).map_or(0.0, |sample| sample.weight.x) / f64::from(n * n);
            }
            assert!(albedo < 1.0 + 1e-4, "{sigma} {cos}: {albedo}");
            if sigma == 0.0 {
                assert!((albedo - 1.0).abs() < 1e-9);
            }
        }
    }
}

/// The layer of albedos shows about what a furnace does.
#[test]
fn the_albedo_is_about_the_light_that_comes_back() {
    for bsdf in [
        Bsdf::Diffuse { reflectance: ORANGE },
        super::kinds::copper([0.1, 0.1]),
        glass(1.5, [0.0, 0.0]),
        sheet(1.5),
        Bsdf::Plastic(Plastic::new(Coat::new(1.5, [0.2, 0.2]), ORANGE, WHITE, true)),
    ] {
        let (mean, _) = furnace(&bsdf, direction(0.95, 0.0), 17);
        assert!((bsdf.albedo() - mean).abs().max_element() < 0.03, "{bsdf:?}: {} {mean}", bsdf.albedo());
    }
}
