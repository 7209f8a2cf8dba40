//! The values of any grid as 32-bit floats, for formats that know nothing else.

use std::borrow::Cow;

use crate::{GridValues, LEAF_VOXELS, Leaf, Tile, Tree};

/// A tree of floats, scalar or vector: borrowed where the grid has them, else converted.
///
/// Doubles and integers are rounded to the nearest float; true is 1.
pub(crate) enum FloatTree<'a> {
    /// One number a voxel.
    Scalar(Cow<'a, Tree<f32>>),
    /// Three numbers a voxel.
    Vector(&'a Tree<[f32; 3]>),
}

impl<'a> FloatTree<'a> {
    /// The values of a grid.
    pub(crate) fn of(values: &'a GridValues) -> Self {
        Self::Scalar(match values {
            GridValues::Vec3(tree) => return Self::Vector(tree),
            GridValues::Float(tree) => Cow::Borrowed(tree),
            GridValues::Double(tree) => Cow::Owned(converted(tree, |value| value as f32)),
            GridValues::Int32(tree) => Cow::Owned(converted(tree, |value| value as f32)),
            GridValues::Int64(tree) => Cow::Owned(converted(tree, |value| value as f32)),
            GridValues::Bool(tree) | GridValues::Mask(tree) => {
                Cow::Owned(converted(tree, |value| if value { 1.0 } else { 0.0 }))
            }
        })
    }
}

/// What [`FloatTree::of`] takes, in bytes, if it has to convert.
pub(crate) fn converted_bytes(values: &GridValues) -> u64 {
    let leaves = match values {
        GridValues::Float(_) | GridValues::Vec3(_) => 0,
        GridValues::Double(tree) => tree.leaves.len(),
        GridValues::Int32(tree) => tree.leaves.len(),
        GridValues::Int64(tree) => tree.leaves.len(),
        GridValues::Bool(tree) | GridValues::Mask(tree) => tree.leaves.len(),
    };
    (leaves as u64).saturating_mul((LEAF_VOXELS * size_of::<f32>() + size_of::<Leaf>()) as u64)
}

fn converted<T: Copy>(tree: &Tree<T>, to_float: impl Fn(T) -> f32) -> Tree<f32> {
    let tile = |tile: &Tile<T>| Tile {
        origin: tile.origin,
        log2_edge: tile.log2_edge,
        value: to_float(tile.value),
        active: tile.active,
    };
    Tree {
        background: to_float(tree.background),
        tiles: tree.tiles.iter().map(tile).collect(),
        leaves: tree.leaves.clone(),
        leaf_values: tree.leaf_values.iter().map(|&value| to_float(value)).collect(),
    }
}

/// Numbers that a voxel of a dense file holds.
pub(crate) trait Voxel: Copy + PartialEq {
    /// How many floats.
    const CHANNELS: usize;
    /// Appends them, little-endian.
    fn put(self, out: &mut Vec<u8>);
}

impl Voxel for f32 {
    const CHANNELS: usize = 1;
    fn put(self, out: &mut Vec<u8>) {
        out.extend_from_slice(&self.to_le_bytes());
    }
}

impl Voxel for [f32; 3] {
    const CHANNELS: usize = 3;
    fn put(self, out: &mut Vec<u8>) {
        self.into_iter().for_each(|value| value.put(out));
    }
}

/// Least and greatest index coordinates of the active voxels of a leaf, if it has any.
pub(crate) fn active_bounds(leaf: &Leaf) -> Option<[[i32; 3]; 2]> {
    let words = || (0..8).filter(|&x| leaf.active[x] != 0);
    let (x_min, x_max) = (words().next()?, words().next_back()?);
    let any = leaf.active.iter().fold(0, |any, word| any | word);
    let bytes = any.to_le_bytes();
    let rows = || (0..8).filter(|&y| bytes[y] != 0);
    let (y_min, y_max) = (rows().next()?, rows().next_back()?);
    let row = bytes.iter().fold(0, |any, byte| any | byte);
    let (z_min, z_max) = (row.trailing_zeros(), 7 - row.leading_zeros());
    let [x, y, z] = leaf.origin;
    Some([
        [x + x_min as i32, y + y_min as i32, z + z_min as i32],
        [x + x_max as i32, y + y_max as i32, z + z_max as i32],
    ])
}
