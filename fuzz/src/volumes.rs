//! Volume files of every format; what is read is measured and made into bricks, as for a render.

use std::path::Path;
use std::sync::LazyLock;

use glam::{DAffine3, DVec3};
use tyndall_volumes::{
    BrickGrid, Codec, Grid, GridClass, GridValues, Leaf, ReadRequest, Storage, Tile, Tree, VolumeFile,
    WriteOptions, read_bytes, write,
};

use crate::folder::Folder;
use crate::{Outcome, assert_message};

/// OpenVDB.
pub(crate) fn vdb(bytes: &[u8]) -> Outcome {
    volume("a.vdb", bytes)
}

/// NanoVDB. Uncompressed files are large, and damage to compressed ones goes no further than that: so an input that begins
/// with `patch` is changes to an uncompressed file.
pub(crate) fn nvdb(bytes: &[u8]) -> Outcome {
    match bytes.strip_prefix(b"patch") {
        Some(patches) => volume("a.nvdb", &patched(patches)),
        None => volume("a.nvdb", bytes),
    }
}

/// An uncompressed NanoVDB file with changes: offset (three bytes), number of bytes (one), the bytes.
fn patched(mut patches: &[u8]) -> Vec<u8> {
    static SOUND: LazyLock<Vec<u8>> = LazyLock::new(|| {
        let folder = Folder::with("a", b"");
        let path = folder.path("a.nvdb");
        let options = WriteOptions { codec: Codec::None, half: false };
        write(&path, &[small_grid()], &options).expect("the grid can be written");
        std::fs::read(path).expect("it was just written")
    });
    let mut bytes = SOUND.clone();
    while let Some(([low, middle, high, len], rest)) = patches.split_first_chunk::<4>() {
        let at = u32::from_le_bytes([*low, *middle, *high, 0]) as usize;
        let len = rest.len().min(usize::from(*len));
        bytes.iter_mut().skip(at).zip(&rest[..len]).for_each(|(byte, new)| *byte = *new);
        patches = &rest[len..];
    }
    bytes
}

/// A leaf, and a tile of each size.
fn small_grid() -> Grid {
    let tile = |origin, log2_edge| Tile { origin, log2_edge, value: 2.0, active: true };
    let tree = Tree {
        background: 0.0f32,
        tiles: vec![tile([8, 0, 0], 3), tile([128, 0, 0], 7), tile([-4096, 0, 0], 12)],
        leaves: vec![Leaf { origin: [0; 3], active: [0x00ff_0000_0000_00ff; 8] }],
        leaf_values: (0..512).map(|n| n as f32).collect(),
    };
    Grid {
        name: "density".to_owned(),
        class: GridClass::FogVolume,
        index_to_world: DAffine3::IDENTITY,
        saved_as_half: false,
        codec: String::new(),
        metadata: Vec::new(),
        values: GridValues::Float(tree),
    }
}

/// Grid volumes of Mitsuba.
pub(crate) fn vol(bytes: &[u8]) -> Outcome {
    volume("a.vol", bytes)
}

/// NumPy arrays.
pub(crate) fn npy(bytes: &[u8]) -> Outcome {
    volume("a.npy", bytes)
}

/// NIfTI images, in gzip or not.
pub(crate) fn nifti(bytes: &[u8]) -> Outcome {
    volume("a.nii.gz", bytes)
}

/// Bare numbers: the first line of the input is the name, which tells shape and type.
pub(crate) fn raw(bytes: &[u8]) -> Outcome {
    let end = bytes.iter().position(|&byte| byte == b'\n').unwrap_or(bytes.len());
    let name = String::from_utf8_lossy(&bytes[..end]).replace(char::is_control, " ");
    volume(&format!("{name}.raw"), bytes.get(end + 1..).unwrap_or_default())
}

fn volume(name: &str, bytes: &[u8]) -> Outcome {
    let VolumeFile { grids, .. } = match read_bytes(bytes, Path::new(name), &ReadRequest::default()) {
        Ok(file) => file,
        Err(error) => return Outcome::refused(&error),
    };
    let content = grids.iter().map(|grid| grid.values.memory_bytes()).sum();
    for grid in &grids {
        grid.values.statistics();
        grid.values.probe(&[[0; 3], [i32::MIN; 3], [i32::MAX; 3]]);
        match BrickGrid::new(grid, Storage::F16) {
            Ok(bricks) => {
                let [least, greatest] = bricks.domain();
                for place in [DVec3::ZERO, least, 0.5 * (least + greatest), greatest, DVec3::MAX, DVec3::NAN]
                {
                    bricks.value(place);
                }
            }
            Err(error) => assert_message(&error.to_string()),
        }
    }
    Outcome::Read(content)
}
