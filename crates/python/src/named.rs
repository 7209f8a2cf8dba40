//! The top of a scene: its lists may be dictionaries of named objects, as scenes of other programs have them.
//!
//! ```text
//! {"light": [{"type": "sun", …}, {"type": "sky"}]}      as in a scene file
//! {"light": {"type": "sky"}}                            the only one
//! {"light": {"sun": {"type": "sun", …}, "sky": {…}}}    by names, which become the objects' `name` if they can have one
//! ```

use std::collections::BTreeSet;
use std::sync::LazyLock;

use pyo3::prelude::{Bound, PyAny, PyAnyMethods, PyResult};
use pyo3::types::{PyMapping, PyMappingMethods};
use serde_json::Value;
use tyndall_scene::json_schema;

use crate::error::wrong;
use crate::tree::Reader;

/// The keys of a scene that hold lists of objects, with the keys that their objects can have.
static LISTS: LazyLock<Vec<(String, BTreeSet<String>)>> = LazyLock::new(|| {
    let schema = json_schema();
    let properties = schema["properties"].as_object().into_iter().flatten();
    let lists = properties.filter(|(_, property)| property["type"] == "array");
    lists
        .map(|(key, property)| {
            let mut keys = BTreeSet::new();
            gather(&property["items"], &schema, &mut keys);
            (key.clone(), keys)
        })
        .collect()
});

fn gather(object: &Value, root: &Value, keys: &mut BTreeSet<String>) {
    if let Some(name) = object["$ref"].as_str().and_then(|path| path.strip_prefix("#/$defs/")) {
        return gather(&root["$defs"][name], root, keys);
    }
    keys.extend(object["properties"].as_object().into_iter().flat_map(|object| object.keys().cloned()));
    for branch in ["oneOf", "anyOf"].iter().filter_map(|key| object[key].as_array()).flatten() {
        gather(branch, root, keys);
    }
}

/// Reads a whole scene.
pub(crate) fn name_objects(reader: &mut Reader, scene: &Bound<'_, PyMapping>) -> PyResult<toml::Table> {
    let mut read = toml::Table::new();
    for item in scene.items()?.try_iter()? {
        let (key, value): (Bound<'_, PyAny>, Bound<'_, PyAny>) = item?.extract()?;
        let key: String = key.extract().map_err(|_| wrong(format!("scene: keys are strings, not {key}")))?;
        // As the scenes of others are marked.
        if key == "type" && value.extract::<String>().is_ok_and(|value| value == "scene") {
            continue;
        }
        let list = LISTS.iter().find(|(list, _)| *list == key);
        let value = match (list, value.cast::<PyMapping>()) {
            (Some((_, keys)), Ok(objects)) => Some(list_of(reader, &key, objects, keys)?),
            _ => reader.value(&value, &[key.as_str()])?,
        };
        if let Some(value) = value {
            read.insert(key, value);
        }
    }
    Ok(read)
}

fn list_of(
    reader: &mut Reader,
    list: &str,
    objects: &Bound<'_, PyMapping>,
    keys: &BTreeSet<String>,
) -> PyResult<toml::Value> {
    let mut named = Vec::new();
    // The objects of a list with types have one each, which is no table.
    let has_types = keys.contains("type");
    let mut is_single = !has_types;
    let mut has_plain = false;
    for item in objects.items()?.try_iter()? {
        let (name, object): (Bound<'_, PyAny>, Bound<'_, PyAny>) = item?.extract()?;
        let name = name.str()?.to_string();
        is_single &= keys.contains(&name);
        has_plain |= object.cast::<PyMapping>().is_err();
        named.push((name, object));
    }
    let mut items = Vec::new();
    if is_single || has_plain {
        items.extend(reader.value(objects.as_any(), &[list, "0"])?);
        return Ok(toml::Value::Array(items));
    }
    for (index, (name, object)) in named.iter().enumerate() {
        let index = index.to_string();
        let Some(mut item) = reader.value(object, &[list, index.as_str()])? else { continue };
        if let toml::Value::Table(table) = &mut item
            && keys.contains("name")
            && !table.contains_key("name")
        {
            table.insert("name".into(), name.clone().into());
        }
        items.push(item);
    }
    Ok(toml::Value::Array(items))
}
