//! `<shape>`: surfaces.
//!
//! A rectangle is [−1, 1]² in z = 0 with its normal along +z, a disk the unit disc likewise, a cube [−1, 1]³; all of them
//! under `to_world`. A mirroring `to_world` leaves the outside of these and of meshes outside, but turns spheres and
//! cylinders inside out. `flip_normals` turns any of them.

use std::collections::HashMap;
use std::path::Path;

use glam::{DAffine3, DVec3};
use tyndall_scene::description::{
    BoxShape, CylinderShape, DiscShape, MaterialChoice, MaterialDescription, MeshShape, Names,
    RectangleShape, ShapeDescription, SphereShape, SurfaceEmission, TransformDescription,
};

use super::importer::Importer;
use super::material::Use;
use super::object::{Class, Object};
use super::smooth::with_normals;
use super::spectrum::Role;
use super::transform::{GREATEST, Transform, plain};
use crate::ImportError;
use crate::affine::{is_flat, uniform_scale};

/// Greatest number of shapes, all instances counted.
const INSTANCES: usize = 1 << 22;

/// Groups of shapes, and where each stands.
#[derive(Debug, Default)]
pub(super) struct Instances {
    /// In the order in which they came.
    groups: Vec<usize>,
    transforms: HashMap<usize, Vec<TransformDescription>>,
}

impl<'a> Importer<'a> {
    /// Adds a shape, or the shapes of a `merge`; what is an instance is gathered.
    pub fn shape(&mut self, number: usize) -> Result<(), ImportError> {
        let object = self.object(number);
        match object.plugin.as_str() {
            "shapegroup" => Ok(()),
            "instance" => self.instance(number),
            "merge" => {
                for shape in self.children(object, Class::Shape) {
                    self.within(number, |importer| importer.shape(shape))?;
                }
                self.tell_unused(object);
                Ok(())
            }
            _ => {
                let shape = self.within(number, |importer| importer.single_shape(object))?;
                self.shapes.extend(shape);
                Ok(())
            }
        }
    }

    fn instance(&mut self, number: usize) -> Result<(), ImportError> {
        let object = self.object(number);
        let Some(group) = self.child(object, Class::Shape) else {
            return Err(object.place.error("the instance has no shapegroup: add a <ref> to one"));
        };
        let map = object.transform("to_world")?.map;
        self.tell_unused(object);
        if is_flat(&map) {
            return Err(object.place.error("the `to_world` of the instance is flat: no factor may be 0"));
        }
        let transforms = self.instances.transforms.entry(group).or_default();
        if transforms.is_empty() {
            self.instances.groups.push(group);
        }
        transforms.push(Transform::describe(&map).unwrap_or_default());
        Ok(())
    }

    /// Adds the shapes of all groups.
    pub fn groups(&mut self) -> Result<(), ImportError> {
        let Instances { groups, mut transforms } = std::mem::take(&mut self.instances);
        let mut count = 0;
        for group in groups {
            let object = self.object(group);
            let transforms = transforms.remove(&group).unwrap_or_default();
            let members = match object.plugin.as_str() {
                "shapegroup" => self.children(object, Class::Shape),
                _ => vec![group],
            };
            for member in members {
                let before = self.shapes.len();
                self.within(group, |importer| match importer.object(member).plugin.as_str() {
                    "instance" | "shapegroup" => {
                        let place = &importer.object(member).place;
                        importer
                            .unsupported(place, "instances within groups are not supported and are left out");
                        Ok(())
                    }
                    _ if member == group => Ok(()),
                    _ => importer.shape(member),
                })?;
                for shape in &mut self.shapes[before..] {
                    count += transforms.len();
                    if count > INSTANCES {
                        return Err(object.place.error("the scene has too many instances"));
                    }
                    shape.instances = Some(transforms.clone());
                }
            }
            self.tell_unused(object);
        }
        Ok(())
    }

