//! `[[volume]]`: a grid from a file, a homogeneous shape, an atmosphere or a procedural cloud.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::emission::{AlbedoGridDescription, EmissionGridDescription, TemperatureDescription};
use super::medium::MediumDescription;
use super::transform::TransformDescription;

/// A volume: exactly one of `file`, `box`, `sphere`, `slab`, `atmosphere`, `procedural`, and the optical properties
/// of what fills it; or none of them, if some shape has it for `interior`.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct VolumeDescription {
    /// A name for messages, and for shapes that bound it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub name: Option<String>,
    /// Volume file (.vdb, .nvdb, .vol, .npy, .raw, .nii, .nii.gz), relative to the scene file.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub file: Option<String>,
    /// Name of the file's grid that multiplies the coefficients; by default the one that looks like a
    /// density.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub grid: Option<String>,
    /// What the grid's values are; by default what the file says.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub values: Option<GridMeaning>,
    /// What lies between the centres of voxels; by default `trilinear`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub filter: Option<GridFilter>,
    /// Voxels along x, y and z of a .raw file.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(inner(range(min = 1)))]
    pub raw_shape: Option<[u32; 3]>,
    /// Number type of a .raw file.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub raw_type: Option<RawType>,
    /// A homogeneous box with edges along the axes.
    #[serde(default, rename = "box", skip_serializing_if = "Option::is_none")]
    pub cuboid: Option<BoxShape>,
    /// A homogeneous sphere.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub sphere: Option<SphereShape>,
    /// A homogeneous layer, unbounded in x and z.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub slab: Option<SlabShape>,
    /// A layer whose density falls exponentially with height, unbounded in x and z.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub atmosphere: Option<AtmosphereShape>,
    /// A volume that is computed.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub procedural: Option<ProceduralDescription>,
    /// Where the volume stands; by default where its file or shape says.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub transform: Option<TransformDescription>,
    /// The optical properties.
    #[serde(flatten)]
    pub medium: MediumDescription,
    /// Factor on everything that the volume emits; 1 unless given.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 0))]
    pub emission_scale: Option<f64>,
    /// A grid that multiplies the emission.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub emission_grid: Option<EmissionGridDescription>,
    /// A grid of temperatures: the medium glows as a black body does, with Le = `emission_scale` B in W/(m² sr nm).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub temperature: Option<TemperatureDescription>,
    /// A grid of colours that multiplies the albedo.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub albedo_grid: Option<AlbedoGridDescription>,
    /// How voxels are kept in memory; chosen from the data by default.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub storage: Option<Storage>,
}

/// Where the density of a volume comes from.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum VolumeSource<'a> {
    /// A grid of this file.
    File(&'a str),
    /// Density 1 in a box.
    Box(&'a BoxShape),
    /// Density 1 in a sphere.
    Sphere(&'a SphereShape),
    /// Density 1 in a layer.
    Slab(&'a SlabShape),
    /// Density falling with height.
    Atmosphere(&'a AtmosphereShape),
    /// Computed.
    Procedural(&'a ProceduralDescription),
    /// Density 1 wherever the shapes are that have it for interior.
    Shapes,
}

impl VolumeDescription {
    /// The one source of the density; or the key that is one too many and the mend.
    pub fn source(&self) -> Result<VolumeSource<'_>, (&'static str, String)> {
        let given: Vec<(&'static str, VolumeSource<'_>)> = [
            ("file", self.file.as_deref().map(VolumeSource::File)),
            ("box", self.cuboid.as_ref().map(VolumeSource::Box)),
            ("sphere", self.sphere.as_ref().map(VolumeSource::Sphere)),
            ("slab", self.slab.as_ref().map(VolumeSource::Slab)),
            ("atmosphere", self.atmosphere.as_ref().map(VolumeSource::Atmosphere)),
            ("procedural", self.procedural.as_ref().map(VolumeSource::Procedural)),
        ]
        .into_iter()
        .filter_map(|(key, source)| source.map(|source| (key, source)))
        .collect();
        match given.as_slice() {
            [(_, source)] => Ok(*source),
            [] => Ok(VolumeSource::Shapes),
            [(first, _), (second, _), ..] => Err((
                *second,
                format!(
                    "the volume has both `{first}` and `{second}`: keep one, or write two [[volume]] tables"
                ),
            )),
        }
    }
}

/// What the values of a grid are.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum GridMeaning {
    /// A density: multiplies the coefficients as it is; negative values count as 0.
    Density,
    /// A signed distance in world units (a level set): density 1 inside, 0 outside, with a ramp one voxel
    /// wide about the surface.
    SignedDistance,
}

/// What lies between the centres of voxels.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum GridFilter {
    /// A mixture of the eight voxels around.
    #[default]
    Trilinear,
    /// Each voxel is a box of one value, with its centre in the middle.
    Nearest,
}

/// Number type of a .raw file; little endian.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum RawType {
    /// 8-bit unsigned integer.
    U8,
    /// 16-bit unsigned integer.
    U16,
    /// 16-bit signed integer.
    I16,
    /// 16-bit float.
    F16,
    /// 32-bit float.
    F32,
    /// 64-bit float.
    F64,
}

/// How voxels are kept in memory.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Storage {
    /// 8 bits, scaled to the range of each brick.
    U8,
    /// 16-bit floats.
    F16,
    /// 32-bit floats.
    F32,
}

/// A box with edges along the axes.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct BoxShape {
    /// The corner of least coordinates.
    pub min: [f64; 3],
    /// The corner of greatest coordinates.
    pub max: [f64; 3],
}

/// A sphere.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct SphereShape {
    /// The centre.
    pub center: [f64; 3],
    /// The radius.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub radius: f64,
}

/// The layer `bottom < y < top`.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct SlabShape {
    /// y of the lower face.
    pub bottom: f64,
    /// y of the upper face.
    pub top: f64,
}

/// The layer `bottom < y < top` with density exp(-(y - bottom)/scale_height): 1 at the bottom, 1/e a scale height
/// above.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct AtmosphereShape {
    /// y of the lower face.
    #[serde(default)]
    pub bottom: f64,
    /// y of the upper face; without one the layer has no end.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub top: Option<f64>,
    /// Height over which the density falls by a factor e.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub scale_height: f64,
}

/// A volume that is computed.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(tag = "type", rename_all = "snake_case")]
pub enum ProceduralDescription {
    /// A fair-weather cumulus in a cube.
    Cumulus {
        /// Which cloud.
        #[serde(default)]
        seed: u32,
        /// Voxels along each edge of the cube.
        #[serde(default = "default_cloud_resolution")]
        #[schemars(range(min = 8, max = 2048))]
        resolution: u32,
        /// Centre of the cube.
        #[serde(default)]
        center: [f64; 3],
        /// Edge of the cube.
        #[serde(default = "default_cloud_size")]
        #[schemars(extend("exclusiveMinimum" = 0))]
        size: f64,
    },
}

fn default_cloud_resolution() -> u32 {
    256
}

fn default_cloud_size() -> f64 {
    1.0
}
