//! `tyndall phase`: its keys, its table and its picture; wrong input is told in one line.

mod command;

use command::Folder;
use serde_json::Value;

fn json(folder: &Folder, line: &str) -> Value {
    serde_json::from_str(&folder.done(line).out).unwrap_or_else(|error| panic!("{line}: {error}"))
}

fn numbers(value: &Value) -> Vec<f64> {
    value.as_array().unwrap().iter().map(|number| number.as_f64().unwrap()).collect()
}

#[test]
fn json_has_g_angles_and_values_that_integrate_to_one() {
    let folder = Folder::new();
    for (spec, g) in [
        ("isotropic", 0.0),
        ("hg(g=0.5)", 0.5),
        ("hg:-0.3", -0.3),
        ("rayleigh", 0.0),
        ("draine(g=0.3,alpha=10)", 0.447_567_567_57),
        ("cornette-shanks(g=0.6)", 0.665_084_745_76),
        ("double-hg(g1=0.6,g2=0.1,weight=0.75)", 0.475),
        ("sggx(kind=surface,roughness=0.5)", -0.434_405_012_34),
    ] {
        let answer = json(&folder, &format!("phase {spec} --json"));
        assert!((answer["g"].as_f64().unwrap() - g).abs() < 1e-9, "{spec}: {answer}");
        let (angles, values) = (numbers(&answer["angles_deg"]), numbers(&answer["values"]));
        assert_eq!((angles.len(), angles[0], angles[180]), (181, 0.0, 180.0));
        // The trapezoid rule in the angle.
        let integral: f64 = angles
            .iter()
            .zip(&values)
            .map(|(angle, value)| {
                value * 2.0 * std::f64::consts::PI * angle.to_radians().sin() * 1_f64.to_radians()
            })
            .sum();
        assert!((integral - 1.0).abs() < 2e-3, "{spec}: {integral}");
    }
}

#[test]
fn angles_are_those_asked_for_and_several_specs_give_an_array() {
    let folder = Folder::new();
    let answer = json(&folder, "phase rayleigh --json --angles 0,90,...,180");
    let expected = [2.0, 1.0, 2.0].map(|n| n * 3.0 / (16.0 * std::f64::consts::PI));
    assert_eq!(numbers(&answer["angles_deg"]), [0.0, 90.0, 180.0]);
    for (value, expected) in numbers(&answer["values"]).iter().zip(expected) {
        assert!((value - expected).abs() < 1e-12, "{answer}");
    }
    let answers = json(&folder, "phase rayleigh hg:0.5 --json --angles 7");
    assert_eq!(answers[1]["phase"], "hg:0.5");
    assert_eq!(answers.as_array().map(Vec::len), Some(2));
}

/// Seen across their axis, fibres of roughness 1/2 turn their whole area; the mean cosine is that of the closed form
/// for light along the axis, and of the reference values for light across it.
#[test]
fn oriented_particles_are_seen_from_the_incidence() {
    let folder = Folder::new();
    let spec = "sggx(kind=fibre,roughness=0.5,axis=[1,0,0])";
    for (option, area, g) in [
        ("", 0.5, 0.434_405_012_34),
        ("--incidence -1,0,0", 0.5, 0.434_405_012_34),
        ("--incidence 0,0,2", 1.0, -0.185_185_185_19),
    ] {
        let answer = json(&folder, &format!("phase {spec} --json {option}"));
        assert!((answer["projected_area"].as_f64().unwrap() - area).abs() < 1e-12, "{answer}");
        assert!((answer["g"].as_f64().unwrap() - g).abs() < 1e-6, "{option}: {}", answer["g"]);
        let values = numbers(&answer["values"]);
        let step = (1_f64).to_radians();
        let mean = |f: &dyn Fn(f64) -> f64| -> f64 {
            let terms = values.iter().enumerate().map(|(i, value)| {
                let theta = i as f64 * step;
                value * f(theta.cos()) * 2.0 * std::f64::consts::PI * theta.sin() * step
            });
            terms.sum()
        };
        assert!((mean(&|_| 1.0) - 1.0).abs() < 1e-3 && (mean(&|cos| cos) - g).abs() < 1e-3, "{option}");
    }
}

