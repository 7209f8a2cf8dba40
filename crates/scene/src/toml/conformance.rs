//! Holds a tree of values against the JSON schema and says everything that is wrong, in words.
//!
//! Only what [`json_schema`](super::json_schema) generates is understood: objects with known properties,
//! arrays, numbers with ranges, strings, booleans, choices of words, objects chosen by their `type`, `anyOf` of
//! different kinds of values, of which several may be objects that differ in a key they need, and references to
//! definitions.

use serde_json::Value as Schema;

use super::counted::counted;
use super::tree::{Entry, Node, Place, Value};
use crate::description::{Dimension, dimension};
use crate::error::Problem;
use crate::suggestion::{did_you_mean, list_of, nearest};

/// Greatest magnitude of any number: products of a few such numbers stay finite in double precision.
const GREATEST: f64 = 1e30;

/// Greatest length in scene units: squares and volumes stay finite in single precision.
const GREATEST_LENGTH: f64 = 1e12;

/// Least length that must be above 0.
const LEAST_LENGTH: f64 = 1e-12;

/// Everything in `node`, which messages call `name`, that the schema does not allow.
pub(crate) fn problems(node: &Node, name: &str, schema: &Schema) -> Vec<Problem> {
    let mut check =
        Check { root: schema, keys: Vec::new(), dimension: Dimension::Plain, problems: Vec::new() };
    check.value(node, name, schema);
    check.problems
}

struct Check<'s> {
    root: &'s Schema,
    /// Those that lead to the present value.
    keys: Vec<&'s str>,
    /// What numbers there are measured in.
    dimension: Dimension,
    problems: Vec<Problem>,
}

impl<'s> Check<'s> {
    fn report(&mut self, place: &Place, message: String) {
        self.problems.push(place.problem(message));
    }

    /// `name` is what messages call the value.
    fn value(&mut self, node: &Node, name: &str, schema: &'s Schema) {
        let schema = self.resolved(schema);
        if let Some(words) = words_of(schema) {
            return self.word(node, name, &words);
        }
        if let Some(branches) = branches_of(schema) {
            if branches.iter().any(|branch| tag_of(branch).is_some()) {
                return self.tagged_table(node, name, branches);
            }
            let branches = branches.iter().map(|branch| self.resolved(branch));
            let fitting: Vec<&'s Schema> =
                branches.filter(|branch| is_kind(&node.value, kind_of(branch))).collect();
            let needs = |branch: &Schema| match &node.value {
                Value::Table(entries) => entries.iter().any(|entry| is_required(branch, &entry.key)),
                _ => false,
            };
            return match fitting.iter().find(|branch| needs(branch)).or(fitting.first()) {
                Some(branch) => self.value(node, name, branch),
                None => self.wrong_kind(node, name, schema),
            };
        }
        if !is_kind(&node.value, kind_of(schema)) {
            return self.wrong_kind(node, name, schema);
        }
        match &node.value {
            Value::Integer(integer) => self.number(node, name, *integer as f64, schema),
            Value::Float(float) => self.number(node, name, *float, schema),
            Value::Array(items) => self.array(node, name, items, schema),
            Value::Table(entries) => self.table(node, name, entries, schema),
            Value::String(_) | Value::Boolean(_) | Value::Datetime => {}
        }
    }

