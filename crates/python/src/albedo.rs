//! Albedos of media by how bright a thick layer of them looks.

use numpy::{IntoPyArray, PyArray1, PyReadonlyArray1};
use pyo3::prelude::{Bound, PyResult, Python, pyfunction};

use crate::slices::numbers;

/// The albedo of a medium, for each of the fractions of diffuse light that a half-space of it reflects.
#[pyfunction]
pub(crate) fn albedo_of_reflectance<'py>(
    py: Python<'py>,
    reflectance: PyReadonlyArray1<'py, f64>,
    g: f64,
) -> PyResult<Bound<'py, PyArray1<f64>>> {
    let invert = |&reflectance: &f64| tyndall_optics::albedo_inversion::albedo_of_reflectance(reflectance, g);
    let albedo: Vec<f64> = numbers("reflectance", &reflectance)?.iter().map(invert).collect();
    Ok(albedo.into_pyarray(py))
}
