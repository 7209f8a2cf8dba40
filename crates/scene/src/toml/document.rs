//! A scene file as text and tree: read, changed by `--set` options, checked and made a description.

use std::path::{Path, PathBuf};
use std::sync::{Arc, LazyLock};

use miette::NamedSource;
use toml::de::{DeTable, DeValue};
use tyndall_machine::files;

use super::conformance;
use super::schema::json_schema;
use super::tree::{Entry, Node, Place, ROOT, Value};
use crate::SceneDescription;
use crate::error::{Problem, SceneError};

/// Scene files are written by people or small programs; one of this size is something else.
const GREATEST_FILE: u64 = 16 << 20;

/// A scene file that is well-formed TOML; whether it is a scene shows in [`description`](Self::description).
///
/// # Examples
///
/// ```
/// let text = "camera = { position = [0, 0, 5], target = [0, 0, 0] }";
/// let mut document = tyndall_scene::SceneDocument::parse("scene.toml", text)?;
/// document.set("camera.vertical_fov=30")?;
/// assert_eq!(document.description()?.camera.vertical_fov, 30.0);
/// # Ok::<(), tyndall_scene::SceneError>(())
/// ```
#[derive(Debug, Clone)]
pub struct SceneDocument {
    folder: PathBuf,
    root: Node,
}

impl SceneDocument {
    /// Reads a scene file.
    pub fn read(path: &Path) -> Result<Self, SceneError> {
        let refuse = |error: std::io::Error| SceneError::file(path, error.to_string());
        let length = files::open(path).and_then(|file| file.metadata()).map_err(refuse)?.len();
        if length > GREATEST_FILE {
            return Err(SceneError::file(
                path,
                "more than 16 MiB of text is not a scene file; is it a volume?",
            ));
        }
        let bytes = files::read(path).map_err(refuse)?;
        let text = String::from_utf8(bytes)
            .map_err(|_| SceneError::file(path, "is not UTF-8 text, so it is not a TOML scene file"))?;
        let mut document = Self::parse(&path.display().to_string(), &text)?;
        document.folder = path.parent().unwrap_or(Path::new("")).to_owned();
        Ok(document)
    }

    /// Parses the text of a scene file; `name` stands for it in messages. Files it mentions are relative to
    /// the working folder.
    pub fn parse(name: &str, text: &str) -> Result<Self, SceneError> {
        let text: Arc<str> = Arc::from(text);
        let place =
            Place { text: Arc::new(NamedSource::new(name, Arc::clone(&text))), is_option: false, span: 0..0 };
        let table = DeTable::parse(&text).map_err(|error| syntax_problem(&error, &place))?;
        let mut problems = Vec::new();
        let root = Node::from_document(table.into_inner(), &place, &mut problems);
        SceneError::unless_empty(problems)?;
        Ok(Self { folder: PathBuf::new(), root })
    }

    /// A scene that a program hands over. Messages show the path of keys, such as `volume.0.mu_t`, where those about a text
    /// show line and column.
    pub fn from_table(table: toml::Table) -> Self {
        Self { folder: PathBuf::new(), root: Node::from_tree(toml::Value::Table(table), ROOT) }
    }

    /// The folder that the scene's file names are relative to.
    pub fn folder(&self) -> &Path {
        &self.folder
    }

    /// Changes one value: `camera.vertical_fov=30`, `volume.0.mu_t=3`, `render.integrator=reference`.
    ///
    /// Tables on the way are made; the entries of arrays count from 0, and the one after the last can be
    /// made. A value that is not TOML is taken as a string.
    pub fn set(&mut self, assignment: &str) -> Result<(), SceneError> {
        let option = format!("--set {assignment}");
        let text = Arc::new(NamedSource::new(option.clone(), Arc::from(assignment)));
        let place = Place { text, is_option: true, span: 0..assignment.len() };
        let Some((path, value)) = assignment.split_once('=') else {
            return Err(place.problem("lacks `=`: write path.to.key=value").into());
        };
        let keys = keys_of(path)
            .ok_or_else(|| place.problem("write path.to.key=value, such as camera.vertical_fov=30"))?;
        let mut problems = Vec::new();
        let node = match DeValue::parse(value.trim()) {
            Ok(value) => Node::from_value(value.into_inner(), place.clone(), &mut problems),
            Err(_) => Node { value: Value::String(value.trim().to_owned()), place: place.clone() },
        };
        SceneError::unless_empty(problems)?;
        *slot(&mut self.root, &keys, &place)? = node;
        Ok(())
    }

