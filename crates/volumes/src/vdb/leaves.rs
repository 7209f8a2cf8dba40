//! The values of the leaves, which stand behind the whole topology, in its order.
//!
//! ```text
//! leaf:            active mask again · values as in `values`
//! leaf of bools:   active mask again · i32 ×3 origin · mask of the values
//! leaf of a mask:  active mask again · i32 ×3 origin
//! ```
//!
//! First they are all found, which is quick and proves that they are there; only then is memory taken for them,
//! and they are decoded on all cores. Source: OpenVDB, `tree/LeafNode`, `LeafNodeBool`, `LeafNodeMask`.

use super::cursor::{Cursor, Problem};
use super::topology::Topology;
use super::value::Value;
use super::values::{Decoder, Stored};
use crate::{LEAF_VOXELS, Leaf};
use rayon::prelude::*;
use tyndall_machine::memory;

const MASK_BYTES: usize = LEAF_VOXELS / 8;
const ORIGIN_BYTES: usize = 12;
/// Leaves decoded in one go by one thread.
const BATCH: usize = 64;

/// What stands in a file for a leaf.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum LeafKind {
    /// Values of any type but these:
    Values,
    /// Booleans, always as a mask.
    Bools,
    /// Nothing: the value is whether a voxel is active.
    Mask,
}

/// Moves past the values of all leaves; the offsets where they begin.
pub(super) fn find<T: Value>(
    cursor: &mut Cursor,
    topology: &Topology<T>,
    kind: LeafKind,
) -> Result<Vec<usize>, Problem> {
    let mut offsets = Vec::with_capacity(topology.leaves.len());
    for leaf in &topology.leaves {
        cursor.take(MASK_BYTES, "the mask of a leaf")?;
        offsets.push(cursor.position());
        match kind {
            LeafKind::Values => {
                Stored::find(cursor, &topology.coding, &leaf.active)?;
            }
            LeafKind::Bools => {
                cursor.take(ORIGIN_BYTES + MASK_BYTES, "a leaf")?;
            }
            LeafKind::Mask => {
                cursor.take(ORIGIN_BYTES, "a leaf")?;
            }
        }
    }
    Ok(offsets)
}

/// The values of all leaves from the `file` in which they were found.
pub(super) fn decode<T: Value>(
    file: &[u8],
    topology: &Topology<T>,
    kind: LeafKind,
    offsets: &[usize],
) -> Result<Vec<T>, Problem> {
    let count = offsets.len() * LEAF_VOXELS;
    memory::ask_for(count, size_of::<T>(), || {
        format!("{} leaves of 512 voxels of {} bytes", offsets.len(), size_of::<T>())
    })?;
    let mut values = vec![T::ZERO; count];
    let problem = values
        .par_chunks_mut(BATCH * LEAF_VOXELS)
        .zip(topology.leaves.par_chunks(BATCH).zip(offsets.par_chunks(BATCH)))
        .map(|(values, (leaves, offsets))| {
            let mut decoder = Decoder::new();
            let batch = values.chunks_exact_mut(LEAF_VOXELS).zip(leaves).zip(offsets);
            for ((values, leaf), &offset) in batch {
                decode_leaf(Cursor::new(file, offset), topology, kind, leaf, &mut decoder, values)
                    .map_err(|problem| problem.at(&format!("leaf at {:?}", leaf.origin)))?;
            }
            Ok(())
        })
        .find_map_first(Result::err);
    match problem {
        Some(problem) => Err(problem),
        None => Ok(values),
    }
}

fn decode_leaf<T: Value>(
    mut cursor: Cursor,
    topology: &Topology<T>,
    kind: LeafKind,
    leaf: &Leaf,
    decoder: &mut Decoder<T>,
    values: &mut [T],
) -> Result<(), Problem> {
    let mut bits = leaf.active;
    match kind {
        LeafKind::Values => {
            let stored = Stored::find(&mut cursor, &topology.coding, &leaf.active)?;
            return stored.decode(topology.coding.width, &leaf.active, decoder, values);
        }
        LeafKind::Bools => {
            cursor.take(ORIGIN_BYTES, "a leaf")?;
            let words = cursor.take(MASK_BYTES, "a leaf")?.as_chunks().0;
            for (bits, word) in bits.iter_mut().zip(words) {
                *bits = u64::from_le_bytes(*word);
            }
        }
        LeafKind::Mask => {}
    }
    let bytes: [u8; LEAF_VOXELS] = std::array::from_fn(|voxel| (bits[voxel / 64] >> (voxel % 64) & 1) as u8);
    T::from_all_bytes(&bytes, values);
    Ok(())
}
