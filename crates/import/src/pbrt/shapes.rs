//! Shapes: where they are, in Tyndall's words.
//!
//! The outer side of a triangle is that from which its vertices run counter-clockwise in its own space; where a mesh has
//! normals, the side to which they point. `ReverseOrientation` makes it the other. Meshes that the scene file writes
//! out are put into the world; all else keeps its transform.

use std::f64::consts::PI;

use glam::DVec3;
use tyndall_machine::files;
use tyndall_scene::description::{
    CylinderShape, DiscShape, MeshShape, RectangleShape, ShapeDescription, SphereShape,
};

use super::context::{Context, text_of};
use super::transforms;
use super::world::Shape;
use crate::packed::unpacked;
use crate::{ImportError, Mesh, affine};

/// Meshes of more vertices are put into files.
const MOST_INLINE: usize = 64;

/// A shape in its place, without material.
#[derive(Debug)]
pub(super) struct Geometry {
    /// Geometry, transform and `flip`.
    pub description: ShapeDescription,
    /// Area in the world and number of parts, if known.
    pub area: Option<(f64, usize)>,
    /// What body the surface bounds, if that is simple.
    pub body: Body,
}

/// A simple body in a shape's own space, its normals outwards.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Body {
    /// A box along the axes: its corners.
    Box([DVec3; 2]),
    /// A sphere about the origin: its radius.
    Sphere(f64),
    /// Something else.
    Other,
}

/// Where a shape is; `None` if it is left out. `is_textured` says whether texture coordinates are needed.
pub(super) fn geometry(
    shape: &Shape,
    is_textured: bool,
    context: &Context,
) -> Result<Option<Geometry>, ImportError> {
    let (entity, place) = (&shape.entity, &shape.entity.place);
    let made = match entity.kind.as_str() {
        "trianglemesh" => triangles(shape, is_textured, context)?,
        "loopsubdiv" => {
            context
                .unsupported(place, "\"loopsubdiv\" is not subdivided: its triangles are as they are given");
            entity.parameters.pass(&["levels", "scheme"]);
            triangles(shape, is_textured, context)?
        }
        "bilinearmesh" => patches(shape, context)?,
        "plymesh" => ply(shape, context)?,
        "sphere" => sphere(shape, context)?,
        "disk" => disc(shape, context)?,
        "cylinder" => cylinder(shape, context)?,
        "curve" => {
            context.unsupported(place, "a \"curve\" is left out");
            return Ok(None);
        }
        kind => return Err(place.error(format!("\"{kind}\" is no shape of pbrt-v4"))),
    };
    let flip = shape.is_reversed;
    Ok(Some(Geometry { description: ShapeDescription { flip, ..made.description }, ..made }))
}

fn triangles(shape: &Shape, is_textured: bool, context: &Context) -> Result<Geometry, ImportError> {
    let (parameters, place) = (&shape.entity.parameters, &shape.entity.place);
    let vertices = parameters.points::<3>("P")?.unwrap_or_default();
    let indices = parameters.indices("indices", vertices.len())?;
    let indices = indices.unwrap_or_else(|| if vertices.len() == 3 { vec![0, 1, 2] } else { Vec::new() });
    let (corners, rest) = indices.as_chunks::<3>();
    if corners.is_empty() || !rest.is_empty() {
        return Err(place.error("the mesh needs points `P` and three `indices` for each triangle"));
    }
    parameters.pass(&["S", "faceIndices"]);
    let mut soup = Soup {
        vertices: vertices.into_iter().map(DVec3::from_array).collect(),
        triangles: corners.to_vec(),
        normals: parameters
            .points::<3>("N")?
            .unwrap_or_default()
            .into_iter()
            .map(DVec3::from_array)
            .collect(),
        uvs: parameters.points::<2>("uv")?.or(parameters.points::<2>("st")?).unwrap_or_default(),
    };
    let counts = [soup.normals.len(), soup.uvs.len()];
    if counts.iter().any(|count| *count != 0 && *count != soup.vertices.len()) {
        return Err(place.error("the mesh has other numbers of `N` or `uv` than of `P`: give one for each"));
    }
    if is_textured && soup.uvs.is_empty() {
        soup.give_texture_coordinates();
    }
    soup.finish(shape, context)
}

