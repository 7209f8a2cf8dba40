//! `tyndall slab` and `tyndall measure` as their users meet them: keys of the answers, and wrong input.

mod command;

use command::Folder;
use serde_json::Value;

fn json(folder: &Folder, line: &str) -> Value {
    serde_json::from_str(&folder.done(line).out).unwrap_or_else(|error| panic!("{line}: {error}"))
}

/// Whether a value is within four of its standard errors of the truth.
fn is_near(value: &Value, truth: f64) -> bool {
    let [mean, error] = ["mean", "standard_error"].map(|key| value[key].as_f64().expect("a number"));
    (mean - truth).abs() <= 4.0 * error
}

#[test]
fn a_slab_is_answered_with_the_keys_that_programs_read() {
    let folder = Folder::new();
    let answer =
        json(&folder, "slab --tau 2 --albedo 0.9 --g 0.75 --samples 20000 --radiance 0.9,0.5 --json");
    assert!(is_near(&answer["reflectance"], 0.097_394_6), "{answer}");
    assert!(is_near(&answer["transmittance"], 0.660_957_7), "{answer}");
    assert!(is_near(&answer["absorptance"], 0.241_647_7), "{answer}");
    assert!((answer["unscattered"]["mean"].as_f64().unwrap() - (-2.0_f64).exp()).abs() < 1e-12);
    assert_eq!(answer["samples"], 20000);
    assert!(answer["seconds"].is_number());
    assert!(is_near(&answer["radiance"][1]["reflected"], 0.038_057_84), "{answer}");
    assert!(is_near(&answer["radiance"][1]["transmitted"], 0.088_443), "{answer}");

    let half = json(&folder, "slab --tau inf --albedo 1 --samples 200 --json");
    assert_eq!(half["reflectance"]["mean"], 1.0);
    assert_eq!(half["transmittance"]["mean"], 0.0);
    let text = folder.done("slab --tau 1 --albedo 1 --phase rayleigh --samples 1000").out;
    assert!(text.contains("reflectance") && text.contains("+-") && text.contains("1000 photons"), "{text}");
}

#[test]
fn neither_threads_nor_the_end_of_the_line_change_a_slab() {
    let folder = Folder::new();
    let line = "slab --tau 2 --albedo 0.9 --samples 20000 --seed 3 --json";
    let value = |line: &str| json(&folder, line)["reflectance"].clone();
    assert_eq!(value(&format!("{line} --threads 1")), value(&format!("{line} --threads 3")));
    let wanted = json(&folder, "slab --tau 2 --albedo 0.9 --error 2% --json");
    for key in ["reflectance", "transmittance"] {
        let [mean, error] = ["mean", "standard_error"].map(|part| wanted[key][part].as_f64().unwrap());
        assert!(error <= 0.02 * mean, "{wanted}");
    }
}

#[test]
fn impossible_slabs_are_refused() {
    let folder = Folder::new();
    for (line, code) in [
        ("slab --tau -1 --albedo 1", 2),
        ("slab --tau nan --albedo 1", 2),
        ("slab --tau 1e9 --albedo 1", 2),
        ("slab --tau 1 --albedo 1.1", 2),
        ("slab --tau 1 --albedo -0.1", 2),
        ("slab --tau 1 --albedo 1 --g 1", 2),
        ("slab --tau 1 --albedo 1 --g nan", 2),
        ("slab --tau 1 --albedo 1 --n 0.5", 2),
        ("slab --tau 1 --albedo 1 --incidence 90", 2),
        ("slab --tau 1 --albedo 1 --radiance 0", 2),
        ("slab --tau 1 --albedo 1 --samples 0", 2),
        ("slab --tau 1 --albedo 1 --g 0.5 --phase rayleigh", 2),
        ("slab --tau 1 --albedo 1 --phase raleigh", 1),
        ("slab --tau inf --albedo 1 --ground-albedo 0.5", 1),
        ("slab --tau 1 --albedo 1 --n 1.33 --radiance 1", 1),
    ] {
        let run = folder.run(line);
        assert_eq!(run.code, Some(code), "{line}: {}", run.err);
        assert!(run.out.is_empty() && !run.error().is_empty(), "{line}");
    }
}

const METERS: &str = r#"
camera = { position = [0, 0, 5], target = [0, 0, 0] }
[[volume]]
slab = { bottom = 0, top = 2 }
mu_t = 1
albedo = 0.9
phase = { type = "hg", g = 0.75 }
[[light]]
type = "constant"
radiance = [1, 2, 4]
[[meter]]
name = "slab"
type = "layer"
bottom = 0
top = 2
direction = [0, -1, 0]
"#;

