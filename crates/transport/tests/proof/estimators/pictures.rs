//! Whole pictures: unusual pairs of estimators make the picture that the default makes.

use tyndall_scene::Scene;
use tyndall_scene::description::Integrator;
use tyndall_transport::{DistanceSampler, Estimators, RenderOptions, TransmittanceEstimator};

use super::effort;
use crate::agreement::{HEAD, assert_same_batches, batches_with};
use crate::rendering::options;
use crate::scenes::{scene_in, write_random_npy};

/// A rough grid and a glowing ball that cross each other, under a point light and surroundings.
fn mixed() -> Scene {
    let folder = tempfile::tempdir().expect("a folder for test files");
    write_random_npy(&folder.path().join("random.npy"), [6, 6, 6], 22);
    scene_in(
        folder.path(),
        &format!(
            r#"{HEAD}
            [[volume]]
            file = "random.npy"
            transform = {{ scale = 0.3, translate = [-0.9, -0.9, -0.9] }}
            mu_t = 3
            albedo = [0.9, 0.6, 0.3]
            phase = {{ type = "hg", g = 0.5 }}
            [[volume]]
            sphere = {{ center = [0.4, 0.3, 0.2], radius = 0.6 }}
            mu_t = 1.5
            albedo = 0.7
            emission = [0.3, 0.2, 0.1]
            [[light]]
            type = "point"
            position = [0.7, 1.4, 1.2]
            intensity = 3
            [[light]]
            type = "constant"
            radiance = 0.4
            "#
        ),
    )
}

fn reference(distance: Option<&str>, transmittance: Option<&str>) -> RenderOptions {
    let estimators = Estimators {
        distance: distance.map(|name| DistanceSampler::from_name(name).expect("a name")),
        transmittance: transmittance.map(|name| TransmittanceEstimator::from_name(name).expect("a name")),
    };
    RenderOptions { estimators, ..options(Integrator::Reference, 0) }
}

#[test]
fn unusual_pairs_make_the_picture_that_the_default_makes() {
    let scene = mixed();
    let number = 16 * effort();
    let default = batches_with(&scene, reference(None, None), number);
    for (seed, distance, transmittance) in [
        (1, "regular-tracking", "unbiased-ray-marching"),
        (2, "forced-collision", "next-flight"),
        (3, "weighted-decomposition-tracking", "telescoping-ray-marching"),
        (4, "equiangular", "p-series-cmf"),
    ] {
        let unusual = reference(Some(distance), Some(transmittance));
        unusual.estimators.validate(&scene).expect("a valid pair");
        let pictures = batches_with(&scene, RenderOptions { seed, ..unusual }, number);
        let name = format!("{distance} with {transmittance}");
        assert_same_batches(&name, [Integrator::Reference; 2], &[default.clone(), pictures]);
    }
}

#[test]
fn pairs_that_do_not_fit_the_scene_are_refused_with_the_reason() {
    let mut scene = mixed();
    let reason = |scene: &Scene, distance, transmittance| {
        reference(distance, transmittance).estimators.validate(scene).unwrap_err().to_string()
    };
    for (distance, transmittance) in [(Some("closed-form"), None), (None, Some("closed-form"))] {
        let reason = reason(&scene, distance, transmittance);
        assert!(reason.contains("closed-form") && reason.contains("regular-tracking"), "{reason}");
    }
    scene.lights.remove(0);
    scene.light_probabilities.remove(0);
    let reason = reason(&scene, Some("equiangular"), None);
    assert!(reason.contains("equiangular") && reason.contains("point light"), "{reason}");
    assert!(reference(Some("ray-marching"), None).estimators.notes()[0].contains("biased"));
    assert!(reference(Some("delta-tracking"), Some("ratio-tracking")).estimators.notes().is_empty());
}
