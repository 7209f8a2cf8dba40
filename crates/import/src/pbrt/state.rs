//! The graphics state: what holds for the shapes, lights and materials that come next.

use std::collections::HashMap;
use std::rc::Rc;

use glam::{DAffine3, DVec3};

use super::context::Context;
use super::directives::{Directive, Entity};
use super::parameters::Parameter;
use super::place::Place;
use super::tokens;
use super::transforms;
use super::world::{CameraUse, MaterialUse, Medium, Object, Shape, Texture, World};
use crate::{ImportError, affine};

/// `AttributeBegin` within `AttributeBegin`.
const DEEPEST: usize = 1000;
/// Parameters given by `Attribute` that hold at a time, for each kind of thing.
const MOST_ATTRIBUTES: usize = 1000;
/// Shapes times the instances of their objects.
const MOST_INSTANCES: usize = 2_000_000;

/// Parameters that `Attribute` has given to things to come.
#[derive(Debug, Clone, Default)]
struct Attributes {
    shape: Rc<Vec<Parameter>>,
    light: Rc<Vec<Parameter>>,
    material: Rc<Vec<Parameter>>,
    medium: Rc<Vec<Parameter>>,
    texture: Rc<Vec<Parameter>>,
}

/// What `AttributeEnd` brings back.
#[derive(Debug, Clone)]
struct Graphics {
    to_world: DAffine3,
    is_reversed: bool,
    material: MaterialUse,
    area_light: Option<Rc<Entity>>,
    inside: Rc<str>,
    outside: Rc<str>,
    attributes: Attributes,
}

/// The state, and those to come back to.
#[derive(Debug, Clone)]
pub(super) struct State {
    now: Graphics,
    /// With each kept state, where it was begun and whether by `ObjectBegin`.
    kept: Vec<(Graphics, Place, bool)>,
    coordinate_systems: HashMap<String, DAffine3>,
    /// The object that shapes become a part of.
    object: Option<usize>,
    is_in_world: bool,
}

impl State {
    /// The state at the beginning of a scene.
    pub(super) fn new() -> Self {
        let now = Graphics {
            to_world: DAffine3::IDENTITY,
            is_reversed: false,
            material: MaterialUse::Default,
            area_light: None,
            inside: Rc::from(""),
            outside: Rc::from(""),
            attributes: Attributes::default(),
        };
        Self { now, kept: Vec::new(), coordinate_systems: HashMap::new(), object: None, is_in_world: false }
    }

    /// Whether `WorldBegin` has been.
    pub(super) fn is_in_world(&self) -> bool {
        self.is_in_world
    }

    /// The end of the scene: nothing must be open.
    pub(super) fn end(&self) -> Result<(), ImportError> {
        match self.kept.last() {
            None => Ok(()),
            Some((_, place, true)) => Err(place.error("this `ObjectBegin` has no `ObjectEnd`: add it")),
            Some((_, place, false)) => {
                Err(place.error("this `AttributeBegin` has no `AttributeEnd`: add it"))
            }
        }
    }

    /// The end of an imported file that was begun in the state `before`.
    pub(super) fn end_of_import(&self, before: &State) -> Result<(), ImportError> {
        if self.kept.len() > before.kept.len() { self.end() } else { Ok(()) }
    }

