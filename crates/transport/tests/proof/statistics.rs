//! The few functions of statistics that the tests decide by.

use std::f64::consts::{FRAC_1_SQRT_2, PI};

/// Probability that a standard normal variable is farther than |z| from 0: erfc(|z|/√2).
pub fn two_sided_tail(z: f64) -> f64 {
    complementary_error_function(z.abs() * FRAC_1_SQRT_2)
}

/// Distribution function of the standard normal law.
pub fn normal_cdf(z: f64) -> f64 {
    let tail = 0.5 * two_sided_tail(z);
    if z > 0.0 { 1.0 - tail } else { tail }
}

/// The |z| that a standard normal variable passes with probability `level`, by bisection.
pub fn two_sided_quantile(level: f64) -> f64 {
    let (mut low, mut high) = (0.0, 38.0);
    for _ in 0..80 {
        let middle = 0.5 * (low + high);
        if two_sided_tail(middle) > level { low = middle } else { high = middle }
    }
    high
}

/// erfc for x ≥ 0: the power series of erf below 2.5, the continued fraction above (Abramowitz & Stegun 1964, 7.1.6
/// and 7.1.14).
fn complementary_error_function(x: f64) -> f64 {
    let gaussian = (-x * x).exp() / PI.sqrt();
    if x < 2.5 {
        let (mut term, mut sum, mut n) = (x, x, 0.0);
        while term > 1e-17 * sum {
            n += 1.0;
            term *= 2.0 * x * x / (2.0 * n + 1.0);
            sum += term;
        }
        return 1.0 - 2.0 * gaussian * sum;
    }
    let fraction = (1..=80).rev().fold(x, |below, n| x + 0.5 * f64::from(n) / below);
    gaussian / fraction
}

/// A t statistic with ν degrees of freedom as the normal variable of the same tail (Abramowitz & Stegun 1964,
/// 26.7.8; within 3 % in z, on the small side, for ν ≥ 30 and |t| < 6).
pub fn normal_from_student(t: f64, degrees: f64) -> f64 {
    t * (1.0 - 0.25 / degrees) / (1.0 + 0.5 * t * t / degrees).sqrt()
}

/// How many times the samples that are asked where a score is doubtful.
pub const AGAIN: u64 = 16;

/// Whether a score is asked again.
fn is_doubtful(z: f64) -> bool {
    z.is_nan() || z.abs() > 3.0
}

/// What was `found`, unless a score of it is doubtful: then what `repeat` finds of so many times as many samples, of seeds moved on by its
/// second argument. Where tails are heavy few samples know too little of their own error, while a bias shows all the more.
pub fn confirmed<T, const N: usize>(
    found: T,
    scores: impl Fn(&T) -> [f64; N],
    repeat: impl Fn(u64, u64) -> T,
) -> T {
    if scores(&found).into_iter().any(is_doubtful) { repeat(AGAIN, 1 << 20) } else { found }
}

/// Mean and standard error of the mean.
pub fn mean_and_error(values: &[f64]) -> (f64, f64) {
    let n = values.len() as f64;
    let mean = values.iter().sum::<f64>() / n;
    let squares = values.iter().map(|x| (x - mean).powi(2)).sum::<f64>();
    (mean, (squares / (n * (n - 1.0))).sqrt())
}

/// Kolmogorov and Smirnov's test: the probability of `values` as far as these, or farther, from the law of the
/// distribution function `cdf` (asymptotic, with Stephens' 1970 correction for finite numbers).
pub fn kolmogorov_smirnov(values: &[f64], cdf: impl Fn(f64) -> f64) -> f64 {
    let mut at: Vec<f64> = values.iter().map(|&value| cdf(value)).collect();
    at.sort_by(f64::total_cmp);
    let n = at.len() as f64;
    let distance = at.iter().enumerate().fold(0.0_f64, |far, (i, &p)| {
        let (below, above) = (i as f64 / n, (i + 1) as f64 / n);
        far.max(p - below).max(above - p)
    });
    let lambda = (n.sqrt() + 0.12 + 0.11 / n.sqrt()) * distance;
    if lambda < 0.2 {
        return 1.0;
    }
    let term = |k: i32| {
        let sign = if k % 2 == 1 { 2.0 } else { -2.0 };
        sign * (-2.0 * f64::from(k * k) * lambda * lambda).exp()
    };
    (1..100).map(term).sum::<f64>().clamp(0.0, 1.0)
}

#[test]
fn tails_and_quantiles_are_those_of_the_tables() {
    for (z, tail) in
        [(0.0, 1.0), (1.0, 0.317_310_507_862_9), (1.96, 0.049_995_790_3), (5.0, 5.733_031_437e-7)]
    {
        assert!((two_sided_tail(z) / tail - 1.0).abs() < 1e-8, "{z}: {}", two_sided_tail(z));
    }
    assert!((two_sided_quantile(1e-3) - 3.290_526_73).abs() < 1e-7);
    assert!((normal_cdf(-1.0) - 0.158_655_253_9).abs() < 1e-9);
    // Student's t: 3.646 at 30 degrees of freedom has the two-sided tail 0.001.
    assert!((normal_from_student(3.646, 30.0) / 3.2905 - 1.0).abs() < 0.03);
}

#[test]
fn the_kolmogorov_smirnov_test_tells_a_law_from_its_neighbour() {
    let mut random = tyndall_lanes::Random::new(1, 0, 0);
    let values: Vec<f64> = (0..10_000).map(|_| random.f64()).collect();
    assert!(kolmogorov_smirnov(&values, |x| x) > 0.01);
    assert!(kolmogorov_smirnov(&values, |x| x.powf(1.1)) < 1e-6);
}
