//! From XML to objects: `$parameters`, `<default>`, `<include>`, `<alias>`, `<ref>` and `<path>` are done with here.
//!
//! As in Mitsuba 3 a `$name` stands for its parameter in every attribute, the longest name first, `\$` for the sign
//! itself; a `<default>` holds from where it stands on and gives way to a parameter from outside; an included scene's
//! objects stand where the `<include>` stood. Whatever a file can ask for is bounded: files, their depth, objects, and
//! the length that attributes grow to.
//!
//! Source: Mitsuba 3, documentation of the scene format, and the behaviour of its `core/parser`.

use std::cell::Cell;
use std::collections::HashMap;
use std::fs;
use std::io::Read;
use std::path::{Path, PathBuf};
use std::rc::Rc;

use roxmltree::{Node, ParsingOptions};
use tyndall_machine::files;

use super::elements::{self, Value};
use super::object::{Class, Object, Place, Property};
use super::text::excerpt;
use crate::include_chain::include_chain;
use crate::{ImportError, Notes};

/// Greatest depth of includes, as in Mitsuba.
const DEPTH_OF_INCLUDES: usize = 15;
/// Greatest number of files.
const FILES: usize = 1024;
/// Greatest sum of the sizes of all files, bytes.
const BYTES: u64 = 1 << 28;
/// Greatest depth of elements.
const DEPTH: usize = 64;
/// Greatest number of properties.
const PROPERTIES: usize = 4_000_000;
/// Greatest length of all attributes together that parameters were put in, bytes.
const SUBSTITUTED: usize = 1 << 24;

/// A scene file as objects.
#[derive(Debug)]
pub(super) struct Document {
    pub objects: Vec<Object>,
    /// Folders that files are looked for in, the first first.
    folders: Vec<PathBuf>,
}

impl Document {
    /// Reads a scene file; `parameters` are set from outside.
    pub fn read(
        path: &Path,
        parameters: &[(String, String)],
        notes: &mut Notes,
    ) -> Result<Self, ImportError> {
        let mut reader = Reader {
            document: Document { objects: Vec::new(), folders: vec![folder_of(path)] },
            notes,
            parameters: Vec::new(),
            ids: HashMap::new(),
            references: Vec::new(),
            open: vec![path.canonicalize().unwrap_or_else(|_| path.to_path_buf())],
            files: 0,
            bytes: 0,
            properties: 0,
            substituted: 0,
        };
        for (name, value) in parameters {
            reader.set_parameter(name.clone(), value.clone());
        }
        reader.file(path, None, 0)?;
        reader.resolve()?;
        if let Some(unused) = reader.parameters.iter().find(|parameter| !parameter.is_used) {
            let name = unused.name.clone();
            reader.notes.choice(path, 1, format!("the parameter `{name}` is used nowhere in the scene"));
        }
        Ok(reader.document)
    }

    /// The root object.
    pub fn root(&self) -> &Object {
        &self.objects[0]
    }

    /// An absolute path of the file that a property names, which must exist.
    pub fn find(&self, name: &str, place: &Place) -> Result<PathBuf, ImportError> {
        let beside = folder_of(&place.file);
        let candidates = self.folders.iter().chain([&beside]).map(|folder| folder.join(name));
        for candidate in candidates {
            if candidate.is_file() {
                return candidate.canonicalize().map_err(|error| ImportError::unreadable(&candidate, &error));
            }
        }
        Err(place.error(format!("there is no file `{}`; mend its name", excerpt(name))))
    }
}

fn folder_of(path: &Path) -> PathBuf {
    path.parent().map(Path::to_path_buf).unwrap_or_default()
}

struct Parameter {
    /// With its `$`.
    key: String,
    name: String,
    value: String,
    is_used: bool,
}

struct Reader<'a> {
    document: Document,
    notes: &'a mut Notes,
    /// The longest key first, so that none is taken for the beginning of another.
    parameters: Vec<Parameter>,
    ids: HashMap<String, usize>,
    /// Properties that are references: object, property, id.
    references: Vec<(usize, usize, String)>,
    /// The files that are being read, the innermost last.
    open: Vec<PathBuf>,
    files: usize,
    bytes: u64,
    properties: usize,
    substituted: usize,
}

