//! Lights ready to trace: each can be sampled from a point, and says what it shines from a direction.
//!
//! Infinite lights (constant, image, sun) have a radiance for every direction and a density of their samples
//! over solid angle; distant, point and spot lights are delta lights, which only sampling finds. Lamps are surfaces, on
//! which paths may end as well: [`AreaLight`] says what they find there and with what density sampling would have drawn
//! it. All samplers are unbiased: the mean of `radiance_over_pdf · f(toward)` is the integral of `radiance · f` over the
//! sphere.

mod area;
mod build;
mod constant;
mod distant;
mod emission_bounds;
mod equal_area;
mod equirectangular;
mod image;
pub(crate) mod image_file;
mod point;
mod spherical_rectangle;
mod spot;
mod sun;
mod texel_distribution;
mod tree;
mod volume_light;

use glam::DVec3;

pub use self::area::AreaLight;
pub use self::build::{BuiltLights, build_lights};
pub use self::constant::ConstantLight;
pub use self::distant::DistantLight;
pub use self::equal_area::{direction_to_equal_area, equal_area_to_direction};
pub use self::equirectangular::{direction_to_uv, uv_to_direction};
pub use self::image::{ImageLight, LightImage};
pub use self::image_file::read_light_image;
pub use self::point::PointLight;
pub use self::spot::SpotLight;
pub use self::sun::SunLight;
pub use self::tree::LightTree;
pub use self::volume_light::{VolumeLight, VolumeLightSample};

/// A light. The clear sky is an image and, if it shines, a sun.
#[derive(Debug, Clone)]
pub enum Light {
    /// The same radiance from every direction.
    Constant(ConstantLight),
    /// A picture of the surroundings.
    Image(ImageLight),
    /// A far disc of uniform radiance.
    Sun(SunLight),
    /// Parallel light.
    Distant(DistantLight),
    /// A point.
    Point(PointLight),
    /// A point that shines into a cone.
    Spot(SpotLight),
    /// A surface that shines.
    Area(AreaLight),
    /// A medium that glows.
    Volume(VolumeLight),
}

/// A direction in which a light was found.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LightSample {
    /// Unit vector from the point to the light.
    pub toward: DVec3,
    /// Distance to the light; infinite for lights at infinity.
    pub distance: f64,
    /// Radiance over `pdf`; irradiance of a surface facing the light for delta lights.
    pub radiance_over_pdf: DVec3,
    /// Density over solid angle, 1/sr; 0 for delta lights, which have none.
    pub pdf: f64,
    /// Whether only sampling can find this light.
    pub is_delta: bool,
}

impl LightSample {
    /// What is sampled where no light comes from. Its density is no one's, and not 0, by which weights would be divided.
    pub(super) const NONE: Self =
        Self { toward: DVec3::Y, distance: 0.0, radiance_over_pdf: DVec3::ZERO, pdf: 1.0, is_delta: false };
}

impl Light {
    /// A direction towards the light from the point `from`; `u` is uniform in [0, 1)². A medium that glows has points on
    /// all the way, and no light by this sample: see [`VolumeLight::sample`].
    pub fn sample(&self, from: DVec3, u: [f64; 2]) -> LightSample {
        match self {
            Self::Constant(light) => light.sample(u),
            Self::Image(light) => light.sample(u),
            Self::Sun(light) => light.sample(u),
            Self::Distant(light) => light.sample(),
            Self::Point(light) => light.sample(from),
            Self::Spot(light) => light.sample(from),
            Self::Area(light) => light.sample(from, u),
            Self::Volume(_) => LightSample::NONE,
        }
    }

    /// Radiance that arrives from far away along the unit vector `direction`, which points to where it comes
    /// from. Zero for lights that are not at infinity or are delta lights.
    pub fn radiance(&self, direction: DVec3) -> DVec3 {
        match self {
            Self::Constant(light) => light.radiance(),
            Self::Image(light) => light.radiance(direction),
            Self::Sun(light) => light.radiance(direction),
            Self::Distant(_) | Self::Point(_) | Self::Spot(_) | Self::Area(_) | Self::Volume(_) => {
                DVec3::ZERO
            }
        }
    }

    /// Density over solid angle, 1/sr, with which [`sample`](Self::sample) chooses `direction`; 0 for lights that
    /// are not at infinity or are delta lights.
    pub fn pdf(&self, direction: DVec3) -> f64 {
        match self {
            Self::Constant(light) => light.pdf(),
            Self::Image(light) => light.pdf(direction),
            Self::Sun(light) => light.pdf(direction),
            Self::Distant(_) | Self::Point(_) | Self::Spot(_) | Self::Area(_) | Self::Volume(_) => 0.0,
        }
    }

    /// Roughly the power that enters a scene of radius `scene_radius`, for choosing among lights.
    pub fn selection_weight(&self, scene_radius: f64) -> f64 {
        let cross_section = std::f64::consts::PI * scene_radius * scene_radius;
        let mean = |channels: DVec3| channels.element_sum() / 3.0;
        match self {
            Self::Constant(light) => mean(light.total()) * cross_section,
            Self::Image(light) => mean(light.total()) * cross_section,
            Self::Sun(light) => mean(light.irradiance()) * cross_section,
            Self::Distant(light) => mean(light.irradiance()) * cross_section,
            Self::Point(light) => mean(light.power()),
            Self::Spot(light) => mean(light.power()),
            Self::Area(light) => mean(light.power()),
            Self::Volume(light) => mean(light.power()),
        }
    }

    /// Whether the light is at infinity and [`radiance`](Self::radiance) may be positive.
    pub fn is_infinite(&self) -> bool {
        matches!(self, Self::Constant(_) | Self::Image(_) | Self::Sun(_))
    }
}
