//! Among surfaces, too, unusual estimators make the picture that the default makes; and so does equiangular sampling of
//! point, spot and area lamps.

use tyndall_scene::Scene;
use tyndall_scene::description::Integrator;
use tyndall_transport::{DistanceSampler, Estimators, RenderOptions, TransmittanceEstimator};

use super::agreement::furnished;
use super::{assert_same_pictures, effort};
use crate::agreement::{Batches, batches_with};
use crate::rendering::options;

/// Independent films for each choice.
const BATCHES: u64 = 10;

fn pictures(scene: &Scene, estimators: Estimators, seed: u64) -> Batches {
    estimators.validate(scene).unwrap_or_else(|reason| panic!("{estimators:?}: {reason}"));
    let options = RenderOptions { estimators, ..options(Integrator::Reference, seed) };
    batches_with(scene, options, BATCHES * effort())
}

const FLOOR_AND_BALL: &str = r#"
    [[shape]]
    plane = { point = [0, -0.8, 0], normal = [0, 1, 0] }
    material = "chequered"
    [[shape]]
    sphere = { center = [0.5, -0.4, 0.2], radius = 0.4 }
    material = "mirror"
    "#;

const CAMERA: &str = "{ position = [0.3, 0.4, 3.6], target = [0, -0.1, 0], vertical_fov = 38 }";

const BOUNDED: &str = r#"
    [[volume]]
    name = "fog"
    mu_t = 0.8
    albedo = [0.9, 0.8, 0.7]
    phase = { type = "hg", g = 0.5 }
    [[shape]]
    box = { min = [-1, -0.79, -1], max = [1, 0.9, 1] }
    material = "none"
    interior = "fog"
    "#;

const GRID: &str = r#"
    [[volume]]
    file = "random.npy"
    mu_t = 3
    albedo = [0.9, 0.8, 0.7]
    transform = { scale = 0.15, translate = [-0.9, -0.7, -0.9] }
    "#;

const LAMPS: [(&str, &str); 3] = [
    (
        "point",
        r#"
        [[light]]
        type = "point"
        position = [-0.2, 0.3, 0.2]
        intensity = [1, 2, 1]
        "#,
    ),
    (
        "spot",
        r#"
        [[light]]
        type = "spot"
        position = [-0.6, 0.6, 0.2]
        direction = [0.8, -1, 0]
        intensity = [3, 2, 1]
        angle = 35
        inner_angle = 10
        "#,
    ),
    (
        "area",
        r#"
        [[shape]]
        disc = { center = [-0.3, 0.5, 0.1], normal = [0.4, -1, 0.2], radius = 0.15 }
        material = "grey"
        emission = { radiance = [20, 15, 10] }
        [[shape]]
        sphere = { center = [0.3, 0.4, -0.5], radius = 0.08 }
        material = "grey"
        emission = { radiance = [10, 15, 20] }
        "#,
    ),
];

#[test]
fn equiangular_sampling_of_point_spot_and_area_lamps_makes_the_same_picture() {
    for (medium, volume) in [("bounded", BOUNDED), ("grid", GRID)] {
        for (lamp, light) in LAMPS {
            let scene = furnished(CAMERA, &format!("{volume}{light}{FLOOR_AND_BALL}"));
            let equiangular =
                Estimators { distance: Some(DistanceSampler::Equiangular), ..Estimators::default() };
            let pair = [pictures(&scene, Estimators::default(), 81), pictures(&scene, equiangular, 82)];
            assert_same_pictures(&format!("{lamp} in {medium}"), [Integrator::Reference; 2], &pair);
        }
    }
}

/// Homogeneous fog bounded by a surface, a ball that overlaps it, and a grid without filter, which closed forms allow.
#[test]
fn every_unbiased_estimator_makes_the_picture_that_the_default_makes() {
    let unfiltered = GRID.replace("mu_t = 3", "mu_t = 1.5\n filter = \"nearest\"");
    let ball = "[[volume]]\n sphere = { center = [-0.4, 0, 0.3], radius = 0.5 }\n mu_t = 2\n albedo = 0.8\n emission = [0.1, 0.2, 0.3]\n";
    let lamps = LAMPS.map(|(_, light)| light).concat();
    let scene = furnished(CAMERA, &format!("{BOUNDED}{unfiltered}{ball}{lamps}{FLOOR_AND_BALL}"));
    let default = pictures(&scene, Estimators::default(), 90);
    let distances: Vec<_> =
        DistanceSampler::ALL.into_iter().filter(|sampler| sampler.properties().unbiased).collect();
    let transmittances: Vec<_> =
        TransmittanceEstimator::ALL.into_iter().filter(|estimator| estimator.properties().unbiased).collect();
    for i in 0..distances.len().max(transmittances.len()) {
        let (distance, transmittance) =
            (distances[i % distances.len()], transmittances[i % transmittances.len()]);
        let estimators = Estimators { distance: Some(distance), transmittance: Some(transmittance) };
        let unusual = pictures(&scene, estimators, 91 + i as u64);
        let name = format!("{} with {}", distance.name(), transmittance.name());
        assert_same_pictures(&name, [Integrator::Reference; 2], &[default.clone(), unusual]);
    }
}
