//! Every `.vdb` of the shared corpus reads as OpenVDB reads it, or is refused where it is damaged.

use serde_json::Value;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use tyndall_volumes::vdb::{self, VdbFile};
use tyndall_volumes::{Grid, GridClass, GridSelection, GridValues, ReadError};

/// OpenVDB reads these without a word; a user is better served by an error.
const REFUSED_THOUGH_OPENVDB_READS: [(&str, &str); 3] = [
    ("variants/bad_garbage_after_magic.vdb", "claimed"),
    ("variants/bad_truncated_header.vdb", "truncated"),
    ("variants/bad_version999.vdb", "version 999"),
];
/// OpenVDB for Python knows no such grids, but they are sound.
const READ_THOUGH_PYTHON_REFUSES: [&str; 4] =
    ["daichi_smoke.vdb", "variants/double.vdb", "variants/int32.vdb", "variants/maskgrid.vdb"];

fn volumes() -> Option<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/volumes");
    if !folder.is_dir() {
        eprintln!("skipped: {} is not there", folder.display());
        return None;
    }
    Some(folder)
}

fn corpus() -> Option<(PathBuf, BTreeMap<String, Value>)> {
    let folder = volumes()?;
    let text = std::fs::read_to_string(folder.join("expected.json")).unwrap();
    Some((folder, serde_json::from_str(&text).unwrap()))
}

fn read(path: &Path) -> Result<VdbFile, ReadError> {
    vdb::read(path, &GridSelection::All)
}

#[test]
fn every_file_is_expected() {
    let Some((folder, expected)) = corpus() else { return };
    let mut files = Vec::new();
    for sub in ["", "variants", "damaged"] {
        for entry in std::fs::read_dir(folder.join(sub)).unwrap() {
            let path = entry.unwrap().path();
            if path.extension().is_some_and(|extension| extension == "vdb") {
                files.push(
                    path.strip_prefix(&folder).unwrap().to_str().unwrap().trim_start_matches('/').to_owned(),
                );
            }
        }
    }
    assert!(files.len() > 50);
    for file in files {
        assert!(expected.contains_key(&file), "{file} is not in expected.json");
    }
}

#[test]
fn damaged_and_unsupported_files_are_refused_in_one_line() {
    let Some((folder, expected)) = corpus() else { return };
    let mut refusals = 0;
    for (file, expected) in &expected {
        let stricter = REFUSED_THOUGH_OPENVDB_READS.iter().find(|(name, _)| name == file);
        let refused = expected.get("refused_by_openvdb").is_some()
            && !READ_THOUGH_PYTHON_REFUSES.contains(&file.as_str());
        if !refused && stricter.is_none() && file != "variants/xform_frustum.vdb" {
            continue;
        }
        let message = read(&folder.join(file)).expect_err(file).to_string();
        eprintln!("{message}");
        assert!(message.contains(file) && !message.contains('\n') && message.len() < 400, "{message}");
        assert!(message.contains(stricter.map_or("", |(_, word)| word)), "{message}");
        refusals += 1;
    }
    assert!(refusals >= 15, "{refusals}");
}

#[test]
fn every_sound_file_has_the_values_that_openvdb_reads() {
    let Some((folder, expected)) = corpus() else { return };
    let mut checked = 0;
    for (file, expected) in &expected {
        if REFUSED_THOUGH_OPENVDB_READS.iter().any(|(name, _)| name == file)
            || file == "variants/xform_frustum.vdb"
        {
            continue;
        }
        let Some(expected) = expected["grids"].as_array() else { continue };
        let mut read = read(&folder.join(file)).unwrap_or_else(|error| panic!("{error}"));
        assert!(read.skipped.is_empty());
        let mut expected: Vec<&Value> = expected.iter().collect();
        assert_eq!(read.grids.len(), expected.len(), "{file}");
        // OpenVDB gives grids by name, equal names in file order; so is the file's order made here.
        expected.sort_by_key(|grid| grid["name"].as_str().unwrap().to_owned());
        read.grids.sort_by(|a, b| a.name.cmp(&b.name));
        for (grid, expected) in read.grids.iter().zip(expected) {
            check_grid(file, grid, expected);
            checked += 1;
        }
    }
    assert!(checked >= 60, "{checked}");
}

