//! Drawing among many lights by place: probabilities sum to 1, draws follow them, no light is forgotten, and the noise is
//! far below that of drawing uniformly.

use std::path::Path;

use glam::DVec3;
use tyndall_lanes::Random;
use tyndall_scene::description::SpotFalloff;
use tyndall_scene::light::{AreaLight, ConstantLight, DistantLight, LightTree, PointLight, SpotLight};
use tyndall_scene::surface::WorldPrimitive;
use tyndall_scene::{Light, Scene, SceneDocument, build};

/// A scene with these lights, drawn by power.
fn scene(lights: Vec<Light>) -> Scene {
    let text = "camera = { position = [0, 0, 1], target = [0, 0, 0] }";
    let description = SceneDocument::parse("test", text).unwrap().description().unwrap();
    let mut scene = build(&description, Path::new(".")).unwrap().scene;
    let weights: Vec<f64> = lights
        .iter()
        .map(|light| if matches!(light, Light::Constant(_)) { 0.0 } else { light.selection_weight(10.0) })
        .collect();
    let total: f64 = weights.iter().sum();
    scene.light_probabilities = weights.iter().map(|weight| weight / total).collect();
    scene.light_tree = LightTree::new(&lights, &scene.light_probabilities);
    scene.lights = lights;
    scene
}

/// Lamps of all kinds under the ceiling of a hall of 100 × 40 m, a few of them a hundred times brighter.
fn hall(count: u64) -> Vec<Light> {
    let mut random = Random::new(5, count, 0);
    (0..count)
        .map(|number| {
            let position = DVec3::new(random.f64() * 100.0, 8.0 + 2.0 * random.f64(), random.f64() * 40.0);
            let strength = if random.f64() < 0.02 { 100.0 } else { 1.0 } * random.f64();
            let intensity = DVec3::new(1.0, 0.9, 0.7) * strength;
            let down = DVec3::new(random.f64() - 0.5, -1.0, random.f64() - 0.5);
            match number % 4 {
                0 => Light::Point(PointLight::new(position, intensity)),
                1 => {
                    let angles = [10.0, 20.0 + 60.0 * random.f64()];
                    Light::Spot(SpotLight::new(position, down, intensity, angles, SpotFalloff::Smooth))
                }
                2 => {
                    let square = WorldPrimitive::Parallelogram { corner: position, u: DVec3::X, v: DVec3::Z };
                    Light::Area(AreaLight::new(vec![square], intensity, number % 8 == 2))
                }
                _ => {
                    let ball = WorldPrimitive::Sphere { center: position, radius: 0.2, inward: false };
                    Light::Area(AreaLight::new(vec![ball], intensity * 5.0, false))
                }
            }
        })
        .collect()
}

fn places() -> Vec<DVec3> {
    let mut random = Random::new(6, 0, 0);
    let mut places: Vec<DVec3> = (0..20)
        .map(|_| DVec3::new(random.f64() * 120.0 - 10.0, random.f64() * 14.0, random.f64() * 60.0 - 10.0))
        .collect();
    places.extend([DVec3::splat(1e6), DVec3::new(50.0, 9.0, 20.0)]);
    places
}

#[test]
fn probabilities_sum_to_1_everywhere() {
    for count in [3, 4, 17, 1000] {
        let mut lights = hall(count);
        lights.insert(1, Light::Constant(ConstantLight::new(DVec3::ONE)));
        lights.push(Light::Distant(DistantLight::new(DVec3::NEG_Y, DVec3::splat(0.01))));
        let scene = scene(lights);
        assert!(scene.light_tree.is_some());
        let mut places = places();
        places.extend(scene.lights.iter().take(5).filter_map(|light| match light {
            Light::Point(point) => Some(point.position()),
            _ => None,
        }));
        for from in places {
            let all = (0..scene.lights.len()).map(|number| scene.light_probability(number, from));
            let total: f64 = all.sum();
            assert!((total - 1.0).abs() < 1e-9, "{count} lights: {total} at {from}");
            assert_eq!(scene.light_probability(1, from), 0.0, "even light is left to the phase function");
        }
    }
}

/// χ² over the lights, those with few expected draws together; 5 standard deviations.
#[test]
fn lights_are_drawn_with_their_probabilities() {
    let mut lights = hall(300);
    lights.push(Light::Distant(DistantLight::new(DVec3::NEG_Y, DVec3::splat(0.1))));
    let scene = scene(lights);
    for (number, from) in places().into_iter().enumerate() {
        let mut random = Random::new(7, number as u64, 0);
        let draws = 20_000;
        let mut counts = vec![0.0; scene.lights.len()];
        for _ in 0..draws {
            let (light, probability) = scene.choose_light(from, random.f64()).unwrap();
            let asked = scene.light_probability(light, from);
            assert!((probability / asked - 1.0).abs() < 1e-9, "{probability} {asked}");
            counts[light] += 1.0;
        }
        let (mut statistic, mut freedom, mut rest) = (0.0, -1.0, (0.0, 0.0));
        for (light, count) in counts.into_iter().enumerate() {
            let expected = scene.light_probability(light, from) * f64::from(draws);
            if expected < 10.0 {
                rest = (rest.0 + expected, rest.1 + count);
            } else {
                statistic += f64::powi(count - expected, 2) / expected;
                freedom += 1.0;
            }
        }
        assert!(f64::abs(rest.1 - rest.0) < 5.0 * f64::sqrt(rest.0) + 20.0, "{from}: {rest:?}");
        let limit = freedom + 5.0 * f64::sqrt(2.0 * f64::max(freedom, 1.0)) + 10.0;
        assert!(statistic < limit, "{from}: χ² = {statistic} with {freedom} degrees of freedom");
    }
}

