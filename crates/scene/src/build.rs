//! From a description to a scene ready to trace: volume files are read, grids chosen, everything put in its place.

use glam::{DAffine3, DVec3};
use std::cell::Cell;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use tyndall_optics::mie::MieCache;
use tyndall_volumes::{
    AxisOrder, BrickGrid, ByteOrder, Element, Filter, Grid, GridClass, GridSelection, GridValues, RawShape,
    ReadError, ReadRequest, VolumeFile,
};

use crate::build_fields::build_fields;
use crate::build_medium::build_medium;
use crate::description::{
    AtmosphereShape, GridFilter, GridMeaning, ProceduralDescription, RawType, Storage, VolumeDescription,
    VolumeSource,
};
use crate::light::{LightTree, build_lights};
use crate::mie::MieTables;
use crate::ready::light_probabilities;
use crate::scene_files::{MemoryGrid, SceneFiles};
use crate::surface::{Boundaries, Presence, Surfaces, VolumeNumber, build_surfaces, numbers_of};
use crate::{Camera, Density, Scene, SceneDescription, SceneError, Volume, observers, procedural};

/// A scene, and what the user should know of how it came about.
#[derive(Debug, Clone)]
pub struct BuiltScene {
    /// The scene.
    pub scene: Scene,
    /// The grid that each volume has from its file: names of the volume and of the grid.
    pub grids: Vec<(String, String)>,
    /// Guesses and warnings, one line each.
    pub notes: Vec<String>,
}

/// Builds the scene of `description`, whose file names are relative to `folder`.
///
/// What Lorenz-Mie theory computes is kept in the cache that the environment names.
pub fn build(description: &SceneDescription, folder: &Path) -> Result<BuiltScene, SceneError> {
    build_with(description, &SceneFiles::in_folder(folder), &MieCache::from_environment())
}

/// The same of a scene whose files may be grids in memory, with a cache for Lorenz-Mie theory.
pub fn build_with(
    description: &SceneDescription,
    files: &SceneFiles,
    cache: &MieCache,
) -> Result<BuiltScene, SceneError> {
    let folder = files.folder.as_path();
    let tables = MieTables::new(description.render.mode, cache);
    let mut notes = Vec::new();
    let mut grids = Vec::new();
    let mut volumes = Vec::new();
    if let Some(medium) = &description.medium {
        volumes.push(Volume {
            name: "medium".into(),
            world_to_local: DAffine3::IDENTITY,
            density: Density::Everywhere,
            medium: build_medium(medium, &description.unit, folder, 1.0, &tables, "medium")?,
            fields: None,
        });
    }
    for (number, volume) in description.volumes.iter().enumerate() {
        let name = volume.name.clone().unwrap_or_else(|| format!("volume.{number}"));
        volumes.push(build_volume(volume, name, &description.unit, files, &tables, &mut grids, &mut notes)?);
    }
    // Nothing collides where there is no extinction.
    let is_there =
        |volume: &Volume| volume.medium.mu_t > 0.0 || volume.medium.emission_per_length != DVec3::ZERO;
    let mut count = 0..;
    let numbers: Vec<VolumeNumber> = volumes
        .iter()
        .map(|volume| VolumeNumber {
            name: volume.name.clone(),
            number: if is_there(volume) { count.next() } else { None },
        })
        .collect();
    volumes.retain(is_there);
    let mut surfaces = build_surfaces(description, folder, &numbers, &mut notes)?;

    let mut lights = build_lights(&description.lights, folder)?;
    lights.add_lamps(&description.shapes, &mut surfaces)?;
    notes.append(&mut lights.warnings);
    if lights.lights.is_empty() && !volumes.iter().any(Volume::glows) {
        notes.push("the scene has no light: the picture will be black; add a [[light]]".into());
    }
    let boundaries = Boundaries::new(&surfaces, volumes.len());
    lights.add_glowing_volumes(&volumes, |volume| boundaries.bound(volume));
    let light_probabilities = light_probabilities(&lights.lights, scene_radius(&volumes, &surfaces));
    let light_tree = LightTree::new(&lights.lights, &light_probabilities);
    let camera = Camera::new(&description.camera, description.film.resolution, description.film.crop);
    let camera_presence = camera_presence(description, &camera, &boundaries, &surfaces, &numbers)?;
    let scene = Scene {
        resolution: camera.resolution(),
        camera,
        lights: lights.lights,
        light_spectra: lights.spectra,
        light_probabilities,
        light_tree,
        surfaces,
        boundaries,
        volumes,
        camera_presence,
        max_depth: description.render.max_depth,
        observer: observers(description)[0],
    };
    Ok(BuiltScene { scene, grids, notes })
}

