//! Every unbiased distance sampler: its weighted collisions against ∫ μt T f, its escapes against T, and the law of those
//! whose weights are 1.

use glam::DVec3;
use serde_json::Value;
use tyndall_transport::along_ray::{AlongRay, Bounding, Control, LightBeside};
use tyndall_transport::distance::ChromaticFlight;
use tyndall_transport::{DistanceSampler, Flight, Lookups, MajorantUse, Repeated, repeat_distance};

use super::effort;
use super::rays::{Tabulated, along, profiles, rows, scenes, table};
use crate::fresh;
use crate::statistics::{confirmed, kolmogorov_smirnov, normal_cdf, two_sided_quantile};

const SAMPLES: u64 = 4000;

/// A light beside the middle of the ray, so that equiangular sampling has one.
fn lit<'a>(ray: AlongRay<'a>) -> AlongRay<'a> {
    let nearest = 0.4 * ray.start() + 0.6 * ray.end();
    let distance = 0.2 * (ray.end() - ray.start());
    ray.with_light(LightBeside { nearest, distance })
}

fn boundings(sampler: DistanceSampler) -> Vec<Bounding> {
    let cells = Bounding::default();
    let mut all = vec![cells, Bounding { control_scale: 0.6, majorant_scale: 1.3, ..cells }];
    if sampler.properties().majorant == MajorantUse::None {
        all.truncate(1);
    }
    if sampler.properties().majorant == MajorantUse::NonBounding {
        all.push(Bounding { majorant_scale: 0.8, ..cells });
        all.push(Bounding { control: Control::Middle, ..cells });
    }
    all
}

/// One of four z scores: of E[weight·f(t)] for one of three f, or of E[escape].
fn moment_score(sampler: DistanceSampler, ray: &AlongRay, truth: &Tabulated, seed: u64) -> Option<f64> {
    let (start, length) = (ray.start(), ray.end() - ray.start());
    let functions: [fn(f64) -> f64; 3] = [|_| 1.0, |x| x, |x| (9.0 * x).sin()];
    let f = functions.get(seed as usize % 4).map(|f| move |t: f64| f((t - start) / length));
    let score = |flight: &Flight| match (&f, flight.t) {
        (Some(f), t) => t.map_or(0.0, |t| flight.weight * f(t)),
        (None, _) => flight.escape,
    };
    let found = repeat_distance(sampler, ray, SAMPLES * effort(), fresh::seed(seed), score);
    let truth = f.map_or((-truth.whole()).exp(), |f| truth.collisions(f));
    if found.variance < 1e-18 {
        assert!((found.mean - truth).abs() < 1e-4, "{}: {found:?}, not {truth}", sampler.name());
        return None;
    }
    let z = found.z(truth);
    assert!(z.abs() < two_sided_quantile(2e-6), "{}: {found:?}, not {truth}, z = {z}", sampler.name());
    Some(z)
}

/// At a level of 1e-3 for each sampler.
#[test]
fn weighted_collisions_of_every_unbiased_sampler_integrate_mu_t_times_t() {
    let scenes = scenes();
    // Of what hardly ever escapes there are too few for a normal law.
    let profiles = profiles().into_iter().filter(|(profile, length)| profile.thickness(0.0, *length) < 5.0);
    let mut rays: Vec<AlongRay> =
        profiles.map(|(profile, length)| lit(AlongRay::with_profile(profile, length, 5))).collect();
    for (_, scene) in &scenes {
        let mut random = fresh::random(13, 0, 0);
        rays.extend((0..6).map(|_| lit(along(scene, &mut random).1)));
    }
    let truths: Vec<Tabulated> = rays.iter().map(|ray| Tabulated::new(ray, 40_000)).collect();
    for sampler in DistanceSampler::ALL.into_iter().filter(|sampler| sampler.properties().unbiased) {
        let mut scores = Vec::new();
        let mut seed = 0;
        for bounding in boundings(sampler) {
            for (ray, truth) in rays.iter().zip(&truths) {
                let ray = ray.clone().with_bounding(bounding);
                seed += 1;
                if sampler.check(&ray).is_ok() {
                    scores.extend(moment_score(sampler, &ray, truth, seed));
                }
            }
        }
        let p = kolmogorov_smirnov(&scores, normal_cdf);
        eprintln!("{}: {} z scores, p = {p:.3}", sampler.name(), scores.len());
        assert!(p > 5e-4, "{}: p = {p} of {scores:?}", sampler.name());
    }
}

