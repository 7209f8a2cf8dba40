//! Descriptions of lights to lights ready to trace.

use std::path::Path;

use glam::DVec3;

use super::{ConstantLight, DistantLight, ImageLight, Light, PointLight, SunLight, read_light_image};
use crate::description::{ImageFilter, LightDescription};
use crate::error::SceneError;
use crate::sky::Sky;

/// Lights ready to trace, and what the user should know of them.
#[derive(Debug, Clone, Default)]
pub struct BuiltLights {
    /// The lights; a sky with its sun is two.
    pub lights: Vec<Light>,
    /// One line each.
    pub warnings: Vec<String>,
}

/// Makes the lights of a scene, whose file names are relative to `folder`, ready.
pub fn build_lights(descriptions: &[LightDescription], folder: &Path) -> Result<BuiltLights, SceneError> {
    let mut built = BuiltLights::default();
    for description in descriptions {
        match description {
            LightDescription::Constant(constant) => {
                built.lights.push(Light::Constant(ConstantLight::new(constant.radiance.channels())));
            }
            LightDescription::Image(description) => {
                let (image, warning) = read_light_image(&folder.join(&description.file))?;
                let light =
                    ImageLight::new(image, description.filter, description.scale, description.rotation);
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
                let disc = SunLight::new(toward, sun.irradiance.channels(), sun.angular_diameter);
                built.lights.push(Light::Sun(disc));
            }
            LightDescription::Distant(distant) => {
                let direction = DVec3::from_array(distant.direction);
                built
                    .lights
                    .push(Light::Distant(DistantLight::new(direction, distant.irradiance.channels())));
            }
            LightDescription::Point(point) => {
                let position = DVec3::from_array(point.position);
                built.lights.push(Light::Point(PointLight::new(position, point.intensity.channels())));
            }
        }
    }
    Ok(built)
}