/// Light that arrives at `from`, with one random number a light.
fn arrives(light: &Light, from: DVec3, u: [f64; 2]) -> f64 {
    light.sample(from, u).radiance_over_pdf.y
}

#[test]
fn a_light_that_reaches_a_place_may_be_drawn_there() {
    let scene = scene(hall(1000));
    let mut places = places();
    // In the edges of cones and planes of lamps, where bounds are tight.
    for light in &scene.lights {
        match light {
            Light::Spot(spot) => {
                let (across, _) = spot.axis().any_orthonormal_pair();
                let (sin, cos) = (0.999 * spot.edge()).sin_cos();
                places.push(spot.position() + 3.0 * (spot.axis() * cos + across * sin));
            }
            Light::Area(lamp) if lamp.primitives()[0].flat_normal().is_some() => {
                let point = lamp.primitives()[0].sample([0.5; 2]);
                places.push(point.position + 3.0 * DVec3::X + 1e-3 * point.normal);
            }
            _ => {}
        }
    }
    let mut dark = 0;
    for from in places {
        for (number, light) in scene.lights.iter().enumerate() {
            let probability = scene.light_probability(number, from);
            let lit = [[0.1, 0.1], [0.9, 0.1], [0.5, 0.5], [0.1, 0.9], [0.9, 0.9]];
            let reaches = lit.iter().any(|&u| arrives(light, from, u) > 0.0);
            assert!(!reaches || probability > 0.0, "light {number} at {from}");
            dark += u32::from(probability == 0.0);
        }
    }
    assert!(dark > 0, "lamps seen from behind are not drawn");
}

#[test]
fn among_a_thousand_lamps_the_noise_is_far_below_that_of_a_uniform_choice() {
    let scene = scene(hall(1000));
    let mut ratios = Vec::new();
    for (number, from) in places().into_iter().take(20).enumerate() {
        let mut random = Random::new(8, number as u64, 0);
        let stratified = (0..64).map(|k| [f64::from(k % 8), f64::from(k / 8)].map(|i| (i + 0.5) / 8.0));
        let stratified: Vec<[f64; 2]> = stratified.collect();
        let truth: f64 = scene
            .lights
            .iter()
            .map(|light| stratified.iter().map(|&u| arrives(light, from, u)).sum::<f64>() / 64.0)
            .sum();
        let n = 20_000;
        let mut moments = |choose: &dyn Fn(f64) -> (usize, f64)| {
            let (mut sum, mut squares) = (0.0, 0.0);
            for _ in 0..n {
                let (light, probability) = choose(random.f64());
                let value = arrives(&scene.lights[light], from, [random.f64(), random.f64()]) / probability;
                sum += value;
                squares += value * value;
            }
            let mean = sum / f64::from(n);
            (mean, squares / f64::from(n) - mean * mean)
        };
        let (mean, variance) = moments(&|u| scene.choose_light(from, u).unwrap());
        let (_, uniform) = moments(&|u| ((u * 1000.0) as usize, 1e-3));
        let error = (variance / f64::from(n)).sqrt();
        assert!((mean - truth).abs() < 4.5 * error + 0.005 * truth, "{from}: {mean} ± {error}, not {truth}");
        ratios.push(uniform / variance);
    }
    ratios.sort_by(f64::total_cmp);
    let median = ratios[ratios.len() / 2];
    println!("variance of a uniform choice over that of the tree: median {median:.0}, {ratios:.0?}");
    assert!(median > 20.0 && ratios[0] > 3.0, "{ratios:?}");
}

#[test]
fn lights_at_one_place_and_sets_of_probabilities_are_no_trouble() {
    let point = |intensity: f64| Light::Point(PointLight::new(DVec3::ONE, DVec3::splat(intensity)));
    let mut scene = scene(vec![point(1.0), point(2.0), point(0.0), point(5.0), point(2.0)]);
    for from in [DVec3::ONE, DVec3::ZERO] {
        let probabilities: Vec<f64> = (0..5).map(|number| scene.light_probability(number, from)).collect();
        for (probability, expected) in probabilities.iter().zip([0.1, 0.2, 0.0, 0.5, 0.2]) {
            assert!((probability - expected).abs() < 1e-12, "{probabilities:?}");
        }
    }
    scene.set_light_probabilities(vec![0.0, 1.0, 0.0, 0.0, 0.0]);
    assert_eq!(scene.choose_light(DVec3::ZERO, 0.9), Some((1, 1.0)));
    assert_eq!(scene.light_probability(3, DVec3::ZERO), 0.0);
}
