//! An estimator run many times on one ray: its mean with the standard error, its variance and its cost.

use tyndall_lanes::Random;

use crate::along_ray::{AlongRay, Lookups};
use crate::distance::{DistanceSampler, Flight};
use crate::transmittance::TransmittanceEstimator;

/// What many independent samples of an estimator say of it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Repeated {
    /// Number of samples.
    pub samples: u64,
    /// Mean of the samples.
    pub mean: f64,
    /// Variance of one sample, estimated without bias; NaN of fewer than two.
    pub variance: f64,
    /// Mean of the fourth power of the distance from the mean.
    pub fourth_moment: f64,
    /// Mean number of lookups of one sample.
    pub lookups: f64,
    /// Variance of that number.
    pub lookups_variance: f64,
}

impl Repeated {
    /// Of `samples` pairs of a value and what it cost.
    pub fn of(samples: u64, mut draw: impl FnMut(u64, &mut Lookups) -> f64) -> Self {
        let (mut values, mut costs) = (Moments::default(), Moments::default());
        for sample in 0..samples {
            let mut lookups = Lookups::default();
            values.add(draw(sample, &mut lookups));
            costs.add(lookups.0 as f64);
        }
        Self {
            samples,
            mean: values.mean,
            variance: values.variance(),
            fourth_moment: values.fourth / values.count,
            lookups: costs.mean,
            lookups_variance: costs.variance(),
        }
    }

    /// Standard error of the mean.
    pub fn standard_error(&self) -> f64 {
        (self.variance / self.samples as f64).sqrt()
    }

    /// Standard error of the mean number of lookups.
    pub fn lookups_error(&self) -> f64 {
        (self.lookups_variance / self.samples as f64).sqrt()
    }

    /// (mean − truth) over the standard error.
    pub fn z(&self, truth: f64) -> f64 {
        (self.mean - truth) / self.standard_error()
    }
}

/// Runs a transmittance estimator `samples` times; sample n has the random numbers (seed, 0, n).
pub fn repeat_transmittance(
    estimator: TransmittanceEstimator,
    ray: &AlongRay,
    samples: u64,
    seed: u64,
) -> Repeated {
    Repeated::of(samples, |n, lookups| estimator.estimate(ray, &mut Random::new(seed, 0, n), lookups))
}

/// Runs a distance sampler `samples` times and takes the statistics of `score` of its flights: weight·f(t), say, or escape.
pub fn repeat_distance(
    sampler: DistanceSampler,
    ray: &AlongRay,
    samples: u64,
    seed: u64,
    score: impl Fn(&Flight) -> f64,
) -> Repeated {
    Repeated::of(samples, |n, lookups| score(&sampler.sample(ray, &mut Random::new(seed, 0, n), lookups)))
}

/// Central moments, kept up to date by the formulas of Pébay 2008, which do not cancel.
#[derive(Default)]
struct Moments {
    count: f64,
    mean: f64,
    second: f64,
    third: f64,
    fourth: f64,
}

impl Moments {
    fn add(&mut self, value: f64) {
        self.count += 1.0;
        let n = self.count;
        let delta = value - self.mean;
        let share = delta / n;
        let term = delta * share * (n - 1.0);
        self.mean += share;
        self.fourth += term * share * share * (n * n - 3.0 * n + 3.0) + 6.0 * share * share * self.second
            - 4.0 * share * self.third;
        self.third += term * share * (n - 2.0) - 3.0 * share * self.second;
        self.second += term;
    }

    fn variance(&self) -> f64 {
        self.second / (self.count - 1.0)
    }
}
