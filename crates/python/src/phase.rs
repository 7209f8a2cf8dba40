//! Phase functions: their values, mean cosines and samples, over arrays.

use glam::DVec3;
use numpy::ndarray::Array2;
use numpy::{IntoPyArray, PyArray1, PyArray2, PyReadonlyArray1, PyReadonlyArray2};
use pyo3::prelude::{Bound, PyResult, Python, pyclass, pymethods};
use tyndall_lanes::Random;
use tyndall_scene::{MieSpheres, PhaseCurve};

use crate::error::wrong;
use crate::slices::{numbers, pairs, vectors};

/// A phase function in one line, for light that arrives in one direction.
#[pyclass(frozen, module = "tyndall.phase")]
pub(crate) struct PhaseFunction {
    curve: PhaseCurve,
    note: Option<String>,
    incidence: Option<[f64; 3]>,
}

impl PhaseFunction {
    /// The phase function for all directions.
    pub(crate) fn phase_function(&self) -> &tyndall_optics::PhaseFunction {
        self.curve.phase_function()
    }

    fn spheres(&self) -> Option<&MieSpheres> {
        self.curve.spheres()
    }
}

#[pymethods]
impl PhaseFunction {
    #[new]
    #[pyo3(signature = (spec, incidence=None))]
    fn new(py: Python<'_>, spec: &str, incidence: Option<[f64; 3]>) -> PyResult<Self> {
        let direction = match incidence.map(|vector| DVec3::from_array(vector).try_normalize()) {
            Some(None) => return Err(wrong("incidence: write a direction of three numbers, not all 0")),
            direction => direction.flatten(),
        };
        // Lorenz-Mie theory of many droplets takes seconds.
        let (curve, note) = py.detach(|| PhaseCurve::read(spec, direction)).map_err(wrong)?;
        if incidence.is_some() && curve.projected_area().is_none() {
            let message = format!("incidence: `{spec}` does not depend on it; leave it out, or give an sggx");
            return Err(wrong(message));
        }
        Ok(Self { curve, note, incidence })
    }

    fn __getnewargs__(&self) -> (String, Option<[f64; 3]>) {
        (self.curve.name().to_owned(), self.incidence)
    }

    fn __repr__(&self) -> String {
        format!("PhaseFunction({:?})", self.curve.name())
    }

    #[getter]
    fn spec(&self) -> &str {
        self.curve.name()
    }

    #[getter]
    fn note(&self) -> Option<&str> {
        self.note.as_deref()
    }

    #[getter]
    fn has_incidence(&self) -> bool {
        self.incidence.is_some()
    }

    #[getter]
    fn mean_cosine(&self) -> f64 {
        self.curve.mean_cosine()
    }

    #[getter]
    fn projected_area(&self) -> Option<f64> {
        self.curve.projected_area()
    }

    #[getter]
    fn q_ext(&self) -> Option<f64> {
        self.spheres().map(|spheres| spheres.average.q_ext)
    }

    #[getter]
    fn q_sca(&self) -> Option<f64> {
        self.spheres().map(|spheres| spheres.average.q_sca)
    }

    #[getter]
    fn q_abs(&self) -> Option<f64> {
        self.spheres().map(|spheres| spheres.average.q_abs)
    }

    #[getter]
    fn q_back(&self) -> Option<f64> {
        self.spheres().and_then(|spheres| spheres.single.as_ref()).map(|sphere| sphere.q_back)
    }

    #[getter]
    fn albedo(&self) -> Option<f64> {
        self.spheres().map(|spheres| spheres.average.albedo())
    }

    /// Values at cosines.
    fn values<'py>(
        &self,
        py: Python<'py>,
        cos_theta: PyReadonlyArray1<'py, f64>,
    ) -> PyResult<Bound<'py, PyArray1<f64>>> {
        let cosines = numbers("cos_theta", &cos_theta)?;
        let values: Vec<f64> = py.detach(|| cosines.iter().map(|&c| self.curve.value_at_cosine(c)).collect());
        Ok(values.into_pyarray(py))
    }

    /// Cosines drawn with the random numbers of a seed.
    fn cosines_of_seed<'py>(&self, py: Python<'py>, n: usize, seed: u64) -> Bound<'py, PyArray1<f64>> {
        let draw = |sample: usize| {
            let mut random = Random::new(seed, 0, sample as u64);
            self.curve.sample_cosine([random.f64(), random.f64()])
        };
        let cosines: Vec<f64> = py.detach(|| (0..n).map(draw).collect());
        cosines.into_pyarray(py)
    }

    /// Cosines that pairs of numbers in [0, 1) draw.
    fn cosines<'py>(
        &self,
        py: Python<'py>,
        u: PyReadonlyArray2<'py, f64>,
    ) -> PyResult<Bound<'py, PyArray1<f64>>> {
        let u = pairs("u", &u)?;
        let cosines: Vec<f64> = py.detach(|| u.iter().map(|&u| self.curve.sample_cosine(u)).collect());
        Ok(cosines.into_pyarray(py))
    }

    /// Values between directions.
    fn values_between<'py>(
        &self,
        py: Python<'py>,
        before: PyReadonlyArray2<'py, f64>,
        after: PyReadonlyArray2<'py, f64>,
    ) -> PyResult<Bound<'py, PyArray1<f64>>> {
        let (before, after) = (vectors("before", &before)?, vectors("after", &after)?);
        let phase = self.phase_function();
        let pairs = before.iter().zip(&after);
        let values: Vec<f64> =
            py.detach(|| pairs.map(|(before, after)| phase.value(*before, *after)).collect());
        Ok(values.into_pyarray(py))
    }

    /// Directions after scattering that pairs of numbers in [0, 1) draw.
    fn directions<'py>(
        &self,
        py: Python<'py>,
        before: PyReadonlyArray2<'py, f64>,
        u: PyReadonlyArray2<'py, f64>,
    ) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let (before, u) = (vectors("before", &before)?, pairs("u", &u)?);
        let phase = self.phase_function();
        let drawn = |(before, u): (&DVec3, &[f64; 2])| phase.sample(*before, *u).to_array();
        let directions: Vec<f64> = py.detach(|| before.iter().zip(&u).flat_map(drawn).collect());
        let rows = directions.len() / 3;
        let directions = Array2::from_shape_vec((rows, 3), directions).map_err(wrong)?;
        Ok(directions.into_pyarray(py))
    }
}
