//! The two integrators, which share nothing but the scene, estimate the same picture: light, layers and all.
//!
//! Each renders the same scene in independent batches. Every quantity of the film is averaged over regions of 8x8
//! pixels, and the batches' means are compared by Welch's t test, whose level is 1e-3 for each scene, shared out
//! among all its regions and quantities (Bonferroni).

use glam::DVec3;
use std::path::Path;
use std::sync::Arc;
use tyndall_film::Film;
use tyndall_scene::description::Integrator;
use tyndall_scene::{Density, Scene};
use tyndall_transport::RenderOptions;
use tyndall_volumes::{BrickGrid, LEAF_VOXELS, Leaf, Storage, Tree};

use crate::rendering::{options, render_with};
use crate::scenes::{scene, scene_in, write_npy, write_random_npy};
use crate::statistics::{mean_and_error, normal_from_student, two_sided_quantile};

/// Columns and rows of the pictures, and the edge of a region.
const EDGE: u32 = 24;
const REGION: u32 = 8;
/// Independent films of each integrator, and samples of every pixel in each.
const BATCHES: u64 = 40;
const SAMPLES: u64 = 6;

pub const HEAD: &str = "camera = { position = [0.3, 0.2, 4], target = [0, 0, 0], vertical_fov = 34 }
    film = { resolution = [24, 24] }\n";

/// Means over each region of each quantity that a film holds, in a fixed order, with their names.
fn region_means(film: &Film) -> Vec<(String, f64)> {
    let channels = film.channels();
    let coverage = channels.iter().find(|channel| channel.name == "A").expect("coverage is always kept");
    let mut means = Vec::new();
    for channel in &channels {
        if channel.name.starts_with("StandardError") || ["A", "SampleCount"].contains(&&*channel.name) {
            continue;
        }
        // Depth and albedo are means over the paths that met a medium; times their number they are linear.
        let is_of_hits = channel.name.starts_with("Depth") || channel.name.starts_with("Albedo");
        for top in (0..EDGE).step_by(REGION as usize) {
            for left in (0..EDGE).step_by(REGION as usize) {
                let mut sum = 0.0;
                for i in 0..REGION * REGION {
                    let pixel = ((top + i / REGION) * EDGE + left + i % REGION) as usize;
                    let hits = f64::from(coverage.values[pixel]);
                    let value = f64::from(channel.values[pixel]);
                    sum += match (is_of_hits, hits > 0.0) {
                        (false, _) => value,
                        (true, true) => value * hits,
                        (true, false) => 0.0,
                    };
                }
                let mean = sum / f64::from(REGION * REGION);
                means.push((format!("{} at {left}, {top}", channel.name), mean));
            }
        }
    }
    means
}

/// For each region and quantity its name and its values in all batches.
pub type Batches = Vec<(String, Vec<f64>)>;

/// The values in `count` batches.
pub fn batches(scene: &Scene, integrator: Integrator, seed: u64, count: u64) -> Batches {
    batches_with(scene, options(integrator, seed), count)
}

/// The same with any options.
pub fn batches_with(scene: &Scene, options: RenderOptions, count: u64) -> Batches {
    batches_of((0..count).map(|batch| render_with(scene, options, batch * SAMPLES..(batch + 1) * SAMPLES)))
}

/// The values of independent films of [`EDGE`] pixels each way.
pub fn batches_of(films: impl Iterator<Item = Film>) -> Batches {
    let mut all: Batches = Vec::new();
    for film in films {
        let means = region_means(&film);
        if all.is_empty() {
            all = means.iter().map(|(name, _)| (name.clone(), Vec::new())).collect();
        }
        for ((_, values), (_, mean)) in all.iter_mut().zip(means) {
            values.push(mean);
        }
    }
    all
}

/// Fails if any region of any quantity differs significantly.
pub fn assert_same(name: &str, first: (&Scene, Integrator), second: (&Scene, Integrator)) {
    let batches = [batches(first.0, first.1, 31, BATCHES), batches(second.0, second.1, 32, BATCHES)];
    assert_same_batches(name, [first.1, second.1], &batches);
}

/// Fails if any region of any quantity differs significantly between the batches of two integrators.
pub fn assert_same_batches(name: &str, integrators: [Integrator; 2], batches: &[Batches; 2]) {
    let verdict = difference(1e-3, name, integrators, batches);
    let share = verdict.unwrap_or_else(|difference| panic!("{difference}"));
    assert!(share * 3.0 > 1.0, "{name}: only {share} of all quantities are lit");
}

