//! Spot lights and lamps: what is sent out adds up, samples follow their density, and both ways of finding a lamp have the
//! same mean.
//!
//! The integrals over a lamp's surface are fine sums over the square that its points are mapped from.

use std::f64::consts::{PI, TAU};
use std::path::Path;

use glam::DVec3;
use tyndall_lanes::Random;
use tyndall_scene::description::SpotFalloff;
use tyndall_scene::light::{AreaLight, SpotLight, uv_to_direction};
use tyndall_scene::surface::WorldPrimitive;
use tyndall_scene::{Light, Ray, SceneDocument, build};

#[test]
fn the_power_of_a_spot_light_is_the_integral_of_its_intensity() {
    for falloff in [SpotFalloff::Smooth, SpotFalloff::Linear] {
        for angles in [[0.0, 30.0], [20.0, 30.0], [30.0, 30.0], [0.0, 180.0], [100.0, 150.0]] {
            let direction = DVec3::new(0.0, 3.0, 0.0);
            let spot = SpotLight::new(DVec3::ONE, direction, DVec3::new(1.0, 2.0, 3.0), angles, falloff);
            let n = 100_000;
            let ring = |k: i32| {
                let v = (f64::from(k) + 0.5) / f64::from(n);
                spot.intensity(uv_to_direction(0.3, v)) * (TAU * PI / f64::from(n) * (PI * v).sin())
            };
            let integral: DVec3 = (0..n).map(ring).sum();
            let power = Light::Spot(spot).selection_weight(1.0);
            assert!((integral.y / power - 1.0).abs() < 1e-4, "{falloff:?} {angles:?}: {integral} {power}");
            assert!((integral.x / integral.y - 0.5).abs() < 1e-12);
        }
    }
}

#[test]
fn a_spot_light_shines_as_a_point_within_its_cone_and_not_beyond() {
    let spot = |angles, falloff| {
        Light::Spot(SpotLight::new(DVec3::ZERO, DVec3::NEG_Z, DVec3::splat(8.0), angles, falloff))
    };
    let at = |light: &Light, degrees: f64| {
        let angle = degrees.to_radians();
        let sample = light.sample(2.0 * DVec3::new(angle.sin(), 0.0, -angle.cos()), [0.5; 2]);
        assert!(sample.is_delta && (sample.distance - 2.0).abs() < 1e-12);
        sample.radiance_over_pdf.x
    };
    let smooth = spot([10.0, 40.0], SpotFalloff::Smooth);
    assert!((at(&smooth, 0.0) - 2.0).abs() < 1e-12 && (at(&smooth, 9.9) - 2.0).abs() < 1e-12);
    let half = (0.5 * (10_f64.to_radians().cos() + 40_f64.to_radians().cos())).acos().to_degrees();
    assert!((at(&smooth, half) - 1.0).abs() < 1e-12);
    assert_eq!(at(&smooth, 40.1), 0.0);
    let linear = spot([10.0, 40.0], SpotFalloff::Linear);
    assert!((at(&linear, 25.0) - 1.0).abs() < 1e-12 && (at(&linear, 32.5) - 0.5).abs() < 1e-12);
    assert!((at(&spot([30.0, 30.0], SpotFalloff::Smooth), 29.9) - 2.0).abs() < 1e-12);
}

/// A lamp and a point that it is seen from.
struct Case {
    name: &'static str,
    lamp: Vec<WorldPrimitive>,
    two_sided: bool,
    from: DVec3,
}

