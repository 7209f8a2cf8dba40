//! pbrt-v4's scene files: <https://pbrt.org/fileformat-v4> and, where that is silent, the program itself.
//!
//! The way of the data:
//!
//!   file ──`tokens`──▶ words ──`directives`──▶ directives ──`state`──▶ `world::World` ──▶ description
//!
//! The world is what the directives have said, with the state that held; nothing in it is in Tyndall's words yet. That is
//! done by one module a subject: `camera`, `lights`, `textures`, `materials`, `shapes`, `media`, and
//! `boundaries`, which finds out where media are.

mod boundaries;
mod camera;
mod cloud;
mod context;
mod directives;
mod files;
mod grids;
mod lights;
mod materials;
mod media;
mod parameters;
mod place;
mod rgb_grid;
mod shapes;
mod spectra;
mod state;
mod textures;
mod tokens;
mod transforms;
mod world;

use std::collections::HashSet;
use std::path::Path;
use std::sync::Arc;

use glam::DAffine3;
use tyndall_scene::SceneDescription;
use tyndall_scene::description::{
    MaterialChoice, MaterialDescription, NamedMaterial, ShapeDescription, SpectrumDescription,
    TextureDescription,
};

use self::boundaries::Boundary;
use self::context::Context;
use self::directives::Entity;
use self::materials::Passage;
use self::parameters::Parameters;
use self::place::Place;
use self::shapes::{Body, Geometry};
use self::textures::Textures;
use self::world::{CameraUse, Shape, World};
use crate::{ImportError, Imported, Sidecar};

/// Reads a pbrt-v4 scene; meshes and grids that it writes out are put into `sidecar`.
///
/// The picture has pbrt's values: its exposure and sensitivity are multiplied into the lights.
///
/// # Errors
/// If a file cannot be read, is no scene, or names what is not there; the message has file and line.
pub fn import_pbrt(path: &Path, sidecar: &Sidecar) -> Result<Imported, ImportError> {
    let path = std::path::absolute(path).map_err(|error| ImportError::unreadable(path, &error))?;
    let context = Context::new(&path, sidecar);
    let mut world = files::read_world(&path, &context)?;
    state::check_instances(&world)?;
    let camera = world.camera.take().unwrap_or_else(|| default_camera(&path));
    let (film, exposure) = camera::film(world.film.as_ref(), &camera, &context)?;
    let mut description = SceneDescription {
        unit: "m".to_owned(),
        camera: camera::camera(&camera, &film, &context)?,
        film,
        render: camera::render(&world, &context)?,
        medium: None,
        volumes: Vec::new(),
        materials: named_materials(&world, &context)?,
        shapes: Vec::new(),
        lights: Vec::new(),
        meters: Vec::new(),
    };
    for (entity, to_world) in &world.lights {
        description.lights.extend(lights::light(entity, to_world, exposure, &context)?);
    }
    let (mut shapes, boundaries) = all_shapes(&world, exposure, &context)?;
    let media = boundaries::media(&world, &boundaries, &camera, &mut shapes, exposure, &context)?;
    description.medium = media.medium;
    description.volumes = media.volumes;
    description.camera.inside = media.inside;
    description.shapes = shapes.into_iter().flatten().collect();
    let description = description.with_counted_numbers();
    // What none of the parts can know of the others, such as a material mixed of too many.
    if let Some(violation) = description.violations().into_iter().next() {
        return Err(ImportError::of(&path, format!("{}: {}", violation.path.join("."), violation.message)));
    }
    Ok(Imported { description, notes: context.into_notes() })
}

/// The camera of a scene that gives none.
fn default_camera(path: &Path) -> CameraUse {
    let place = Place { file: Arc::from(path), line: 1 };
    let entity = Entity { kind: "perspective".to_owned(), parameters: Parameters::default(), place };
    CameraUse { entity, world_to_camera: DAffine3::IDENTITY, medium: String::new() }
}

fn named_materials(world: &World, context: &Context) -> Result<Vec<NamedMaterial>, ImportError> {
    let textures = Textures { world, context };
    let mut names = HashSet::new();
    let mut made = Vec::new();
    for (number, (name, entity)) in world.materials.iter().enumerate() {
        if !names.insert(name) {
            return Err(entity.place.error(format!("the material \"{name}\" is made twice: rename one")));
        }
        made.push(NamedMaterial { name: name.clone(), material: textures.named_material(number, entity)? });
    }
    Ok(made)
}

