//! Damaged files give an error or a grid, never a panic, and take no memory that their content does not account for.
//!
//! Ten thousand files are damaged in memory, always in the same way, and every allocation is counted.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::{Path, PathBuf};

use tyndall_fuzz::memory::{alone, peak_of};
use tyndall_fuzz::mutation::Random;
use tyndall_volumes::vdb::{self, Codec, VdbFile, WriteOptions};
use tyndall_volumes::{Grid, GridClass, GridSelection, GridValues, LEAF_VOXELS, Leaf, ReadError, Tree};

const DAMAGED_FILES: usize = 10_000;
const ALLOWANCE: usize = 64 << 20;

/// What reading gives, and the most memory it took at any time.
fn measured(bytes: &[u8]) -> (Result<VdbFile, ReadError>, usize) {
    peak_of(|| vdb::read_bytes(bytes, Path::new("damaged.vdb"), &GridSelection::All))
}

fn corpus() -> Option<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../shared/volumes");
    if !folder.is_dir() {
        eprintln!("skipped: {} is not there", folder.display());
        return None;
    }
    Some(folder)
}

fn damage(bytes: &mut Vec<u8>, random: &mut Random) {
    for _ in 0..1 + random.below(3) {
        // What comes first says most: half of the damage goes to headers and topology.
        let reach = if random.below(2) == 0 { bytes.len() } else { bytes.len().min(2048) };
        let at = random.below(reach);
        match random.below(10) {
            0 => bytes.truncate(at),
            1..=4 => {
                for _ in 0..1 + random.below(8) {
                    let at = random.below(reach);
                    if let Some(byte) = bytes.get_mut(at) {
                        *byte ^= 1 << random.below(8);
                    }
                }
            }
            5..=7 => {
                let extremes: [u64; 8] =
                    [0, 1, u64::MAX, 1 << 31, i32::MAX as u64, i64::MAX as u64, 1 << 32, random.bits()];
                let value = extremes[random.below(8)].to_le_bytes();
                let len = [4, 8][random.below(2)];
                bytes.iter_mut().skip(at).take(len).zip(value).for_each(|(byte, value)| *byte = value);
            }
            8 => {
                let from = random.below(bytes.len());
                let piece: Vec<u8> = bytes.iter().skip(from).take(random.below(300)).copied().collect();
                bytes.splice(at..at, piece);
            }
            _ => {
                let end = (at + random.below(64)).min(bytes.len());
                bytes.drain(at.min(end)..end);
            }
        }
    }
}

#[test]
fn ten_thousand_damaged_files_neither_panic_nor_take_memory_that_is_not_theirs() {
    let _turn = alone();
    let Some(folder) = corpus() else { return };
    let mut paths: Vec<PathBuf> = ["", "variants", "damaged"]
        .iter()
        .flat_map(|sub| std::fs::read_dir(folder.join(sub)).unwrap().map(|entry| entry.unwrap().path()))
        .filter(|path| path.extension().is_some_and(|extension| extension == "vdb"))
        .filter(|path| (100..150_000).contains(&path.metadata().unwrap().len()))
        .collect();
    paths.sort();
    let originals: Vec<(Vec<u8>, usize)> = paths
        .iter()
        .map(|path| {
            let bytes = std::fs::read(path).unwrap();
            let content = measured(&bytes).1;
            (bytes, content)
        })
        .collect();
    assert!(originals.len() > 30);
    let mut random = Random(1871);
    let (mut refused, mut read) = (0, 0);
    for round in 0..DAMAGED_FILES {
        let file = round % originals.len();
        let (original, content) = &originals[file];
        let mut bytes = original.clone();
        damage(&mut bytes, &mut random);
        let name = paths[file].display();
        let outcome = catch_unwind(AssertUnwindSafe(|| {
            let (outcome, peak) = measured(&bytes);
            assert!(peak <= content + ALLOWANCE, "took {peak} bytes, {content} undamaged");
            // Whatever is read can be looked at.
            let grids = outcome.map(|file| file.grids)?;
            for grid in &grids {
                grid.values.statistics();
                grid.values.probe(&[[0; 3], [i32::MIN; 3], [i32::MAX; 3]]);
            }
            Ok::<_, ReadError>(())
        }));
        match outcome.unwrap_or_else(|_| panic!("round {round}: {name}")) {
            Ok(()) => read += 1,
            Err(error) => {
                let message = error.to_string();
                assert!(!message.contains('\n') && message.len() < 600, "{message}");
                refused += 1;
            }
        }
    }
    eprintln!("{refused} refused, {read} read");
    assert!(refused > DAMAGED_FILES / 2 && read > DAMAGED_FILES / 20, "{refused} refused, {read} read");
}

