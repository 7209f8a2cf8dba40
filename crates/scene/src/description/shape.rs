//! `[[shape]]`: surfaces, what they are made of, and what is inside.

use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::{Deserialize, Serialize};

use super::material::MaterialChoice;
use super::spectrum::SpectrumDescription;
use super::transform::TransformDescription;
use super::volume::{BoxShape, SphereShape};

/// A surface: exactly one of `mesh`, `sphere`, `box`, `rectangle`, `disc`, `cylinder`, `plane`.
///
/// Every surface has an outer side, to which its normal points: that of a closed shape is outside.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct ShapeDescription {
    /// A name for messages.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub name: Option<String>,
    /// Triangles, from a file or given here.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub mesh: Option<MeshShape>,
    /// A sphere.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub sphere: Option<SphereShape>,
    /// A box with edges along the axes.
    #[serde(default, rename = "box", skip_serializing_if = "Option::is_none")]
    pub cuboid: Option<BoxShape>,
    /// A parallelogram.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub rectangle: Option<RectangleShape>,
    /// A disc, or a ring.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub disc: Option<DiscShape>,
    /// A cylinder without caps unless it is `capped`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub cylinder: Option<CylinderShape>,
    /// An infinite plane.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub plane: Option<PlaneShape>,
    /// Where the shape stands.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub transform: Option<TransformDescription>,
    /// The shape stands once for each of these, which are applied after `transform`; once as it is if absent.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub instances: Option<Vec<TransformDescription>>,
    /// What the surface is made of: the name of a `[[material]]`, or a material given here.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub material: Option<MaterialChoice>,
    /// Makes the surface a lamp.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub emission: Option<SurfaceEmission>,
    /// Name, or names, of volumes that are only inside this shape. Light that crosses the surface enters them.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub interior: Option<Names>,
    /// Name, or names, of volumes that end at this surface and are not inside; `"medium"` is the one that fills the
    /// scene.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub exterior: Option<Names>,
    /// Makes the inner side the outer side.
    #[serde(default, skip_serializing_if = "super::is_default")]
    pub flip: bool,
    /// Whether shadows on it, and not the surface itself, are for a compositor: see the layer `shadow_catcher`.
    #[serde(default, skip_serializing_if = "super::is_default")]
    pub shadow_catcher: bool,
    /// Number of the object in the layer `object_id`; shapes are numbered from 1 unless given.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 1, max = 16777215))]
    pub id: Option<u32>,
}

/// One name or several.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(untagged)]
pub enum Names {
    /// One.
    One(String),
    /// Several.
    Several(Vec<String>),
}

impl Names {
    /// These names, if there are any.
    pub fn some(mut names: Vec<String>) -> Option<Self> {
        match names.len() {
            0 => None,
            1 => names.pop().map(Self::One),
            _ => Some(Self::Several(names)),
        }
    }

    /// The names.
    pub fn all(&self) -> &[String] {
        match self {
            Self::One(name) => std::slice::from_ref(name),
            Self::Several(names) => names,
        }
    }
}

impl JsonSchema for Names {
    fn schema_name() -> std::borrow::Cow<'static, str> {
        "Names".into()
    }

    fn json_schema(_: &mut SchemaGenerator) -> Schema {
        json_schema!({ "anyOf": [
            { "type": "string" },
            { "type": "array", "items": { "type": "string" } }
        ]})
    }
}

/// Triangles: a `file`, or `vertices` and `triangles`. The outer side is the one from which a triangle's vertices run
/// counter-clockwise.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct MeshShape {
    /// Mesh file (.ply, .obj), relative to the scene file.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub file: Option<String>,
    /// Places of the vertices.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub vertices: Option<Vec<[f64; 3]>>,
    /// The three vertices of each triangle, by number from 0.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub triangles: Option<Vec<[u32; 3]>>,
    /// A normal for each vertex: the surface looks as if it were bent.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub normals: Option<Vec<[f64; 3]>>,
    /// Texture coordinates for each vertex.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub uvs: Option<Vec<[f64; 2]>>,
    /// Whether normals of the file are left unused, so that every triangle looks flat.
    #[serde(default, skip_serializing_if = "super::is_default")]
    pub flat: bool,
}