/// The probability integral of each distance, 1 − exp(−τ(t)), is uniform below that of the whole ray. At a level of
/// 1e-3 for each sampler.
#[test]
fn distances_of_analog_samplers_follow_the_extinction_along_the_ray() {
    for sampler in DistanceSampler::ALL {
        if !sampler.properties().unbiased || !sampler.is_analog() {
            continue;
        }
        let mut uniform = Vec::new();
        for (_, scene) in scenes() {
            let mut random = fresh::random(17, 0, 0);
            for _ in 0..6 {
                let (_, ray) = along(&scene, &mut random);
                let truth = Tabulated::new(&ray, 40_000);
                for _ in 0..400 * effort() {
                    if let Some(t) = sampler.sample(&ray, &mut random, &mut Lookups::default()).t {
                        uniform.push((-truth.tau_at(t)).exp_m1() / (-truth.whole()).exp_m1());
                    }
                }
            }
        }
        let p = kolmogorov_smirnov(&uniform, |u| u);
        eprintln!("{}: {} distances, p = {p:.3}", sampler.name(), uniform.len());
        assert!(p > 1e-3, "{}: p = {p} of {} distances", sampler.name(), uniform.len());
    }
}

/// P(t < s) for the tabulated quantiles s, of all samplers that are unbiased; at a level of 1e-3 together.
#[test]
fn free_flights_have_the_tabulated_quantiles() {
    let table = table();
    for (row, (profile, length)) in rows(&table, "heterogeneous").iter().zip(profiles()) {
        let ray = lit(AlongRay::with_profile(profile, length, 3));
        let quantiles = row["free_flight_quantiles_p"].as_array().into_iter().flatten();
        let places = row["free_flight_quantiles_s"].as_array().into_iter().flatten();
        for (p, s) in quantiles.zip(places).filter_map(|(p, s)| Some((p.as_f64()?, Value::as_f64(s)?))) {
            for sampler in DistanceSampler::ALL.iter().filter(|sampler| sampler.properties().unbiased) {
                let share =
                    |flight: &Flight| if flight.t.is_some_and(|t| t < s) { flight.weight } else { 0.0 };
                let repeat = |times, seed| {
                    let samples = 2000 * times * effort();
                    repeat_distance(*sampler, &ray, samples, fresh::seed(21 + seed), share)
                };
                let z = confirmed(repeat(1, 0), |found| [found.z(p)], repeat).z(p);
                assert!(
                    z.abs() < two_sided_quantile(1e-3 / 500.0),
                    "{}: {row}: {p}: z = {z}",
                    sampler.name()
                );
            }
        }
    }
}

/// Distance and optical thickness are each other's inverse, to rounding, on every kind of ray.
#[test]
fn the_distance_at_an_optical_thickness_has_that_optical_thickness() {
    let mut random = fresh::random(23, 0, 0);
    let mut check = |ray: AlongRay| {
        let lookups = &mut Lookups::default();
        let whole = ray.thickness(f64::INFINITY, lookups);
        for _ in 0..20 {
            let tau = whole * random.f64();
            let t = ray.distance_at(tau, lookups).expect("within the ray");
            assert!((ray.thickness(t, lookups) - tau).abs() < 1e-11 * whole.max(1.0), "{tau} at {t}");
        }
        assert_eq!(ray.distance_at(whole * (1.0 + 1e-9), lookups), None);
    };
    for (profile, length) in profiles() {
        check(AlongRay::with_profile(profile, length, 4));
    }
    for (_, scene) in scenes() {
        let mut random = fresh::random(24, 0, 0);
        (0..20).for_each(|_| check(along(&scene, &mut random).1));
    }
}

/// Each channel of a chromatic medium has its own law; at a level of 1e-3 together.
#[test]
fn spectral_tracking_is_unbiased_in_every_channel() {
    let tint = DVec3::new(1.0, 0.4, 0.05);
    for throughput in [DVec3::ONE, DVec3::new(0.1, 1.0, 3.0)] {
        for (number, (profile, length)) in (0..).zip(profiles()) {
            let ray = AlongRay::with_profile(profile.clone(), length, 3);
            let tau = profile.thickness(0.0, length);
            for channel in 0..3 {
                let truth = (-tint[channel] * tau).exp();
                for (escapes, truth) in [(true, truth), (false, 1.0 - truth)] {
                    let repeat = |times, seed| {
                        Repeated::of(20_000 * times * effort(), |n, lookups| {
                            let random = &mut fresh::random(31 + seed, number, n);
                            let flight = ChromaticFlight::sample(&ray, tint, throughput, random, lookups);
                            if escapes { flight.escape[channel] } else { flight.weight[channel] }
                        })
                    };
                    let found = confirmed(repeat(1, 0), |found| [found.z(truth)], repeat);
                    let z = found.z(truth);
                    assert!(
                        z.abs() < two_sided_quantile(1e-3 / 132.0),
                        "{profile:?} {channel}: {found:?}, {truth}"
                    );
                }
            }
        }
    }
}
