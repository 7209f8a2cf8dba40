//! NanoVDB files that no shared volume shows: long names, bare grids, hostile offsets.

use std::path::Path;

use glam::DAffine3;
use tyndall_volumes::{Codec, Grid, GridClass, GridSelection, GridValues, Leaf, ReadRequest, Tile, Tree};
use tyndall_volumes::{read, read_bytes, write};

use crate::facts::{float, options};

/// A tree with a leaf, tiles of every size, active and not, on both sides of the origin.
pub fn mixed_tree() -> Tree<f32> {
    let tile = |origin, log2_edge, value, active| Tile { origin, log2_edge, value, active };
    Tree {
        background: 0.25,
        tiles: vec![
            tile([8, -8, 0], 3, 3.0, true),
            tile([16, -8, 0], 3, 4.0, false),
            tile([-128, 128, 256], 7, 5.0, true),
            tile([-4096, 4096, -8192], 12, 6.0, true),
            tile([8192, 4096, -8192], 12, 7.0, false),
        ],
        leaves: vec![
            Leaf { origin: [0, -8, 0], active: [0x8000_0000_0000_0001; 8] },
            Leaf { origin: [-16, 8, 1024], active: [u64::MAX; 8] },
        ],
        leaf_values: (0..1024).map(|n| n as f32 * 0.5 - 100.0).collect(),
    }
}

pub fn grid_of(name: &str, tree: Tree<f32>) -> Grid {
    Grid {
        name: name.to_owned(),
        class: GridClass::FogVolume,
        index_to_world: DAffine3::from_cols_array(&[
            0.5, 0.1, 0.0, 0.0, 0.25, 0.0, -0.1, 0.0, 2.0, 1.0, 2.0, 3.0,
        ]),
        saved_as_half: false,
        codec: "none".to_owned(),
        metadata: Vec::new(),
        values: GridValues::Float(tree),
    }
}

/// The bytes of a NanoVDB file of `grids`.
pub fn file_of(grids: &[Grid], codec: Codec) -> Vec<u8> {
    let folder = tempfile::tempdir().expect("a folder");
    let path = write(&folder.path().join("a.nvdb"), grids, &options(codec)).expect("written");
    assert_eq!(
        std::fs::read_dir(folder.path()).expect("a folder").count(),
        1,
        "nothing unfinished stays behind"
    );
    std::fs::read(path).expect("readable")
}

fn parse(bytes: &[u8]) -> Result<Vec<Grid>, String> {
    read_bytes(bytes, Path::new("a.nvdb"), &ReadRequest::default())
        .map(|file| file.grids)
        .map_err(|error| error.to_string())
}

/// Leaves, their values, and tiles, in the order of their origins.
fn sorted(tree: &Tree<f32>) -> (Vec<Leaf>, Vec<f32>, Vec<Tile<f32>>) {
    let mut order: Vec<_> = (0..tree.leaves.len()).collect();
    order.sort_by_key(|&leaf| tree.leaves[leaf].origin);
    let mut tiles = tree.tiles.clone();
    tiles.sort_by_key(|tile| tile.origin);
    let values = order.iter().flat_map(|leaf| &tree.leaf_values[leaf * 512..][..512]);
    (order.iter().map(|&leaf| tree.leaves[leaf]).collect(), values.copied().collect(), tiles)
}

#[test]
fn a_written_grid_is_read_back_to_the_bit_in_every_codec() {
    for codec in [Codec::None, Codec::Zip, Codec::Blosc] {
        let grid = grid_of("density", mixed_tree());
        let [back] =
            parse(&file_of(std::slice::from_ref(&grid), codec)).expect("readable").try_into().expect("one");
        assert_eq!(float(&back).background, 0.25);
        assert_eq!(sorted(float(&back)), sorted(&mixed_tree()));
        assert_eq!(back.index_to_world, grid.index_to_world);
        assert_eq!((back.name.as_str(), back.class), ("density", GridClass::FogVolume));
    }
}

