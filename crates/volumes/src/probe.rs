//! The value at a voxel of a tree as a file has it. For rays there are bricks; this is for looking at single voxels.

use crate::statistics::{Components, components};
use crate::{GridValues, LEAF_EDGE, LEAF_VOXELS, Leaf, Tile, Tree};
use std::collections::{BTreeMap, HashMap};

impl<T: Copy> Tree<T> {
    /// Value and activity of the voxel at index coordinates `voxel`. Takes time with the size of the tree: for many
    /// voxels make a [`Lookup`] once.
    pub fn probe(&self, voxel: [i32; 3]) -> (T, bool) {
        let origin = aligned(voxel, LEAF_EDGE);
        if let Some(leaf) = self.leaves.iter().position(|leaf| leaf.origin == origin) {
            return self.in_leaf(leaf, voxel);
        }
        let covers = |tile: &&Tile<T>| aligned(voxel, 1 << tile.log2_edge) == tile.origin;
        self.tiles.iter().find(covers).map_or((self.background, false), |tile| (tile.value, tile.active))
    }

    fn in_leaf(&self, leaf: usize, voxel: [i32; 3]) -> (T, bool) {
        let [x, y, z] = voxel.map(|coordinate| coordinate.rem_euclid(LEAF_EDGE) as usize);
        let Leaf { active, .. } = self.leaves[leaf];
        let value = self.leaf_values[leaf * LEAF_VOXELS + (x << 6 | y << 3 | z)];
        (value, active[x] >> (y << 3 | z) & 1 != 0)
    }
}

/// A tree with the means to find any voxel at once.
pub struct Lookup<'a, T> {
    tree: &'a Tree<T>,
    leaves: HashMap<[i32; 3], usize>,
    /// By the logarithm of their edge.
    tiles: BTreeMap<u32, HashMap<[i32; 3], usize>>,
}

impl<'a, T: Copy> Lookup<'a, T> {
    /// Takes time and memory with the number of leaves and tiles.
    pub fn new(tree: &'a Tree<T>) -> Self {
        let mut tiles = BTreeMap::<u32, HashMap<_, _>>::new();
        for (index, tile) in tree.tiles.iter().enumerate() {
            tiles.entry(tile.log2_edge).or_default().insert(tile.origin, index);
        }
        let leaves = tree.leaves.iter().enumerate().map(|(index, leaf)| (leaf.origin, index)).collect();
        Self { tree, leaves, tiles }
    }

    /// Value and activity of the voxel at index coordinates `voxel`.
    pub fn probe(&self, voxel: [i32; 3]) -> (T, bool) {
        if let Some(&leaf) = self.leaves.get(&aligned(voxel, LEAF_EDGE)) {
            return self.tree.in_leaf(leaf, voxel);
        }
        let tile = self.tiles.iter().find_map(|(log2, tiles)| tiles.get(&aligned(voxel, 1 << log2)));
        tile.map_or((self.tree.background, false), |&tile| {
            (self.tree.tiles[tile].value, self.tree.tiles[tile].active)
        })
    }
}

impl GridValues {
    /// Components and activity of the voxels at these index coordinates.
    pub fn probe(&self, voxels: &[[i32; 3]]) -> Vec<(Vec<f64>, bool)> {
        match self {
            Self::Float(tree) => probe_all(tree, voxels),
            Self::Double(tree) => probe_all(tree, voxels),
            Self::Vec3(tree) => probe_all(tree, voxels),
            Self::Int32(tree) => probe_all(tree, voxels),
            Self::Int64(tree) => probe_all(tree, voxels),
            Self::Bool(tree) | Self::Mask(tree) => probe_all(tree, voxels),
        }
    }
}

fn probe_all<T: Components>(tree: &Tree<T>, voxels: &[[i32; 3]]) -> Vec<(Vec<f64>, bool)> {
    let lookup = Lookup::new(tree);
    let probe = |&voxel| {
        let (value, active) = lookup.probe(voxel);
        (components(value), active)
    };
    voxels.iter().map(probe).collect()
}

/// The least corner of the cube of this edge, a power of two, that holds the voxel.
fn aligned(voxel: [i32; 3], edge: i32) -> [i32; 3] {
    voxel.map(|coordinate| coordinate & !(edge - 1))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_voxel_is_found_in_its_leaf_its_tile_or_the_background() {
        let mut active = [0; 8];
        active[7] = 1 << 63;
        let tree = Tree {
            background: 1.0f32,
            tiles: vec![Tile { origin: [0, 0, -128], log2_edge: 7, value: 2.0, active: true }],
            leaves: vec![Leaf { origin: [-8, -8, -8], active }],
            leaf_values: (0..LEAF_VOXELS).map(|voxel| voxel as f32).collect(),
        };
        let lookup = Lookup::new(&tree);
        for (voxel, expected) in [
            ([-1, -1, -1], (511.0, true)),
            ([-8, -7, -6], (10.0, false)),
            ([0, 0, -1], (2.0, true)),
            ([127, 127, -128], (2.0, true)),
            ([128, 0, -1], (1.0, false)),
            ([i32::MIN, i32::MAX, 0], (1.0, false)),
        ] {
            assert_eq!(lookup.probe(voxel), expected, "{voxel:?}");
            assert_eq!(tree.probe(voxel), expected, "{voxel:?}");
        }
    }
}
