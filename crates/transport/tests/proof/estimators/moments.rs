//! Mean, variance and cost of estimators whose moments are known in closed form: `truth/transmittance_estimators.json`.
//!
//! A sample variance of N samples has the standard deviation var·√((m₄/var² − 1)/N), with the fourth central moment m₄. N is
//! chosen for each row so that this is a tenth of the variance, as far as 10⁷ lookups allow.

use tyndall_transport::along_ray::{AlongRay, Bounding, Profile};
use tyndall_transport::{Repeated, TransmittanceEstimator, repeat_transmittance};

use super::effort;
use super::rays::{WHOLE, integral, number, profiles, rows, table};
use crate::fresh;
use crate::statistics::{kolmogorov_smirnov, normal_cdf, two_sided_quantile};

/// What is known of one estimator on one ray.
struct Known {
    /// E[X].
    mean: f64,
    variance: f64,
    lookups: f64,
    /// E[X²], E[X³], E[X⁴]; measured where they are not given.
    higher: Option<[f64; 3]>,
}

#[derive(Default)]
struct Family {
    /// z scores of means, variances and lookups.
    scores: [Vec<f64>; 3],
}

impl Family {
    fn add(&mut self, name: &str, estimator: TransmittanceEstimator, ray: &AlongRay, known: &Known) {
        let fourth = known.higher.map(|[e2, e3, e4]| {
            let t = known.mean;
            e4 - 4.0 * t * e3 + 6.0 * t * t * e2 - 3.0 * t.powi(4)
        });
        let kurtosis = |fourth: f64| (fourth / known.variance.powi(2)).max(1.0);
        let pilot = fourth.map_or((1.0 / known.variance).clamp(30.0, 3000.0), kurtosis);
        let samples = (100.0 * pilot).clamp(5_000.0, 2e6).min(1e7 / known.lookups) as u64 * effort();
        let seed = self.scores[0].len() as u64;
        let found = repeat_transmittance(estimator, ray, samples, fresh::seed(seed));
        let n = samples as f64;
        if known.variance < 1e-12 * known.mean.powi(2) {
            // No variance: every sample is the truth.
            assert!(
                (found.mean / known.mean - 1.0).abs() < 1e-9,
                "{name}: {}, not {}",
                found.mean,
                known.mean
            );
            assert!(found.variance < 1e-12 * known.mean.powi(2), "{name}: variance {}", found.variance);
        } else {
            self.scores[0].push((found.mean - known.mean) / (known.variance / n).sqrt());
            let relative = ((kurtosis(fourth.unwrap_or(found.fourth_moment)) - 1.0) / n).sqrt();
            // The variance of a Bernoulli variable of ½ has no error to first order.
            if relative > 1e-3 {
                self.scores[1].push((found.variance / known.variance - 1.0) / relative);
            }
        }
        self.scores[2].push(lookup_score(&found, known.lookups, n));
        for (kind, scores) in ["mean", "variance", "lookups"].iter().zip(&self.scores) {
            let z = scores.last().copied().unwrap_or(0.0);
            // At a level of 1e-3 for all of some 500 scores together.
            assert!(z.abs() < two_sided_quantile(2e-6), "{name}: {kind}: z = {z}, {found:?}");
        }
    }

    /// The scores follow the normal law, at a level of 1e-3 for each kind.
    fn assert_normal(&self, name: &str) {
        for (kind, scores) in ["means", "variances", "lookups"].iter().zip(&self.scores) {
            let p = kolmogorov_smirnov(scores, normal_cdf);
            eprintln!("{name}: {} z scores of {kind}: p = {p:.3}", scores.len());
            assert!(p > 1e-3, "{name}: {kind}: p = {p} of {scores:?}");
        }
    }
}

/// Lookups are whole numbers, so that those of mean m have a variance of f(1 − f) at least, f the fraction of m; where nearly
/// all of them are the same, all of a few thousand may be, and tell none.
fn lookup_score(found: &Repeated, truth: f64, samples: f64) -> f64 {
    let fraction = truth.fract();
    (found.lookups - truth) / found.lookups_error().max((fraction * (1.0 - fraction) / samples).sqrt())
}

