//! Which shapes the media of a scene need around them.
//!
//! Every medium is inside some shape. Where that is one box or sphere that lets light through and bounds nothing else, it
//! is the volume's own form and no surface is needed; around a grid no more than what the grid reaches to matters. A
//! medium that is inside no shape fills the scene.

use std::path::Path;

use glam::{DAffine3, DVec3};
use tyndall_scene::SceneDescription;
use tyndall_scene::description::{
    BoxShape, MaterialChoice, MaterialDescription, Names, ShapeDescription, TransformDescription,
    VolumeDescription, VolumeSource,
};

use super::transform::{Transform, plain};
use crate::Notes;
use crate::affine::{keeps_axes, map_box};

/// The volumes of one medium.
#[derive(Debug, Clone)]
pub(super) struct MediumVolumes {
    pub names: Vec<String>,
    /// Where they are, unless everywhere in their shapes.
    pub extent: Option<Extent>,
}

/// A unit cube somewhere, outside which there is nothing of a medium.
#[derive(Debug, Clone, Copy)]
pub(super) struct Extent {
    /// The cube to the world.
    pub to_world: DAffine3,
    /// What of the volume is not 0 before it is cut, in the space of the cube; may reach beyond it.
    pub support: [DVec3; 2],
    /// Whether the volume is a box by itself, which can be cut without a surface.
    pub is_box: bool,
}

/// Frees media from shapes that they do not need.
pub(super) fn simplify(
    description: &mut SceneDescription,
    media: &[MediumVolumes],
    path: &Path,
    notes: &mut Notes,
) {
    for medium in media {
        let Some(hull) = hull(description, medium) else {
            tell_reach(description, medium, path, notes);
            continue;
        };
        let is_freed = match &medium.extent {
            None => take_form(description, medium, hull),
            Some(extent) => cut(description, medium, extent, hull),
        };
        if !is_freed {
            tell_reach(description, medium, path, notes);
        }
    }
    description.shapes.retain(|shape| shape.geometry().is_ok());
    fill_the_scene(description, path, notes);
}

/// Number of the one shape that a medium is inside, if it does nothing but bound it.
fn hull(description: &SceneDescription, medium: &MediumVolumes) -> Option<usize> {
    let touches = |shape: &ShapeDescription| {
        names(&shape.interior).chain(names(&shape.exterior)).any(|name| medium.names.contains(name))
    };
    let mut touching = description.shapes.iter().enumerate().filter(|(_, shape)| touches(shape));
    let (number, shape) = touching.next()?;
    let is_bare = shape.exterior.is_none()
        && shape.emission.is_none()
        && shape.instances.is_none()
        && !shape.flip
        && is_null(description, &shape.material)
        && names(&shape.interior).eq(&medium.names);
    if touching.next().is_some() || !is_bare {
        return None;
    }
    // Where the file puts the camera elsewhere than it is, only counting surfaces gives the same picture.
    let eye = DVec3::from_array(description.camera.position);
    let claims = names(&description.camera.inside).any(|name| medium.names.contains(name));
    let is_inside = is_inside(shape, eye)?;
    (is_inside || !claims).then_some(number)
}

/// Whether a point is in a box or sphere.
fn is_inside(shape: &ShapeDescription, point: DVec3) -> Option<bool> {
    let point = to_world(shape).inverse().transform_point3(point);
    if let Some(cuboid) = &shape.cuboid {
        let [min, max] = [cuboid.min, cuboid.max].map(DVec3::from_array);
        return Some(point.cmpge(min).all() && point.cmple(max).all());
    }
    let sphere = shape.sphere.as_ref()?;
    Some(point.distance(DVec3::from_array(sphere.center)) <= sphere.radius)
}

fn to_world(shape: &ShapeDescription) -> DAffine3 {
    shape.transform.as_ref().map_or(DAffine3::IDENTITY, TransformDescription::to_affine)
}

/// Gives a homogeneous medium the form of its shape.
fn take_form(description: &mut SceneDescription, medium: &MediumVolumes, hull: usize) -> bool {
    let shape = description.shapes[hull].clone();
    let mut volumes = description.volumes.iter_mut().filter(|volume| is_one_of(volume, medium));
    let (Some(volume), None) = (volumes.next(), volumes.next()) else { return false };
    // Grids of a volume stand in its space.
    if volume.albedo_grid.is_some() && shape.transform.is_some() {
        return false;
    }
    (volume.cuboid, volume.sphere, volume.transform) = (shape.cuboid, shape.sphere, shape.transform);
    remove(description, hull);
    leave(description, medium);
    true
}

