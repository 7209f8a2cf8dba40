//! `tyndall.Render`, a picture with its error, and the loop that makes it.
//!
//! The loop of `tyndall-session` runs on threads of its own without Python's lock. The thread that called waits, and every
//! 50 ms takes the lock for a moment to see signals and to report progress, so that Ctrl-C stops at once.

use std::fmt::Display;
use std::ops::RangeInclusive;
use std::path::PathBuf;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread;
use std::time::{Duration, Instant};

use numpy::{PyArray1, PyArrayDyn, PyArrayMethods};
use pyo3::exceptions::PyKeyboardInterrupt;
use pyo3::prelude::{Bound, PyAny, PyAnyMethods, PyResult, Python, pyclass, pyfunction, pymethods};
use pyo3::types::{PyBytes, PyDict};
use pyo3::{Py, PyErr};
use tyndall_film::{Accumulation as Sums, Colours, png_bytes};
use tyndall_session::{Goal, Job, JobOptions, Plan, SessionError};
use tyndall_transport::{Control, Outcome};

use crate::accumulation::Accumulation;
use crate::error::{of_session, wrong};
use crate::pixels;
use crate::scene::Scene;

/// Time between two looks at signals.
const GLANCE: Duration = Duration::from_millis(50);
/// Time between two reports at least: the error costs a look at every pixel.
const REPORT: Duration = Duration::from_millis(200);

/// A picture with its error.
#[pyclass(module = "tyndall", frozen)]
#[derive(Debug)]
pub(crate) struct Render {
    pictures: Arc<Vec<Sums>>,
    exposure: f32,
    notes: Vec<String>,
    is_complete: bool,
}

/// What is known of a render under way.
#[pyclass(module = "tyndall", frozen, get_all)]
#[derive(Debug)]
pub(crate) struct Progress {
    /// Samples of each pixel so far, the mean of all pixels.
    samples: f64,
    /// Samples that will be made at most; `None` if only an error or a time ends the render.
    spp: Option<u64>,
    /// Median relative standard error, once it is known.
    error: Option<f64>,
    /// Time since the start.
    seconds: f64,
    /// The picture as it was after the last pass, of shape (H, W, 3), if it was asked for and there is one.
    image: Option<Py<PyArrayDyn<f32>>>,
}

/// Renders; `report` is called with a `Progress` every now and then, with the picture in it if `with_image`. The
/// error in it costs a look at every pixel, which `with_error = false` saves; then there is no picture either. What is
/// interrupted `in_one_pass` may have pixels without a sample.
#[pyfunction]
#[pyo3(signature = (scene, *, spp, samples, error, time, seed, threads, report, with_image, with_error = true, in_one_pass = false))]
#[expect(clippy::too_many_arguments, reason = "Python calls it with names")]
pub(crate) fn render(
    scene: &Bound<'_, Scene>,
    spp: Option<i64>,
    samples: Option<(i64, i64)>,
    error: Option<f64>,
    time: Option<f64>,
    seed: Option<i64>,
    threads: Option<i64>,
    report: Option<Py<PyAny>>,
    with_image: bool,
    with_error: bool,
    in_one_pass: bool,
) -> PyResult<Render> {
    let py = scene.py();
    let goal = goal(spp, samples, error, time)?;
    let threads = threads.map(|threads| whole("threads", threads, 1..=u16::MAX)).transpose()?;
    let seed = seed.map(|seed| whole("seed", seed, 0..=u32::MAX)).transpose()?;
    let (mut input, ready) = Scene::ready(scene)?;
    if let Some(seed) = seed {
        input.description_mut().render.seed = seed;
    }
    let options = JobOptions { threads: threads.map(usize::from), ..JobOptions::default() };
    let mut job = py.detach(|| Job::of_ready(&input, &ready, &options)).map_err(of_session)?;
    let mut plan = goal.plan(input.description().render.spp);
    let with_error = with_error && report.is_some();
    if in_one_pass {
        plan = plan.in_one_pass();
    }
    let watch = Watch {
        control: Control::default(),
        start: Instant::now(),
        pixels: job.pixels(),
        spp: plan.spp(),
        report,
        with_image,
        with_error,
        latest: Mutex::default(),
    };
    let (outcome, stopped) = py.detach(|| watch.run(&mut job, &plan));
    let outcome = outcome.map_err(of_session)?;
    let notes = job.notes().to_vec();
    let pictures = Arc::new(job.into_pictures());
    let is_there = pictures.iter().all(|picture| picture.film.mean_sample_count() > 0.0);
    match stopped {
        Some(stopped) if stopped.is_instance_of::<PyKeyboardInterrupt>(py) && is_there => {}
        Some(stopped) => return Err(stopped),
        None => {}
    }
    let exposure = input.description().film.exposure as f32;
    Ok(Render { pictures, exposure, notes, is_complete: outcome == Outcome::Complete })
}

