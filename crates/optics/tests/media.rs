//! Measured media against `truth/measured_media.json`, and half-spaces against `truth/half_space.json`.

use serde_json::Value;
use tyndall_optics::albedo_inversion::{albedo_of_reflectance, reflectance_of_albedo};
use tyndall_optics::presets::{MEASURED_MEDIA, measured_medium};

fn table(text: &str, name: &str) -> Vec<Vec<Value>> {
    let truth: Value = serde_json::from_str(text).expect("the table is JSON");
    serde_json::from_value(truth[name].clone()).expect("rows")
}

fn number(value: &Value) -> f64 {
    value.as_f64().expect("a number")
}

fn channels(value: &Value) -> [f64; 3] {
    serde_json::from_value(value.clone()).expect("three numbers")
}

#[test]
fn every_measured_medium_has_its_printed_coefficients() {
    let text = include_str!("truth/measured_media.json");
    let (jensen, narasimhan) = (table(text, "jensen2001"), table(text, "narasimhan2006"));
    assert!(jensen.len() >= 8 && narasimhan.len() >= 23);
    for row in jensen.iter().chain(&narasimhan) {
        let name = row[0].as_str().expect("a name");
        let medium = measured_medium(name).unwrap_or_else(|| panic!("there is no {name}"));
        assert_eq!(medium.mu_s.to_array(), channels(&row[1]), "{name}");
        assert_eq!(medium.mu_a.to_array(), channels(&row[2]), "{name}");
        let g = row.get(3).map_or([0.0; 3], channels);
        assert_eq!(medium.g.to_array(), g, "{name}");
        if let Some(reduced) = row.get(4) {
            // The coefficients are rounded to 5 decimals, g to 3.
            let here = medium.mu_s * (1.0 - medium.g);
            let rounded = 5e-6 * (1.0 - medium.g) + 5e-4 * medium.mu_s;
            for (channel, printed) in channels(reduced).into_iter().enumerate() {
                let tolerance = rounded[channel] + 1e-4 * printed;
                assert!((here[channel] - printed).abs() <= tolerance, "{name}: {here}, not {printed}");
            }
        }
    }
}

#[test]
fn names_of_measured_media_are_found_however_they_are_spelt() {
    for medium in &MEASURED_MEDIA {
        assert_eq!(measured_medium(medium.name), Some(medium), "another medium is found as {}", medium.name);
    }
    for name in ["skimmilk", "Skim milk", "SKIM_MILK"] {
        assert_eq!(measured_medium(name).map(|medium| medium.name), Some("Skimmilk"));
    }
    assert_eq!(measured_medium("lava"), None);
}

#[test]
fn half_spaces_reflect_what_h_functions_say() {
    let rows = table(include_str!("truth/half_space.json"), "isotropic");
    assert!(rows.len() > 5);
    for row in rows {
        let [albedo, truth] = [0, 1].map(|column| number(&row[column]));
        let reflectance = reflectance_of_albedo(albedo, 0.0);
        assert!((reflectance - truth).abs() < 2e-5, "{albedo}: {reflectance}, not {truth}");
        assert!((albedo_of_reflectance(truth, 0.0) - albedo).abs() < 1e-4, "{albedo}");
    }
}

#[test]
fn half_spaces_of_other_phase_functions_reflect_nearly_what_similarity_says() {
    let rows = table(include_str!("truth/half_space.json"), "henyey_greenstein");
    assert!(rows.len() > 10);
    let mut worst: f64 = 0.0;
    for row in rows {
        let [albedo, g, truth] = [0, 1, 2].map(|column| number(&row[column]));
        worst = worst.max((reflectance_of_albedo(albedo, g) - truth).abs());
    }
    assert!(worst < 0.005, "off by {worst}");
}
