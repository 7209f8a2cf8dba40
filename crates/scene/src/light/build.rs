//! Descriptions of lights to lights ready to trace.

use std::path::Path;

use glam::DVec3;
use tyndall_optics::{Spectrum, cie};

use super::image::BRIGHTEST;
use super::{
    AreaLight, ConstantLight, DistantLight, ImageLight, Light, PointLight, SpotLight, SunLight, VolumeLight,
    read_light_image,
};
use crate::Volume;
use crate::description::{
    ImageFilter, ImageLightDescription, ImageMapping, LightDescription, ShapeDescription,
    SpectrumDescription, SurfaceEmission,
};
use crate::error::SceneError;
use crate::sky::Sky;
use crate::surface::{Surfaces, WorldPrimitive};

/// Lights ready to trace, and what the user should know of them.
#[derive(Debug, Clone, Default)]
pub struct BuiltLights {
    /// The lights; a sky with its sun is two.
    pub lights: Vec<Light>,
    /// For each light its spectrum at luminance 1, if that is not the one of its red, green and blue.
    pub spectra: Vec<Option<Spectrum>>,
    /// One line each.
    pub warnings: Vec<String>,
}

/// Makes the lights of a scene, whose file names are relative to `folder`, ready.
pub fn build_lights(descriptions: &[LightDescription], folder: &Path) -> Result<BuiltLights, SceneError> {
    let mut built = BuiltLights::default();
    for (number, description) in descriptions.iter().enumerate() {
        let colour = |spectrum: &SpectrumDescription| {
            let place = format!("light.{number}");
            spectrum.light().map_err(|(_, message)| SceneError::file(Path::new(&place), message))
        };
        let mut own_spectrum = None;
        match description {
            LightDescription::Constant(constant) => {
                let radiance = colour(&constant.radiance)?;
                built.lights.push(Light::Constant(ConstantLight::new(radiance.light_rgb())));
                own_spectrum = Some(radiance);
            }
            LightDescription::Image(description) => {
                let path = folder.join(&description.file);
                let (image, warning) = read_light_image(&path)?;
                let (width, height) = (image.width(), image.height());
                if description.mapping == ImageMapping::EqualArea && width != height {
                    return Err(SceneError::file(
                        &path,
                        format!(
                            "has {width} x {height} texels, but a picture of `mapping = \"equal_area\"` is a square"
                        ),
                    ));
                }
                let brightest = description.scale * image.greatest();
                if brightest > f64::from(BRIGHTEST) {
                    return Err(SceneError::file(
                        &path,
                        format!(
                            "`scale` makes it as bright as {brightest:e}, and pictures hold numbers up to 4e9: give a smaller one"
                        ),
                    ));
                }
                let orientation = description.orientation();
                let ImageLightDescription { mapping, filter, scale, .. } = *description;
                let light = ImageLight::mapped(image, mapping, filter, scale, orientation);
                built.lights.push(Light::Image(light));
                built.warnings.extend(warning);
            }
            LightDescription::Sky(description) => {
                let sky = Sky::new(description);
                let light = ImageLight::new(sky.to_image(), ImageFilter::Bilinear, 1.0, 0.0);
                built.lights.push(Light::Image(light));
                if description.sun && sky.sun_irradiance().max_element() > 0.0 {
                    let toward = description.toward_sun();
                    let disc = SunLight::new(toward, sky.sun_irradiance(), description.angular_diameter);
                    built.lights.push(Light::Sun(disc));
                }
            }
            LightDescription::Sun(sun) => {
                let toward = -DVec3::from_array(sun.direction);
                let irradiance = colour(&sun.irradiance)?;
                let disc = SunLight::new(toward, irradiance.light_rgb(), sun.angular_diameter);
                built.lights.push(Light::Sun(disc));
                own_spectrum = Some(irradiance);
            }
            LightDescription::Distant(distant) => {
                let direction = DVec3::from_array(distant.direction);
                let irradiance = colour(&distant.irradiance)?;
                built.lights.push(Light::Distant(DistantLight::new(direction, irradiance.light_rgb())));
                own_spectrum = Some(irradiance);
            }
            LightDescription::Spot(spot) => {
                let [position, direction] = [spot.position, spot.direction].map(DVec3::from_array);
                let intensity = colour(&spot.intensity)?;
                let angles = [spot.inner_angle, spot.angle];
                let light = SpotLight::new(position, direction, intensity.light_rgb(), angles, spot.falloff);
                built.lights.push(Light::Spot(light));
                own_spectrum = Some(intensity);
            }
            LightDescription::Point(point) => {
                let position = DVec3::from_array(point.position);
                let intensity = colour(&point.intensity)?;
                built.lights.push(Light::Point(PointLight::new(position, intensity.light_rgb())));
                own_spectrum = Some(intensity);
            }
        }
        // Only lights of one colour have a spectrum of their own, and these are one light each.
        built.spectra.resize(built.lights.len(), own_spectrum.and_then(of_luminance_one));
    }
    Ok(built)
}

