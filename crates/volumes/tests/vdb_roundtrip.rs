//! What is written reads again as it was, for every grid of the corpus and every codec.

use std::path::{Path, PathBuf};
use tyndall_volumes::vdb::{self, Codec, WriteOptions};
use tyndall_volumes::{
    Grid, GridClass, GridSelection, GridValues, LEAF_VOXELS, Leaf, Tile, Tree, WriteError,
};

const CODECS: [Codec; 3] = [Codec::None, Codec::Zip, Codec::Blosc];

/// A tree in a canonical order, its values as bits, so that NaN equals itself and -0 is not 0.
type Canonical = (Vec<u64>, Vec<([i32; 3], u32, Vec<u64>, bool)>, Vec<([i32; 3], [u64; 8], Vec<u64>)>);

fn canonical(values: &GridValues) -> Canonical {
    fn of<T: Copy>(tree: &Tree<T>, bits: impl Fn(T) -> Vec<u64>) -> Canonical {
        let mut tiles: Vec<_> =
            tree.tiles.iter().map(|t| (t.origin, t.log2_edge, bits(t.value), t.active)).collect();
        tiles.sort();
        let mut leaves: Vec<_> = tree
            .leaves
            .iter()
            .zip(tree.leaf_values.chunks_exact(LEAF_VOXELS))
            .map(|(leaf, values)| (leaf.origin, leaf.active, values.iter().flat_map(|&v| bits(v)).collect()))
            .collect();
        leaves.sort();
        (bits(tree.background), tiles, leaves)
    }
    match values {
        GridValues::Float(tree) => of(tree, |v| vec![u64::from(v.to_bits())]),
        GridValues::Double(tree) => of(tree, |v| vec![v.to_bits()]),
        GridValues::Vec3(tree) => of(tree, |v| v.map(|c| u64::from(c.to_bits())).to_vec()),
        GridValues::Int32(tree) => of(tree, |v| vec![v as u64]),
        GridValues::Int64(tree) => of(tree, |v| vec![v as u64]),
        GridValues::Bool(tree) | GridValues::Mask(tree) => of(tree, |v| vec![u64::from(v)]),
    }
}

fn write_and_read(grids: &[Grid], options: &WriteOptions) -> Vec<Grid> {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("grids.vdb");
    vdb::write(&path, grids, options).unwrap();
    let left_behind = std::fs::read_dir(folder.path()).unwrap().count();
    assert_eq!(left_behind, 1, "the temporary file is gone");
    vdb::read(&path, &GridSelection::All).unwrap().grids
}

fn assert_same(place: &str, written: &Grid, read: &Grid) {
    assert_eq!(written.name, read.name, "{place}");
    assert_eq!(written.class, read.class, "{place}");
    assert_eq!(written.index_to_world, read.index_to_world, "{place}");
    assert_eq!(std::mem::discriminant(&written.values), std::mem::discriminant(&read.values), "{place}");
    assert!(canonical(&written.values) == canonical(&read.values), "{place}: the values differ");
}

fn corpus() -> Vec<(PathBuf, Vec<Grid>)> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/volumes");
    if !folder.is_dir() {
        eprintln!("skipped: {} is not there", folder.display());
        return Vec::new();
    }
    let mut files = Vec::new();
    for folder in [folder.clone(), folder.join("variants")] {
        let paths = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
        files.extend(paths.filter_map(|path| {
            let grids = vdb::read(&path, &GridSelection::All).ok()?.grids;
            Some((path, grids))
        }));
    }
    assert!(files.len() > 40, "{}", files.len());
    files
}

#[test]
fn every_grid_of_the_corpus_comes_back_with_every_codec() {
    for (path, grids) in corpus() {
        for codec in CODECS {
            let read = write_and_read(&grids, &WriteOptions { codec, half: false });
            assert_eq!(grids.len(), read.len());
            for (written, read) in grids.iter().zip(&read) {
                assert_same(&format!("{} {codec:?}", path.display()), written, read);
                assert!(!read.saved_as_half);
            }
        }
    }
}

