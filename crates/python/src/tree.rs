//! From Python's objects to the values of a scene, and back.
//!
//! Dictionaries are tables, sequences and NumPy arrays are arrays, `None` is a key that is not there. A quantity with a unit
//! becomes a number where a length, a quantity per length or an angle is wanted, and a [`Volume`] may stand where a `file` would.

use std::collections::BTreeMap;

use pyo3::prelude::{Bound, PyAny, PyAnyMethods, PyDictMethods, PyListMethods, PyResult, Python};
use pyo3::types::{PyBool, PyDict, PyFloat, PyInt, PyList, PyMapping, PyString};
use pyo3::{BoundObject, IntoPyObject, IntoPyObjectExt};
use tyndall_scene::description::{Dimension, dimension};

use crate::error::wrong;
use crate::units;
use crate::volume::Volume;

/// Deeper than any scene; a list that holds itself is endless.
const DEEPEST: usize = 24;

/// Reads what a user wrote as Python's objects.
pub(crate) struct Reader {
    unit: String,
    /// The volumes that were met, by the names that stand for them.
    pub(crate) volumes: BTreeMap<String, Volume>,
}

impl Reader {
    /// For a scene of a unit, some volumes of which are known already.
    pub(crate) fn new(unit: &str, volumes: BTreeMap<String, Volume>) -> Self {
        Self { unit: unit.to_owned(), volumes }
    }

    /// The value at a path of keys; `None` if it is Python's `None`.
    pub(crate) fn value(
        &mut self,
        object: &Bound<'_, PyAny>,
        path: &[&str],
    ) -> PyResult<Option<toml::Value>> {
        if path.len() > DEEPEST {
            return Err(wrong(format!("{}: is nested deeper than any scene", shown(&path[..4]))));
        }
        if object.is_none() {
            return Ok(None);
        }
        if let Ok(volume) = object.cast::<Volume>() {
            return self.volume(volume.get(), path).map(Some);
        }
        let value = if let Ok(text) = object.cast::<PyString>() {
            self.text(&text.to_string(), path)?
        } else if let Ok(flag) = object.cast::<PyBool>() {
            toml::Value::Boolean(flag.extract()?)
        } else if let Ok(number) = object.cast::<PyFloat>() {
            toml::Value::Float(number.extract()?)
        } else if let Ok(number) = object.cast::<PyInt>() {
            let number = number.extract::<i64>();
            toml::Value::Integer(
                number.map_err(|_| wrong(format!("{}: is too large an integer", shown(path))))?,
            )
        } else if let Ok(table) = object.cast::<PyMapping>() {
            toml::Value::Table(self.table(table.as_any(), path)?)
        } else if let Some(number) = units::from_pint(object, &shown(path), dimension_of(path), &self.unit)? {
            return self.value(&number, path);
        } else {
            return self.other(object, path);
        };
        Ok(Some(value))
    }

    fn table(&mut self, table: &Bound<'_, PyAny>, path: &[&str]) -> PyResult<toml::Table> {
        let mut read = toml::Table::new();
        for item in table.call_method0("items")?.try_iter()? {
            let (key, value): (Bound<'_, PyAny>, Bound<'_, PyAny>) = item?.extract()?;
            let Ok(key) = key.cast::<PyString>() else {
                return Err(wrong(format!("{}: keys are strings, not {key}", shown(path))));
            };
            let key = key.to_string();
            if let Some(value) = self.value(&value, &[path, &[key.as_str()]].concat())? {
                read.insert(key, value);
            }
        }
        Ok(read)
    }

    /// Arrays and scalars of NumPy, sequences, paths.
    fn other(&mut self, object: &Bound<'_, PyAny>, path: &[&str]) -> PyResult<Option<toml::Value>> {
        if object.hasattr("__fspath__")? {
            let text: Bound<'_, PyAny> = object.call_method0("__fspath__")?;
            return self.value(&text, path);
        }
        if object.hasattr("tolist")? {
            return self.value(&object.call_method0("tolist")?, path);
        }
        let Ok(items) = object.try_iter() else {
            let kind = object.get_type().to_string();
            return Err(wrong(format!("{}: {kind} is nothing that a scene holds", shown(path))));
        };
        let mut read = Vec::new();
        for (index, item) in items.enumerate() {
            let index = index.to_string();
            let item = self.value(&item?, &[path, &[index.as_str()]].concat())?;
            read.push(item.ok_or_else(|| wrong(format!("{}.{index}: is None; leave it out", shown(path))))?);
        }
        Ok(Some(toml::Value::Array(read)))
    }

    fn text(&self, text: &str, path: &[&str]) -> PyResult<toml::Value> {
        Ok(match dimension_of(path) {
            Dimension::Plain => toml::Value::String(text.to_owned()),
            dimension => toml::Value::Float(units::from_text(text, &shown(path), dimension, &self.unit)?),
        })
    }

    fn volume(&mut self, volume: &Volume, path: &[&str]) -> PyResult<toml::Value> {
        if path.last() != Some(&"file") {
            let message = format!("{}: a Volume stands where the name of a `file` would", shown(path));
            return Err(wrong(message));
        }
        let known = self.volumes.iter().find(|(_, known)| known.is_same(volume));
        let name = match known {
            Some((name, _)) => name.clone(),
            None => {
                let name = format!("<volume {}>", self.volumes.len());
                self.volumes.insert(name.clone(), volume.clone());
                name
            }
        };
        Ok(toml::Value::String(name))
    }
}

/// The path as messages show it.
pub(crate) fn shown(path: &[&str]) -> String {
    if path.is_empty() { "scene".to_owned() } else { path.join(".") }
}

/// Places in arrays are no keys.
fn dimension_of(path: &[&str]) -> Dimension {
    let keys: Vec<&str> = path.iter().filter(|key| key.parse::<usize>().is_err()).copied().collect();
    dimension(&keys)
}

/// A value of a scene as Python's own objects; volumes stand where their names do.
pub(crate) fn to_python<'py>(
    py: Python<'py>,
    value: &toml::Value,
    volumes: &BTreeMap<String, Volume>,
) -> PyResult<Bound<'py, PyAny>> {
    Ok(match value {
        toml::Value::String(text) => match volumes.get(text) {
            Some(volume) => volume.clone().into_bound_py_any(py)?,
            None => text.into_bound_py_any(py)?,
        },
        toml::Value::Integer(number) => number.into_bound_py_any(py)?,
        toml::Value::Float(number) => number.into_bound_py_any(py)?,
        toml::Value::Boolean(flag) => PyBool::new(py, *flag).into_bound().into_any(),
        toml::Value::Datetime(date) => date.to_string().into_pyobject(py)?.into_any(),
        toml::Value::Array(items) => {
            let list = PyList::empty(py);
            for item in items {
                list.append(to_python(py, item, volumes)?)?;
            }
            list.into_any()
        }
        toml::Value::Table(table) => {
            let dict = PyDict::new(py);
            for (key, value) in table {
                dict.set_item(key, to_python(py, value, volumes)?)?;
            }
            dict.into_any()
        }
    })
}
