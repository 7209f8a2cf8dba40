//! Which grids of a file are read, and what happens to those that cannot be.

use std::path::Path;
use tyndall_volumes::vdb::{self, VdbFile, WriteOptions};
use tyndall_volumes::{Grid, GridClass, GridSelection, GridValues, LEAF_VOXELS, Leaf, ReadError, Tree};

/// A file with the grids `first`, `second` and `third`, whose one leaf holds 1, 2 and 3.
fn file() -> Vec<u8> {
    let grid = |(name, value): (&str, f32)| Grid {
        name: name.to_owned(),
        class: GridClass::FogVolume,
        index_to_world: glam::DAffine3::IDENTITY,
        saved_as_half: false,
        codec: String::new(),
        metadata: Vec::new(),
        values: GridValues::Float(Tree {
            background: 0.0,
            tiles: Vec::new(),
            leaves: vec![Leaf { origin: [0; 3], active: [u64::MAX; 8] }],
            leaf_values: vec![value; LEAF_VOXELS],
        }),
    };
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("three.vdb");
    let grids = [("first", 1.0), ("second", 2.0), ("third", 3.0)].map(grid);
    vdb::write(&path, &grids, &WriteOptions { codec: vdb::Codec::None, half: false }).unwrap();
    std::fs::read(&path).unwrap()
}

fn place(bytes: &[u8], pattern: &[u8], nth: usize) -> usize {
    let mut places = (0..bytes.len()).filter(|&at| bytes[at..].starts_with(pattern));
    places.nth(nth).unwrap()
}

/// The second grid gets a type that nobody knows.
fn with_an_unknown_grid(mut bytes: Vec<u8>) -> Vec<u8> {
    let at = place(&bytes, b"Tree_float", 1);
    bytes[at + 5..at + 10].copy_from_slice(b"color");
    bytes
}

fn as_stream(mut bytes: Vec<u8>) -> Vec<u8> {
    bytes[8 + 4 + 8] = 0;
    for name in [&b"first"[..], b"second", b"third"] {
        let offsets = place(&bytes, name, 0) + name.len() + 4 + 16 + 4;
        bytes[offsets..offsets + 24].fill(0);
    }
    bytes
}

fn read(bytes: &[u8], names: &[&str]) -> Result<VdbFile, ReadError> {
    let selection = match names {
        [] => GridSelection::All,
        names => GridSelection::Names(names.iter().map(|&name| name.to_owned()).collect()),
    };
    vdb::read_bytes(bytes, Path::new("three.vdb"), &selection)
}

fn names(file: &VdbFile) -> Vec<&str> {
    file.grids.iter().map(|grid| grid.name.as_str()).collect()
}

#[test]
fn only_the_grids_asked_for_are_decoded() {
    let mut bytes = file();
    let second = place(&bytes, b"second", 0);
    let third = place(&bytes, b"third", 0);
    bytes[second + 60..third - 8].fill(0xff);
    assert_eq!(names(&read(&bytes, &["third", "first"]).unwrap()), ["first", "third"]);
    let error = read(&bytes, &[]).unwrap_err().to_string();
    assert!(error.starts_with("three.vdb: grid `second`: "), "{error}");
}

#[test]
fn a_stream_reads_as_the_file_it_was() {
    let whole = read(&file(), &[]).unwrap();
    let stream = read(&as_stream(file()), &[]).unwrap();
    assert_eq!(names(&stream), ["first", "second", "third"]);
    for (a, b) in whole.grids.iter().zip(&stream.grids) {
        assert_eq!(a.values.statistics(), b.values.statistics());
    }
    let third = read(&as_stream(file()), &["third"]).unwrap();
    assert_eq!(third.grids[0].values.statistics().sum, [3.0 * 512.0]);
}

#[test]
fn an_unknown_grid_is_skipped_with_a_reason_unless_it_was_asked_for() {
    let bytes = with_an_unknown_grid(file());
    let all = read(&bytes, &[]).unwrap();
    assert_eq!(names(&all), ["first", "third"]);
    assert_eq!(all.skipped.len(), 1);
    assert_eq!(all.skipped[0].name, "second");
    assert!(all.skipped[0].why.contains("`color`"), "{}", all.skipped[0].why);
    assert_eq!(names(&read(&bytes, &["third"]).unwrap()), ["third"]);
    assert!(matches!(read(&bytes, &["second"]), Err(ReadError::Unsupported { .. })));
}

#[test]
fn a_stream_is_read_as_far_as_its_grids_are_known() {
    let bytes = as_stream(with_an_unknown_grid(file()));
    let all = read(&bytes, &[]).unwrap();
    assert_eq!(names(&all), ["first"]);
    assert_eq!(all.skipped[0].name, "second");
    let error = read(&bytes, &["third"]).unwrap_err().to_string();
    assert!(error.contains("grid `third` cannot be reached") && error.contains("second"), "{error}");
}

#[test]
fn a_frustum_is_refused_by_name_and_walked_past_in_a_stream() {
    let bytes = as_stream(file());
    let at = place(&bytes, b"UniformScaleMap", 0);
    let mut frustum = Vec::new();
    let string = |text: &str, out: &mut Vec<u8>| {
        out.extend_from_slice(&(text.len() as u32).to_le_bytes());
        out.extend_from_slice(text.as_bytes());
    };
    string("NonlinearFrustumMap", &mut frustum);
    frustum.extend(
        [0.0, 0.0, 0.0, 9.0, 9.0, 9.0, 0.5, 1.0].iter().flat_map(|number: &f64| number.to_le_bytes()),
    );
    let mut bytes = bytes;
    bytes.splice(at - 4..at - 4, frustum);
    let all = read(&bytes, &[]).unwrap();
    assert_eq!(names(&all), ["second", "third"]);
    assert!(all.skipped[0].why.contains("frustum"));
    assert!(read(&bytes, &["first"]).unwrap_err().to_string().contains("resample"));
}

/// File version 225 has trees of halves, background and tiles included.
#[test]
fn a_native_half_grid_is_read() {
    let mut bytes = as_stream(file());
    bytes[8] = 225;
    let tree = place(&bytes, b"Tree_float", 0);
    let second = place(&bytes, b"second", 0) - 4;
    let map = place(&bytes, b"UniformScaleMap", 0) + 15 + 5 * 24;
    let mut halves = bytes[..tree - 4].to_vec();
    halves.extend_from_slice(&15u32.to_le_bytes());
    halves.extend_from_slice(b"Tree_half_5_4_3");
    halves.extend_from_slice(&bytes[tree + 16..map]);
    halves.extend_from_slice(&1u32.to_le_bytes());
    halves.extend_from_slice(&0x3c00u16.to_le_bytes());
    halves.extend_from_slice(&[1, 0, 0, 0, 0, 0, 0, 0]);
    halves.extend_from_slice(&[0, 0xf0, 0xff, 0xff, 0, 0, 0, 0, 0, 0x10, 0, 0]);
    halves.extend_from_slice(&0xc000u16.to_le_bytes());
    halves.push(1);
    halves.extend_from_slice(&bytes[second..]);
    let file = read(&halves, &[]).unwrap();
    assert_eq!(names(&file), ["first", "second", "third"]);
    assert!(file.grids[0].saved_as_half && !file.grids[1].saved_as_half);
    let GridValues::Float(tree) = &file.grids[0].values else { panic!() };
    assert_eq!(tree.background, 1.0);
    assert_eq!(tree.probe([-4096, 0, 4096]), (-2.0, true));
    assert_eq!(tree.probe([0, 0, 0]), (1.0, false));
}
