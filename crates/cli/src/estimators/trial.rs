//! One estimator on one ray, many times: what it says, how far that scatters, and what it costs.

use std::time::Instant;

use serde::Serialize;
use tyndall_lanes::Random;
use tyndall_transport::along_ray::LightBeside;
use tyndall_transport::{
    AlongRay, DistanceSampler, Flight, Lookups, Properties, Reason, Repeated, TransmittanceEstimator,
};

/// What an estimator is for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Kind {
    /// Where a ray collides.
    Distance,
    /// How much gets through.
    Transmittance,
}

/// Any estimator.
#[derive(Debug, Clone, Copy)]
pub enum Estimator {
    /// Of distances.
    Distance(DistanceSampler),
    /// Of transmittance.
    Transmittance(TransmittanceEstimator),
}

impl Estimator {
    /// All there are.
    pub fn all() -> Vec<Self> {
        let distance = DistanceSampler::ALL.map(Self::Distance).into_iter();
        distance.chain(TransmittanceEstimator::ALL.map(Self::Transmittance)).collect()
    }

    pub fn kind(self) -> Kind {
        match self {
            Self::Distance(_) => Kind::Distance,
            Self::Transmittance(_) => Kind::Transmittance,
        }
    }

    pub fn properties(self) -> &'static Properties {
        match self {
            Self::Distance(sampler) => sampler.properties(),
            Self::Transmittance(estimator) => estimator.properties(),
        }
    }

    pub fn check(self, ray: &AlongRay) -> Result<(), Reason> {
        match self {
            Self::Distance(sampler) => sampler.check(ray),
            Self::Transmittance(estimator) => estimator.check(ray),
        }
    }
}

/// f in E[weight·f(t)], by which distance samplers are judged: what a collision would bring.
#[derive(Debug, Clone, Copy)]
pub enum TestFunction {
    /// How deep in the ray the collision is, from 0 to 1.
    Depth {
        /// Where the ray starts.
        start: f64,
        /// How long it is.
        length: f64,
    },
    /// The unattenuated light of a point light, over that at the ray's nearest point.
    PointLight(LightBeside),
}

impl TestFunction {
    /// That of a point light if there is one beside the ray.
    pub fn of(ray: &AlongRay) -> Self {
        match ray.light() {
            Some(light) => Self::PointLight(light),
            None => Self::Depth { start: ray.start(), length: ray.end() - ray.start() },
        }
    }

    pub fn at(&self, t: f64) -> f64 {
        match self {
            Self::Depth { start, length } => (t - start) / length,
            Self::PointLight(light) => {
                let slope = (t - light.nearest) / light.distance;
                1.0 / (1.0 + slope * slope)
            }
        }
    }

    /// How reports call it.
    pub fn name(&self) -> &'static str {
        match self {
            Self::Depth { .. } => "depth",
            Self::PointLight(_) => "point light",
        }
    }
}

/// What is estimated on a ray, with its true values.
#[derive(Debug, Clone, Copy)]
pub struct Truths {
    /// T of the whole ray.
    pub transmittance: f64,
    /// f.
    pub test_function: TestFunction,
    /// ∫ μt T f.
    pub collision_mean: f64,
}

impl Truths {
    /// By formula or voxel by voxel, and quadrature.
    pub fn of(ray: &AlongRay) -> Self {
        let test_function = TestFunction::of(ray);
        Self {
            transmittance: (-ray.thickness(f64::INFINITY, &mut Lookups::default())).exp(),
            test_function,
            collision_mean: ray.collision_mean(|t| test_function.at(t)),
        }
    }

    pub fn of_kind(&self, kind: Kind) -> f64 {
        match kind {
            Kind::Distance => self.collision_mean,
            Kind::Transmittance => self.transmittance,
        }
    }
}

/// How often to sample, and with which random numbers.
#[derive(Debug, Clone, Copy)]
pub struct Effort {
    /// Number of samples; as many as some number of lookups allows if it is left open.
    pub samples: Option<u64>,
    /// Seed of the random numbers.
    pub seed: u64,
    /// Tells those of trials apart.
    pub stream: u64,
}

/// Samples of the first look, after which an estimator without variance is done.
const FIRST_LOOK: u64 = 64;
/// Most samples unless a number is asked for.
const MOST_SAMPLES: u64 = 1 << 15;
/// Lookups for which fewer samples are taken instead.
const MOST_LOOKUPS: f64 = 4e6;
/// Relative difference that is rounding.
const ROUNDING: f64 = 1e-9;

