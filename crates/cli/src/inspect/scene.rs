//! The facts about a scene: the scene file with nothing left out, and what its volumes come to.

use std::fmt::Write;

use glam::DVec3;
use serde::Serialize;
use tyndall_scene::{Density, Ray, SceneDescription, Volume};
use tyndall_session::Input;

use super::contents::Contents;
use super::table::{bytes, number, triple};

/// What is told about a scene.
#[derive(Debug, Serialize)]
pub struct SceneReport {
    format: &'static str,
    /// What `.acc` files of this scene carry.
    scene_hash: String,
    scene: SceneDescription,
    volumes: Vec<VolumeReport>,
    /// What is in it as a whole.
    contents: Contents,
    /// Guesses and warnings.
    notes: Vec<String>,
}

/// What is told about a volume.
#[derive(Debug, Serialize)]
struct VolumeReport {
    name: String,
    /// The grid of its file that multiplies the coefficients.
    grid: Option<String>,
    /// Least and greatest corner in scene units; `None` where it is unbounded.
    world_box: Option<[[f64; 3]; 2]>,
    /// Least and greatest density after filtering.
    density_range: [f64; 2],
    /// Extinction coefficient at density 1, in 1/scene unit.
    mu_t: f64,
    /// Optical thickness through the box.
    optical_thickness: Option<OpticalThickness>,
    /// Memory of its voxels.
    memory_bytes: u64,
}

/// ∫ μt along parallel rays through the world box, along each axis.
#[derive(Debug, Serialize)]
struct OpticalThickness {
    mean: [f64; 3],
    max: [f64; 3],
}

impl SceneReport {
    /// Builds the scene and measures it.
    pub fn new(input: &Input) -> miette::Result<Self> {
        let built = input.build()?;
        let grid_of =
            |volume: &str| built.grids.iter().find(|(name, _)| name == volume).map(|(_, grid)| grid.clone());
        Ok(Self {
            format: "Tyndall scene",
            scene_hash: input.scene_hash()?.to_string(),
            scene: input.description().clone(),
            volumes: built
                .scene
                .volumes
                .iter()
                .map(|volume| VolumeReport::new(volume, grid_of(&volume.name)))
                .collect(),
            contents: Contents::new(input.description(), &built.scene),
            notes: input.notes().iter().cloned().chain(built.notes).collect(),
        })
    }
}

impl VolumeReport {
    fn new(volume: &Volume, grid: Option<String>) -> Self {
        let world_box = volume.world_box().filter(|corners| corners.iter().all(|corner| corner.is_finite()));
        let (density_range, memory_bytes) = match &volume.density {
            Density::Grid(bricks) => {
                let bounds = bricks.bounds();
                ([bounds.min, bounds.max].map(f64::from), bricks.memory_bytes() as u64)
            }
            _ => ([1.0; 2], 0),
        };
        Self {
            name: volume.name.clone(),
            grid,
            world_box: world_box.map(|corners| corners.map(|corner| corner.to_array())),
            density_range,
            mu_t: volume.medium.mu_t,
            optical_thickness: world_box.map(|corners| optical_thickness(volume, corners)),
            memory_bytes,
        }
    }
}

/// Rays along each edge of the face of a box.
const RAYS: u32 = 32;
/// Points of a ray: the midpoint rule errs far less than the rays' own spread.
const POINTS: u32 = 128;

fn optical_thickness(volume: &Volume, [min, max]: [DVec3; 2]) -> OpticalThickness {
    let (mut mean, mut greatest) = ([0.0; 3], [0.0_f64; 3]);
    for axis in 0..3 {
        let mut direction = DVec3::ZERO;
        direction[axis] = 1.0;
        for cell in 0..RAYS * RAYS {
            let mut origin = min;
            let place = [cell / RAYS, cell % RAYS].map(|k| (f64::from(k) + 0.5) / f64::from(RAYS));
            for (across, u) in [(axis + 1) % 3, (axis + 2) % 3].into_iter().zip(place) {
                origin[across] += u * (max[across] - min[across]);
            }
            let ray = volume.local_ray(&Ray { origin, direction });
            let thickness = volume.medium.mu_t * density_integral(volume, &ray, max[axis] - min[axis]);
            mean[axis] += thickness / f64::from(RAYS * RAYS);
            greatest[axis] = greatest[axis].max(thickness);
        }
    }
    OpticalThickness { mean, max: greatest }
}