    /// A shape; none if it is invisible.
    fn single_shape(&mut self, object: &'a Object) -> Result<Option<ShapeDescription>, ImportError> {
        object.ignore(&["silhouette_sampling_weight"]);
        let map = object.transform("to_world")?.map;
        let flip_normals = object.boolean("flip_normals", false)?;
        let is_mirrored = map.matrix3.determinant() < 0.0;
        let mut shape = ShapeDescription { flip: flip_normals, ..ShapeDescription::default() };
        let mut flipped = false;
        match object.plugin.as_str() {
            "sphere" => {
                sphere(&mut shape, object, &map)?;
                shape.flip ^= is_mirrored;
            }
            "cylinder" => {
                cylinder(&mut shape, object, &map)?;
                shape.flip ^= is_mirrored;
            }
            "cube" => cube(&mut shape, &map),
            "rectangle" => {
                rectangle(&mut shape, &map);
                shape.flip ^= is_mirrored;
            }
            "disk" => disc(&mut shape, &map),
            "ply" | "obj" => {
                let Some(name) = object.text("filename")? else {
                    return Err(object.place.error(format!("{} has no `filename`: add it", object.title())));
                };
                let file = self.document.find(name, &object.place)?.to_string_lossy().into_owned();
                let flat = object.boolean("face_normals", false)?;
                flipped = object.boolean("flip_tex_coords", object.plugin == "obj")?;
                shape.mesh = Some(MeshShape { file: Some(file), flat, ..MeshShape::default() });
                shape.transform = Transform::describe(&map);
            }
            "serialized" => {
                self.unsupported(
                    &object.place,
                    "`serialized` meshes are not read and are left out: convert them to .ply",
                );
                return Ok(None);
            }
            _ => {
                let message = format!("{} is not supported and is left out", object.title());
                self.unsupported(&object.place, message);
                return Ok(None);
            }
        }
        if is_degenerate(&shape, &map) {
            let message = format!("{} has no extent and is left out", object.title());
            self.choice(&object.place, message);
            return Ok(None);
        }
        let emitters = self.children(object, Class::Emitter);
        shape.emission = match emitters.first() {
            Some(emitter) => self.lamp(*emitter)?,
            None => None,
        };
        let shines = !emitters.is_empty();
        shape.interior = self.bounded(object, "interior")?;
        shape.exterior = self.bounded(object, "exterior")?;
        shape.material = Some(self.material_of(object, flipped, shines, shape.interior.is_some())?);
        if object.objects().any(|(_, number)| self.object(number).class == Class::Sensor) {
            self.unsupported(&object.place, "a sensor on a shape is not supported and is left out");
            self.children(object, Class::Sensor);
        }
        if object.id.is_some() {
            shape.name = Some(self.name(object));
        }
        self.tell_unused(object);
        if !is_null(&shape.material) {
            self.smooth(&mut shape)?;
        }
        if is_null(&shape.material) {
            if shape.interior.is_none() && shape.exterior.is_none() && shape.emission.is_none() {
                return Ok(None);
            }
            if shape.emission.is_some() {
                let message = "a lamp with a `null` bsdf is not supported: it lets no light through";
                self.unsupported(&object.place, message);
                shape.material = Some(black());
            }
        }
        Ok(Some(shape))
    }

    /// Gives a mesh without normals those that Mitsuba computes.
    fn smooth(&mut self, shape: &mut ShapeDescription) -> Result<(), ImportError> {
        let Some(mesh) = shape.mesh.as_mut().filter(|mesh| !mesh.flat) else { return Ok(()) };
        let Some(file) = &mesh.file else { return Ok(()) };
        let joins = file.ends_with(".obj");
        if let Some(smooth) = with_normals(Path::new(file), joins, self.sidecar)? {
            mesh.file = Some(smooth);
        }
        Ok(())
    }

    fn material_of(
        &mut self,
        object: &'a Object,
        flipped: bool,
        shines: bool,
        has_interior: bool,
    ) -> Result<MaterialChoice, ImportError> {
        if let Some(bsdf) = self.child(object, Class::Bsdf) {
            if self.has_texture(bsdf, 0) && !matches!(object.plugin.as_str(), "ply" | "obj" | "rectangle") {
                let message = format!("a texture on a `{}` may lie on it in another way", object.plugin);
                self.choice(&object.place, message);
            }
            return self.material(bsdf, Use { flipped, two_sided: false });
        }
        if shines {
            return Ok(black());
        }
        let message = if has_interior {
            "a shape without a bsdf is diffuse, and the medium within is not seen: `null` would let light in"
        } else {
            "a shape without a bsdf is diffuse, 0.5"
        };
        self.choice(&object.place, message);
        Ok(MaterialChoice::Here(Box::new(MaterialDescription::Diffuse { reflectance: 0.5.into() })))
    }

    fn bounded(&mut self, object: &'a Object, side: &str) -> Result<Option<Names>, ImportError> {
        match self.named_child(object, side, Class::Medium) {
            Some(medium) => Ok(Names::some(self.medium(medium)?)),
            None => Ok(None),
        }
    }

    fn lamp(&mut self, number: usize) -> Result<Option<SurfaceEmission>, ImportError> {
        let object = self.object(number);
        object.ignore(&["sampling_weight"]);
        if object.plugin != "area" {
            let message = format!("{} is not supported: the surface does not shine", object.title());
            self.unsupported(&object.place, message);
            return Ok(None);
        }
        let radiance = self.spectrum(object, "radiance", Role::Light, 1.0)?;
        self.tell_unused(object);
        Ok(Some(SurfaceEmission { radiance, scale: 1.0, two_sided: false }))
    }
}

fn is_null(material: &Option<MaterialChoice>) -> bool {
    matches!(material, Some(MaterialChoice::Here(here)) if **here == MaterialDescription::Null)
}

