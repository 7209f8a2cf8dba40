//! `[[light]]`: where the light comes from.
//!
//! Directions of the compass in all lights: +y is up, -z is north, +x is east; azimuth counts from north
//! through east. `direction` is the way the light travels; `toward_sun` points to the sun.

use glam::{DMat3, DVec3};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::rgb::{Rgb, fraction};
use super::spectrum::SpectrumDescription;
use crate::rotation;

/// A light.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(tag = "type", rename_all = "snake_case")]
pub enum LightDescription {
    /// The same radiance from every direction.
    Constant(ConstantLightDescription),
    /// A picture of the surroundings.
    Image(ImageLightDescription),
    /// The clear sky of the Earth, with its sun.
    Sky(SkyDescription),
    /// A far disc, as the sun is.
    Sun(SunLightDescription),
    /// Parallel light.
    Distant(DistantLightDescription),
    /// A point that shines equally in all directions.
    Point(PointLightDescription),
    /// A point that shines into a cone.
    Spot(SpotLightDescription),
}

/// The same radiance from every direction.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[schemars(inline)]
pub struct ConstantLightDescription {
    /// Radiance.
    pub radiance: SpectrumDescription,
}

/// A picture of the surroundings. Of an equirectangular one the top row is +y, the middle column is -z (north), and
/// columns to the right of it are +x (east), as seen from inside.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[schemars(inline)]
pub struct ImageLightDescription {
    /// The picture (.exr, .hdr), relative to the scene file.
    pub file: String,
    /// How directions come onto the picture.
    #[serde(default, skip_serializing_if = "super::is_default")]
    pub mapping: ImageMapping,
    /// Rotation of the surroundings into the scene, nine numbers row by row, done before `rotation`; may mirror.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub orientation: Option<[f64; 9]>,
    /// Turns the surroundings about +y, degrees, right-handed.
    #[serde(default, skip_serializing_if = "super::is_default")]
    pub rotation: f64,
    /// Factor on the picture's radiance.
    #[serde(default = "one")]
    #[schemars(range(min = 0))]
    pub scale: f64,
    /// How radiance between texel centres is found.
    #[serde(default)]
    pub filter: ImageFilter,
}

/// How directions come onto a picture of the surroundings.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum ImageMapping {
    /// Longitude and latitude.
    #[default]
    Equirectangular,
    /// Clarberg 2008's map of the square to the sphere, areas kept: +z is at its centre, -z at its corners, columns to the
    /// right are +x and rows downwards +y.
    EqualArea,
}

/// How radiance between texel centres is found.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum ImageFilter {
    /// Interpolated between the four nearest texels.
    #[default]
    Bilinear,
    /// That of the texel it lies in.
    Nearest,
}

/// The clear sky of the Earth, with its sun.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default)]
#[schemars(inline)]
pub struct SkyDescription {
    /// Height of the sun above the horizon, degrees.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = -6, max = 90))]
    pub sun_elevation: Option<f64>,
    /// Compass direction of the sun, degrees from north (-z) through east (+x).
    #[serde(skip_serializing_if = "Option::is_none")]
    pub sun_azimuth: Option<f64>,
    /// Instead of both: a vector that points to the sun.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub toward_sun: Option<[f64; 3]>,
    /// Haze: optical thickness of the whole air over that of its molecules alone, straight up at 550 nm. 1 is
    /// air without dust, 2 a clear day, 5 a hazy one.
    #[schemars(range(min = 1, max = 20))]
    pub turbidity: f64,
    /// Height of the viewer above the ground, metres; softens the horizon.
    #[schemars(range(min = 0, max = 20000))]
    pub altitude: f64,
    /// Fraction of the light that the ground reflects.
    #[schemars(schema_with = "fraction")]
    pub ground_albedo: Rgb,
    /// Factor on the radiance of sky and sun. At 1, a white surface under 100,000 lux has radiance 1.
    #[schemars(range(min = 0))]
    pub intensity: f64,
    /// Whether the sun's disc shines; without, only the sky does.
    pub sun: bool,
    /// Angle across the sun's disc, degrees.
    #[schemars(range(max = 90), extend("exclusiveMinimum" = 0))]
    pub angular_diameter: f64,
}

impl Default for SkyDescription {
    fn default() -> Self {
        Self {
            sun_elevation: None,
            sun_azimuth: None,
            toward_sun: None,
            turbidity: 2.0,
            altitude: 100.0,
            ground_albedo: Rgb::Grey(0.2),
            intensity: 1.0,
            sun: true,
            angular_diameter: SUN_ANGULAR_DIAMETER,
        }
    }
}