/// The file that is being read.
struct Source {
    file: Rc<Path>,
    /// Where lines begin, bytes.
    lines: Vec<usize>,
    /// Whether names are those of Mitsuba 0.x, in camel case.
    is_old: bool,
    depth: usize,
}

impl Source {
    fn place(&self, node: Node) -> Place {
        let line = self.lines.partition_point(|start| *start <= node.range().start);
        Place { file: Rc::clone(&self.file), line: line.max(1) }
    }
}

impl Reader<'_> {
    fn set_parameter(&mut self, name: String, value: String) {
        let key = format!("${name}");
        let at = self.parameters.partition_point(|parameter| parameter.key.len() >= key.len());
        self.parameters.insert(at, Parameter { key, name, value, is_used: false });
    }

    /// Reads a file; its objects go into the object `parent`, if there is one.
    fn file(&mut self, path: &Path, parent: Option<usize>, depth: usize) -> Result<(), ImportError> {
        let text = self.text(path)?;
        let options = ParsingOptions { nodes_limit: PROPERTIES as u32, ..ParsingOptions::default() };
        let xml = roxmltree::Document::parse_with_options(&text, options).map_err(|error| {
            let message = format!("is no sound XML: {}", excerpt_of(&error.to_string()));
            ImportError::at(path, error.pos().row as usize, message)
        })?;
        let lines = std::iter::once(0).chain(text.match_indices('\n').map(|(at, _)| at + 1)).collect();
        let root = xml.root_element();
        let version = root.attribute("version").unwrap_or("3.0.0");
        let major = version.split('.').next().and_then(|major| major.trim().parse::<u32>().ok());
        let source = Source { file: path.into(), lines, is_old: major.is_some_and(|major| major < 2), depth };
        let place = source.place(root);
        let Some(major) = major else {
            return Err(place.error(format!("`{}` is no version, such as 3.0.0", excerpt(version))));
        };
        if major < 2 {
            let message =
                "a scene of Mitsuba 0.x: names are read as those of Mitsuba 3, and what they mean may differ";
            self.notes.choice(path, place.line, message);
        }
        match (parent, Class::of_tag(root.tag_name().name())) {
            (Some(parent), Some(Class::Scene)) => {
                root.children().try_for_each(|child| self.element(child, &source, parent, 1))
            }
            (None, Some(Class::Scene)) => self.object(root, &source, None, Class::Scene, 0).map(drop),
            (Some(parent), _) => self.element(root, &source, parent, 1),
            (None, _) => Err(place.error(format!(
                "the file is no scene: it begins with <{}>, and not with <scene>",
                excerpt(root.tag_name().name())
            ))),
        }
    }

    fn text(&mut self, path: &Path) -> Result<String, ImportError> {
        self.files += 1;
        let mut bytes = Vec::new();
        let file = files::open(path).map_err(|error| ImportError::unreadable(path, &error))?;
        let rest = BYTES.saturating_sub(self.bytes);
        let read = file.take(rest + 1).read_to_end(&mut bytes);
        read.map_err(|error| ImportError::unreadable(path, &error))?;
        self.bytes += bytes.len() as u64;
        if self.files > FILES || self.bytes > BYTES {
            return Err(ImportError::of(
                path,
                "the scene has too many files, or too large ones: 256 MB are read",
            ));
        }
        String::from_utf8(bytes).map_err(|error| {
            let valid = &error.as_bytes()[..error.utf8_error().valid_up_to()];
            let line = valid.iter().filter(|byte| **byte == b'\n').count() + 1;
            ImportError::at(path, line, "is no UTF-8: save the file in that encoding")
        })
    }

    fn element(
        &mut self,
        node: Node,
        source: &Source,
        parent: usize,
        depth: usize,
    ) -> Result<(), ImportError> {
        if !node.is_element() {
            return Ok(());
        }
        let place = source.place(node);
        if depth > DEPTH {
            return Err(place.error(format!("elements are nested deeper than {DEPTH}")));
        }
        let tag = node.tag_name().name();
        let class = match Class::of_tag(tag) {
            None if tag == "spectrum" && node.has_attribute("type") => Some(Class::Texture),
            class => class,
        };
        if let Some(class) = class {
            let number = self.object(node, source, Some(parent), class, depth)?;
            let name = self.name(node, source)?;
            return self.add(parent, Property::new(name, Value::Object(number), place));
        }
        let attribute = |reader: &mut Self, name: &str| {
            let value = reader.attribute(node, name, source)?;
            value.ok_or_else(|| place.error(format!("<{tag}> has no `{name}`: add it")))
        };
        match tag {
            "default" => {
                let (name, value) = (attribute(self, "name")?, attribute(self, "value")?);
                if name.is_empty() {
                    return Err(place.error("the <default> has an empty name: give it one"));
                }
                if !self.parameters.iter().any(|parameter| parameter.name == name) {
                    self.set_parameter(name.clone(), value);
                    // Defaults that nothing uses are no mistake.
                    for parameter in self.parameters.iter_mut().filter(|parameter| parameter.name == name) {
                        parameter.is_used = true;
                    }
                }
                Ok(())
            }
            "ref" => {
                let (id, name) = (attribute(self, "id")?, self.name(node, source)?);
                let at = self.document.objects[parent].properties.len();
                self.references.push((parent, at, id));
                self.add(parent, Property::new(name, Value::Object(0), place))
            }
            "alias" => {
                let (id, other) = (attribute(self, "id")?, attribute(self, "as")?);
                let unknown = || place.error(format!("nothing before has the id `{}`", excerpt(&id)));
                let number = *self.ids.get(&id).ok_or_else(unknown)?;
                self.register(other, number, &place)
            }
            "path" => {
                let folder = attribute(self, "value")?;
                let folder = folder_of(&source.file).join(folder);
                if !folder.is_dir() {
                    let message = format!("there is no folder `{}`", excerpt(&folder.to_string_lossy()));
                    return Err(place.error(message));
                }
                self.document.folders.insert(0, folder);
                Ok(())
            }
            "include" => {
                let name = attribute(self, "filename")?;
                if source.depth >= DEPTH_OF_INCLUDES {
                    let message = format!("files include each other more than {DEPTH_OF_INCLUDES} deep");
                    return Err(place.error(message));
                }
                let path = self.document.find(&name, &place)?;
                if let Some(chain) = include_chain(&self.open, &path) {
                    return Err(
                        place.error(format!("{chain}: the file includes itself; take one <include> out"))
                    );
                }
                self.open.push(path.clone());
                self.file(&path, Some(parent), source.depth + 1)?;
                self.open.pop();
                Ok(())
            }
            _ => {
                let name = self.name(node, source)?;
                let mut fault = None;
                let mut value = |node: Node, name: &str| match self.attribute(node, name, source) {
                    Ok(value) => value,
                    Err(error) => {
                        fault.get_or_insert(error);
                        None
                    }
                };
                let read = elements::value(node, &mut value);
                if let Some(error) = fault {
                    return Err(error);
                }
                match read.map_err(|(within, message)| source.place(within).error(message))? {
                    elements::Read::Value(value) => self.add(parent, Property::new(name, value, place)),
                    elements::Read::SpectrumFile(file) => {
                        let value = self.spectrum_file(&file, &place)?;
                        self.add(parent, Property::new(name, value, place))
                    }
                    elements::Read::Unknown => {
                        let message = format!("<{}> is not known; it is left out", excerpt(tag));
                        self.notes.unsupported(&source.file, place.line, message);
                        Ok(())
                    }
                }
            }
        }
    }

    /// Reads an object and what is in it; returns its number.
    fn object(
        &mut self,
        node: Node,
        source: &Source,
        parent: Option<usize>,
        class: Class,
        depth: usize,
    ) -> Result<usize, ImportError> {
        let place = source.place(node);
        let plugin = match (self.attribute(node, "type", source)?, class) {
            (Some(plugin), _) => plugin,
            (None, Class::Scene) => "scene".to_owned(),
            (None, _) => return Err(place.error(format!("<{}> has no `type`: add it", class.tag()))),
        };
        let id = self.attribute(node, "id", source)?;
        let number = self.document.objects.len();
        if let Some(id) = &id {
            self.register(id.clone(), number, &place)?;
        }
        if parent.is_some() && class == Class::Scene {
            self.notes.unsupported(&source.file, place.line, "a <scene> within a scene is left out");
        }
        self.document.objects.push(Object { class, plugin, id, place, properties: Vec::new() });
        node.children().try_for_each(|child| self.element(child, source, number, depth + 1))?;
        Ok(number)
    }

    fn add(&mut self, object: usize, property: Property) -> Result<(), ImportError> {
        self.properties += 1;
        if self.properties > PROPERTIES {
            return Err(property.place.error("the scene has too many elements"));
        }
        self.document.objects[object].properties.push(property);
        Ok(())
    }

    fn register(&mut self, id: String, number: usize, place: &Place) -> Result<(), ImportError> {
        if self.ids.contains_key(&id) {
            return Err(place.error(format!("the id `{}` stands twice: rename one", excerpt(&id))));
        }
        self.ids.insert(id, number);
        Ok(())
    }

    /// Puts the objects in the place of references to them.
    fn resolve(&mut self) -> Result<(), ImportError> {
        for (object, property, id) in std::mem::take(&mut self.references) {
            let property = &mut self.document.objects[object].properties[property];
            let Some(number) = self.ids.get(&id) else {
                let message = format!("nothing has the id `{}`: mend the <ref>", excerpt(&id));
                return Err(property.place.error(message));
            };
            property.value = Value::Object(*number);
        }
        Ok(())
    }

    /// The name of a property; of Mitsuba 0.x's `toWorld` it is `to_world`.
    fn name(&mut self, node: Node, source: &Source) -> Result<String, ImportError> {
        let name = self.attribute(node, "name", source)?.unwrap_or_default();
        Ok(if source.is_old { elements::new_name(&name) } else { name })
    }

    /// An attribute, with parameters put in.
    fn attribute(&mut self, node: Node, name: &str, source: &Source) -> Result<Option<String>, ImportError> {
        let Some(given) = node.attribute(name) else { return Ok(None) };
        if !given.contains('$') {
            return Ok(Some(given.to_owned()));
        }
        let mut result = String::new();
        let mut rest = given;
        while let Some(at) = rest.find('$') {
            if rest[..at].ends_with('\\') {
                result += &rest[..at - 1];
                result.push('$');
                rest = &rest[at + 1..];
                continue;
            }
            result += &rest[..at];
            let found = self.parameters.iter_mut().find(|parameter| rest[at..].starts_with(&parameter.key));
            let Some(parameter) = found else {
                let name: String =
                    rest[at + 1..].chars().take_while(|c| c.is_alphanumeric() || *c == '_').collect();
                let message =
                    format!("the parameter `${}` has no value: add a <default> for it", excerpt(&name));
                return Err(source.place(node).error(message));
            };
            parameter.is_used = true;
            result += &parameter.value;
            rest = &rest[at + parameter.key.len()..];
            if self.substituted + result.len() > SUBSTITUTED {
                return Err(source.place(node).error("the parameters make the scene too long"));
            }
        }
        result += rest;
        self.substituted += result.len();
        Ok(Some(result))
    }

    fn spectrum_file(&mut self, name: &str, place: &Place) -> Result<Value, ImportError> {
        let path = self.document.find(name, place)?;
        let size = fs::metadata(&path).map(|data| data.len());
        if size.is_ok_and(|size| size > 1 << 24) {
            return Err(ImportError::of(&path, "is too large for a spectrum"));
        }
        let text = files::open(&path)
            .and_then(|file| std::io::read_to_string(file.take(1 << 24)))
            .map_err(|error| ImportError::unreadable(&path, &error))?;
        super::text::spectrum_file(&text).map_err(|message| ImportError::of(&path, message))
    }
}

impl Property {
    fn new(name: String, value: Value, place: Place) -> Self {
        Self { name, value, place, is_used: Cell::new(false) }
    }
}

/// The message of the XML reader in one line.
fn excerpt_of(message: &str) -> String {
    message.chars().take(200).map(|c| if c.is_control() { ' ' } else { c }).collect()
}