/// The volumes that are present where the camera is: as the description says, or found out once if all rays begin there.
fn camera_presence(
    description: &SceneDescription,
    camera: &Camera,
    boundaries: &Boundaries,
    surfaces: &Surfaces,
    volumes: &[VolumeNumber],
) -> Result<Option<Presence>, SceneError> {
    if let Some(inside) = &description.camera.inside {
        let numbers = numbers_of(Some(inside), volumes)
            .map_err(|message| SceneError::file(Path::new("camera"), format!("`inside`: {message}")))?;
        return Ok(Some(boundaries.inside(&numbers)));
    }
    Ok(camera.pinhole().map(|place| boundaries.presence_at(place, surfaces)))
}

fn build_volume(
    description: &VolumeDescription,
    name: String,
    unit: &str,
    files: &SceneFiles,
    tables: &MieTables,
    grids: &mut Vec<(String, String)>,
    notes: &mut Vec<String>,
) -> Result<Volume, SceneError> {
    let folder = files.folder.as_path();
    let source = description.source().map_err(|(_, message)| SceneError::file(Path::new(&name), message))?;
    let to_scene =
        description.transform.as_ref().map_or(DAffine3::IDENTITY, |transform| transform.to_affine());
    let (density, local_to_volume) = match source {
        VolumeSource::File(file) => {
            let (path, grid, place) = match files.grids.get(file) {
                Some(memory) => (
                    PathBuf::from(file),
                    named_grid(memory, description.grid.as_deref(), file)?,
                    memory.place(),
                ),
                None => {
                    let path = folder.join(file);
                    let grid = Arc::new(read_grid(description, &path, notes)?);
                    (path, grid, DAffine3::IDENTITY)
                }
            };
            grids.push((name.clone(), grid.name.clone()));
            let bricks = build_bricks(description, &grid, &path, notes)?;
            let (density, local_to_grid) = grid_density(bricks, &grid);
            (density, place * local_to_grid)
        }
        VolumeSource::Box(cuboid) => {
            let [min, max] = [cuboid.min, cuboid.max].map(DVec3::from_array);
            (Density::Box { min, max }, DAffine3::IDENTITY)
        }
        VolumeSource::Sphere(sphere) => {
            let place = DAffine3::from_translation(DVec3::from_array(sphere.center));
            (Density::Sphere, place * DAffine3::from_scale(DVec3::splat(sphere.radius)))
        }
        VolumeSource::Slab(slab) => {
            (Density::Slab { bottom: slab.bottom, top: slab.top }, DAffine3::IDENTITY)
        }
        VolumeSource::Atmosphere(AtmosphereShape { bottom, top, scale_height }) => {
            let top = top.unwrap_or(f64::INFINITY);
            let atmosphere = Density::Atmosphere { bottom: *bottom, top, scale_height: *scale_height };
            (atmosphere, DAffine3::IDENTITY)
        }
        VolumeSource::Procedural(ProceduralDescription::Cumulus { seed, resolution, center, size }) => {
            let grid = procedural::cumulus(*seed, *resolution, DVec3::from_array(*center), *size)
                .map_err(|error| SceneError::file(Path::new(&name), error.to_string()))?;
            let bricks = build_bricks(description, &grid, Path::new(&name), notes)?;
            grid_density(bricks, &grid)
        }
        VolumeSource::Shapes => (Density::Everywhere, DAffine3::IDENTITY),
    };
    let local_to_world = to_scene * local_to_volume;
    let world_to_local = local_to_world.inverse();
    if !world_to_local.is_finite() {
        return Err(SceneError::file(
            Path::new(&name),
            "its transform is singular: it flattens the volume; give scales other than 0",
        ));
    }
    let emission_scale = description.emission_scale.unwrap_or(1.0);
    let medium = build_medium(&description.medium, unit, folder, emission_scale, tables, &name)?;
    let fields = build_fields(description, files, to_scene, &name, notes)?;
    Ok(Volume { name, world_to_local, density, medium, fields })
}

