//! `<medium>`: participating media.
//!
//! Coefficients are `scale` times `sigma_t`, of which the fraction `albedo` scatters. A heterogeneous medium lies in the
//! box of its `sigma_t`, the unit cube under `to_world`, and only there; and, as every medium, only in shapes that have
//! it for `interior`. A medium that is inside no shape, but that of the camera, fills the scene.

use glam::{DAffine3, DVec3};
use tyndall_scene::description::{
    AlbedoGridDescription, BoxShape, GridFilter, MediumDescription, SpectrumDescription,
    TransformDescription, VolumeDescription,
};

use super::boundaries::{Extent, MediumVolumes};
use super::grid::{GridFile, Placed};
use super::importer::Importer;
use super::object::{Class, Object, Value};
use super::spectrum::Role;
use super::transform::Transform;
use crate::ImportError;
use crate::affine::is_flat;

/// A quantity of a medium.
enum Quantity {
    /// The same everywhere within the unit cube under a transform.
    Constant(SpectrumDescription, Transform),
    /// A grid.
    Grid(Placed, GridFilter),
}

impl<'a> Importer<'a> {
    /// Names of the volumes that a medium is.
    pub fn medium(&mut self, number: usize) -> Result<Vec<String>, ImportError> {
        if let Some(names) = self.media.get(&number) {
            return Ok(names.clone());
        }
        let object = self.object(number);
        let name = self.name(object);
        let (volumes, extent) = self.within(number, |importer| importer.volumes(object, &name))?;
        let names: Vec<String> = volumes.iter().filter_map(|volume| volume.name.clone()).collect();
        self.volumes.extend(volumes);
        self.media.insert(number, names.clone());
        self.medium_volumes.push(MediumVolumes { names: names.clone(), extent });
        Ok(names)
    }

    /// The volumes of a medium, and where they are.
    fn volumes(
        &mut self,
        object: &'a Object,
        name: &str,
    ) -> Result<(Vec<VolumeDescription>, Option<Extent>), ImportError> {
        object.ignore(&["has_spectral_extinction", "sample_emitters"]);
        let is_homogeneous = match object.plugin.as_str() {
            "homogeneous" => true,
            "heterogeneous" => false,
            _ => {
                let message = format!("{} is not supported: a homogeneous one is taken", object.title());
                self.unsupported(&object.place, message);
                true
            }
        };
        let phase = match self.child(object, Class::Phase) {
            Some(number) => self.phase(number)?,
            None => None,
        };
        let scale = object.float("scale", 1.0)?;
        if scale < 0.0 {
            return Err(object.place.error("the `scale` of the medium is negative: mend it"));
        }
        if scale > 1e12 {
            return Err(object.place.error("the `scale` of the medium is too large to compute with"));
        }
        if object.get("material").is_some() {
            self.unsupported(
                &object.place,
                "media by the name of a `material` are not supported: give `sigma_t` and `albedo`",
            );
        }
        let named = |name: String| VolumeDescription {
            name: Some(name),
            medium: MediumDescription { phase: phase.clone(), ..MediumDescription::default() },
            ..VolumeDescription::default()
        };
        let mut volume = named(name.to_owned());
        if object.get("sigma_a").is_some() || object.get("sigma_s").is_some() {
            volume.medium.mu_a = Some(self.spectrum(object, "sigma_a", Role::Coefficient, 0.0)?);
            volume.medium.mu_s = Some(self.spectrum(object, "sigma_s", Role::Coefficient, 0.0)?);
            volume.medium.scale = Some(scale).filter(|scale| *scale != 1.0);
            self.tell_unused(object);
            return Ok((vec![volume], None));
        }
        // Mitsuba 0.x calls the extinction of grids so.
        let sigma_t = if object.get("density").is_some() { "density" } else { "sigma_t" };
        let extinction = self.quantity(object, sigma_t, Role::Coefficient, 1.0)?;
        let albedo = self.quantity(object, "albedo", Role::Fraction, 0.75)?;
        self.tell_unused(object);
        let mut extent = None;
        let mut volumes = match extinction {
            Quantity::Constant(mu_t, transform) => {
                (volume.medium.mu_t, volume.medium.scale) = scaled(mu_t, scale);
                if !is_homogeneous {
                    volume.cuboid = Some(BoxShape { min: [0.0; 3], max: [1.0; 3] });
                    volume.transform = Transform::describe(&transform.map);
                    let support = [DVec3::ZERO, DVec3::ONE];
                    extent = Some(Extent { to_world: transform.map, support, is_box: true });
                }
                vec![volume]
            }
            Quantity::Grid(placed, filter) => {
                if is_homogeneous {
                    self.unsupported(
                        &object.place,
                        "a homogeneous medium with a grid for `sigma_t` varies here",
                    );
                }
                let grids = placed.split(self.sidecar)?;
                extent = Some(placed.extent());
                let is_one = grids.len() == 1;
                let mut volumes = Vec::new();
                for (channel, grid) in grids.into_iter().enumerate() {
                    // Where the extinction has colours, each is a volume of its own: coefficients add.
                    let mut volume = if is_one {
                        volume.clone()
                    } else {
                        named(format!("{name}.{}", ["red", "green", "blue"][channel]))
                    };
                    let mut mu_t = [0.0; 3];
                    mu_t[channel] = scale;
                    volume.medium.mu_t = Some(if is_one { scale.into() } else { mu_t.into() });
                    volume.filter = Some(filter).filter(|filter| *filter != GridFilter::default());
                    volume.transform = Transform::describe(&grid.transform);
                    volume.file = Some(grid.file);
                    volumes.push(volume);
                }
                volumes
            }
        };
        match albedo {
            Quantity::Constant(albedo, _) => {
                for volume in &mut volumes {
                    volume.medium.albedo = Some(albedo.clone());
                }
            }
            Quantity::Grid(placed, filter) => {
                for volume in &mut volumes {
                    if filter != volume.filter.unwrap_or_default() && volume.file.is_some() {
                        let message =
                            "an `albedo` that is filtered otherwise than `sigma_t` is filtered as that is";
                        self.unsupported(&object.place, message);
                    } else if volume.file.is_none() && filter != GridFilter::default() {
                        self.unsupported(&object.place, "the grid of the `albedo` is filtered trilinearly");
                    }
                    let own =
                        volume.transform.as_ref().map_or(DAffine3::IDENTITY, TransformDescription::to_affine);
                    let file = placed.file_in(&own, self.sidecar)?;
                    volume.medium.albedo = Some(1.0.into());
                    volume.albedo_grid = Some(AlbedoGridDescription { file: Some(file), grid: None });
                }
            }
        }
        Ok((volumes, extent))
    }