/// What many samples say of an estimator.
#[derive(Debug, Clone, Serialize)]
pub struct Trial {
    pub name: &'static str,
    pub kind: Kind,
    pub unbiased: bool,
    pub samples: u64,
    /// What the mean should be.
    pub truth: f64,
    pub mean: f64,
    pub standard_error: f64,
    /// Relative uncertainty of the standard error itself; large where a few samples decide.
    pub standard_error_uncertainty: f64,
    /// Of one sample.
    pub variance: f64,
    /// Whether every sample is the true value.
    pub exact: bool,
    /// Mean of one sample.
    pub lookups: f64,
    /// Of all samples.
    pub seconds: f64,
    /// 1/(variance · seconds a sample); none without variance.
    pub efficiency: Option<f64>,
    /// 1/(variance · lookups a sample); none without variance or lookups.
    pub efficiency_per_lookup: Option<f64>,
    /// (mean − truth) over the standard error; none where no sample has met what would make up the difference.
    pub z: Option<f64>,
    /// Of distance samplers: their estimate of the transmittance.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub escape: Option<Escape>,
    /// How the error falls with the number of samples.
    pub convergence: Vec<Convergence>,
    /// The samples.
    #[serde(skip)]
    pub values: Vec<f64>,
    /// Distances and weights of the collisions among them.
    #[serde(skip)]
    pub collisions: Vec<(f64, f64)>,
}

/// What a distance sampler says of the transmittance.
#[derive(Debug, Clone, Copy, Serialize)]
pub struct Escape {
    pub mean: f64,
    pub standard_error: f64,
    pub variance: f64,
    pub z: Option<f64>,
}

/// The error of the mean of `n` samples, from `batches` of so many.
#[derive(Debug, Clone, Copy, Serialize)]
pub struct Convergence {
    pub n: u64,
    /// Root mean square of mean − truth.
    pub rms_error: f64,
    /// Its standard error.
    pub rms_uncertainty: f64,
    pub batches: u64,
}

/// Relative uncertainty of a standard error from which on it is doubtful.
const DOUBTFUL: f64 = 0.3;

impl Trial {
    /// Whether a few samples decide over the standard error.
    pub fn error_is_doubtful(&self) -> bool {
        self.standard_error_uncertainty > DOUBTFUL
    }

    /// Whether the variance can be believed: rare samples that make it up have been met if the mean is right.
    pub fn variance_is_known(&self) -> bool {
        let mean_is_right = self.z.is_some_and(|z| z.abs() < 5.0);
        !self.error_is_doubtful() && (mean_is_right || !self.unbiased)
    }

    /// Samples `estimator` on a ray that it can be used on.
    pub fn run(estimator: Estimator, ray: &AlongRay, truths: &Truths, effort: Effort) -> Self {
        let first = Samples::draw(estimator, ray, truths, effort, FIRST_LOOK);
        let truth = truths.of_kind(estimator.kind());
        if first.is_exact(truth) {
            // The first look finds memory cold; the second is as fast as all others would be.
            let second = Samples::draw(estimator, ray, truths, effort, FIRST_LOOK);
            return Self::of(estimator, truths, second);
        }
        let by_cost = (MOST_LOOKUPS / first.found.lookups.max(1.0)) as u64;
        let samples = effort.samples.unwrap_or(by_cost.clamp(FIRST_LOOK, MOST_SAMPLES));
        Self::of(estimator, truths, Samples::draw(estimator, ray, truths, effort, samples))
    }

    fn of(estimator: Estimator, truths: &Truths, samples: Samples) -> Self {
        let kind = estimator.kind();
        let truth = truths.of_kind(kind);
        let Properties { name, unbiased, .. } = *estimator.properties();
        let exact = samples.is_exact(truth);
        let Samples { found, escape, seconds, values, collisions } = samples;
        let count = found.samples as f64;
        let has_variance = !exact && found.variance > 0.0;
        let efficiency = |cost: f64| (has_variance && cost > 0.0).then(|| 1.0 / (found.variance * cost));
        Self {
            name,
            kind,
            unbiased,
            samples: found.samples,
            truth,
            mean: found.mean,
            standard_error: found.standard_error(),
            standard_error_uncertainty: if has_variance { error_uncertainty(&found) } else { 0.0 },
            variance: found.variance,
            exact,
            lookups: found.lookups,
            seconds,
            efficiency: efficiency(seconds / count),
            efficiency_per_lookup: efficiency(found.lookups),
            z: z(&found, truth),
            escape: escape.map(|found| Escape {
                mean: found.mean,
                standard_error: found.standard_error(),
                variance: found.variance,
                z: z(&found, truths.transmittance),
            }),
            convergence: if exact { Vec::new() } else { convergence(&values, truth) },
            values,
            collisions,
        }
    }
}

/// The samples with their statistics.
struct Samples {
    found: Repeated,
    escape: Option<Repeated>,
    seconds: f64,
    values: Vec<f64>,
    collisions: Vec<(f64, f64)>,
}