/// A number of a kind, if it is in range.
fn whole<T>(name: &str, number: i64, range: RangeInclusive<T>) -> PyResult<T>
where
    T: TryFrom<i64> + PartialOrd + Display,
{
    let (least, most) = (range.start(), range.end());
    let refuse = || wrong(format!("{name}: give a whole number from {least} to {most}, not {number}"));
    T::try_from(number).ok().filter(|number| range.contains(number)).ok_or_else(refuse)
}

fn goal(
    spp: Option<i64>,
    samples: Option<(i64, i64)>,
    error: Option<f64>,
    time: Option<f64>,
) -> PyResult<Goal> {
    let spp = spp.map(|spp| whole("spp", spp, 1..=u32::MAX)).transpose()?;
    if samples.is_some() && (spp.is_some() || error.is_some() || time.is_some()) {
        return Err(wrong("samples: says how many there are; leave spp, error and time out"));
    }
    if let Some((first, end)) = samples.filter(|(first, end)| *first < 0 || first >= end) {
        return Err(wrong(format!(
            "samples: ({first}, {end}) is no range; give (A, B) with A < B, such as (0, 64)"
        )));
    }
    if error.is_some_and(|error| !(error.is_finite() && error > 0.0)) {
        return Err(wrong("error: give a share above 0, such as 0.01"));
    }
    let time = match time {
        Some(seconds) => {
            let time = Duration::try_from_secs_f64(seconds).ok().filter(|time| !time.is_zero());
            Some(time.ok_or_else(|| wrong("time: give seconds above 0"))?)
        }
        None => None,
    };
    Ok(Goal {
        spp,
        samples: samples.map(|(first, end)| first.unsigned_abs()..end.unsigned_abs()),
        error,
        time,
    })
}

/// A render under way, as the thread that waits for it sees it.
struct Watch {
    control: Control,
    start: Instant,
    pixels: u64,
    spp: Option<u64>,
    report: Option<Py<PyAny>>,
    with_image: bool,
    with_error: bool,
    latest: Mutex<Latest>,
}

/// What the last pass that was looked at came to.
#[derive(Default)]
struct Latest {
    seen: Option<Instant>,
    error: Option<f64>,
    image: Option<(Vec<[f32; 3]>, [usize; 2])>,
}

