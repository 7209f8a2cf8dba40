//! What the user wrote: a scene as plain data, one struct for each table of the scene file.
//!
//! The types are read by serde, and the JSON schema that checks a file is generated from them, so that a key,
//! its range and its documentation stand in one place. Lengths are in scene units, angles in degrees, colours
//! linear Rec. 709.

mod automatic;
mod call;
mod camera;
mod dimension;
mod emission;
mod files;
mod film;
mod lights;
mod material;
mod material_rules;
mod medium;
mod meter;
mod meter_rules;
mod mie_spec;
mod particles;
mod phase;
pub mod phase_spec;
mod quantity;
mod rgb;
mod rules;
mod shape;
mod shape_rules;
mod spectrum;
mod spheres;
mod transform;
mod units;
mod volume;

pub use automatic::{AutomaticScene, Glow, VolumeSummary};
pub use camera::{CameraDescription, Projection};
pub use dimension::{Dimension, dimension};
pub use emission::{AlbedoGridDescription, EmissionGridDescription, TemperatureDescription};
pub use film::{ColourMode, FilmDescription, FilmOutput, Integrator, Layer, RenderDescription, Sampler};
pub use lights::{
    ConstantLightDescription, DistantLightDescription, ImageFilter, ImageLightDescription, ImageMapping,
    LightDescription, PointLightDescription, SkyDescription, SpotFalloff, SpotLightDescription,
    SunLightDescription,
};
pub use material::{
    CheckerTexture, ImageTexture, IndexChoice, MaterialChoice, MaterialDescription, NamedMaterial, Roughness,
    TextureDescription, TextureWrap,
};
pub(crate) use material_rules::{material_of_name, no_metal, no_substance};
pub use medium::MediumDescription;
pub use meter::{
    BodyMeterDescription, Channel, IrradianceMeterDescription, LayerMeterDescription, MeterDescription,
    RadianceMeterDescription,
};
pub use particles::ParticlesDescription;
pub use phase::{PhaseDescription, SggxShape};
pub use quantity::Quantity;
pub use rgb::Rgb;
pub use rules::Violation;
pub use shape::{
    CylinderShape, DiscShape, MeshShape, Names, PlaneShape, RectangleShape, ShapeDescription, ShapeGeometry,
    SurfaceEmission,
};
pub(crate) use shape_rules::unknown_volume;
pub use spectrum::{KeyProblem, SpectrumDescription, SpectrumTable};
pub use spheres::{DistributionDescription, IndexDescription, MaterialName, SubstanceChoice, substance};
pub use transform::{Scale, TransformDescription};
pub use units::unit_in_metres;
pub use volume::{
    AtmosphereShape, BoxShape, GridFilter, GridMeaning, ProceduralDescription, RawType, SlabShape,
    SphereShape, Storage, VolumeDescription, VolumeSource,
};

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// A scene for Tyndall: what is seen, through which camera, under which lights.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[schemars(title = "Tyndall scene")]
pub struct SceneDescription {
    /// The scene's unit of length: `m`, `cm`, `mm`, `km`, … Coefficients are per this unit; it matters only to what is
    /// given in physical units, such as a `preset`.
    #[serde(default = "default_unit")]
    pub unit: String,
    /// The camera.
    pub camera: CameraDescription,
    /// The picture that is made.
    #[serde(default)]
    pub film: FilmDescription,
    /// How it is rendered.
    #[serde(default)]
    pub render: RenderDescription,
    /// A homogeneous medium that fills the whole scene, such as fog.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub medium: Option<MediumDescription>,
    /// Volumes: grids from files, homogeneous shapes, procedural clouds. Where they overlap, their
    /// coefficients add.
    #[serde(default, rename = "volume", skip_serializing_if = "Vec::is_empty")]
    pub volumes: Vec<VolumeDescription>,
    /// Materials that shapes have by name.
    #[serde(default, rename = "material", skip_serializing_if = "Vec::is_empty")]
    pub materials: Vec<NamedMaterial>,
    /// Surfaces: meshes, spheres, floors, lamps; and the boundaries of volumes.
    #[serde(default, rename = "shape", skip_serializing_if = "Vec::is_empty")]
    pub shapes: Vec<ShapeDescription>,
    /// Lights.
    #[serde(default, rename = "light", skip_serializing_if = "Vec::is_empty")]
    pub lights: Vec<LightDescription>,
    /// What `tyndall measure` measures.
    #[serde(default, rename = "meter", skip_serializing_if = "Vec::is_empty")]
    pub meters: Vec<MeterDescription>,
}

fn default_unit() -> String {
    "m".to_owned()
}

fn is_default<T: Default + PartialEq>(value: &T) -> bool {
    *value == T::default()
}

impl SceneDescription {
    /// The media of the scene, everywhere and in volumes.
    pub fn media(&self) -> impl Iterator<Item = &MediumDescription> {
        self.medium.iter().chain(self.volumes.iter().map(|volume| &volume.medium))
    }
}
