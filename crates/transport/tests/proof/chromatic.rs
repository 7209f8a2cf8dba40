//! Media whose extinction and phase function depend on colour: each channel is what a grey medium of its own would be.
//!
//! The spectral integrator draws one path for all channels, so what is to be shown is that its weights are right, however
//! far apart the channels are, and that they stay bounded.

use std::sync::Arc;

use glam::DVec3;
use tyndall_film::Film;
use tyndall_optics::PhaseFunction;
use tyndall_scene::description::Integrator;
use tyndall_scene::{Channels, ChromaticMedium, Ray, Scene};
use tyndall_transport::SpectralScene;

use crate::agreement::{Batches, HEAD, assert_same, assert_same_batches, batches};
use crate::effort::is_full;
use crate::fresh;
use crate::rendering::render;
use crate::scenes::{scene, scene_in, two_halves, with_next_event, write_random_npy};
use crate::slab::{Row, rows};
use crate::statistics::{confirmed, kolmogorov_smirnov, mean_and_error, normal_cdf, two_sided_quantile};

/// Batches of pictures of the crowd.
pub const BATCHES: u64 = 16;

/// The scene with the extinction of each volume multiplied by `factors` in red, green and blue, and phase functions of
/// mean cosine `g` in all volumes if there are any.
pub fn chromatic(mut scene: Scene, factors: DVec3, g: Option<[f64; 3]>) -> Scene {
    for volume in &mut scene.volumes {
        let medium = &mut volume.medium;
        let phase_functions = g.map(|g| g.map(|g| PhaseFunction::HenyeyGreenstein { g }));
        medium.chromatic = Some(Arc::new(ChromaticMedium { mu_t: medium.mu_t * factors, phase_functions }));
    }
    scene
}

/// The grey scene that [`chromatic`] is in one of its channels.
fn grey(mut scene: Scene, factors: DVec3, g: Option<[f64; 3]>, channel: usize) -> Scene {
    for volume in &mut scene.volumes {
        volume.medium.mu_t *= factors[channel];
        if let Some(g) = g {
            volume.medium.phase_function = PhaseFunction::HenyeyGreenstein { g: g[channel] };
        }
    }
    scene.volumes.retain(|volume| volume.medium.mu_t > 0.0);
    scene
}

/// Rough grids and shapes that overlap and glow, under a lamp, a bright patch of sky and an even light.
pub fn crowd() -> Scene {
    let folder = tempfile::tempdir().expect("a folder for test files");
    write_random_npy(&folder.path().join("random.npy"), [16, 16, 16], 21);
    let mut crowd = scene_in(
        folder.path(),
        &format!(
            r#"{HEAD}
            [medium]
            mu_t = 0.1
            albedo = [0.9, 0.8, 0.6]
            emission = [0.02, 0.01, 0.03]
            [[volume]]
            file = "random.npy"
            mu_t = 4
            albedo = [0.9, 0.6, 0.95]
            phase = {{ type = "hg", g = 0.6 }}
            transform = {{ scale = [0.11, 0.08, 0.1], rotate = [15, 40, -20], translate = [-1, -0.5, -0.4] }}
            [[volume]]
            file = "random.npy"
            mu_t = 2
            albedo = [0.2, 1, 0.8]
            emission = [0.5, 0.2, 0.1]
            transform = {{ scale = 0.1, translate = [-0.4, -0.9, -0.8] }}
            [[volume]]
            sphere = {{ center = [0, 0.2, 0.3], radius = 0.6 }}
            mu_t = 1.5
            albedo = 0.7
            emission = [0.1, 0.3, 0.6]
            [[light]]
            type = "point"
            position = [1.5, 2, 1.5]
            intensity = [8, 7, 6]
            [[light]]
            type = "constant"
            radiance = [0.05, 0.1, 0.15]
            "#
        ),
    );
    let mut texels = vec![[0.1_f32, 0.2, 0.3]; 8];
    texels[5] = [5.0, 3.0, 1.0];
    crowd.lights.push(crate::scenes::image(texels, tyndall_scene::description::ImageFilter::Bilinear));
    // The two in the middle are the volumes that glow.
    with_next_event(crowd, &[0.3, 0.1, 0.1, 0.1, 0.4])
}