#[test]
fn grids_that_came_from_halves_come_back_from_halves() {
    let mut checked = 0;
    for (path, grids) in corpus() {
        if !grids.iter().all(|grid| grid.saved_as_half) {
            continue;
        }
        for codec in CODECS {
            let read = write_and_read(&grids, &WriteOptions { codec, half: true });
            for (written, read) in grids.iter().zip(&read) {
                assert_same(&format!("{} {codec:?}", path.display()), written, read);
                assert!(read.saved_as_half);
            }
        }
        checked += 1;
    }
    assert!(checked == 0 || checked >= 8, "{checked}");
}

/// Every kind of inactive values, tiles at every level, negative coordinates.
fn awkward_tree() -> Tree<f32> {
    let inactive: [fn(usize) -> f32; 8] = [
        |_| 0.5,
        |_| -0.5,
        |_| 7.0,
        |voxel| if voxel % 3 == 0 { 0.5 } else { -0.5 },
        |voxel| if voxel % 5 == 0 { 7.0 } else { 0.5 },
        |voxel| if voxel % 2 == 0 { 7.0 } else { -8.0 },
        |voxel| voxel as f32,
        |voxel| if voxel % 2 == 0 { f32::NAN } else { -0.0 },
    ];
    let masks = [[0; 8], [u64::MAX; 8], [0x8421_8421_0f0f_0001; 8], [u64::MAX, 0, 0, 5, 0, 0, 0, 1 << 63]];
    let mut tree = Tree { background: 0.5, tiles: Vec::new(), leaves: Vec::new(), leaf_values: Vec::new() };
    for (row, inactive) in inactive.iter().enumerate() {
        for (column, &active) in masks.iter().enumerate() {
            tree.leaves
                .push(Leaf { origin: [-16, row as i32 * 8 - 4096 - 24, column as i32 * 1024], active });
            tree.leaf_values.extend((0..LEAF_VOXELS).map(|voxel| {
                if active[voxel / 64] >> (voxel % 64) & 1 != 0 { voxel as f32 / 8.0 } else { inactive(voxel) }
            }));
        }
    }
    for (log2_edge, far) in [(3, -1), (7, -2), (12, -4)] {
        for (step, (value, active)) in [(3.0, true), (-0.5, false), (9.0, false)].into_iter().enumerate() {
            let origin = [far * 8192 + ((step as i32) << log2_edge), 0, 4096];
            tree.tiles.push(Tile { origin, log2_edge, value, active });
        }
    }
    tree
}

fn grid(name: &str, values: GridValues) -> Grid {
    Grid {
        name: name.to_owned(),
        class: GridClass::FogVolume,
        index_to_world: glam::DAffine3::from_scale(glam::DVec3::splat(0.1)),
        saved_as_half: false,
        codec: String::new(),
        metadata: vec![("author".to_owned(), "someone".to_owned())],
        values,
    }
}

#[test]
fn awkward_trees_of_every_type_come_back() {
    let floats = awkward_tree();
    fn map<T>(tree: &Tree<f32>, convert: impl Fn(f32) -> T) -> Tree<T> {
        Tree {
            background: convert(tree.background),
            tiles: tree
                .tiles
                .iter()
                .map(|t| {
                    let Tile { origin, log2_edge, value, active } = *t;
                    Tile { origin, log2_edge, value: convert(value), active }
                })
                .collect(),
            leaves: tree.leaves.clone(),
            leaf_values: tree.leaf_values.iter().map(|&value| convert(value)).collect(),
        }
    }
    // A reader keeps inactive tiles only where they differ from the background.
    fn telling<T: PartialEq>(mut tree: Tree<T>) -> Tree<T> {
        let Tree { background, tiles, .. } = &mut tree;
        tiles.retain(|tile| tile.active || tile.value != *background);
        tree
    }
    let mut mask = telling(map(&floats, |value| value > 0.5));
    for (index, value) in mask.leaf_values.iter_mut().enumerate() {
        *value = mask.leaves[index / 512].active[index % 512 / 64] >> (index % 64) & 1 != 0;
    }
    let grids = [
        grid("double", GridValues::Double(map(&floats, f64::from))),
        grid("vec3s", GridValues::Vec3(map(&floats, |value| [value, -value, 1.0]))),
        grid("int32", GridValues::Int32(telling(map(&floats, |value| value as i32)))),
        grid("int64", GridValues::Int64(telling(map(&floats, |value| value as i64 * 5_000_000_000)))),
        grid("bool", GridValues::Bool(telling(map(&floats, |value| value > 0.5)))),
        grid("mask", GridValues::Mask(mask)),
        grid("float", GridValues::Float(floats)),
    ];
    for codec in CODECS {
        for half in [false, true] {
            let read = write_and_read(&grids, &WriteOptions { codec, half });
            assert_eq!(grids.len(), read.len());
            for (written, read) in grids.iter().zip(&read) {
                assert_same(&format!("{} {codec:?} half {half}", written.name), written, read);
                let author = ("author".to_owned(), "someone".to_owned());
                assert!(read.metadata.contains(&author), "{:?}", read.metadata);
            }
        }
    }
}

