//! Light of a point light scattered once along a ray, against `truth/single_scatter.json`.

use std::f64::consts::PI;

use glam::DVec3;
use serde_json::Value;
use tyndall_scene::Ray;
use tyndall_transport::along_ray::{AlongRay, LightBeside, Profile};
use tyndall_transport::{DistanceSampler, Estimators, Repeated, repeat_distance, trace_with};

use super::effort;
use super::rays::{number, rows};
use crate::fresh;
use crate::scenes::scene;
use crate::statistics::two_sided_quantile;

fn table() -> Value {
    serde_json::from_str(include_str!("../../truth/single_scatter.json")).expect("the table is JSON")
}

/// Henyey and Greenstein's phase function.
fn phase(g: f64, cos_theta: f64) -> f64 {
    (1.0 - g * g) / (4.0 * PI * (1.0 + g * g - 2.0 * g * cos_theta).powf(1.5))
}

/// At a level of 1e-3 for all rows and samplers together.
#[test]
fn distance_samplers_estimate_the_airlight_of_a_point_light() {
    let table = table();
    for row in rows(&table, "single_scatter") {
        let at = |key: &str| number(row, key);
        let (mu_t, g) = (at("sigma_t"), at("g"));
        let light = DVec3::new(at("light_offset_x"), 0.0, at("light_depth_z"));
        let length = row["ray_length"].as_f64().unwrap_or(60.0 / mu_t);
        let ray = Ray { origin: DVec3::ZERO, direction: DVec3::Z };
        let along = AlongRay::with_profile(Profile::Constant(mu_t), length, 1)
            .with_light(LightBeside::new(&ray, light));
        let scattered = |t: f64| {
            let toward = light - ray.at(t);
            let distance = toward.length();
            // From the light to the place, and on towards the camera at the ray's origin.
            let cos_theta = (toward / distance).dot(ray.direction);
            at("albedo") * phase(g, cos_theta) * (-mu_t * distance).exp() / (distance * distance)
        };
        let mut variances = Vec::new();
        for sampler in
            [DistanceSampler::Equiangular, DistanceSampler::ForcedCollision, DistanceSampler::DeltaTracking]
        {
            let samples = 20_000 * effort();
            let found = repeat_distance(sampler, &along, samples, fresh::seed(3), |f| {
                f.t.map_or(0.0, |t| f.weight * scattered(t))
            });
            let z = found.z(at("L_single_scatter"));
            assert!(
                z.abs() < two_sided_quantile(1e-3 / 24.0),
                "{}: {row}: {found:?}, z = {z}",
                sampler.name()
            );
            variances.push(found.variance);
        }
        if row["ray_length"].is_number() {
            assert!(
                variances[1] < variances[2],
                "{row}: a forced collision has less variance: {variances:?}"
            );
        }
    }
}

/// The reference integrator in a medium that fills space, with and without equiangular samples; at a level of 1e-3 for
/// all rows together. The variance is less with them in every row.
#[test]
fn equiangular_samples_in_the_integrator_keep_the_mean_and_lessen_the_variance() {
    let table = table();
    for row in rows(&table, "single_scatter").iter().filter(|row| row["ray_length"].is_string()) {
        let at = |key: &str| number(row, key);
        let scene = scene(&format!(
            "camera = {{ position = [0, 0, 0], direction = [0, 0, 1] }}
             render = {{ max_depth = 1 }}
             [medium]
             mu_t = {}
             albedo = {}
             phase = {{ type = \"hg\", g = {} }}
             [[light]]
             type = \"point\"
             position = [{}, 0, {}]
             intensity = 1",
            at("sigma_t"),
            at("albedo"),
            at("g"),
            at("light_offset_x"),
            at("light_depth_z")
        ));
        let ray = Ray { origin: DVec3::ZERO, direction: DVec3::Z };
        let variances = [None, Some(DistanceSampler::Equiangular)].map(|distance| {
            let estimators = Estimators { distance, transmittance: None };
            estimators.validate(&scene).expect("there is a point light");
            let found = Repeated::of(40_000 * effort(), |n, _| {
                f64::from(trace_with(&scene, estimators, ray, &mut fresh::random(9, 0, n)).radiance[0])
            });
            let z = found.z(at("L_single_scatter"));
            assert!(z.abs() < two_sided_quantile(1e-3 / 6.0), "{distance:?}: {row}: {found:?}, z = {z}");
            found.variance
        });
        eprintln!(
            "{row}: variance {:.3e} at collisions, {:.3e} with equiangular samples",
            variances[0], variances[1]
        );
        assert!(variances[1] < variances[0], "{row}: {variances:?}");
    }
}
