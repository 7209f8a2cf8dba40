//! Ten thousand damaged files of every format: each is read or refused in one line, none panics or asks for much.

use std::path::Path;

use tyndall_volumes::{Codec, ReadRequest, read_bytes, write};

use crate::facts::{options, shared};
use crate::nvdb_files::{file_of, grid_of, mixed_tree};

/// Knuth's MMIX generator, upper bits: enough to pick bytes with, and the same on every machine.
struct Random(u64);

impl Random {
    fn below(&mut self, bound: usize) -> usize {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        ((self.0 >> 33) as usize) % bound.max(1)
    }
}

/// One of: some bytes changed, a run of one byte, a hostile number, a part cut out, an end cut off.
fn corrupt(file: &[u8], random: &mut Random) -> Vec<u8> {
    let mut file = file.to_vec();
    // Heads are short and matter most.
    let place = |random: &mut Random, len: usize| {
        let reach = if random.below(2) == 0 { len.min(1024) } else { len };
        random.below(reach)
    };
    match random.below(5) {
        0 => {
            for _ in 0..=random.below(8) {
                let at = place(random, file.len());
                file[at] = random.below(256) as u8;
            }
        }
        1 => {
            let (at, len) = (place(random, file.len()), random.below(64));
            let end = (at + len).min(file.len());
            file[at..end].fill([0, 0xff, 0x7f, 0x80][random.below(4)]);
        }
        2 => {
            let at = place(random, file.len()).min(file.len().saturating_sub(8)) & !3;
            let hostile = [u64::MAX, i64::MAX as u64, 1 << 31, 1 << 32, 1 << 62, u64::from(u32::MAX), 0, 1]
                [random.below(8)];
            let len = if random.below(2) == 0 { 4 } else { 8 };
            file[at..at + len].copy_from_slice(&hostile.to_le_bytes()[..len]);
        }
        3 => {
            let at = place(random, file.len());
            let end = (at + 1 + random.below(200)).min(file.len());
            file.drain(at..end);
        }
        _ => file.truncate(place(random, file.len())),
    }
    file
}

#[track_caller]
fn survive(name: &str, file: &[u8], rounds: usize, seed: u64) {
    let mut random = Random(seed);
    let (mut read, mut refused) = (0, 0);
    for round in 0..rounds {
        let damaged = corrupt(file, &mut random);
        match read_bytes(&damaged, Path::new(name), &ReadRequest::default()) {
            Ok(found) => {
                read += 1;
                let taken: usize = found.grids.iter().map(|grid| grid.values.memory_bytes()).sum();
                assert!(taken < (64 << 20) + 16 * damaged.len(), "{name}, round {round}: {taken} bytes");
            }
            Err(error) => {
                refused += 1;
                let line = error.to_string();
                assert!(!line.contains('\n') && line.starts_with(name), "{name}, round {round}: {line}");
            }
        }
    }
    assert!(read > 0 && refused > 0, "{name}: {read} read, {refused} refused");
}

/// A small file of the format that `name` has.
fn small(name: &str) -> (String, Vec<u8>) {
    let mut tree = mixed_tree();
    tree.tiles.truncate(2);
    tree.leaves.truncate(1);
    tree.leaf_values.truncate(512);
    let mut grid = grid_of("density", tree);
    grid.index_to_world = glam::DAffine3::from_scale(glam::DVec3::splat(0.5));
    let folder = tempfile::tempdir().expect("a folder");
    let path = write(&folder.path().join(name), &[grid], &options(Codec::None)).expect("written");
    let name = path.file_name().expect("a name").to_string_lossy().into_owned();
    (name, std::fs::read(path).expect("readable"))
}

#[test]
fn damaged_arrays_are_read_or_refused() {
    for (seed, name) in ["a.npy", "a.vol", "a.nii", "a.nii.gz", "a.raw"].into_iter().enumerate() {
        let (name, file) = small(name);
        survive(&name, &file, 1500, seed as u64);
    }
}

#[test]
fn damaged_nanovdb_files_are_read_or_refused() {
    for (seed, codec) in [Codec::None, Codec::Zip, Codec::Blosc].into_iter().enumerate() {
        let file = file_of(&[grid_of("density", mixed_tree()), grid_of("heat", mixed_tree())], codec);
        survive("a.nvdb", &file, 500, seed as u64);
    }
}

#[test]
fn damaged_nanovdb_files_of_others_are_read_or_refused() {
    for (seed, name) in
        ["fp4", "fp8", "fp16_blosc", "fpN", "float_none", "float_zip", "float_blosc", "multi_zip"]
            .into_iter()
            .enumerate()
    {
        let Some(path) = shared(&format!("volumes/variants/{name}.nvdb")) else { return };
        let file = std::fs::read(path).expect("readable");
        survive("a.nvdb", &file, 250, 100 + seed as u64);
    }
}
