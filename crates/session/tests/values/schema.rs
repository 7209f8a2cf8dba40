//! The leaves of the schema of scene files: every key of every table, in every form that a value may have there.
//!
//! A table that stands in several places, as a spectrum does, is one table: its keys are leaves once.

use std::collections::{BTreeMap, BTreeSet};

use serde_json::Value as Schema;
use toml::Value;

/// The way to a value in a scene: keys, and numbers of entries.
pub type Path = Vec<String>;

/// A value of a scene, with what the schema allows in its place.
pub struct Node<'s> {
    /// The leaf of the schema that it is.
    pub leaf: String,
    /// Where it stands.
    pub path: Path,
    /// The branch of the schema that it follows.
    pub schema: &'s Schema,
}

/// The schema, and a name for each of its tables: the path to the first place where it stands.
pub struct Leaves {
    root: Schema,
    tables: BTreeMap<String, String>,
    /// All leaves.
    pub all: BTreeSet<String>,
}

impl Leaves {
    /// Of the schema as it is generated.
    pub fn new() -> Self {
        let root = tyndall_scene::json_schema();
        let mut leaves = Self { root: Schema::Null, tables: BTreeMap::new(), all: BTreeSet::new() };
        leaves.collect(&root, &root, "");
        leaves.root = root;
        leaves
    }

    /// `leaf` is what a value of this schema is.
    fn collect(&mut self, root: &Schema, schema: &Schema, leaf: &str) {
        let schema = resolved(root, schema);
        if let Some(branches) = branches(schema).filter(|_| !is_word(schema)) {
            // A number is allowed in the place of a quantity, such as "10 um", only to be told that it lacks its unit.
            let is_quantity = branches.iter().map(kind).eq(["string", "number"]);
            branches[..if is_quantity { 1 } else { branches.len() }]
                .iter()
                .for_each(|branch| self.collect(root, branch, leaf));
        } else if kind(schema) == "object" {
            let identity = identity(schema);
            if self.tables.contains_key(&identity) {
                return;
            }
            let name = match tag(schema) {
                Some(tag) => format!("{leaf}({tag})"),
                None => leaf.to_owned(),
            };
            self.tables.insert(identity, name.clone());
            for (key, property) in properties(schema) {
                self.collect(root, property, &format!("{name}.{key}"));
            }
        } else {
            self.all.insert(format!("{leaf}: {}", kind(schema)));
            if let Some(items) = schema.get("items") {
                self.collect(root, items, &format!("{leaf}[]"));
            }
        }
    }

    /// All values of a scene that are leaves, the parts of arrays among them.
    pub fn of_scene(&self, scene: &toml::Table) -> Vec<Node<'_>> {
        let mut found = Vec::new();
        self.walk(&Value::Table(scene.clone()), &self.root, "", &mut Vec::new(), &mut found);
        found
    }

    fn walk<'s>(
        &'s self,
        value: &Value,
        schema: &'s Schema,
        leaf: &str,
        path: &mut Path,
        found: &mut Vec<Node<'s>>,
    ) {
        let Some(schema) = self.branch_of(value, schema) else { return };
        match value {
            Value::Table(table) => {
                let name = &self.tables[&identity(schema)];
                for (key, value) in table {
                    let Some(property) = properties(schema).find_map(|(k, p)| (k == key).then_some(p)) else {
                        panic!("{}: there is no key `{key}`", path.join("."));
                    };
                    path.push(key.clone());
                    self.walk(value, property, &format!("{name}.{key}"), path, found);
                    path.pop();
                }
            }
            _ => {
                found.push(Node { leaf: format!("{leaf}: {}", kind(schema)), path: path.clone(), schema });
                let Value::Array(items) = value else { return };
                for (index, item) in items.iter().enumerate() {
                    path.push(index.to_string());
                    self.walk(item, &schema["items"], &format!("{leaf}[]"), path, found);
                    path.pop();
                }
            }
        }
    }

    /// The branch of the schema that a value follows.
    fn branch_of<'s>(&'s self, value: &Value, schema: &'s Schema) -> Option<&'s Schema> {
        let schema = resolved(&self.root, schema);
        match branches(schema).filter(|_| !is_word(schema)) {
            None => suits(value, schema).then_some(schema),
            Some(branches) => {
                // Of tables the one whose keys all are known and which lacks none.
                branches.iter().find_map(|branch| self.branch_of(value, branch))
            }
        }
    }
}

/// Whether the value is of this schema's kind; of tables, whether it has the keys of that one.
fn suits(value: &Value, schema: &Schema) -> bool {
    match value {
        Value::Table(table) => {
            let required = schema.get("required").and_then(Schema::as_array);
            kind(schema) == "object"
                && table.keys().all(|key| schema["properties"].get(key).is_some())
                && required.into_iter().flatten().all(|key| table.contains_key(key.as_str().unwrap_or("")))
                && tag(schema).is_none_or(|tag| table["type"].as_str() == Some(tag))
        }
        Value::Array(_) => kind(schema) == "array",
        Value::String(_) => matches!(kind(schema), "string" | "word"),
        Value::Boolean(_) => kind(schema) == "boolean",
        Value::Integer(_) => matches!(kind(schema), "integer" | "number"),
        Value::Float(_) => kind(schema) == "number",
        Value::Datetime(_) => false,
    }
}

fn resolved<'s>(root: &'s Schema, schema: &'s Schema) -> &'s Schema {
    let name = schema.get("$ref").and_then(Schema::as_str).and_then(|path| path.strip_prefix("#/$defs/"));
    name.map_or(schema, |name| &root["$defs"][name])
}

fn branches(schema: &Schema) -> Option<&Vec<Schema>> {
    schema.get("oneOf").or_else(|| schema.get("anyOf"))?.as_array()
}

fn is_word(schema: &Schema) -> bool {
    schema.get("enum").is_some()
        || schema.get("const").is_some()
        || branches(schema).is_some_and(|branches| branches.iter().all(|b| b.get("const").is_some()))
}

/// The kind of values, as JSON schemas call it; `word` for one of a list.
pub fn kind(schema: &Schema) -> &str {
    if is_word(schema) { "word" } else { schema["type"].as_str().unwrap_or("") }
}

fn properties(schema: &Schema) -> impl Iterator<Item = (&String, &Schema)> {
    schema["properties"].as_object().into_iter().flatten()
}

/// The `type` of a table that is told by it.
fn tag(schema: &Schema) -> Option<&str> {
    schema.get("properties")?.get("type")?.get("const")?.as_str()
}

/// The same for tables with the same keys. A material has the same with a name.
fn identity(schema: &Schema) -> String {
    let without_name = |(key, _): &(&String, &Schema)| *key != "name" || tag(schema).is_none();
    let keys: Vec<_> = properties(schema).filter(without_name).map(|(key, p)| format!("{key}{p}")).collect();
    format!("{:?}{}", tag(schema), keys.concat())
}
