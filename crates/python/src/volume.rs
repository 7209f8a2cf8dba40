//! `tyndall.Volume`: a grid from a NumPy array, an xarray or a file.

use std::path::PathBuf;

use glam::{DAffine3, DMat3, DMat4, DVec3};
use numpy::{PyArray1, PyArray2, PyArrayDyn, PyArrayMethods};
use pyo3::prelude::{Bound, PyAny, PyAnyMethods, PyResult, Python, pyclass, pymethods};
use pyo3::types::{PyBytes, PyString, PyTuple};
use tyndall_scene::MemoryGrid;
use tyndall_volumes::{Codec, Grid, GridSelection, GridValues, ReadRequest, VolumeFile, WriteOptions};

use crate::array::grid_values;
use crate::error::{self, wrong};
use crate::units;

/// A grid of numbers in space, to be rendered or to stand where a scene names a file.
///
/// `array[i, j, k]` is the voxel at (x, y, z) = (i, j, k), as in a `.npy` file; an array of shape (X, Y, Z, 3) holds vectors. Any
/// type of integers or floats in any order will do: the array is read where it stands, and only the grid, which leaves out what is
/// the same over 8³ voxels, is new. Later changes of the array do not change the volume. Values that are not finite count as 0.
///
/// `spacing` is the distance between voxels, one or three along x, y, z, and `origin` the place of the first voxel's centre; in scene
/// units, or with units (`"0.5 mm"`). Instead, `index_to_world` is a 4×4 matrix, such as NIfTI's affine. An xarray DataArray with
/// dimensions x, y and z, in any order, says these by its coordinates.
///
/// >>> import numpy, tyndall
/// >>> volume = tyndall.Volume(numpy.ones((8, 16, 8), dtype="uint8"), spacing=0.5)
/// >>> volume
/// <tyndall.Volume `density`, 8x16x8 voxels>
/// >>> volume.index_to_world[0].tolist()
/// [0.5, 0.0, 0.0, 0.0]
#[pyclass(module = "tyndall", frozen)]
#[derive(Debug, Clone)]
pub(crate) struct Volume {
    grid: MemoryGrid,
    /// Whether its world is in metres, and not in the units of the scene that it comes into.
    is_in_metres: bool,
}

impl Volume {
    /// The grid as it is in a scene of this `unit`.
    pub(crate) fn in_scene(&self, unit: &str) -> PyResult<MemoryGrid> {
        Ok(if self.is_in_metres { self.grid.scaled(1.0 / units::metres(unit)?) } else { self.grid.clone() })
    }

    /// Whether both are of the same voxels in the same place.
    pub(crate) fn is_same(&self, other: &Self) -> bool {
        self.grid.is_same(&other.grid) && self.is_in_metres == other.is_in_metres
    }

    fn grid(&self) -> &Grid {
        self.grid.grid()
    }
}

