//! The shape of a tree: a root table, two levels of inner nodes, and the masks of the leaves.
//!
//! ```text
//! i32 number of buffers (1) · background · u32 tiles · u32 children
//! tile:  i32 ×3 origin · value · u8 active
//! child: i32 ×3 origin · inner node of 32³ entries of 128³ voxels
//! inner node: child mask · active mask · values of all entries, coded as in `values` · its children
//!             (inner nodes of 16³ entries of 8³ voxels, and in those leaves: their active masks)
//! ```
//!
//! Entry (x, y, z) of a node with n = 2^log2 entries along an edge is number x n² + y n + z. The masks of all leaves
//! come before the values of the first. Source: Museth 2013, "VDB"; OpenVDB, `tree/RootNode` and `InternalNode`.

use super::cursor::{Cursor, Problem, damaged};
use super::value::{self, Value, Width};
use super::values::{Coding, Decoder, Stored, is_set};
use crate::{Leaf, Tile};
use std::collections::HashSet;

/// Base-2 logarithms of the entries along the edge of the inner nodes, from the root down; a leaf has 3.
pub(super) const LOG2_ENTRIES: [u32; 2] = [5, 4];
/// Base-2 logarithms of the edge in voxels of what an entry of the root and of each inner node covers.
pub(super) const LOG2_EDGES: [u32; 3] = [12, 7, 3];

/// A tree without the values of its leaves.
pub(super) struct Topology<T> {
    pub(super) coding: Coding<T>,
    pub(super) tiles: Vec<Tile<T>>,
    pub(super) leaves: Vec<Leaf>,
}

/// Reads a whole topology and moves past it.
pub(super) fn read<T: Value>(cursor: &mut Cursor, flags: u32, width: Width) -> Result<Topology<T>, Problem> {
    let buffers = cursor.i32("the number of buffers")?;
    if buffers != 1 {
        return Err(damaged(format!("a tree has {buffers} buffers instead of 1")));
    }
    let lone = value::bytes_alone::<T>(width);
    let background = value::alone(width, cursor.take(lone, "the background")?);
    let coding = Coding { flags, width, background };
    let mut nodes = Nodes {
        topology: Topology { coding, tiles: Vec::new(), leaves: Vec::new() },
        decoder: Decoder::new(),
    };
    let tiles = cursor.u32("the number of root tiles")?;
    let children = cursor.u32("the number of root children")?;
    let mut origins = HashSet::new();
    for _ in 0..tiles {
        let origin = root_origin(cursor, &mut origins)?;
        let value = value::alone(width, cursor.take(lone, "a root tile")?);
        let active = cursor.u8("a root tile")? != 0;
        nodes.add_tile(Tile { origin, log2_edge: LOG2_EDGES[0], value, active });
    }
    for _ in 0..children {
        let origin = root_origin(cursor, &mut origins)?;
        nodes.read_inner(cursor, 0, origin).map_err(|problem| problem.at(&format!("node at {origin:?}")))?;
    }
    Ok(nodes.topology)
}

fn root_origin(cursor: &mut Cursor, known: &mut HashSet<[i32; 3]>) -> Result<[i32; 3], Problem> {
    let origin = cursor.coordinates("an entry of the root")?;
    let edge = 1 << LOG2_EDGES[0];
    if origin.iter().any(|coordinate| coordinate % edge != 0) {
        return Err(damaged(format!(
            "an entry of the root is at {origin:?}, which is not a multiple of {edge}"
        )));
    }
    if !known.insert(origin) {
        return Err(damaged(format!("the root has two entries at {origin:?}")));
    }
    Ok(origin)
}

struct Nodes<T> {
    topology: Topology<T>,
    decoder: Decoder<T>,
}

impl<T: Value> Nodes<T> {
    fn add_tile(&mut self, tile: Tile<T>) {
        if tile.active || !tile.value.same(self.topology.coding.background) {
            grow_by_a_quarter(&mut self.topology.tiles);
            self.topology.tiles.push(tile);
        }
    }

    fn read_inner(&mut self, cursor: &mut Cursor, level: usize, origin: [i32; 3]) -> Result<(), Problem> {
        let log2 = LOG2_ENTRIES[level];
        let entries = 1 << (3 * log2);
        let child_mask = mask(cursor.take(entries / 8, "a child mask")?);
        let active_mask = mask(cursor.take(entries / 8, "an active mask")?);
        let stored = Stored::find(cursor, &self.topology.coding, &active_mask)?;
        let mut values = vec![T::ZERO; entries];
        stored.decode(self.topology.coding.width, &active_mask, &mut self.decoder, &mut values)?;
        let log2_edge = LOG2_EDGES[level + 1];
        let entry_origin = |entry: usize| {
            let along = |shift: u32| ((entry >> shift & ((1 << log2) - 1)) as i32) << log2_edge;
            [origin[0] + along(2 * log2), origin[1] + along(log2), origin[2] + along(0)]
        };
        for (entry, &value) in values.iter().enumerate() {
            if !is_set(&child_mask, entry) {
                let active = is_set(&active_mask, entry);
                self.add_tile(Tile { origin: entry_origin(entry), log2_edge, value, active });
            }
        }
        drop(values);
        for entry in (0..entries).filter(|&entry| is_set(&child_mask, entry)) {
            let origin = entry_origin(entry);
            if level + 1 < LOG2_ENTRIES.len() {
                self.read_inner(cursor, level + 1, origin)?;
            } else {
                let mut active = [0; 8];
                active.copy_from_slice(&mask(cursor.take(64, "the mask of a leaf")?));
                grow_by_a_quarter(&mut self.topology.leaves);
                self.topology.leaves.push(Leaf { origin, active });
            }
        }
        Ok(())
    }
}

/// Doubling, as a vector does of itself, would take more than a damaged file has to show for it.
fn grow_by_a_quarter<T>(items: &mut Vec<T>) {
    if items.len() == items.capacity() {
        items.reserve_exact(items.len() / 4 + 1024);
    }
}

fn mask(bytes: &[u8]) -> Vec<u64> {
    bytes.as_chunks().0.iter().map(|&word| u64::from_le_bytes(word)).collect()
}