#[test]
fn grey_media_look_the_same_by_the_spectral_integrator_and_by_the_reference() {
    let as_chromatic = chromatic(crowd(), DVec3::ONE, None);
    let spectral = batches(&as_chromatic, Integrator::Fast, 31, BATCHES);
    let reference = batches(&crowd(), Integrator::Reference, 32, BATCHES);
    assert_same_batches("grey", [Integrator::Fast, Integrator::Reference], &[spectral, reference]);
}

#[test]
fn each_channel_of_chromatic_media_is_what_a_grey_medium_would_be() {
    let factors = DVec3::new(0.3, 3.0, 1.0);
    let g = Some([0.7, -0.3, 0.0]);
    let all = batches(&chromatic(crowd(), factors, g), Integrator::Fast, 33, BATCHES);
    for (channel, colour) in ["R", "G", "B"].into_iter().enumerate() {
        let alone = grey(crowd(), factors, g, channel);
        let alone = batches(&alone, Integrator::Reference, 34 + channel as u64, BATCHES);
        // Coverage, depth and albedo are those of all channels together.
        let in_colour = |batches: &Batches| -> Batches {
            let mut batches = batches.clone();
            batches.retain(|(quantity, _)| {
                let layer = quantity.split(" at").next().unwrap_or_default();
                layer == colour
                    || ["Emission.", "Single.", "Multiple."]
                        .iter()
                        .any(|kept| *layer == format!("{kept}{colour}"))
            });
            assert_eq!(batches.len(), 4 * 9);
            batches
        };
        let pair = [in_colour(&all), in_colour(&alone)];
        assert_same_batches(&format!("channel {colour}"), [Integrator::Fast, Integrator::Reference], &pair);
    }
}

/// A slab whose channels are three rows of the table, seen along the normal.
fn slab(rows: &[Row], lit_from_above: bool, next_event: bool) -> Scene {
    let mut slab = scene(
        "camera = { position = [0, 1, 0], target = [0, 0, 0], up = [0, 0, 1], vertical_fov = 1e-6 }
         film = { resolution = [1, 1] }
         [[volume]]
         slab = { bottom = -2, top = 0 }
         mu_t = 1
         albedo = 1",
    );
    let channels = |value: fn(&Row) -> f64| DVec3::new(value(&rows[0]), value(&rows[1]), value(&rows[2]));
    slab.volumes[0].medium.albedo = channels(|row| row.albedo);
    let slab = chromatic(slab, channels(|row| 0.5 * row.tau), Some([0, 1, 2].map(|channel| rows[channel].g)));
    let (lit, dark) = ([1.0; 3], [0.0; 3]);
    let light = if lit_from_above { two_halves(lit, dark) } else { two_halves(dark, lit) };
    let slab = Scene { lights: vec![light], ..slab };
    with_next_event(slab, &[f64::from(u8::from(next_event))])
}

/// Each triple of rows with those a third and two thirds of the table further on, which are quite different media. For
/// other seeds one in a thousand runs would fail by the law of the z scores, and few by a single score.
#[test]
fn a_slab_of_three_media_reflects_and_transmits_what_adding_doubling_says_of_each() {
    let paths: u64 = if is_full() { 32_768 } else { 2048 };
    let rows = rows();
    let third = rows.len() / 3;
    let mut scores: [Vec<f64>; 6] = Default::default();
    for first in 0..third {
        let triple: Vec<Row> = [0, 1, 2]
            .map(|channel| {
                // Another order in each triple, so that all differences of extinction occur.
                let Row { albedo, tau, g, truth } =
                    rows[(first * (channel + 1) + channel * third) % rows.len()];
                Row { albedo, tau, g, truth }
            })
            .into();
        for from_above in [true, false] {
            let scene = slab(&triple, from_above, first % 2 == 0);
            let spectral = SpectralScene::new(&scene, Channels::Rgb);
            let truths = [0, 1, 2].map(|channel| triple[channel].truth[0][usize::from(!from_above)]);
            // With few paths that bring anything their own spread is no guide; at most they bring 3 each.
            let is_normal = |channel: usize| truths[channel] * paths as f64 > 300.0;
            let found = |times: u64, seed: u64| {
                let paths = times * paths;
                let mut values: [Vec<f64>; 3] = Default::default();
                for path in 0..paths {
                    let mut random = fresh::random(41 + u64::from(from_above) + seed, first as u64, path);
                    let ray = Ray { origin: DVec3::Y, direction: DVec3::NEG_Y };
                    let sample = spectral.trace(ray, &mut random);
                    for (values, value) in values.iter_mut().zip(sample.radiance) {
                        values.push(value.into());
                    }
                }
                [0, 1, 2].map(|channel| {
                    let (mean, error) = mean_and_error(&values[channel]);
                    let (truth, paths) = (truths[channel], paths as f64);
                    let floor =
                        if is_normal(channel) { 0.0 } else { (3.0 * truth / paths).sqrt().max(3.0 / paths) };
                    (mean, error, (mean - truth) / error.max(floor))
                })
            };
            // What few paths bring, 3 each, sets mean and spread together: by too few of them both are small.
            let means = confirmed(found(1, 0), |means| means.map(|(.., z)| z), found);
            for (channel, ((mean, error, z), Row { albedo, tau, g, .. })) in
                means.into_iter().zip(&triple).enumerate()
            {
                let truth = truths[channel];
                assert!(
                    z.abs() < 4.2,
                    "albedo {albedo} tau {tau} g {g} from above {from_above}: {mean} +- {error}, not {truth}, z = {z}"
                );
                if is_normal(channel) {
                    scores[channel + 3 * usize::from(from_above)].push(z);
                }
            }
        }
    }
    for z in &scores {
        let p = kolmogorov_smirnov(z, normal_cdf);
        eprintln!("{} z scores: Kolmogorov-Smirnov p = {p}", z.len());
        assert!(z.len() > 15 && p > 1e-3 / 6.0, "z scores do not follow the normal law: p = {p} {z:?}");
    }
}

