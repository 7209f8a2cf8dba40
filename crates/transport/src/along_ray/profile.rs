//! Extinction by formula, with its integral: homogeneous media, the exponential atmosphere, and profiles on which
//! estimators are compared.

use std::f64::consts::{PI, SQRT_2, TAU};

use tyndall_scene::Exponential;

/// The extinction as a function of the distance t along the ray, 1/length; nowhere negative.
#[derive(Debug, Clone, PartialEq)]
pub enum Profile {
    /// The same everywhere.
    Constant(f64),
    /// That of an atmosphere along a straight line.
    Exponential(Exponential),
    /// Straight lines between (t, μt), in order of t; two knots at one t make a step.
    PiecewiseLinear(Vec<(f64, f64)>),
    /// peak·exp(−(t − centre)²/(2 width²)).
    Gaussian {
        /// Greatest extinction.
        peak: f64,
        /// Where it is.
        centre: f64,
        /// Standard deviation.
        width: f64,
    },
    /// mean·(1 + sin(2π·frequency·t)).
    Sine {
        /// Mean over a period.
        mean: f64,
        /// Periods per length.
        frequency: f64,
    },
}

impl Profile {
    /// Extinction at the distance `t`.
    pub fn mu_t(&self, t: f64) -> f64 {
        match *self {
            Self::Constant(mu_t) => mu_t,
            Self::Exponential(exponential) => exponential.value(t),
            Self::PiecewiseLinear(ref knots) => {
                let after = knots.partition_point(|knot| knot.0 <= t);
                match (after.checked_sub(1).map(|before| knots[before]), knots.get(after)) {
                    (Some(a), Some(b)) => a.1 + (b.1 - a.1) * (t - a.0) / (b.0 - a.0),
                    (Some(a), None) => a.1,
                    (None, b) => b.map_or(0.0, |b| b.1),
                }
            }
            Self::Gaussian { peak, centre, width } => peak * libm::exp(-0.5 * ((t - centre) / width).powi(2)),
            Self::Sine { mean, frequency } => mean * (1.0 + libm::sin(TAU * frequency * t)),
        }
    }

    /// Optical thickness from `a` to `b` ≥ `a`.
    pub fn thickness(&self, a: f64, b: f64) -> f64 {
        match *self {
            Self::Constant(mu_t) => mu_t * (b - a),
            Self::Exponential(exponential) => exponential.integral(a, b),
            Self::PiecewiseLinear(ref knots) => {
                let inside = knots.iter().map(|knot| knot.0).filter(|t| (a..b).contains(t));
                let cuts: Vec<f64> = std::iter::once(a).chain(inside).chain([b]).collect();
                // A straight line has its mean in the middle.
                let line = |a: f64, b: f64| (b - a) * self.mu_t(0.5 * (a + b));
                cuts.windows(2).filter(|cut| cut[0] < cut[1]).map(|cut| line(cut[0], cut[1])).sum()
            }
            Self::Gaussian { peak, centre, width } => {
                let at = |t: f64| error_function((t - centre) / (SQRT_2 * width));
                peak * width * (0.5 * PI).sqrt() * (at(b) - at(a))
            }
            Self::Sine { mean, frequency } => {
                let turns = TAU * frequency;
                mean * (b - a + (libm::cos(turns * a) - libm::cos(turns * b)) / turns)
            }
        }
    }

    /// The distance at which the optical thickness from `a` is `tau`; `None` where there is no formula or it never gets
    /// so far.
    pub fn distance_at(&self, a: f64, tau: f64) -> Option<f64> {
        match *self {
            Self::Constant(mu_t) => (mu_t > 0.0).then(|| a + tau / mu_t),
            Self::Exponential(exponential) => {
                let distance = exponential.distance_of_integral(a, tau);
                distance.is_finite().then_some(distance)
            }
            _ => None,
        }
    }

    /// Least and greatest extinction between `a` and `b`.
    pub fn bounds(&self, a: f64, b: f64) -> (f64, f64) {
        let ends = [self.mu_t(a), self.mu_t(b)];
        let (mut min, mut max) = (ends[0].min(ends[1]), ends[0].max(ends[1]));
        match *self {
            Self::Constant(_) | Self::Exponential(_) => {}
            Self::PiecewiseLinear(ref knots) => {
                for knot in knots.iter().filter(|knot| (a..=b).contains(&knot.0)) {
                    (min, max) = (min.min(knot.1), max.max(knot.1));
                }
            }
            Self::Gaussian { peak, centre, .. } => {
                if (a..=b).contains(&centre) {
                    max = peak;
                }
            }
            Self::Sine { mean, frequency } => {
                // Whether a whole number of turns after `phase` lies between.
                let passes = |phase: f64| (frequency * b - phase).floor() > (frequency * a - phase).floor();
                if passes(0.25) {
                    max = 2.0 * mean;
                }
                if passes(0.75) {
                    min = 0.0;
                }
            }
        }
        (min, max)
    }
}

/// erf by its power series below 3, by its continued fraction above (Abramowitz & Stegun 1964, 7.1.6 and 7.1.14).
fn error_function(x: f64) -> f64 {
    let size = x.abs();
    let gaussian = libm::exp(-size * size) / PI.sqrt();
    if size < 3.0 {
        let (mut term, mut sum, mut n) = (size, size, 0.0);
        while term > 1e-17 * sum {
            n += 1.0;
            term *= 2.0 * size * size / (2.0 * n + 1.0);
            sum += term;
        }
        return (2.0 * gaussian * sum).copysign(x);
    }
    let fraction = (1..=60).rev().fold(size, |below, n| size + 0.5 * f64::from(n) / below);
    (1.0 - gaussian / fraction).copysign(x)
}
