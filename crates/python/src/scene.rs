//! `tyndall.Scene`: a scene as a dictionary, as a scene file, or as whatever the command opens.

use std::collections::BTreeMap;
use std::path::PathBuf;
use std::sync::Arc;

use pyo3::exceptions::PyKeyError;
use pyo3::prelude::{
    Bound, Py, PyAny, PyAnyMethods, PyDictMethods, PyResult, Python, pyclass, pyfunction, pymethods,
};
use pyo3::types::{PyDict, PyTuple};
use tyndall_scene::{SceneDescription, SceneDocument, SceneError, content_hash, json_schema};
use tyndall_session::{ImportOptions, Input, InputOptions, ReadyScene};

use crate::error::{of_session, wrong};
use crate::interrupt::abandonable;
use crate::named::name_objects;
use crate::tree::{Reader, to_python};
use crate::volume::Volume;

/// What is rendered: camera, media, surfaces, lights.
///
/// Made of a dictionary with the keys of a scene file (`schema` tells them all). Values may be NumPy arrays; a `Volume` may stand
/// where a volume's `file` would. Lists of objects may be dictionaries by name, or a single object. Where a length, a quantity per
/// length or an angle is wanted, text with a unit (`"0.3 1/mm"`) and quantities of pint will do; numbers are in units of the scene
/// (`unit`, metres unless given).
///
/// >>> import tyndall
/// >>> scene = tyndall.Scene({
/// ...     "unit": "mm",
/// ...     "camera": {"position": [0, 0, "1 cm"], "target": [0, 0, 0]},
/// ...     "volume": {"milk": {"sphere": {"center": [0, 0, 0], "radius": 1}, "preset": "wholemilk"}},
/// ...     "light": [{"type": "constant", "radiance": 1}],
/// ... })
/// >>> scene["camera.position"]
/// [0.0, 0.0, 10.0]
/// >>> scene["camera.vertical_fov"] = 30
#[pyclass(module = "tyndall")]
#[derive(Debug, Clone)]
pub(crate) struct Scene {
    input: Input,
    volumes: BTreeMap<String, Volume>,
    /// Built when it is first needed, until something is changed.
    ready: Option<Arc<ReadyScene>>,
}

impl Scene {
    fn new(input: Input, volumes: BTreeMap<String, Volume>) -> PyResult<Self> {
        let unit = &input.description().unit;
        let grids = volumes.iter().map(|(name, volume)| Ok((name.clone(), volume.in_scene(unit)?)));
        let grids = grids.collect::<PyResult<BTreeMap<_, _>>>()?;
        Ok(Self { input: input.with_grids(grids), volumes, ready: None })
    }

    fn from_tree(
        table: toml::Table,
        volumes: BTreeMap<String, Volume>,
        folder: PathBuf,
        name: &str,
    ) -> PyResult<Self> {
        let description = SceneDocument::from_table(table).description().map_err(all_problems)?;
        Self::new(Input::from_description(name, description, folder), volumes)
    }

    /// The scene as it is now, and ready to trace.
    pub(crate) fn ready(this: &Bound<'_, Self>) -> PyResult<(Input, Arc<ReadyScene>)> {
        let Self { input, ready, .. } = this.borrow().clone();
        if let Some(ready) = ready {
            return Ok((input, ready));
        }
        let build = input.clone();
        let ready = Arc::new(abandonable(this.py(), move || build.ready())?.map_err(of_session)?);
        // Others may have changed it meanwhile, or be looking at it.
        if let Ok(mut scene) = this.try_borrow_mut()
            && scene.input.description() == input.description()
        {
            scene.ready = Some(Arc::clone(&ready));
        }
        Ok((input, ready))
    }

    fn tree(&self) -> PyResult<toml::Table> {
        toml::Table::try_from(self.input.description()).map_err(wrong)
    }
}