/// A file of one grid with this many full leaves, all of one value.
fn flat_file(leaves: usize, codec: Codec) -> Vec<u8> {
    let origin =
        |leaf: usize| [(leaf >> 16) as i32 * 8, (leaf >> 8 & 255) as i32 * 8, (leaf & 255) as i32 * 8];
    let tree = Tree {
        background: 0.0f32,
        tiles: Vec::new(),
        leaves: (0..leaves).map(|leaf| Leaf { origin: origin(leaf), active: [u64::MAX; 8] }).collect(),
        leaf_values: vec![1.0; leaves * LEAF_VOXELS],
    };
    let grid = Grid {
        name: "density".to_owned(),
        class: GridClass::FogVolume,
        index_to_world: glam::DAffine3::IDENTITY,
        saved_as_half: false,
        codec: String::new(),
        metadata: Vec::new(),
        values: GridValues::Float(tree),
    };
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("flat.vdb");
    vdb::write(&path, &[grid], &WriteOptions { codec, half: false }).unwrap();
    std::fs::read(&path).unwrap()
}

fn find(bytes: &[u8], pattern: &[u8]) -> usize {
    bytes.windows(pattern.len()).position(|window| window == pattern).unwrap()
}

#[test]
fn leaves_whose_values_are_missing_take_no_memory() {
    let _turn = alone();
    // 120 MiB of values behind 4 MiB of topology.
    let leaves = 60_000;
    for codec in [Codec::None, Codec::Zip, Codec::Blosc] {
        let mut bytes = flat_file(leaves, codec);
        let (whole, peak) = measured(&bytes);
        assert!(whole.is_ok());
        assert!(peak < leaves * (LEAF_VOXELS * 4 + 80) + ALLOWANCE, "{codec:?}: {peak}");
        // Without offsets nothing tells that the end is missing.
        bytes[20] = 0;
        bytes.truncate(leaves * 64 + leaves);
        let (outcome, peak) = measured(&bytes);
        assert!(outcome.unwrap_err().to_string().contains("truncated"));
        assert!(peak < bytes.len() + ALLOWANCE, "{codec:?}: {peak}");
    }
}

#[test]
fn lengths_that_the_file_does_not_hold_take_no_memory() {
    let _turn = alone();
    let sound = flat_file(1, Codec::Blosc);
    let after_uuid = 8 + 4 + 8 + 1 + 36;
    let root = find(&sound, b"UniformScaleMap") + 15 + 5 * 24 + 4;
    for (place, at) in [
        ("number of metadata", after_uuid),
        ("length of a name", after_uuid + 4),
        ("length of a grid's name", find(&sound, b"density") - 4),
        ("number of root tiles", root + 4),
        ("number of root children", root + 8),
    ] {
        for huge in [i32::MAX as u32, u32::MAX] {
            let mut bytes = sound.clone();
            bytes[at..at + 4].copy_from_slice(&huge.to_le_bytes());
            let (outcome, peak) = measured(&bytes);
            assert!(matches!(outcome, Err(ReadError::Damaged { .. })), "{place}");
            assert!(peak < 1 << 20, "{place}: {peak}");
        }
    }
}

#[test]
fn instances_of_a_large_tree_are_not_copied_without_end() {
    let _turn = alone();
    let sound = flat_file(5_000, Codec::Blosc);
    let grid = find(&sound, b"density") - 4;
    let end = sound.len();
    let count = 2000u32;
    let mut bytes = sound[..grid - 4].to_vec();
    bytes.extend_from_slice(&(1 + count).to_le_bytes());
    bytes.extend_from_slice(&sound[grid..end]);
    for instance in 0..count {
        // Name, type, parent; three offsets; no compression, no metadata, the identity as a translation by 0.
        for text in [format!("i{instance}").as_str(), "Tree_float_5_4_3", "density"] {
            bytes.extend_from_slice(&(text.len() as u32).to_le_bytes());
            bytes.extend_from_slice(text.as_bytes());
        }
        let start = bytes.len() as u64 + 24;
        for offset in [start, 0, start + 4 + 4 + 4 + 14 + 24] {
            bytes.extend_from_slice(&offset.to_le_bytes());
        }
        bytes.extend_from_slice(&[0; 8]);
        bytes.extend_from_slice(&14u32.to_le_bytes());
        bytes.extend_from_slice(b"TranslationMap");
        bytes.extend_from_slice(&[0; 24]);
    }
    let content = measured(&sound).1;
    let (outcome, peak) = measured(&bytes);
    let file = outcome.unwrap();
    assert!(peak < content + ALLOWANCE, "{peak}");
    assert!(file.grids.len() > 2 && !file.skipped.is_empty(), "{} grids", file.grids.len());
    assert!(file.skipped[0].why.contains("by its name"), "{}", file.skipped[0].why);
    let last = GridSelection::Names(vec![format!("i{}", count - 1)]);
    let alone = vdb::read_bytes(&bytes, Path::new("instances.vdb"), &last).unwrap();
    assert_eq!(alone.grids[0].values.statistics().active_voxels, 5_000 * 512);
}
