//! The default choice in grids against quadrature, the fast engine's collisions, and what both rely on.
//!
//! Between two planes of voxel centres the trilinear field along a ray is a cubic polynomial, which Simpson's rule
//! integrates exactly; so ∫ μt, and with it the law of every collision, is known to rounding.

use glam::DVec3;
use std::ops::ControlFlow;
use tyndall_lanes::Random;
use tyndall_scene::description::Integrator;
use tyndall_scene::{Density, Ray, Scene, Volume};
use tyndall_transport::{estimate_transmittance, sample_distance};
use tyndall_volumes::BrickGrid;

use crate::fresh;
use crate::rendering::render;
use crate::scenes::{random_direction, scene, scene_in, write_npy, write_random_npy};
use crate::statistics::{kolmogorov_smirnov, mean_and_error, normal_cdf, two_sided_quantile};

fn grid(volume: &Volume) -> &BrickGrid {
    match &volume.density {
        Density::Grid(grid) => grid,
        other => panic!("a grid was expected, not {other:?}"),
    }
}

/// (distance, optical thickness up to it) at every plane of voxel centres that the ray crosses up to `end`.
fn optical_thickness(volume: &Volume, ray: &Ray, end: f64) -> Vec<(f64, f64)> {
    let (local, grid) = (volume.local_ray(ray), grid(volume));
    let Some((enter, leave)) = volume.interval(&local, (0.0, end)) else { return vec![(end, 0.0)] };
    let mut knots = vec![enter, leave];
    for axis in 0..3 {
        let (origin, direction) = (local.origin[axis], local.direction[axis]);
        let [a, b] = [enter, leave].map(|t| origin + t * direction);
        let planes = a.min(b).ceil() as i64..=a.max(b).floor() as i64;
        knots.extend(planes.map(|plane| (plane as f64 - origin) / direction).filter(|t| t.is_finite()));
    }
    knots.retain(|t| (enter..=leave).contains(t));
    knots.sort_by(f64::total_cmp);
    let mut table = vec![(0.0, 0.0), (enter, 0.0)];
    let mut tau = 0.0;
    for pair in knots.windows(2) {
        let (from, to) = (pair[0], pair[1]);
        // Just inside: where the grid is cut at its domain the field steps.
        let inside = 1e-9 * (to - from);
        let at = |t: f64| volume.medium.mu_t * grid.value(local.at(t));
        tau += (to - from) / 6.0 * (at(from + inside) + 4.0 * at(0.5 * (from + to)) + at(to - inside));
        table.push((to, tau));
    }
    table
}

fn thickness_to_the_end(volume: &Volume, ray: &Ray) -> f64 {
    optical_thickness(volume, ray, f64::INFINITY).last().map_or(0.0, |&(_, tau)| tau)
}

/// Level of each of two verdicts on each of [`heterogeneous`].
const EACH: f64 = 1e-3 / 12.0;

/// A rough grid and a cloud, in each storage.
fn heterogeneous() -> Vec<(String, Scene)> {
    let folder = tempfile::tempdir().expect("a folder for test files");
    write_random_npy(&folder.path().join("random.npy"), [20, 13, 17], 9);
    let mut scenes = Vec::new();
    for storage in ["u8", "f16", "f32"] {
        for (name, volume) in [
            (
                "random",
                "file = \"random.npy\"\n mu_t = 3
                 transform = { scale = [0.1, 0.15, 0.12], rotate = [10, 20, 30], translate = [-1, -1, -1] }",
            ),
            (
                "cumulus",
                "procedural = { type = \"cumulus\", seed = 2, resolution = 40, size = 2 }\n mu_t = 4",
            ),
        ] {
            let text = format!(
                "camera = {{ position = [0, 0, 5], target = [0, 0, 0] }}
                 [[volume]]
                 {volume}
                 albedo = 0.5
                 storage = \"{storage}\""
            );
            scenes.push((format!("{name} in {storage}"), scene_in(folder.path(), &text)));
        }
    }
    scenes
}

/// A ray that points into the volume from some way outside.
pub fn ray_through(volume: &Volume, random: &mut Random) -> Ray {
    let [min, max] = volume.world_box().expect("a grid has a box");
    let u = DVec3::new(random.f64(), random.f64(), random.f64());
    let direction = random_direction(random);
    Ray { origin: min + (0.25 + 0.5 * u) * (max - min) - 3.0 * direction, direction }
}

