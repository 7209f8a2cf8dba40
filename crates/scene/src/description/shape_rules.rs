//! What must hold between the keys of a shape, and between shapes, materials and volumes.

use std::collections::HashSet;

use glam::DVec3;

use super::rules::{Findings, light_spectrum, transform_is_invertible};
use super::{
    MaterialChoice, MaterialDescription, MeshShape, Names, SceneDescription, ShapeDescription, ShapeGeometry,
    VolumeSource,
};
use crate::suggestion::did_you_mean;

/// Reports what is wrong with the shapes, and with materials and volumes as shapes use them.
pub(super) fn shapes(found: &mut Findings, scene: &SceneDescription) {
    for (index, description) in scene.shapes.iter().enumerate() {
        within(found, "shape", index, |found| shape(found, description, scene));
    }
    let bounded: HashSet<&str> = scene
        .shapes
        .iter()
        .flat_map(|shape| shape.interior.as_ref().map_or(&[][..], Names::all))
        .map(String::as_str)
        .collect();
    for (index, volume) in scene.volumes.iter().enumerate() {
        let is_bounded = volume.name.as_deref().is_some_and(|name| bounded.contains(name));
        if volume.source() == Ok(VolumeSource::Shapes) && !is_bounded {
            let message = "the volume has no shape: give one of `file`, `box`, `sphere`, `slab`, `atmosphere`, `procedural`, \
                           or a [[shape]] with its `name` for `interior`";
            within(found, "volume", index, |found| found.report("", message));
        }
    }
}

fn within(found: &mut Findings, table: &str, index: usize, inspect: impl FnOnce(&mut Findings)) {
    found.within(table, |found| found.within(&index.to_string(), inspect));
}

fn shape(found: &mut Findings, shape: &ShapeDescription, scene: &SceneDescription) {
    match shape.geometry() {
        Ok(geometry) => geometry_rules(found, geometry),
        Err((key, message)) => found.report(key, message),
    }
    if let Some(transform) = &shape.transform {
        found.within("transform", |found| transform_is_invertible(found, transform, "shape"));
    }
    for (index, instance) in shape.instances.iter().flatten().enumerate() {
        within(found, "instances", index, |found| transform_is_invertible(found, instance, "shape"));
    }
    if shape.material.is_none() {
        found.report(
            "",
            "the shape has no `material`: give the name of a [[material]], or one such as { type = \"diffuse\" }, or \
             { type = \"null\" } if it is only the boundary of a volume",
        );
    }
    if let Some(emission) = &shape.emission {
        if is_null(shape.material.as_ref(), scene) {
            let message = "a surface of `null` is not there, and cannot shine: give another `material`";
            found.report("emission", message);
        }
        found.within("emission", |found| {
            light_spectrum(found, "radiance", &emission.radiance, emission.scale);
        });
    }
    for (key, names) in [("interior", &shape.interior), ("exterior", &shape.exterior)] {
        for name in names.as_ref().map_or(&[][..], Names::all) {
            volume_name(found, key, name, scene);
        }
    }
}

fn is_null(material: Option<&MaterialChoice>, scene: &SceneDescription) -> bool {
    let material = match material {
        None => return false,
        Some(MaterialChoice::Here(material)) => Some(&**material),
        Some(MaterialChoice::Name(name)) => {
            scene.materials.iter().find(|material| material.name == *name).map(|material| &material.material)
        }
    };
    matches!(material, Some(MaterialDescription::Null))
}

fn volume_name(found: &mut Findings, key: &str, name: &str, scene: &SceneDescription) {
    let fills_scene = scene.medium.iter().map(|_| "medium");
    let names =
        || fills_scene.clone().chain(scene.volumes.iter().filter_map(|volume| volume.name.as_deref()));
    match names().filter(|other| *other == name).count() {
        1 => {}
        0 => found.report(key, format!("`{key}`: {}", unknown_volume(name, names()))),
        _ => {
            found.report(key, format!("`{key}`: several volumes are named `{name}`: give each its own name"))
        }
    }
}

fn geometry_rules(found: &mut Findings, geometry: ShapeGeometry<'_>) {
    match geometry {
        ShapeGeometry::Mesh(shape) => found.within("mesh", |found| mesh(found, shape)),
        ShapeGeometry::Box(shape) if (0..3).any(|axis| shape.min[axis] >= shape.max[axis]) => {
            found.report("box", "`box` is empty: each number of `min` must be less than that of `max`");
        }
        ShapeGeometry::Sphere(_) | ShapeGeometry::Box(_) => {}
        ShapeGeometry::Rectangle(shape) => {
            let (u, v) = (DVec3::from_array(shape.u), DVec3::from_array(shape.v));
            if u.cross(v).try_normalize().is_none() {
                let message = "`rectangle` has no area: `u` and `v` must point different ways";
                found.report("rectangle", message);
            }
        }
        ShapeGeometry::Disc(shape) => found.within("disc", |found| {
            found.report_zero("normal", shape.normal);
            if shape.inner_radius >= shape.radius {
                found.report("inner_radius", "`inner_radius` must be less than `radius`");
            }
        }),
        ShapeGeometry::Cylinder(shape) => {
            let along = DVec3::from_array(shape.to) - DVec3::from_array(shape.from);
            if along.try_normalize().is_none() {
                found.report("cylinder", "`cylinder` has no length: `from` and `to` must differ");
            }
        }
        ShapeGeometry::Plane(shape) => {
            found.within("plane", |found| found.report_zero("normal", shape.normal));
        }
    }
}

fn mesh(found: &mut Findings, mesh: &MeshShape) {
    let inline = [
        ("vertices", mesh.vertices.as_ref().map(Vec::len)),
        ("triangles", mesh.triangles.as_ref().map(Vec::len)),
        ("normals", mesh.normals.as_ref().map(Vec::len)),
        ("uvs", mesh.uvs.as_ref().map(Vec::len)),
    ];
    if mesh.file.is_some() {
        for (key, _) in inline.iter().filter(|(_, length)| length.is_some()) {
            found.report(key, format!("the mesh has both `file` and `{key}`: keep one"));
        }
        return;
    }
    let (Some(vertices), Some(triangles)) = (&mesh.vertices, &mesh.triangles) else {
        return found.report("", "the mesh has no triangles: give a `file`, or `vertices` and `triangles`");
    };
    if triangles.is_empty() {
        found.report("triangles", "`triangles` is empty: nothing of the mesh can be seen");
    }
    if let Some(corner) = triangles.iter().flatten().find(|corner| **corner as usize >= vertices.len()) {
        let count = vertices.len();
        found.report(
            "triangles",
            format!("`triangles`: there is no vertex {corner}, the {count} are numbered from 0"),
        );
    }
    for (key, length) in &inline[2..] {
        if let Some(length) = length.filter(|length| *length != vertices.len()) {
            let count = vertices.len();
            found.report(key, format!("`{key}` are one for each vertex: {count}, not {length}"));
        }
    }
}

/// What is said of a name that no volume has.
pub(crate) fn unknown_volume<'a>(name: &str, names: impl Iterator<Item = &'a str>) -> String {
    let names: Vec<&str> = names.collect();
    if names.is_empty() {
        return format!(
            "there is no volume `{name}`, nor any with a name: add a [[volume]] with `name = \"{name}\"`"
        );
    }
    format!("there is no volume `{name}`{}", did_you_mean(name, names.into_iter()))
}
