//! What is written in any format is read back with the same values in the same place of world space.

use std::path::Path;

use glam::{DAffine3, DQuat, DVec3};
use tyndall_volumes::{
    Codec, Format, Grid, GridClass, GridValues, Leaf, ReadRequest, Tile, Tree, WriteOptions, read, write,
};

use crate::facts::options;

/// Two leaves and a tile, with the box not on the grid of leaves.
fn tree<T: Copy>(value: impl Fn(usize) -> T) -> Tree<T> {
    Tree {
        background: value(0),
        tiles: vec![Tile { origin: [8, 8, 0], log2_edge: 3, value: value(3), active: true }],
        leaves: vec![
            Leaf { origin: [-8, 0, 8], active: [0, 0, 0, 0x0000_1800, 0, 0, 0, 0x0100_0000] },
            Leaf { origin: [0, 0, 0], active: [u64::MAX; 8] },
        ],
        leaf_values: (0..1024).map(|n| value(n % 37)).collect(),
    }
}

fn grid(values: GridValues, index_to_world: DAffine3) -> Grid {
    Grid {
        name: "density".to_owned(),
        class: GridClass::FogVolume,
        index_to_world,
        saved_as_half: false,
        codec: "none".to_owned(),
        metadata: Vec::new(),
        values,
    }
}

fn upright() -> DAffine3 {
    DAffine3::from_scale_rotation_translation(
        DVec3::new(0.5, 0.25, 2.0),
        DQuat::IDENTITY,
        DVec3::new(10.0, -20.0, 3.0),
    )
}

fn turned() -> DAffine3 {
    DAffine3::from_scale_rotation_translation(
        DVec3::new(0.5, 0.25, 2.0),
        DQuat::from_euler(glam::EulerRot::XYZ, 0.3, -0.2, 1.0),
        DVec3::new(10.0, -20.0, 3.0),
    )
}

fn through(name: &str, grid: &Grid) -> (Format, Grid) {
    let folder = tempfile::tempdir().expect("a folder");
    let path =
        write(&folder.path().join(name), std::slice::from_ref(grid), &options(Codec::Zip)).expect("written");
    let file = read(&path, &ReadRequest::default()).expect("readable");
    let [back] = file.grids.try_into().expect("one grid");
    (file.format, back)
}

/// Active voxels of `grid` and their values, found in `back` at the same place of world space.
#[track_caller]
fn assert_same(grid: &Grid, back: &Grid, with_map: bool) {
    let bounds = grid.values.statistics().active_bbox.expect("active voxels");
    let there = back.values.statistics().active_bbox.expect("active voxels");
    let [min, max] = bounds;
    let mut compared = 0;
    for x in min[0]..=max[0] {
        for y in min[1]..=max[1] {
            for z in min[2]..=max[2] {
                let at = if with_map {
                    let world =
                        grid.index_to_world.transform_point3(DVec3::new(x.into(), y.into(), z.into()));
                    let index = back.index_to_world.inverse().transform_point3(world);
                    assert!(index.abs_diff_eq(index.round(), 1e-3), "{index}");
                    index.round().to_array().map(|index| index as i32)
                } else {
                    [x - min[0], y - min[1], z - min[2]].map(|index| index + there[0][0])
                };
                let (value, _) = &grid.values.probe(&[[x, y, z]])[0];
                let (found, active) = &back.values.probe(&[at])[0];
                assert_eq!((value, *active), (found, true), "at {x} {y} {z}");
                compared += 1;
            }
        }
    }
    assert_eq!(compared, back.values.statistics().active_voxels);
}

#[test]
fn dense_formats_keep_every_value_of_the_active_box() {
    let scalars = grid(GridValues::Float(tree(|n| n as f32 * 0.1)), upright());
    for (name, format, with_map) in [
        ("a.npy", Format::NumPy, false),
        ("a.raw", Format::Raw, false),
        ("a.vol", Format::Mitsuba, true),
        ("a.nii", Format::Nifti, true),
        ("a.nii.gz", Format::NiftiGzip, true),
    ] {
        let (found, back) = through(name, &scalars);
        assert_eq!(found, format);
        assert_same(&scalars, &back, with_map);
    }
    let turned = grid(GridValues::Float(tree(|n| n as f32)), turned());
    assert_same(&turned, &through("a.nii", &turned).1, true);

    let vectors = grid(GridValues::Vec3(tree(|n| [n as f32, -1.0, 0.5 * n as f32])), upright());
    assert_same(&vectors, &through("a.npy", &vectors).1, false);
    assert_same(&vectors, &through("a.vol", &vectors).1, true);
}