/// All shapes, and which of them media begin or end at.
fn all_shapes(
    world: &World,
    exposure: f64,
    context: &Context,
) -> Result<(Vec<Option<ShapeDescription>>, Vec<Boundary>), ImportError> {
    let (mut shapes, mut boundaries) = (Vec::new(), Vec::new());
    for shape in &world.shapes {
        let instances = shape.object.map(|object| world.objects[object].instances.as_slice());
        // An object that is nowhere is not seen.
        if instances.is_some_and(<[DAffine3]>::is_empty) {
            continue;
        }
        let passage = materials::passage(&shape.material, world);
        let is_boundary = shape.inside != shape.outside && passage != Passage::None;
        let Some((description, body)) = whole_shape(shape, passage, is_boundary, world, exposure, context)?
        else {
            continue;
        };
        if is_boundary {
            boundaries.push(Boundary {
                shape: shapes.len(),
                inside: shape.inside.to_string(),
                outside: shape.outside.to_string(),
                passage,
                body: if instances.is_some() { Body::Other } else { body },
                to_world: shape.to_world,
                place: shape.entity.place.clone(),
            });
        }
        let placed = |to_world: &DAffine3| transforms::description(to_world).unwrap_or_default();
        let instances = instances.map(|instances| instances.iter().map(placed).collect());
        shapes.push(Some(ShapeDescription { instances, ..description }));
    }
    Ok((shapes, boundaries))
}

/// A shape with its material and light, and the body it bounds; `None` if nothing is left of it.
fn whole_shape(
    shape: &Shape,
    passage: Passage,
    is_boundary: bool,
    world: &World,
    exposure: f64,
    context: &Context,
) -> Result<Option<(ShapeDescription, Body)>, ImportError> {
    let textures = Textures { world, context };
    let place = &shape.entity.place;
    let mut material = textures.material(&shape.material)?;
    let alpha = textures.number(&shape.entity.parameters, "alpha")?;
    let needs_uvs = is_textured(&material, world) || alpha.as_ref().is_some_and(varies);
    let geometry = shapes::geometry(shape, needs_uvs, context)?;
    shape.entity.parameters.pass(&["emissionfilename"]);
    context.tell_unused("Shape", &shape.entity);
    let Some(Geometry { mut description, area, body }) = geometry else { return Ok(None) };
    if let Some(entity) = &shape.area_light {
        let message = match (passage, shape.object) {
            (Passage::Free, _) => Some("a lamp of the material \"interface\" is none, as in pbrt"),
            (_, Some(_)) => Some("a lamp in an object is none, as in pbrt"),
            _ => None,
        };
        match message {
            Some(message) => context.choice(place, message),
            None => description.emission = Some(lights::emission(entity, area, exposure, context)?),
        }
    }
    if passage == Passage::Free && !is_boundary {
        return Ok(None);
    }
    let alpha = alpha.filter(|alpha| *alpha != TextureDescription::Constant(SpectrumDescription::Grey(1.0)));
    if let Some(amount) = alpha {
        if amount == TextureDescription::Constant(SpectrumDescription::Grey(0.0)) {
            if description.emission.is_none() {
                return Ok(None);
            }
            context.unsupported(place, "a lamp whose `alpha` is 0 is seen and stands in the way");
        } else if passage != Passage::Free {
            let materials = [materials::here(MaterialDescription::Null), material];
            material = materials::here(MaterialDescription::Mix { materials, amount });
        }
    }
    description.material = Some(material);
    Ok(Some((description, body)))
}

/// Whether a material needs texture coordinates.
fn is_textured(material: &MaterialChoice, world: &World) -> bool {
    match material {
        // What a name stands for may be a mixture; textures anywhere among the named ones are enough to ask.
        MaterialChoice::Name(_) => !world.textures.is_empty(),
        MaterialChoice::Here(material) => match material.as_ref() {
            MaterialDescription::Diffuse { reflectance }
            | MaterialDescription::Plastic { reflectance, .. } => varies(reflectance),
            MaterialDescription::Conductor { tint, .. } => tint.as_ref().is_some_and(varies),
            MaterialDescription::Mix { .. } => !world.textures.is_empty(),
            _ => false,
        },
    }
}

fn varies(texture: &TextureDescription) -> bool {
    !matches!(texture, TextureDescription::Constant(_))
}