/// At a level of 1e-3 for all rays together.
#[test]
fn collision_distances_in_a_grid_of_ones_follow_the_exponential_law() {
    let folder = tempfile::tempdir().expect("a folder for test files");
    write_npy(&folder.path().join("ones.npy"), [20, 24, 30], |_| 1.0);
    let scene = scene_in(
        folder.path(),
        "camera = { position = [0, 0, 5], target = [0, 0, 0] }
         [[volume]]
         file = \"ones.npy\"
         mu_t = 0.2
         albedo = 0.5",
    );
    let volume = &scene.volumes[0];
    for (number, direction) in [DVec3::X, DVec3::NEG_Z, DVec3::new(0.3, 0.6, 0.7)].into_iter().enumerate() {
        // From within, and not as far as the border, where the field fades out.
        let ray = Ray { origin: DVec3::new(9.0, 8.0, 13.0), direction: direction.normalize() };
        let end = 9.0;
        let mut random = fresh::random(3, number as u64, 0);
        let draws: Vec<_> =
            (0..100_000).map(|_| sample_distance(volume, &ray, (0.0, end), &mut random)).collect();
        let inside: Vec<f64> = draws.iter().flatten().copied().collect();
        let share = 1.0 - f64::exp(-0.2 * end);
        let p = kolmogorov_smirnov(&inside, |t| (1.0 - f64::exp(-0.2 * t)) / share);
        assert!(p > 1e-3 / 6.0, "{direction}: p = {p}");
        let error = (share * (1.0 - share) / draws.len() as f64).sqrt();
        let z = (inside.len() as f64 / draws.len() as f64 - share) / error;
        assert!(z.abs() < two_sided_quantile(1e-3 / 6.0), "{direction}: z = {z}");
    }
}

/// The probability integral of each distance, 1 − exp(−τ(t)), is uniform below that of the whole ray. At a level
/// of 1e-3 together.
#[test]
fn collision_distances_in_rough_grids_follow_the_extinction_along_the_ray() {
    for (name, scene) in heterogeneous() {
        let volume = &scene.volumes[0];
        let mut random = fresh::random(4, 0, 0);
        let mut uniform = Vec::new();
        let (mut inside, mut expected, mut variance) = (0.0, 0.0, 0.0);
        for _ in 0..50 {
            let ray = ray_through(volume, &mut random);
            let share = 1.0 - (-thickness_to_the_end(volume, &ray)).exp();
            let n = 400;
            expected += share * f64::from(n);
            variance += share * (1.0 - share) * f64::from(n);
            for _ in 0..n {
                let Some(t) = sample_distance(volume, &ray, (0.0, f64::INFINITY), &mut random) else {
                    continue;
                };
                inside += 1.0;
                let tau = optical_thickness(volume, &ray, t).last().map_or(0.0, |&(_, tau)| tau);
                uniform.push((1.0 - (-tau).exp()) / share);
            }
        }
        let p = kolmogorov_smirnov(&uniform, |u| u);
        assert!(p > EACH, "{name}: p = {p} of {} distances", uniform.len());
        let z = (inside - expected) / f64::sqrt(variance);
        assert!(z.abs() < two_sided_quantile(EACH), "{name}: {inside} collisions, not {expected}, z = {z}");
    }
}

/// A bias that no ray shows by itself shows in the sum of all z scores; at a level of 1e-3.
fn assert_unbiased_together(scores: &[f64]) {
    let z = scores.iter().sum::<f64>() / (scores.len() as f64).sqrt();
    eprintln!("{} rays together: z = {z}", scores.len());
    assert!(z.abs() < two_sided_quantile(1e-3), "{} rays together: z = {z}", scores.len());
}

/// 100 rays in each field: each within its error, and all together following the normal law; at a level of 1e-3
/// together.
#[test]
fn ratio_tracking_has_the_transmittance_as_its_mean() {
    let mut all = Vec::new();
    for (number, (name, scene)) in (0..).zip(heterogeneous()) {
        let volume = &scene.volumes[0];
        let mut random = fresh::random(5, number, 0);
        let mut scores = Vec::new();
        while scores.len() < 100 {
            let ray = ray_through(volume, &mut random);
            let truth = (-thickness_to_the_end(volume, &ray)).exp();
            // A ray that nearly always passes unchanged makes no normal law.
            if !(0.01..0.99).contains(&truth) {
                continue;
            }
            let estimates: Vec<f64> =
                (0..4000).map(|_| estimate_transmittance(volume, &ray, (0.0, 1e9), &mut random)).collect();
            let (mean, error) = mean_and_error(&estimates);
            let z = (mean - truth) / error;
            assert!(
                z.abs() < two_sided_quantile(EACH / 100.0),
                "{name}: {mean} +- {error}, not {truth}, z = {z}"
            );
            scores.push(z);
        }
        let p = kolmogorov_smirnov(&scores, normal_cdf);
        assert!(p > EACH, "{name}: p = {p} of {scores:?}");
        all.extend(scores);
    }
    assert_unbiased_together(&all);
}

