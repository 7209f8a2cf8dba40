//! Media: homogeneous ones, grids that the scene file writes out, NanoVDB files, and pbrt-v4's cloud.
//!
//! A grid's values stand at the centres of its cells and are interpolated; beyond its outermost centres they fall to 0
//! within one cell, and where the grid's box ends there is nothing.
//!
//! pbrt's film sums X, Y and Z over wavelengths without dividing by ∫ ȳ, and its lights are normalised for that; what
//! is not normalised (black bodies in grids, the `Le` of an rgbgrid) comes out brighter by ∫ ȳ.

use glam::{DAffine3, DVec3};
use tyndall_optics::cie::Y_INTEGRAL_NM;
use tyndall_optics::presets::measured_medium;
use tyndall_scene::description::{
    EmissionGridDescription, MediumDescription, PhaseDescription, SpectrumDescription,
    TemperatureDescription, VolumeDescription,
};
use tyndall_volumes::{Grid, GridSelection, GridValues, ReadRequest, Tree};

use super::cloud;
use super::context::{Context, text_of};
use super::directives::Entity;
use super::grids::{Cells, Lattice};
use super::parameters::Parameters;
use super::spectra;
use super::transforms;
use super::world::Medium;
use crate::{ImportError, affine};

/// A box by its corners.
pub(super) type Corners = [DVec3; 2];

/// A medium in Tyndall's words.
#[derive(Debug)]
pub(super) enum Matter {
    /// The same everywhere.
    Homogeneous(Box<MediumDescription>),
    /// Grids, which overlap.
    Grids {
        /// One or several volumes, their transforms included; they have no names yet.
        volumes: Vec<VolumeDescription>,
        /// Outside this box of the medium's space there is nothing; not stated for files.
        bounds: Option<Corners>,
        /// In the medium's space, a box around all that is not 0; without end if that is not known.
        support: Corners,
    },
}

/// Space without end.
pub(super) const EVERYWHERE: Corners = [DVec3::NEG_INFINITY, DVec3::INFINITY];

/// The matter of a medium; `exposure` is a factor on all light of the scene.
pub(super) fn matter(
    name: &str,
    medium: &Medium,
    exposure: f64,
    context: &Context,
) -> Result<Matter, ImportError> {
    let entity = &medium.entity;
    let (parameters, place) = (&entity.parameters, &entity.place);
    let Some(kind) = parameters.text("type")? else {
        return Err(place.error("the medium needs its \"string type\""));
    };
    let maker = Maker { name, entity, to_world: medium.to_world, exposure, context };
    let matter = match kind {
        "homogeneous" => Matter::Homogeneous(Box::new(maker.homogeneous()?)),
        "uniformgrid" => maker.uniform_grid()?,
        "rgbgrid" => maker.rgb_grid()?,
        "cloud" => maker.cloud()?,
        "nanovdb" => maker.nano_vdb()?,
        _ => return Err(place.error(format!("\"{kind}\" is no medium of pbrt-v4"))),
    };
    context.tell_unused("MakeNamedMedium", entity);
    Ok(matter)
}

pub(super) struct Maker<'a> {
    pub name: &'a str,
    pub entity: &'a Entity,
    pub to_world: DAffine3,
    pub exposure: f64,
    pub context: &'a Context<'a>,
}