#[test]
fn a_single_layer_is_answered_at_the_top_and_by_its_name() {
    let folder = Folder::new();
    folder.write("slab.toml", METERS);
    let answer = json(&folder, "measure slab.toml --samples 20000 --json");
    assert!(is_near(&answer["reflectance"], 0.097_394_6), "{answer}");
    assert!(is_near(&answer["unscattered"], (-2.0_f64).exp()), "{answer}");
    assert_eq!(answer["meters"]["slab"], {
        let mut only = answer.clone();
        only.as_object_mut().unwrap().remove("meters");
        only
    });
}

#[test]
fn meters_of_all_types_are_answered_by_name() {
    let folder = Folder::new();
    let more = r#"
        [[meter]]
        name = "tiles"
        type = "layer"
        bottom = 0
        top = 2
        periodic = [0, 0, 4, 1]
        columns = [4, 1]
        radiance = [[0, 0], [180, 0]]
        [[meter]]
        type = "irradiance"
        position = [0, 9, 0]
        normal = [0, 1, 0]
        [[meter]]
        name = "up"
        type = "radiance"
        position = [0, 9, 0]
        direction = [0, 1, 0]
        "#;
    folder.write("meters.toml", format!("{METERS}{more}"));
    let answer = json(&folder, "measure meters.toml --samples 4000 --json");
    assert!(answer.get("reflectance").is_none(), "with several meters none is at the top");
    let tiles = &answer["meters"]["tiles"];
    assert_eq!(tiles["columns"]["reflectance"]["mean"].as_array().unwrap().len(), 4);
    assert_eq!(tiles["radiance"][1]["theta"], 180.0);
    assert_eq!(tiles["radiance"][1]["columns"]["mean"].as_array().unwrap().len(), 4);
    assert_eq!(answer["meters"]["up"]["radiance"]["mean"], serde_json::json!([1.0, 2.0, 4.0]));
    let irradiance = &answer["meters"]["meter.2"]["irradiance"]["mean"][0];
    assert!((irradiance.as_f64().unwrap() / std::f64::consts::PI - 1.0).abs() < 0.2, "{answer}");
    let text = folder.done("measure meters.toml --samples 1000").out;
    assert!(text.contains("tiles") && text.contains("irradiance"), "{text}");

    folder.write(
        "ball.toml",
        METERS.replace("slab = { bottom = 0, top = 2 }", "sphere = { center = [0, 0, 0], radius = 1 }"),
    );
    let run = "measure ball.toml --samples 1000 --set meter.0.type=body --set meter.0.bins=4";
    assert_eq!(folder.run(run).code, Some(1), "a body has no faces");
}

#[test]
fn scenes_that_a_meter_does_not_fit_are_refused_with_the_mend() {
    let folder = Folder::new();
    folder.write("meters.toml", METERS);
    for (line, words) in [
        ("measure scene.toml", ["scene.toml", "[[meter]]"]),
        ("measure nosuch.toml", ["nosuch.toml", "no such file"]),
        ("measure meters.toml --set volume.0.albedo=[0.1,0.2,0.3]", ["`volume.0`", "channel"]),
        ("measure meters.toml --set volume.0.transform.rotate=[10,0,0]", ["`volume.0`", "periodic"]),
        ("measure meters.toml --set meter.0.direction=[0,1,0]", ["direction", "below 0"]),
        ("measure meters.toml --set meter.0.direction=[1,0,0]", ["direction", "below 0"]),
        ("measure meters.toml --set meter.0.top=0", ["`bottom` must be less", "empty"]),
        ("measure meters.toml --set meter.0.columns=[2,2]", ["columns", "periodic"]),
        ("measure meters.toml --set meter.0.periodic=[0,0,0,1]", ["periodic", "x0 < x1"]),
        ("measure meters.toml --set meter.0.radiance=[[90,0]]", ["radiance", "90"]),
        ("measure meters.toml --set meter.0.ground_albedo=2", ["ground_albedo", "from 0 to 1"]),
        ("measure meters.toml --set meter.0.typ=1", ["typ", "[[meter]]"]),
    ] {
        let run = folder.run(line);
        assert_eq!(run.code, Some(1), "{line}: {}", run.err);
        for word in words {
            assert!(run.error().contains(word), "{line}: `{word}` is not in: {}", run.error());
        }
    }
}