#[pymethods]
impl Volume {
    #[new]
    #[pyo3(signature = (array, *, spacing = None, origin = None, index_to_world = None, name = "density"))]
    fn new(
        array: &Bound<'_, PyAny>,
        spacing: Option<&Bound<'_, PyAny>>,
        origin: Option<&Bound<'_, PyAny>>,
        index_to_world: Option<&Bound<'_, PyAny>>,
        name: &str,
    ) -> PyResult<Self> {
        let py = array.py();
        let mut coordinates = None;
        let mut array = array.clone();
        if array.hasattr("dims")? && array.hasattr("coords")? {
            let has_place = spacing.is_some() || origin.is_some() || index_to_world.is_some();
            let taken =
                py.import("tyndall._xarray")?.call_method1("volume_arguments", (&array, !has_place))?;
            let (values, place): (Bound<'_, PyAny>, Option<Coordinates>) = taken.extract()?;
            (array, coordinates) = (values, place);
        }
        let place = match (coordinates, index_to_world) {
            (Some((spacing, origin, is_in_metres)), _) => Place {
                index_to_world: DAffine3 {
                    matrix3: DMat3::from_diagonal(spacing.into()),
                    translation: origin.into(),
                },
                is_in_metres,
            },
            (None, Some(_)) if spacing.is_some() || origin.is_some() => {
                return Err(wrong("index_to_world: says spacing and origin too; leave these out"));
            }
            (None, Some(matrix)) => Place { index_to_world: affine(matrix)?, is_in_metres: false },
            (None, None) => Place::new(spacing, origin)?,
        };
        let values = grid_values(&array)?;
        let grid = Grid::in_memory(name, place.index_to_world, values);
        Ok(Self { grid: MemoryGrid::new(grid), is_in_metres: place.is_in_metres })
    }

    /// Reads a grid of a volume file: the one of this name, or the one that is most likely a density.
    #[staticmethod]
    #[pyo3(signature = (path, grid = None))]
    fn load(py: Python<'_>, path: PathBuf, grid: Option<String>) -> PyResult<Self> {
        let grids = grid.map_or(GridSelection::All, |name| GridSelection::Names(vec![name]));
        let read = || tyndall_volumes::read(&path, &ReadRequest { grids, raw: None });
        let VolumeFile { grids, .. } = py.detach(read).map_err(error::of_volume)?;
        let (scalars, vectors): (Vec<Grid>, Vec<Grid>) =
            grids.into_iter().partition(|grid| !matches!(grid.values, GridValues::Vec3(_)));
        let grid = tyndall_scene::choose_density(scalars).or_else(|| vectors.into_iter().next());
        let grid = grid.ok_or_else(|| wrong(format!("{}: has no grids", path.display())))?;
        Ok(Self { grid: MemoryGrid::new(grid), is_in_metres: false })
    }

    /// Writes the volume to a file whose extension says the format.
    fn save(&self, py: Python<'_>, path: PathBuf) -> PyResult<PathBuf> {
        let grids = [self.grid().clone()];
        let write = || tyndall_volumes::write(&path, &grids, &WriteOptions::default());
        py.detach(write).map_err(error::of_writing)
    }

    /// The voxels, as a new array of shape (X, Y, Z) or (X, Y, Z, 3).
    #[getter]
    fn array<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArrayDyn<f32>>> {
        let dense = py.detach(|| self.grid().to_array()).map_err(wrong)?;
        let [x, y, z] = dense.shape;
        let values = PyArray1::from_vec(py, dense.values);
        match dense.channels {
            1 => values.reshape(vec![x, y, z]),
            channels => values.reshape(vec![x, y, z, channels]),
        }
    }

    /// Shape of `array`.
    #[getter]
    fn shape<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyTuple>> {
        let [low, high] = self.active_box()?;
        let mut shape: Vec<i64> =
            (0..3).map(|axis| i64::from(high[axis]) - i64::from(low[axis]) + 1).collect();
        if matches!(self.grid().values, GridValues::Vec3(_)) {
            shape.push(3);
        }
        PyTuple::new(py, shape)
    }

    /// The matrix, 4×4, from indices of `array` to the world; voxel centres stand at whole numbers.
    #[getter]
    fn index_to_world<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let [low, _] = self.active_box()?;
        let to_index = DAffine3::from_translation(DVec3::from_array(low.map(f64::from)));
        let matrix = DMat4::from(self.grid().index_to_world * to_index).transpose().to_cols_array();
        PyArray1::from_slice(py, &matrix).reshape([4, 4])
    }

    /// What the grid is called.
    #[getter]
    fn name(&self) -> &str {
        &self.grid().name
    }

    /// Hash of the content.
    #[getter]
    fn hash(&self, py: Python<'_>) -> String {
        py.detach(|| self.grid.hash()).to_string()
    }

    /// All of it, for `from_bytes`.
    fn to_bytes<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyBytes>> {
        let grids = [self.grid().clone()];
        let bytes = py.detach(|| {
            let folder = tempfile::tempdir().map_err(error::file)?;
            let path = folder.path().join("volume.vdb");
            let options = WriteOptions { codec: Codec::default(), half: false };
            tyndall_volumes::write(&path, &grids, &options).map_err(error::of_writing)?;
            let mut bytes = vec![u8::from(self.is_in_metres)];
            bytes.append(&mut std::fs::read(&path).map_err(error::file)?);
            Ok::<_, pyo3::PyErr>(bytes)
        })?;
        Ok(PyBytes::new(py, &bytes))
    }

    /// The volume of `to_bytes`.
    #[staticmethod]
    fn from_bytes(bytes: &[u8]) -> PyResult<Self> {
        let damaged = || wrong("the bytes are not those of a Volume");
        let (is_in_metres, bytes) = bytes.split_first().ok_or_else(damaged)?;
        let read = tyndall_volumes::read_bytes(bytes, "bytes of a Volume".as_ref(), &ReadRequest::default());
        let grid = read.map_err(error::of_volume)?.grids.into_iter().next().ok_or_else(damaged)?;
        Ok(Self { grid: MemoryGrid::new(grid), is_in_metres: *is_in_metres != 0 })
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<(Bound<'py, PyAny>, (Bound<'py, PyBytes>,))> {
        let from_bytes = py.get_type::<Self>().getattr("from_bytes")?;
        Ok((from_bytes, (self.to_bytes(py)?,)))
    }