impl Watch {
    /// Renders to the end, or until a signal or the report stops it; that is the second answer.
    fn run(&self, job: &mut Job, plan: &Plan) -> (Result<Outcome, SessionError>, Option<PyErr>) {
        let is_done = AtomicBool::new(false);
        let waiting = thread::current();
        thread::scope(|scope| {
            let render = scope.spawn(|| {
                let outcome = job.run(plan, &self.control, |pictures| self.after_pass(pictures));
                is_done.store(true, Ordering::Release);
                waiting.unpark();
                outcome
            });
            let mut stopped = None;
            let mut reported = Instant::now();
            while !is_done.load(Ordering::Acquire) && !render.is_finished() {
                thread::park_timeout(GLANCE);
                let is_due = reported.elapsed() >= REPORT;
                if is_due {
                    reported = Instant::now();
                }
                if let Err(error) = self.glance(is_due && stopped.is_none()) {
                    self.control.cancel.store(true, Ordering::Relaxed);
                    stopped.get_or_insert(error);
                }
            }
            let outcome = render.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic));
            if stopped.is_none() {
                stopped = self.glance(true).err();
            }
            (outcome, stopped)
        })
    }

    /// On the rendering thread.
    fn after_pass(&self, pictures: &[Sums]) {
        let Some(Sums { film, .. }) = pictures.first().filter(|_| self.with_error) else { return };
        let mut latest = self.latest.lock().unwrap_or_else(PoisonError::into_inner);
        if latest.seen.is_some_and(|seen| seen.elapsed() < REPORT) {
            return;
        }
        latest.error = film.median_relative_error().filter(|error| error.is_finite());
        if self.with_image {
            latest.image = Some((film.mean_image(), [film.height() as usize, film.width() as usize]));
        }
        latest.seen = Some(Instant::now());
    }

    /// Lets Python see signals, and calls the report if it is due.
    fn glance(&self, is_due: bool) -> PyResult<()> {
        Python::attach(|py| {
            py.check_signals()?;
            let Some(report) = self.report.as_ref().filter(|_| is_due) else { return Ok(()) };
            let (error, image) = {
                let mut latest = self.latest.lock().unwrap_or_else(PoisonError::into_inner);
                (latest.error, latest.image.take())
            };
            let image = image.map(|(pixels, [height, width])| {
                let flat = PyArray1::from_vec(py, pixels.into_flattened());
                flat.reshape(vec![height, width, 3]).map(Bound::unbind)
            });
            let progress = Progress {
                samples: self.control.samples.load(Ordering::Relaxed) as f64 / self.pixels.max(1) as f64,
                spp: self.spp,
                error,
                seconds: self.start.elapsed().as_secs_f64(),
                image: image.transpose()?,
            };
            report.bind(py).call1((progress,)).map(drop)
        })
    }
}

#[pymethods]
impl Render {
    /// The picture that the sums of an `.acc` file, or of merged renders, come to.
    #[staticmethod]
    #[pyo3(signature = (accumulation, *, exposure = 0.0, notes = Vec::new(), complete = true))]
    fn from_accumulation(
        accumulation: &Accumulation,
        exposure: f32,
        notes: Vec<String>,
        complete: bool,
    ) -> Self {
        Self { pictures: Arc::clone(accumulation.pictures()), exposure, notes, is_complete: complete }
    }

    /// Mean radiance, linear: of shape (H, W, 3), or (H, W, N) of a picture of N bands.
    #[getter]
    fn image<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArrayDyn<f32>>> {
        pixels::image(py, &self.pictures)
    }

    /// Standard error of `image`, of the same shape; infinite with fewer than two samples.
    #[getter]
    fn standard_error<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArrayDyn<f32>>> {
        pixels::standard_error(py, &self.pictures)
    }