    /// A quantity that may be a `<volume>`.
    fn quantity(
        &mut self,
        object: &'a Object,
        name: &str,
        role: Role,
        default: f64,
    ) -> Result<Quantity, ImportError> {
        let property = object.get(name);
        let Some(Value::Object(number)) = property.map(|property| &property.value) else {
            return Ok(Quantity::Constant(self.spectrum(object, name, role, default)?, Transform::default()));
        };
        let volume = self.object(*number);
        if volume.class != Class::Volume {
            return Ok(Quantity::Constant(self.spectrum(object, name, role, default)?, Transform::default()));
        }
        let transform = volume.transform("to_world")?;
        if is_flat(&transform.map) {
            return Err(volume.place.error("the `to_world` of the volume is flat: no factor may be 0"));
        }
        let quantity = match volume.plugin.as_str() {
            "constvolume" => Quantity::Constant(self.spectrum(volume, "value", role, 1.0)?, transform),
            "gridvolume" => self.grid(volume, transform)?,
            _ => {
                let message = format!("{} is not supported: {default} is taken", volume.title());
                self.unsupported(&volume.place, message);
                return Ok(Quantity::Constant(default.into(), transform));
            }
        };
        self.tell_unused(volume);
        Ok(quantity)
    }

    fn grid(&mut self, volume: &'a Object, transform: Transform) -> Result<Quantity, ImportError> {
        volume.ignore(&["raw", "accel", "max_value"]);
        let Some(name) = volume.text("filename")? else {
            return Err(volume.place.error("the gridvolume has no `filename`: add it"));
        };
        let path = self.document.find(name, &volume.place)?;
        let filter = match volume.text("filter_type")? {
            Some("nearest") => GridFilter::Nearest,
            _ => GridFilter::Trilinear,
        };
        if !matches!(volume.text("wrap_mode")?, None | Some("clamp")) {
            let message = "a `wrap_mode` other than `clamp` is not supported: values at the border go on";
            self.unsupported(&volume.place, message);
        }
        let uses_box = volume.boolean("use_grid_bbox", false)?;
        let file = GridFile::read(&path, uses_box)?;
        let map = if uses_box { transform.map } else { transform.map * file.box_to_unit_cube() };
        let is_large = map.to_cols_array().iter().any(|entry| entry.abs() > 1e30);
        if is_large || is_flat(&map) {
            return Err(volume
                .place
                .error("the `to_world` is too large or too small for this grid: mend its factors"));
        }
        Ok(Quantity::Grid(
            Placed { file, transform: map, filter_reaches_out: filter == GridFilter::Trilinear },
            filter,
        ))
    }
}

/// A coefficient and the factor on it, which is put into it if it is grey.
fn scaled(mu_t: SpectrumDescription, scale: f64) -> (Option<SpectrumDescription>, Option<f64>) {
    match mu_t {
        SpectrumDescription::Grey(value) => (Some((value * scale).into()), None),
        SpectrumDescription::Channels(channels) => (Some(channels.map(|value| value * scale).into()), None),
        table => (Some(table), Some(scale).filter(|scale| *scale != 1.0)),
    }
}
