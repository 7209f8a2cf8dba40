//! What a scene file says, before anyone asks what it means: objects with named properties.
//!
//! `<bsdf type="diffuse" id="wall"><rgb name="reflectance" value="0.5"/></bsdf>` is an object of the class `bsdf` and
//! the plug-in `diffuse`, with one property. Objects within objects are properties as well. A property remembers
//! whether anyone asked for it, so that the rest can be told to be without effect.

use std::cell::Cell;
use std::path::Path;
use std::rc::Rc;

use super::transform::{GREATEST, Transform};
use crate::ImportError;

/// A line of a file.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Place {
    pub file: Rc<Path>,
    /// From 1.
    pub line: usize,
}

impl Place {
    /// A fault here.
    pub fn error(&self, message: impl Into<String>) -> ImportError {
        ImportError::at(&self.file, self.line, message)
    }
}

/// What an object is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub(super) enum Class {
    Scene,
    Sensor,
    Film,
    Integrator,
    Sampler,
    ReconstructionFilter,
    Medium,
    Volume,
    Phase,
    Shape,
    Bsdf,
    /// A texture, or a spectrum with a `type`.
    Texture,
    Emitter,
}

impl Class {
    /// The class of an element, if it is an object at all.
    pub fn of_tag(tag: &str) -> Option<Self> {
        Some(match tag {
            "scene" => Self::Scene,
            "sensor" => Self::Sensor,
            "film" => Self::Film,
            "integrator" => Self::Integrator,
            "sampler" => Self::Sampler,
            "rfilter" => Self::ReconstructionFilter,
            "medium" => Self::Medium,
            "volume" => Self::Volume,
            "phase" => Self::Phase,
            "shape" => Self::Shape,
            "bsdf" => Self::Bsdf,
            "texture" => Self::Texture,
            "emitter" => Self::Emitter,
            _ => return None,
        })
    }

    /// The element's name.
    pub fn tag(self) -> &'static str {
        match self {
            Self::Scene => "scene",
            Self::Sensor => "sensor",
            Self::Film => "film",
            Self::Integrator => "integrator",
            Self::Sampler => "sampler",
            Self::ReconstructionFilter => "rfilter",
            Self::Medium => "medium",
            Self::Volume => "volume",
            Self::Phase => "phase",
            Self::Shape => "shape",
            Self::Bsdf => "bsdf",
            Self::Texture => "texture",
            Self::Emitter => "emitter",
        }
    }
}

/// The value of a property.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Value {
    Float(f64),
    Integer(i64),
    Boolean(bool),
    Text(String),
    Vector([f64; 3]),
    Rgb([f64; 3]),
    /// The same at all wavelengths.
    Uniform(f64),
    /// Wavelengths in nm, increasing, and values.
    Sampled(Vec<f64>, Vec<f64>),
    Transform(Transform),
    /// Number of an object.
    Object(usize),
}

impl Value {
    /// How messages call it.
    fn kind(&self) -> &'static str {
        match self {
            Self::Float(_) => "a float",
            Self::Integer(_) => "an integer",
            Self::Boolean(_) => "a boolean",
            Self::Text(_) => "a string",
            Self::Vector(_) => "a vector",
            Self::Rgb(_) => "a colour",
            Self::Uniform(_) | Self::Sampled(..) => "a spectrum",
            Self::Transform(_) => "a transform",
            Self::Object(_) => "an object",
        }
    }
}

/// A named value.
#[derive(Debug, Clone)]
pub(super) struct Property {
    /// Empty for objects without a name.
    pub name: String,
    pub value: Value,
    pub place: Place,
    /// Whether anyone asked for it.
    pub is_used: Cell<bool>,
}

/// An object and its properties.
#[derive(Debug, Clone)]
pub(super) struct Object {
    pub class: Class,
    /// The `type`.
    pub plugin: String,
    pub id: Option<String>,
    pub place: Place,
    pub properties: Vec<Property>,
}

impl Object {
    /// The last property of this name; it counts as used.
    pub fn get(&self, name: &str) -> Option<&Property> {
        let property = self.properties.iter().rev().find(|property| property.name == name)?;
        property.is_used.set(true);
        Some(property)
    }

    /// Marks properties that change nothing here as used.
    pub fn ignore(&self, names: &[&str]) {
        for name in names {
            self.get(name);
        }
    }

    fn typed<T>(
        &self,
        name: &str,
        wanted: &str,
        read: impl FnOnce(&Value) -> Option<T>,
    ) -> Result<Option<T>, ImportError> {
        let Some(property) = self.get(name) else { return Ok(None) };
        read(&property.value).map(Some).ok_or_else(|| {
            let kind = property.value.kind();
            property.place.error(format!("`{name}` is {kind}: write {wanted}"))
        })
    }

    pub fn float_if_given(&self, name: &str) -> Result<Option<f64>, ImportError> {
        self.typed(name, "a <float>", |value| match value {
            Value::Float(value) | Value::Uniform(value) => Some(*value),
            Value::Integer(value) => Some(*value as f64),
            _ => None,
        })
    }

    pub fn float(&self, name: &str, default: f64) -> Result<f64, ImportError> {
        Ok(self.float_if_given(name)?.unwrap_or(default))
    }

    pub fn integer(&self, name: &str) -> Result<Option<i64>, ImportError> {
        self.typed(name, "an <integer>", |value| match value {
            Value::Integer(value) => Some(*value),
            _ => None,
        })
    }

    pub fn boolean(&self, name: &str, default: bool) -> Result<bool, ImportError> {
        let given = self.typed(name, "a <boolean>", |value| match value {
            Value::Boolean(value) => Some(*value),
            _ => None,
        });
        Ok(given?.unwrap_or(default))
    }

    pub fn text(&self, name: &str) -> Result<Option<&str>, ImportError> {
        let Some(property) = self.get(name) else { return Ok(None) };
        match &property.value {
            Value::Text(text) => Ok(Some(text)),
            other => Err(property.place.error(format!("`{name}` is {}: write a <string>", other.kind()))),
        }
    }

    pub fn vector(&self, name: &str) -> Result<Option<[f64; 3]>, ImportError> {
        let given = self.typed(name, "a <vector> or <point>", |value| match value {
            Value::Vector(value) => Some(*value),
            _ => None,
        })?;
        match given {
            Some(vector) if vector.iter().any(|x| x.abs() > GREATEST) => {
                Err(self.place.error(format!("`{name}` is too large to compute with")))
            }
            given => Ok(given),
        }
    }

    /// The transform of this name, or none at all.
    pub fn transform(&self, name: &str) -> Result<Transform, ImportError> {
        let given = self.typed(name, "a <transform>", |value| match value {
            Value::Transform(value) => Some(*value),
            _ => None,
        });
        Ok(given?.unwrap_or_default())
    }

    /// Numbers of the objects in this one, with their names; they do not count as used yet.
    pub fn objects(&self) -> impl Iterator<Item = (&Property, usize)> {
        self.properties.iter().filter_map(|property| match property.value {
            Value::Object(number) => Some((property, number)),
            _ => None,
        })
    }

    /// How messages call it.
    pub fn title(&self) -> String {
        format!("the {} `{}`", self.class.tag(), self.plugin)
    }
}
