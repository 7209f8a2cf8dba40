//! The fast engine for an even chromatic medium: the same pictures as by the spectral integrator in f64, and as adding and
//! doubling says; and every scene that it does not know goes to that integrator.

use glam::DVec3;
use tyndall_film::{Film, Layers};
use tyndall_scene::Scene;
use tyndall_scene::description::Integrator;
use tyndall_scene::light::{Light, PointLight};
use tyndall_transport::RenderOptions;

use crate::agreement::{HEAD, assert_same_batches, batches};
use crate::chromatic::{chromatic, crowd};
use crate::effort::is_full;
use crate::rendering::{add_pass, options, render};
use crate::scenes::scene;
use crate::slab::{Row, rows};
use crate::statistics::{kolmogorov_smirnov, normal_cdf, two_sided_quantile};

const MILK: &str = "sphere = { center = [0, 0, 0], radius = 1 }
    mu_s = [1, 3, 8]
    mu_a = [0.01, 0.2, 0.1]
    phase = { type = \"hg\", g = 0.6 }";

const LIGHTS: &str = "[[light]]
    type = \"constant\"
    radiance = [0.3, 0.2, 0.4]
    [[light]]
    type = \"point\"
    position = [2, 2.5, 2]
    intensity = [30, 25, 20]
    [[light]]
    type = \"distant\"
    direction = [1, -0.4, -0.3]
    irradiance = [1, 2, 3]";

fn even(volume: &str, lights: &str) -> Scene {
    scene(&format!("{HEAD}\n[[volume]]\n{volume}\n{lights}"))
}

/// The fast engine against the integrator in f64, in every layer and region, at a level of 1e-3 for each scene.
fn assert_engines_agree(name: &str, scene: &Scene) {
    let count = if is_full() { 400 } else { 24 };
    let pair = [Integrator::Fast, Integrator::Reference];
    let [fast, f64] = [batches(scene, pair[0], 51, count), batches(scene, pair[1], 52, count)];
    assert_same_batches(name, pair, &[fast, f64]);
    assert!(knows(scene), "{name} was left to the integrator in f64");
}

/// Whether the fast engine is another than the one in f64.
fn knows(scene: &Scene) -> bool {
    let [width, height] = scene.resolution;
    let [fast, f64] = [Integrator::Fast, Integrator::Reference].map(|integrator| {
        let mut film = Film::new(width, height, Layers::ALL).expect("a small picture");
        add_pass(scene, &mut film, 0..1, options(integrator, 5));
        film
    });
    fast != f64
}

#[test]
fn a_sphere_of_milk_to_any_depth() {
    let mut milk = even(MILK, LIGHTS);
    for max_depth in [Some(1), Some(2), None] {
        milk.max_depth = max_depth;
        assert_engines_agree(&format!("milk to depth {max_depth:?}"), &milk);
    }
}

/// Phase functions far apart, a channel that only absorbs, and one that meets nothing.
#[test]
fn channels_with_nothing_in_common() {
    let mut sphere = even(MILK, LIGHTS);
    sphere.volumes[0].medium.albedo = DVec3::new(1.0, 0.0, 0.9);
    let sphere = chromatic(sphere, DVec3::new(0.3, 1.0, 3.0), Some([0.8, 0.0, -0.5]));
    assert_engines_agree("three phase functions", &sphere);
    let gap = chromatic(sphere, DVec3::new(1.0, 0.0, 0.5), None);
    assert_engines_agree("a channel without extinction", &gap);
}

#[test]
fn boxes_slabs_and_fog_with_the_camera_in_it() {
    let block = "box = { min = [-1, -0.6, -0.8], max = [0.9, 0.7, 0.5] }
        transform = { scale = [1.2, 1, 0.7], rotate = [20, 50, 10], translate = [0.1, 0, 0.2] }
        mu_s = [2, 3, 7]
        mu_a = [0.5, 0.1, 0.2]
        phase = { type = \"hg\", g = -0.3 }";
    assert_engines_agree("a turned box", &even(block, LIGHTS));
    let lens = "sphere = { center = [0, 0, 0], radius = 1 }
        transform = { scale = [1.2, 0.5, 0.9], rotate = [0, 30, 40], translate = [0, 0, 3.5] }
        mu_s = [2, 0.3, 7]
        mu_a = [0.5, 0.1, 0.2]";
    assert_engines_agree("an ellipsoid about the camera", &even(lens, LIGHTS));
    let slab = "slab = { bottom = -1, top = 0.1 }
        mu_s = [0.5, 1, 2]
        mu_a = [0.05, 0.1, 0.02]";
    assert_engines_agree("a slab", &even(slab, LIGHTS));
    let fog = format!("{HEAD}\n[medium]\nmu_s = [0.1, 0.2, 0.4]\nmu_a = [0.02, 0.1, 0.05]\n{LIGHTS}");
    assert_engines_agree("fog", &scene(&fog));
}

/// Bands of wavelengths, in which milk is as it is in RGB: the engine has to take them from the spectra.
#[test]
fn bands_of_wavelengths() {
    let bands = format!(
        "camera = {{ position = [0.3, 0.2, 4], target = [0, 0, 0], vertical_fov = 34 }}
         film = {{ resolution = [24, 24], bands = [630, 540, 460] }}
         render = {{ mode = \"spectral\" }}
         [[volume]]
         {MILK}
         {LIGHTS}"
    );
    assert_engines_agree("bands", &scene(&bands));
}

/// White media a hundred times as dense in blue as in red, with or without phase functions that differ, in light of
/// radiance 1: every channel is 1. The balance heuristic's weights enter at every flight and turn, and a factor that is
/// wrong anywhere, or missing, moves the mean of some channel by far more than the errors here, of a per mille.
#[test]
fn white_media_stay_white_in_every_channel() {
    let sphere = "sphere = { center = [0, 0.1, 0], radius = 1 }\nmu_t = 1\nalbedo = 1";
    let slab =
        "slab = { bottom = -0.5, top = 0.5 }\nmu_t = 1\nalbedo = 1\nphase = { type = \"hg\", g = 0.7 }";
    let light = "[[light]]\ntype = \"constant\"\nradiance = 1";
    for (name, volume, g) in
        [("sphere", sphere, Some([-0.5, 0.0, 0.9])), ("slab", slab, None), ("red and blue", sphere, None)]
    {
        let white = chromatic(even(volume, light), DVec3::new(0.1, 1.0, 10.0), g);
        let film = render(&white, Integrator::Fast, 53, 0..if is_full() { 2048 } else { 256 });
        for estimate in film.image_mean() {
            let (mean, error) = (estimate.mean, estimate.standard_error);
            let z = (mean - 1.0) / error.max(1e-6);
            eprintln!("{name}: {mean} +- {error}, z = {z}");
            assert!(z.abs() < two_sided_quantile(1e-4), "{name}: {mean} +- {error}, z = {z}");
            assert!(error < 0.003, "{name}: {error} says nothing");
        }
    }
}

/// Slabs of three media each, under even light: what they reflect and what they let through, together.
#[test]
fn slabs_of_three_media_send_out_what_adding_doubling_says_of_each() {
    let rows = rows();
    let third = rows.len() / 3;
    let triples = if is_full() { third } else { 20 };
    let limit = two_sided_quantile(1e-3 / (3 * triples) as f64);
    let mut scores = Vec::new();
    for triple in 0..triples {
        let first = triple * third / triples;
        let row = |channel: usize| &rows[(first * (channel + 1) + channel * third) % rows.len()];
        let channels = |value: fn(&Row) -> f64| DVec3::new(value(row(0)), value(row(1)), value(row(2)));
        let mut slab = scene(
            "camera = { position = [0, 1, 0], target = [0, 0, 0], up = [0, 0, 1], vertical_fov = 1e-6 }
             film = { resolution = [16, 16] }
             [[volume]]
             slab = { bottom = -2, top = 0 }
             mu_t = 1
             albedo = 1
             [[light]]
             type = \"constant\"
             radiance = 1",
        );
        slab.volumes[0].medium.albedo = channels(|row| row.albedo);
        let slab = chromatic(slab, channels(|row| 0.5 * row.tau), Some([row(0).g, row(1).g, row(2).g]));
        let film = render(&slab, Integrator::Fast, 54, 0..if is_full() { 128 } else { 16 });
        for (channel, estimate) in film.image_mean().into_iter().enumerate() {
            let Row { albedo, tau, g, truth } = row(channel);
            let truth = truth[0][0] + truth[0][1];
            let (mean, error) = (estimate.mean, estimate.standard_error.max(2e-6));
            let z = (mean - truth) / error;
            assert!(
                z.abs() < limit,
                "albedo {albedo} tau {tau} g {g}: {mean} +- {error}, not {truth}, z = {z}"
            );
            scores.push(z);
        }
    }
    let p = kolmogorov_smirnov(&scores, normal_cdf);
    eprintln!("{} z scores: Kolmogorov-Smirnov p = {p}", scores.len());
    assert!(p > 1e-3, "z scores do not follow the normal law: p = {p} {scores:?}");
}

#[test]
fn threads_and_passes_change_no_bit() {
    let mut milk = even(MILK, LIGHTS);
    milk.resolution = [150, 90];
    let film = |threads, passes: &[[u64; 2]]| {
        let mut film = Film::new(150, 90, Layers::ALL).expect("a small picture");
        let options = RenderOptions { threads, ..options(Integrator::Fast, 7) };
        for &[start, end] in passes {
            add_pass(&milk, &mut film, start..end, options);
        }
        film
    };
    let whole = film(1, &[[0, 8]]);
    assert!(whole == film(3, &[[0, 8]]), "three threads");
    assert!(whole == film(2, &[[5, 8], [0, 5]]), "two passes in the other order");
    assert!(whole != film(1, &[[1, 9]]), "other samples are other pictures");
}

#[test]
fn scenes_of_other_kinds_go_to_the_integrator_in_f64() {
    let milk = || even(MILK, LIGHTS);
    assert!(knows(&milk()));
    let mut glowing = milk();
    glowing.volumes[0].medium.emission = DVec3::ONE;
    let mut two = milk();
    two.volumes.push(two.volumes[0].clone());
    let mut droplets = milk();
    droplets.volumes[0].medium.phase_function = tyndall_optics::PhaseFunction::Rayleigh;
    let atmosphere = even(
        "atmosphere = { bottom = -1, top = 1, scale_height = 0.5 }\nmu_s = [1, 2, 3]\nmu_a = 0.1",
        LIGHTS,
    );
    let image = even(MILK, "[[light]]\ntype = \"sky\"\nsun_elevation = 30\nsun_azimuth = 0");
    let floor = even(
        MILK,
        &format!(
            "{LIGHTS}\n[[shape]]\nplane = {{ point = [0, -1, 0], normal = [0, 1, 0] }}\nmaterial = {{ type = \"diffuse\" }}"
        ),
    );
    // What f32 cannot hold the squares of.
    let dense = chromatic(milk(), DVec3::new(1e30, 1.0, 1.0), None);
    let mut far = even(MILK, "[[light]]\ntype = \"point\"\nposition = [0, 1, 0]\nintensity = 1");
    far.lights[0] = Light::Point(PointLight::new(DVec3::Y * 1e20, DVec3::splat(1e30)));
    let others =
        [dense, far, glowing, two, droplets, atmosphere, image, floor, chromatic(crowd(), DVec3::ONE, None)];
    for (number, other) in others.iter().enumerate() {
        assert!(!knows(other), "scene {number}");
    }
}
