//! `tyndall.Accumulation`: the exact sums of some samples, to be added to those of other samples of the same picture.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use numpy::PyArrayDyn;
use pyo3::prelude::{Bound, PyAny, PyAnyMethods, PyRef, PyResult, Python, pyclass, pymethods};
use pyo3::types::PyBytes;
use tyndall_film::Accumulation as Sums;

use crate::error::{of_picture, wrong};
use crate::pixels;

/// The exact sums of a picture's samples, to be added to those of other samples: in any split and order, the same bits.
///
/// >>> import tyndall
/// >>> scene = tyndall.Scene({"camera": {"position": [0, 0, 0], "direction": [0, 0, 1]}, "film": {"resolution": [8, 8]},
/// ...     "medium": {"mu_t": 1, "albedo": 0.5}, "light": {"type": "constant", "radiance": 1}})
/// >>> first = tyndall.render(scene, samples=(0, 3), progress=False).accumulation
/// >>> second = tyndall.render(scene, samples=(3, 8), progress=False).accumulation
/// >>> (first + second).samples
/// [(0, 8)]
/// >>> first + second == tyndall.render(scene, spp=8, progress=False).accumulation
/// True
#[pyclass(module = "tyndall")]
#[derive(Debug, Clone)]
pub(crate) struct Accumulation {
    /// A single one, in the vector that a `Render` holds too: they share it until samples are added.
    pictures: Arc<Vec<Sums>>,
}

impl Accumulation {
    /// The sums of a picture that is one film.
    pub(crate) fn of_pictures(pictures: &Arc<Vec<Sums>>) -> Option<Self> {
        (pictures.len() == 1).then(|| Self { pictures: Arc::clone(pictures) })
    }

    pub(crate) fn pictures(&self) -> &Arc<Vec<Sums>> {
        &self.pictures
    }

    fn new(sums: Sums) -> Self {
        Self { pictures: Arc::new(vec![sums]) }
    }

    fn sums(&self) -> &Sums {
        &self.pictures[0]
    }

    fn sums_mut(&mut self) -> &mut Sums {
        &mut Arc::make_mut(&mut self.pictures)[0]
    }
}

#[pymethods]
impl Accumulation {
    /// Reads an `.acc` file.
    #[staticmethod]
    fn read(py: Python<'_>, path: PathBuf) -> PyResult<Self> {
        py.detach(|| Sums::read(&path)).map(Self::new).map_err(of_picture)
    }

    /// The accumulation of `to_bytes`.
    #[staticmethod]
    fn from_bytes(py: Python<'_>, bytes: &[u8]) -> PyResult<Self> {
        let name = Path::new("bytes of an Accumulation");
        py.detach(|| Sums::from_bytes(bytes, name)).map(Self::new).map_err(of_picture)
    }

    /// The content of an `.acc` file.
    fn to_bytes<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyBytes>> {
        let bytes = py.detach(|| self.sums().to_bytes()).map_err(wrong)?;
        Ok(PyBytes::new(py, &bytes))
    }

    /// Writes the sums (`.acc`), the picture (`.exr`, `.png`), or its numbers (`.json`).
    #[pyo3(signature = (path, exposure = 0.0))]
    fn save(&self, py: Python<'_>, path: PathBuf, exposure: f32) -> PyResult<()> {
        pixels::save(py, &path, &self.pictures, exposure)
    }

    /// Adds the samples of another.
    fn merge(slf: &Bound<'_, Self>, other: &Bound<'_, Self>) -> PyResult<()> {
        if slf.is(other) {
            return Err(wrong(
                "an accumulation cannot be merged with itself: its samples would be counted twice",
            ));
        }
        let (mut this, other) = (slf.try_borrow_mut()?, other.try_borrow()?);
        add(slf.py(), this.sums_mut(), other.sums())
    }

    fn __add__(&self, py: Python<'_>, other: PyRef<'_, Self>) -> PyResult<Self> {
        let mut sum = self.clone();
        add(py, sum.sums_mut(), other.sums())?;
        Ok(sum)
    }

    fn __eq__(&self, py: Python<'_>, other: PyRef<'_, Self>) -> bool {
        let (this, other) = (self.sums(), other.sums());
        // Times differ from run to run.
        py.detach(|| {
            this.film == other.film
                && tyndall_film::ImageMetadata { seconds: 0.0, ..this.metadata.clone() }
                    == tyndall_film::ImageMetadata { seconds: 0.0, ..other.metadata.clone() }
        })
    }

    /// Ranges of the samples that every pixel holds.
    #[getter]
    fn samples(&self) -> Vec<(u64, u64)> {
        self.sums().film.complete().clone().into()
    }

    /// Mean radiance, of shape (H, W, 3).
    #[getter]
    fn image<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArrayDyn<f32>>> {
        pixels::image(py, &self.pictures)
    }

    /// Its standard error.
    #[getter]
    fn standard_error<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArrayDyn<f32>>> {
        pixels::standard_error(py, &self.pictures)
    }

    /// Median over the pixels of standard error over mean of luminance.
    #[getter]
    fn median_error(&self, py: Python<'_>) -> Option<f64> {
        py.detach(|| self.sums().film.median_relative_error())
    }

    /// The error to be held against one that is asked for: the median error, or the bound of what most pixels have not seen
    /// yet, as a share of their light, if that is more than was asked for. `None` of a black picture, and with fewer than 16
    /// samples in some pixel.
    fn error_against(&self, py: Python<'_>, asked: f64) -> Option<f64> {
        py.detach(|| self.sums().film.believed_error_against(asked))
    }

    /// Memory that it takes, at most.
    #[getter]
    fn nbytes(&self) -> usize {
        self.sums().film.bytes()
    }

    /// Hash of the scene.
    #[getter]
    fn scene_hash(&self) -> &str {
        &self.sums().metadata.scene_hash
    }

    /// Seed of the random numbers.
    #[getter]
    fn seed(&self) -> u64 {
        self.sums().metadata.seed
    }

    /// Time of rendering, summed over what was merged.
    #[getter]
    fn seconds(&self) -> f64 {
        self.sums().metadata.seconds
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<(Bound<'py, PyAny>, (Bound<'py, PyBytes>,))> {
        let from_bytes = py.get_type::<Self>().getattr("from_bytes")?;
        Ok((from_bytes, (self.to_bytes(py)?,)))
    }

    fn __repr__(&self) -> String {
        let film = &self.sums().film;
        format!("<tyndall.Accumulation {}x{}, samples {}>", film.width(), film.height(), film.complete())
    }
}

fn add(py: Python<'_>, sum: &mut Sums, other: &Sums) -> PyResult<()> {
    let [this_one, other_one] = ["this accumulation", "the other accumulation"].map(Path::new);
    py.detach(|| sum.merge(this_one, other, other_one)).map_err(of_picture)
}