#[test]
fn grids_of_one_name_are_told_apart_by_number() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("grids.vdb");
    let mut grids = vec![grid("density", GridValues::Float(awkward_tree())); 3];
    grids[1].class = GridClass::LevelSet;
    grids[2].name = "heat".to_owned();
    vdb::write(&path, &grids, &WriteOptions::default()).unwrap();
    let names = |names: &[&str]| GridSelection::Names(names.iter().map(|&name| name.to_owned()).collect());
    let read = |selection| vdb::read(&path, &selection).map(|file| file.grids);
    assert_eq!(read(names(&["density"])).unwrap().len(), 2);
    let second = read(names(&["density[1]"])).unwrap();
    assert_eq!((second.len(), second[0].class, second[0].name.as_str()), (1, GridClass::LevelSet, "density"));
    assert_eq!(read(names(&["heat", "density[0]", "heat"])).unwrap().len(), 2);
    let error = read(names(&["smoke"])).unwrap_err().to_string();
    assert!(
        error.ends_with("no grid named `smoke`; the file has `density[0]`, `density[1]`, `heat`"),
        "{error}"
    );
}

#[test]
fn every_linear_transform_comes_back() {
    use glam::{DAffine3, DQuat, DVec3};
    let scales = [DVec3::splat(0.3), DVec3::new(1.0, 2.0, 0.5), DVec3::new(-1.0, 1.0, 1.0)];
    for scale in scales {
        for rotation in [DQuat::IDENTITY, DQuat::from_rotation_y(1.0)] {
            for translation in [DVec3::ZERO, DVec3::new(3.0, -4.0, 5.0)] {
                let mut grid = grid("density", GridValues::Float(awkward_tree()));
                grid.index_to_world = DAffine3::from_scale_rotation_translation(scale, rotation, translation);
                let read = write_and_read(std::slice::from_ref(&grid), &WriteOptions::default());
                assert_same("transform", &grid, &read[0]);
            }
        }
    }
}

#[test]
fn what_has_no_place_in_a_file_is_refused_and_the_old_file_stays() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("grids.vdb");
    std::fs::write(&path, "old").unwrap();
    let refuse = |change: fn(&mut Tree<f32>), half: bool, word: &str| {
        let mut tree = awkward_tree();
        change(&mut tree);
        let options = WriteOptions { half, ..WriteOptions::default() };
        let error = vdb::write(&path, &[grid("density", GridValues::Float(tree))], &options).unwrap_err();
        assert!(matches!(error, WriteError::Unwritable { .. }));
        assert!(error.to_string().contains(word), "{error}");
        assert_eq!(std::fs::read(&path).unwrap(), b"old");
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1);
    };
    refuse(|tree| tree.leaf_values[5] = 1e6, true, "65504");
    refuse(|tree| tree.leaves[1].origin = tree.leaves[0].origin, false, "two leaves");
    refuse(|tree| tree.leaves[1].origin = [1, 2, 3], false, "multiple of 8");
    refuse(|tree| tree.tiles[0].log2_edge = 5, false, "2^5");
    refuse(|tree| tree.tiles[0].origin = tree.leaves[0].origin, false, "overlaps");
    refuse(|tree| tree.tiles[8].origin = [-4096, -8192, 0], false, "overlaps");
    refuse(|tree| tree.leaf_values.truncate(7), false, "values");
}
