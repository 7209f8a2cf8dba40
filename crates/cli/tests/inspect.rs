//! `tyndall inspect --json` says of real files what OpenVDB says of them.

use std::path::Path;
use std::process::Command;

use serde_json::Value;

fn inspect(path: &Path, arguments: &[String]) -> Value {
    let output = Command::new(env!("CARGO_BIN_EXE_tyndall"))
        .arg("inspect")
        .arg(path)
        .arg("--json")
        .args(arguments)
        .output()
        .unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    serde_json::from_slice(&output.stdout).unwrap()
}

/// Equal within the rounding of sums in another order; what is no number in JSON is `null` here.
fn agrees(ours: &Value, theirs: &Value) -> bool {
    match (ours, theirs) {
        (Value::Array(a), Value::Array(b)) => {
            a.len() == b.len() && a.iter().zip(b).all(|(a, b)| agrees(a, b))
        }
        (Value::Null, theirs) => theirs.as_f64().is_none_or(|x| !x.is_finite()),
        (ours, theirs) => match (ours.as_f64(), theirs.as_f64()) {
            (Some(a), Some(b)) => (a - b).abs() <= 1e-5 * a.abs().max(b.abs()).max(1e-3),
            _ => ours == theirs,
        },
    }
}

#[test]
fn every_fact_and_probe_of_the_expected_values_is_told() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/volumes");
    let Ok(text) = std::fs::read_to_string(folder.join("expected.json")) else {
        eprintln!("skipped: {} is not there", folder.display());
        return;
    };
    // Python writes NaN, which is no JSON.
    let expected: Value = serde_json::from_str(&text.replace("NaN", "null")).unwrap();
    let files = ["arnold_grids", "mantaflow_0001", "mj_sphere", "variants/bool", "variants/nan_inf_neg"];
    for name in files.map(|name| format!("{name}.vdb")) {
        for grid in expected[&name]["grids"].as_array().unwrap() {
            check_grid(&folder.join(&name), grid, expected[&name]["grids"].as_array().unwrap());
        }
    }
}

/// `grid` is one of the grids expected of the file.
fn check_grid(path: &Path, grid: &Value, all: &[Value]) {
    let probes = grid.get("probes").and_then(Value::as_array).cloned().unwrap_or_default();
    let arguments: Vec<String> = probes
        .iter()
        .map(|probe| format!("--probe={}", probe[0].to_string().trim_matches(['[', ']'])))
        .collect();
    let report = inspect(path, &arguments);
    // Several grids may have one name; they stand in the order of the file.
    let same_name = |g: &&Value| g["name"] == grid["name"];
    let place = all.iter().filter(same_name).position(|g| std::ptr::eq(g, grid)).unwrap();
    let ours = report["grids"].as_array().unwrap().iter().filter(same_name).nth(place).unwrap();
    for key in
        ["type", "class", "active_voxels", "saved_as_half", "background", "min", "max", "sum", "non_finite"]
    {
        if let Some(theirs) = grid.get(key) {
            assert!(agrees(&ours[key], theirs), "{} {key}: {} {theirs}", path.display(), ours[key]);
        }
    }
    assert_eq!(ours["index_bbox"], grid["active_bbox_index"]);
    let map = &grid["index_to_world"];
    for row in 0..3 {
        for (column, key) in ["di", "dj", "dk", "origin"].iter().enumerate() {
            assert!(agrees(&ours["index_to_world"][row][column], &map[key][row]), "{}", path.display());
        }
    }
    for (i, probe) in probes.iter().enumerate() {
        assert!(agrees(&ours["probes"][i], probe), "{}: {} {probe}", path.display(), ours["probes"][i]);
    }
}