/// Bilinear patches, each as two triangles; one that is a parallelogram as that.
fn patches(shape: &Shape, context: &Context) -> Result<Geometry, ImportError> {
    let (parameters, place) = (&shape.entity.parameters, &shape.entity.place);
    let vertices: Vec<DVec3> =
        parameters.points::<3>("P")?.unwrap_or_default().into_iter().map(DVec3::from_array).collect();
    let indices = parameters.indices("indices", vertices.len())?;
    let indices = indices.unwrap_or_else(|| if vertices.len() == 4 { vec![0, 1, 2, 3] } else { Vec::new() });
    let (corners, rest) = indices.as_chunks::<4>();
    if corners.is_empty() || !rest.is_empty() {
        return Err(place.error("the mesh needs points `P` and four `indices` for each patch"));
    }
    parameters.pass(&["faceIndices"]);
    let uvs = parameters.points::<2>("uv")?.unwrap_or_default();
    let normals = parameters.points::<3>("N")?.unwrap_or_default();
    let counts = [normals.len(), uvs.len()];
    if counts.iter().any(|count| *count != 0 && *count != vertices.len()) {
        return Err(place.error("the mesh has other numbers of `N` or `uv` than of `P`: give one for each"));
    }
    let at = |index: u32| vertices[index as usize];
    for &[p00, p10, p01, p11] in corners {
        let (u, v, w) = (at(p10) - at(p00), at(p01) - at(p00), at(p11) - at(p00));
        if w.dot(u.cross(v)).abs() > 1e-6 * u.length() * v.length() * w.length() {
            context.unsupported(place, "bilinear patches that are not flat are two triangles each");
        }
    }
    if let (&[[p00, p10, p01, p11]], [0, 0]) = (corners, counts) {
        let [corner, right, top, far] = [p00, p10, p01, p11].map(|p| shape.to_world.transform_point3(at(p)));
        let (u, v) = (right - corner, top - corner);
        let area = u.cross(v).length();
        if (corner + u + v - far).length() <= 1e-6 * (u.length() + v.length()) && area > 0.0 {
            // Through a mirror u × v turns over, and the patch's outer side does not.
            let is_mirrored = shape.to_world.matrix3.determinant() < 0.0;
            let (u, v) = if is_mirrored { (v, u) } else { (u, v) };
            let rectangle = RectangleShape { corner: corner.to_array(), u: u.to_array(), v: v.to_array() };
            let description = ShapeDescription { rectangle: Some(rectangle), ..ShapeDescription::default() };
            return Ok(Geometry { description, area: Some((area, 1)), body: Body::Other });
        }
    }
    let mut soup = Soup {
        vertices,
        triangles: corners
            .iter()
            .flat_map(|&[p00, p10, p01, p11]| [[p00, p10, p11], [p00, p11, p01]])
            .collect(),
        normals: normals.into_iter().map(DVec3::from_array).collect(),
        uvs,
    };
    if soup.uvs.is_empty() {
        soup.spread_patches(corners);
    }
    soup.finish(shape, context)
}

fn ply(shape: &Shape, context: &Context) -> Result<Geometry, ImportError> {
    let (parameters, place) = (&shape.entity.parameters, &shape.entity.place);
    let Some(name) = parameters.text("filename")? else {
        return Err(place.error("\"plymesh\" needs a `filename`"));
    };
    parameters.pass(&["edgelength"]);
    let mut file = context.file(name, place)?;
    if file.ends_with(".gz") {
        let unreadable = |error: std::io::Error| place.error(format!("{file} cannot be read: {error}"));
        let packed = files::open(file.as_ref()).map_err(unreadable)?;
        let length = packed.metadata().map_err(unreadable)?.len();
        let stem = name.rsplit(['/', '\\']).next().unwrap_or(name).trim_end_matches(".ply.gz");
        let path = context.sidecar.write_copy(stem, "ply", &mut unpacked(packed, length))?;
        file = text_of(&path, place)?;
    }
    let mesh = MeshShape { file: Some(file), ..MeshShape::default() };
    let transform = transforms::description(&shape.to_world);
    let description = ShapeDescription { mesh: Some(mesh), transform, ..ShapeDescription::default() };
    Ok(Geometry { description, area: None, body: Body::Other })
}

fn sphere(shape: &Shape, context: &Context) -> Result<Geometry, ImportError> {
    let (parameters, place) = (&shape.entity.parameters, &shape.entity.place);
    let radius = above_zero(shape, "radius", 1.0)?;
    let (low, high) = (parameters.float_or("zmin", -radius)?, parameters.float_or("zmax", radius)?);
    if low > -radius || high < radius || parameters.float_or("phimax", 360.0)? < 360.0 {
        context.unsupported(place, "a part of a sphere is the whole sphere");
    }
    let scale = affine::uniform_scale(&shape.to_world);
    let mut description = ShapeDescription::default();
    match scale {
        Some(scale) => {
            let center = shape.to_world.translation.to_array();
            description.sphere = Some(SphereShape { center, radius: radius * scale });
        }
        None => {
            description.sphere = Some(SphereShape { center: [0.0; 3], radius });
            description.transform = transforms::description(&shape.to_world);
        }
    }
    let area = scale.map(|scale| (4.0 * PI * (radius * scale).powi(2), 1));
    Ok(Geometry { description, area, body: Body::Sphere(radius) })
}