/// The parallelogram `corner`, `corner + u`, `corner + u + v`, `corner + v`; its normal is u × v. Texture coordinates run
/// from 0 to 1 along `u` and `v`.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct RectangleShape {
    /// One of the corners.
    pub corner: [f64; 3],
    /// The first edge.
    pub u: [f64; 3],
    /// The second edge.
    pub v: [f64; 3],
}

/// A disc, or a ring if it has an inner radius.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct DiscShape {
    /// The centre.
    pub center: [f64; 3],
    /// The direction of the outer side.
    pub normal: [f64; 3],
    /// The radius.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub radius: f64,
    /// Radius of the hole.
    #[serde(default, skip_serializing_if = "super::is_default")]
    #[schemars(range(min = 0))]
    pub inner_radius: f64,
}

/// A cylinder about the line between two points; the outer side is away from the line.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct CylinderShape {
    /// Centre of one end.
    pub from: [f64; 3],
    /// Centre of the other end.
    pub to: [f64; 3],
    /// The radius.
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub radius: f64,
    /// Whether its ends are closed by discs.
    #[serde(default, skip_serializing_if = "super::is_default")]
    pub capped: bool,
}

/// An infinite plane. Texture coordinates are scene units along two directions in it.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct PlaneShape {
    /// A point of the plane.
    pub point: [f64; 3],
    /// The direction of the outer side.
    pub normal: [f64; 3],
}

/// Light that a surface sends out.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct SurfaceEmission {
    /// Radiance, the same in all directions.
    pub radiance: SpectrumDescription,
    /// Factor on it.
    #[serde(default = "one")]
    #[schemars(range(min = 0))]
    pub scale: f64,
    /// Whether the inner side shines too.
    #[serde(default, skip_serializing_if = "super::is_default")]
    pub two_sided: bool,
}

fn one() -> f64 {
    1.0
}

/// Where a surface lies.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum ShapeGeometry<'a> {
    /// Triangles.
    Mesh(&'a MeshShape),
    /// A sphere.
    Sphere(&'a SphereShape),
    /// A box.
    Box(&'a BoxShape),
    /// A parallelogram.
    Rectangle(&'a RectangleShape),
    /// A disc or ring.
    Disc(&'a DiscShape),
    /// A cylinder.
    Cylinder(&'a CylinderShape),
    /// An infinite plane.
    Plane(&'a PlaneShape),
}

impl ShapeDescription {
    /// The one geometry; or the key that is one too many (empty if there is none) and the mend.
    pub fn geometry(&self) -> Result<ShapeGeometry<'_>, (&'static str, String)> {
        let given: Vec<(&'static str, ShapeGeometry<'_>)> = [
            ("mesh", self.mesh.as_ref().map(ShapeGeometry::Mesh)),
            ("sphere", self.sphere.as_ref().map(ShapeGeometry::Sphere)),
            ("box", self.cuboid.as_ref().map(ShapeGeometry::Box)),
            ("rectangle", self.rectangle.as_ref().map(ShapeGeometry::Rectangle)),
            ("disc", self.disc.as_ref().map(ShapeGeometry::Disc)),
            ("cylinder", self.cylinder.as_ref().map(ShapeGeometry::Cylinder)),
            ("plane", self.plane.as_ref().map(ShapeGeometry::Plane)),
        ]
        .into_iter()
        .filter_map(|(key, geometry)| geometry.map(|geometry| (key, geometry)))
        .collect();
        match given.as_slice() {
            [(_, geometry)] => Ok(*geometry),
            [] => Err((
                "",
                "the shape is nowhere: give one of `mesh`, `sphere`, `box`, `rectangle`, `disc`, `cylinder`, `plane`"
                    .to_owned(),
            )),
            [(first, _), (second, _), ..] => Err((
                *second,
                format!("the shape has both `{first}` and `{second}`: keep one, or write two [[shape]] tables"),
            )),
        }
    }
}