/// The density, and its local coordinates in those of the volume.
fn grid_density(bricks: BrickGrid, grid: &Grid) -> (Density, DAffine3) {
    let to_index = DAffine3::from_translation(DVec3::splat(-bricks.filter().offset()));
    (Density::Grid(Arc::new(bricks)), grid.index_to_world * to_index)
}

/// Reads the grid that the description names, or the one that is most likely meant.
fn read_grid(
    description: &VolumeDescription,
    path: &Path,
    notes: &mut Vec<String>,
) -> Result<Grid, SceneError> {
    let grids = match &description.grid {
        Some(name) => GridSelection::Names(vec![name.clone()]),
        None => GridSelection::All,
    };
    let raw = description.raw_shape.map(|shape| RawShape {
        shape: shape.map(|n| n as usize),
        element: element(description.raw_type.unwrap_or(RawType::U8)),
        byte_order: ByteOrder::Little,
        axis_order: AxisOrder::XFastest,
    });
    let file = read_volume_file(path, &ReadRequest { grids, raw })?;
    let names: Vec<String> = file.grids.iter().map(|grid| format!("`{}`", grid.name)).collect();
    let same_name = description.grid.is_some();
    let Some(grid) = choose_density(file.grids) else {
        return Err(SceneError::file(
            path,
            format!("has no scalar grid; it has the vectors {}; a density is needed", names.join(", ")),
        ));
    };
    if names.len() > 1 && same_name {
        let count = names.len();
        notes.push(format!("{}: of {count} grids `{}` the first is rendered", path.display(), grid.name));
    } else if names.len() > 1 {
        notes.push(format!(
            "{}: of the grids {} `{}` is rendered; the key `grid` names another",
            path.display(),
            names.join(", "),
            grid.name
        ));
    }
    Ok(grid)
}

/// The grid in memory, if it is the one that was asked for.
pub(crate) fn named_grid(
    memory: &MemoryGrid,
    wanted: Option<&str>,
    file: &str,
) -> Result<Arc<Grid>, SceneError> {
    let grid = memory.grid();
    match wanted.filter(|wanted| *wanted != grid.name) {
        None => Ok(Arc::clone(grid)),
        Some(wanted) => {
            Err(SceneError::file(Path::new(file), format!("no grid named `{wanted}`; it is `{}`", grid.name)))
        }
    }
}

/// Reads a volume file that the scene names.
pub(crate) fn read_volume_file(path: &Path, request: &ReadRequest) -> Result<VolumeFile, SceneError> {
    tyndall_volumes::read(path, request).map_err(|error| {
        if matches!(&error, ReadError::Io { error, .. } if error.kind() == std::io::ErrorKind::NotFound) {
            let mend = "there is no such file; mend the key `file`, which is relative to the scene file";
            return SceneError::file(path, mend);
        }
        let message = error.to_string();
        let prefix = format!("{}: ", path.display());
        SceneError::file(path, message.strip_prefix(&prefix).unwrap_or(&message))
    })
}

