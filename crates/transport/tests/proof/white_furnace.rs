//! The white furnace: where nothing absorbs and light comes evenly from everywhere, everything looks the same.
//!
//! With albedo 1 and radiance 1 all around, L = 1 solves the volume rendering equation for any density and any phase
//! function. Without next-event estimation each path carries exactly 1; with it, only the mean is 1, and every
//! factor of it (transmittance, phase function, densities, weights) must be right.

use tyndall_film::Estimate;
use tyndall_scene::Scene;
use tyndall_scene::description::{ImageFilter, Integrator};

use crate::effort::is_full;
use crate::rendering::{BOTH, render};
use crate::scenes::{image, scene, scene_in, with_next_event, write_random_npy};
use crate::statistics::two_sided_quantile;

const PHASES: [&str; 4] = [
    r#"{ type = "isotropic" }"#,
    r#"{ type = "hg", g = -0.5 }"#,
    r#"{ type = "hg", g = 0.5 }"#,
    r#"{ type = "hg", g = 0.9 }"#,
];

/// A white volume, seen from `position`, in surroundings of radiance 1.
fn furnace(position: &str, volume: &str, phase: &str) -> String {
    format!(
        "camera = {{ position = {position}, target = [0, 0, 0], vertical_fov = 40 }}
         film = {{ resolution = [20, 20] }}
         [[light]]
         type = \"constant\"
         radiance = 1
         [[volume]]
         {volume}
         albedo = 1
         phase = {phase}"
    )
}

/// The same volumes for each test: shapes thin and thick, a cloud, and a rough grid turned and stretched.
fn furnaces(phase: &str) -> Vec<(&'static str, Scene)> {
    let folder = tempfile::tempdir().expect("a folder for test files");
    write_random_npy(&folder.path().join("random.npy"), [12, 9, 14], 5);
    let mut furnaces = Vec::new();
    let mut add = |name, position, volume: &str| {
        furnaces.push((name, scene_in(folder.path(), &furnace(position, volume, phase))));
    };
    add("sphere", "[0, 0, 4]", "sphere = { center = [0, 0.1, 0], radius = 1 }\n mu_t = 5");
    add("box", "[2, 1, 3]", "box = { min = [-1, -0.5, -0.7], max = [0.9, 0.8, 1] }\n mu_t = 8");
    add("thin slab", "[0, 3, 3]", "slab = { bottom = -0.2, top = 0 }\n mu_t = 2");
    add("thick slab", "[0, 3, 3]", "slab = { bottom = -1, top = 0 }\n mu_t = 30");
    add(
        "cumulus",
        "[0.5, -0.3, 3]",
        "procedural = { type = \"cumulus\", seed = 1, resolution = 48, size = 2 }\n mu_t = 20",
    );
    add(
        "random grid",
        "[0, 0, 3]",
        "file = \"random.npy\"\n mu_t = 10
         transform = { scale = [0.1, 0.16, 0.07], rotate = [20, 35, -50], translate = [-0.6, -0.7, 0.4] }",
    );
    furnaces
}

#[test]
fn every_path_through_a_white_medium_brings_the_light_of_its_surroundings() {
    for phase in PHASES {
        for (name, scene) in furnaces(phase) {
            assert_eq!(scene.light_probabilities, [0.0], "constant light needs no next-event estimation");
            for integrator in BOTH {
                let film = render(&scene, integrator, 1, 0..16);
                for y in 0..20 {
                    for x in 0..20 {
                        for channel in film.mean(x, y) {
                            assert!(
                                (channel - 1.0).abs() < 1e-5,
                                "{name}, {phase}, {integrator:?}: {channel} at {x}, {y}"
                            );
                        }
                    }
                }
                let hits = film.channels().into_iter().find(|channel| channel.name == "A");
                let hits = hits.map_or(0.0, |channel| channel.values.iter().sum::<f32>());
                assert!(hits > 20.0, "{name}: the camera misses the medium");
            }
        }
    }
}

/// Edge in pixels of the regions that are looked at one by one. A single pixel at the rim of a medium holds so few
/// scattered paths that its own standard error is no guide.
const REGION: u32 = 5;

