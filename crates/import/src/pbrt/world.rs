//! What the directives of a scene have said, gathered, before any of it is put into Tyndall's words.

use std::collections::HashMap;
use std::rc::Rc;

use glam::DAffine3;

use super::directives::Entity;
use super::place::Place;

/// A whole scene of pbrt.
#[derive(Debug, Default)]
pub(super) struct World {
    pub film: Option<Entity>,
    pub camera: Option<CameraUse>,
    pub sampler: Option<Entity>,
    pub integrator: Option<Entity>,
    pub filter: Option<Entity>,
    pub seed: Option<u32>,
    pub lights: Vec<(Entity, DAffine3)>,
    pub textures: HashMap<String, Texture>,
    /// Named materials, in the order of the file.
    pub materials: Vec<(String, Rc<Entity>)>,
    pub media: HashMap<String, Medium>,
    pub shapes: Vec<Shape>,
    pub objects: Vec<Object>,
    /// Number of each object by its name.
    pub object_numbers: HashMap<String, usize>,
}

/// The camera, and where it is.
#[derive(Debug)]
pub(super) struct CameraUse {
    pub entity: Entity,
    pub world_to_camera: DAffine3,
    /// Name of the medium around it; empty for none.
    pub medium: String,
}

/// A texture.
#[derive(Debug)]
pub(super) struct Texture {
    pub entity: Entity,
    /// Whether its values are single numbers.
    pub is_float: bool,
}

/// A medium.
#[derive(Debug)]
pub(super) struct Medium {
    pub entity: Entity,
    pub to_world: DAffine3,
}

/// What a shape is made of.
#[derive(Debug, Clone)]
pub(super) enum MaterialUse {
    /// Nothing was said.
    Default,
    /// The name of a material, and where that was said.
    Named(Rc<str>, Place),
    /// A material.
    Here(Rc<Entity>),
}

/// A shape and the state in which it was made.
#[derive(Debug)]
pub(super) struct Shape {
    pub entity: Entity,
    pub to_world: DAffine3,
    pub is_reversed: bool,
    pub material: MaterialUse,
    pub area_light: Option<Rc<Entity>>,
    /// Names of the media inside and outside; empty for none.
    pub inside: Rc<str>,
    pub outside: Rc<str>,
    /// The object that it is a part of.
    pub object: Option<usize>,
}

/// Shapes that stand wherever they are instanced.
#[derive(Debug)]
pub(super) struct Object {
    pub instances: Vec<DAffine3>,
}
