//! Lights: infinite, distant, point, spot, and surfaces that shine.
//!
//! `scale`, `power` and `illuminance` are what pbrt-v4's `lights.cpp` makes of them; see also [`super::spectra`].

use std::f64::consts::PI;

use glam::{DAffine3, DVec3};
use tyndall_scene::description::{
    ConstantLightDescription, DistantLightDescription, ImageFilter, ImageLightDescription, ImageMapping,
    LightDescription, PointLightDescription, SpotFalloff, SpotLightDescription, SurfaceEmission,
};

use super::context::Context;
use super::directives::Entity;
use super::spectra;
use crate::ImportError;

/// A light; `exposure` is a factor on all light of the scene. `None` if it is left out.
pub(super) fn light(
    entity: &Entity,
    to_world: &DAffine3,
    exposure: f64,
    context: &Context,
) -> Result<Option<LightDescription>, ImportError> {
    let lamp = Lamp { entity, to_world, context, scale: exposure * positive(entity, "scale", 1.0)? };
    let made = match entity.kind.as_str() {
        "infinite" => lamp.infinite()?,
        "distant" => lamp.distant()?,
        "point" => lamp.point()?,
        "spot" => lamp.spot()?,
        "goniometric" => {
            context.unsupported(&entity.place, "a \"goniometric\" light shines equally in all directions");
            entity.parameters.pass(&["filename"]);
            lamp.point()?
        }
        "projection" => {
            context.unsupported(&entity.place, "a \"projection\" light is left out");
            return Ok(None);
        }
        kind => return Err(entity.place.error(format!("\"{kind}\" is no light of pbrt-v4"))),
    };
    context.tell_unused("LightSource", entity);
    Ok(Some(made))
}

struct Lamp<'a> {
    entity: &'a Entity,
    to_world: &'a DAffine3,
    context: &'a Context<'a>,
    scale: f64,
}

impl Lamp<'_> {
    fn infinite(&self) -> Result<LightDescription, ImportError> {
        let (parameters, place) = (&self.entity.parameters, &self.entity.place);
        let illuminance = parameters.float("illuminance")?.filter(|lux| *lux > 0.0);
        if parameters.points::<3>("portal")?.is_some() {
            self.context
                .unsupported(place, "the portal of an infinite light is left out: it shines from everywhere");
        }
        let colour = parameters.colour("L");
        let Some(name) = parameters.text("filename")? else {
            let scale = self.scale * illuminance.map_or(1.0, |lux| lux / PI);
            let radiance = spectra::light(colour, scale, self.context)?;
            return Ok(LightDescription::Constant(ConstantLightDescription { radiance }));
        };
        if colour.is_some() {
            return Err(place.error("an infinite light has both `L` and `filename`: keep one"));
        }
        if illuminance.is_some() {
            let message = "the `illuminance` of a picture is left out: its radiance is what the file says";
            self.context.unsupported(place, message);
        }
        let m = self.to_world.matrix3;
        let rotation = glam::DMat3::from_cols(
            m.x_axis.normalize_or_zero(),
            m.y_axis.normalize_or_zero(),
            m.z_axis.normalize_or_zero(),
        );
        let off = rotation.transpose() * rotation - glam::DMat3::IDENTITY;
        if off.to_cols_array().iter().any(|number| number.abs() > 1e-6) {
            return Err(place.error("the transform of an infinite light shears it: turn it only"));
        }
        let rows = rotation.transpose();
        let orientation = Some(rows.to_cols_array()).filter(|_| rotation != glam::DMat3::IDENTITY);
        Ok(LightDescription::Image(ImageLightDescription {
            file: self.context.file(name, place)?,
            mapping: ImageMapping::EqualArea,
            orientation,
            rotation: 0.0,
            scale: self.scale,
            filter: ImageFilter::Bilinear,
        }))
    }

    /// Where the light is, and where it shines to.
    fn axis(&self) -> Result<(DVec3, DVec3), ImportError> {
        let end = |name: &str, default: DVec3| -> Result<DVec3, ImportError> {
            Ok(self.entity.parameters.exactly::<3>(name)?.map_or(default, DVec3::from_array))
        };
        let (from, to) = (end("from", DVec3::ZERO)?, end("to", DVec3::Z)?);
        let direction = self.to_world.transform_vector3(to - from).try_normalize();
        let message = "the light has `from` and `to` at one place: give a direction";
        let direction = direction.ok_or_else(|| self.entity.place.error(message))?;
        Ok((self.to_world.transform_point3(from), direction))
    }

    fn distant(&self) -> Result<LightDescription, ImportError> {
        let parameters = &self.entity.parameters;
        let illuminance = parameters.float("illuminance")?.filter(|lux| *lux > 0.0).unwrap_or(1.0);
        let irradiance = spectra::light(parameters.colour("L"), self.scale * illuminance, self.context)?;
        let (_, direction) = self.axis()?;
        Ok(LightDescription::Distant(DistantLightDescription { direction: direction.to_array(), irradiance }))
    }

    fn point(&self) -> Result<LightDescription, ImportError> {
        let parameters = &self.entity.parameters;
        let power = parameters.float("power")?.filter(|power| *power > 0.0);
        let scale = self.scale * power.map_or(1.0, |power| power / (4.0 * PI));
        let intensity = spectra::light(parameters.colour("I"), scale, self.context)?;
        let from = parameters.exactly::<3>("from")?.map_or(DVec3::ZERO, DVec3::from_array);
        let position = self.to_world.transform_point3(from).to_array();
        Ok(LightDescription::Point(PointLightDescription { position, intensity }))
    }

    fn spot(&self) -> Result<LightDescription, ImportError> {
        let (parameters, place) = (&self.entity.parameters, &self.entity.place);
        let angle = parameters.float_or("coneangle", 30.0)?;
        let inner_angle = angle - parameters.float_or("conedeltaangle", 5.0)?;
        if !(angle > 0.0 && angle <= 180.0 && inner_angle <= angle) {
            return Err(
                place.error("the cone of a spot light needs 0 < coneangle <= 180 and conedeltaangle >= 0")
            );
        }
        let inner_angle = inner_angle.max(0.0);
        let power = parameters.float("power")?.filter(|power| *power > 0.0);
        let [cos_end, cos_start] = [angle, inner_angle].map(|angle| libm::cos(angle.to_radians()));
        let solid_angle = 2.0 * PI * ((1.0 - cos_start) + (cos_start - cos_end) / 2.0);
        let scale = self.scale * power.map_or(1.0, |power| power / solid_angle);
        let intensity = spectra::light(parameters.colour("I"), scale, self.context)?;
        let (position, direction) = self.axis()?;
        Ok(LightDescription::Spot(SpotLightDescription {
            position: position.to_array(),
            direction: direction.to_array(),
            intensity,
            angle,
            inner_angle,
            falloff: SpotFalloff::Smooth,
        }))
    }
}

