//! Every estimator on every ray, and on homogeneous media of many thicknesses.

use serde::Serialize;
use tyndall_transport::AlongRay;
use tyndall_transport::along_ray::{Bounding, Profile};

use super::rays::ChosenRay;
use super::trial::{Effort, Estimator, Kind, Trial, Truths};

/// All estimators on one ray.
#[derive(Debug, Serialize)]
pub struct RayComparison {
    /// Column and row, if it is a camera ray.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub pixel: Option<[u32; 2]>,
    pub origin: [f64; 3],
    pub direction: [f64; 3],
    /// Distances at which the first medium starts and the last ends, or the ray is cut.
    pub start: f64,
    pub end: f64,
    pub optical_thickness: f64,
    /// That of the majorants.
    pub majorant_thickness: f64,
    /// The true transmittance.
    pub transmittance: f64,
    /// By which function f of the distance the samplers of distances are judged.
    pub test_function: &'static str,
    /// The true ∫ μt T f.
    pub collision_mean: f64,
    /// In the order of the registry.
    pub estimators: Vec<Trial>,
    /// Those that cannot be used on this ray.
    pub refused: Vec<Refused>,
    /// Densities of the true collision distances at equal steps, for the report.
    #[serde(skip)]
    pub collision_density: Vec<f64>,
}

/// An estimator that cannot be used.
#[derive(Debug, Clone, Serialize)]
pub struct Refused {
    pub name: &'static str,
    pub kind: Kind,
    pub reason: String,
}

/// What an estimator declares of itself.
#[derive(Debug, Serialize)]
pub struct Declared {
    pub name: &'static str,
    pub kind: Kind,
    pub unbiased: bool,
    pub majorant: String,
    pub needs: Vec<String>,
    pub source: &'static str,
}

/// Relative variances in a homogeneous medium.
#[derive(Debug, Serialize)]
pub struct Homogeneous {
    pub optical_thickness: f64,
    pub estimators: Vec<RelativeVariance>,
}

/// Variance of a sample over the square of the true value.
#[derive(Debug, Serialize)]
pub struct RelativeVariance {
    pub name: &'static str,
    pub kind: Kind,
    /// None where too few samples decide over it.
    pub relative_variance: Option<f64>,
}

/// Number of places at which the true density of collisions is given.
pub const DENSITY_STEPS: usize = 200;
/// How much the majorant of the homogeneous media exceeds their extinction; if it did not, null collisions had nothing to do.
pub const MAJORANT_SCALE: f64 = 2.0;
/// Samples of each of them.
const HOMOGENEOUS_SAMPLES: u64 = 4096;

/// What all estimators declare.
pub fn declared() -> Vec<Declared> {
    let declare = |estimator: Estimator| {
        let properties = estimator.properties();
        Declared {
            name: properties.name,
            kind: estimator.kind(),
            unbiased: properties.unbiased,
            majorant: properties.majorant.to_string(),
            needs: properties.needs.iter().map(ToString::to_string).collect(),
            source: properties.source,
        }
    };
    Estimator::all().into_iter().map(declare).collect()
}

/// Tries all estimators on the ray, with random numbers of its own.
pub fn compare(number: u64, ray: &ChosenRay, samples: Option<u64>, seed: u64) -> RayComparison {
    let along = &ray.along;
    let truths = Truths::of(along);
    let (mut estimators, mut refused) = (Vec::new(), Vec::new());
    for (stream, estimator) in streams(number).zip(Estimator::all()) {
        match estimator.check(along) {
            Ok(()) => {
                estimators.push(Trial::run(estimator, along, &truths, Effort { samples, seed, stream }));
            }
            Err(reason) => refused.push(Refused {
                name: estimator.properties().name,
                kind: estimator.kind(),
                reason: reason.to_string(),
            }),
        }
    }
    RayComparison {
        pixel: ray.pixel,
        origin: ray.ray.origin.to_array(),
        direction: ray.ray.direction.to_array(),
        start: along.start(),
        end: along.end(),
        optical_thickness: ray.optical_thickness,
        majorant_thickness: along.majorant_thickness(),
        transmittance: truths.transmittance,
        test_function: truths.test_function.name(),
        collision_mean: truths.collision_mean,
        estimators,
        refused,
        collision_density: collision_density(along),
    }
}

/// Media of optical thickness 1/32 to 32.
pub fn homogeneous_family(seed: u64) -> Vec<Homogeneous> {
    let bounding = Bounding { majorant_scale: MAJORANT_SCALE, ..Bounding::default() };
    let of_thickness = |power: i32| {
        let optical_thickness = 2_f64.powi(power);
        let ray =
            AlongRay::with_profile(Profile::Constant(optical_thickness), 1.0, 1).with_bounding(bounding);
        let truths = Truths::of(&ray);
        let streams = streams((1 << 32) + u64::from(power.unsigned_abs()) * 2 + u64::from(power < 0));
        let usable = streams.zip(Estimator::all()).filter(|(_, estimator)| estimator.check(&ray).is_ok());
        let estimators = usable.map(|(stream, estimator)| {
            let effort = Effort { samples: Some(HOMOGENEOUS_SAMPLES), seed, stream };
            let trial = Trial::run(estimator, &ray, &truths, effort);
            let relative_variance = if trial.exact { 0.0 } else { trial.variance / trial.truth.powi(2) };
            let relative_variance = trial.variance_is_known().then_some(relative_variance);
            RelativeVariance { name: trial.name, kind: trial.kind, relative_variance }
        });
        Homogeneous { optical_thickness, estimators: estimators.collect() }
    };
    (-5..=5).map(of_thickness).collect()
}

/// Streams of random numbers for the estimators, apart from those of any other `number`.
fn streams(number: u64) -> impl Iterator<Item = u64> {
    let first = number * 64;
    first..first + 64
}

/// Mean density of collisions, μt T, in equal parts of the ray, per part.
fn collision_density(ray: &AlongRay) -> Vec<f64> {
    let (start, length) = (ray.start(), ray.end() - ray.start());
    let transmittance = |part: usize| {
        let t = start + length * part as f64 / DENSITY_STEPS as f64;
        (-ray.thickness(t, &mut tyndall_transport::Lookups::default())).exp()
    };
    let at: Vec<f64> = (0..=DENSITY_STEPS).map(transmittance).collect();
    at.windows(2).map(|pair| pair[0] - pair[1]).collect()
}
