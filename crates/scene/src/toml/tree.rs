//! TOML values that know where they stand, in the scene file or in an option.

use std::ops::Range;
use std::sync::Arc;

use miette::NamedSource;
use toml::de::{DeTable, DeValue};

use super::counted::counted;
use crate::error::{Problem, SceneText};

/// What messages call a tree as a whole.
pub(crate) const ROOT: &str = "scene";

/// Bytes of a text.
#[derive(Debug, Clone)]
pub(crate) struct Place {
    pub(crate) text: SceneText,
    /// Whether the text is an option, such as `--set`'s, which is shown whole, and not the scene file.
    pub(crate) is_option: bool,
    pub(crate) span: Range<usize>,
}

impl Place {
    pub(crate) fn problem(&self, message: impl Into<String>) -> Problem {
        if self.is_option {
            Problem::option(self.text.name(), message)
        } else {
            Problem::at(&self.text, self.span.clone(), message)
        }
    }

    /// A place in a tree that no text is behind: messages show the path of keys.
    pub(crate) fn in_tree(path: &str) -> Self {
        Self { text: Arc::new(NamedSource::new(path, Arc::from(""))), is_option: true, span: 0..0 }
    }

    fn elsewhere(&self, span: Range<usize>) -> Self {
        Self { span, ..self.clone() }
    }
}

/// A value and where it stands.
#[derive(Debug, Clone)]
pub(crate) struct Node {
    pub(crate) value: Value,
    pub(crate) place: Place,
}

/// A TOML value.
#[derive(Debug, Clone)]
pub(crate) enum Value {
    String(String),
    Integer(i64),
    Float(f64),
    Boolean(bool),
    Datetime,
    Array(Vec<Node>),
    Table(Vec<Entry>),
}

/// A key of a table with its value.
#[derive(Debug, Clone)]
pub(crate) struct Entry {
    pub(crate) key: String,
    pub(crate) key_place: Place,
    pub(crate) node: Node,
}

impl Node {
    /// The tree of a whole document that stands at `place`.
    pub(crate) fn from_document(table: DeTable<'_>, place: &Place, problems: &mut Vec<Problem>) -> Self {
        Self { value: entries(table, place, problems), place: place.elsewhere(0..0) }
    }

    /// The tree of a single value.
    pub(crate) fn from_value(value: DeValue<'_>, place: Place, problems: &mut Vec<Problem>) -> Self {
        let value = match value {
            DeValue::String(text) => Value::String(text.into_owned()),
            DeValue::Boolean(flag) => Value::Boolean(flag),
            DeValue::Datetime(_) => Value::Datetime,
            DeValue::Integer(digits) => match i64::from_str_radix(digits.as_str(), digits.radix()) {
                Ok(integer) => Value::Integer(integer),
                Err(_) => {
                    problems.push(place.problem(format!("{digits} is too large an integer")));
                    Value::Integer(0)
                }
            },
            DeValue::Float(digits) => match digits.as_str().parse() {
                Ok(float) => Value::Float(float),
                Err(_) => {
                    problems.push(place.problem(format!("{digits} is not a number")));
                    Value::Float(0.0)
                }
            },
            DeValue::Array(items) => Value::Array(
                items
                    .into_iter()
                    .map(|item| {
                        let place = place.elsewhere(item.span());
                        Self::from_value(item.into_inner(), place, problems)
                    })
                    .collect(),
            ),
            DeValue::Table(table) => entries(table, &place, problems),
        };
        Self { value, place }
    }

    /// The tree of a value at a path of keys, such as `volume.0.mu_t`.
    pub(crate) fn from_tree(value: toml::Value, path: &str) -> Self {
        let place = Place::in_tree(path);
        let below = |key: &dyn std::fmt::Display| match path {
            ROOT => key.to_string(),
            path => format!("{path}.{key}"),
        };
        let value = match value {
            toml::Value::String(text) => Value::String(text),
            toml::Value::Integer(integer) => Value::Integer(integer),
            toml::Value::Float(float) => Value::Float(float),
            toml::Value::Boolean(flag) => Value::Boolean(flag),
            toml::Value::Datetime(_) => Value::Datetime,
            toml::Value::Array(items) => Value::Array(
                items
                    .into_iter()
                    .enumerate()
                    .map(|(index, item)| match item {
                        toml::Value::Table(_) | toml::Value::Array(_) => {
                            Self::from_tree(item, &below(&index))
                        }
                        // Meshes have very many numbers.
                        item => Self { place: place.clone(), ..Self::from_tree(item, ROOT) },
                    })
                    .collect(),
            ),
            toml::Value::Table(table) => Value::Table(
                table
                    .into_iter()
                    .map(|(key, value)| {
                        let path = below(&key);
                        let key_place = Place::in_tree(&path);
                        Entry { key_place, key, node: Self::from_tree(value, &path) }
                    })
                    .collect(),
            ),
        };
        Self { value, place }
    }

    /// The value without its places.
    pub(crate) fn to_toml(&self) -> toml::Value {
        match &self.value {
            Value::String(text) => toml::Value::String(text.clone()),
            Value::Integer(integer) => toml::Value::Integer(*integer),
            Value::Float(float) => toml::Value::Float(counted(*float)),
            Value::Boolean(flag) => toml::Value::Boolean(*flag),
            // The schema has no dates: the check has refused it before.
            Value::Datetime => toml::Value::String(String::new()),
            Value::Array(items) => toml::Value::Array(items.iter().map(Self::to_toml).collect()),
            Value::Table(entries) => toml::Value::Table(
                entries.iter().map(|entry| (entry.key.clone(), entry.node.to_toml())).collect(),
            ),
        }
    }

    /// Where `path` stands, or the nearest table above it that is there.
    pub(crate) fn place_of(&self, path: &[String]) -> &Place {
        let Some((key, rest)) = path.split_first() else { return &self.place };
        match &self.value {
            Value::Table(entries) => match entries.iter().find(|entry| entry.key == *key) {
                // The key, not the value, is what a person looks for.
                Some(entry) if rest.is_empty() => &entry.key_place,
                Some(entry) => entry.node.place_of(rest),
                None => &self.place,
            },
            Value::Array(items) => match key.parse().ok().and_then(|index: usize| items.get(index)) {
                Some(item) => item.place_of(rest),
                None => &self.place,
            },
            _ => &self.place,
        }
    }
}

fn entries(table: DeTable<'_>, place: &Place, problems: &mut Vec<Problem>) -> Value {
    Value::Table(
        table
            .into_iter()
            .map(|(key, value)| {
                let value_place = place.elsewhere(value.span());
                Entry {
                    key_place: place.elsewhere(key.span()),
                    key: key.into_inner().into_owned(),
                    node: Node::from_value(value.into_inner(), value_place, problems),
                }
            })
            .collect(),
    )
}
