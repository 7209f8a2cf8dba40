//! What is to be rendered: the built-in scene, a scene file, one of another renderer, or a bare volume with a scene made up
//! for it.

use std::path::{Path, PathBuf};

use glam::DVec3;
use miette::miette;
use tyndall_film::Colours;
use tyndall_scene::description::{Glow, VolumeSummary};
use tyndall_scene::{SceneDescription, SceneDocument, choose_density};
use tyndall_volumes::{Grid, GridValues};

use crate::imported::{self, Foreign, ImportArgs, WrittenFiles};
use crate::output::Output;
use crate::volume_input::{self, RawArgs};

/// A scene to render.
pub struct Input {
    /// The scene, with all overrides applied.
    pub description: SceneDescription,
    /// It as a scene file.
    pub text: String,
    /// What its file names are relative to.
    pub folder: PathBuf,
    /// What was guessed, and what is not as in the renderer that the scene is for.
    pub notes: Vec<String>,
    /// Files that the scene of another renderer has written out, and which its description names.
    pub written: Option<WrittenFiles>,
    /// Name for output files.
    stem: String,
}

/// A cumulus under sun and sky.
const DEFAULT_SCENE: &str = include_str!("../../../../scenes/cloud.toml");

impl Input {
    /// A picture to work with and, of colours, one to look at, otherwise the numbers, in the working folder.
    pub fn default_outputs(&self, colours: &Colours) -> Vec<Output> {
        [".exr", if *colours == Colours::Rgb { ".png" } else { ".json" }]
            .iter()
            .filter_map(|extension| format!("{}{extension}", self.stem).parse().ok())
            .collect()
    }
}

/// Loads `path`, or the built-in scene, and applies `overrides` of the form `key=value`; `raw` is for a bare volume, `args`
/// for a scene of another renderer.
pub fn load(
    path: Option<&Path>,
    overrides: &[String],
    raw: &RawArgs,
    args: &ImportArgs,
) -> miette::Result<Input> {
    let Some(path) = path else {
        let document = SceneDocument::parse("the built-in scene", DEFAULT_SCENE)?;
        return from_document(document, overrides, Some(DEFAULT_SCENE), PathBuf::new(), "cloud".into());
    };
    volume_input::check_input(path)?;
    let name = path.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default();
    let stem = name.split('.').next().filter(|stem| !stem.is_empty()).unwrap_or("picture").to_owned();
    if imported::is_foreign(path) && !raw.is_given() {
        return from_foreign(path, overrides, args, stem);
    }
    args.refuse(path)?;
    match name.rsplit('.').next().map(str::to_ascii_lowercase).as_deref() {
        Some("toml" | "pbrt" | "xml") if raw.is_given() => Err(miette!(
            "{}: --raw-shape is for a .raw file; a scene says it itself, by raw_shape and raw_type in its [[volume]]",
            path.display()
        )),
        Some("toml") => {
            let folder = path.parent().unwrap_or(Path::new("")).to_owned();
            from_document(SceneDocument::read(path)?, overrides, None, folder, stem)
        }
        Some("exr" | "png" | "hdr" | "acc" | "json") => Err(miette!(
            "{}: is not a scene or a volume; give a .toml scene, one of pbrt or Mitsuba (.pbrt .xml), or a volume file \
             (.vdb .nvdb .vol .npy .nii .raw)",
            path.display()
        )),
        _ => from_volume(path, overrides, raw, stem),
    }
}

fn from_document(
    mut document: SceneDocument,
    overrides: &[String],
    text: Option<&str>,
    folder: PathBuf,
    stem: String,
) -> miette::Result<Input> {
    for assignment in overrides {
        document.set(assignment)?;
    }
    let description = document.description()?;
    // Comments survive as long as nothing is changed.
    let text = text.filter(|_| overrides.is_empty()).map_or_else(|| description.to_toml(), str::to_owned);
    Ok(Input { description, text, folder, notes: Vec::new(), written: None, stem })
}

/// The scene of another renderer; file names of `overrides` are relative to it.
fn from_foreign(path: &Path, overrides: &[String], args: &ImportArgs, stem: String) -> miette::Result<Input> {
    let Foreign { imported, files } = imported::import(path, args)?;
    let name = format!("{} as a scene of Tyndall", path.display());
    let document = SceneDocument::parse(&name, &imported.description.to_toml())?;
    let folder = path.parent().unwrap_or(Path::new("")).to_owned();
    let mut input = from_document(document, overrides, None, folder, stem)?;
    input.notes = imported.notes.iter().map(ToString::to_string).collect();
    input.written = Some(files);
    Ok(input)
}

/// The scene of a bare volume, made up from its data.
fn from_volume(path: &Path, overrides: &[String], raw: &RawArgs, stem: String) -> miette::Result<Input> {
    let file = volume_input::read(path, &[], raw)?;
    let mut notes: Vec<String> =
        file.skipped.iter().map(|(name, why)| format!("{}: grid `{name}`: {why}", path.display())).collect();
    let mut names: Vec<String> = file.grids.iter().map(|grid| format!("`{}`", grid.name)).collect();
    // The scene says which of several grids of one name is taken.
    names.dedup();
    let glow = glow(&file.grids);
    let Some(grid) = choose_density(file.grids) else {
        return Err(miette!(
            "{}: has no scalar grid to render, only the vectors {}; give a file with a density",
            path.display(),
            names.join(", ")
        ));
    };
    if names.len() > 1 {
        notes.push(format!("of the grids {} `{}` is rendered", names.join(", "), grid.name));
    }
    let glow = glow.filter(|_| grid.name.to_ascii_lowercase().contains("density"));
    let Some(summary) = summary(&grid, glow) else {
        return Err(miette!(
            "{}: grid `{}` has no active voxels: there is nothing to see; give a file with a density",
            path.display(),
            grid.name
        ));
    };
    drop(grid);
    match &summary.glow {
        Some(Glow::Temperature { grid_name, max }) => notes.push(format!(
            "`{grid_name}` is taken for kelvin, {max:.0} at most, and the volume glows; --print-scene shows how"
        )),
        Some(Glow::Flame { grid_name, .. }) => {
            notes.push(format!("`{grid_name}` is taken for flames, which shine; --print-scene shows how"));
        }
        None => {}
    }
    let mut automatic = SceneDescription::for_volume(&path.display().to_string(), &summary);
    notes.push("light, camera and density are chosen from the data; --print-scene shows them".into());
    automatic.description.volumes.iter_mut().try_for_each(|volume| raw.describe(volume))?;
    let text = automatic.to_toml();
    let document = SceneDocument::parse("the scene made up for the volume", &text)?;
    let mut input = from_document(document, overrides, Some(&text), PathBuf::new(), stem)?;
    input.notes = notes;
    Ok(input)
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
fn summary(grid: &Grid, glow: Option<Glow>) -> Option<VolumeSummary> {
    let statistics = grid.values.statistics();
    let [low, high] = statistics.active_bbox?;
    let to_world = grid.index_to_world;
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
