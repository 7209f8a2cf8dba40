//! Leaves and tiles, hung into a tree again: the shape that `topology` tells, without values.

use super::topology::{LOG2_EDGES, LOG2_ENTRIES};
use super::value::Value;
use crate::{LEAF_EDGE, LEAF_VOXELS, Tree};
use std::collections::BTreeMap;

/// The root: its tiles and nodes by their origin, numbers of tiles and leaves as in the [`Tree`].
#[derive(Debug, Default)]
pub(super) struct Root {
    pub(super) tiles: BTreeMap<[i32; 3], usize>,
    pub(super) children: BTreeMap<[i32; 3], Upper>,
}

/// A node of 32³ entries; tiles and children by entry.
#[derive(Debug, Default)]
pub(super) struct Upper {
    pub(super) tiles: BTreeMap<usize, usize>,
    pub(super) children: BTreeMap<usize, Lower>,
}

/// A node of 16³ entries; tiles and leaves by entry.
#[derive(Debug, Default)]
pub(super) struct Lower {
    pub(super) tiles: BTreeMap<usize, usize>,
    pub(super) leaves: BTreeMap<usize, usize>,
}

impl Root {
    /// Hangs everything into its place; says in one line what has none.
    pub(super) fn build<T: Value>(tree: &Tree<T>) -> Result<Self, String> {
        if tree.leaf_values.len() != tree.leaves.len() * LEAF_VOXELS {
            return Err(format!("{} leaves have {} values", tree.leaves.len(), tree.leaf_values.len()));
        }
        let mut root = Self::default();
        for (index, leaf) in tree.leaves.iter().enumerate() {
            check_aligned(leaf.origin, LEAF_EDGE)?;
            let lower = root.upper(leaf.origin).lower(leaf.origin);
            if lower.leaves.insert(entry(1, leaf.origin), index).is_some() {
                return Err(format!("two leaves are at {:?}", leaf.origin));
            }
        }
        for (index, tile) in tree.tiles.iter().enumerate() {
            let origin = tile.origin;
            let level = LOG2_EDGES.iter().position(|&log2| log2 == tile.log2_edge);
            let level =
                level.ok_or_else(|| format!("a tile at {origin:?} has an edge of 2^{}", tile.log2_edge))?;
            check_aligned(origin, 1 << tile.log2_edge)?;
            let (there_is_a_child, there_is_a_tile) = match level {
                0 => (root.children.contains_key(&origin), root.tiles.insert(origin, index)),
                1 => {
                    let (upper, entry) = (root.upper(origin), entry(0, origin));
                    (upper.children.contains_key(&entry), upper.tiles.insert(entry, index))
                }
                _ => {
                    let (lower, entry) = (root.upper(origin).lower(origin), entry(1, origin));
                    (lower.leaves.contains_key(&entry), lower.tiles.insert(entry, index))
                }
            };
            if there_is_a_child || there_is_a_tile.is_some() {
                return Err(format!("a tile at {origin:?} overlaps others"));
            }
        }
        root.check_coarse_tiles()?;
        Ok(root)
    }

    /// A child made after a tile of the same place is noticed only now.
    fn check_coarse_tiles(&self) -> Result<(), String> {
        let covered = self.tiles.keys().find(|origin| self.children.contains_key(*origin));
        let covered_below = self
            .children
            .iter()
            .find(|(_, upper)| upper.tiles.keys().any(|entry| upper.children.contains_key(entry)))
            .map(|(origin, _)| origin);
        match covered.or(covered_below) {
            Some(origin) => Err(format!("a tile in the node at {origin:?} overlaps others")),
            None => Ok(()),
        }
    }

    /// Numbers of the leaves in the order of the file.
    pub(super) fn leaves(&self) -> Vec<usize> {
        let lowers = self.children.values().flat_map(|upper| upper.children.values());
        lowers.flat_map(|lower| lower.leaves.values().copied()).collect()
    }

    fn upper(&mut self, voxel: [i32; 3]) -> &mut Upper {
        let mask = !((1 << LOG2_EDGES[0]) - 1);
        self.children.entry(voxel.map(|coordinate| coordinate & mask)).or_default()
    }
}

impl Upper {
    fn lower(&mut self, voxel: [i32; 3]) -> &mut Lower {
        self.children.entry(entry(0, voxel)).or_default()
    }
}

/// Number of the entry that covers a voxel, in the inner node of `level`.
fn entry(level: usize, voxel: [i32; 3]) -> usize {
    let log2 = LOG2_ENTRIES[level];
    let along = voxel.map(|coordinate| (coordinate >> LOG2_EDGES[level + 1]) as usize & ((1 << log2) - 1));
    along[0] << (2 * log2) | along[1] << log2 | along[2]
}

fn check_aligned(origin: [i32; 3], edge: i32) -> Result<(), String> {
    match origin.iter().all(|coordinate| coordinate % edge == 0) {
        true => Ok(()),
        false => Err(format!("{origin:?} is not a multiple of {edge}")),
    }
}
