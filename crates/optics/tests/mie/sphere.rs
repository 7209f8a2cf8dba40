//! One sphere: efficiencies and phase function.

use serde_json::Value;
use std::f64::consts::PI;
use tyndall_optics::RefractiveIndex;
use tyndall_optics::mie::Sphere;

fn truth() -> Value {
    serde_json::from_str(include_str!("../truth/mie_sphere.json")).unwrap()
}

fn number(row: &Value, key: &str) -> f64 {
    row[key].as_f64().unwrap()
}

fn solve(row: &Value) -> Sphere {
    let m = RefractiveIndex { n: number(row, "m_re"), k: number(row, "m_im") };
    Sphere::new(m, number(row, "x")).unwrap()
}

fn efficiencies(sphere: &Sphere) -> [(&'static str, f64); 4] {
    [("Qext", sphere.q_ext), ("Qsca", sphere.q_sca), ("Qback", sphere.q_back), ("g", sphere.g)]
}

fn relative_error(value: f64, truth: f64) -> f64 {
    (value / truth - 1.0).abs()
}

/// Beyond size 50 the table's series were cut by Wiscombe's criterion, which in backscattering leaves up to 1e-7.
fn tolerance(key: &str, x: f64, digits: f64) -> f64 {
    if key == "Qback" && x > 50.0 { 2e-7 } else { digits }
}

/// The rows have nine digits, of which the last is rounded: half of it is up to 5e-9 of a value that begins with 1.
#[test]
fn efficiencies_have_all_digits_of_the_table() {
    let truth = truth();
    let rows = truth["efficiencies"].as_array().unwrap();
    for row in rows {
        for (key, value) in efficiencies(&solve(row)) {
            let error = relative_error(value, number(row, key));
            assert!(
                error < tolerance(key, number(row, "x"), 5.1e-9),
                "{key} {value} differs by {error:e} in {row}"
            );
        }
    }
    assert_eq!(rows.len(), 40);
}

#[test]
fn efficiencies_of_the_published_cases_have_ten_digits() {
    for row in truth()["solved"].as_array().unwrap() {
        for (key, value) in efficiencies(&solve(row)) {
            let error = relative_error(value, number(row, key));
            assert!(
                error < tolerance(key, number(row, "x"), 1e-10),
                "{key} {value} differs by {error:e} in {row}"
            );
        }
    }
}

#[test]
fn efficiencies_agree_with_bohren_and_huffman_and_with_wiscombe() {
    let size = 2.0 * PI * 0.525 / 0.6328;
    let cases =
        [(1.55, 0.0, size), (1.55, 0.1, size), (1.33, 1e-5, 1.0), (1.33, 1e-5, 100.0), (1.33, 1e-5, 1e4)]
            .into_iter()
            .chain([(0.75, 0.0, 0.101), (0.75, 0.0, 10.0), (0.75, 0.0, 1000.0)]);
    for ((n, k, x), row) in cases.zip(truth()["published"].as_array().unwrap()) {
        let sphere = Sphere::new(RefractiveIndex { n, k }, x).unwrap();
        for (key, value) in efficiencies(&sphere) {
            // Printed with six decimals, those of Bohren & Huffman with five to eight.
            let printed = row[key].as_f64();
            assert!(printed.is_none_or(|printed| (value - printed).abs() < 5.1e-6), "{key} {value} in {row}");
        }
    }
}

/// Where opposite amplitudes nearly cancel, digits of the sum are lost to any code; there only the decimals count.
#[test]
fn phase_functions_agree_with_the_table() {
    let truth = truth();
    let angles: Vec<f64> =
        truth["angles_deg"].as_array().unwrap().iter().map(|a| a.as_f64().unwrap()).collect();
    let mut values = 0;
    for row in truth["phase"].as_array().unwrap() {
        let sphere = solve(row);
        for (angle, expected) in angles.iter().zip(row["p_per_sr"].as_array().unwrap()) {
            let expected = expected.as_f64().unwrap();
            let value = sphere.phase_function(angle.to_radians().cos());
            let error =
                (value - expected).abs() / (1e-5 * expected + 1e-7 * sphere.phase_function(1.0).min(1.0));
            assert!(error < 1.0, "{value} at {angle}° differs from {expected} for m, x of {row}");
            values += 1;
        }
    }
    assert_eq!(values, 40 * 26);
}

/// (8/3)x⁴|(m²−1)/(m²+2)|², 4x Im (m²−1)/(m²+2) and 3/(16π)(1 + cos²θ), with corrections of order x².
#[test]
fn small_spheres_scatter_as_rayleigh_says() {
    for (n, k) in [(1.33_f64, 0.0_f64), (1.33, 1e-9), (1.5, 0.1), (0.2, 3.4)] {
        let (re, im) = (n * n - k * k, 2.0 * n * k);
        let norm = (re + 2.0).powi(2) + im * im;
        let [real, imaginary] = [((re - 1.0) * (re + 2.0) + im * im) / norm, 3.0 * im / norm];
        for x in [1e-6, 1e-4, 1e-3] {
            let sphere = Sphere::new(RefractiveIndex { n, k }, x).unwrap();
            let tolerance = 10.0 * x * x + 1e-13;
            let scattering = 8.0 / 3.0 * x.powi(4) * (real * real + imaginary * imaginary);
            // Metals: radiation adds a relative x³ to absorption, and n = 0.2 has a steep x² term.
            assert!(relative_error(sphere.q_sca, scattering) < tolerance, "{n} {k} {x}");
            if k > 0.0 {
                assert!(relative_error(sphere.q_abs, 4.0 * x * imaginary) < tolerance, "{n} {k} {x}");
            }
            assert!(sphere.g.abs() < x * x);
            for cos in [-1.0, -0.3, 0.0, 1.0_f64] {
                let rayleigh = 3.0 / (16.0 * PI) * (1.0 + cos * cos);
                assert!(
                    relative_error(sphere.phase_function(cos), rayleigh) < tolerance,
                    "{n} {k} {x} {cos}"
                );
            }
        }
    }
}

/// Great spheres take twice their cross section from the beam, with 2Q ≈ x^{-2/3} more (Nussenzveig & Wiscombe 1980).
#[test]
fn great_spheres_tend_to_twice_their_cross_section() {
    for (x, tolerance) in [(1e3, 0.03), (1e4, 0.006), (1e5, 0.0015)] {
        let sphere = Sphere::new(RefractiveIndex { n: 1.5, k: 0.1 }, x).unwrap();
        assert!(
            (sphere.q_ext - 2.0 - 1.9924 * f64::powf(x, -2.0 / 3.0)).abs() < 0.1 * tolerance,
            "{x} {}",
            sphere.q_ext
        );
    }
}

/// Absorption far below the last digit of extinction: it is proportional to k as long as the sphere is transparent.
#[test]
fn weak_absorption_keeps_its_digits() {
    for x in [0.01, 1.0, 100.0, 3000.0] {
        let absorption = |k| Sphere::new(RefractiveIndex { n: 1.33, k }, x).unwrap().q_abs;
        let ratio = absorption(1e-18) / absorption(1e-19);
        assert!((ratio - 10.0).abs() < 1e-6, "{x}: {ratio}");
    }
}

#[test]
fn impossible_spheres_are_refused_with_the_reason() {
    let refusal = |n, k, x| Sphere::new(RefractiveIndex { n, k }, x).unwrap_err().to_string();
    for x in [0.0, -1.0, 1e-7, 1e6, f64::NAN, f64::INFINITY] {
        assert!(refusal(1.33, 0.0, x).contains("must be from 1e-6 to 1e5"));
    }
    assert!(refusal(1.33, -1e-9, 1.0).contains("k from 0"));
    assert!(refusal(f64::NAN, 0.0, 1.0).contains("n must be"));
    assert!(refusal(1.0, 0.0, 1.0).contains("do not scatter"));
    assert!(refusal(90.0, 0.0, 1e5).contains("make the sphere smaller"));
}