    /// The other layers by their names in an EXR file, of shape (H, W) or (H, W, channels).
    #[getter]
    fn layers<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        pixels::layers(py, &self.pictures)
    }

    /// What the channels of `image` are: `R`, `G`, `B`, or wavelengths such as `550nm`.
    #[getter]
    fn channels(&self) -> Vec<String> {
        pixels::channel_names(&self.pictures)
    }

    /// Samples of each pixel, the mean of all pixels.
    #[getter]
    fn samples(&self) -> f64 {
        self.pictures.first().map_or(0.0, |picture| picture.film.mean_sample_count())
    }

    /// Time of rendering.
    #[getter]
    fn seconds(&self) -> f64 {
        self.pictures.iter().map(|picture| picture.metadata.seconds).fold(0.0, f64::max)
    }

    /// Median over the pixels with medium of standard error over mean; `None` if the picture is black.
    #[getter]
    fn median_error(&self, py: Python<'_>) -> Option<f64> {
        py.detach(|| self.pictures.first().and_then(|picture| picture.film.median_relative_error()))
    }

    /// The light that most pixels have not seen yet, as a share of what they show, at most, as far as the picture knows; `None`
    /// if it is black.
    #[getter]
    fn unseen_light(&self, py: Python<'_>) -> Option<f64> {
        let bounds = || self.pictures.iter().filter_map(|picture| picture.film.stated_unseen_light());
        py.detach(|| bounds().map(|unseen| unseen.bound).reduce(f64::max))
    }

    /// What has to be told along with the picture, where its stated errors do not hold; one line each.
    #[getter]
    fn warnings(&self, py: Python<'_>) -> Vec<String> {
        py.detach(|| tyndall_film::warnings(self.pictures.iter().map(|picture| &picture.film)))
    }

    /// Samples that were not finite or too large; the picture leaves them out, and may be biased by it.
    #[getter]
    fn rejected(&self) -> u64 {
        self.pictures.iter().map(|picture| picture.film.rejected()).sum()
    }

    /// Whether all that was asked for is there; not so after Ctrl-C.
    #[getter]
    fn complete(&self) -> bool {
        self.is_complete
    }

    /// What was guessed, and what the user should know; one line each.
    #[getter]
    fn notes(&self) -> Vec<String> {
        self.notes.clone()
    }

    /// How the samples were made: seed, samples, scene, options, version.
    #[getter]
    fn metadata<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let metadata = PyDict::new(py);
        if let Some(Sums { film, metadata: made }) = self.pictures.first() {
            metadata.set_item("seed", made.seed)?;
            metadata.set_item("samples", film.complete().to_string())?;
            metadata.set_item("scene_hash", &made.scene_hash)?;
            metadata.set_item("options", &made.options)?;
            metadata.set_item("version", &made.version)?;
            metadata.set_item("seconds", self.seconds())?;
            metadata.set_item("rejected", self.rejected())?;
        }
        Ok(metadata)
    }

    /// The exact sums, to be saved or merged with those of other samples.
    #[getter]
    fn accumulation(&self) -> PyResult<Accumulation> {
        Accumulation::of_pictures(&self.pictures)
            .ok_or_else(|| wrong("accumulation: holds at most three bands; give fewer in film.bands"))
    }

    /// Writes the picture (`.exr`, `.png`), its sums (`.acc`) or its numbers (`.json`).
    #[pyo3(signature = (path, exposure = None))]
    fn save(&self, py: Python<'_>, path: PathBuf, exposure: Option<f32>) -> PyResult<()> {
        pixels::save(py, &path, &self.pictures, exposure.unwrap_or(self.exposure))
    }

    /// The picture as an xarray Dataset.
    fn to_xarray<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyAny>> {
        slf.py().import("tyndall._xarray")?.call_method1("dataset", (slf,))
    }

    fn _repr_png_<'py>(&self, py: Python<'py>) -> PyResult<Option<Bound<'py, PyBytes>>> {
        let Some(Sums { film, metadata }) = self.pictures.first() else { return Ok(None) };
        if metadata.colours != Colours::Rgb {
            return Ok(None);
        }
        let bytes = py.detach(|| png_bytes(film, self.exposure)).map_err(wrong)?;
        Ok(Some(PyBytes::new(py, &bytes)))
    }

    fn __repr__(&self, py: Python<'_>) -> String {
        let [width, height] =
            self.pictures.first().map_or([0, 0], |picture| [picture.film.width(), picture.film.height()]);
        let error = self.median_error(py).filter(|error| error.is_finite());
        let error = error.map_or(String::new(), |error| format!(", median error {:.2} %", 100.0 * error));
        let samples = (self.samples() * 100.0).round() / 100.0;
        let interrupted = if self.is_complete { "" } else { ", interrupted" };
        format!(
            "<tyndall.Render {width}x{height}, {samples} samples a pixel{error}, {:.1} s{interrupted}>",
            self.seconds()
        )
    }
}