#[test]
fn sparse_formats_keep_the_very_voxels_and_the_map() {
    for values in [
        GridValues::Float(tree(|n| n as f32 * 0.1)),
        GridValues::Vec3(tree(|n| [n as f32, -1.0, 0.5 * n as f32])),
    ] {
        let grid = grid(values, turned());
        for (name, format) in [("a.vdb", Format::OpenVdb), ("a.nvdb", Format::NanoVdb)] {
            let (found, back) = through(name, &grid);
            assert_eq!(found, format);
            assert_eq!(back.values.statistics(), grid.values.statistics());
            assert_eq!(back.values.background(), grid.values.background());
            assert!(back.index_to_world.abs_diff_eq(grid.index_to_world, 1e-12));
            let [min, max] = [[-9, -1, -1], [17, 17, 17]];
            let voxels: Vec<_> = (min[0]..max[0])
                .flat_map(|x| (min[1]..max[1]).flat_map(move |y| (min[2]..max[2]).map(move |z| [x, y, z])))
                .collect();
            assert_eq!(back.values.probe(&voxels), grid.values.probe(&voxels));
        }
    }
}

#[test]
fn other_types_become_floats() {
    for values in [
        GridValues::Double(tree(|n| n as f64)),
        GridValues::Int32(tree(|n| n as i32 - 10)),
        GridValues::Int64(tree(|n| n as i64)),
        GridValues::Bool(tree(|n| n % 2 == 1)),
    ] {
        let grid = grid(values, upright());
        for name in ["a.npy", "a.nvdb"] {
            let (_, back) = through(name, &grid);
            let (was, is) = (grid.values.statistics(), back.values.statistics());
            assert_eq!((was.min, was.max), (is.min, is.max));
        }
    }
}

#[test]
fn what_a_format_cannot_hold_is_refused_with_the_mend() {
    let turned_grid = grid(GridValues::Float(tree(|n| n as f32)), turned());
    let vectors = grid(GridValues::Vec3(tree(|n| [n as f32; 3])), upright());
    let mut empty = grid(GridValues::Float(tree(|n| n as f32)), upright());
    empty.values = GridValues::Float(Tree {
        background: 0.0,
        tiles: Vec::new(),
        leaves: Vec::new(),
        leaf_values: Vec::new(),
    });
    let two = [vectors.clone(), turned_grid.clone()];
    let cases: [(&str, &[Grid], &str); 7] = [
        ("a.vol", std::slice::from_ref(&turned_grid), "turned or mirrored; write .vdb, .nvdb or .nii"),
        ("a.nii", std::slice::from_ref(&vectors), "vectors are not written; write .npy"),
        ("a.raw", std::slice::from_ref(&vectors), "a .raw file of vectors"),
        ("a.npy", &two, "holds one grid; choose one of `density`, `density`"),
        ("a.npy", std::slice::from_ref(&empty), "without active voxels has no array"),
        ("a.raw_", std::slice::from_ref(&vectors), "name the file .vdb, .nvdb, .vol"),
        ("a_3x3x3_uint8.raw", std::slice::from_ref(&turned_grid), "the name promises another shape or type"),
    ];
    let folder = tempfile::tempdir().expect("a folder");
    for (name, grids, reason) in cases {
        let error =
            write(&folder.path().join(name), grids, &options(Codec::None)).expect_err(name).to_string();
        assert!(error.contains(reason) && !error.contains('\n'), "{error}");
    }
    let half = WriteOptions { codec: Codec::None, half: true };
    let error = write(&folder.path().join("a.nvdb"), &two, &half).expect_err("no halves").to_string();
    assert!(error.contains("only OpenVDB files are written in halves"), "{error}");
    assert!(write(Path::new("/no/such/folder/a.npy"), &two[..1], &options(Codec::None)).is_err());
}

#[test]
fn a_raw_file_gets_its_shape_into_its_name() {
    let folder = tempfile::tempdir().expect("a folder");
    let grids = [grid(GridValues::Float(tree(|n| n as f32)), upright())];
    let path = write(&folder.path().join("a.raw"), &grids, &options(Codec::None)).expect("written");
    let [min, max] = grids[0].values.statistics().active_bbox.expect("active voxels");
    let [x, y, z] = [0, 1, 2].map(|axis| max[axis] - min[axis] + 1);
    assert_eq!(path, folder.path().join(format!("a_{x}x{y}x{z}_float32.raw")));
    assert_eq!(write(&path, &grids, &options(Codec::None)).expect("written again"), path);
}
