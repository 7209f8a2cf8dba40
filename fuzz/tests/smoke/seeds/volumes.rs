//! Volumes: every type of values, codec and version that is read.

use std::fs;

use glam::{DAffine3, DVec3};
use tyndall_volumes::{Codec, Grid, GridClass, GridValues, Leaf, Tile, Tree, WriteOptions, write};

use super::put;

pub fn write_all() {
    for (name, codec) in [("none", Codec::None), ("zip", Codec::Zip), ("blosc", Codec::Blosc)] {
        let float = grid("density", GridValues::Float(tree(|n| n as f32 * 0.25)));
        file("vdb", &format!("float_{name}.vdb"), std::slice::from_ref(&float), codec, false);
        file("vdb", &format!("half_{name}.vdb"), std::slice::from_ref(&float), codec, true);
        let heat = grid("heat", GridValues::Float(tree(|n| f32::from(n > 100))));
        if codec != Codec::None {
            file("nvdb", &format!("two_{name}.nvdb"), &[float, heat], codec, false);
        }
    }
    let kinds = [
        ("double", GridValues::Double(tree(|n| n as f64 / 3.0))),
        ("vec3", GridValues::Vec3(tree(|n| [n as f32, 0.5, -1.0]))),
        ("int32", GridValues::Int32(tree(|n| n as i32 - 7))),
        ("int64", GridValues::Int64(tree(|n| n as i64 - 7))),
        ("bool", GridValues::Bool(tree(|n| n % 3 == 0))),
        ("mask", GridValues::Mask(tree(|n| n % 3 == 0))),
    ];
    for (name, values) in kinds {
        let grids = [grid(name, values)];
        file("vdb", &format!("{name}.vdb"), &grids, Codec::Zip, false);
    }
    let vectors = [grid("vec3", GridValues::Vec3(tree(|n| [n as f32, 0.5, -1.0])))];
    file("nvdb", "vec3.nvdb", &vectors, Codec::Zip, false);
    let empty = Tree { background: 0.5f32, tiles: Vec::new(), leaves: Vec::new(), leaf_values: Vec::new() };
    file("vdb", "empty.vdb", &[grid("nothing", GridValues::Float(empty))], Codec::None, false);
    let mut turned = grid("turned", GridValues::Float(tree(|_| 1.0)));
    turned.index_to_world = DAffine3::from_rotation_x(0.3) * DAffine3::from_scale(DVec3::new(1.0, 2.0, 3.0));
    let twins = [turned.clone(), grid("turned", GridValues::Float(tree(|n| n as f32)))];
    file("vdb", "twins.vdb", &twins, Codec::Blosc, false);
    // To an uncompressed file: another number of active voxels in its head, which is not looked at.
    put("nvdb", "patch", b"patch\x28\x00\x00\x02\x00\x01");
    arrays();
}

/// Dense arrays.
fn arrays() {
    let scalar = [grid("density", GridValues::Float(small(|n| n as f32)))];
    let vector = [grid("Cd", GridValues::Vec3(small(|n| [n as f32, 1.0, 2.0])))];
    for (target, name) in [("npy", "a.npy"), ("vol", "a.vol"), ("nifti", "a.nii"), ("nifti", "a.nii.gz")] {
        file(target, name, &scalar, Codec::None, false);
    }
    for (target, name) in [("npy", "vectors.npy"), ("vol", "vectors.vol")] {
        file(target, name, &vector, Codec::None, false);
    }
    for (name, descr, order, shape, len) in [
        ("bytes", "|u1", "False", "5, 6, 7", 210),
        ("big", ">i2", "True", "4, 4, 4", 128),
        ("halves", "<f2", "False", "4, 4, 4, 1", 128),
        ("doubles", "<f8", "True", "3, 3, 3", 216),
        ("components", "<f4", "True", "2, 2, 2, 3", 96),
    ] {
        let header = format!("{{'descr': '{descr}', 'fortran_order': {order}, 'shape': ({shape})}}\n");
        let start = [b"\x93NUMPY\x01\x00".as_slice(), &(header.len() as u16).to_le_bytes()].concat();
        put("npy", &format!("{name}.npy"), &[start, header.into_bytes(), numbers(len)].concat());
    }
    for (name, encoding, len) in [("halves", 2i32, 128), ("bytes", 3, 64)] {
        let counts = [encoding, 4, 4, 4, 1].map(i32::to_le_bytes).concat();
        let corners = [0f32, 0.0, 0.0, 1.0, 1.0, 2.0].map(f32::to_le_bytes).concat();
        put("vol", &format!("{name}.vol"), &[b"VOL\x03".to_vec(), counts, corners, numbers(len)].concat());
    }
    for (name, len) in [
        ("bonsai_8x8x8_uint8", 512),
        ("a_3x4x5_uint16_be", 120),
        ("b_4x4x4_float32", 256),
        ("c_2x2x2_float64_le", 64),
        ("d_9x1x1_int8", 9),
    ] {
        put("raw", name, &[name.as_bytes(), b"\n", &numbers(len)].concat());
    }
    put("nifti", "second.nii", &nifti_2());
}