/// The share of quantities that are lit, if no region of any differs at this `level`, shared out among them all.
///
/// # Errors
/// The first that does.
pub fn difference(
    level: f64,
    name: &str,
    integrators: [Integrator; 2],
    [a, b]: &[Batches; 2],
) -> Result<f64, String> {
    let limit = two_sided_quantile(level / a.len() as f64);
    let mut lit = 0;
    let mut worst: f64 = 0.0;
    for ((quantity, a), (_, b)) in a.iter().zip(b) {
        let ((mean_a, error_a), (mean_b, error_b)) = (mean_and_error(a), mean_and_error(b));
        lit += usize::from(mean_a > 0.0 && error_a > 0.0);
        let (va, vb) = (error_a * error_a, error_b * error_b);
        let difference = mean_a - mean_b;
        // What f32 rounds, where there is next to no noise.
        let error = (va + vb).sqrt().max(1e-6 * mean_a.abs());
        if difference == 0.0 {
            continue;
        }
        let degrees = (va + vb).powi(2) / (va * va + vb * vb).max(f64::MIN_POSITIVE) * (a.len() - 1) as f64;
        let z = normal_from_student(difference / error, degrees.max(1.0));
        worst = worst.max(z.abs());
        if z.abs() >= limit {
            let [first, second] = integrators;
            return Err(format!(
                "{name}: {quantity}: {first:?} has {mean_a} +- {error_a}, {second:?} {mean_b} +- {error_b}, z = {z}",
            ));
        }
    }
    eprintln!("{name}: {lit} of {} quantities are lit, greatest |z| {worst:.2} below {limit:.2}", a.len());
    Ok(lit as f64 / a.len() as f64)
}

fn assert_integrators_agree(name: &str, scene: &Scene) {
    assert_same(name, (scene, Integrator::Reference), (scene, Integrator::Fast));
}

const DEPTHS: [Option<u32>; 3] = [Some(1), Some(2), None];

#[test]
fn a_cloud_under_sun_and_sky() {
    let mut cloud = scene(&format!(
        r#"{HEAD}
        [[volume]]
        procedural = {{ type = "cumulus", seed = 1, resolution = 48, size = 2.4 }}
        mu_t = 12
        albedo = [1, 0.98, 0.9]
        phase = {{ type = "hg", g = 0.7 }}
        [[light]]
        type = "sky"
        sun_elevation = 35
        sun_azimuth = 250
        "#
    ));
    for max_depth in DEPTHS {
        cloud.max_depth = max_depth;
        assert_integrators_agree(&format!("cloud to depth {max_depth:?}"), &cloud);
    }
}

/// Oriented particles have another extinction along each ray, in a grid and in a shape; the fog's peak is sharp.
#[test]
fn oriented_particles_beside_fog() {
    let folder = tempfile::tempdir().expect("a folder for test files");
    write_random_npy(&folder.path().join("random.npy"), [16, 16, 16], 23);
    let scene = scene_in(
        folder.path(),
        &format!(
            r#"{HEAD}
            [[volume]]
            file = "random.npy"
            mu_t = 6
            albedo = [1, 0.9, 0.8]
            phase = {{ type = "sggx", kind = "fibre", roughness = 0.2, axis = [1, 0.5, 0.2] }}
            transform = {{ scale = 0.09, translate = [-1.1, -0.7, -0.7] }}
            [[volume]]
            sphere = {{ center = [0.5, 0, 0], radius = 0.8 }}
            mu_t = 2
            albedo = 0.95
            phase = {{ type = "sggx", kind = "surface", roughness = 0.3, axis = [0, 1, 0] }}
            [[volume]]
            sphere = {{ center = [0, -0.5, 0.2], radius = 0.7 }}
            mu_t = 1
            albedo = 1
            phase = {{ type = "fog", droplet_diameter_um = 12 }}
            [[light]]
            type = "distant"
            direction = [-0.4, -1, -0.5]
            irradiance = 2
            [[light]]
            type = "constant"
            radiance = 0.3
            "#
        ),
    );
    assert_integrators_agree("oriented particles beside fog", &scene);
}

#[test]
fn voxels_without_a_filter_in_an_atmosphere() {
    let folder = tempfile::tempdir().expect("a folder for test files");
    write_random_npy(&folder.path().join("random.npy"), [6, 6, 6], 22);
    let scene = scene_in(
        folder.path(),
        &format!(
            r#"{HEAD}
            [[volume]]
            file = "random.npy"
            filter = "nearest"
            transform = {{ scale = 0.3, translate = [-0.9, -0.9, -0.9] }}
            mu_t = 3
            albedo = [0.9, 0.6, 0.3]
            [[volume]]
            atmosphere = {{ bottom = -1, scale_height = 0.7 }}
            mu_t = 0.5
            albedo = 0.8
            phase = {{ type = "hg", g = 0.5 }}
            [[light]]
            type = "distant"
            direction = [0.2, 1, 0.4]
            irradiance = 3
            [[light]]
            type = "constant"
            radiance = 0.4
            "#
        ),
    );
    assert_integrators_agree("voxels in an atmosphere", &scene);
}