    /// Does what a directive says.
    pub(super) fn apply(
        &mut self,
        directive: Directive,
        place: &Place,
        world: &mut World,
        context: &Context,
    ) -> Result<(), ImportError> {
        self.check_block(&directive, place)?;
        match directive {
            Directive::Identity => self.now.to_world = DAffine3::IDENTITY,
            Directive::Translate(by) => self.concat(DAffine3::from_translation(by.into()), place)?,
            Directive::Scale(by) => self.concat(DAffine3::from_scale(DVec3::from(by)), place)?,
            Directive::Rotate(numbers) => {
                let rotation = transforms::rotation(numbers);
                self.concat(rotation.ok_or_else(|| place.error("the axis is 0: give a direction"))?, place)?;
            }
            Directive::LookAt(numbers) => {
                let message = "the camera is where it looks at, or looks along its up vector: change one";
                self.concat(transforms::look_at(numbers).ok_or_else(|| place.error(message))?, place)?;
            }
            Directive::Transform(numbers) => {
                self.now.to_world = DAffine3::IDENTITY;
                self.concat(affine(numbers, place)?, place)?;
            }
            Directive::ConcatTransform(numbers) => self.concat(affine(numbers, place)?, place)?,
            Directive::CoordinateSystem(name) => {
                self.coordinate_systems.insert(name, self.now.to_world);
            }
            Directive::CoordSysTransform(name) => match self.coordinate_systems.get(&name) {
                Some(system) => self.now.to_world = *system,
                None => return Err(place.error(format!("there is no coordinate system \"{name}\""))),
            },
            Directive::ActiveTransform | Directive::TransformTimes => {
                context.unsupported(place, "motion is left out: transforms hold for the whole shot");
            }
            Directive::ReverseOrientation => self.now.is_reversed = !self.now.is_reversed,
            Directive::AttributeBegin => self.keep(place, false)?,
            Directive::AttributeEnd => self.bring_back(place, false)?,
            Directive::Attribute(entity) => self.add_attributes(entity, place)?,
            Directive::ObjectBegin(name) => self.begin_object(name, place, world)?,
            Directive::ObjectEnd => {
                self.bring_back(place, true)?;
                self.object = None;
            }
            Directive::ObjectInstance(name) => self.instance(&name, place, world)?,
            Directive::WorldBegin => {
                self.is_in_world = true;
                self.now.to_world = DAffine3::IDENTITY;
                self.coordinate_systems.insert("world".to_owned(), DAffine3::IDENTITY);
            }
            Directive::ColorSpace(name) => {
                if name != "srgb" {
                    context.unsupported(
                        place,
                        format!("the colour space \"{name}\" is left out: colours count as sRGB's"),
                    );
                }
            }
            Directive::MediumInterface(inside, outside) => {
                self.now.inside = Rc::from(inside);
                self.now.outside = Rc::from(outside);
            }
            Directive::NamedMaterial(name) => {
                self.now.material = MaterialUse::Named(Rc::from(name), place.clone());
            }
            Directive::Material(entity) => {
                let entity = inherit(entity, &self.now.attributes.material);
                self.now.material = MaterialUse::Here(Rc::new(entity));
            }
            Directive::AreaLightSource(entity) => {
                let entity = inherit(entity, &self.now.attributes.light);
                self.now.area_light = Some(Rc::new(entity));
            }
            Directive::Shape(entity) => {
                let entity = inherit(entity, &self.now.attributes.shape);
                world.shapes.push(self.shape(entity)?);
            }
            Directive::LightSource(entity) => {
                self.check_regular(place)?;
                world.lights.push((inherit(entity, &self.now.attributes.light), self.now.to_world));
            }
            Directive::MakeNamedMaterial(entity) => {
                let name = entity.kind.clone();
                let entity = Rc::new(inherit(entity, &self.now.attributes.material));
                world.materials.push((name, entity));
            }
            Directive::MakeNamedMedium(entity) => {
                self.check_regular(place)?;
                let name = entity.kind.clone();
                let entity = inherit(entity, &self.now.attributes.medium);
                if world.media.insert(name.clone(), Medium { entity, to_world: self.now.to_world }).is_some()
                {
                    return Err(place.error(format!("the medium \"{name}\" is made twice: rename one")));
                }
            }
            Directive::Texture(name, values, entity) => {
                let is_float = values == "float";
                if !is_float && values != "spectrum" && values != "color" {
                    return Err(place.error("the values of a texture are \"float\" or \"spectrum\""));
                }
                let entity = inherit(entity, &self.now.attributes.texture);
                world.textures.insert(name, Texture { entity, is_float });
            }
            Directive::Film(entity) => world.film = Some(entity),
            Directive::Sampler(entity) => world.sampler = Some(entity),
            Directive::Integrator(entity) => world.integrator = Some(entity),
            Directive::PixelFilter(entity) => world.filter = Some(entity),
            Directive::Camera(entity) => {
                self.check_regular(place)?;
                self.coordinate_systems.insert("camera".to_owned(), self.now.to_world.inverse());
                let medium = self.now.outside.to_string();
                world.camera = Some(CameraUse { entity, world_to_camera: self.now.to_world, medium });
            }
            Directive::Option(name, value) => match (name.as_str(), value.parse()) {
                ("seed", Ok(seed)) => world.seed = Some(seed),
                _ => context.choice(place, format!("the option `{name}` is left out")),
            },
            // How rays find what they hit is Tyndall's own affair; files are opened by the caller.
            Directive::Accelerator | Directive::Include(_) | Directive::Import(_) => {}
        }
        Ok(())
    }

    /// Options come before `WorldBegin`, the world after it.
    fn check_block(&self, directive: &Directive, place: &Place) -> Result<(), ImportError> {
        let is_option = matches!(
            directive,
            Directive::Film(_)
                | Directive::Camera(_)
                | Directive::Sampler(_)
                | Directive::Integrator(_)
                | Directive::PixelFilter(_)
                | Directive::WorldBegin
        );
        let is_of_world = matches!(
            directive,
            Directive::Shape(_)
                | Directive::LightSource(_)
                | Directive::AreaLightSource(_)
                | Directive::ObjectBegin(_)
                | Directive::ObjectEnd
                | Directive::ObjectInstance(_)
        );
        if is_option && self.is_in_world {
            return Err(place.error("this comes before `WorldBegin`: move it there"));
        }
        if is_of_world && !self.is_in_world {
            return Err(place.error("this comes after `WorldBegin`: move it there"));
        }
        Ok(())
    }