/// A far disc of uniform radiance, as the sun is.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[schemars(inline)]
pub struct SunLightDescription {
    /// The way the light travels: from the sun to the scene.
    pub direction: [f64; 3],
    /// Irradiance on a surface that faces the sun.
    pub irradiance: SpectrumDescription,
    /// Angle across the disc, degrees.
    #[serde(default = "sun_angular_diameter")]
    #[schemars(range(max = 90), extend("exclusiveMinimum" = 0))]
    pub angular_diameter: f64,
}

/// Parallel light.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[schemars(inline)]
pub struct DistantLightDescription {
    /// The way the light travels.
    pub direction: [f64; 3],
    /// Irradiance on a surface that faces the light.
    pub irradiance: SpectrumDescription,
}

/// A point that shines equally in all directions.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[schemars(inline)]
pub struct PointLightDescription {
    /// Where it is.
    pub position: [f64; 3],
    /// Power per solid angle, W/sr for radiance in W/(m² sr) and lengths in m.
    pub intensity: SpectrumDescription,
}

/// A point that shines into a cone.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[schemars(inline)]
pub struct SpotLightDescription {
    /// Where it is.
    pub position: [f64; 3],
    /// The axis of the cone, the way the light travels.
    pub direction: [f64; 3],
    /// Power per solid angle along the axis.
    pub intensity: SpectrumDescription,
    /// Angle between the axis and the edge of the cone, degrees.
    #[schemars(range(max = 180), extend("exclusiveMinimum" = 0))]
    pub angle: f64,
    /// Angle from the axis up to which the light is undiminished, degrees.
    #[serde(default, skip_serializing_if = "super::is_default")]
    #[schemars(range(min = 0, max = 180))]
    pub inner_angle: f64,
    /// How it diminishes from there to the edge.
    #[serde(default, skip_serializing_if = "super::is_default")]
    pub falloff: SpotFalloff,
}

/// How a spot light diminishes towards the edge of its cone.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum SpotFalloff {
    /// x² (3 - 2x), x being 1 at the inner angle and 0 at the edge, linear in the cosine.
    #[default]
    Smooth,
    /// Linear in the angle.
    Linear,
}

/// Mean angle across the sun as seen from the Earth, degrees.
const SUN_ANGULAR_DIAMETER: f64 = 0.533;

fn sun_angular_diameter() -> f64 {
    SUN_ANGULAR_DIAMETER
}

fn one() -> f64 {
    1.0
}

impl ImageLightDescription {
    /// The map from directions of the picture to those of the scene: `orientation`, made exactly orthogonal, then
    /// `rotation`.
    pub fn orientation(&self) -> DMat3 {
        let given =
            self.orientation.map_or(DMat3::IDENTITY, |rows| DMat3::from_cols_array(&rows).transpose());
        let x = given.x_axis.normalize_or(DVec3::X);
        let y = (given.y_axis - x * x.dot(given.y_axis)).normalize_or(x.any_orthonormal_vector());
        let z = x.cross(y);
        let z = if given.determinant() < 0.0 { -z } else { z };
        rotation(DVec3::Y, self.rotation.to_radians()) * DMat3::from_cols(x, y, z)
    }

    /// What is wrong with the orientation, if anything.
    pub(super) fn orientation_violation(&self) -> Option<&'static str> {
        let rows = self.orientation?;
        let given = DMat3::from_cols_array(&rows);
        let difference = given * given.transpose() - DMat3::IDENTITY;
        let is_orthogonal = difference.to_cols_array().iter().all(|value| value.abs() < 1e-3);
        (!is_orthogonal).then_some(
            "`orientation` must be a rotation, mirrored or not: three rows of length 1 at right angles to each other",
        )
    }
}

impl SkyDescription {
    /// Unit vector to the sun. Where the scene does not say, the sun stands 40 degrees high in the
    /// south-east.
    pub fn toward_sun(&self) -> DVec3 {
        if let Some(direction) = self.toward_sun.and_then(|v| DVec3::from_array(v).try_normalize()) {
            return direction;
        }
        direction_of_compass(self.sun_elevation.unwrap_or(40.0), self.sun_azimuth.unwrap_or(135.0))
    }
}

/// The unit vector at an elevation above the horizon and an azimuth from north (-z) through east (+x),
/// degrees.
pub(super) fn direction_of_compass(elevation: f64, azimuth: f64) -> DVec3 {
    let (sin_elevation, cos_elevation) = libm::sincos(elevation.to_radians());
    let (sin_azimuth, cos_azimuth) = libm::sincos(azimuth.to_radians());
    DVec3::new(cos_elevation * sin_azimuth, sin_elevation, -cos_elevation * cos_azimuth)
}