#[pymethods]
impl Scene {
    #[new]
    fn from_dict(scene: &Bound<'_, PyAny>) -> PyResult<Self> {
        if let Ok(scene) = scene.cast::<Self>() {
            return Ok(scene.borrow().clone());
        }
        let Ok(scene) = scene.cast::<pyo3::types::PyMapping>() else {
            return Err(wrong("a scene is a dictionary; tyndall.load opens files"));
        };
        let unit: Option<String> = match scene.contains("unit")? {
            true => Some(scene.get_item("unit")?.extract().map_err(|_| wrong("unit: must be a string"))?),
            false => None,
        };
        let mut reader = Reader::new(unit.as_deref().unwrap_or("m"), BTreeMap::new());
        let table = name_objects(&mut reader, scene)?;
        // Names of files must go on to mean the same files.
        let folder = std::env::current_dir().unwrap_or_default();
        Self::from_tree(table, reader.volumes, folder, "scene")
    }

    /// Opens whatever can be rendered; without a path, the built-in scene.
    #[staticmethod]
    #[pyo3(signature = (path = None, frame = None, define = BTreeMap::new(), strict = false))]
    fn load(
        py: Python<'_>,
        path: Option<PathBuf>,
        frame: Option<u32>,
        define: BTreeMap<String, String>,
        strict: bool,
    ) -> PyResult<Self> {
        let import = ImportOptions { strict, define: define.into_iter().collect() };
        let options = InputOptions { import, frame, ..InputOptions::default() };
        let open = || match &path {
            Some(path) => Input::open(path, &options),
            None => Input::built_in(&[]),
        };
        let input = py.detach(open).map_err(of_session)?;
        Self::new(input, BTreeMap::new())
    }

    /// The scene that is the text of a scene file.
    #[staticmethod]
    #[pyo3(signature = (text, folder = None, volumes = None))]
    fn from_toml(
        text: &str,
        folder: Option<PathBuf>,
        volumes: Option<BTreeMap<String, Py<Volume>>>,
    ) -> PyResult<Self> {
        let folder = folder.unwrap_or_else(|| std::env::current_dir().unwrap_or_default());
        let input = Input::from_text("scene", text, folder, &[]).map_err(of_session)?;
        let volumes = volumes.unwrap_or_default().into_iter();
        Self::new(input, volumes.map(|(name, volume)| (name, volume.get().clone())).collect())
    }

    /// The scene of a bare volume: camera, light and density are chosen from its values.
    #[staticmethod]
    fn of_volume(py: Python<'_>, volume: Py<Volume>) -> PyResult<Self> {
        let volume = volume.get().clone();
        let name = "<volume 0>";
        // A scene made up has metres for its unit.
        let grid = volume.in_scene("m")?;
        let input = py.detach(|| Input::from_grid(name, grid)).map_err(of_session)?;
        Self::new(input, BTreeMap::from([(name.to_owned(), volume)]))
    }

    /// The scene of another frame of the animation that was loaded with a `frame`.
    fn at_frame(&self, frame: u32) -> PyResult<Self> {
        Self::new(self.input.at_frame(frame).map_err(of_session)?, self.volumes.clone())
    }