fn cases() -> Vec<Case> {
    let case = |name, lamp: &[WorldPrimitive], two_sided, from: [f64; 3]| Case {
        name,
        lamp: lamp.to_vec(),
        two_sided,
        from: DVec3::from_array(from),
    };
    let triangle = WorldPrimitive::Triangle([DVec3::ZERO, DVec3::X, DVec3::new(0.3, 1.5, 0.2)]);
    let corner = DVec3::new(-1.0, -0.5, 0.0);
    let rectangle = WorldPrimitive::Parallelogram { corner, u: DVec3::X * 2.0, v: DVec3::Y };
    let skew = WorldPrimitive::Parallelogram { corner, u: DVec3::X * 2.0, v: DVec3::new(0.7, 1.0, 0.0) };
    let sphere = |inward| WorldPrimitive::Sphere { center: DVec3::Y, radius: 0.8, inward };
    let ring = WorldPrimitive::Disc { center: DVec3::ZERO, normal: DVec3::Z, radius: 1.0, inner_radius: 0.6 };
    let cylinder = |inward| {
        let [from, to] = [DVec3::new(0.0, -1.0, 0.0), DVec3::new(0.2, 1.0, 0.0)];
        WorldPrimitive::Cylinder { from, to, radius: 0.5, inward }
    };
    let face = |axis: DVec3, u: DVec3, v: DVec3| WorldPrimitive::Parallelogram {
        corner: 0.5 * (axis - u - v),
        u,
        v,
    };
    let [x, y, z] = DVec3::AXES;
    let cube = [face(x, y, z), face(y, z, x), face(z, x, y), face(-x, z, y), face(-y, x, z), face(-z, y, x)];
    vec![
        case("triangle", &[triangle], false, [0.5, 0.2, 1.0]),
        case("triangle behind", &[triangle], true, [0.5, 0.2, -1.0]),
        case("rectangle", &[rectangle], false, [0.4, 0.2, 0.6]),
        case("rectangle near", &[rectangle], false, [-0.9, 0.4, 0.1]),
        case("rectangle aside", &[rectangle], false, [3.0, -2.0, 0.3]),
        case("rectangle behind", &[rectangle], true, [0.3, 2.0, -1.5]),
        case("rectangle far", &[rectangle], false, [100.0, 300.0, 1000.0]),
        case("skew", &[skew], false, [0.5, 0.2, 1.0]),
        case("sphere", &[sphere(false)], false, [0.5, 0.2, 1.0]),
        case("sphere near", &[sphere(false)], false, [0.0, 0.1, 0.0]),
        case("sphere far", &[sphere(false)], false, [1e4, -1e4, 2e4]),
        case("sphere around", &[sphere(true)], false, [0.1, 1.3, 0.2]),
        case("sphere two-sided", &[sphere(false)], true, [0.1, 1.3, 0.2]),
        case("ring", &[ring], false, [0.5, 0.2, 0.7]),
        case("cylinder", &[cylinder(false)], false, [1.0, 0.3, 1.0]),
        case("cylinder around", &[cylinder(true)], false, [0.1, 0.3, 0.1]),
        case("cube", &cube, false, [1.0, 0.9, 1.2]),
    ]
}

/// Calls `visit` with the direction, position, normal and the solid angle of each element of the surface.
fn elements(case: &Case, mut visit: impl FnMut(DVec3, DVec3, DVec3, f64)) {
    let n = 800;
    for primitive in &case.lamp {
        let area = primitive.area() / f64::from(n * n);
        for k in 0..n * n {
            let point = primitive.sample([k % n, k / n].map(|k| (f64::from(k) + 0.5) / f64::from(n)));
            let offset = point.position - case.from;
            let toward = offset.normalize();
            let solid_angle = area * toward.dot(point.normal).abs() / offset.length_squared();
            visit(toward, point.position, point.normal, solid_angle);
        }
    }
}

fn lamp(case: &Case) -> AreaLight {
    AreaLight::new(case.lamp.clone(), DVec3::new(1.0, 2.0, 0.5), case.two_sided)
}

/// The level of all cases together is 1e-4.
#[test]
fn both_ways_of_finding_a_lamp_bring_the_same_light() {
    let cases = cases();
    for (number, case) in cases.iter().enumerate() {
        let lamp = lamp(case);
        let weight = |direction: DVec3| 1.0 + direction.dot(DVec3::new(0.3, 0.5, -0.4));
        let mut truth = 0.0;
        elements(case, |toward, _, normal, solid_angle| {
            truth += lamp.radiance_from(normal, toward).y * weight(toward) * solid_angle;
        });
        let light = Light::Area(lamp);
        let mut random = Random::new(1, number as u64, 0);
        let n = 100_000;
        let (mut sum, mut squares) = (0.0, 0.0);
        for _ in 0..n {
            let sample = light.sample(case.from, [random.f64(), random.f64()]);
            let value = sample.radiance_over_pdf.y * weight(sample.toward);
            sum += value;
            squares += value * value;
        }
        let (n, mean) = (f64::from(n), sum / f64::from(n));
        let error = ((squares / n - mean * mean).max(0.0) / n).sqrt();
        let name = case.name;
        // 4.5 standard errors, and what the fine sum leaves open.
        assert!((mean - truth).abs() < 4.5 * error + 5e-4 * truth, "{name}: {mean} ± {error}, not {truth}");
        assert!(truth > 0.0 && error < 0.02 * truth, "{name}: {mean} ± {error}");
    }
}

