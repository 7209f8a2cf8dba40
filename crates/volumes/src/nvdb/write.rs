//! Writing NanoVDB files: one segment a grid, floats and vectors of floats.
//!
//! The oldest magic number and version 32.4 are written: every reader of ABI 32, old or new, takes them. There is no
//! checksum (all bits set says so) and no average or deviation in the nodes.

use std::io::Write;

use flate2::Compression;
use flate2::write::ZlibEncoder;
use glam::DVec3;
use tyndall_machine::memory;

use crate::fault::Fault;
use crate::float_tree::FloatTree;
use crate::{Codec, Grid, GridClass};

use super::build::{Built, build};
use super::layout::{ALIGNMENT, GRID_HEAD, LOWER, Layout, TREE_HEAD, UPPER, ValueType, align};
use super::{BLOSC_PIECE, GRID_RECORD, MAGIC_0, SEGMENT_HEAD};

const VERSION: u32 = 32 << 21 | 4 << 10 | 2;
/// What the nodes hold: bounds (2) and extrema (4); and that they stand breadth first (32).
const HAS_BOUNDS: u32 = 2;
const HAS_EXTREMA: u32 = 4;
const BREADTH_FIRST: u32 = 32;
const LONG_NAME: u32 = 1;
/// Room for a name in the head of a grid, with its zero byte.
const SHORT_NAME: usize = 256;
const BLIND_HEAD: usize = 288;

/// Writes `grids`; scalars of every type become floats.
pub(crate) fn write(out: &mut dyn Write, grids: &[Grid], codec: Codec) -> Result<(), Fault> {
    if grids.is_empty() {
        return Err(Fault::unsupported("there is no grid to write"));
    }
    for grid in grids {
        match FloatTree::of(&grid.values) {
            FloatTree::Scalar(tree) => write_grid(out, grid, build(&*tree)?, codec)?,
            FloatTree::Vector(tree) => write_grid(out, grid, build(tree)?, codec)?,
        }
    }
    Ok(())
}

fn write_grid(out: &mut dyn Write, grid: &Grid, built: Built, codec: Codec) -> Result<(), Fault> {
    let head = Head::of(grid, &built)?;
    let Built { bytes: mut buffer, nodes, tiles, summary, value_type } = built;
    let long_name = grid.name.len() >= SHORT_NAME;
    let nodes_end = buffer.len();
    if long_name {
        append_name(&mut buffer, &grid.name);
    }
    let size = buffer.len() as u64;
    head.put(&mut buffer, grid, value_type, nodes_end, long_name);
    put_tree_head(&mut buffer, nodes, tiles, summary.voxels, value_type);

    let packed = pack(buffer, codec)?;
    let on_disk = packed.len() as u64;
    let mut record = Record { bytes: vec![0; SEGMENT_HEAD + GRID_RECORD] };
    let codec_number: u16 = match codec {
        Codec::None => 0,
        Codec::Zip => 1,
        Codec::Blosc => 2,
    };
    record.put(0, &MAGIC_0.to_le_bytes());
    record.put(8, &VERSION.to_le_bytes());
    record.put(12, &1u16.to_le_bytes());
    record.put(14, &codec_number.to_le_bytes());
    let at = |offset| SEGMENT_HEAD + offset;
    for (n, number) in [size, on_disk, name_hash(&grid.name), summary.voxels].into_iter().enumerate() {
        record.put(at(8 * n), &number.to_le_bytes());
    }
    record.put(at(32), &value_type.number().to_le_bytes());
    record.put(at(36), &head.class.to_le_bytes());
    record.put_floats(at(40), head.world_box.into_iter().flat_map(|corner| corner.to_array()));
    for (n, index) in head.bounds.into_iter().flatten().enumerate() {
        record.put(at(88 + 4 * n), &index.to_le_bytes());
    }
    record.put_floats(at(112), head.voxel_size.to_array().into_iter());
    record.put(at(136), &(grid.name.len() as u32 + 1).to_le_bytes());
    for (n, count) in nodes.into_iter().chain([1]).chain(tiles).enumerate() {
        record.put(at(140 + 4 * n), &count.to_le_bytes());
    }
    record.put(at(168), &codec_number.to_le_bytes());
    record.put(at(170), &u16::from(long_name).to_le_bytes());
    record.put(at(172), &VERSION.to_le_bytes());
    record.bytes.extend_from_slice(grid.name.as_bytes());
    record.bytes.push(0);
    out.write_all(&record.bytes).and_then(|()| out.write_all(&packed)).map_err(Fault::Io)
}

