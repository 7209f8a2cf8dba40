//! From `[[shape]]` tables to surfaces ready to trace.

use std::collections::HashMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use glam::{DAffine3, DMat3, DVec3};

use super::closed::is_closed;
use super::placed::{Geometry, Placed};
use super::triangle_mesh::TriangleMesh;
use super::{MaterialBuilder, Mesh, Shape, Surfaces, read_mesh};
use crate::description::{
    MaterialChoice, MaterialDescription, MeshShape, Names, ShapeDescription, ShapeGeometry, material_of_name,
    unknown_volume,
};
use crate::{SceneDescription, SceneError};

/// What shapes call a volume, and its number in the scene, if it has one: what does nothing to light has none.
pub(crate) struct VolumeNumber {
    /// The name.
    pub name: String,
    /// The number.
    pub number: Option<usize>,
}

/// Makes the shapes of `description`, whose file names are relative to `folder`, ready.
pub(crate) fn build_surfaces(
    description: &SceneDescription,
    folder: &Path,
    volumes: &[VolumeNumber],
    notes: &mut Vec<String>,
) -> Result<Surfaces, SceneError> {
    let mut surfaces = Surfaces::default();
    let mut meshes = HashMap::new();
    let mut builder = MaterialBuilder::new(&description.materials, folder);
    let mut named = HashMap::new();
    for (index, shape) in description.shapes.iter().enumerate() {
        let name = shape.name.clone().unwrap_or_else(|| format!("shape.{index}"));
        let refuse = |message: String| SceneError::file(Path::new(&name), message);
        let (geometry, to_own) = geometry(shape, &name, folder, &mut meshes, notes)?;
        if shape.interior.is_some() && !encloses(&geometry) {
            notes.push(format!(
                "{name}: the surface is not closed: volumes that it has for `interior` begin where light crosses it one way \
                 and end only where light crosses back"
            ));
        }
        let mut add = |description: &MaterialDescription, place: &str, notes: &mut Vec<String>| {
            surfaces.materials.push(builder.build(description, place, notes)?);
            Ok::<usize, SceneError>(surfaces.materials.len() - 1)
        };
        let material = match &shape.material {
            None => add(&MaterialDescription::Null, &name, notes)?,
            Some(MaterialChoice::Here(material)) => add(material, &name, notes)?,
            Some(MaterialChoice::Name(name)) => match named.get(name) {
                Some(&number) => number,
                None => {
                    let material = material_of_name(name, &description.materials).map_err(refuse)?;
                    let number = add(&material.material, name, notes)?;
                    *named.entry(name).or_insert(number)
                }
            },
        };
        let interior = numbers_of(shape.interior.as_ref(), volumes).map_err(refuse)?;
        let exterior = numbers_of(shape.exterior.as_ref(), volumes).map_err(refuse)?;
        let transform =
            shape.transform.as_ref().map_or(DAffine3::IDENTITY, |transform| transform.to_affine());
        let once = [DAffine3::IDENTITY];
        let instances: Option<Vec<DAffine3>> = shape
            .instances
            .as_ref()
            .map(|instances| instances.iter().map(|instance| instance.to_affine()).collect());
        let is_one = instances.is_none();
        for (number, instance) in instances.as_deref().unwrap_or(&once).iter().enumerate() {
            let to_world = *instance * transform * to_own;
            let placed = Placed::new(geometry.clone(), to_world, shape.flip)
                .ok_or_else(|| refuse("its transform makes it flat: give scales other than 0".into()))?;
            surfaces.placed.push(placed);
            surfaces.shapes.push(Shape {
                name: if is_one { name.clone() } else { format!("{name}.instances.{number}") },
                material,
                interior: interior.clone(),
                exterior: exterior.clone(),
                light: None,
                id: shape.id.unwrap_or(index as u32 + 1),
                is_shadow_catcher: shape.shadow_catcher,
            });
        }
    }
    surfaces.index();
    Ok(surfaces)
}

/// The numbers of the volumes of these names.
pub(crate) fn numbers_of(names: Option<&Names>, volumes: &[VolumeNumber]) -> Result<Vec<usize>, String> {
    let names = names.map_or(&[][..], Names::all).iter();
    let found = names.map(|name| match volumes.iter().find(|volume| volume.name == *name) {
        Some(volume) => Ok(volume.number),
        None => Err(unknown_volume(name, volumes.iter().map(|volume| volume.name.as_str()))),
    });
    found.filter_map(Result::transpose).collect()
}

