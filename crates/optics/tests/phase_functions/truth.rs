//! Every row of the reference values: phase functions' values, moments and quantiles, the fog fit, SGGX.

use glam::DVec3;
use serde_json::Value;
use tyndall_optics::PhaseFunction;
use tyndall_optics::phase_function::{FogFit, Sggx, SggxKind};

use super::quadrature::integrate;

fn table() -> Value {
    serde_json::from_str(include_str!("../truth/phase_functions.json")).expect("the truth is JSON")
}

fn numbers(value: &Value) -> Vec<f64> {
    value.as_array().unwrap().iter().map(|x| x.as_f64().unwrap()).collect()
}

fn vector(value: &Value) -> DVec3 {
    DVec3::from_slice(&numbers(value))
}

/// The phase function of a row of the family `scalar`.
fn phase_of(row: &Value) -> PhaseFunction {
    let parameter = |name: &str| row["params"][name].as_f64().unwrap();
    match row["phase"].as_str().unwrap() {
        "rayleigh" => PhaseFunction::Rayleigh,
        "hg" => PhaseFunction::HenyeyGreenstein { g: parameter("g") },
        "cornette_shanks" => PhaseFunction::cornette_shanks(parameter("g")),
        "draine" => PhaseFunction::Draine { g: parameter("g"), alpha: parameter("alpha") },
        "two_term_hg" => {
            PhaseFunction::double_henyey_greenstein(parameter("g1"), parameter("g2"), parameter("w"))
        }
        "hg_draine_fog" => PhaseFunction::fog(parameter("diameter_um")),
        other => panic!("a new phase function in the table: {other}"),
    }
}

/// The table's tolerance, of values between 1e-4 and 1e3 given to 11 digits.
fn assert_near(actual: f64, expected: f64, what: &str) {
    let error = (actual - expected).abs();
    assert!(error <= 1e-9 * expected.abs().max(1.0), "{what}: {actual} in place of {expected}");
}

#[test]
fn values_and_moments_are_those_of_the_table() {
    let table = table();
    let cosines = numbers(&table["cos_grid"]);
    let rows = table["scalar"].as_array().unwrap();
    assert!(rows.len() >= 25);
    for row in rows {
        let phase = phase_of(row);
        let what = |of: &str| format!("{of} of {} {}", row["phase"], row["params"]);
        for (cos, value) in cosines.iter().zip(numbers(&row["values"])) {
            assert_near(phase.value_at_cosine(*cos), value, &what("value"));
        }
        assert_near(phase.mean_cosine(), row["mean_cosine"].as_f64().unwrap(), &what("mean cosine"));
        let squared = integrate(&phase, -1.0, 1.0, |cos| cos * cos);
        assert_near(squared, row["mean_cosine_squared"].as_f64().unwrap(), &what("mean squared cosine"));
    }
}

/// The quantile has the stated probability above it; where the sampler is the inverse of the cumulative distribution, it
/// gives the quantile itself.
#[test]
fn quantiles_are_those_of_the_table() {
    let table = table();
    let tails = numbers(&table["xi_grid"]);
    for row in table["scalar"].as_array().unwrap() {
        let phase = phase_of(row);
        let what = format!("quantile of {} {}", row["phase"], row["params"]);
        for (tail, quantile) in tails.iter().zip(numbers(&row["cos_at_upper_tail_probability"])) {
            let density = std::f64::consts::TAU * phase.value_at_cosine(quantile);
            let above = integrate(&phase, quantile, 1.0, |_| 1.0);
            assert!((above - tail).abs() < 1e-9 * density.max(1.0), "{what}: {above} in place of {tail}");
            if !matches!(phase, PhaseFunction::Mixture(_)) {
                assert_near(phase.sample_cosine(1.0 - tail), quantile, &what);
            }
        }
    }
}

#[test]
fn the_fog_fit_has_the_published_parameters() {
    let table = table();
    for row in table["hg_draine_fit"].as_array().unwrap() {
        let expected = |key: &str| row[key].as_f64().unwrap();
        let fit = FogFit::new(expected("diameter_um"));
        for (actual, key) in
            [(fit.g_hg, "gHG"), (fit.g_draine, "gD"), (fit.alpha, "alpha"), (fit.weight_draine, "wD")]
        {
            assert_near(actual, expected(key), &format!("{key} at {} µm", row["diameter_um"]));
        }
    }
}

/// The table's directions both point away from the particle; light travels against the first.
#[test]
fn sggx_is_that_of_the_table() {
    let table = table();
    let rows = table["sggx"].as_array().unwrap();
    assert!(rows.len() >= 16);
    for row in rows {
        let kind = match row["kind"].as_str().unwrap() {
            "surface" => SggxKind::Surface,
            _ => SggxKind::Fibre,
        };
        let before = -vector(&row["wi"]);
        let sggx = Sggx::new(kind, vector(&row["axis"]), row["roughness"].as_f64().unwrap());
        let phase = PhaseFunction::Sggx(sggx);
        let area = row["sigma"].as_f64().unwrap();
        assert!((phase.projected_area(before) - area).abs() < 1e-11, "{row}");
        let outgoing = row["wo"].as_array().unwrap();
        for (after, value) in outgoing.iter().zip(row["specular_phase"].as_array().unwrap()) {
            // Exactly forward the table has no value.
            let Some(value) = value.as_f64() else { continue };
            assert_near(phase.value(before, vector(after)), value, &row.to_string());
        }
        let mean = row["mean_cos_propagation"].as_f64().unwrap();
        assert!((phase.mean_cosine_from(before) - mean).abs() < 1e-3, "{row}");
        if before.dot(sggx.axis()).abs() > 1.0 - 1e-12 {
            assert!((phase.mean_cosine() - mean).abs() < 1e-9, "{row}");
        }
    }
}