/// χ² over bins of direction, whose probabilities are fine sums of the density; 5 standard deviations of χ² is below
/// 1e-4 for each, at these numbers of bins.
#[test]
fn lamps_are_sampled_as_their_pdf_says() {
    let mut without_distribution = Vec::new();
    for (number, case) in cases().iter().enumerate() {
        let lamp = lamp(case);
        let name = case.name;
        let mut mean = DVec3::ZERO;
        let mut nearest = Vec::new();
        elements(case, |toward, position, normal, solid_angle| {
            let pdf = lamp.pdf_of_hit(case.from, toward, position, normal);
            if pdf > 0.0 {
                mean += toward * (pdf * solid_angle);
                nearest.push((toward, pdf * solid_angle));
            }
        });
        let total: f64 = nearest.iter().map(|(_, probability)| probability).sum();
        assert!((total - 1.0).abs() < 2e-3, "{name}: the pdf integrates to {total}");

        let axis = mean.normalize();
        let (across, other) = axis.any_orthonormal_pair();
        let depth = |direction: DVec3| 0.5 * (direction - axis).length_squared();
        let deepest = nearest.iter().fold(0.0_f64, |deep, (toward, _)| deep.max(depth(*toward))) * 1.001;
        let bin = |direction: DVec3| {
            let azimuth = direction.dot(other).atan2(direction.dot(across)) / TAU + 0.5;
            let down = ((depth(direction) / deepest * 8.0) as usize).min(7);
            down * 8 + ((azimuth * 8.0) as usize).min(7)
        };
        let mut expected = [0.0; 64];
        for (toward, probability) in nearest {
            expected[bin(toward)] += probability / total;
        }
        let light = Light::Area(lamp.clone());
        let mut random = Random::new(2, number as u64, 0);
        let n = 40_000;
        let mut counts = [0.0; 64];
        let mut blocked = 0;
        for _ in 0..n {
            let sample = light.sample(case.from, [random.f64(), random.f64()]);
            assert!((sample.toward.length() - 1.0).abs() < 1e-12 && !sample.is_delta, "{name}");
            counts[bin(sample.toward)] += 1.0;
            let position = case.from + sample.toward * sample.distance;
            if let [only] = case.lamp.as_slice()
                && let Some(normal) = only.flat_normal()
            {
                let pdf = lamp.pdf_of_hit(case.from, sample.toward, position, normal);
                assert!((pdf / sample.pdf - 1.0).abs() < 1e-6, "{name}: {pdf} {}", sample.pdf);
                let WorldPrimitive::Parallelogram { corner, .. } = only else { continue };
                let plane = (*corner - case.from).dot(normal) / sample.toward.dot(normal);
                blocked += u32::from(sample.distance >= plane * (1.0 - 1e-10));
            }
        }
        assert_eq!(blocked, 0, "{name}: a lamp shadows itself");
        let (mut statistic, mut freedom, mut rest) = (0.0, -1.0, (0.0, 0.0));
        for (probability, count) in expected.iter().zip(counts) {
            let expected = probability * f64::from(n);
            if expected < 20.0 {
                rest = (rest.0 + expected, rest.1 + count);
            } else {
                statistic += (count - expected).powi(2) / expected;
                freedom += 1.0;
            }
        }
        assert!((rest.1 - rest.0).abs() < 5.0 * rest.0.sqrt() + 20.0, "{name}: {rest:?}");
        let limit = freedom + 5.0 * f64::sqrt(2.0 * freedom) + 10.0;
        assert!(statistic < limit, "{name}: χ² = {statistic} with {freedom} degrees of freedom");
        if freedom < 10.0 {
            without_distribution.push(name);
        }
    }
    assert_eq!(without_distribution, [""; 0], "too few bins to say anything");
}

#[test]
fn a_lamp_is_dark_from_behind_and_one_without_area_is_never_drawn() {
    let radiance = DVec3::ONE;
    let square = WorldPrimitive::Parallelogram { corner: DVec3::ZERO, u: DVec3::X, v: DVec3::Y };
    let behind = DVec3::new(0.5, 0.5, -1.0);
    for (two_sided, seen) in [(false, DVec3::ZERO), (true, radiance)] {
        let lamp = AreaLight::new(vec![square], radiance, two_sided);
        assert_eq!(lamp.radiance_from(DVec3::Z, DVec3::Z), seen);
        assert_eq!(lamp.radiance_from(DVec3::Z, DVec3::NEG_Z), radiance);
        let sample = Light::Area(lamp).sample(behind, [0.3, 0.4]);
        assert!((sample.radiance_over_pdf * sample.pdf - seen).length() < 1e-12);
    }
    let flat = WorldPrimitive::Triangle([DVec3::ZERO, DVec3::X, DVec3::X * 2.0]);
    for primitives in [vec![], vec![flat]] {
        let lamp = AreaLight::new(primitives, radiance, false);
        assert_eq!(lamp.pdf_of_hit(DVec3::Z, DVec3::NEG_Z, DVec3::ZERO, DVec3::Z), 0.0);
        assert_eq!(lamp.radiance_from(DVec3::Z, DVec3::NEG_Z), radiance);
        let light = Light::Area(lamp);
        assert_eq!(light.sample(DVec3::Z, [0.3, 0.4]).radiance_over_pdf, DVec3::ZERO);
        assert_eq!(light.selection_weight(1.0), 0.0);
    }
}