impl Samples {
    fn draw(estimator: Estimator, ray: &AlongRay, truths: &Truths, effort: Effort, samples: u64) -> Self {
        let random = |sample| Random::new(effort.seed, effort.stream, sample);
        let mut values = Vec::with_capacity(samples as usize);
        let (mut escapes, mut collisions) = (Vec::new(), Vec::new());
        let start = Instant::now();
        let found = match estimator {
            Estimator::Transmittance(estimator) => Repeated::of(samples, |sample, lookups| {
                let value = estimator.estimate(ray, &mut random(sample), lookups);
                values.push(value);
                value
            }),
            Estimator::Distance(sampler) => Repeated::of(samples, |sample, lookups| {
                let Flight { t, weight, escape } = sampler.sample(ray, &mut random(sample), lookups);
                let value = t.map_or(0.0, |t| weight * truths.test_function.at(t));
                values.push(value);
                escapes.push(escape);
                collisions.extend(t.map(|t| (t, weight)));
                value
            }),
        };
        let seconds = start.elapsed().as_secs_f64();
        let escape =
            (!escapes.is_empty()).then(|| Repeated::of(samples, |sample, _| escapes[sample as usize]));
        Self { found, escape, seconds, values, collisions }
    }

    /// Whether each sample is `truth`, up to rounding.
    fn is_exact(&self, truth: f64) -> bool {
        let tolerance = ROUNDING * truth.abs();
        self.values.iter().all(|value| (value - truth).abs() <= tolerance)
    }
}

fn z(found: &Repeated, truth: f64) -> Option<f64> {
    let difference = found.mean - truth;
    let rounding = ROUNDING * truth.abs();
    if found.variance <= 0.0 && difference.abs() > rounding {
        return None;
    }
    let error = found.standard_error().hypot(rounding);
    Some(if difference == 0.0 { 0.0 } else { difference / error })
}

/// Relative standard error of the standard error: √(m₄/s⁴ − 1)/(2√n).
fn error_uncertainty(found: &Repeated) -> f64 {
    let kurtosis = found.fourth_moment / (found.variance * found.variance);
    0.5 * ((kurtosis - 1.0).max(0.0) / found.samples as f64).sqrt()
}

/// Means of 1, 4, 16, … samples, as long as there are eight of them.
fn convergence(values: &[f64], truth: f64) -> Vec<Convergence> {
    let sizes = (0..).map(|power| 4_usize.pow(power)).take_while(|size| values.len() / size >= 8);
    let of_size = |size: usize| {
        let square = |batch: &[f64]| (batch.iter().sum::<f64>() / size as f64 - truth).powi(2);
        let batches = (values.len() / size) as u64;
        let squares = Repeated::of(batches, |batch, _| {
            let start = batch as usize * size;
            square(&values[start..start + size])
        });
        let rms_error = squares.mean.sqrt();
        let rms_uncertainty =
            if rms_error > 0.0 { squares.standard_error() / (2.0 * rms_error) } else { 0.0 };
        Convergence { n: size as u64, rms_error, rms_uncertainty, batches }
    };
    sizes.map(of_size).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use tyndall_transport::along_ray::{Bounding, Profile};

    fn ray() -> AlongRay<'static> {
        let bounding = Bounding { majorant_scale: 2.0, ..Bounding::default() };
        AlongRay::with_profile(Profile::Constant(1.5), 1.0, 1).with_bounding(bounding)
    }

    fn trial(estimator: Estimator) -> Trial {
        let effort = Effort { samples: Some(4096), seed: 1, stream: 0 };
        Trial::run(estimator, &ray(), &Truths::of(&ray()), effort)
    }

    #[test]
    fn a_closed_form_is_exact_after_a_first_look() {
        let trial = trial(Estimator::Transmittance(TransmittanceEstimator::ClosedForm));
        assert!(trial.exact && trial.samples == FIRST_LOOK && trial.efficiency.is_none());
        assert!(trial.z.is_some_and(|z| z.abs() < 1e-3));
    }

    /// Delta tracking is Bernoulli's with T: variance T(1 − T), and means of n scatter by √(T(1 − T)/n).
    #[test]
    fn variance_and_convergence_of_delta_tracking_are_those_of_a_coin() {
        let trial = trial(Estimator::Transmittance(TransmittanceEstimator::DeltaTracking));
        let t = (-1.5_f64).exp();
        assert!((trial.variance - t * (1.0 - t)).abs() < 0.02, "{}", trial.variance);
        for step in &trial.convergence {
            let truth = (t * (1.0 - t) / step.n as f64).sqrt();
            assert!((step.rms_error - truth).abs() < 5.0 * step.rms_uncertainty, "{step:?}, not {truth}");
        }
        assert_eq!(trial.convergence.len(), 5);
    }

    #[test]
    fn without_a_sample_that_differs_no_z_is_claimed() {
        let thick = AlongRay::with_profile(Profile::Constant(60.0), 1.0, 1);
        let estimator = Estimator::Transmittance(TransmittanceEstimator::DeltaTracking);
        let effort = Effort { samples: None, seed: 1, stream: 0 };
        let trial = Trial::run(estimator, &thick, &Truths::of(&thick), effort);
        assert!(trial.z.is_none() && !trial.exact && trial.mean == 0.0);
    }
}
