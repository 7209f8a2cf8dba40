//! `tyndall phase mie(…)`: spheres of Lorenz-Mie theory, kept in the cache.

mod command;

use command::Folder;
use serde_json::Value;

fn json(folder: &Folder, line: &str) -> Value {
    serde_json::from_str(&folder.done(line).out).unwrap_or_else(|error| panic!("{line}: {error}"))
}

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or_else(|| panic!("{value} is no number"))
}

/// Qext, Qsca, Qback and g of an independent solution in forty digits.
#[test]
fn a_single_sphere_is_exact() {
    let folder = Folder::new();
    let answer = json(&folder, "phase mie(m=1.33+1e-5i,x=10) --json --angles 0,90,180");
    for (key, expected) in
        [("q_ext", 2.20659294), ("q_sca", 2.20613778), ("q_back", 0.560832896), ("g", 0.712504141)]
    {
        assert!((number(&answer[key]) / expected - 1.0).abs() < 5e-9, "{key}: {answer}");
    }
    // Qback = 4|S(180°)|²/x² and p = (|S₁|² + |S₂|²)/(2πx²Qsca).
    let backward = number(&answer["q_back"]) / (4.0 * std::f64::consts::PI * number(&answer["q_sca"]));
    assert!((number(&answer["values"][2]) / backward - 1.0).abs() < 1e-9, "{answer}");
}

/// Water haze at 550 nm: the row of an independent code. The second run reads what the first one wrote.
#[test]
fn a_distribution_is_averaged_and_kept() {
    let folder = Folder::new();
    let long = "phase mie(material=water,wavelength=550nm,distribution=lognormal(r_g=0.2um,sigma_g=1.6)) --json \
                --angles 0,30,140,180";
    let first = json(&folder, long);
    for (key, expected) in [("q_ext", 2.3051559), ("q_sca", 2.3051559), ("g", 0.80504118)] {
        assert!((number(&first[key]) / expected - 1.0).abs() < 1e-4, "{key}: {first}");
    }
    for (value, expected) in
        first["values"].as_array().unwrap().iter().zip([1.9405021, 0.3079507, 0.0065946982, 0.0092377066])
    {
        assert!((number(value) / expected - 1.0).abs() < 0.01, "{first}");
    }
    let kept: Vec<_> = std::fs::read_dir(folder.path("cache/mie")).unwrap().collect();
    assert_eq!(kept.len(), 1);
    let short = json(&folder, "phase mie:water:0.2um:lognormal(1.6) --json --angles 0,30,140,180");
    assert_eq!((&short["values"], &short["g"]), (&first["values"], &first["g"]));
    assert_eq!(std::fs::read_dir(folder.path("cache/mie")).unwrap().count(), 1);
    let table = folder.done("phase mie:water:0.2um:lognormal(1.6) hg:0.5 --angles 0");
    assert!(table.out.contains("q_ext") && table.out.contains("2.305"), "{}", table.out);
    assert!(table.err.contains("the wavelength is 550 nm"), "{}", table.err);
}

#[test]
fn mistakes_are_told_in_one_line() {
    let folder = Folder::new();
    for (spec, word) in [
        ("mie(m=1.33)", "`distribution` or `x`"),
        ("mie(m=1,x=1)", "do not scatter"),
        ("mie(m=50,x=1e5)", "make the sphere smaller"),
        ("mie:water:10um:gamma(0.7)", "`v_eff`"),
        ("mie(material=soot,x=1,wavelength=100nm)", "soot is known from 250 to 2500 nm"),
        ("mie(material_file=none.csv,x=1,wavelength=550nm)", "none.csv"),
    ] {
        let run = folder.run(&format!("phase {spec}"));
        assert_eq!(run.code, Some(1), "{spec}: {}", run.out);
        let message = run.error();
        assert!(message.contains(word), "{spec}: {message}");
    }
}