fn black() -> MaterialChoice {
    MaterialChoice::Here(Box::new(MaterialDescription::Diffuse { reflectance: 0.0.into() }))
}

/// Whether nothing can hit the shape, or no file can say it.
fn is_degenerate(shape: &ShapeDescription, map: &DAffine3) -> bool {
    let crosses = |u: [f64; 3], v: [f64; 3]| {
        let cross = DVec3::from_array(u).cross(DVec3::from_array(v));
        cross.is_finite() && cross.try_normalize().is_some()
    };
    if let Some(rectangle) = &shape.rectangle {
        return !crosses(rectangle.u, rectangle.v);
    }
    is_flat(map)
}

fn sphere(shape: &mut ShapeDescription, object: &Object, map: &DAffine3) -> Result<(), ImportError> {
    let center = DVec3::from_array(object.vector("center")?.unwrap_or_default());
    let radius = radius(object)?;
    let similar = uniform_scale(map);
    let (center, radius) = match similar {
        Some(scale) => (map.transform_point3(center), radius * scale),
        None => (center, radius),
    };
    shape.sphere = Some(SphereShape { center: center.to_array().map(plain), radius });
    shape.transform = if similar.is_some() { None } else { Transform::describe(map) };
    Ok(())
}

fn radius(object: &Object) -> Result<f64, ImportError> {
    let radius = object.float("radius", 1.0)?.abs();
    if radius == 0.0 || radius > GREATEST {
        let message = format!("the `radius` of {} must be above 0, and one to compute with", object.title());
        return Err(object.place.error(message));
    }
    Ok(radius)
}

fn cylinder(shape: &mut ShapeDescription, object: &Object, map: &DAffine3) -> Result<(), ImportError> {
    let radius = radius(object)?;
    let from = DVec3::from_array(object.vector("p0")?.unwrap_or_default());
    let to = DVec3::from_array(object.vector("p1")?.unwrap_or([0.0, 0.0, 1.0]));
    if from == to {
        return Err(object.place.error("the cylinder has no length: `p0` and `p1` must differ"));
    }
    let similar = uniform_scale(map);
    let place = if similar.is_some() { *map } else { DAffine3::IDENTITY };
    let [from, to] = [from, to].map(|point| place.transform_point3(point).to_array().map(plain));
    shape.cylinder = Some(CylinderShape { from, to, radius: radius * similar.unwrap_or(1.0), capped: false });
    shape.transform = if similar.is_some() { None } else { Transform::describe(map) };
    Ok(())
}

fn cube(shape: &mut ShapeDescription, map: &DAffine3) {
    let half = DVec3::from_array(std::array::from_fn(|axis| map.matrix3.row(axis).abs().max_element()));
    // Every column along one axis.
    let columns = [map.matrix3.x_axis, map.matrix3.y_axis, map.matrix3.z_axis];
    let is_upright = columns.iter().all(|column| {
        let length = column.abs().max_element();
        (column.abs().element_sum() - length) <= 1e-12 * length
    });
    let reached: DVec3 = columns.iter().map(|column| column.abs()).sum();
    if is_upright
        && (reached - half).abs().max_element() <= 1e-9 * half.max_element()
        && half.min_element() > 0.0
    {
        let [min, max] = [map.translation - half, map.translation + half];
        shape.cuboid = Some(BoxShape { min: min.to_array().map(plain), max: max.to_array().map(plain) });
    } else {
        shape.cuboid = Some(BoxShape { min: [-1.0; 3], max: [1.0; 3] });
        shape.transform = Transform::describe(map);
    }
}

fn rectangle(shape: &mut ShapeDescription, map: &DAffine3) {
    let corner = map.transform_point3(DVec3::new(-1.0, -1.0, 0.0));
    let [u, v] = [DVec3::X, DVec3::Y].map(|edge| map.transform_vector3(2.0 * edge).to_array().map(plain));
    shape.rectangle = Some(RectangleShape { corner: corner.to_array().map(plain), u, v });
}

fn disc(shape: &mut ShapeDescription, map: &DAffine3) {
    let [x, y] = [map.matrix3.x_axis, map.matrix3.y_axis];
    let radius = x.length();
    let is_round = (y.length() - radius).abs() <= 1e-9 * radius && x.dot(y).abs() <= 1e-9 * radius * radius;
    if is_round && radius > 0.0 {
        let normal = (x.cross(y) / (radius * radius) * map.matrix3.determinant().signum()).to_array();
        let center = map.translation.to_array().map(plain);
        shape.disc = Some(DiscShape { center, normal: normal.map(plain), radius, inner_radius: 0.0 });
    } else {
        shape.disc =
            Some(DiscShape { center: [0.0; 3], normal: [0.0, 0.0, 1.0], radius: 1.0, inner_radius: 0.0 });
        shape.transform = Transform::describe(map);
    }
}