impl Maker<'_> {
    fn parameters(&self) -> &Parameters {
        &self.entity.parameters
    }

    fn error(&self, message: impl Into<String>) -> ImportError {
        self.entity.place.error(message)
    }

    /// Coefficients and phase function; without emission.
    fn medium(&self) -> Result<MediumDescription, ImportError> {
        let coefficient = |name: &str| match self.parameters().colour(name) {
            Some(parameter) => spectra::coefficient(parameter, self.context),
            None => Ok(SpectrumDescription::Grey(1.0)),
        };
        let (mu_a, mu_s) = (coefficient("sigma_a")?, coefficient("sigma_s")?);
        let scale = self.scale()?;
        Ok(MediumDescription {
            mu_a: Some(mu_a),
            mu_s: Some(mu_s),
            scale: Some(scale).filter(|scale| *scale != 1.0),
            phase: self.phase()?,
            ..MediumDescription::default()
        })
    }

    /// Factor on the coefficients.
    pub(super) fn scale(&self) -> Result<f64, ImportError> {
        let scale = self.parameters().float_or("scale", 1.0)?;
        if scale >= 0.0 { Ok(scale) } else { Err(self.error("`scale` must be at least 0")) }
    }

    pub(super) fn phase(&self) -> Result<Option<PhaseDescription>, ImportError> {
        let g = self.parameters().float_or("g", 0.0)?;
        if g.abs() >= 1.0 {
            return Err(self.error("`g` must be above -1 and below 1"));
        }
        Ok(Some(PhaseDescription::Hg { g }).filter(|_| g != 0.0))
    }

    /// The light `Le` times a factor, if there is any.
    fn emission(&self, factor: f64) -> Result<Option<SpectrumDescription>, ImportError> {
        let Some(parameter) = self.parameters().colour("Le") else { return Ok(None) };
        let light = spectra::light(Some(parameter), factor * self.exposure, self.context)?;
        Ok(Some(light).filter(|light| *light != SpectrumDescription::Grey(0.0)))
    }

    fn homogeneous(&self) -> Result<MediumDescription, ImportError> {
        let preset = self.parameters().text("preset")?.filter(|preset| !preset.is_empty());
        let mut medium = self.medium()?;
        if let Some(preset) = preset {
            let Some(measured) = measured_medium(preset) else {
                let message =
                    format!("there is no measured medium \"{preset}\": give `sigma_a` and `sigma_s`");
                return Err(self.error(message));
            };
            self.context.choice(
                &self.entity.place,
                "a measured medium is in 1/mm and has the reduced scattering coefficient, as in pbrt",
            );
            let reduced = measured.mu_s * (DVec3::ONE - measured.g);
            medium.mu_a = Some(spectra::grey_or_channels(measured.mu_a.to_array()));
            medium.mu_s = Some(spectra::grey_or_channels(reduced.to_array()));
        }
        medium.emission = self.emission(self.parameters().float_or("Lescale", 1.0)?)?;
        Ok(medium)
    }

    /// The lattice of a grid that is written out: cells along x, y, z and the box they fill.
    pub(super) fn lattice(&self) -> Result<Lattice, ImportError> {
        let mut cells = [0; 3];
        for (count, name) in cells.iter_mut().zip(["nx", "ny", "nz"]) {
            *count = match self.parameters().integer(name)?.unwrap_or(1) {
                number @ 1..=1_000_000 => number as usize,
                _ => return Err(self.error(format!("`{name}` must be from 1 to 1,000,000"))),
            };
        }
        Ok(Lattice { cells, bounds: self.bounds()? })
    }

    fn bounds(&self) -> Result<Corners, ImportError> {
        let corner = |name: &str, default: f64| -> Result<DVec3, ImportError> {
            let point = self.parameters().exactly::<3>(name)?;
            Ok(point.map_or(DVec3::splat(default), DVec3::from_array))
        };
        let (p0, p1) = (corner("p0", 0.0)?, corner("p1", 1.0)?);
        if (p0 - p1).abs().min_element() > 0.0 && (p0 - p1).is_finite() {
            return Ok([p0.min(p1), p0.max(p1)]);
        }
        Err(self.error("the box from `p0` to `p1` is flat: give it a volume"))
    }

    /// A volume whose density is a grid in a file of its own; `None` if that is 0 everywhere.
    pub(super) fn volume(
        &self,
        suffix: &str,
        cells: &Cells,
        medium: MediumDescription,
    ) -> Result<Option<VolumeDescription>, ImportError> {
        let Some(file) = self.grid_file(suffix, cells)? else { return Ok(None) };
        let transform = transforms::description(&self.to_world);
        Ok(Some(VolumeDescription { file: Some(file), transform, medium, ..VolumeDescription::default() }))
    }

    /// Path of a new file with a grid; `None` if the grid is 0 everywhere.
    pub(super) fn grid_file(&self, suffix: &str, cells: &Cells) -> Result<Option<String>, ImportError> {
        if cells.support().is_none() {
            return Ok(None);
        }
        let path = self.context.sidecar.write_grid(&format!("{}{suffix}", self.name), &cells.grid())?;
        text_of(&path, &self.entity.place).map(Some)
    }

    pub(super) fn tell_empty(&self) {
        self.context
            .choice(&self.entity.place, format!("the medium \"{}\" is empty and left out", self.name));
    }

    fn uniform_grid(&self) -> Result<Matter, ImportError> {
        let lattice = self.lattice()?;
        let Some(density) = self.cells("density", lattice)? else {
            return Err(self.error("a \"uniformgrid\" needs its `density`"));
        };
        let glow = self.cells("Lescale", lattice)?;
        let temperature = self.cells("temperature", lattice)?;
        let mut medium = self.medium()?;
        if temperature.is_some() && self.parameters().colour("Le").is_some() {
            return Err(self.error("the medium has both `Le` and `temperature`: keep one"));
        }
        medium.emission = self.emission(1.0)?;
        let glows = medium.emission.is_some() || temperature.is_some();
        let Some(mut volume) = self.volume("", &density, medium)? else {
            self.tell_empty();
            return Ok(Matter::Grids { volumes: Vec::new(), bounds: None, support: EVERYWHERE });
        };
        if let Some(glow) = glow.filter(|_| glows) {
            match self.grid_file("_glow", &glow)? {
                Some(file) => volume.emission_grid = Some(emission_grid(file)),
                None => volume.medium.emission = None,
            }
        }
        if let Some(temperature) = temperature
            && let Some(file) = self.grid_file("_temperature", &temperature)?
        {
            volume.temperature = Some(self.temperature(Some(file), None)?);
            volume.emission_scale = Some(self.exposure * Y_INTEGRAL_NM);
        }
        let support = density.support().unwrap_or(EVERYWHERE);
        Ok(Matter::Grids { volumes: vec![volume], bounds: Some(lattice.bounds), support })
    }

    /// The numbers of a parameter as cells.
    fn cells(&self, name: &str, lattice: Lattice) -> Result<Option<Cells>, ImportError> {
        let Some(values) = self.parameters().floats(name) else { return Ok(None) };
        let cells = Cells::new(lattice, values.iter().copied());
        cells.map(Some).map_err(|message| self.error(format!("`{name}`: {message}")))
    }

    /// Light of black bodies, each brought to 1 where its spectrum is greatest: T = (value − offset) · scale.
    fn temperature(
        &self,
        file: Option<String>,
        grid: Option<String>,
    ) -> Result<TemperatureDescription, ImportError> {
        let parameters = self.parameters();
        let cutoff = parameters.float_or("temperaturecutoff", 0.0)?;
        let offset = parameters.float_or("temperatureoffset", cutoff)?;
        let scale = parameters.float_or("temperaturescale", 1.0)?;
        // Without this a product of 0 and an offset would be -0.
        let offset = if offset == 0.0 { 0.0 } else { -offset * scale };
        Ok(TemperatureDescription { file, grid, scale, offset, normalised: true })
    }

    fn cloud(&self) -> Result<Matter, ImportError> {
        let parameters = self.parameters();
        let shape = cloud::Shape {
            density: parameters.float_or("density", 1.0)?,
            wispiness: parameters.float_or("wispiness", 1.0)?,
            frequency: parameters.float_or("frequency", 5.0)?,
        };
        let bounds = self.bounds()?;
        let cells = shape.cells(bounds);
        let [nx, ny, nz] = cells.lattice.cells;
        let message = format!("the noise of a \"cloud\" is kept as a grid of {nx} x {ny} x {nz} cells");
        self.context.choice(&self.entity.place, message);
        let Some(volume) = self.volume("", &cells, self.medium()?)? else {
            self.tell_empty();
            return Ok(Matter::Grids { volumes: Vec::new(), bounds: None, support: EVERYWHERE });
        };
        let support = cells.support().unwrap_or(EVERYWHERE);
        Ok(Matter::Grids { volumes: vec![volume], bounds: Some(bounds), support })
    }

    fn nano_vdb(&self) -> Result<Matter, ImportError> {
        let (parameters, place) = (self.parameters(), &self.entity.place);
        let Some(name) = parameters.text("filename")? else {
            return Err(self.error("a \"nanovdb\" medium needs a `filename`"));
        };
        let file = self.context.file(name, place)?;
        let request = ReadRequest { grids: GridSelection::All, raw: None };
        let content = tyndall_volumes::read(file.as_ref(), &request);
        let content = content.map_err(|error| self.error(error.to_string()))?;
        let find = |name: &str| content.grids.iter().find(|grid| grid.name == name);
        let density_name = parameters.text("gridname")?.unwrap_or("density");
        let Some(density) = find(density_name) else {
            let names: Vec<String> = content.grids.iter().map(|grid| format!("\"{}\"", grid.name)).collect();
            let message = format!(
                "{file} has no grid \"{density_name}\": give `gridname` as one of {}",
                names.join(", ")
            );
            return Err(self.error(message));
        };
        let mut volume = VolumeDescription {
            file: Some(file),
            grid: Some(density_name.to_owned()),
            transform: transforms::description(&self.to_world),
            medium: self.medium()?,
            ..VolumeDescription::default()
        };
        let glow = parameters.float_or("Lescale", 1.0)?;
        let temperature_name = parameters.text("temperaturename")?.unwrap_or("temperature");
        let temperature = self.temperature(None, Some(temperature_name.to_owned()))?;
        if glow > 0.0 && find(temperature_name).is_some() {
            volume.temperature = Some(temperature);
            volume.emission_scale = Some(glow * self.exposure * Y_INTEGRAL_NM);
        }
        // pbrt also cuts the interpolated values off at the least voxel of the file's box, though not at the greatest:
        // half a voxel at one side only, which is left.
        Ok(Matter::Grids { volumes: vec![volume], bounds: None, support: support(density) })
    }
}