/// A homogeneous ray of optical thickness `tau` and length 1.
fn homogeneous(tau: f64, bounding: Bounding) -> AlongRay<'static> {
    AlongRay::with_profile(Profile::Constant(tau), 1.0, 1).with_bounding(bounding)
}

#[test]
fn delta_ratio_and_next_flight_have_the_stated_moments_and_lookups_in_homogeneous_media() {
    let table = table();
    let mut family = Family::default();
    for row in rows(&table, "homogeneous") {
        let at = |key: &str| number(row, key);
        let (tau, mean) = (at("tau"), at("T"));
        let bounding = Bounding { majorant_scale: 1.0 / at("mu_over_majorant"), ..WHOLE };
        let ray = homogeneous(tau, bounding);
        let ratio_second = at("ratio_var") + mean * mean;
        for (estimator, key, higher) in [
            (TransmittanceEstimator::DeltaTracking, "delta", Some([mean; 3])),
            (
                TransmittanceEstimator::RatioTracking,
                "ratio",
                Some([ratio_second, at("ratio_E3"), at("ratio_E4")]),
            ),
            (TransmittanceEstimator::NextFlight, "nextflight_weighted", None),
            (TransmittanceEstimator::NextFlightAnalog, "nextflight_analog", None),
        ] {
            let known = Known {
                mean,
                variance: at(&format!("{key}_var")),
                lookups: at(&format!("{key}_lookups")),
                higher,
            };
            family.add(&format!("{key} {row}"), estimator, &ray, &known);
        }
    }
    family.assert_normal("homogeneous");
}

#[test]
fn residual_ratio_tracking_has_the_stated_moments_and_lookups() {
    let table = table();
    let mut family = Family::default();
    for row in rows(&table, "residual_ratio") {
        let at = |key: &str| number(row, key);
        let (tau, mean, majorant) = (at("tau"), at("T"), at("residual_majorant"));
        let control = at("control_over_mu") * tau;
        let bounding = Bounding {
            control_scale: at("control_over_mu"),
            majorant_scale: majorant / (tau - control),
            ..WHOLE
        };
        // E[X^k] = exp(−k μc) exp(−μ̄r (1 − (1 − μr/μ̄r)^k)) on a ray of length 1.
        let moment = |k: i32| {
            (-f64::from(k) * control - majorant * (1.0 - (1.0 - (tau - control) / majorant).powi(k))).exp()
        };
        let known = Known {
            mean,
            variance: at("var"),
            lookups: at("lookups"),
            higher: Some([moment(2), moment(3), moment(4)]),
        };
        let ray = homogeneous(tau, bounding);
        family.add(&format!("{row}"), TransmittanceEstimator::ResidualRatioTracking, &ray, &known);
    }
    family.assert_normal("residual ratio");
}

#[test]
fn delta_and_ratio_tracking_have_the_stated_moments_and_lookups_in_heterogeneous_media() {
    let table = table();
    let mut family = Family::default();
    for (row, (profile, length)) in rows(&table, "heterogeneous").iter().zip(profiles()) {
        let at = |key: &str| number(row, key);
        let mean = at("T");
        let majorant = at("majorant");
        let cube = integral(&profile, length, |mu_t| majorant * (1.0 - (1.0 - mu_t / majorant).powi(3)));
        let ray = AlongRay::with_profile(profile, length, 1).with_bounding(WHOLE);
        assert!((ray.majorant_thickness() / (majorant * length) - 1.0).abs() < 1e-9, "{row}");
        let exact = TransmittanceEstimator::ClosedForm.estimate(
            &ray,
            &mut Default::default(),
            &mut Default::default(),
        );
        assert!((exact / mean - 1.0).abs() < 1e-9, "closed form {exact} {row}");
        let ratio = [at("ratio_var") + mean * mean, (-cube).exp(), at("ratio_E4")];
        for (estimator, key, higher) in [
            (TransmittanceEstimator::DeltaTracking, "delta", [mean; 3]),
            (TransmittanceEstimator::RatioTracking, "ratio", ratio),
        ] {
            let known = Known {
                mean,
                variance: at(&format!("{key}_var")),
                lookups: at(&format!("{key}_lookups")),
                higher: Some(higher),
            };
            family.add(&format!("{key} {row}"), estimator, &ray, &known);
        }
    }
    family.assert_normal("heterogeneous");
}
