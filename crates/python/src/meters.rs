//! The meters of a scene, with the command's answer.

use pyo3::prelude::{Bound, PyResult, Python, pyfunction};
use tyndall_session::{read_meters, readings_report};

use crate::effort::Effort;
use crate::error::of_session;
use crate::interrupt::cancellable;
use crate::scene::Scene;

/// The JSON of all readings.
#[pyfunction]
pub(crate) fn meters(py: Python<'_>, scene: &Bound<'_, Scene>, effort: Effort) -> PyResult<String> {
    let (input, ready) = Scene::ready(scene)?;
    let (report, signal) = cancellable(py, |cancel| {
        let options = |number| effort.options(number);
        let scene = &ready.built.scene;
        let readings = read_meters(input.name(), input.description(), scene, options, cancel)?;
        Ok(readings_report(&readings).to_string())
    });
    match signal {
        Some(signal) => Err(signal),
        None => report.map_err(of_session),
    }
}