/// ∫ density along a local ray from 0 to `end`.
fn density_integral(volume: &Volume, ray: &Ray, end: f64) -> f64 {
    let Some((enter, leave)) = volume.interval(ray, (0.0, end)) else { return 0.0 };
    let Density::Grid(bricks) = &volume.density else {
        return volume.density_integral(ray, (enter, leave)).unwrap_or(0.0);
    };
    let step = (leave - enter) / f64::from(POINTS);
    let density = |k: u32| bricks.value(ray.origin + ray.direction * (enter + (f64::from(k) + 0.5) * step));
    (0..POINTS).map(|k| density(k).max(0.0) * step).sum()
}

/// The scene file, followed by a paragraph for each volume; what is no TOML is a comment, so that the whole remains
/// a scene file.
pub fn text(input: &Input, report: &SceneReport) -> String {
    let mut text = input.to_toml();
    for volume in &report.volumes {
        let _ = writeln!(text, "\n# {}", volume.name);
        for (key, value) in rows(volume) {
            // Writing to a string cannot fail.
            let _ = writeln!(text, "#   {key:<19}{value}");
        }
    }
    let contents = report.contents.rows();
    if !contents.is_empty() {
        let _ = writeln!(text, "\n# the scene");
        for (key, value) in contents {
            let _ = writeln!(text, "#   {key:<19}{value}");
        }
    }
    for note in &report.notes {
        let _ = writeln!(text, "\n# note: {note}");
    }
    text
}

fn rows(volume: &VolumeReport) -> Vec<(&'static str, String)> {
    let vector = |x: [f64; 3]| triple(x.map(number));
    let mut rows = Vec::new();
    if let Some(grid) = &volume.grid {
        rows.push(("grid", format!("`{grid}`")));
    }
    match volume.world_box {
        Some([min, max]) => rows.push(("world box", format!("{} to {}", vector(min), vector(max)))),
        None => rows.push(("world box", "unbounded".into())),
    }
    let [least, greatest] = volume.density_range.map(number);
    rows.push(("density", format!("{least} to {greatest}, times mu_t = {}", number(volume.mu_t))));
    if let Some(OpticalThickness { mean, max }) = &volume.optical_thickness {
        let values = format!("mean {}, greatest {} along x, y, z of the box", vector(*mean), vector(*max));
        rows.push(("optical thickness", values));
    }
    if volume.memory_bytes > 0 {
        rows.push(("memory", bytes(volume.memory_bytes)));
    }
    rows
}

#[cfg(test)]
mod tests {
    use super::*;
    use tyndall_session::InputOptions;

    #[test]
    fn the_optical_thickness_of_a_ball_is_that_of_its_chords() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("ball.toml");
        let scene = "camera = { position = [0, 0, 9], target = [0, 0, 0] }\n[[volume]]\n\
                     sphere = { center = [1, 2, 3], radius = 2 }\nmu_t = 3\nalbedo = 1\n";
        std::fs::write(&path, scene).unwrap();
        let report = SceneReport::new(&Input::open(&path, &InputOptions::default()).unwrap()).unwrap();
        let [volume] = &report.volumes[..] else { panic!("{:?}", report.volumes) };
        assert_eq!(volume.world_box, Some([[-1.0, 0.0, 1.0], [3.0, 4.0, 5.0]]));
        let OpticalThickness { mean, max } = volume.optical_thickness.as_ref().unwrap();
        // The volume over the face of its box, 4/3 π r³ / (2 r)², and the diameter.
        let expected = 3.0 * 2.0 * std::f64::consts::FRAC_PI_3;
        assert!(mean.iter().all(|mean| (mean / expected - 1.0).abs() < 0.01), "{mean:?} {expected}");
        assert!(max.iter().all(|max| (11.9..=12.0).contains(max)), "{max:?}");
    }
}
