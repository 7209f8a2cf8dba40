//! Phase functions in one line: `rayleigh`, `hg(g=0.85)`, `hg:0.85`, `fog(d=10um)`, `sggx(kind=fibre, roughness=0.3)`.
//!
//! The text is a call whose name is the `type` of a [`PhaseDescription`] and whose values are its keys;
//! calls within it are tables that are told apart by their `type`. It is made the tree that a scene file would give and
//! held against the same schema, so that names, ranges and messages are those of scene files. Two things are shorter
//! here. A key may leave its unit to the value: `wavelength=0.55um` is `wavelength_nm=550`. And the only key that a type
//! needs may go without its name.

use std::sync::Arc;

use miette::NamedSource;
use serde_json::Value as Schema;

use super::call::{self, Argument, Call, Term};
use super::{PhaseDescription, mie_spec};
use crate::SceneError;
use crate::toml::conformance;
use crate::toml::schema::schema_of;
use crate::toml::tree::{Entry, Node, Place, Value};

/// A longer text is no description in one line.
const GREATEST_LENGTH: usize = 4096;

/// Short forms: of a type, a key and what it stands for.
const SHORT_KEYS: [(&str, &str, &str); 2] =
    [("fog", "d", "droplet_diameter"), ("fog", "diameter", "droplet_diameter")];

/// Reads a phase function in one line; errors start with the text.
///
/// # Examples
///
/// ```
/// use tyndall_scene::description::{PhaseDescription, phase_spec};
/// assert_eq!(phase_spec::parse("hg:0.85")?, PhaseDescription::Hg { g: 0.85 });
/// # Ok::<(), tyndall_scene::SceneError>(())
/// ```
pub fn parse(text: &str) -> Result<PhaseDescription, SceneError> {
    let shown: String = match text.trim() {
        "" => "the phase function".into(),
        text => text.chars().take(80).collect(),
    };
    let source = NamedSource::new(shown, Arc::from(text));
    let place = Place { text: Arc::new(source), is_option: true, span: 0..0 };
    if text.len() > GREATEST_LENGTH {
        return Err(place.problem("is too long for a phase function in one line").into());
    }
    let call = call::parse(text).map(mie_spec::named).map_err(|message| place.problem(message))?;
    let schema = schema_of::<PhaseDescription>();
    let node = Tree { place: &place }.table(&call, &schema)?;
    SceneError::unless_empty(conformance::problems(&node, "the phase function", &schema))?;
    let description: PhaseDescription = node
        .to_toml()
        .try_into()
        .map_err(|error: toml::de::Error| place.problem(error.message().replace('\n', " ")))?;
    match description.violation() {
        Some((_, message)) => Err(place.problem(message).into()),
        None => Ok(description),
    }
}

/// Makes the tree of a scene file from calls.
struct Tree<'a> {
    place: &'a Place,
}

