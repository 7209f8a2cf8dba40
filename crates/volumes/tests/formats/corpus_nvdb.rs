//! NanoVDB files of several makers and versions give the values they were made from.

use std::path::Path;

use tyndall_volumes::{
    Format, Grid, GridClass, GridSelection, GridStatistics, GridValues, ReadError, ReadRequest, read,
};

use crate::facts::{float, shared};

/// Sum over the active voxels of `dragon.vdb`, from which the variants were made, and their number.
const DRAGON: (f64, u64) = (10186.861159738584, 19_660);

fn read_all(path: &Path) -> Vec<Grid> {
    let file = read(path, &ReadRequest::default()).unwrap_or_else(|error| panic!("{error}"));
    assert_eq!(file.format, Format::NanoVdb);
    assert!(file.skipped.is_empty(), "{:?}", file.skipped);
    file.grids
}

#[track_caller]
fn assert_sum(found: &GridStatistics, sum: f64, active: u64, tolerance: f64) {
    assert_eq!(found.active_voxels, active);
    assert!((found.sum[0] - sum).abs() <= tolerance, "sum {} instead of {sum}", found.sum[0]);
}

#[test]
fn float_grids_are_exact_in_every_codec() {
    for codec in ["none", "zip", "blosc"] {
        let Some(path) = shared(&format!("volumes/variants/float_{codec}.nvdb")) else { return };
        let [grid] = read_all(&path).try_into().expect("one grid");
        let found = grid.values.statistics();
        assert_sum(&found, DRAGON.0, DRAGON.1, 1e-9);
        assert_eq!((found.min[0], found.max[0]), (2.8933087378391065e-05, 1.0));
        assert_eq!(found.active_bbox, Some([[16, 1, 35], [85, 49, 65]]));
        assert_eq!(
            (grid.name.as_str(), grid.class, grid.codec.as_str()),
            ("density", GridClass::FogVolume, codec)
        );
        assert_eq!(
            grid.index_to_world.transform_point3(glam::DVec3::ONE),
            glam::DVec3::splat(0.10000000149011612)
        );
        assert_eq!(float(&grid).background, 0.0);
        assert_eq!(float(&grid).probe([55, 31, 43]), (0.767_42, true));
        assert_eq!(float(&grid).probe([44, 7, 45]), (1.0, true));
        assert_eq!(float(&grid).probe([40, 28, 64]), (0.0, false));
    }
}

#[test]
fn quantised_grids_stay_within_their_quantum() {
    let Some(exact) = shared("volumes/variants/float_none.nvdb") else { return };
    let exact = read_all(&exact);
    let exact = float(&exact[0]);
    // Values span [0, 1]: half a quantum of 4, 8, 16 bits; FpN keeps fog within 0.01.
    for (file, quantum) in
        [("fp4", 1.0 / 15.0), ("fp8", 1.0 / 255.0), ("fp16_blosc", 1.0 / 65535.0), ("fpN", 2e-2)]
    {
        let Some(path) = shared(&format!("volumes/variants/{file}.nvdb")) else { return };
        let grids = read_all(&path);
        let quantised = float(&grids[0]);
        assert_eq!(quantised.leaves, exact.leaves, "{file}");
        let worst = (quantised.leaf_values.iter().zip(&exact.leaf_values))
            .map(|(a, b)| (a - b).abs())
            .fold(0.0, f32::max);
        assert!(worst <= 0.501 * quantum, "{file}: off by {worst}");
        assert!(worst > 0.0, "{file} is not quantised");
    }
}

#[test]
fn several_grids_are_read_in_file_order_or_by_name() {
    let Some(path) = shared("volumes/variants/multi_zip.nvdb") else { return };
    let grids = read_all(&path);
    let names: Vec<_> = grids.iter().map(|grid| grid.name.as_str()).collect();
    assert_eq!(names, ["density", "temperature"]);
    for grid in &grids {
        assert_sum(&grid.values.statistics(), DRAGON.0, DRAGON.1, 1e-9);
    }

    let named = |name: &str| ReadRequest { grids: GridSelection::Names(vec![name.to_owned()]), raw: None };
    let file = read(&path, &named("temperature")).expect("readable");
    assert_eq!(file.grids.len(), 1);
    assert_eq!(file.grids[0].name, "temperature");
    let error = read(&path, &named("heat")).expect_err("there is no such grid");
    assert!(matches!(error, ReadError::NoSuchGrid { .. }));
    assert!(
        error.to_string().contains("no grid named `heat`; the file has `density`, `temperature`"),
        "{error}"
    );
}

#[test]
fn vectors_are_read() {
    let Some(path) = shared("volumes/variants/vec3f.nvdb") else { return };
    let [grid] = read_all(&path).try_into().expect("one grid");
    let GridValues::Vec3(tree) = &grid.values else { panic!("not vectors") };
    let found = tree.statistics();
    assert_eq!(found.active_voxels, DRAGON.1);
    for (axis, sum) in [18.638968428596854, -196.09178103040904, 35.3759128972888].into_iter().enumerate() {
        assert!((found.sum[axis] - sum).abs() < 1e-9, "component {axis}: {}", found.sum[axis]);
    }
    assert_eq!(tree.probe([60, 17, 44]), ([1.622_465_1, -1.147_475_1, 0.648_042_44], true));
}

#[test]
fn real_files_of_old_versions_give_the_values_of_their_sources() {
    // The sums are those OpenVDB reads from the .vdb of the same field; 593,674 voxels are in the file's own record.
    let Some(smoke) = shared("volumes/smoke-blosc.nvdb") else { return };
    let [grid] = read_all(&smoke).try_into().expect("one grid");
    assert_sum(&grid.values.statistics(), 171499.69552135468, 1_049_275, 1e-6);
    assert_eq!(float(&grid).probe([72, 8, 53]), (1.2607422, true));

    // Sums and counts of the fields these were made from, and of the files' own records.
    for (name, active, sum) in [
        ("volumes/nebula_density_nozip.nvdb", 593_674, 63173.28312695),
        ("volumes/batch.nvdb", 774, -0.80864406),
        ("bench/pbrt/cloud.nvdb", 1_079_271, 690298.23873187),
        ("bench/pbrt/smoke.nvdb", 441_392, 79522.08010232),
        ("bench/pbrt/wdas.nvdb", 363_038, 188542.10390198557),
    ] {
        let Some(path) = shared(name) else { continue };
        let [grid] = read_all(&path).try_into().expect("one grid");
        assert_sum(&grid.values.statistics(), sum, active, 1e-6);
    }
}

#[test]
fn the_name_of_a_file_does_not_decide_its_format() {
    let Some(path) = shared("volumes/variants/bad_nvdb_named.vdb") else { return };
    assert!(!read_all(&path).is_empty());
}

#[test]
fn a_truncated_file_is_refused_in_one_line() {
    let Some(path) = shared("volumes/variants/bad_truncated.nvdb") else { return };
    let error = read(&path, &ReadRequest::default()).expect_err("truncated").to_string();
    assert!(
        error.ends_with("bad_truncated.nvdb: truncated: grid `density` lies outside the file"),
        "{error}"
    );
}
