//! The objects of a scene one after another, and what becomes of them.

use std::collections::{HashMap, HashSet};
use std::path::Path;

use tyndall_scene::SceneDescription;
use tyndall_scene::description::{
    FilmDescription, LightDescription, NamedMaterial, RenderDescription, ShapeDescription, VolumeDescription,
};

use super::boundaries::{self, MediumVolumes};
use super::document::Document;
use super::object::{Class, Object, Place};
use super::shape::Instances;
use crate::{ImportError, Notes, Sidecar};

/// A scene on its way from one form to the other.
pub(super) struct Importer<'a> {
    pub document: &'a Document,
    pub sidecar: &'a Sidecar,
    pub notes: Notes,
    pub film: FilmDescription,
    pub render: RenderDescription,
    pub volumes: Vec<VolumeDescription>,
    pub materials: Vec<NamedMaterial>,
    pub shapes: Vec<ShapeDescription>,
    pub lights: Vec<LightDescription>,
    /// Names of the volumes that a medium has become.
    pub media: HashMap<usize, Vec<String>>,
    /// The same in the order of the file, with where they are.
    pub medium_volumes: Vec<MediumVolumes>,
    /// Names of the materials that objects have become, for textures as they are and upside down.
    pub named_materials: HashMap<(usize, bool), String>,
    /// How many materials each of these is mixed of.
    pub material_parts: HashMap<String, usize>,
    /// Objects that are being looked at, from the outermost to the innermost.
    pub open: Vec<usize>,
    /// Names of volumes, materials and shapes that are taken.
    names: HashSet<String>,
    /// Groups of shapes that stand several times.
    pub instances: Instances,
}

/// Greatest depth to which objects refer to others.
const DEPTH: usize = 32;

impl<'a> Importer<'a> {
    pub fn new(document: &'a Document, sidecar: &'a Sidecar, notes: Notes) -> Self {
        Self {
            document,
            sidecar,
            notes,
            film: FilmDescription::default(),
            render: RenderDescription::default(),
            volumes: Vec::new(),
            materials: Vec::new(),
            shapes: Vec::new(),
            lights: Vec::new(),
            media: HashMap::new(),
            medium_volumes: Vec::new(),
            named_materials: HashMap::new(),
            material_parts: HashMap::new(),
            open: Vec::new(),
            // The medium that fills the scene has this name.
            names: HashSet::from(["medium".to_owned()]),
            instances: Instances::default(),
        }
    }

    /// The whole scene.
    pub fn scene(mut self, path: &Path) -> Result<(SceneDescription, Notes), ImportError> {
        let root = self.document.root();
        let mut sensors = Vec::new();
        let mut integrators = Vec::new();
        for (property, number) in root.objects() {
            property.is_used.set(true);
            let object = self.object(number);
            match object.class {
                Class::Sensor => sensors.push(number),
                Class::Integrator => integrators.push(number),
                Class::Shape => self.shape(number)?,
                Class::Emitter => self.emitter(number)?,
                // They count where others refer to them.
                Class::Bsdf | Class::Texture | Class::Medium | Class::Volume | Class::Phase => {}
                Class::Scene => {}
                Class::Film | Class::Sampler | Class::ReconstructionFilter => {
                    self.unsupported(
                        &object.place,
                        format!("{} outside a sensor is left out", object.title()),
                    );
                }
            }
        }
        self.groups()?;
        root.ignore(&["allow_thread_reordering", "embree_use_robust_intersections"]);
        self.tell_unused(root);
        let Some((&sensor, others)) = sensors.split_first() else {
            return Err(ImportError::of(path, "the scene has no camera: add a <sensor>"));
        };
        if let Some(other) = others.first() {
            let place = &self.object(*other).place;
            self.unsupported(place, "the scene has several sensors: the first is rendered");
        }
        if let Some(integrator) = integrators.first() {
            self.integrator(*integrator)?;
        }
        let camera = self.sensor(sensor)?;
        let mut description = SceneDescription {
            unit: "m".into(),
            camera,
            film: self.film,
            render: self.render,
            medium: None,
            volumes: self.volumes,
            materials: self.materials,
            shapes: self.shapes,
            lights: self.lights,
            meters: Vec::new(),
        };
        boundaries::simplify(&mut description, &self.medium_volumes, path, &mut self.notes);
        Ok((description, self.notes))
    }

    pub fn object(&self, number: usize) -> &'a Object {
        &self.document.objects[number]
    }

    /// The first object of a class in another, whatever its name.
    pub fn child(&self, object: &'a Object, class: Class) -> Option<usize> {
        self.children(object, class).first().copied()
    }

    /// All objects of a class in another.
    pub fn children(&self, object: &'a Object, class: Class) -> Vec<usize> {
        let of_class = object.objects().filter(|(_, number)| self.object(*number).class == class);
        of_class
            .map(|(property, number)| {
                property.is_used.set(true);
                number
            })
            .collect()
    }

    /// The object of this name in another, if it is of the class.
    pub fn named_child(&self, object: &'a Object, name: &str, class: Class) -> Option<usize> {
        let (property, number) = object
            .objects()
            .find(|(property, number)| property.name == name && self.object(*number).class == class)?;
        property.is_used.set(true);
        Some(number)
    }

    /// Looks into an object, which must not be within itself.
    pub fn within<T>(
        &mut self,
        number: usize,
        look: impl FnOnce(&mut Self) -> Result<T, ImportError>,
    ) -> Result<T, ImportError> {
        let object = self.object(number);
        if self.open.contains(&number) {
            return Err(object.place.error(format!("{} contains itself: mend the <ref>s", object.title())));
        }
        if self.open.len() >= DEPTH {
            return Err(object.place.error(format!("objects refer to others more than {DEPTH} deep")));
        }
        self.open.push(number);
        let result = look(self);
        self.open.pop();
        result
    }

    /// A name that nothing else has: the object's id, or its class and a number.
    pub fn name(&mut self, object: &Object) -> String {
        let plain = |id: &str| id.chars().filter(|c| !c.is_control()).take(80).collect::<String>();
        let stem = object.id.as_deref().map(plain).filter(|id| !id.trim().is_empty());
        let stem = stem.unwrap_or_else(|| object.class.tag().to_owned());
        let mut name = stem.clone();
        let mut number = 1;
        while !self.names.insert(name.clone()) {
            number += 1;
            name = format!("{stem}-{number}");
        }
        name
    }

    pub fn unsupported(&mut self, place: &Place, message: impl Into<String>) {
        self.notes.unsupported(&place.file, place.line, message);
    }

    pub fn choice(&mut self, place: &Place, message: impl Into<String>) {
        self.notes.choice(&place.file, place.line, message);
    }

    /// Tells which properties of an object nobody asked for.
    pub fn tell_unused(&mut self, object: &'a Object) {
        for property in object.properties.iter().filter(|property| !property.is_used.get()) {
            // Once.
            property.is_used.set(true);
            let what = match property.value {
                super::object::Value::Object(number) if property.name.is_empty() => {
                    self.object(number).title()
                }
                _ => format!("`{}`", super::text::excerpt(&property.name)),
            };
            let message = format!("{what} in {} is not supported and has no effect", object.title());
            self.unsupported(&property.place, message);
        }
    }
}