/// The grid that is a density by its name, by its class, or at least by its type.
pub fn choose_density(grids: Vec<Grid>) -> Option<Grid> {
    let rank = |grid: &Grid| {
        let name = grid.name.to_ascii_lowercase();
        let by_name = match name.as_str() {
            "density" => 0,
            _ if name.contains("density") => 1,
            _ if name.contains("temperature") || name.contains("flame") || name.contains("heat") => 3,
            _ => 2,
        };
        (by_name, grid.class != GridClass::FogVolume)
    };
    grids.into_iter().filter(|grid| !matches!(grid.values, GridValues::Vec3(_))).min_by_key(rank)
}

fn build_bricks(
    description: &VolumeDescription,
    grid: &Grid,
    path: &Path,
    notes: &mut Vec<String>,
) -> Result<BrickGrid, SceneError> {
    let storage = match description.storage {
        Some(Storage::U8) => tyndall_volumes::Storage::U8,
        Some(Storage::F32) => tyndall_volumes::Storage::F32,
        Some(Storage::F16) | None => tyndall_volumes::Storage::F16,
    };
    let is_distance = match description.values {
        Some(meaning) => meaning == GridMeaning::SignedDistance,
        None => grid.class == GridClass::LevelSet,
    };
    let has_negative = Cell::new(false);
    let bricks = if is_distance {
        if description.values.is_none() {
            notes.push(format!(
                "{}: `{}` is a level set: density is 1 inside, 0 outside, with a ramp of one voxel",
                path.display(),
                grid.name
            ));
        }
        // The surface is where the distance is 0; a voxel's edge is the cube root of its volume.
        let voxel = libm::cbrt(grid.index_to_world.matrix3.determinant().abs()) as f32;
        BrickGrid::mapped(grid, storage, |distance| (0.5 - distance / voxel).clamp(0.0, 1.0))
    } else {
        // Voxel by voxel: cut off after filtering, a single voxel drawn in place of the mixture of eight would have
        // another mean than the mixture.
        BrickGrid::mapped(grid, storage, |value| {
            let negative = value < 0.0 && value.is_finite();
            has_negative.set(has_negative.get() || negative);
            if negative { 0.0 } else { value }
        })
    };
    let bricks = bricks.map_err(|error| SceneError::file(path, error.to_string()))?;
    if bricks.non_finite() > 0 {
        notes.push(format!(
            "{}: {} values of `{}` are not finite and count as 0",
            path.display(),
            bricks.non_finite(),
            grid.name
        ));
    }
    if bricks.bounds().max <= 0.0 {
        notes.push(format!(
            "{}: `{}` is nowhere above 0: there is nothing to see",
            path.display(),
            grid.name
        ));
    }
    if has_negative.get() {
        notes.push(format!("{}: negative values of `{}` count as 0", path.display(), grid.name));
    }
    Ok(bricks.with_filter(match description.filter.unwrap_or_default() {
        GridFilter::Trilinear => Filter::Trilinear,
        GridFilter::Nearest => Filter::Nearest,
    }))
}

fn element(raw_type: RawType) -> Element {
    match raw_type {
        RawType::U8 => Element::UInt8,
        RawType::U16 => Element::UInt16,
        RawType::I16 => Element::Int16,
        RawType::F16 => Element::Float16,
        RawType::F32 => Element::Float32,
        RawType::F64 => Element::Float64,
    }
}

/// Radius of a sphere around the bounded volumes and surfaces.
fn scene_radius(volumes: &[Volume], surfaces: &Surfaces) -> f64 {
    let boxes = volumes.iter().filter_map(Volume::world_box).chain(surfaces.bounds());
    let all = boxes.reduce(|[low, high], [min, max]| [low.min(min), high.max(max)]);
    all.map_or(1.0, |[min, max]| 0.5 * (max - min).length())
}