impl BuiltLights {
    /// Adds a lamp for each of the `surfaces`, built from `shapes`, that shines, and tells it its number.
    pub(crate) fn add_lamps(
        &mut self,
        shapes: &[ShapeDescription],
        surfaces: &mut Surfaces,
    ) -> Result<(), SceneError> {
        let instances = |shape: &ShapeDescription| shape.instances.as_ref().map_or(1, Vec::len);
        let descriptions = shapes.iter().flat_map(|shape| std::iter::repeat_n(shape, instances(shape)));
        for (number, description) in descriptions.enumerate().take(surfaces.shapes.len()) {
            if let Some(emission) = &description.emission {
                let primitives = surfaces.world_primitives(number);
                let light = self.add_lamp(&surfaces.shapes[number].name, emission, primitives)?;
                surfaces.shapes[number].light = Some(light);
            }
        }
        Ok(())
    }

    /// Adds the lamp that a shape called `name` is, and returns its number. `primitives` are the pieces of its surface, if
    /// points of it can be drawn uniformly.
    fn add_lamp(
        &mut self,
        name: &str,
        emission: &SurfaceEmission,
        primitives: Option<Vec<WorldPrimitive>>,
    ) -> Result<usize, SceneError> {
        let spectrum =
            emission.radiance.light().map_err(|(_, message)| SceneError::file(Path::new(name), message))?;
        let spectrum = spectrum.scaled(emission.scale);
        if primitives.is_none() {
            self.warnings.push(format!(
                "{name}: only paths that meet this lamp by chance see its light, since it is infinite or a round shape \
                 with different scales along its axes: a rectangle or a mesh in its place has less noise"
            ));
        }
        let lamp = AreaLight::new(primitives.unwrap_or_default(), spectrum.light_rgb(), emission.two_sided);
        self.lights.push(Light::Area(lamp));
        self.spectra.push(of_luminance_one(spectrum));
        Ok(self.lights.len() - 1)
    }

    /// Adds those of the `volumes` of a scene that glow and are where their own density says; `is_bounded_by_shapes` tells
    /// of the others by their numbers.
    pub(crate) fn add_glowing_volumes(
        &mut self,
        volumes: &[Volume],
        is_bounded_by_shapes: impl Fn(usize) -> bool,
    ) {
        let glowing = volumes.iter().enumerate().filter(|(number, _)| !is_bounded_by_shapes(*number));
        self.lights.extend(
            glowing.filter_map(|(number, volume)| VolumeLight::new(volume, number).map(Light::Volume)),
        );
        self.spectra.resize(self.lights.len(), None);
    }
}

/// The spectrum at luminance 1, if it is not made from red, green and blue.
fn of_luminance_one(spectrum: Spectrum) -> Option<Spectrum> {
    let luminance = cie::luminance(spectrum.light_rgb());
    let is_own = !matches!(spectrum, Spectrum::RgbLight(_)) && luminance > 0.0;
    is_own.then(|| spectrum.scaled(1.0 / luminance))
}