/// Cuts a medium in a cube to what its shape leaves of it; with a box if something of the medium lies beyond.
fn cut(description: &mut SceneDescription, medium: &MediumVolumes, extent: &Extent, hull: usize) -> bool {
    let shape = &description.shapes[hull];
    let [min, max] = extent.support;
    let to_cube = extent.to_world.inverse() * to_world(shape);
    let kept = if let Some(cuboid) = shape.cuboid.filter(|_| keeps_axes(&to_cube)) {
        let corners = map_box(&to_cube, [cuboid.min, cuboid.max].map(DVec3::from_array));
        // Faces that coincide but for rounding do.
        let snap = |x: f64| if (x - x.round()).abs() < 1e-7 { x.round() } else { x };
        let [low, high] = corners.map(|corner| DVec3::from_array(corner.to_array().map(snap)));
        [low.max(DVec3::ZERO), high.min(DVec3::ONE)]
    } else if let Some(sphere) = &shape.sphere {
        let to_shape = to_cube.inverse();
        let contains = |[min, max]: [DVec3; 2]| {
            (0..8).all(|corner| {
                let pick = |axis: usize| if corner >> axis & 1 == 1 { max[axis] } else { min[axis] };
                let corner = to_shape.transform_point3(DVec3::from_array(std::array::from_fn(pick)));
                corner.distance(sphere.center.into()) <= sphere.radius
            })
        };
        let reach = [min.max(DVec3::ZERO), max.min(DVec3::ONE)];
        if !contains(reach) {
            return extent.is_box || reach == extent.support;
        }
        [DVec3::ZERO, DVec3::ONE]
    } else {
        return extent.is_box || DVec3::ZERO.cmple(min).all() && DVec3::ONE.cmpge(max).all();
    };
    if kept[0].cmpge(kept[1]).any() {
        return false;
    }
    let holds_all = kept[0].cmple(min).all() && kept[1].cmpge(max).all();
    let corners = BoxShape { min: kept[0].to_array(), max: kept[1].to_array() };
    if holds_all {
        remove(description, hull);
        leave(description, medium);
    } else if extent.is_box {
        for volume in description.volumes.iter_mut().filter(|volume| is_one_of(volume, medium)) {
            volume.cuboid = Some(corners);
        }
        remove(description, hull);
        leave(description, medium);
    } else {
        let (cuboid, transform) = match keeps_axes(&extent.to_world) {
            true => {
                let [min, max] = map_box(&extent.to_world, kept);
                (BoxShape { min: min.to_array().map(plain), max: max.to_array().map(plain) }, None)
            }
            false => (corners, Transform::describe(&extent.to_world)),
        };
        let shape = &mut description.shapes[hull];
        *shape = ShapeDescription {
            name: shape.name.take(),
            cuboid: Some(cuboid),
            transform,
            material: shape.material.take(),
            interior: shape.interior.take(),
            ..ShapeDescription::default()
        };
    }
    true
}

/// Tells of a grid that goes on beyond its box, if no surface cuts it there.
fn tell_reach(description: &SceneDescription, medium: &MediumVolumes, path: &Path, notes: &mut Notes) {
    let Some(extent) = medium.extent.filter(|extent| !extent.is_box) else { return };
    let [min, max] = extent.support;
    let is_used =
        description.shapes.iter().any(|shape| names(&shape.interior).any(|name| medium.names.contains(name)));
    if is_used && (min.cmplt(DVec3::ZERO).any() || max.cmpgt(DVec3::ONE).any()) {
        let name = medium.names.first().map_or("", String::as_str);
        let message = format!(
            "the grid of the medium `{name}` ends half a cell beyond its box, where its shape lets it"
        );
        notes.choice(path, 1, message);
    }
}

/// Leaves a hole in the list, so that numbers of shapes stay.
fn remove(description: &mut SceneDescription, shape: usize) {
    description.shapes[shape] = ShapeDescription::default();
}

/// The camera is not told to be in volumes that no shape bounds.
fn leave(description: &mut SceneDescription, medium: &MediumVolumes) {
    let inside = names(&description.camera.inside).filter(|name| !medium.names.contains(name)).cloned();
    description.camera.inside = Names::some(inside.collect());
}

fn is_one_of(volume: &VolumeDescription, medium: &MediumVolumes) -> bool {
    volume.name.as_ref().is_some_and(|name| medium.names.contains(name))
}

fn is_null(description: &SceneDescription, material: &Option<MaterialChoice>) -> bool {
    match material {
        Some(MaterialChoice::Here(material)) => **material == MaterialDescription::Null,
        Some(MaterialChoice::Name(name)) => {
            let named = description.materials.iter().find(|material| material.name == *name);
            named.is_some_and(|named| named.material == MaterialDescription::Null)
        }
        None => false,
    }
}

/// Lets the medium that is inside no shape fill the scene.
fn fill_the_scene(description: &mut SceneDescription, path: &Path, notes: &mut Notes) {
    let bounded: Vec<String> =
        description.shapes.iter().flat_map(|shape| names(&shape.interior)).cloned().collect();
    let is_everywhere = |volume: &VolumeDescription| {
        let is_bounded = volume.name.as_ref().is_some_and(|name| bounded.contains(name));
        !is_bounded && volume.source() == Ok(VolumeSource::Shapes)
    };
    let (everywhere, rest): (Vec<_>, Vec<_>) = description.volumes.drain(..).partition(is_everywhere);
    description.volumes = rest;
    let mut everywhere = everywhere.into_iter();
    if let Some(volume) = everywhere.next() {
        let filling = volume.name.clone().unwrap_or_default();
        if volume.albedo_grid.is_some() {
            notes.unsupported(
                path,
                1,
                format!("the albedo of `{filling}`, which fills the scene, does not vary"),
            );
        }
        description.medium = Some(volume.medium);
        let gone: Vec<String> = everywhere.filter_map(|volume| volume.name).collect();
        for name in &gone {
            let message =
                format!("the medium `{name}` is inside no shape, as `{filling}` is, and is left out");
            notes.unsupported(path, 1, message);
        }
        for shape in &mut description.shapes {
            let mut exterior: Vec<String> = names(&shape.exterior).cloned().collect();
            exterior.retain(|name| !gone.contains(name));
            for name in exterior.iter_mut().filter(|name| **name == filling) {
                *name = "medium".into();
            }
            shape.exterior = Names::some(exterior);
        }
    }
    let inside = names(&description.camera.inside).filter(|name| bounded.contains(name)).cloned();
    description.camera.inside = Names::some(inside.collect());
}

fn names(names: &Option<Names>) -> impl Iterator<Item = &String> {
    names.iter().flat_map(|names| names.all())
}