/// White media a hundred times as dense in blue as in red, of three phase functions, in light of radiance 1.
fn furnaces() -> [(&'static str, Scene); 2] {
    let folder = tempfile::tempdir().expect("a folder for test files");
    write_random_npy(&folder.path().join("random.npy"), [12, 9, 14], 5);
    let furnace = |volume: &str| {
        let text = format!(
            "camera = {{ position = [0, 0, 3], target = [0, 0, 0], vertical_fov = 30 }}
             film = {{ resolution = [20, 20] }}
             [[light]]
             type = \"constant\"
             radiance = 1
             [[volume]]
             {volume}
             albedo = 1"
        );
        chromatic(scene_in(folder.path(), &text), DVec3::new(0.1, 1.0, 10.0), Some([-0.5, 0.0, 0.9]))
    };
    // Thick enough that rays out of it have null collisions, on which the weights depend.
    let grid = "file = \"random.npy\"
        mu_t = 3
        transform = { scale = [0.1, 0.16, 0.07], rotate = [20, 35, -50], translate = [-0.6, -0.7, 0.4] }";
    [
        ("sphere", furnace("sphere = { center = [0, 0.1, 0], radius = 1 }\n mu_t = 1")),
        ("rough grid", furnace(grid)),
    ]
}

/// Mean of a film in each channel with its standard error, and those of its pixels' mean over the channels.
fn image_means(film: &Film) -> [(f64, f64); 3] {
    film.image_mean().map(|estimate| (estimate.mean, estimate.standard_error))
}

/// Without next-event estimation the weights of a path have the mean 1 over the channels, path by path; each by itself
/// is 1 on average, at a level of 1e-4 for each picture and channel.
#[test]
fn white_media_of_any_colour_of_extinction_stay_white() {
    for (name, scene) in furnaces() {
        let spectral = SpectralScene::new(&scene, Channels::Rgb);
        for path in 0..2000 {
            let mut random = fresh::random(3, 0, path);
            let ray = scene.camera.ray([10, 10], [0.5, 0.5], [0.5, 0.5]);
            let sum: f32 = spectral.trace(ray, &mut random).radiance.iter().sum();
            assert!((sum - 3.0).abs() < 1e-4, "{name}: {sum}");
        }
        for probability in [0.0, 1.0] {
            let scene = with_next_event(scene.clone(), &[probability]);
            let film = render(&scene, Integrator::Fast, 5, 0..512);
            for (mean, error) in image_means(&film) {
                let z = (mean - 1.0) / error;
                eprintln!("{name}, next event {probability}: {mean} +- {error}, z = {z}");
                assert!(z.abs() < two_sided_quantile(1e-4), "{name}: {mean} +- {error}, z = {z}");
                assert!(error < 0.005, "{name}: {error} says nothing");
            }
        }
    }
}

#[test]
fn paths_alone_and_paths_joined_by_next_event_estimation_bring_the_same() {
    let texels = [[0.1_f32, 0.2, 0.3], [2.0, 3.0, 1.0], [0.0; 3], [0.5; 3]].repeat(2);
    for (name, mut scene) in furnaces() {
        scene.resolution = [24, 24];
        scene.volumes[0].medium.albedo = DVec3::new(1.0, 0.9, 0.95);
        scene.lights =
            vec![crate::scenes::image(texels.clone(), tyndall_scene::description::ImageFilter::Bilinear)];
        let [paths, joined] = [0.0, 1.0].map(|share| with_next_event(scene.clone(), &[share]));
        assert_same(name, (&paths, Integrator::Fast), (&joined, Integrator::Fast));
    }
}

/// Where red meets nothing and green and blue are a hundred times apart, with albedos of 1 and 0: what red sees is the
/// background, and what green sees behind black fog is its transmittance.
#[test]
fn channels_without_extinction_or_without_scattering_are_exact_on_average() {
    let mut fog = scene(
        "camera = { position = [0, 0, 3], target = [0, 0, 0], vertical_fov = 40 }
         film = { resolution = [4, 4] }
         [[light]]
         type = \"constant\"
         radiance = [0.5, 2, 3]
         [[volume]]
         slab = { bottom = -5, top = 5 }
         mu_t = 1
         albedo = 1
         [[volume]]
         box = { min = [-9, -9, 1], max = [9, 9, 2] }
         mu_t = 2
         albedo = 1",
    );
    fog.volumes[0].density =
        tyndall_scene::Density::Box { min: DVec3::splat(-9.0), max: DVec3::new(9.0, 9.0, 0.0) };
    for volume in &mut fog.volumes {
        volume.medium.albedo = DVec3::new(1.0, 0.0, 1.0);
    }
    let fog = chromatic(fog, DVec3::new(0.0, 0.01, 1.0), None);
    let spectral = SpectralScene::new(&fog, Channels::Rgb);
    let ray = Ray { origin: DVec3::new(0.0, 0.0, 3.0), direction: DVec3::NEG_Z };
    let mut values: [Vec<f64>; 3] = Default::default();
    for path in 0..20_000 {
        let sample = spectral.trace(ray, &mut fresh::random(5, 0, path));
        values.iter_mut().zip(sample.radiance).for_each(|(values, value)| values.push(value.into()));
    }
    let truth = [0.5, 2.0 * (-0.01_f64 * (2.0 + 9.0)).exp(), 3.0];
    for (values, truth) in values.iter().zip(truth) {
        let (mean, error) = mean_and_error(values);
        let z = (mean - truth) / error;
        assert!(z.abs() < two_sided_quantile(1e-3), "{mean} +- {error}, not {truth}");
        assert!(error < 0.02 * truth, "{error} says nothing");
    }
}

/// The second moment of a channel is at most n times what it would be if that channel were always the hero, whatever the
/// others are, since p is at least p_c/n. A heavy tail would break that bound, with its 5 standard errors, by far.
#[test]
fn channels_a_hundred_times_apart_make_no_outliers() {
    let factors = DVec3::new(0.1, 1.0, 10.0);
    let g = Some([0.9, 0.0, -0.5]);
    let mut crowd = crowd();
    crowd.set_light_probabilities(vec![0.0; 5]);
    crowd.lights.remove(0);
    let moments = |scene: &Scene| {
        let spectral = SpectralScene::new(scene, Channels::Rgb);
        let mut squares: [Vec<f64>; 3] = Default::default();
        for path in 0..20_000 {
            let mut random = fresh::random(6, 0, path);
            let ray = scene.camera.ray([12, 12], [random.f64(), random.f64()], [0.5, 0.5]);
            let radiance = spectral.trace(ray, &mut random).radiance;
            squares.iter_mut().zip(radiance).for_each(|(squares, x)| squares.push(f64::from(x).powi(2)));
        }
        squares.map(|squares| mean_and_error(&squares))
    };
    let together = moments(&chromatic(crowd.clone(), factors, g));
    for (channel, (second, error)) in together.into_iter().enumerate() {
        let alone = moments(&grey(crowd.clone(), factors, g, channel))[channel];
        eprintln!("channel {channel}: {second} +- {error} together, {} +- {} alone", alone.0, alone.1);
        assert!(second < 3.0 * alone.0 + 5.0 * (error + 3.0 * alone.1), "channel {channel}");
    }
}