    fn concat(&mut self, by: DAffine3, place: &Place) -> Result<(), ImportError> {
        self.now.to_world *= by;
        let is_sound = |number: f64| number.abs() <= tokens::GREATEST;
        if self.now.to_world.to_cols_array().into_iter().all(is_sound) {
            return Ok(());
        }
        Err(place.error("the transform has numbers beyond 1e30: use smaller ones"))
    }

    fn check_regular(&self, place: &Place) -> Result<(), ImportError> {
        if !affine::is_flat(&self.now.to_world) {
            return Ok(());
        }
        Err(place.error("the transform here flattens all things: give no scale of 0"))
    }

    fn keep(&mut self, place: &Place, is_object: bool) -> Result<(), ImportError> {
        if self.kept.len() == DEEPEST {
            return Err(place.error("more than 1000 attribute blocks within each other: close some"));
        }
        self.kept.push((self.now.clone(), place.clone(), is_object));
        Ok(())
    }

    fn bring_back(&mut self, place: &Place, is_object: bool) -> Result<(), ImportError> {
        match self.kept.pop() {
            Some((before, _, began_object)) if began_object == is_object => {
                self.now = before;
                Ok(())
            }
            Some((_, begin, true)) => {
                let message =
                    format!("the `ObjectBegin` of line {} is open: end it by `ObjectEnd`", begin.line);
                Err(place.error(message))
            }
            Some((_, begin, false)) => {
                let message =
                    format!("the `AttributeBegin` of line {} is open: end it by `AttributeEnd`", begin.line);
                Err(place.error(message))
            }
            None => Err(place.error("nothing was begun that ends here: take it out")),
        }
    }

    fn add_attributes(&mut self, entity: Entity, place: &Place) -> Result<(), ImportError> {
        let attributes = &mut self.now.attributes;
        let list = match entity.kind.as_str() {
            "shape" => &mut attributes.shape,
            "light" => &mut attributes.light,
            "material" => &mut attributes.material,
            "medium" => &mut attributes.medium,
            "texture" => &mut attributes.texture,
            _ => {
                let message =
                    "attributes are of \"shape\", \"light\", \"material\", \"medium\" or \"texture\"";
                return Err(place.error(message));
            }
        };
        let own = entity.parameters.into_own();
        if list.len() + own.len() > MOST_ATTRIBUTES {
            return Err(
                place.error("more than 1000 attributes hold at a time: give them to the things themselves")
            );
        }
        Rc::make_mut(list).extend(own);
        Ok(())
    }

    fn begin_object(&mut self, name: String, place: &Place, world: &mut World) -> Result<(), ImportError> {
        if self.object.is_some() {
            return Err(place.error("objects cannot be within objects: close the outer one by `ObjectEnd`"));
        }
        if world.object_numbers.contains_key(&name) {
            return Err(place.error(format!("the object \"{name}\" is made twice: rename one")));
        }
        self.keep(place, true)?;
        self.object = Some(world.objects.len());
        world.object_numbers.insert(name, world.objects.len());
        world.objects.push(Object { instances: Vec::new() });
        Ok(())
    }

    fn instance(&mut self, name: &str, place: &Place, world: &mut World) -> Result<(), ImportError> {
        if self.object.is_some() {
            return Err(place.error("objects cannot have instances of objects: write the shapes instead"));
        }
        let Some(&number) = world.object_numbers.get(name) else {
            return Err(place.error(format!("there is no object \"{name}\" above: make it by `ObjectBegin`")));
        };
        self.check_regular(place)?;
        let object = &mut world.objects[number];
        object.instances.push(self.now.to_world);
        if object.instances.len() > MOST_INSTANCES {
            return Err(place.error("an object has more than 2,000,000 instances: leave some out"));
        }
        Ok(())
    }

    fn shape(&self, entity: Entity) -> Result<Shape, ImportError> {
        self.check_regular(&entity.place)?;
        let now = &self.now;
        Ok(Shape {
            entity,
            to_world: now.to_world,
            is_reversed: now.is_reversed,
            material: now.material.clone(),
            area_light: now.area_light.clone(),
            inside: now.inside.clone(),
            outside: now.outside.clone(),
            object: self.object,
        })
    }
}

/// Whether the shapes of all objects at all their places are few enough to be kept.
pub(super) fn check_instances(world: &World) -> Result<(), ImportError> {
    let mut count = 0_usize;
    for shape in &world.shapes {
        let Some(object) = shape.object else { continue };
        count = count.saturating_add(world.objects[object].instances.len());
        if count > MOST_INSTANCES {
            let message = "objects have more than 2,000,000 shapes at all their places: leave some out";
            return Err(shape.entity.place.error(message));
        }
    }
    Ok(())
}

fn inherit(entity: Entity, attributes: &Rc<Vec<Parameter>>) -> Entity {
    Entity { parameters: entity.parameters.inheriting(attributes), ..entity }
}

fn affine(numbers: [f64; 16], place: &Place) -> Result<DAffine3, ImportError> {
    let message = "the matrix is not affine: every fourth number is 0, the last one 1";
    transforms::matrix(numbers).ok_or_else(|| place.error(message))
}
