//! Laws that hold whatever the surface is made of: reciprocity, Snell's law, the normalisation of microfacets.

use std::f64::consts::TAU;

use glam::{DVec3, DVec4};
use tyndall_lanes::Random;
use tyndall_optics::bsdf::{Bsdf, Ggx};

use super::kinds::{copper, direction, directions, glass, scattering, sheet};

/// f(ω, ω′) = f(ω′, ω) for reflection; for refraction n(ω′)² f(ω, ω′) = n(ω)² f(ω′, ω).
#[test]
fn surfaces_are_reciprocal() {
    let mut random = Random::new(7, 0, 0);
    let mut sphere = || direction(2.0 * random.f64() - 1.0, TAU * random.f64());
    let mut refracted = 0;
    for bsdf in scattering() {
        for _ in 0..2_000 {
            let (wo, wi) = (sphere(), sphere());
            let forth = bsdf.value(wo, wi) / wi.z.abs();
            let back = bsdf.value(wi, wo) / wo.z.abs();
            let scale = if wo.z * wi.z < 0.0 { squared_ratio(&bsdf, wo) } else { 1.0 };
            let error = (forth * scale - back).abs().max_element();
            assert!(error <= 1e-9 * back.max_element(), "{bsdf:?} {wo} {wi}: {forth} {back}");
            refracted += usize::from(wo.z * wi.z < 0.0 && forth.max_element() > 0.0);
        }
    }
    assert!(refracted > 1_000, "{refracted} pairs were refracted");
}

/// (n(ω′)/n(ω))² of the one dielectric in it, from the side of `wo`.
fn squared_ratio(bsdf: &Bsdf, wo: DVec3) -> f64 {
    match bsdf {
        Bsdf::Dielectric(glass) => {
            if wo.z > 0.0 {
                glass.index.powi(2)
            } else {
                glass.index.powi(-2)
            }
        }
        Bsdf::Mix(mix) => squared_ratio(&mix.parts[0], wo),
        _ => 1.0,
    }
}

#[test]
fn smooth_glass_obeys_snells_law() {
    let mut seen = [false; 3];
    for index in [1.5, 1.0 / 1.5, 1.33] {
        let bsdf = glass(index, [0.0, 0.0]);
        for wo in directions() {
            let eta = if wo.z > 0.0 { index } else { 1.0 / index };
            for choice in [0.0, 0.999_999] {
                let sample = bsdf.sample(wo, choice, [0.3, 0.6]).expect("glass loses nothing");
                let wi = sample.wi;
                if wi.z * wo.z > 0.0 {
                    assert!((wi - DVec3::new(-wo.x, -wo.y, wo.z)).length() < 1e-12);
                    assert_eq!(sample.radiance_scale, 1.0);
                    seen[usize::from(choice > 0.5)] = true;
                } else {
                    // In the same plane, and the sines in the ratio of the indices.
                    assert!((wi.x * eta + wo.x).abs() < 1e-12 && (wi.y * eta + wo.y).abs() < 1e-12);
                    assert!((sample.radiance_scale - 1.0 / (eta * eta)).abs() < 1e-12);
                    seen[2] = true;
                }
            }
        }
    }
    // Partial reflection, total reflection, refraction.
    assert_eq!(seen, [true; 3]);
}

/// Light that passes a pane, or water and back, is scaled by what is lost alone.
#[test]
fn radiance_is_as_it_was_after_going_in_and_out() {
    for index in [1.5, 0.8] {
        let glass = glass(index, [0.0, 0.0]);
        let inward = glass.sample(direction(0.9, 0.0), 0.999_999, [0.5; 2]).unwrap();
        let outward = glass.sample(-inward.wi * DVec3::new(1.0, 1.0, -1.0), 0.999_999, [0.5; 2]);
        let back =
            glass.sample(DVec3::new(inward.wi.x, inward.wi.y, inward.wi.z), 0.999_999, [0.5; 2]).unwrap();
        assert!(outward.is_some());
        assert!((inward.radiance_scale * back.radiance_scale - 1.0).abs() < 1e-12);
    }
}