/// What stands both in the head of a grid and in its record.
struct Head {
    class: u32,
    bounds: [[i32; 3]; 2],
    world_box: [DVec3; 2],
    voxel_size: DVec3,
    has_extrema: bool,
}

impl Head {
    fn of(grid: &Grid, built: &Built) -> Result<Self, Fault> {
        if grid.name.contains('\0') {
            return Err(Fault::unsupported("a grid whose name holds a zero byte is not written; rename it"));
        }
        let scalar = built.value_type == ValueType::Float;
        let class = match grid.class {
            GridClass::LevelSet if scalar => 1,
            GridClass::FogVolume if scalar => 2,
            GridClass::Staggered if !scalar => 3,
            _ => 0,
        };
        let map = &grid.index_to_world;
        let bounds = built.summary.bounds.unwrap_or([[i32::MAX; 3], [i32::MIN; 3]]);
        // The corners of the box around whole voxels, of which the greatest index is the first of the voxel.
        let corner = |n: usize| {
            let index = |axis: usize| f64::from(bounds[n >> axis & 1][axis]) + (n >> axis & 1) as f64;
            map.transform_point3(DVec3::new(index(0), index(1), index(2)))
        };
        let world_box = match built.summary.bounds {
            Some(_) => {
                (1..8).fold([corner(0); 2], |[low, high], n| [low.min(corner(n)), high.max(corner(n))])
            }
            None => [DVec3::MAX, DVec3::MIN],
        };
        let voxel_size = DVec3::from_array([0, 1, 2].map(|axis| map.matrix3.col(axis).length()));
        Ok(Self { class, bounds, world_box, voxel_size, has_extrema: scalar })
    }

    /// Fills the first 672 bytes of a grid's buffer.
    fn put(&self, buffer: &mut [u8], grid: &Grid, value_type: ValueType, nodes_end: usize, long_name: bool) {
        let size = buffer.len() as u64;
        let mut head = Record { bytes: vec![0; GRID_HEAD] };
        let flags = HAS_BOUNDS
            | BREADTH_FIRST
            | if self.has_extrema { HAS_EXTREMA } else { 0 }
            | if long_name { LONG_NAME } else { 0 };
        head.put(0, &MAGIC_0.to_le_bytes());
        head.put(8, &u64::MAX.to_le_bytes());
        head.put(16, &VERSION.to_le_bytes());
        head.put(20, &flags.to_le_bytes());
        head.put(28, &1u32.to_le_bytes());
        head.put(32, &size.to_le_bytes());
        let name = grid.name.as_bytes();
        head.put(40, &name[..name.len().min(SHORT_NAME - 1)]);
        let map = grid.index_to_world;
        let inverse = map.matrix3.inverse();
        let rows = map.matrix3.transpose().to_cols_array();
        let inverse_rows = inverse.transpose().to_cols_array();
        let parts = rows.into_iter().chain(inverse_rows);
        for (n, value) in parts.clone().chain(map.translation.to_array()).chain([1.0]).enumerate() {
            head.put(296 + 4 * n, &(value as f32).to_le_bytes());
        }
        head.put_floats(384, parts.chain(map.translation.to_array()).chain([1.0]));
        head.put_floats(560, self.world_box.into_iter().flat_map(|corner| corner.to_array()));
        head.put_floats(608, self.voxel_size.to_array().into_iter());
        head.put(632, &self.class.to_le_bytes());
        head.put(636, &value_type.number().to_le_bytes());
        head.put(640, &(nodes_end as u64).to_le_bytes());
        head.put(648, &u32::from(long_name).to_le_bytes());
        buffer[..GRID_HEAD].copy_from_slice(&head.bytes);
    }
}