/// What a shape is in coordinates of its own, and these in those of the shape.
fn geometry(
    shape: &ShapeDescription,
    name: &str,
    folder: &Path,
    meshes: &mut HashMap<PathBuf, Arc<TriangleMesh>>,
    notes: &mut Vec<String>,
) -> Result<(Geometry, DAffine3), SceneError> {
    let geometry = shape.geometry().map_err(|(_, message)| SceneError::file(Path::new(name), message))?;
    let vector = DVec3::from_array;
    Ok(match geometry {
        ShapeGeometry::Mesh(description) => {
            let mesh = triangles(description, name, folder, meshes, notes)?;
            (Geometry::Mesh { mesh, smooth: !description.flat }, DAffine3::IDENTITY)
        }
        ShapeGeometry::Sphere(sphere) => {
            let size = DMat3::from_diagonal(DVec3::splat(sphere.radius));
            (Geometry::Sphere, DAffine3::from_mat3_translation(size, vector(sphere.center)))
        }
        ShapeGeometry::Box(cuboid) => {
            let [min, max] = [cuboid.min, cuboid.max].map(DVec3::from_array);
            let size = DMat3::from_diagonal(max - min);
            (Geometry::Cuboid, DAffine3::from_mat3_translation(size, min))
        }
        ShapeGeometry::Rectangle(rectangle) => {
            let (u, v) = (vector(rectangle.u), vector(rectangle.v));
            // As long as the edges are, so that the map is well-conditioned.
            let normal = u.cross(v).normalize_or_zero() * u.length().max(v.length());
            let edges = DMat3::from_cols(u, v, normal);
            (Geometry::Square, DAffine3::from_mat3_translation(edges, vector(rectangle.corner)))
        }
        ShapeGeometry::Disc(disc) => {
            let axes = about(vector(disc.normal)) * disc.radius;
            let inner_radius = disc.inner_radius / disc.radius;
            (Geometry::Disc { inner_radius }, DAffine3::from_mat3_translation(axes, vector(disc.center)))
        }
        ShapeGeometry::Cylinder(cylinder) => {
            let along = vector(cylinder.to) - vector(cylinder.from);
            let axes = about(along) * cylinder.radius;
            let axes = DMat3::from_cols(axes.x_axis, axes.y_axis, along);
            let geometry = Geometry::Cylinder { capped: cylinder.capped };
            (geometry, DAffine3::from_mat3_translation(axes, vector(cylinder.from)))
        }
        ShapeGeometry::Plane(plane) => {
            let axes = about(vector(plane.normal));
            (Geometry::Plane, DAffine3::from_mat3_translation(axes, vector(plane.point)))
        }
    })
}

/// Right-handed unit axes of which the third is along `direction`.
fn about(direction: DVec3) -> DMat3 {
    let z = direction.normalize_or_zero();
    let x = if z == DVec3::ZERO { DVec3::ZERO } else { z.any_orthonormal_vector() };
    DMat3::from_cols(x, z.cross(x), z)
}

/// The triangles of a mesh; those of a file are read once.
fn triangles(
    description: &MeshShape,
    name: &str,
    folder: &Path,
    meshes: &mut HashMap<PathBuf, Arc<TriangleMesh>>,
    notes: &mut Vec<String>,
) -> Result<Arc<TriangleMesh>, SceneError> {
    if let Some(file) = &description.file {
        let path = folder.join(file);
        if let Some(mesh) = meshes.get(&path) {
            return Ok(Arc::clone(mesh));
        }
        let mesh = Arc::new(TriangleMesh::new(read_mesh(&path, notes)?));
        meshes.insert(path, Arc::clone(&mesh));
        return Ok(mesh);
    }
    let vectors = |values: &[[f64; 3]]| values.iter().copied().map(DVec3::from_array).collect();
    let mesh = Mesh {
        positions: vectors(description.vertices.as_deref().unwrap_or_default()),
        normals: description.normals.as_deref().map(vectors),
        uvs: description.uvs.clone(),
        triangles: description.triangles.clone().unwrap_or_default(),
    };
    let mut own = Vec::new();
    let mesh = mesh.checked(&mut own).map_err(|message| SceneError::file(Path::new(name), message))?;
    notes.extend(own.into_iter().map(|note| format!("{name}: {note}")));
    Ok(Arc::new(TriangleMesh::new(mesh)))
}

/// Whether a geometry has an inside.
fn encloses(geometry: &Geometry) -> bool {
    match geometry {
        Geometry::Mesh { mesh, .. } => is_closed(mesh.mesh()),
        Geometry::Sphere | Geometry::Cuboid | Geometry::Plane | Geometry::Cylinder { capped: true } => true,
        Geometry::Square | Geometry::Disc { .. } | Geometry::Cylinder { capped: false } => false,
    }
}