/// Every region within its standard error and the mean of the picture within its own, each at a level of 1e-4 for
/// the picture; and that standard error is small enough to say something.
fn assert_white_on_average(name: &str, scene: &Scene, integrator: Integrator, seed: u64) -> Estimate {
    let samples = if is_full() { 640 } else { 64 };
    let film = render(scene, integrator, seed, 0..samples);
    let regions = 20 / REGION;
    let limit = two_sided_quantile(1e-4 / f64::from(regions * regions));
    for region in 0..regions * regions {
        let (left, top) = (region % regions * REGION, region / regions * REGION);
        let (mut sum, mut variance) = (0.0, 0.0);
        for (x, y) in (0..REGION * REGION).map(|i| (left + i % REGION, top + i / REGION)) {
            sum += film.mean(x, y)[0] - 1.0;
            variance += film.standard_error(x, y)[0].powi(2);
        }
        let (off, error) = (sum.abs(), variance.sqrt());
        // Where no path met the medium there is no error; f32 rounds in the sixth place.
        assert!(off < limit * error + 1e-4, "{name}, {integrator:?}: {sum} +- {error} at {left}, {top}");
    }
    let [mean, ..] = film.image_mean();
    let z = (mean.mean - 1.0) / mean.standard_error;
    assert!(z.abs() < two_sided_quantile(1e-4), "{name}, {integrator:?}: the mean is {mean:?}, z = {z}");
    assert!(mean.standard_error < 6e-3, "{name}, {integrator:?}: {mean:?} says nothing");
    mean
}

/// The mean of all pictures together, which shows an error that each alone would hide; at a level of 1e-4.
fn assert_white_together(means: &[Estimate], integrator: Integrator) {
    let off: f64 = means.iter().map(|mean| mean.mean - 1.0).sum();
    let error = means.iter().map(|mean| mean.standard_error.powi(2)).sum::<f64>().sqrt();
    eprintln!("{integrator:?}: off by {} +- {}", off / means.len() as f64, error / means.len() as f64);
    assert!((off / error).abs() < two_sided_quantile(1e-4), "{integrator:?}: {off} +- {error}");
    assert!(error < 1e-3 * means.len() as f64, "{integrator:?}: {off} +- {error} says nothing");
}

#[test]
fn next_event_estimation_and_its_weights_keep_a_white_medium_white() {
    let all: Vec<(String, Scene)> = PHASES
        .into_iter()
        .flat_map(|phase| {
            furnaces(phase).into_iter().map(move |(name, scene)| (format!("{name}, {phase}"), scene))
        })
        .map(|(name, scene)| (name, with_next_event(scene, &[1.0])))
        .collect();
    for integrator in BOTH {
        // Each with a seed of its own, so that their errors are independent.
        let means: Vec<Estimate> = (1000..)
            .zip(&all)
            .map(|(seed, (name, scene))| assert_white_on_average(name, scene, integrator, seed))
            .collect();
        assert_white_together(&means, integrator);
    }
}

/// The light comes as a constant and as two pictures that add up to an even one; each is drawn with another
/// probability.
#[test]
fn lights_that_add_up_to_an_even_one_keep_a_white_medium_white() {
    let [r, s] = [[0.25_f32; 3], [0.0; 3]];
    let checks = vec![r, s, r, s, s, r, s, r];
    let others = checks.iter().map(|texel| texel.map(|x| 0.25 - x)).collect();
    for filter in [ImageFilter::Nearest, ImageFilter::Bilinear] {
        let mut scene = scene(&furnace(
            "[0, 0, 4]",
            "sphere = { center = [0, 0, 0], radius = 1 }\n mu_t = 5",
            r#"{ type = "hg", g = 0.5 }"#,
        ));
        let rest = image(vec![[0.75; 3]; 8], filter);
        scene.lights = vec![image(checks.clone(), filter), rest, image(Vec::clone(&others), filter)];
        let scene = with_next_event(scene, &[0.2, 0.3, 0.5]);
        for integrator in BOTH {
            assert_white_on_average(&format!("{filter:?}"), &scene, integrator, 2);
        }
    }
}

#[test]
fn paths_end_where_nothing_absorbs_and_nothing_leaves() {
    let endless = scene(
        "camera = { position = [0, 0, 0], direction = [0, 0, -1] }
         film = { resolution = [3, 3] }
         medium = { mu_t = 1, albedo = 1 }
         [[light]]
         type = \"constant\"
         radiance = 1",
    );
    let chromatic = crate::chromatic::chromatic(endless.clone(), glam::DVec3::new(1.0, 2.0, 3.0), None);
    for (scene, integrator) in [(&endless, BOTH[0]), (&endless, BOTH[1]), (&chromatic, BOTH[0])] {
        let film = render(scene, integrator, 1, 0..1);
        assert_eq!(film.rejected(), 0);
    }
}