pub(super) fn emission_grid(file: String) -> EmissionGridDescription {
    EmissionGridDescription { file: Some(file), grid: None, scale: 1.0 }
}

/// A box in the file's world around all places where the interpolated values are not 0.
fn support(grid: &Grid) -> Corners {
    let GridValues::Float(tree) = &grid.values else { return EVERYWHERE };
    let Some([least, greatest]) = index_support(tree) else { return EVERYWHERE };
    affine::map_box(&grid.index_to_world, [least - DVec3::ONE, greatest + DVec3::ONE])
}

/// Least and greatest index coordinates of voxels that are not 0; `None` if these are without end.
fn index_support(tree: &Tree<f32>) -> Option<Corners> {
    if tree.background != 0.0 {
        return None;
    }
    let mut found = [DVec3::INFINITY, DVec3::NEG_INFINITY];
    let mut grow = |least: DVec3, greatest: DVec3| {
        found = [found[0].min(least), found[1].max(greatest)];
    };
    let origin = |origin: [i32; 3]| DVec3::from_array(origin.map(f64::from));
    for tile in tree.tiles.iter().filter(|tile| tile.value != 0.0) {
        let least = origin(tile.origin);
        grow(least, least + DVec3::splat(f64::from((1_u32 << tile.log2_edge.min(16)) - 1)));
    }
    for (leaf, values) in tree.leaves.iter().zip(tree.leaf_values.chunks(tyndall_volumes::LEAF_VOXELS)) {
        let least = origin(leaf.origin);
        for (place, _) in values.iter().enumerate().filter(|(_, value)| **value != 0.0) {
            let [x, y, z] = [place >> 6, place >> 3 & 7, place & 7].map(|index| index as f64);
            let voxel = least + DVec3::new(x, y, z);
            grow(voxel, voxel);
        }
    }
    Some(found)
}
