//! Pearson's chi-squared test of counts in cells, for samplers.

use std::f64::consts::TAU;

/// Whether `TYNDALL_PROOF=full` asks for more effort.
pub fn is_full() -> bool {
    std::env::var_os("TYNDALL_PROOF").is_some_and(|effort| effort == "full")
}

/// The chi-squared statistic as a standard normal variable (Wilson & Hilferty 1931), over cells of at least ten expected
/// counts, the others joined.
pub fn chi_squared_z(counts: &[usize], expected: &[f64]) -> f64 {
    let (mut statistic, mut cells) = (0.0, 0.0);
    let (mut rest_counted, mut rest_expected) = (0.0, 0.0);
    for (count, expected) in counts.iter().zip(expected) {
        if *expected >= 10.0 {
            statistic += (*count as f64 - expected).powi(2) / expected;
            cells += 1.0;
        } else {
            rest_counted += *count as f64;
            rest_expected += expected;
        }
    }
    if rest_expected >= 10.0 {
        statistic += (rest_counted - rest_expected).powi(2) / rest_expected;
        cells += 1.0;
    } else {
        // Too few for chi-squared, but no room for many.
        assert!(rest_counted < 40.0, "{rest_counted} samples where {rest_expected} are expected");
    }
    let degrees = cells - 1.0;
    let spread = 2.0 / (9.0 * degrees);
    ((statistic / degrees).cbrt() - 1.0 + spread) / spread.sqrt()
}

/// A z that a standard normal variable passes with at most the probability `level`: its upper tail is below
/// exp(−z²/2)/(z √(2π)), which is solved by bisection.
pub fn upper_quantile(level: f64) -> f64 {
    let tail = |z: f64| (-0.5 * z * z).exp() / (z * TAU.sqrt());
    let (mut low, mut high) = (1.0, 40.0);
    for _ in 0..100 {
        let middle = 0.5 * (low + high);
        if tail(middle) > level { low = middle } else { high = middle }
    }
    high
}