    fn __repr__(&self) -> String {
        let shape = self.active_box().map_or_else(
            |_| "empty".to_owned(),
            |[low, high]| {
                let edge = |axis: usize| i64::from(high[axis]) - i64::from(low[axis]) + 1;
                format!("{}x{}x{}", edge(0), edge(1), edge(2))
            },
        );
        format!("<tyndall.Volume `{}`, {shape} voxels>", self.grid().name)
    }
}

impl Volume {
    fn active_box(&self) -> PyResult<[[i32; 3]; 2]> {
        let empty = || wrong(format!("the volume `{}` has no active voxels", self.grid().name));
        self.grid().values.statistics().active_bbox.ok_or_else(empty)
    }
}

/// Spacing and origin, and whether they are in metres.
type Coordinates = ([f64; 3], [f64; 3], bool);

/// Where an array stands.
struct Place {
    index_to_world: DAffine3,
    is_in_metres: bool,
}

impl Place {
    fn new(spacing: Option<&Bound<'_, PyAny>>, origin: Option<&Bound<'_, PyAny>>) -> PyResult<Self> {
        let spacing = spacing.map(|given| lengths(given, "spacing")).transpose()?;
        let origin = origin.map(|given| lengths(given, "origin")).transpose()?;
        if let (Some((_, spacing)), Some((_, origin))) = (&spacing, &origin)
            && spacing != origin
        {
            return Err(wrong("spacing and origin: give both as lengths with units, or neither"));
        }
        if origin.is_some_and(|(_, is_in_metres)| is_in_metres) && spacing.is_none() {
            return Err(wrong("origin: has a unit; give `spacing` with one as well"));
        }
        let is_in_metres = spacing.is_some_and(|(_, is_in_metres)| is_in_metres);
        let spacing = spacing.map_or(DVec3::ONE, |(spacing, _)| spacing);
        if spacing.min_element() <= 0.0 {
            return Err(wrong("spacing: must be above 0 along every axis"));
        }
        let translation = origin.map_or(DVec3::ZERO, |(origin, _)| origin);
        let index_to_world = DAffine3 { matrix3: DMat3::from_diagonal(spacing), translation };
        Ok(Self { index_to_world, is_in_metres })
    }
}

/// One length or three, as numbers of scene units or with units, which are then metres.
fn lengths(given: &Bound<'_, PyAny>, key: &str) -> PyResult<(DVec3, bool)> {
    let one = |given: &Bound<'_, PyAny>| -> PyResult<(f64, bool)> {
        if let Ok(text) = given.cast::<PyString>() {
            return Ok((units::length_in_metres(&text.to_string(), key)?, true));
        }
        let metres = units::from_pint(given, key, tyndall_scene::description::Dimension::Length, "m")?;
        let number = metres.as_ref().unwrap_or(given).extract::<f64>();
        let number = number.ok().filter(|number| number.is_finite());
        let number =
            number.ok_or_else(|| wrong(format!("{key}: give a length, or three along x, y and z")))?;
        Ok((number, metres.is_some()))
    };
    if let Ok(number) = one(given) {
        return Ok((DVec3::splat(number.0), number.1));
    }
    if given.cast::<PyString>().is_ok() {
        one(given)?;
    }
    let items: Vec<Bound<'_, PyAny>> = given.try_iter().and_then(Iterator::collect).unwrap_or_default();
    let [x, y, z] = items.as_slice() else {
        return Err(wrong(format!("{key}: give a length, or three along x, y and z")));
    };
    let [x, y, z] = [one(x)?, one(y)?, one(z)?];
    if x.1 != y.1 || y.1 != z.1 {
        return Err(wrong(format!("{key}: give all three as lengths with units, or none")));
    }
    Ok((DVec3::new(x.0, y.0, z.0), x.1))
}

/// A 4×4 matrix, row by row, that is applied to column vectors.
fn affine(given: &Bound<'_, PyAny>) -> PyResult<DAffine3> {
    let refuse = || wrong("index_to_world: give a 4x4 matrix whose last row is 0, 0, 0, 1");
    let rows: Vec<Vec<f64>> =
        given.call_method0("tolist").unwrap_or_else(|_| given.clone()).extract().map_err(|_| refuse())?;
    let numbers: Vec<f64> = rows.concat();
    let numbers: [f64; 16] = numbers.try_into().map_err(|_| refuse())?;
    let matrix = DMat4::from_cols_array(&numbers).transpose();
    if !matrix.is_finite() || matrix.row(3).to_array() != [0.0, 0.0, 0.0, 1.0] {
        return Err(refuse());
    }
    if matrix.determinant() == 0.0 {
        return Err(wrong("index_to_world: is singular: it flattens the volume"));
    }
    Ok(DAffine3::from_mat4(matrix))
}