/// A row of bytes with numbers at offsets.
struct Record {
    bytes: Vec<u8>,
}

impl Record {
    fn put(&mut self, at: usize, bytes: &[u8]) {
        self.bytes[at..at + bytes.len()].copy_from_slice(bytes);
    }

    fn put_floats(&mut self, at: usize, values: impl Iterator<Item = f64>) {
        values.enumerate().for_each(|(n, value)| self.put(at + 8 * n, &value.to_le_bytes()));
    }
}

/// Offsets of the first node of each level, from the head of the tree on, then the counts.
fn put_tree_head(buffer: &mut [u8], nodes: [u32; 3], tiles: [u32; 3], voxels: u64, value_type: ValueType) {
    let layout = Layout::of(value_type);
    let root = GRID_HEAD + TREE_HEAD;
    let entries = u32::from_le_bytes(std::array::from_fn(|n| buffer[root + 24 + n])) as usize;
    let [_, lowers, uppers] = nodes.map(|count| count as usize);
    let first_upper = TREE_HEAD + layout.root_head() + entries * layout.root_entry();
    let first_lower = first_upper + uppers * layout.inner(UPPER);
    let first_leaf = first_lower + lowers * layout.inner(LOWER);
    let mut head = Vec::with_capacity(TREE_HEAD);
    for offset in [first_leaf, first_lower, first_upper, TREE_HEAD] {
        head.extend_from_slice(&(offset as u64).to_le_bytes());
    }
    for count in nodes.into_iter().chain(tiles) {
        head.extend_from_slice(&count.to_le_bytes());
    }
    head.extend_from_slice(&voxels.to_le_bytes());
    buffer[GRID_HEAD..root].copy_from_slice(&head);
}

/// Adds a name that is too long for the head, as blind data of class "grid name" (3).
fn append_name(buffer: &mut Vec<u8>, name: &str) {
    let mut blind = Record { bytes: vec![0; BLIND_HEAD] };
    blind.put(0, &(BLIND_HEAD as u64).to_le_bytes());
    blind.put(8, &(name.len() as u64 + 1).to_le_bytes());
    blind.put(16, &1u32.to_le_bytes());
    blind.put(24, &3u32.to_le_bytes());
    buffer.extend_from_slice(&blind.bytes);
    buffer.extend_from_slice(name.as_bytes());
    buffer.resize(align(buffer.len() + 1, ALIGNMENT), 0);
}

fn pack(buffer: Vec<u8>, codec: Codec) -> Result<Vec<u8>, Fault> {
    if codec != Codec::None {
        // Packed it is hardly ever larger.
        memory::ask(buffer.len() as u64, || format!("{} bytes to be compressed", buffer.len()))?;
    }
    let mut packed = vec![];
    match codec {
        Codec::None => return Ok(buffer),
        Codec::Zip => {
            let mut stream = ZlibEncoder::new(vec![0; 8], Compression::default());
            packed = stream.write_all(&buffer).and_then(|()| stream.finish()).map_err(Fault::Io)?;
            let length = packed.len() as u64 - 8;
            packed[..8].copy_from_slice(&length.to_le_bytes());
        }
        Codec::Blosc => {
            for piece in buffer.chunks(BLOSC_PIECE as usize) {
                let chunk = crate::blosc::compress(piece, 4);
                packed.extend_from_slice(&(chunk.len() as u64).to_le_bytes());
                packed.extend_from_slice(&chunk);
            }
        }
    }
    Ok(packed)
}

/// The hash by which readers look a name up: base 67, the bits shifted out added to the next digit.
fn name_hash(name: &str) -> u64 {
    name.bytes().fold(0u64, |hash, byte| {
        let overflow = hash >> 56;
        hash.wrapping_mul(67).wrapping_add(u64::from(byte)).wrapping_add(overflow)
    })
}
