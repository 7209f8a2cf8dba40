//! A scene for a bare volume file: what its data say, from which `tyndall_scene` chooses camera, light and density.

use std::path::Path;

use glam::{DAffine3, DVec3};
use tyndall_scene::description::{Glow, VolumeSummary};
use tyndall_scene::{MemoryGrid, SceneDescription, choose_density};
use tyndall_volumes::{Grid, GridValues};

use crate::SessionError;
use crate::volume_file::{RawVolume, read_volume};

/// A scene file with comments, and what the user should know of how it came about.
pub(crate) struct AutomaticInput {
    pub text: String,
    pub notes: Vec<String>,
}

/// Makes up a scene for the volume file at `path`, which the scene calls `shown`.
///
/// # Errors
/// If it cannot be read, or has nothing to be seen.
pub(crate) fn make_up(
    path: &Path,
    shown: &Path,
    raw: Option<RawVolume>,
) -> Result<AutomaticInput, SessionError> {
    let file = read_volume(path, &[], raw)?;
    let mut notes: Vec<String> =
        file.skipped.iter().map(|(name, why)| format!("{}: grid `{name}`: {why}", path.display())).collect();
    let mut names: Vec<String> = file.grids.iter().map(|grid| format!("`{}`", grid.name)).collect();
    // The scene says which of several grids of one name is taken.
    names.dedup();
    let glow = glow(&file.grids);
    let Some(grid) = choose_density(file.grids) else {
        return Err(SessionError::refuse_file(
            path,
            format!(
                "has no scalar grid to render, only the vectors {}; give a file with a density",
                names.join(", ")
            ),
        ));
    };
    if names.len() > 1 {
        notes.push(format!("of the grids {} `{}` is rendered", names.join(", "), grid.name));
    }
    make_up_of(path, shown, &grid, DAffine3::IDENTITY, glow, raw, notes)
}

/// Makes up a scene for a grid in memory that stands for the file `name`.
///
/// # Errors
/// If it has nothing to be seen.
pub(crate) fn make_up_of_grid(name: &str, memory: &MemoryGrid) -> Result<AutomaticInput, SessionError> {
    let path = Path::new(name);
    if matches!(memory.grid().values, GridValues::Vec3(_)) {
        return Err(SessionError::refuse_file(path, "holds vectors; give a volume with a density"));
    }
    make_up_of(path, path, memory.grid(), memory.place(), None, None, Vec::new())
}

/// Makes up a scene for a grid, which `path` stands for in messages and `shown` in the scene.
fn make_up_of(
    path: &Path,
    shown: &Path,
    grid: &Grid,
    place: DAffine3,
    glow: Option<Glow>,
    raw: Option<RawVolume>,
    mut notes: Vec<String>,
) -> Result<AutomaticInput, SessionError> {
    let glow = glow.filter(|_| grid.name.to_ascii_lowercase().contains("density"));
    let Some(summary) = summary(grid, place, glow) else {
        return Err(SessionError::refuse_file(
            path,
            format!(
                "grid `{}` has no active voxels: there is nothing to see; give a file with a density",
                grid.name
            ),
        ));
    };
    match &summary.glow {
        Some(Glow::Temperature { grid_name, max }) => notes.push(format!(
            "`{grid_name}` is taken for kelvin, {max:.0} at most, and the volume glows; --print-scene shows how"
        )),
        Some(Glow::Flame { grid_name, .. }) => {
            notes.push(format!("`{grid_name}` is taken for flames, which shine; --print-scene shows how"));
        }
        None => {}
    }
    notes.push("light, camera and density are chosen from the data; --print-scene shows them".into());
    let mut automatic = SceneDescription::for_volume(&shown.display().to_string(), &summary);
    if let Some(raw) = raw {
        automatic.description.volumes.iter_mut().try_for_each(|volume| raw.describe(volume))?;
    }
    Ok(AutomaticInput { text: automatic.to_toml(), notes })
}

/// The grid by which a file's volume glows: temperatures before flames.
fn glow(grids: &[Grid]) -> Option<Glow> {
    let glow = |grid: &Grid| {
        let max = *grid.values.statistics().max.first()?;
        Glow::of_grid(&grid.name, max)
    };
    let scalars = grids.iter().filter(|grid| !matches!(grid.values, GridValues::Vec3(_)));
    let found: Vec<Glow> = scalars.filter_map(glow).collect();
    let is_temperature = |glow: &&Glow| matches!(glow, Glow::Temperature { .. });
    found.iter().find(is_temperature).or(found.first()).cloned()
}

/// What the made-up scene depends on; `None` if no voxel is active.
fn summary(grid: &Grid, place: DAffine3, glow: Option<Glow>) -> Option<VolumeSummary> {
    let statistics = grid.values.statistics();
    let [low, high] = statistics.active_bbox?;
    let to_world = place * grid.index_to_world;
    let corner = |i: usize| {
        let face = |axis: usize| match i >> axis & 1 {
            0 => f64::from(low[axis]) - 0.5,
            _ => f64::from(high[axis]) + 0.5,
        };
        to_world.transform_point3(DVec3::new(face(0), face(1), face(2)))
    };
    let voxels: f64 = (0..3).map(|a| f64::from(high[a]) - f64::from(low[a]) + 1.0).product();
    let count = statistics.active_voxels as f64;
    let name = grid.name.to_ascii_lowercase();
    Some(VolumeSummary {
        grid_name: grid.name.clone(),
        world_box: [
            (1..8).fold(corner(0), |least, i| least.min(corner(i))),
            (1..8).fold(corner(0), |greatest, i| greatest.max(corner(i))),
        ],
        mean: statistics.sum.first()? / count,
        max: *statistics.max.first()?,
        active_fraction: (count / voxels).min(1.0),
        voxel_size: to_world.matrix3.determinant().abs().cbrt(),
        class: grid.class,
        value_is_temperature: name.contains("temperature"),
        glow,
    })
}
