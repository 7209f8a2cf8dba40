//! Distance samplers and transmittance estimators on arrays of rays through a scene's media.

use std::sync::atomic::Ordering;

use numpy::{IntoPyArray, PyArray1, PyReadonlyArray1, PyReadonlyArray2};
use pyo3::FromPyObject;
use pyo3::prelude::{Bound, PyErr, PyResult, Python, pyfunction};
use rayon::iter::{IndexedParallelIterator, IntoParallelRefIterator, ParallelIterator};
use tyndall_lanes::Random;
use tyndall_scene::{Ray, Scene};
use tyndall_transport::{
    AlongRay, DistanceSampler, Lookups, Properties, Reason, Repeated, TransmittanceEstimator,
};

use crate::error::wrong;
use crate::interrupt::cancellable;
use crate::scene::Scene as PyScene;
use crate::slices::{numbers, vectors};

/// Rays as Python gives them: directions are of unit length, as many of each.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub(crate) struct Rays<'py> {
    origins: PyReadonlyArray2<'py, f64>,
    directions: PyReadonlyArray2<'py, f64>,
    /// Where each ends.
    distances: PyReadonlyArray1<'py, f64>,
    threads: Option<usize>,
}

/// How often each ray is sampled, and with the random numbers of which seed.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub(crate) struct Sampling {
    name: String,
    samples: u64,
    seed: u64,
}

/// A column of results.
type Column<'py> = Bound<'py, PyArray1<f64>>;

/// What an estimator declares of itself: kind, name, whether it is unbiased, use of the majorant, needs, source.
type Declared = (&'static str, &'static str, bool, String, Vec<String>, &'static str);

/// All estimators.
#[pyfunction]
pub(crate) fn declared_estimators() -> Vec<Declared> {
    let declare = |kind, properties: &'static Properties| {
        let needs = properties.needs.iter().map(ToString::to_string).collect();
        (
            kind,
            properties.name,
            properties.unbiased,
            properties.majorant.to_string(),
            needs,
            properties.source,
        )
    };
    let distances = DistanceSampler::ALL.into_iter().map(|sampler| declare("distance", sampler.properties()));
    let transmittances = TransmittanceEstimator::ALL.into_iter();
    distances
        .chain(transmittances.map(|estimator| declare("transmittance", estimator.properties())))
        .collect()
}

/// The optical thickness of each ray, by formula or voxel by voxel.
#[pyfunction]
pub(crate) fn optical_thickness<'py>(
    py: Python<'py>,
    scene: &Bound<'py, PyScene>,
    rays: Rays<'py>,
) -> PyResult<Column<'py>> {
    let (_, scene) = PyScene::ready(scene)?;
    let thickness = |_: u64, along: Option<AlongRay>| -> Result<f64, Reason> {
        Ok(along.map_or(0.0, |along| along.thickness(f64::INFINITY, &mut Lookups::default())))
    };
    Ok(each(py, &scene.built.scene, &rays, thickness)?.into_pyarray(py))
}

/// Mean, standard error and mean number of lookups of a transmittance estimator on each ray.
#[pyfunction]
pub(crate) fn estimate_transmittance<'py>(
    py: Python<'py>,
    scene: &Bound<'py, PyScene>,
    rays: Rays<'py>,
    sampling: Sampling,
) -> PyResult<[Column<'py>; 3]> {
    let Some(estimator) = TransmittanceEstimator::from_name(&sampling.name) else {
        return Err(unknown(&sampling.name, &TransmittanceEstimator::ALL.map(TransmittanceEstimator::name)));
    };
    let (_, scene) = PyScene::ready(scene)?;
    let found = each(py, &scene.built.scene, &rays, |number, along| {
        let Some(along) = along else { return Ok([1.0, 0.0, 0.0]) };
        estimator.check(&along)?;
        let found = Repeated::of(sampling.samples, |sample, lookups| {
            estimator.estimate(&along, &mut Random::new(sampling.seed, number, sample), lookups)
        });
        Ok([found.mean, found.standard_error(), found.lookups])
    })?;
    Ok([0, 1, 2].map(|column| found.iter().map(|row| row[column]).collect::<Vec<_>>().into_pyarray(py)))
}

