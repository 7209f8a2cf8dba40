//! The grids of a volume beside its density, from their files: emission, temperature, albedo.

use std::path::Path;
use std::sync::Arc;

use glam::DAffine3;
use tyndall_optics::planck::BlackbodyColours;
use tyndall_volumes::{BrickGrid, Filter, Grid, GridSelection, ReadRequest, Storage};

use crate::build::{named_grid, read_volume_file};
use crate::description::{GridFilter, VolumeDescription};
use crate::scene_files::SceneFiles;
use crate::{Field, Fields, SceneError, TemperatureField};

/// The fields of a volume; `to_scene` is its transform. What was chosen or is odd goes into `notes`.
pub(crate) fn build_fields(
    description: &VolumeDescription,
    files: &SceneFiles,
    to_scene: DAffine3,
    name: &str,
    notes: &mut Vec<String>,
) -> Result<Option<Arc<Fields>>, SceneError> {
    let mut source = Source { description, files, to_scene, name, notes };
    let mut fields = Fields::default();
    if let Some(emission) = &description.emission_grid {
        let grid = source.read(&emission.file, &emission.grid, &["flame", "heat"], "emission_grid")?;
        fields.emission = Some((source.field(&grid, Storage::F16, |value| value.max(0.0))?, emission.scale));
    }
    if let Some(temperature) = &description.temperature {
        let grid =
            source.read(&temperature.file, &temperature.grid, &["temperature", "temp"], "temperature")?;
        // A blackbody's light changes by 16 times as much as its temperature: halves would show.
        let field = source.field(&grid, Storage::F32, |value| value)?;
        source.note_range(&field, temperature.scale, temperature.offset);
        fields.temperature = Some(TemperatureField {
            field,
            scale: temperature.scale,
            offset: temperature.offset,
            radiance_scale: description.emission_scale.unwrap_or(1.0),
            normalised: temperature.normalised,
            colours: Arc::new(BlackbodyColours::new()),
        });
    }
    if let Some(albedo) = &description.albedo_grid {
        let names = ["cd", "color", "colour", "albedo"];
        let grid = source.read(&albedo.file, &albedo.grid, &names, "albedo_grid")?;
        fields.albedo = Some(source.colours(&grid)?);
    }
    let is_empty = fields.emission.is_none() && fields.temperature.is_none() && fields.albedo.is_none();
    Ok((!is_empty).then(|| Arc::new(fields)))
}

/// A grid, and the way from its own world space to the volume's.
struct Placed {
    grid: Arc<Grid>,
    place: DAffine3,
}

/// Where the grids come from, and where they go.
struct Source<'a> {
    description: &'a VolumeDescription,
    files: &'a SceneFiles,
    to_scene: DAffine3,
    name: &'a str,
    notes: &'a mut Vec<String>,
}

impl Source<'_> {
    /// The grid called `grid`, or the first whose name contains one of `names`, or the only one.
    fn read(
        &mut self,
        file: &Option<String>,
        grid: &Option<String>,
        names: &[&str],
        key: &str,
    ) -> Result<Placed, SceneError> {
        let Some(file) = file.as_ref().or(self.description.file.as_ref()) else {
            return Err(SceneError::file(Path::new(self.name), format!("`{key}` needs a `file`")));
        };
        if let Some(memory) = self.files.grids.get(file) {
            let grid = named_grid(memory, grid.as_deref(), file)?;
            return Ok(Placed { grid, place: memory.place() });
        }
        let path = self.files.folder.join(file);
        let grids = match grid {
            Some(name) => GridSelection::Names(vec![name.clone()]),
            None => GridSelection::All,
        };
        let mut grids = read_volume_file(&path, &ReadRequest { grids, raw: None })?.grids;
        let is_named = |candidate: &Grid| {
            let candidate = candidate.name.to_ascii_lowercase();
            names.iter().any(|name| candidate.contains(name))
        };
        let chosen = match grid {
            Some(_) => (!grids.is_empty()).then_some(0),
            None if grids.len() == 1 => Some(0),
            None => grids.iter().position(is_named),
        };
        let Some(chosen) = chosen else {
            let list: Vec<String> = grids.iter().map(|grid| format!("`{}`", grid.name)).collect();
            let message = format!(
                "has no grid for `{key}` by its name: give `{key}.grid` as one of {}",
                list.join(", ")
            );
            return Err(SceneError::file(&path, message));
        };
        let chosen_grid = grids.swap_remove(chosen);
        if grid.is_none() {
            let text = format!("{}: `{}` is taken for `{key}`", path.display(), chosen_grid.name);
            self.notes.push(text);
        }
        Ok(Placed { grid: Arc::new(chosen_grid), place: DAffine3::IDENTITY })
    }

    /// A scalar grid in its place.
    fn field(
        &mut self,
        placed: &Placed,
        storage: Storage,
        map: impl Fn(f32) -> f32,
    ) -> Result<Field, SceneError> {
        let Placed { grid, place } = placed;
        let refuse = |message: String| SceneError::file(Path::new(self.name), message);
        let filter = match self.description.filter.unwrap_or_default() {
            GridFilter::Trilinear => Filter::Trilinear,
            GridFilter::Nearest => Filter::Nearest,
        };
        let bricks = BrickGrid::mapped(grid, storage, map).map_err(|error| refuse(error.to_string()))?;
        if bricks.non_finite() > 0 {
            let count = bricks.non_finite();
            self.notes.push(format!(
                "{}: {count} values of `{}` are not finite and count as 0",
                self.name, grid.name
            ));
        }
        let bricks = bricks.with_filter(filter);
        let to_index = DAffine3::from_translation(glam::DVec3::splat(-filter.offset()));
        let world_to_local = (self.to_scene * *place * grid.index_to_world * to_index).inverse();
        if !world_to_local.is_finite() {
            return Err(refuse(format!(
                "the transform of `{}` is singular: it flattens the grid",
                grid.name
            )));
        }
        Ok(Field { world_to_local, grid: Arc::new(bricks) })
    }

    /// The channels of a grid of colours, or a scalar grid three times; values beyond 0…1 are the nearer end.
    fn colours(&mut self, placed: &Placed) -> Result<[Field; 3], SceneError> {
        let clamp = |value: f32| value.clamp(0.0, 1.0);
        let mut channel = |axis: usize| {
            let grid = placed.grid.component(axis).map_or_else(|| Arc::clone(&placed.grid), Arc::new);
            self.field(&Placed { grid, place: placed.place }, Storage::F16, clamp)
        };
        Ok([channel(0)?, channel(1)?, channel(2)?])
    }

    /// Says what the temperatures come to; a scale that was forgotten shows.
    fn note_range(&mut self, field: &Field, scale: f64, offset: f64) {
        let bounds = field.grid.bounds();
        let [one, other] = [bounds.min, bounds.max].map(|value| scale * f64::from(value) + offset);
        let (least, greatest) = (one.min(other), one.max(other));
        let mut note = format!("{}: temperatures from {least:.0} to {greatest:.0} K", self.name);
        if greatest < 800.0 {
            note += ", which is too cold to be seen; `temperature.scale` and `temperature.offset` make kelvin of the grid's values";
        }
        self.notes.push(note);
    }
}
