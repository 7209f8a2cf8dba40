//! NumPy arrays as slices. Shapes, broadcasting and their messages are Python's part: what arrives here is contiguous.

use glam::DVec3;
use numpy::{PyReadonlyArray1, PyReadonlyArray2, PyUntypedArrayMethods};
use pyo3::PyResult;

use crate::error::wrong;

/// The numbers of a contiguous array.
pub(crate) fn numbers<'a>(name: &str, array: &'a PyReadonlyArray1<f64>) -> PyResult<&'a [f64]> {
    array.as_slice().map_err(|_| wrong(format!("{name}: a contiguous array is needed")))
}

/// The rows of an array of three columns.
pub(crate) fn vectors(name: &str, array: &PyReadonlyArray2<f64>) -> PyResult<Vec<DVec3>> {
    match array.as_slice() {
        Ok(values) if array.shape()[1] == 3 => Ok(values.chunks_exact(3).map(DVec3::from_slice).collect()),
        _ => Err(wrong(format!("{name}: a contiguous array of shape (N, 3) is needed"))),
    }
}

/// The rows of an array of two columns.
pub(crate) fn pairs(name: &str, array: &PyReadonlyArray2<f64>) -> PyResult<Vec<[f64; 2]>> {
    match array.as_slice() {
        Ok(values) if array.shape()[1] == 2 => {
            Ok(values.chunks_exact(2).map(|pair| [pair[0], pair[1]]).collect())
        }
        _ => Err(wrong(format!("{name}: a contiguous array of shape (N, 2) is needed"))),
    }
}