#[test]
fn tables_are_read_and_the_choice_of_a_wavelength_is_told() {
    let folder = Folder::new();
    folder.write("two.csv", "angle_deg,450,650\n0,1,3\n180,1,1\n");
    let run = folder.done("phase tabulated(file=two.csv) --json --angles 0,180");
    assert!(run.err.contains("550 nm") && run.err.lines().count() == 1, "{}", run.err);
    let run = folder.done("phase tabulated(file=two.csv,wavelength=650nm) --angles 0,180");
    assert!(run.err.is_empty() && run.out.contains("1.193662e-1"), "{}{}", run.out, run.err);
}

#[test]
fn the_picture_holds_every_curve_and_appears_whole() {
    let folder = Folder::new();
    for radius in ["log", "linear"] {
        folder.done(&format!("phase fog(d=10um) hg:0.85 isotropic -o phase.svg --radius {radius}"));
        let svg = String::from_utf8(folder.read("phase.svg")).unwrap();
        assert!(svg.starts_with("<svg ") && svg.ends_with("</svg>\n"));
        // In the polar diagram, over the axes, and in the legend.
        assert_eq!(svg.matches("class=\"curve\"").count(), 9);
        for name in ["fog(d=10um), g = 0.8642", "hg:0.85, g = 0.8500", "isotropic, g = 0.0000"] {
            assert!(svg.contains(name), "{name}");
        }
        assert!(!svg.contains("NaN") && !svg.contains("inf"));
    }
    assert_eq!(folder.names(), ["phase.svg", "scene.toml"]);
}

#[test]
fn wrong_input_is_told_in_one_line() {
    let folder = Folder::new();
    folder.write("wrong.txt", "0 1\n10 -1\n");
    for (line, words) in [
        ("phase hgg:0.85", ["hgg:0.85: ", "did you mean `hg`?"]),
        ("phase hg:1.5", ["`g`", "between -1 and 1"]),
        ("phase tabulated(file=no.txt)", ["no.txt: ", "no such file"]),
        ("phase tabulated(file=wrong.txt)", ["wrong.txt: line 2", "negative"]),
        ("phase hg:0.5 --incidence 1,0,0", ["--incidence", "sggx"]),
        ("phase hg:0.5 -o no/such.svg", ["no/such.svg", "create it"]),
    ] {
        let run = folder.run(line);
        assert_eq!(
            (run.code, run.out.as_str(), run.err.lines().count()),
            (Some(1), "", 1),
            "{line}: {}",
            run.err
        );
        assert!(words.iter().all(|word| run.error().contains(word)), "{line}: {}", run.err);
    }
    for line in [
        "phase",
        "phase hg:0.5 --angles 0,200",
        "phase hg:0.5 --angles ...",
        "phase hg:0.5 -o phase.png",
        "phase hg:0.5 --radius square",
        "phase rayleigh --incidence 0,0,0",
        "phase rayleigh --incidence 1,2",
    ] {
        assert_eq!(folder.run(line).code, Some(2), "{line}");
    }
}

#[test]
fn slabs_take_any_phase_function() {
    let folder = Folder::new();
    let slab = |options: &str| {
        let answer = json(&folder, &format!("slab --tau 1 --albedo 0.9 --samples 2000 --json {options}"));
        answer["reflectance"]["mean"].as_f64().unwrap()
    };
    assert_eq!(slab("--phase hg:0.75"), slab("--g 0.75"));
    assert_eq!(slab("--phase isotropic"), slab("--g 0"));
    assert!(slab("--phase fog(d=10um)") < slab("--phase rayleigh"));
    let run = folder.run("slab --tau 1 --albedo 1 --phase hgg:0.75");
    assert!(run.code == Some(1) && run.error().contains("did you mean `hg`?"), "{}", run.err);
}
