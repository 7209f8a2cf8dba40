//! Averages over size distributions.

use serde_json::Value;
use std::f64::consts::TAU;
use tyndall_optics::Material;
use tyndall_optics::mie::{MieAverage, SizeDistribution, SizeLaw};

fn truth() -> Value {
    serde_json::from_str(include_str!("../truth/mie_distributions.json")).unwrap()
}

fn number(row: &Value, key: &str) -> f64 {
    row[key].as_f64().unwrap()
}

fn average(row: &Value) -> MieAverage {
    let law = match row["distribution"].as_str().unwrap() {
        "gamma_cloud" | "gamma_fog" => {
            SizeLaw::Gamma { r_eff: number(row, "r_eff"), v_eff: number(row, "v_eff") }
        }
        "lognormal_haze" => SizeLaw::LogNormal { r_g: number(row, "r_g"), sigma_g: number(row, "sigma_g") },
        "deirmendjian_C1" => SizeLaw::ModifiedGamma {
            r_mode: number(row, "r_mode"),
            alpha: number(row, "alpha"),
            gamma: number(row, "gamma"),
        },
        other => panic!("unknown distribution {other}"),
    };
    let wavelength = 1000.0 * number(row, "wavelength_um");
    let m = Material::Water.refractive_index(wavelength).unwrap();
    MieAverage::new(m, wavelength, &SizeDistribution::from(law)).unwrap()
}

/// The table at cos θ, linear between its rows, as it is sampled.
fn interpolate(rows: &[(f64, f64)], cos: f64) -> f64 {
    let below = rows.partition_point(|row| row.0 > cos).clamp(1, rows.len() - 1);
    let [left, right] = [rows[below - 1], rows[below]];
    left.1 + (cos - left.0) / (right.0 - left.0) * (right.1 - left.1)
}

fn angles(truth: &Value) -> Vec<f64> {
    truth["angles_deg"].as_array().unwrap().iter().map(|angle| angle.as_f64().unwrap()).collect()
}

/// ∫ f_p dω and ∫ f_p cos θ dω of a table that is linear between its rows.
fn moments(rows: &[(f64, f64)]) -> [f64; 2] {
    let mut moments = [0.0; 2];
    for pair in rows.windows(2) {
        let [(right, above), (left, below)] = [pair[0], pair[1]];
        let width = TAU * (right - left);
        moments[0] += width * 0.5 * (above + below);
        moments[1] += width / 6.0 * (below * (2.0 * left + right) + above * (left + 2.0 * right));
    }
    moments
}

/// Rows of the table, of which the whole proof takes all.
fn rows(truth: &Value) -> Vec<(&Value, &Value)> {
    let rows = truth["averages"].as_array().unwrap().iter().zip(truth["phase"].as_array().unwrap());
    let is_full = std::env::var("TYNDALL_PROOF").is_ok_and(|value| value == "full");
    // The clouds at two wavelengths are one claim, and the dearest.
    rows.filter(|(row, _)| is_full || row["distribution"] != "gamma_cloud" || row["wavelength_um"] == 0.55)
        .collect()
}

#[test]
fn averages_of_water_droplets_agree_with_the_table() {
    let truth = truth();
    let angles = angles(&truth);
    for (row, phase) in rows(&truth) {
        let average = average(row);
        for (value, key) in [
            (average.q_ext, "Qext"),
            (average.q_sca, "Qsca"),
            (average.g, "g"),
            (average.albedo(), "albedo"),
            (average.c_ext(), "sigma_ext_per_particle_um2"),
            (average.c_ext() / average.volume, "ext_per_volume_fraction_per_um"),
        ] {
            let error = (value / number(row, key) - 1.0).abs();
            assert!(error < 1e-4, "{key} {value} differs by {error:e} in {row}");
        }
        // Absorption of transparent droplets happens in resonances, which no grid of sizes has all of.
        let absorbed = (1.0 - average.q_abs / average.q_ext / number(row, "one_minus_albedo")).abs();
        assert!(absorbed < 0.15, "1 − albedo differs by {absorbed} in {row}");
        let table = average.rows();
        for (angle, expected) in angles.iter().zip(phase["p_per_sr"].as_array().unwrap()) {
            let (value, expected) =
                (interpolate(&table, angle.to_radians().cos()), expected.as_f64().unwrap());
            let tolerance = if *angle >= 179.0 { 0.02 } else { 0.01 };
            let error = (value / expected - 1.0).abs();
            assert!(error < tolerance, "p {value} differs by {error} at {angle}° in {row}");
        }
        let [integral, first] = moments(&table);
        assert!(
            (integral - 1.0).abs() < 2e-4 && (first / integral - average.g).abs() < 1e-4,
            "{integral} {first} {row}"
        );
    }
}