/// An image of the second version of NIfTI, big endian, turned by a quaternion and scaled.
fn nifti_2() -> Vec<u8> {
    let mut bytes = vec![0; 544];
    let mut at = |offset: usize, number: &[u8]| bytes[offset..offset + number.len()].copy_from_slice(number);
    at(0, &540i32.to_be_bytes());
    at(4, b"n+2\0\r\n\x1a\n");
    at(12, &4i16.to_be_bytes());
    [4i64, 3, 4, 5, 2].iter().enumerate().for_each(|(n, number)| at(16 + 8 * n, &number.to_be_bytes()));
    [-1f64, 0.5, 0.5, 2.0].iter().enumerate().for_each(|(n, number)| at(104 + 8 * n, &number.to_be_bytes()));
    at(168, &544i64.to_be_bytes());
    at(176, &0.5f64.to_be_bytes());
    at(184, &1.0f64.to_be_bytes());
    at(344, &1i32.to_be_bytes());
    at(352, &0.7f64.to_be_bytes());
    bytes.extend(numbers(240));
    bytes
}

fn numbers(len: usize) -> Vec<u8> {
    (0..len).map(|n| (n * 7 % 60) as u8).collect()
}

fn file(target: &str, name: &str, grids: &[Grid], codec: Codec, half: bool) {
    let folder = tempfile::tempdir().unwrap();
    let path = write(&folder.path().join(name), grids, &WriteOptions { codec, half }).unwrap();
    put(target, name, &fs::read(path).unwrap());
}

fn grid(name: &str, values: GridValues) -> Grid {
    Grid {
        name: name.to_owned(),
        class: GridClass::FogVolume,
        index_to_world: DAffine3::from_scale_rotation_translation(
            DVec3::splat(0.5),
            glam::DQuat::IDENTITY,
            DVec3::new(1.0, 2.0, 3.0),
        ),
        saved_as_half: false,
        codec: "none".to_owned(),
        metadata: Vec::new(),
        values,
    }
}

/// Two leaves, one of them sparse, and tiles of every size.
fn tree<T: Copy>(value: impl Fn(usize) -> T) -> Tree<T> {
    let tile = |origin, log2_edge, n, active| Tile { origin, log2_edge, value: value(n), active };
    Tree {
        background: value(0),
        tiles: vec![
            tile([8, 0, 0], 3, 3, true),
            tile([16, 0, 0], 3, 4, false),
            tile([128, 128, 256], 7, 5, true),
            tile([-4096, 4096, -8192], 12, 6, true),
        ],
        leaves: vec![
            Leaf { origin: [0, 8, 0], active: [0x8000_0000_0010_0001; 8] },
            Leaf { origin: [16, 8, 1024], active: [u64::MAX; 8] },
        ],
        // Mostly constant, so that the file is small.
        leaf_values: (0..1024).map(|n| value(if n % 512 < 8 { 10 + n % 512 } else { 1 })).collect(),
    }
}

/// A few voxels in one leaf.
fn small<T: Copy>(value: impl Fn(usize) -> T) -> Tree<T> {
    Tree {
        background: value(0),
        tiles: Vec::new(),
        leaves: vec![Leaf { origin: [0; 3], active: [0x0f0f_0f0f; 8] }],
        leaf_values: (0..512).map(value).collect(),
    }
}