#[test]
fn overlapping_media_of_different_kinds_that_glow_beside_a_point_light() {
    let folder = tempfile::tempdir().expect("a folder for test files");
    write_random_npy(&folder.path().join("random.npy"), [16, 16, 16], 21);
    let mut crowd = scene_in(
        folder.path(),
        &format!(
            r#"{HEAD}
            [[volume]]
            file = "random.npy"
            mu_t = 4
            albedo = [0.9, 0.6, 0.3]
            phase = {{ type = "hg", g = 0.6 }}
            transform = {{ scale = [0.11, 0.08, 0.1], rotate = [15, 40, -20], translate = [-1, -0.5, -0.4] }}
            [[volume]]
            file = "random.npy"
            mu_t = 2
            albedo = [0.2, 0.5, 0.8]
            phase = {{ type = "hg", g = -0.4 }}
            emission = [0.5, 0.2, 0.1]
            transform = {{ scale = 0.1, translate = [-0.4, -0.9, -0.8] }}
            [[volume]]
            sphere = {{ center = [0, 0.2, 0.3], radius = 0.6 }}
            mu_t = 1.5
            albedo = 0.7
            emission = [0.1, 0.3, 0.6]
            transform = {{ scale = [1, 1.5, 0.8], rotate = [0, 0, 30] }}
            [[volume]]
            box = {{ min = [-0.5, -0.5, -0.5], max = [0.7, 0.1, 0.2] }}
            mu_t = 3
            albedo = 0.99
            phase = {{ type = "hg", g = 0.9 }}
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
    for max_depth in DEPTHS {
        crowd.max_depth = max_depth;
        assert_integrators_agree(&format!("crowd to depth {max_depth:?}"), &crowd);
    }
}

#[test]
fn a_sphere_and_a_cloud_in_fog() {
    let fog = scene(&format!(
        r#"{HEAD}
        [medium]
        mu_t = 0.15
        albedo = [0.9, 0.8, 0.6]
        phase = {{ type = "hg", g = 0.3 }}
        emission = [0.02, 0.01, 0.03]
        [[volume]]
        sphere = {{ center = [-0.5, 0, 0], radius = 0.5 }}
        mu_t = 4
        albedo = 0.8
        [[volume]]
        procedural = {{ type = "cumulus", seed = 4, resolution = 32, size = 2, center = [0.5, 0, 0] }}
        mu_t = 6
        albedo = 0.9
        [[light]]
        type = "point"
        position = [3, 4, 1]
        intensity = 60
        [[light]]
        type = "distant"
        direction = [1, -2, -1]
        irradiance = 3
        "#
    ));
    assert_integrators_agree("fog", &fog);
}

/// Light of all kinds at once, with one bright picture, and a lens.
#[test]
fn many_lights_and_a_lens() {
    let mut lit = scene(&format!(
        r#"camera = {{ position = [0.3, 0.2, 4], target = [0, 0, 0], vertical_fov = 34, aperture_radius = 0.2 }}
        film = {{ resolution = [24, 24] }}
        [[volume]]
        sphere = {{ center = [0, 0, 0], radius = 1 }}
        mu_t = 3
        albedo = [0.95, 0.9, 0.8]
        phase = {{ type = "hg", g = {} }}
        [[light]]
        type = "sun"
        direction = [-1, -1, -1]
        irradiance = [3, 2, 1]
        angular_diameter = 20
        [[light]]
        type = "distant"
        direction = [1, 0, 0.2]
        irradiance = [0.1, 0.2, 1]
        [[light]]
        type = "point"
        position = [0, 2, 0]
        intensity = [1, 2, 1]
        [[light]]
        type = "constant"
        radiance = 0.1
        "#,
        -0.3
    ));
    let mut texels = vec![[0.1_f32, 0.2, 0.3]; 8];
    texels[5] = [5.0, 3.0, 1.0];
    lit.lights.push(crate::scenes::image(texels, tyndall_scene::description::ImageFilter::Bilinear));
    lit.set_light_probabilities(vec![0.3, 0.2, 0.2, 0.0, 0.3]);
    assert_integrators_agree("many lights", &lit);
}

/// A field of both signs among them: what counts as 0 there must be the same for eight voxels mixed and for one drawn.
#[test]
fn grids_in_every_storage_and_of_every_sign() {
    let folder = tempfile::tempdir().expect("a folder for test files");
    let mut random = tyndall_lanes::Random::new(8, 0, 0);
    write_random_npy(&folder.path().join("positive.npy"), [14, 14, 14], 22);
    write_npy(&folder.path().join("signed.npy"), [14, 14, 14], |_| 2.0 * random.f32() - 1.0);
    for (file, mu_t) in [("positive", 3), ("signed", 6)] {
        for storage in ["u8", "f16", "f32"] {
            let scene = grid_scene(folder.path(), file, mu_t, storage);
            assert_integrators_agree(&format!("{file} in {storage}"), &scene);
        }
    }
}

fn grid_scene(folder: &Path, file: &str, mu_t: u32, storage: &str) -> Scene {
    scene_in(
        folder,
        &format!(
            r#"{HEAD}
            [[volume]]
            file = "{file}.npy"
            mu_t = {mu_t}
            storage = "{storage}"
            albedo = [0.9, 0.8, 0.7]
            phase = {{ type = "hg", g = 0.5 }}
            transform = {{ scale = 0.14, translate = [-1, -1, -1] }}
            [[light]]
            type = "distant"
            direction = [-1, -1, -0.5]
            irradiance = 3
            [[light]]
            type = "constant"
            radiance = 0.2
            "#
        ),
    )
}

/// Rays along the axes and in the planes of cell faces, from inside, far from the origin, where single precision leaves
/// nothing of the scene by itself.
#[test]
fn rays_along_the_axes_from_inside_a_grid_far_away() {
    let folder = tempfile::tempdir().expect("a folder for test files");
    write_random_npy(&folder.path().join("random.npy"), [16, 16, 16], 23);
    let [x, y, z] = [3e6, -2e6, 5e6];
    let far = scene_in(
        folder.path(),
        &format!(
            r#"camera = {{ position = [{x}, {y}, {z}], direction = [0, 0, -1], vertical_fov = 1e-4 }}
            film = {{ resolution = [24, 24] }}
            [[volume]]
            file = "random.npy"
            mu_t = 3
            albedo = [0.9, 0.8, 0.7]
            phase = {{ type = "hg", g = 0.3 }}
            transform = {{ scale = 0.125, translate = [{}, {}, {}] }}
            [[light]]
            type = "distant"
            direction = [0, -1, 0]
            irradiance = 3
            [[light]]
            type = "distant"
            direction = [1, 0, 0]
            irradiance = [0.1, 0.3, 1]
            [[light]]
            type = "constant"
            radiance = 0.2
            "#,
            x - 1.0,
            y - 1.0,
            z - 1.5
        ),
    );
    assert_integrators_agree("far away", &far);
}

/// A grid of ones on a ground of ones is cut at the faces of its active voxels, so that it is the very same body as
/// a box; but every sampler goes another way through it.
#[test]
fn a_box_as_a_shape_and_as_a_grid_of_ones() {
    let as_box = scene(&format!(
        r#"{HEAD}
        [[volume]]
        box = {{ min = [-0.5, -0.5, -0.5], max = [15.5, 15.5, 7.5] }}
        mu_t = 4
        albedo = [0.95, 0.8, 0.5]
        phase = {{ type = "hg", g = 0.4 }}
        emission = [0.2, 0.3, 0.1]
        transform = {{ scale = [0.1, 0.08, 0.12], rotate = [25, 35, 10], translate = [-0.9, -0.5, -0.2] }}
        [[light]]
        type = "sun"
        direction = [-1, -1, -0.5]
        irradiance = 3
        angular_diameter = 5
        "#
    ));
    let leaves: Vec<Leaf> = [[0, 0, 0], [0, 8, 0], [8, 0, 0], [8, 8, 0]]
        .map(|origin| Leaf { origin, active: [u64::MAX; 8] })
        .to_vec();
    let leaf_values = vec![1.0; leaves.len() * LEAF_VOXELS];
    let tree = Tree { background: 1.0, tiles: Vec::new(), leaves, leaf_values };
    let grid = BrickGrid::from_tree(&tree, "ones", Storage::F32).expect("four leaves make a grid");
    assert_eq!(grid.domain(), [DVec3::splat(-0.5), DVec3::new(15.5, 15.5, 7.5)]);
    let mut as_grid = as_box.clone();
    as_grid.volumes[0].density = Density::Grid(Arc::new(grid));
    for integrator in [Integrator::Reference, Integrator::Fast] {
        assert_same("box and grid", (&as_box, Integrator::Reference), (&as_grid, integrator));
    }
}