impl Tree<'_> {
    fn node(&self, value: Value) -> Node {
        Node { value, place: self.place.clone() }
    }

    /// The table of a call, where `schema` is a choice of tables by `type`.
    fn table(&self, call: &Call, schema: &Schema) -> Result<Node, SceneError> {
        let branch = branch_of(schema, &call.name);
        let mut entries = vec![self.entry("type", Value::String(call.name.clone()))];
        for argument in &call.arguments {
            let (key, value) = self.argument(call, argument, branch)?;
            if entries.iter().any(|entry| entry.key == key) {
                return Err(self.place.problem(format!("`{key}` is given twice; keep one")).into());
            }
            entries.push(self.entry(&key, value));
        }
        Ok(self.node(Value::Table(entries)))
    }

    fn entry(&self, key: &str, value: Value) -> Entry {
        Entry { key: key.to_owned(), key_place: self.place.clone(), node: self.node(value) }
    }

    /// The key of the scene file that an argument means, and its value there.
    fn argument(
        &self,
        call: &Call,
        argument: &Argument,
        branch: &Schema,
    ) -> Result<(String, Value), SceneError> {
        let key = match &argument.key {
            Some(key) => key.clone(),
            None => self.only_key(call, branch)?,
        };
        let is_short = |short: &&(&str, &str, &str)| short.0 == call.name && short.1 == key;
        let key = SHORT_KEYS.iter().find(is_short).map_or(key, |short| short.2.to_owned());
        let (key, unit) = with_unit(&key, branch);
        let value = self.value(&argument.term, &branch["properties"][&key])?;
        match (unit, value) {
            (Some(unit), Value::String(text)) => {
                Ok((key, in_unit(&text, unit).unwrap_or(Value::String(text))))
            }
            (_, value) => Ok((key, value)),
        }
    }

    fn only_key(&self, call: &Call, branch: &Schema) -> Result<String, SceneError> {
        let required = branch["required"].as_array().into_iter().flatten().filter_map(Schema::as_str);
        let keys: Vec<&str> = required.filter(|key| *key != "type").collect();
        match keys.as_slice() {
            [key] if call.arguments.len() == 1 => Ok((*key).to_owned()),
            // An unknown type: what is wrong is its name, not its keys.
            [] if branch.is_null() => Ok(String::new()),
            _ => {
                let message = format!("write the names of the values of `{}`: key=value", call.name);
                Err(self.place.problem(message).into())
            }
        }
    }

    fn value(&self, term: &Term, schema: &Schema) -> Result<Value, SceneError> {
        Ok(match term {
            // What is to be text stays text, also a file that is called 7.
            Term::Text(text) if schema["type"] == "string" => Value::String(text.clone()),
            Term::Text(text) => match (text.parse(), text.parse()) {
                (Ok(integer), _) => Value::Integer(integer),
                (_, Ok(float)) => Value::Float(float),
                _ => Value::String(text.clone()),
            },
            Term::List(items) => {
                let items = items.iter().map(|item| Ok(self.node(self.value(item, &schema["items"])?)));
                Value::Array(items.collect::<Result<_, SceneError>>()?)
            }
            Term::Call(call) => self.table(call, schema)?.value,
        })
    }
}

/// The schema of the tables of type `tag`; null if there is none.
fn branch_of<'a>(schema: &'a Schema, tag: &str) -> &'a Schema {
    let choices = schema["oneOf"].as_array().or(schema["anyOf"].as_array());
    let found = choices.into_iter().flatten().find(|branch| branch["properties"]["type"]["const"] == tag);
    found.unwrap_or(&Schema::Null)
}

/// Units that keys end in, with their metres.
const UNITS: [(&str, f64); 5] = [("nm", 1e-9), ("um", 1e-6), ("mm", 1e-3), ("cm", 1e-2), ("m", 1.0)];

/// The key that is in the schema, perhaps with the unit that it ends in, and that unit's metres.
fn with_unit(key: &str, branch: &Schema) -> (String, Option<f64>) {
    let is_there = |key: &str| branch["properties"].get(key).is_some();
    let unit_of = |key: &str| UNITS.iter().find(|unit| key.ends_with(&format!("_{}", unit.0)));
    if is_there(key) {
        return (key.to_owned(), unit_of(key).map(|unit| unit.1));
    }
    let with_units = UNITS.iter().map(|unit| (format!("{key}_{}", unit.0), unit.1));
    match with_units.into_iter().find(|(key, _)| is_there(key)) {
        Some((key, metres)) => (key, Some(metres)),
        None => (key.to_owned(), None),
    }
}

/// A length with its unit, in units of so many metres.
fn in_unit(text: &str, metres: f64) -> Option<Value> {
    let digits = text.trim_end_matches(|c: char| c.is_alphabetic()).trim_end();
    let name = text[digits.len()..].trim().replace(['µ', 'μ'], "u");
    let unit = UNITS.iter().find(|unit| unit.0 == name)?;
    // The quotient of two powers of ten is exact this way round for units a thousand apart.
    let factor = if unit.1 < metres { 1.0 / (metres / unit.1).round() } else { (unit.1 / metres).round() };
    Some(Value::Float(digits.parse::<f64>().ok()? * factor))
}