/// The fast engine shows its camera rays' transmittance in the picture: one pixel for each of 100 rays.
#[test]
fn the_fast_engine_collides_as_often_as_the_extinction_along_the_ray_says() {
    let mut all = Vec::new();
    for (number, (name, mut scene)) in (0..).zip(heterogeneous()) {
        let mut random = fresh::random(6, number, 0);
        let mut scores = Vec::new();
        scene.resolution = [1, 1];
        scene.max_depth = Some(0);
        while scores.len() < 100 {
            let ray = ray_through(&scene.volumes[0], &mut random);
            let truth = (-thickness_to_the_end(&scene.volumes[0], &ray)).exp();
            if !(0.05..0.95).contains(&truth) {
                continue;
            }
            scene.camera = pencil(&ray);
            let film = render(&scene, Integrator::Fast, 100 * number + scores.len() as u64, 0..4000);
            let channel = film.channels().into_iter().find(|channel| channel.name == "Transmittance");
            let mean = channel.map_or(f64::NAN, |channel| channel.values[0].into());
            scores.push((mean - truth) / (truth * (1.0 - truth) / 4000.0).sqrt());
            let z = scores[scores.len() - 1];
            assert!(z.abs() < two_sided_quantile(EACH / 100.0), "{name}: {mean}, not {truth}, z = {z}");
        }
        let p = kolmogorov_smirnov(&scores, normal_cdf);
        assert!(p > EACH, "{name}: p = {p} of {scores:?}");
        all.extend(scores);
    }
    assert_unbiased_together(&all);
}

/// A camera all of whose rays are, nearly, this one.
fn pencil(ray: &Ray) -> tyndall_scene::Camera {
    let ([x, y, z], [dx, dy, dz]) = (ray.origin.to_array(), ray.direction.to_array());
    let [ux, uy, uz] = ray.direction.any_orthonormal_vector().to_array();
    scene(&format!(
        "camera = {{ position = [{x}, {y}, {z}], direction = [{dx}, {dy}, {dz}], up = [{ux}, {uy}, {uz}], \
         vertical_fov = 1e-6 }}
         film = {{ resolution = [1, 1] }}"
    ))
    .camera
}

#[test]
fn segments_follow_each_other_and_their_bounds_hold() {
    for (name, scene) in heterogeneous() {
        let volume = &scene.volumes[0];
        let grid = grid(volume);
        let mut random = fresh::random(7, 0, 0);
        for _ in 0..300 {
            let local = volume.local_ray(&ray_through(volume, &mut random));
            let Some((enter, leave)) = volume.interval(&local, (0.0, f64::INFINITY)) else { continue };
            let mut reached = enter;
            let _ = grid.segments(local.origin, local.direction, (0.0, f64::INFINITY), |segment| {
                assert!((segment.start - reached).abs() < 1e-9 && segment.end > segment.start, "{name}");
                reached = segment.end;
                for i in 1..16 {
                    let t = segment.start + f64::from(i) / 16.0 * (segment.end - segment.start);
                    let value = grid.value(local.at(t));
                    let (min, max) = (f64::from(segment.bounds.min), f64::from(segment.bounds.max));
                    assert!((min..=max * (1.0 + 1e-12)).contains(&value), "{name}: {value} in {segment:?}");
                }
                ControlFlow::<()>::Continue(())
            });
            assert!(
                (reached - leave).abs() < 1e-6,
                "{name}: the last segment ends at {reached}, not {leave}"
            );
        }
    }
}

/// What the fast engine relies on: no voxel that may stand for a point exceeds the majorant of the point's cell.
#[test]
fn no_voxel_around_a_point_exceeds_the_majorant_of_its_cell() {
    for (name, scene) in heterogeneous() {
        let grid = grid(&scene.volumes[0]);
        let origin = grid.origin();
        let [min, max] = grid.domain();
        let mut random = fresh::random(8, 0, 0);
        for _ in 0..100_000 {
            let u = DVec3::new(random.f64(), random.f64(), random.f64());
            let floor = (min + u * (max - min)).floor().as_ivec3().to_array();
            let local = std::array::from_fn(|axis| (floor[axis] - origin[axis]) as u32);
            let majorant = grid.cell(local).max;
            for corner in 0..8 {
                let step = [corner >> 2, corner >> 1 & 1, corner & 1];
                let voxel = grid.voxel(std::array::from_fn(|axis| floor[axis] + step[axis]));
                assert!(voxel <= majorant, "{name}: {voxel} above {majorant} at {floor:?}");
            }
        }
    }
}