    /// All of it as dictionaries, lists and numbers.
    fn to_dict<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        to_python(py, &toml::Value::Table(self.tree()?), &self.volumes)
    }

    /// All of it as the text of a scene file. Volumes in memory have names such as `<volume 0>` in it: for a file, save them
    /// first and name the files.
    fn to_toml(&self) -> String {
        self.input.to_toml()
    }

    fn __getitem__<'py>(&self, py: Python<'py>, path: &str) -> PyResult<Bound<'py, PyAny>> {
        let tree = toml::Value::Table(self.tree()?);
        let mut value = &tree;
        for key in path.split('.') {
            let inner = match value {
                toml::Value::Table(table) => table.get(key),
                toml::Value::Array(items) => key.parse().ok().and_then(|index: usize| items.get(index)),
                _ => None,
            };
            value = inner.ok_or_else(|| PyKeyError::new_err(path.to_owned()))?;
        }
        to_python(py, value, &self.volumes)
    }

    fn __setitem__(&mut self, path: &str, value: &Bound<'_, PyAny>) -> PyResult<()> {
        let keys: Vec<&str> = path.split('.').collect();
        let mut reader = Reader::new(&self.input.description().unit, self.volumes.clone());
        let Some(value) = reader.value(value, &keys)? else {
            return Err(wrong(format!("{path}: is None; give a value")));
        };
        let mut document = SceneDocument::from_table(self.tree()?);
        document.set_value(path, value).map_err(all_problems)?;
        let description = document.description().map_err(all_problems)?;
        let mut input = self.input.clone();
        *input.description_mut() = description;
        *self = Self::new(input, reader.volumes)?;
        Ok(())
    }

    fn __contains__(&self, py: Python<'_>, path: &str) -> bool {
        self.__getitem__(py, path).is_ok()
    }

    /// A scene of its own that can be changed without changing this one.
    fn copy(&self) -> Self {
        self.clone()
    }

    fn __copy__(&self) -> Self {
        self.clone()
    }

    fn __deepcopy__(&self, _memo: &Bound<'_, PyAny>) -> Self {
        self.clone()
    }

    /// Hash of all that decides the expected picture, files and volumes included.
    #[getter]
    fn hash(&self, py: Python<'_>) -> PyResult<String> {
        let hash = match &self.ready {
            Some(ready) => ready.hash,
            None => py.detach(|| self.input.scene_hash()).map_err(of_session)?,
        };
        Ok(hash.to_string())
    }

    /// The files that the scene names: as it names them, and where they are.
    #[getter]
    fn files(&self) -> BTreeMap<String, PathBuf> {
        let mut description = self.input.description().clone();
        let names = description.files_mut().into_iter().map(|name| name.clone());
        let names = names.filter(|name| !self.volumes.contains_key(name));
        names.map(|name| (name.clone(), self.input.folder().join(name))).collect()
    }

    /// The volumes that stand for files, by their names.
    #[getter]
    fn volumes(&self) -> BTreeMap<String, Volume> {
        self.volumes.clone()
    }

    /// What was guessed, and what is not as in the renderer that the scene is for; one line each.
    #[getter]
    fn notes(&self) -> Vec<String> {
        self.input.notes().to_vec()
    }

    /// The scene as text and files, from which it can be made anew elsewhere: the text names each file by a hash of its
    /// content and its name, `HASH/cloud.vdb`; then where they are now; then the volumes in memory.
    fn to_parts<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyTuple>> {
        let (text, files) = py.detach(|| self.parts()).map_err(wrong)?;
        let paths = PyDict::new(py);
        for (name, path) in files {
            paths.set_item(name, path)?;
        }
        PyTuple::new(
            py,
            [
                pyo3::IntoPyObjectExt::into_bound_py_any(text, py)?,
                paths.into_any(),
                pyo3::IntoPyObjectExt::into_bound_py_any(self.volumes.clone(), py)?,
            ],
        )
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<(Bound<'py, PyAny>, Bound<'py, PyTuple>)> {
        let module = py.import("tyndall._files")?;
        let parts = module.call_method1("contents", (self.to_parts(py)?,))?;
        Ok((module.getattr("scene")?, parts.cast_into::<PyTuple>()?))
    }

    fn __repr__(&self) -> String {
        let description = self.input.description();
        let SceneDescription { volumes, shapes, lights, .. } = description;
        let [width, height] = description.film.picture_size();
        let count = |count: usize, what: &str| match count {
            0 => String::new(),
            1 => format!(", 1 {what}"),
            count => format!(", {count} {what}s"),
        };
        format!(
            "<tyndall.Scene {width}x{height}{}{}{}>",
            count(volumes.len(), "volume"),
            count(shapes.len(), "shape"),
            count(lights.len(), "light")
        )
    }
}

impl Scene {
    fn parts(&self) -> Result<(String, BTreeMap<String, PathBuf>), SceneError> {
        let mut description = self.input.description().clone();
        let mut files = BTreeMap::new();
        for name in description.files_mut() {
            if self.volumes.contains_key(name) {
                continue;
            }
            let path = self.input.folder().join(&*name);
            let file_name = path.file_name().unwrap_or_default().to_string_lossy();
            let content = format!("{}/{file_name}", content_hash(&path)?);
            files.insert(content.clone(), path);
            *name = content;
        }
        Ok((description.to_toml(), files))
    }
}

/// All that is wrong, not only the first: a program has no place to look the others up.
fn all_problems(error: SceneError) -> pyo3::PyErr {
    let problems: Vec<String> = error.problems().iter().map(ToString::to_string).collect();
    wrong(problems.join("; "))
}

/// The JSON schema of scenes, as text.
#[pyfunction]
pub(crate) fn schema() -> String {
    json_schema().to_string()
}