fn check_grid(file: &str, grid: &Grid, expected: &Value) {
    let place = format!("{file}: {}", grid.name);
    let kind = match grid.values {
        GridValues::Float(_) => "FloatGrid",
        GridValues::Double(_) => "DoubleGrid",
        GridValues::Vec3(_) => "Vec3SGrid",
        GridValues::Int32(_) => "Int32Grid",
        GridValues::Int64(_) => "Int64Grid",
        GridValues::Bool(_) => "BoolGrid",
        GridValues::Mask(_) => "MaskGrid",
    };
    let class = match grid.class {
        GridClass::Unknown => "unknown",
        GridClass::FogVolume => "fog volume",
        GridClass::LevelSet => "level set",
        GridClass::Staggered => "staggered",
    };
    assert_eq!(grid.name, expected["name"], "{place}");
    assert_eq!(kind, expected["type"], "{place}");
    assert_eq!(class, expected["class"], "{place}");
    assert_eq!(grid.saved_as_half, expected["saved_as_half"], "{place}");
    assert_eq!(grid.values.background(), numbers(&expected["background"]), "{place}: background");
    let map = [
        ("origin", grid.index_to_world.translation),
        ("di", grid.index_to_world.matrix3.x_axis),
        ("dj", grid.index_to_world.matrix3.y_axis),
        ("dk", grid.index_to_world.matrix3.z_axis),
    ];
    for (key, vector) in map {
        for (read, expected) in vector.to_array().into_iter().zip(numbers(&expected["index_to_world"][key])) {
            // The truth is a difference of transformed points.
            assert!(
                (read - expected).abs() <= 1e-12 * (1.0 + expected.abs()),
                "{place}: {key} {read} {expected}"
            );
        }
    }
    let statistics = grid.values.statistics();
    assert_eq!(
        statistics.active_voxels,
        expected["active_voxels"].as_u64().unwrap(),
        "{place}: active voxels"
    );
    let bbox: Vec<Vec<f64>> = expected["active_bbox_index"].as_array().unwrap().iter().map(numbers).collect();
    match statistics.active_bbox {
        Some(read) => {
            assert_eq!(read.map(|corner| corner.map(f64::from).to_vec()).to_vec(), bbox, "{place}: box")
        }
        None => assert!(bbox[0] > bbox[1], "{place}: box"),
    }
    if let Some(tiles) = expected.get("active_tiles") {
        assert_eq!(statistics.active_tiles, tiles.as_u64().unwrap(), "{place}: active tiles");
    }
    for (key, read) in [("min", &statistics.min), ("max", &statistics.max)] {
        if let Some(expected) = expected.get(key) {
            assert_eq!(*read, numbers(expected), "{place}: {key}");
        }
    }
    if let Some(expected) = expected.get("sum") {
        for (read, expected) in statistics.sum.iter().zip(numbers(expected)) {
            let extremes = statistics.min.iter().chain(&statistics.max).filter(|value| value.is_finite());
            let largest = extremes.fold(1.0, |largest: f64, value| largest.max(value.abs()));
            let scale = statistics.active_voxels as f64 * largest;
            assert!((read - expected).abs() <= 1e-12 * scale, "{place}: sum {read} {expected}");
        }
    }
    if let Some(expected) = expected.get("non_finite") {
        assert_eq!(statistics.non_finite, expected.as_u64().unwrap(), "{place}: not finite");
    }
    let Some(probes) = expected.get("probes").and_then(Value::as_array) else {
        assert!(statistics.active_voxels == 0 || kind == "BoolGrid", "{place}: no probes");
        return;
    };
    let voxels: Vec<[i32; 3]> = probes
        .iter()
        .map(|probe| numbers(&probe[0]).iter().map(|&c| c as i32).collect::<Vec<_>>().try_into().unwrap())
        .collect();
    for ((voxel, (value, active)), probe) in voxels.iter().zip(grid.values.probe(&voxels)).zip(probes) {
        let truth = numbers(&probe[1]);
        let equal = value.iter().zip(&truth).all(|(a, b)| a == b || (a.is_nan() && b.is_nan()));
        assert!(equal, "{place}: {voxel:?} is {value:?} instead of {truth:?}");
        assert_eq!(active, probe[2], "{place}: {voxel:?}");
    }
}

/// Numbers, or the words that stand for what JSON cannot say.
fn numbers(value: &Value) -> Vec<f64> {
    match value {
        Value::Array(items) => items.iter().flat_map(numbers).collect(),
        Value::Bool(truth) => vec![f64::from(u8::from(*truth))],
        Value::String(word) => vec![word.parse().unwrap()],
        number => vec![number.as_f64().unwrap()],
    }
}

/// The same field as other types: what OpenVDB for Python cannot read is held against what it can.
#[test]
fn double_int_bool_and_mask_grids_agree_with_the_float_grid_they_were_made_from() {
    let Some((folder, _)) = corpus() else { return };
    let one = |file: &str| read(&folder.join("variants").join(file)).unwrap().grids.remove(0).values;
    let GridValues::Float(float) = one("none.vdb") else { panic!() };
    let GridValues::Double(double) = one("double.vdb") else { panic!() };
    let GridValues::Int32(int) = one("int32.vdb") else { panic!() };
    let GridValues::Bool(bool) = one("bool.vdb") else { panic!() };
    let GridValues::Mask(mask) = one("maskgrid.vdb") else { panic!() };
    for leaves in [&double.leaves, &int.leaves, &bool.leaves, &mask.leaves] {
        assert_eq!(float.leaves, *leaves);
    }
    for (index, &value) in float.leaf_values.iter().enumerate() {
        let active = float.leaves[index / 512].active[index % 512 / 64] >> (index % 64) & 1 != 0;
        assert_eq!(mask.leaf_values[index], active);
        assert_eq!(bool.leaf_values[index], active);
        assert_eq!(double.leaf_values[index] as f32, value);
        assert_eq!(int.leaf_values[index], (f64::from(value) * 1000.0) as i32);
    }
}