/// Distance (infinite without a collision), weight and weight of what escapes of each sample, ray by ray; and the mean
/// number of lookups on each ray.
#[pyfunction]
pub(crate) fn sample_distances<'py>(
    py: Python<'py>,
    scene: &Bound<'py, PyScene>,
    rays: Rays<'py>,
    sampling: Sampling,
) -> PyResult<[Column<'py>; 4]> {
    let Some(sampler) = DistanceSampler::from_name(&sampling.name) else {
        return Err(unknown(&sampling.name, &DistanceSampler::ALL.map(DistanceSampler::name)));
    };
    let (_, scene) = PyScene::ready(scene)?;
    let samples = sampling.samples as usize;
    let found = each(py, &scene.built.scene, &rays, |number, along| {
        let Some(along) = along else { return Ok((vec![[f64::INFINITY, 0.0, 1.0]; samples], 0.0)) };
        sampler.check(&along)?;
        let mut lookups = Lookups::default();
        let mut fly = |sample: u64| {
            let flight =
                sampler.sample(&along, &mut Random::new(sampling.seed, number, sample), &mut lookups);
            [flight.t.unwrap_or(f64::INFINITY), flight.weight, flight.escape]
        };
        let flights: Vec<[f64; 3]> = (0..sampling.samples).map(&mut fly).collect();
        Ok((flights, lookups.0 as f64 / sampling.samples as f64))
    })?;
    let column = |column: usize| {
        let rows = found.iter().flat_map(|(flights, _)| flights);
        rows.map(|flight| flight[column]).collect::<Vec<_>>().into_pyarray(py)
    };
    let lookups: Vec<f64> = found.iter().map(|(_, lookups)| *lookups).collect();
    Ok([column(0), column(1), column(2), lookups.into_pyarray(py)])
}

/// What `work` finds on each ray, which it gets with its number; nothing where it meets no medium.
fn each<T: Send>(
    py: Python<'_>,
    scene: &Scene,
    rays: &Rays<'_>,
    work: impl Fn(u64, Option<AlongRay>) -> Result<T, Reason> + Sync + Send,
) -> PyResult<Vec<T>> {
    let origins = vectors("origins", &rays.origins)?;
    let directions = vectors("directions", &rays.directions)?;
    let ends = numbers("distance", &rays.distances)?;
    if origins.len() != directions.len() || origins.len() != ends.len() {
        return Err(wrong("as many origins, directions and distances are needed"));
    }
    let ends = ends.iter().copied();
    let paths = origins.into_iter().zip(directions).zip(ends);
    let paths: Vec<(Ray, f64)> =
        paths.map(|((origin, direction), end)| (Ray { origin, direction }, end)).collect();
    let pool =
        rayon::ThreadPoolBuilder::new().num_threads(rays.threads.unwrap_or(0)).build().map_err(wrong)?;
    let (found, signal) = cancellable(py, |cancel| {
        let one = |(number, (ray, end)): (usize, &(Ray, f64))| {
            if cancel.load(Ordering::Relaxed) {
                return Err(Stop::Cancelled);
            }
            let along = AlongRay::through_scene(scene, ray, *end);
            let along = along.map(|along| along.with_point_light_of(scene, ray));
            work(number as u64, along).map_err(Stop::Refused)
        };
        pool.install(|| paths.par_iter().enumerate().map(one).collect::<Result<Vec<T>, Stop>>())
    });
    match (found, signal) {
        (_, Some(signal)) => Err(signal),
        (Ok(found), None) => Ok(found),
        (Err(Stop::Refused(reason)), None) => Err(wrong(reason)),
        (Err(Stop::Cancelled), None) => Err(wrong("interrupted")),
    }
}

/// Why not all rays were done.
enum Stop {
    Cancelled,
    Refused(Reason),
}

fn unknown(name: &str, names: &[&str]) -> PyErr {
    wrong(format!("estimator: there is no `{name}`; there are {}", names.join(", ")))
}