#[test]
fn shapes_that_shine_become_lamps_each_instance_its_own() {
    let text = r#"
        camera = { position = [0, 0, 9], target = [0, 0, 0] }
        [[material]]
        name = "white"
        type = "diffuse"
        reflectance = 0.5
        [[shape]]
        box = { min = [5, 5, 5], max = [6, 6, 6] }
        material = "white"
        [[shape]]
        name = "bulb"
        sphere = { center = [0, 0, 0], radius = 0.5 }
        material = "white"
        emission = { radiance = { blackbody = 3000, luminance = 2 }, scale = 3 }
        instances = [{ scale = 2 }, { translate = [4, 0, 0] }, { scale = [1, 2, 1], translate = [-4, 0, 0] }]
        [[shape]]
        rectangle = { corner = [-1, 3, -1], u = [2, 0, 0], v = [0, 0, 2] }
        transform = { scale = [-1, 1, 1] }
        material = "white"
        emission = { radiance = [1, 2, 3], two_sided = true }
        [[light]]
        type = "spot"
        position = [0, 1, 0]
        direction = [0, -2, 0]
        intensity = 4
        angle = 60
        inner_angle = 60
    "#;
    let description = SceneDocument::parse("lamps.toml", text).unwrap().description().unwrap();
    let built = build(&description, Path::new(".")).unwrap();
    let scene = &built.scene;
    let numbers: Vec<Option<usize>> = scene.surfaces.shapes.iter().map(|shape| shape.light).collect();
    assert_eq!(numbers, [None, Some(1), Some(2), Some(3), Some(4)]);
    let areas: Vec<f64> = scene.lights.iter().filter_map(lamp_of).map(AreaLight::area).collect();
    for (area, expected) in areas.iter().zip([4.0 * PI, PI, 0.0, 4.0]) {
        assert!((area - expected).abs() < 1e-12, "{areas:?}");
    }
    let about: Vec<&String> = built.notes.iter().filter(|note| note.contains("by chance")).collect();
    assert!(matches!(about[..], [note] if note.starts_with("bulb.instances.2: ")), "{:?}", built.notes);
    assert!(scene.light_spectra[1].is_some() && scene.light_spectra[4].is_none());
    let Light::Area(bulb) = &scene.lights[1] else { panic!("{:?}", scene.lights[1]) };
    let radiance = bulb.radiance_from(DVec3::Y, DVec3::NEG_Y);
    let luminance = radiance.dot(DVec3::new(0.2126, 0.7152, 0.0722));
    assert!((luminance / 6.0 - 1.0).abs() < 1e-3, "{radiance}");
    assert_eq!(bulb.radiance_from(DVec3::Y, DVec3::Y), DVec3::ZERO);
    // Spot: 2π (1 − cos 60°) 4.
    assert!((scene.lights[0].selection_weight(1.0) / (4.0 * PI) - 1.0).abs() < 1e-12);
    assert_eq!(scene.light_probability(3, DVec3::ZERO), 0.0);

    // A ray that meets a lamp finds it where sampling drew it, and as dense.
    let mut random = Random::new(3, 0, 0);
    for (number, shape) in [(1, 1), (2, 2), (4, 4)] {
        for _ in 0..1000 {
            let from = DVec3::new(2.0 + random.f64(), random.f64(), 5.0 * random.f64());
            let light = &scene.lights[number];
            let sample = light.sample(from, [random.f64(), random.f64()]);
            let ray = Ray { origin: from, direction: sample.toward };
            let free = scene.surfaces.intersect(&ray, sample.distance);
            assert!(free.is_none_or(|hit| hit.shape != shape), "lamp {number} shadows itself: {free:?}");
            let Some(hit) = scene.surfaces.intersect(&ray, sample.distance * (1.0 + 1e-6)) else { continue };
            let lamp = lamp_of(light).unwrap();
            if hit.shape == shape && hit.normal.dot(sample.toward).abs() > 0.01 {
                let pdf = lamp.pdf_of_hit(from, sample.toward, hit.position, hit.normal);
                assert!((pdf / sample.pdf - 1.0).abs() < 1e-6, "lamp {number}: {pdf} {sample:?}");
                let brought = lamp.radiance_from(hit.normal, sample.toward) / pdf;
                assert!((brought - sample.radiance_over_pdf).length() < 1e-6 * brought.length());
            }
        }
    }
}

fn lamp_of(light: &Light) -> Option<&AreaLight> {
    if let Light::Area(lamp) = light { Some(lamp) } else { None }
}
