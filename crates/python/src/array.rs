//! NumPy arrays as the values of a grid, whatever their type and order.
//!
//! An array `a` of shape (X, Y, Z) has `a[i, j, k]` at voxel (i, j, k) = (x, y, z), as in a `.npy` file, and one of shape
//! (X, Y, Z, 3) holds vectors. It is read where it stands, with any strides: the grid's tree is the only copy.

use half::f16;
use numpy::ndarray::{Ix3, Ix4};
use numpy::{Element, PyArrayDyn, PyArrayMethods, PyUntypedArray, PyUntypedArrayMethods};
use pyo3::prelude::{Bound, PyAny, PyAnyMethods, PyResult};
use tyndall_volumes::{GridValues, tree_of_array};

use crate::error::wrong;

/// More voxels than any memory has room for; an array of strides 0 may claim them.
const MOST_VOXELS: usize = 1 << 34;

/// The values of anything that NumPy makes an array of.
pub(crate) fn grid_values(given: &Bound<'_, PyAny>) -> PyResult<GridValues> {
    let array = given.py().import("numpy")?.call_method1("asarray", (given,))?;
    let array = plain(&array)?;
    let kind: String = array.getattr("dtype")?.getattr("str")?.extract()?;
    match kind.get(1..).unwrap_or_default() {
        "f2" => floats(&array, f16::to_f32),
        "f4" => floats(&array, |number: f32| number),
        "u1" => floats(&array, |number: u8| number.into()),
        "u2" => floats(&array, |number: u16| number.into()),
        "i1" => floats(&array, |number: i8| number.into()),
        "i2" => floats(&array, |number: i16| number.into()),
        // NumPy's booleans may be bytes other than 0 and 1, which Rust's may not.
        "b1" => floats(&array.call_method1("view", ("uint8",))?, |number: u8| f32::from(number != 0)),
        "f8" => doubles(&array, |number: f64| number),
        "u4" => doubles(&array, |number: u32| number.into()),
        "i4" => doubles(&array, |number: i32| number.into()),
        // As far as 53 bits tell them apart.
        "u8" => doubles(&array, |number: u64| number as f64),
        "i8" => doubles(&array, |number: i64| number as f64),
        _ => {
            let name = array.getattr("dtype")?.str()?;
            Err(wrong(format!("an array of type `{name}` is no volume; give it .astype('float32')")))
        }
    }
}

/// The array in this machine's order of bytes, each number where the processor wants it.
fn plain<'py>(array: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
    let dtype = array.getattr("dtype")?;
    let is_native: bool = dtype.getattr("isnative")?.extract()?;
    let is_aligned: bool = array.getattr("flags")?.getattr("aligned")?.extract()?;
    if is_native && is_aligned {
        return Ok(array.clone());
    }
    array.call_method1("astype", (dtype.call_method1("newbyteorder", ("=",))?,))
}

/// Of numbers that 32-bit floats hold exactly.
fn floats<T: Element + Copy>(array: &Bound<'_, PyAny>, convert: fn(T) -> f32) -> PyResult<GridValues> {
    match dense(array, convert)? {
        Values::Scalars(tree) => Ok(GridValues::Float(tree)),
        Values::Vectors(values) => Ok(values),
    }
}

fn doubles<T: Element + Copy>(array: &Bound<'_, PyAny>, convert: fn(T) -> f64) -> PyResult<GridValues> {
    match dense(array, convert)? {
        Values::Scalars(tree) => Ok(GridValues::Double(tree)),
        Values::Vectors(values) => Ok(values),
    }
}

enum Values<V> {
    Scalars(tyndall_volumes::Tree<V>),
    Vectors(GridValues),
}

fn dense<T: Element + Copy, V: Copy + Default + PartialEq + Into<f64>>(
    array: &Bound<'_, PyAny>,
    convert: fn(T) -> V,
) -> PyResult<Values<V>> {
    let untyped = array.cast::<PyUntypedArray>()?;
    let shape = untyped.shape().to_vec();
    if shape.iter().fold(1, |count: usize, edge| count.saturating_mul(*edge)) > MOST_VOXELS {
        return Err(wrong(format!("an array of shape {shape:?} is too large for any memory")));
    }
    let refuse = || {
        wrong(format!(
            "an array of {} axes {shape:?} is no volume; give one of shape (X, Y, Z) or (X, Y, Z, 3)",
            shape.len()
        ))
    };
    let numbers = array.cast::<PyArrayDyn<T>>()?.try_readonly().map_err(wrong)?;
    let numbers = numbers.as_array();
    match *shape.as_slice() {
        [x, y, z] => {
            let numbers = numbers.into_dimensionality::<Ix3>().map_err(|_| refuse())?;
            let tree = tree_of_array([x, y, z], |voxel| convert(numbers[voxel]));
            Ok(Values::Scalars(tree.map_err(wrong)?))
        }
        [x, y, z, channels @ (1 | 3)] => {
            let numbers = numbers.into_dimensionality::<Ix4>().map_err(|_| refuse())?;
            if channels == 1 {
                let tree = tree_of_array([x, y, z], |[x, y, z]| convert(numbers[[x, y, z, 0]]));
                return Ok(Values::Scalars(tree.map_err(wrong)?));
            }
            let number = |x, y, z, channel| convert(numbers[[x, y, z, channel]]).into() as f32;
            let tree = tree_of_array([x, y, z], |[x, y, z]| [0, 1, 2].map(|c| number(x, y, z, c)));
            Ok(Values::Vectors(GridValues::Vec3(tree.map_err(wrong)?)))
        }
        _ => Err(refuse()),
    }
}