fn disc(shape: &Shape, context: &Context) -> Result<Geometry, ImportError> {
    let (parameters, place) = (&shape.entity.parameters, &shape.entity.place);
    let radius = above_zero(shape, "radius", 1.0)?;
    let inner_radius = parameters.float_or("innerradius", 0.0)?.max(0.0);
    if inner_radius >= radius {
        return Err(place.error("`innerradius` must be below `radius`"));
    }
    if parameters.float_or("phimax", 360.0)? < 360.0 {
        context.unsupported(place, "a part of a disk is the whole disk");
    }
    let disc = DiscShape {
        center: [0.0, 0.0, parameters.float_or("height", 0.0)?],
        normal: [0.0, 0.0, 1.0],
        radius,
        inner_radius,
    };
    let scale = affine::uniform_scale(&shape.to_world);
    let area = scale.map(|scale| (PI * (radius * radius - inner_radius * inner_radius) * scale * scale, 1));
    let transform = transforms::description(&shape.to_world);
    let description = ShapeDescription { disc: Some(disc), transform, ..ShapeDescription::default() };
    Ok(Geometry { description, area, body: Body::Other })
}

fn cylinder(shape: &Shape, context: &Context) -> Result<Geometry, ImportError> {
    let (parameters, place) = (&shape.entity.parameters, &shape.entity.place);
    let radius = above_zero(shape, "radius", 1.0)?;
    let (low, high) = (parameters.float_or("zmin", -1.0)?, parameters.float_or("zmax", 1.0)?);
    if low >= high {
        return Err(place.error("`zmin` must be below `zmax`"));
    }
    if parameters.float_or("phimax", 360.0)? < 360.0 {
        context.unsupported(place, "a part of a cylinder is the whole cylinder");
    }
    let cylinder = CylinderShape { from: [0.0, 0.0, low], to: [0.0, 0.0, high], radius, capped: false };
    let scale = affine::uniform_scale(&shape.to_world);
    let area = scale.map(|scale| (2.0 * PI * radius * (high - low) * scale * scale, 1));
    let transform = transforms::description(&shape.to_world);
    let description = ShapeDescription { cylinder: Some(cylinder), transform, ..ShapeDescription::default() };
    Ok(Geometry { description, area, body: Body::Other })
}

fn above_zero(shape: &Shape, name: &str, default: f64) -> Result<f64, ImportError> {
    let number = shape.entity.parameters.float_or(name, default)?;
    if number > 0.0 {
        return Ok(number);
    }
    Err(shape.entity.place.error(format!("`{name}` must be above 0")))
}

/// Triangles in their own space.
#[derive(Debug)]
struct Soup {
    vertices: Vec<DVec3>,
    triangles: Vec<[u32; 3]>,
    normals: Vec<DVec3>,
    uvs: Vec<[f64; 2]>,
}

impl Soup {
    fn corners(&self, triangle: &[u32; 3]) -> [DVec3; 3] {
        triangle.map(|vertex| self.vertices[vertex as usize])
    }