/// 2R/(1 + R) against the sum over the reflections between the faces, term by term.
#[test]
fn a_sheet_adds_up_its_inner_reflections() {
    for (index, cos) in [(1.5_f64, 1.0_f64), (1.5, 0.4), (2.4, 0.1), (1.0, 0.5)] {
        let face = match glass(index, [0.0, 0.0]).sample(direction(cos, 0.0), 0.0, [0.5; 2]) {
            Some(_) => tyndall_optics::bsdf::fresnel::dielectric(cos, index).0,
            None => 0.0,
        };
        let (mut reflected, mut transmitted) = (face, 0.0);
        let mut inside = 1.0 - face;
        for _ in 0..2_000 {
            transmitted += inside * (1.0 - face);
            inside *= face;
            reflected += inside * (1.0 - face);
            inside *= face;
        }
        let (mut up, mut down) = (DVec4::ZERO, DVec4::ZERO);
        let n = 10_000;
        for k in 0..n {
            let choice = (f64::from(k) + 0.5) / f64::from(n);
            let sample = sheet(index).sample(direction(cos, 0.0), choice, [0.5; 2]).unwrap();
            *(if sample.wi.z > 0.0 { &mut up } else { &mut down }) += sample.weight / f64::from(n);
        }
        assert!((up.x - reflected).abs() < 1e-4 && (down.x - transmitted).abs() < 1e-4, "{index} {cos}");
        assert!((reflected + transmitted - 1.0).abs() < 1e-9);
    }
}

/// ∫ D(h) hz dω = 1, and ∫ D_ω(h) dω = 1 over the normals that face ω: the shadowing is that of the distribution
/// (Heitz 2014, eq. 43).
#[test]
fn microfacets_cover_the_surface() {
    for alpha in [[0.05, 0.05], [0.1, 0.6], [1.0, 1.0]] {
        let facets = Ggx::new(alpha).unwrap();
        let integral = |f: &dyn Fn(DVec3) -> f64| {
            // In slopes, stretched by α: ρ² = x/(1 − x), with x = 1 − y² against the far tail.
            let n = 800;
            let mut sum = 0.0;
            for i in 0..n {
                let y = (f64::from(i) + 0.5) / f64::from(n);
                let x = 1.0 - y * y;
                let rho = (x / (1.0 - x)).sqrt();
                for j in 0..n {
                    let phi = TAU * (f64::from(j) + 0.5) / f64::from(n);
                    let slope = DVec3::new(alpha[0] * rho * phi.cos(), alpha[1] * rho * phi.sin(), 1.0);
                    let h = slope.normalize();
                    let solid_angle = alpha[0] * alpha[1] * h.z.powi(3) / y.powi(3);
                    sum += f(h) * solid_angle * TAU / f64::from(n * n);
                }
            }
            sum
        };
        let covered = integral(&|h| facets.density(h) * h.z);
        assert!((covered - 1.0).abs() < 1e-6, "{alpha:?}: {covered}");
        for w in [direction(1.0, 0.0), direction(0.6, 0.9), direction(0.1, 2.0)] {
            let seen = integral(&|h| if w.dot(h) > 0.0 { facets.seen_density(w, h) } else { 0.0 });
            assert!((seen - 1.0).abs() < 1e-3, "{alpha:?} from {w}: {seen}");
        }
    }
}

/// Two lobes of a mixture: each is there with its share.
#[test]
fn a_mixture_has_the_mean_of_its_parts() {
    let (first, second) = (copper([0.3, 0.3]), Bsdf::Diffuse { reflectance: super::kinds::ORANGE });
    let amount = DVec4::new(0.2, 0.5, 1.0, 0.0);
    let mixed = super::kinds::mix(first.clone(), second.clone(), amount);
    let (wo, wi) = (direction(0.7, 0.2), direction(0.6, 3.0));
    let expected = first.value(wo, wi) * (super::kinds::WHITE - amount) + second.value(wo, wi) * amount;
    assert!((mixed.value(wo, wi) - expected).abs().max_element() < 1e-15);
}