    /// What a reference stands for; the schema itself otherwise.
    fn resolved(&self, schema: &'s Schema) -> &'s Schema {
        let name = schema.get("$ref").and_then(Schema::as_str).and_then(|path| path.strip_prefix("#/$defs/"));
        name.and_then(|name| self.root.get("$defs")?.get(name)).unwrap_or(schema)
    }

    fn wrong_kind(&mut self, node: &Node, name: &str, schema: &Schema) {
        self.report(
            &node.place,
            format!("{name} must be {}, not {}", expected(schema), kind_in_words(&node.value)),
        );
    }

    fn word(&mut self, node: &Node, name: &str, words: &[&str]) {
        match &node.value {
            Value::String(word) if words.contains(&word.as_str()) => {}
            Value::String(word) => {
                let mend = did_you_mean(word, words.iter().copied());
                self.report(&node.place, format!("unknown value `{word}` of {name}{mend}"));
            }
            other => {
                let list = list_of(words.iter().copied());
                self.report(
                    &node.place,
                    format!("{name} must be one of {list}, not {}", kind_in_words(other)),
                );
            }
        }
    }

    fn number(&mut self, node: &Node, name: &str, number: f64, schema: &Schema) {
        let bound = |key: &str| schema.get(key).and_then(Schema::as_f64);
        let counted = counted(number);
        let is_inside = bound("minimum").is_none_or(|bound| counted >= bound)
            && bound("maximum").is_none_or(|bound| counted <= bound)
            && bound("exclusiveMinimum").is_none_or(|bound| counted > bound)
            && bound("exclusiveMaximum").is_none_or(|bound| counted < bound);
        if !number.is_finite() {
            self.report(&node.place, format!("{name} must be finite, not {number}"));
        } else if !is_inside {
            self.report(&node.place, format!("{name} must be {}, not {number}", expected(schema)));
        } else if number.abs() > GREATEST {
            self.report(
                &node.place,
                format!("{name} is {number:e}: numbers beyond 1e30 are not computed with"),
            );
        } else if let Some(message) = self.beyond_lengths(name, number, bound("exclusiveMinimum")) {
            self.report(&node.place, message);
        }
    }

    /// What is wrong with a length.
    fn beyond_lengths(&self, name: &str, number: f64, must_be_above: Option<f64>) -> Option<String> {
        let (is_great, is_small) = (number.abs() > GREATEST_LENGTH, number < LEAST_LENGTH);
        match self.dimension {
            Dimension::Length if is_great => Some(format!(
                "{name} is {number:e}: lengths beyond 1e12 scene units are not computed with; let a scene unit be longer"
            )),
            Dimension::Length if is_small && must_be_above.is_some() => Some(format!(
                "{name} is {number:e}: what is shorter than 1e-12 scene units is not computed with; let a scene unit be \
                 shorter"
            )),
            _ => None,
        }
    }

    fn array(&mut self, node: &Node, name: &str, items: &[Node], schema: &'s Schema) {
        let length = |key: &str| schema.get(key).and_then(Schema::as_u64);
        let is_fitting = length("minItems").is_none_or(|least| items.len() as u64 >= least)
            && length("maxItems").is_none_or(|most| items.len() as u64 <= most);
        if !is_fitting {
            let message = format!("{name} must be {}, not {} of them", expected(schema), items.len());
            return self.report(&node.place, message);
        }
        let Some(item_schema) = schema.get("items") else { return };
        let is_array_of_tables = kind_of(item_schema) == "object" || branches_of(item_schema).is_some();
        for (index, item) in items.iter().enumerate() {
            let item_name = if is_array_of_tables {
                name.to_owned()
            } else {
                format!("`{}[{index}]`", name.trim_matches('`'))
            };
            self.value(item, &item_name, item_schema);
        }
    }

    fn tagged_table(&mut self, node: &Node, name: &str, branches: &'s [Schema]) {
        let Value::Table(entries) = &node.value else {
            let message = format!("{name} must be a table with a `type`, not {}", kind_in_words(&node.value));
            return self.report(&node.place, message);
        };
        let tags = || branches.iter().filter_map(tag_of);
        let Some(entry) = entries.iter().find(|entry| entry.key == "type") else {
            return self.report(&node.place, format!("{name} lacks `type`: give one of {}", list_of(tags())));
        };
        let Value::String(tag) = &entry.node.value else {
            let message = format!("`type` must be one of {}", list_of(tags()));
            return self.report(&entry.node.place, message);
        };
        match branches.iter().find(|branch| tag_of(branch) == Some(tag)) {
            Some(branch) => self.table(node, &format!("{name} of type `{tag}`"), entries, branch),
            None => {
                let mend = did_you_mean(tag, tags());
                self.report(&entry.node.place, format!("unknown type `{tag}` of {name}{mend}"));
            }
        }
    }

    /// The value of a key of a table.
    fn property(&mut self, node: &Node, key: &'s str, schema: &'s Schema) {
        let outside = self.dimension;
        self.keys.push(key);
        self.dimension = dimension(&self.keys);
        self.value(node, &name_of(key, schema), schema);
        self.keys.pop();
        self.dimension = outside;
    }

    fn table(&mut self, node: &Node, name: &str, entries: &[Entry], schema: &'s Schema) {
        let Some(properties) = schema.get("properties").and_then(Schema::as_object) else { return };
        let mut has_unknown = false;
        for entry in entries {
            match properties.get_key_value(&entry.key) {
                Some((key, property)) if key == "type" && tag_of(schema).is_some() => {
                    debug_assert!(property.get("const").is_some());
                }
                Some((key, property)) => self.property(&entry.node, key, property),
                None => {
                    has_unknown = true;
                    let keys = || properties.keys().map(String::as_str);
                    let absent = || keys().filter(|key| !entries.iter().any(|entry| entry.key == **key));
                    // A `--set` that misspells a key means one that is there already.
                    let mend = match nearest(&entry.key, absent()) {
                        None if nearest(&entry.key, keys()).is_some() => did_you_mean(&entry.key, keys()),
                        _ => did_you_mean(&entry.key, absent()),
                    };
                    self.report(&entry.key_place, format!("unknown key `{}` in {name}{mend}", entry.key));
                }
            }
        }
        let required = schema.get("required").and_then(Schema::as_array);
        for key in required.into_iter().flatten().filter_map(Schema::as_str) {
            // A misspelt key is reported once, as unknown.
            if !has_unknown && !entries.iter().any(|entry| entry.key == key) {
                let wanted = properties.get(key).map_or_else(String::new, expected);
                self.report(
                    &node.place,
                    format!("{name} lacks {}: give {wanted}", name_of(key, &Schema::Null)),
                );
            }
        }
    }
}

/// What messages call the value of a key: tables as people write them, other keys in back quotes.
fn name_of(key: &str, schema: &Schema) -> String {
    let is_table = kind_of(schema) == "object" && matches!(key, "film" | "render" | "medium");
    match key {
        "camera" => "[camera]".to_owned(),
        "volume" | "light" | "meter" | "material" | "shape" if kind_of(schema) == "array" => {
            format!("[[{key}]]")
        }
        _ if is_table => format!("[{key}]"),
        _ => format!("`{key}`"),
    }
}

/// The words a schema allows, if it is a choice of words.
fn words_of(schema: &Schema) -> Option<Vec<&str>> {
    if let Some(words) = schema.get("enum").and_then(Schema::as_array) {
        return words.iter().map(Schema::as_str).collect();
    }
    let branches = schema.get("oneOf")?.as_array()?;
    let mut words = Vec::new();
    for branch in branches {
        match (branch.get("const"), branch.get("enum").and_then(Schema::as_array)) {
            (Some(word), _) => words.push(word.as_str()?),
            (None, Some(several)) => words.extend(several.iter().filter_map(Schema::as_str)),
            (None, None) => return None,
        }
    }
    Some(words)
}

fn branches_of(schema: &Schema) -> Option<&Vec<Schema>> {
    schema.get("oneOf").or_else(|| schema.get("anyOf"))?.as_array()
}

/// The `type` by which an object is chosen among others.
fn tag_of(schema: &Schema) -> Option<&str> {
    schema.get("properties")?.get("type")?.get("const")?.as_str()
}

/// A choice among objects by their `type` is an object.
fn kind_of(schema: &Schema) -> &str {
    let is_tagged =
        || branches_of(schema).is_some_and(|branches| branches.iter().any(|b| tag_of(b).is_some()));
    match schema.get("type").and_then(Schema::as_str) {
        Some(kind) => kind,
        None if is_tagged() => "object",
        None => "",
    }
}

fn is_required(schema: &Schema, key: &str) -> bool {
    let required = schema.get("required").and_then(Schema::as_array);
    required.is_some_and(|keys| keys.iter().any(|required| required == key))
}

fn is_kind(value: &Value, kind: &str) -> bool {
    match value {
        Value::String(_) => kind == "string",
        Value::Integer(_) => kind == "integer" || kind == "number",
        Value::Float(_) => kind == "number",
        Value::Boolean(_) => kind == "boolean",
        Value::Array(_) => kind == "array",
        Value::Table(_) => kind == "object",
        Value::Datetime => false,
    }
}

fn kind_in_words(value: &Value) -> String {
    match value {
        Value::String(_) => "a string".to_owned(),
        Value::Integer(_) => "an integer".to_owned(),
        Value::Float(number) => format!("{number}"),
        Value::Boolean(flag) => format!("{flag}"),
        Value::Array(items) => format!("an array of {}", items.len()),
        Value::Table(_) => "a table".to_owned(),
        Value::Datetime => "a date".to_owned(),
    }
}

/// What a schema allows, in words that follow "must be".
fn expected(schema: &Schema) -> String {
    if let Some(words) = words_of(schema) {
        return format!("one of {}", list_of(words));
    }
    if let Some(branches) = branches_of(schema) {
        return match branches.iter().filter_map(tag_of).collect::<Vec<_>>() {
            tags if tags.is_empty() => {
                let mut ways: Vec<String> = branches.iter().map(expected).collect();
                ways.dedup();
                ways.join(" or ")
            }
            tags => format!("a table with a `type`, one of {}", list_of(tags)),
        };
    }
    match kind_of(schema) {
        "integer" => format!("an integer{}", range_in_words(schema)),
        "number" => format!("a number{}", range_in_words(schema)),
        "string" => "a string".to_owned(),
        "boolean" => "true or false".to_owned(),
        "array" => {
            let items = schema.get("items").unwrap_or(&Schema::Null);
            let count = match schema.get("minItems").and_then(Schema::as_u64) {
                Some(count) => format!("{count} "),
                None => String::new(),
            };
            match kind_of(items) {
                "integer" => format!("an array of {count}integers{}", range_in_words(items)),
                "number" => format!("an array of {count}numbers{}", range_in_words(items)),
                _ if words_of(items).is_some() => format!("an array of words, each {}", expected(items)),
                _ => "an array of tables".to_owned(),
            }
        }
        "object" => "a table".to_owned(),
        // Of what is defined elsewhere only tables are referred to.
        _ if schema.get("$ref").is_some() => "a table".to_owned(),
        _ => "something else".to_owned(),
    }
}

fn range_in_words(schema: &Schema) -> String {
    let bound = |key: &str| schema.get(key).and_then(Schema::as_f64);
    match (bound("minimum"), bound("exclusiveMinimum"), bound("maximum"), bound("exclusiveMaximum")) {
        (None, None, None, None) => String::new(),
        (Some(least), None, None, None) => format!(" of at least {least}"),
        (None, None, Some(most), None) => format!(" of at most {most}"),
        (None, Some(below), None, None) => format!(" above {below}"),
        (None, Some(below), Some(most), None) => format!(" above {below} and at most {most}"),
        (None, Some(below), None, Some(above)) => format!(" between {below} and {above}, both excluded"),
        (Some(least), None, Some(most), None) => format!(" from {least} to {most}"),
        // No other pair of bounds is in the schema.
        _ => " within its range".to_owned(),
    }
}
