//! `<emitter>`: lights. Lamps, the emitters of shapes, are told by [`super::shape`].
//!
//! Lamps with a transform shine along +z. A picture of the surroundings has −z at its left edge and +x a quarter further
//! to the right; Tyndall's has −z in the middle, which is half a turn about +y.

use glam::{DMat3, DVec3};
use tyndall_scene::description::{
    ConstantLightDescription, DistantLightDescription, ImageFilter, ImageLightDescription, ImageMapping,
    LightDescription, PointLightDescription, SkyDescription, SpotFalloff, SpotLightDescription,
    SunLightDescription,
};

use super::importer::Importer;
use super::object::Object;
use super::spectrum::Role;
use super::transform::plain;
use crate::ImportError;

impl<'a> Importer<'a> {
    /// An emitter that is on no shape.
    pub fn emitter(&mut self, number: usize) -> Result<(), ImportError> {
        let object = self.object(number);
        object.ignore(&["sampling_weight", "mis_compensation", "medium"]);
        let light = match object.plugin.as_str() {
            "constant" => LightDescription::Constant(ConstantLightDescription {
                radiance: self.spectrum(object, "radiance", Role::Light, 1.0)?,
            }),
            "envmap" => self.surroundings(object)?,
            "point" => {
                let place = object.transform("to_world")?.map.translation;
                let position = object.vector("position")?.unwrap_or(place.to_array()).map(plain);
                let intensity = self.spectrum(object, "intensity", Role::Light, 1.0)?;
                LightDescription::Point(PointLightDescription { position, intensity })
            }
            "spot" => self.spot(object)?,
            "directional" => {
                let along = object.transform("to_world")?.map.matrix3.z_axis;
                let direction = object.vector("direction")?.unwrap_or(along.to_array());
                let direction = self.direction(object, direction)?;
                let irradiance = self.spectrum(object, "irradiance", Role::Light, 1.0)?;
                LightDescription::Distant(DistantLightDescription { direction, irradiance })
            }
            "sunsky" | "sky" | "sun" | "timed_sunsky" => self.sky(object)?,
            _ => {
                let message = format!("{} is not supported and is left out", object.title());
                self.unsupported(&object.place, message);
                return Ok(());
            }
        };
        self.tell_unused(object);
        self.lights.push(light);
        Ok(())
    }

    fn direction(&self, object: &Object, direction: [f64; 3]) -> Result<[f64; 3], ImportError> {
        match DVec3::from_array(direction).try_normalize() {
            Some(_) => Ok(direction.map(plain)),
            None => Err(object.place.error(format!("the direction of {} is 0: mend it", object.title()))),
        }
    }

    fn surroundings(&mut self, object: &'a Object) -> Result<LightDescription, ImportError> {
        let Some(name) = object.text("filename")? else {
            return Err(object.place.error("the envmap has no `filename`: add it"));
        };
        let path = self.document.find(name, &object.place)?;
        let scale = object.float("scale", 1.0)?;
        if scale < 0.0 {
            return Err(object.place.error("the `scale` of the envmap is negative: mend it"));
        }
        let turn = object.transform("to_world")?.map.matrix3;
        let columns = [turn.x_axis, turn.y_axis, turn.z_axis].map(DVec3::normalize_or_zero);
        let turn = DMat3::from_cols(columns[0], columns[1], columns[2]);
        if (turn.determinant().abs() - 1.0).abs() > 1e-6 {
            return Err(object
                .place
                .error("the `to_world` of the envmap is no rotation: leave out what deforms"));
        }
        let half_turn = DMat3::from_diagonal(DVec3::new(-1.0, 1.0, -1.0));
        let orientation = turn * half_turn;
        let (rotation, orientation) = match about_y(orientation) {
            Some(degrees) => (degrees, None),
            None => (0.0, Some(orientation.transpose().to_cols_array().map(plain))),
        };
        Ok(LightDescription::Image(ImageLightDescription {
            file: path.to_string_lossy().into_owned(),
            mapping: ImageMapping::Equirectangular,
            orientation,
            rotation,
            scale,
            filter: ImageFilter::Bilinear,
        }))
    }

    fn spot(&mut self, object: &'a Object) -> Result<LightDescription, ImportError> {
        let map = object.transform("to_world")?.map;
        let direction = self.direction(object, map.matrix3.z_axis.to_array())?;
        let angle = object.float("cutoff_angle", 20.0)?;
        let inner_angle = object.float("beam_width", 0.75 * angle)?;
        if !(angle > 0.0 && angle <= 180.0) {
            return Err(object.place.error("the `cutoff_angle` must be above 0 and at most 180 degrees"));
        }
        if object.get("texture").is_some() {
            self.unsupported(&object.place, "the `texture` of a spot is not supported: it shines without");
        }
        Ok(LightDescription::Spot(SpotLightDescription {
            position: map.translation.to_array().map(plain),
            direction,
            intensity: self.spectrum(object, "intensity", Role::Light, 1.0)?,
            angle,
            inner_angle: inner_angle.clamp(0.0, angle),
            falloff: SpotFalloff::Linear,
        }))
    }

    fn sky(&mut self, object: &'a Object) -> Result<LightDescription, ImportError> {
        let message = "the sky is Tyndall's own model, which has another brightness and colour: a white surface under 100,000 lux has radiance 1";
        self.unsupported(&object.place, message);
        let turn = object.transform("to_world")?.map.matrix3;
        let up = turn.z_axis.normalize_or_zero();
        if up.distance(DVec3::Y) > 1e-6 {
            self.unsupported(&object.place, "the sky's zenith is +y, not where `to_world` puts +z");
        }
        let toward = object.vector("sun_direction")?.map(|direction| turn * DVec3::from_array(direction));
        let toward = toward.and_then(DVec3::try_normalize);
        if toward.is_none() {
            self.unsupported(
                &object.place,
                "the sun is not put where date and place say: give `sun_direction`",
            );
        }
        // At night there is no sky to compute.
        let toward_sun =
            toward.filter(|direction| direction.y > -0.1).map(|toward| toward.to_array().map(plain));
        let turbidity = object.float("turbidity", 3.0)?.clamp(1.0, 20.0);
        for property in &object.properties {
            property.is_used.set(true);
        }
        let scale = if object.plugin == "sun" { "sun_scale" } else { "sky_scale" };
        let intensity = object.float(scale, 1.0)?.max(0.0);
        if object.plugin == "sun" {
            let direction = toward.unwrap_or(DVec3::new(-0.5, 0.7, 0.5)) * -1.0;
            return Ok(LightDescription::Sun(SunLightDescription {
                direction: direction.to_array().map(plain),
                irradiance: intensity.into(),
                angular_diameter: 0.533,
            }));
        }
        let sun = object.plugin != "sky" && object.float("sun_scale", 1.0)? > 0.0;
        Ok(LightDescription::Sky(SkyDescription {
            toward_sun,
            turbidity,
            intensity,
            sun,
            ..SkyDescription::default()
        }))
    }
}

/// The angle of a rotation about +y, degrees, if it is one.
fn about_y(turn: DMat3) -> Option<f64> {
    let is_about_y = turn.y_axis.distance(DVec3::Y) < 1e-12 && turn.determinant() > 0.0;
    // The rotation takes +z to (sin, 0, cos).
    is_about_y.then(|| libm::atan2(plain(turn.z_axis.x), turn.z_axis.z).to_degrees())
}