    /// Changes one value as [`set`](Self::set) does: `path` such as `volume.0.mu_t`.
    pub fn set_value(&mut self, path: &str, value: toml::Value) -> Result<(), SceneError> {
        let place = Place::in_tree(path);
        let keys = keys_of(path).ok_or_else(|| {
            place.problem("write the keys that lead to the value, such as camera.vertical_fov")
        })?;
        *slot(&mut self.root, &keys, &place)? = Node::from_tree(value, path);
        Ok(())
    }

    /// The description, if the document is a sound scene; else everything that is wrong with it.
    pub fn description(&self) -> Result<SceneDescription, SceneError> {
        static SCHEMA: LazyLock<serde_json::Value> = LazyLock::new(json_schema);
        let mut problems = conformance::problems(&self.root, "the scene", &SCHEMA);
        problems.sort_by_key(|problem| problem.position);
        SceneError::unless_empty(problems)?;

        let description: SceneDescription =
            self.root.to_toml().try_into().map_err(|error: toml::de::Error| {
                self.root.place.problem(error.message().replace('\n', " "))
            })?;

        let violations = description.violations();
        let problems =
            violations.into_iter().map(|v| self.root.place_of(&v.path).problem(v.message)).collect();
        SceneError::unless_empty(problems)?;
        Ok(description)
    }
}

/// The keys of a path. Paths deeper than any scene are none; walks over the tree must not run out of stack.
fn keys_of(path: &str) -> Option<Vec<&str>> {
    let keys: Vec<&str> = path.split('.').map(str::trim).collect();
    (keys.iter().all(|key| !key.is_empty()) && keys.len() <= 16).then_some(keys)
}

/// The value at `keys`, made if it is not there.
fn slot<'a>(node: &'a mut Node, keys: &[&str], place: &Place) -> Result<&'a mut Node, SceneError> {
    let Some((key, rest)) = keys.split_first() else { return Ok(node) };
    let new_table = || Node { value: Value::Table(Vec::new()), place: place.clone() };
    let child = match &mut node.value {
        Value::Table(entries) => {
            let index = entries.iter().position(|entry| entry.key == **key).unwrap_or(entries.len());
            if index == entries.len() {
                // The first `--set volume.0.…` of a scene without volumes makes the array.
                let value = match rest.first() {
                    Some(next) if next.parse::<usize>().is_ok() => Value::Array(Vec::new()),
                    _ => Value::Table(Vec::new()),
                };
                entries.push(Entry {
                    key: (*key).to_owned(),
                    key_place: place.clone(),
                    node: Node { value, place: place.clone() },
                });
            }
            &mut entries[index].node
        }
        Value::Array(items) => {
            let Some(index) = key.parse().ok().filter(|index: &usize| *index <= items.len()) else {
                let message = format!("`{key}` is no entry: the array has {}, counted from 0", items.len());
                return Err(place.problem(message).into());
            };
            if index == items.len() {
                items.push(new_table());
            }
            &mut items[index]
        }
        _ => return Err(place.problem(format!("there is no `{key}` inside a plain value")).into()),
    };
    slot(child, rest, place)
}

fn syntax_problem(error: &toml::de::Error, place: &Place) -> Problem {
    let message = error.message().lines().collect::<Vec<_>>().join(", ");
    Problem::at(&place.text, error.span().unwrap_or(0..0), format!("not TOML: {message}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn problem(text: &str) -> String {
        SceneDocument::from_table(toml::from_str(text).unwrap()).description().unwrap_err().to_string()
    }

    #[test]
    fn a_tree_is_the_same_scene_as_its_text_and_its_problems_name_keys() {
        let text = "camera = { position = [0, 0, 5], target = [0, 0, 0] }\nlight = [{ type = \"sun\", direction = [0, 1, 0], irradiance = 1 }]\n";
        let tree = SceneDocument::from_table(toml::from_str(text).unwrap()).description().unwrap();
        assert_eq!(tree, SceneDocument::parse("text", text).unwrap().description().unwrap());
        assert_eq!(
            problem(&text.replace("irradiance", "irradance")),
            "light.0.irradance: unknown key `irradance` in [[light]] of type `sun`, did you mean `irradiance`?"
        );
        assert!(
            problem(&text.replace("5]", "\"x\"]")).starts_with("camera.position: `position[2]` must be a")
        );
        assert!(problem("").starts_with("scene: the scene lacks [camera]"));
    }

    #[test]
    fn values_are_set_as_options_set_them() {
        let text = "camera = { position = [0, 0, 5], target = [0, 0, 0] }";
        let mut by_option = SceneDocument::parse("text", text).unwrap();
        let mut by_value = by_option.clone();
        by_option.set("volume.0.sphere.radius=2").unwrap();
        by_value.set_value("volume.0.sphere.radius", 2.into()).unwrap();
        assert_eq!(by_value.root.to_toml(), by_option.root.to_toml());
        assert!(by_value.set_value("camera..x", 2.into()).is_err());
    }
}
