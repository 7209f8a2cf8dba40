//! Every unbiased transmittance estimator has exp(−τ) as its mean, under every kind of bound that it is made for.

use tyndall_scene::Scene;
use tyndall_transport::along_ray::{AlongRay, Bounding, Control, Profile};
use tyndall_transport::{
    Lookups, MajorantUse, TransmittanceEstimator, estimate_transmittance, repeat_transmittance,
};

use super::effort;
use super::rays::{Tabulated, WHOLE, along, profiles, scenes};
use crate::fresh;
use crate::statistics::{confirmed, kolmogorov_smirnov, normal_cdf, two_sided_quantile};

/// Cell by cell, over the whole ray and loose, and with a majorant that is none where the estimator stands it.
fn boundings(majorant: MajorantUse) -> Vec<Bounding> {
    let mut all = vec![
        Bounding::default(),
        Bounding { majorant_scale: 1.6, ..WHOLE },
        Bounding { control: Control::Middle, control_scale: 0.7, ..Bounding::default() },
    ];
    if majorant == MajorantUse::NonBounding {
        all.push(Bounding { majorant_scale: 0.7, ..Bounding::default() });
        all.push(Bounding { control: Control::Middle, control_scale: 1.3, ..Bounding::default() });
    }
    all
}

/// Rays of all kinds, with the truth.
fn rays<'a>(scenes: &'a [(&'static str, Scene)]) -> Vec<(&'static str, AlongRay<'a>, f64)> {
    let mut rays = Vec::new();
    for (profile, length) in profiles() {
        let ray = AlongRay::with_profile(profile.clone(), length, 5);
        let tau = profile.thickness(0.0, length);
        if tau < 5.0 {
            rays.push(("a profile", ray, (-tau).exp()));
        }
    }
    for (name, scene) in scenes {
        let mut random = fresh::random(3, 0, 0);
        for _ in 0..6 {
            let (_, ray) = along(scene, &mut random);
            let tau = Tabulated::new(&ray, 40_000).whole();
            rays.push((name, ray, (-tau).exp()));
        }
    }
    rays
}

/// Each mean within its error, and all of an estimator together following the normal law; at a level of 1e-3 for each
/// estimator.
#[test]
fn every_unbiased_estimator_has_the_transmittance_as_its_mean() {
    let scenes = scenes();
    let rays = rays(&scenes);
    let mut failures = Vec::new();
    for estimator in TransmittanceEstimator::ALL {
        let properties = estimator.properties();
        if !properties.unbiased {
            continue;
        }
        let mut scores = Vec::new();
        for bounding in boundings(properties.majorant) {
            for (name, ray, truth) in &rays {
                let ray = ray.clone().with_bounding(bounding);
                if estimator.check(&ray).is_err() {
                    continue;
                }
                let own = scores.len() as u64;
                let repeat = |times, seed| {
                    let samples = 2000 * times * effort();
                    repeat_transmittance(estimator, &ray, samples, fresh::seed(own + seed))
                };
                let found = repeat(1, 0);
                if found.variance < 1e-18 {
                    // To the error of the quadrature, which is that of steps for voxels without a filter.
                    assert!(
                        (found.mean - truth).abs() < 1e-4,
                        "{} in {name}: {found:?}, not {truth}",
                        estimator.name()
                    );
                    continue;
                }
                let found = confirmed(found, |found| [found.z(*truth)], repeat);
                let z = found.z(*truth);
                if z.abs() > two_sided_quantile(2e-6) {
                    failures.push(format!(
                        "{} in {name} under {bounding:?}: {found:?}, not {truth}, z = {z}",
                        estimator.name()
                    ));
                }
                scores.push(z);
            }
        }
        let p = if scores.is_empty() { 1.0 } else { kolmogorov_smirnov(&scores, normal_cdf) };
        eprintln!("{}: {} z scores, p = {p:.3}", estimator.name(), scores.len());
        if p < 5e-4 {
            failures.push(format!("{}: p = {p} of {scores:?}", estimator.name()));
        }
    }
    assert!(failures.is_empty(), "{}", failures.join("\n"));
}

/// In a thin medium all but the first term of the p-series is drawn by roulette. At a level of 1e-3.
#[test]
fn the_roulette_of_the_p_series_makes_up_for_what_it_cuts() {
    let loose = Bounding { majorant_scale: 2.0, ..WHOLE };
    let ray = AlongRay::with_profile(Profile::Constant(0.005), 1.0, 1).with_bounding(loose);
    let found = repeat_transmittance(TransmittanceEstimator::PSeriesCmf, &ray, 200_000, fresh::seed(6));
    let z = found.z(f64::exp(-0.005));
    assert!(z.abs() < two_sided_quantile(1e-3), "{found:?}, z = {z}");
    assert!(found.lookups < 0.02, "{found:?}");
}

#[test]
fn the_default_takes_the_closed_form_where_there_is_one_and_else_ratio_tracking() {
    for (name, scene) in scenes() {
        let (ray, _) = along(&scene, &mut fresh::random(4, 0, 0));
        for volume in &scene.volumes {
            let alone = std::slice::from_ref(volume);
            let Some(along) = AlongRay::through(alone, &ray, 8.0) else { continue };
            let is_grid = matches!(volume.density, tyndall_scene::Density::Grid(_));
            let estimator = if is_grid {
                TransmittanceEstimator::RatioTrackingRoulette
            } else {
                TransmittanceEstimator::ClosedForm
            };
            let [mut a, mut b] = [fresh::random(5, 0, 0); 2];
            let default = estimate_transmittance(volume, &ray, (0.0, 8.0), &mut a);
            assert_eq!(default, estimator.estimate(&along, &mut b, &mut Lookups::default()), "{name}");
        }
    }
}

#[test]
fn names_lead_back_to_estimators_and_what_does_not_fit_is_refused_with_a_reason() {
    for estimator in TransmittanceEstimator::ALL {
        assert_eq!(TransmittanceEstimator::from_name(estimator.name()), Some(estimator));
    }
    for sampler in tyndall_transport::DistanceSampler::ALL {
        assert_eq!(tyndall_transport::DistanceSampler::from_name(sampler.name()), Some(sampler));
    }
    let (_, scene) = scenes().remove(0);
    let (_, ray) = along(&scene, &mut fresh::random(4, 0, 0));
    let reason = TransmittanceEstimator::ClosedForm.check(&ray).unwrap_err().to_string();
    assert!(reason.contains("regular-tracking"), "{reason}");
    let loose = ray.with_bounding(Bounding { majorant_scale: 0.9, ..Bounding::default() });
    let reason = TransmittanceEstimator::DeltaTracking.check(&loose).unwrap_err().to_string();
    assert!(reason.contains("majorant"), "{reason}");
    assert!(TransmittanceEstimator::RatioTracking.check(&loose).is_ok());
}