    /// Every triangle gets vertices of its own, at (0, 0), (1, 0), (1, 1): what pbrt takes where none are given.
    fn give_texture_coordinates(&mut self) {
        let of = |list: &[DVec3], triangles: &[[u32; 3]]| -> Vec<DVec3> {
            triangles.iter().flatten().filter_map(|&vertex| list.get(vertex as usize).copied()).collect()
        };
        self.vertices = of(&self.vertices, &self.triangles);
        self.normals = of(&self.normals, &self.triangles);
        self.uvs = self.triangles.iter().flat_map(|_| [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0]]).collect();
        self.triangles = (0..self.triangles.len() as u32).map(|n| [3 * n, 3 * n + 1, 3 * n + 2]).collect();
    }

    /// Every patch gets vertices of its own, whose texture coordinates are the corners of the unit square.
    fn spread_patches(&mut self, patches: &[[u32; 4]]) {
        let of = |list: &[DVec3]| -> Vec<DVec3> {
            patches.iter().flatten().filter_map(|&vertex| list.get(vertex as usize).copied()).collect()
        };
        self.vertices = of(&self.vertices);
        self.normals = of(&self.normals);
        self.uvs = patches.iter().flat_map(|_| [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [1.0, 1.0]]).collect();
        let corners = |n: u32| [[4 * n, 4 * n + 1, 4 * n + 3], [4 * n, 4 * n + 3, 4 * n + 2]];
        self.triangles = (0..patches.len() as u32).flat_map(corners).collect();
    }

    /// The triangles in the world, in the description itself or in a file.
    fn finish(mut self, shape: &Shape, context: &Context) -> Result<Geometry, ImportError> {
        let body = if self.normals.is_empty() && !shape.is_reversed { self.body() } else { Body::Other };
        let m = shape.to_world.matrix3;
        let to_world_of_normals = m.inverse().transpose();
        self.vertices.iter_mut().for_each(|vertex| *vertex = shape.to_world.transform_point3(*vertex));
        for normal in &mut self.normals {
            *normal = (to_world_of_normals * *normal).normalize_or_zero();
        }
        let is_mirrored = m.determinant() < 0.0;
        let (mut area, count) = (0.0, self.triangles.len());
        for number in 0..count {
            let [a, b, c] = self.corners(&self.triangles[number]);
            let normal = (b - a).cross(c - a);
            area += 0.5 * normal.length();
            let is_turned = match self.normals.is_empty() {
                true => is_mirrored,
                false => {
                    let sum: DVec3 =
                        self.triangles[number].iter().map(|&vertex| self.normals[vertex as usize]).sum();
                    normal.dot(sum) < 0.0
                }
            };
            if is_turned {
                self.triangles[number].swap(1, 2);
            }
        }
        let mesh = if self.vertices.len() <= MOST_INLINE {
            self.into_description()
        } else {
            self.into_file(shape, context)?
        };
        let description = ShapeDescription { mesh: Some(mesh), ..ShapeDescription::default() };
        Ok(Geometry { description, area: Some((area, count)), body })
    }

    fn into_description(self) -> MeshShape {
        let list = |vectors: &[DVec3]| vectors.iter().map(DVec3::to_array).collect::<Vec<_>>();
        MeshShape {
            file: None,
            vertices: Some(list(&self.vertices)),
            triangles: Some(self.triangles),
            normals: Some(list(&self.normals)).filter(|normals| !normals.is_empty()),
            uvs: Some(self.uvs).filter(|uvs| !uvs.is_empty()),
            flat: false,
        }
    }

    fn into_file(self, shape: &Shape, context: &Context) -> Result<MeshShape, ImportError> {
        let place = &shape.entity.place;
        let list = |vectors: &[DVec3]| vectors.iter().map(|v| v.as_vec3().to_array()).collect::<Vec<_>>();
        let mesh = Mesh {
            vertices: list(&self.vertices),
            triangles: self.triangles,
            normals: list(&self.normals),
            uvs: self.uvs.iter().map(|uv| uv.map(|number| number as f32)).collect(),
        };
        let path = context.sidecar.write_mesh(&format!("{}_{}", shape.entity.kind, place.line), &mesh)?;
        Ok(MeshShape { file: Some(text_of(&path, place)?), ..MeshShape::default() })
    }

    /// Whether the triangles are the faces of a box along the axes, each with its normal outwards.
    fn body(&self) -> Body {
        if self.triangles.len() > 64 {
            return Body::Other;
        }
        let min = self.vertices.iter().copied().fold(DVec3::INFINITY, DVec3::min);
        let max = self.vertices.iter().copied().fold(DVec3::NEG_INFINITY, DVec3::max);
        let size = max - min;
        if size.min_element() <= 0.0 {
            return Body::Other;
        }
        let tolerance = 1e-6 * size.max_element();
        let mut covered = [[0.0_f64; 2]; 3];
        for triangle in &self.triangles {
            let corners = self.corners(triangle);
            let normal = (corners[1] - corners[0]).cross(corners[2] - corners[0]);
            let face = (0..3).flat_map(|axis| [(axis, 0, min[axis], -1.0), (axis, 1, max[axis], 1.0)]).find(
                |&(axis, _, plane, sign)| {
                    let is_in_plane = corners.iter().all(|corner| (corner[axis] - plane).abs() <= tolerance);
                    is_in_plane && normal[axis] * sign > 0.0
                },
            );
            let Some((axis, side, ..)) = face else { return Body::Other };
            covered[axis][side] += 0.5 * normal[axis].abs();
        }
        let is_whole = |axis: usize| {
            let area = size[(axis + 1) % 3] * size[(axis + 2) % 3];
            covered[axis].iter().all(|part| (part - area).abs() <= 1e-5 * area)
        };
        if (0..3).all(is_whole) { Body::Box([min, max]) } else { Body::Other }
    }
}