/// The light of a surface. `area` is that of the shape in the world and the number of its parts, each of which pbrt
/// gives the `power`, if they are known.
pub(super) fn emission(
    entity: &Entity,
    area: Option<(f64, usize)>,
    exposure: f64,
    context: &Context,
) -> Result<SurfaceEmission, ImportError> {
    let (parameters, place) = (&entity.parameters, &entity.place);
    if entity.kind != "diffuse" {
        return Err(
            place.error(format!("\"{}\" is no area light of pbrt-v4: there is \"diffuse\"", entity.kind))
        );
    }
    let mut scale = exposure * positive(entity, "scale", 1.0)?;
    let two_sided = parameters.flag("twosided")?.unwrap_or(false);
    if let Some(power) = parameters.float("power")?.filter(|power| *power > 0.0) {
        let sides = if two_sided { 2.0 } else { 1.0 };
        match area {
            Some((area, parts)) if area > 0.0 => scale *= power * parts as f64 / (sides * PI * area),
            _ => context.unsupported(place, "the `power` of a lamp of this shape is left out: its `L` holds"),
        }
        if area.is_some_and(|(_, parts)| parts > 1) {
            context.choice(
                place,
                "the `power` of a lamp of triangles is that of each, as in pbrt, spread evenly",
            );
        }
    }
    if parameters.text("filename")?.is_some() {
        context.unsupported(place, "the picture of a lamp is left out: it is white");
    }
    let radiance = spectra::light(parameters.colour("L"), scale, context)?;
    context.tell_unused("AreaLightSource", entity);
    Ok(SurfaceEmission { radiance, scale: 1.0, two_sided })
}

fn positive(entity: &Entity, name: &str, default: f64) -> Result<f64, ImportError> {
    let number = entity.parameters.float_or(name, default)?;
    if number >= 0.0 {
        return Ok(number);
    }
    Err(entity.place.error(format!("`{name}` must be at least 0")))
}