#[test]
fn names_longer_than_the_head_has_room_for_survive_in_both_forms_of_the_file() {
    let long = "smoke of the burning house, ".repeat(12);
    let file = file_of(&[grid_of(&long, mixed_tree()), grid_of("short", mixed_tree())], Codec::None);
    let names = |grids: Vec<Grid>| grids.into_iter().map(|grid| grid.name).collect::<Vec<_>>();
    assert_eq!(names(parse(&file).expect("readable")), [long.as_str(), "short"]);

    // Without its segments' heads and with the magic number of grids, the file is a row of bare grids.
    let mut bare = Vec::new();
    let mut rest = file.as_slice();
    while !rest.is_empty() {
        let number = |at: usize| u64::from_le_bytes(rest[at..at + 8].try_into().expect("8 bytes")) as usize;
        let start = 16 + 176 + u32::from_le_bytes(rest[152..156].try_into().expect("4 bytes")) as usize;
        let size = number(16);
        let first = bare.len();
        bare.extend_from_slice(&rest[start..start + size]);
        bare[first..first + 8].copy_from_slice(b"NanoVDB1");
        rest = &rest[start + size..];
    }
    let grids = parse(&bare).expect("readable");
    assert_eq!(sorted(float(&grids[0])), sorted(&mixed_tree()));
    assert_eq!(names(grids), [long.as_str(), "short"]);
}

#[test]
fn grids_of_one_name_are_told_apart_by_number() {
    let mut other = mixed_tree();
    other.background = 9.0;
    let file = file_of(&[grid_of("density", mixed_tree()), grid_of("density", other)], Codec::Zip);
    let request = |name: &str| ReadRequest { grids: GridSelection::Names(vec![name.to_owned()]), raw: None };
    let backgrounds = |name: &str| {
        let file = read_bytes(&file, Path::new("a.nvdb"), &request(name)).expect("readable");
        file.grids.iter().map(|grid| float(grid).background).collect::<Vec<_>>()
    };
    assert_eq!(backgrounds("density"), [0.25, 9.0]);
    assert_eq!(backgrounds("density[1]"), [9.0]);
}

#[test]
fn offsets_and_counts_that_lead_outside_or_twice_to_one_place_are_refused() {
    let file = file_of(&[grid_of("density", mixed_tree())], Codec::None);
    let grid = 16 + 176 + 8;
    let (tree, root) = (grid + 672, grid + 672 + 64);
    let with = |at: usize, bytes: &[u8]| {
        let mut file = file.clone();
        file[at..at + bytes.len()].copy_from_slice(bytes);
        parse(&file).expect_err("refused")
    };
    for hostile in [i64::MAX, i64::MIN, -1 << 40, 1 << 40, -(grid as i64) - 1000] {
        assert!(with(tree + 24, &hostile.to_le_bytes()).contains("outside the data"));
        assert!(with(root + 64 + 8, &hostile.to_le_bytes()).contains("outside the data"));
    }
    assert!(with(root + 24, &u32::MAX.to_le_bytes()).contains("the root's table lies outside the data"));
    assert!(with(root + 64 + 32, &file[root + 64..root + 72]).contains("two entries for one place"));
    let child = i64::from_le_bytes(file[root + 72..root + 80].try_into().expect("8 bytes"));
    assert!(with(root + 64 + 32 + 8, &(child + 64).to_le_bytes()).contains("overlap"));
    assert!(with(grid + 636, &99u32.to_le_bytes()).contains("there is no NanoVDB grid type 99"));
    assert!(
        with(grid + 636, &23u32.to_le_bytes())
            .contains("grids of type point are not read; write the grid as float")
    );
    assert!(with(8, &(31u32 << 21).to_le_bytes()).contains("NanoVDB version 31.0.0 is not read, only 32.x"));
    assert!(with(16, &u64::MAX.to_le_bytes()).contains("bytes cannot hold a grid of"));
    assert!(with(16 + 136, &u32::MAX.to_le_bytes()).contains("the name of a grid lies outside the file"));
}

#[test]
fn a_failed_write_leaves_what_was_there() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("a.npy");
    std::fs::write(&path, "before").expect("writable");
    let error = write(&path, &[grid_of("density", mixed_tree())], &options(Codec::None))
        .expect_err("too large")
        .to_string();
    assert!(error.contains("is larger than 4 GiB as an array; write .vdb or .nvdb"), "{error}");
    assert_eq!(std::fs::read(&path).expect("readable"), b"before");
    assert_eq!(std::fs::read_dir(folder.path()).expect("a folder").count(), 1);
    assert!(read(&folder.path().join("absent.nvdb"), &ReadRequest::default()).is_err());
}
