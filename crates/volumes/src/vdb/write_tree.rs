//! Writing a tree: the masks of all nodes first, then the values of the leaves, encoded on all cores.

use super::encode::{Codec, Encoding};
use super::leaves::LeafKind;
use super::nodes::{Lower, Root, Upper};
use super::sink::{Failure, Sink};
use super::value::Value;
use crate::{LEAF_VOXELS, Tile, Tree};
use rayon::prelude::*;
use std::collections::BTreeMap;

/// Leaves encoded in one go by one thread.
const BATCH: usize = 64;
/// Batches encoded before any is written: a bound of memory.
const BATCHES: usize = 256;
const NO_CHILDREN: [u64; 8] = [0; 8];

/// A tree and how it is to stand in a file.
pub(super) struct TreeWriter<'a, T> {
    pub(super) tree: &'a Tree<T>,
    encoding: Encoding<T>,
    kind: LeafKind,
}

impl<'a, T: Value> TreeWriter<'a, T> {
    /// Says in one line why the tree cannot be written so.
    pub(super) fn new(tree: &'a Tree<T>, codec: Codec, half: bool, kind: LeafKind) -> Result<Self, String> {
        if half {
            let tiles = tree.tiles.iter().map(|tile| &tile.value);
            let mut values = [&tree.background].into_iter().chain(tiles).chain(&tree.leaf_values);
            if values.any(|value| value.rounded_to_half().is_none()) {
                return Err("a value is beyond 65504, the largest half; write it as float".into());
            }
        }
        let mut writer = Self { tree, encoding: Encoding { codec, half, background: tree.background }, kind };
        writer.encoding.background = writer.stored(tree.background);
        Ok(writer)
    }

    /// The value as it will be read again.
    fn stored(&self, value: T) -> T {
        if self.encoding.half { value.rounded_to_half().unwrap_or(value) } else { value }
    }

    /// Background, root table, inner nodes and the masks of the leaves.
    pub(super) fn write_topology(&self, root: &Root, sink: &mut Sink) -> Result<(), Failure> {
        let mut out = Vec::new();
        self.encoding.background.put(&mut out);
        out.extend_from_slice(&(root.tiles.len() as u32).to_le_bytes());
        out.extend_from_slice(&(root.children.len() as u32).to_le_bytes());
        for (origin, &tile) in &root.tiles {
            let Tile { value, active, .. } = self.tree.tiles[tile];
            put_coordinates(*origin, &mut out);
            self.stored(value).put(&mut out);
            out.push(u8::from(active));
        }
        sink.put(&out)?;
        for (origin, upper) in &root.children {
            out.clear();
            put_coordinates(*origin, &mut out);
            let Upper { tiles, children } = upper;
            self.put_inner::<512>(tiles, children.keys(), &mut out);
            for Lower { tiles, leaves } in children.values() {
                self.put_inner::<64>(tiles, leaves.keys(), &mut out);
                for &leaf in leaves.values() {
                    out.extend_from_slice(self.tree.leaves[leaf].active.map(u64::to_le_bytes).as_flattened());
                }
            }
            sink.put(&out)?;
        }
        Ok(())
    }

    /// An inner node of `WORDS`·64 entries, without its children.
    fn put_inner<'b, const WORDS: usize>(
        &self,
        tiles: &BTreeMap<usize, usize>,
        children: impl Iterator<Item = &'b usize>,
        out: &mut Vec<u8>,
    ) {
        let (mut child_mask, mut active_mask) = ([0u64; WORDS], [0u64; WORDS]);
        let mut values = vec![self.encoding.background; WORDS * 64];
        for entry in children {
            child_mask[entry / 64] |= 1 << (entry % 64);
        }
        for (&entry, &tile) in tiles {
            let Tile { value, active, .. } = self.tree.tiles[tile];
            values[entry] = self.stored(value);
            active_mask[entry / 64] |= u64::from(active) << (entry % 64);
        }
        out.extend_from_slice(child_mask.map(u64::to_le_bytes).as_flattened());
        out.extend_from_slice(active_mask.map(u64::to_le_bytes).as_flattened());
        self.encoding.put(&values, &active_mask, &child_mask, out);
    }

    /// The values of the leaves, in this order.
    pub(super) fn write_leaves(&self, order: &[usize], sink: &mut Sink) -> Result<(), Failure> {
        for leaves in order.chunks(BATCH * BATCHES) {
            let encode = |leaves: &[usize]| {
                let mut out = Vec::new();
                leaves.iter().for_each(|&leaf| self.put_leaf(leaf, &mut out));
                out
            };
            let encoded: Vec<Vec<u8>> = leaves.par_chunks(BATCH).map(encode).collect();
            encoded.iter().try_for_each(|batch| sink.put(batch))?;
        }
        Ok(())
    }

    fn put_leaf(&self, index: usize, out: &mut Vec<u8>) {
        let leaf = &self.tree.leaves[index];
        let values = &self.tree.leaf_values[index * LEAF_VOXELS..][..LEAF_VOXELS];
        out.extend_from_slice(leaf.active.map(u64::to_le_bytes).as_flattened());
        match self.kind {
            LeafKind::Values if self.encoding.half => {
                let rounded: Vec<T> = values.iter().map(|&value| self.stored(value)).collect();
                self.encoding.put(&rounded, &leaf.active, &NO_CHILDREN, out);
            }
            LeafKind::Values => self.encoding.put(values, &leaf.active, &NO_CHILDREN, out),
            LeafKind::Bools => {
                put_coordinates(leaf.origin, out);
                for byte in values.chunks_exact(8) {
                    let bits = byte.iter().enumerate();
                    out.push(bits.fold(0, |bits, (bit, value)| bits | u8::from(!value.same(T::ZERO)) << bit));
                }
            }
            LeafKind::Mask => put_coordinates(leaf.origin, out),
        }
    }
}

fn put_coordinates(coordinates: [i32; 3], out: &mut Vec<u8>) {
    out.extend_from_slice(coordinates.map(i32::to_le_bytes).as_flattened());
}
