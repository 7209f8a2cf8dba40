//! Bricks of bytes, the storage for grids that hardly fit into memory.
//!
//! A brick is 4³ blocks of 2³ voxels. Blocks that hold nothing but the brick's least value, such as the empty corners of
//! a brick at the edge of a cloud, are left out: a mask says which are kept, and how many bits are set below a block's
//! own says how many come before it. That is exact, whatever the values are.

use super::storage::BrickValues;
use crate::LEAF_VOXELS;

/// Voxels of a block.
const BLOCK_VOXELS: usize = 8;

/// Bricks of bytes: value = least + step·code, and the code is 0 in the blocks that are left out.
#[derive(Debug, Clone)]
pub struct U8Bricks {
    bricks: Vec<U8Brick>,
    /// Codes of the blocks that are kept, brick after brick.
    codes: Vec<u8>,
}

#[derive(Debug, Clone, Copy)]
struct U8Brick {
    least: f32,
    step: f32,
    /// Bit `b` is set if block `b` is kept.
    kept: u64,
    /// Place of its first code.
    first: usize,
}

impl BrickValues for U8Bricks {
    #[inline(always)]
    fn value(&self, brick: u32, offset: u32) -> f32 {
        let U8Brick { least, step, kept, first } = self.bricks[brick as usize];
        let (block, voxel) = block_and_voxel(offset);
        let code = if kept >> block & 1 == 1 {
            let before = (kept & ((1 << block) - 1)).count_ones() as usize;
            self.codes[first + before * BLOCK_VOXELS + voxel as usize]
        } else {
            0
        };
        least + step * f32::from(code)
    }
}

/// The block that voxel `offset` (x << 6 | y << 3 | z) of a brick lies in, of 64, and which of its 8 voxels it is.
#[inline(always)]
fn block_and_voxel(offset: u32) -> (u32, u32) {
    let [x, y, z] = [offset >> 6, offset >> 3 & 7, offset & 7];
    let pack = |x: u32, y: u32, z: u32, bits: u32| (x << bits | y) << bits | z;
    (pack(x >> 1, y >> 1, z >> 1, 2), pack(x & 1, y & 1, z & 1, 1))
}

impl U8Bricks {
    /// Bytes of a brick of which no block is left out.
    pub(super) const MOST_BRICK_BYTES: usize = LEAF_VOXELS + size_of::<U8Brick>();

    pub(super) fn with_capacity(count: usize) -> U8Bricks {
        U8Bricks { bricks: Vec::with_capacity(count), codes: Vec::with_capacity(count * LEAF_VOXELS) }
    }

    pub(super) fn count(&self) -> usize {
        self.bricks.len()
    }

    pub(super) fn memory_bytes(&self) -> usize {
        self.codes.len() + size_of_val(&self.bricks[..])
    }

    /// Appends a brick of 512 finite values.
    pub(super) fn push(&mut self, values: &[f32; LEAF_VOXELS]) {
        let least = values.iter().copied().fold(f32::INFINITY, f32::min);
        let greatest = values.iter().copied().fold(f32::NEG_INFINITY, f32::max);
        // Divided first: the difference of two finite values may overflow.
        let step = (greatest / 255.0) - (least / 255.0);
        let code = |v: f32| if step > 0.0 { ((v - least) / step).round().clamp(0.0, 255.0) as u8 } else { 0 };
        let mut blocks = [[0; BLOCK_VOXELS]; LEAF_VOXELS / BLOCK_VOXELS];
        for (offset, &value) in values.iter().enumerate() {
            let (block, voxel) = block_and_voxel(offset as u32);
            blocks[block as usize][voxel as usize] = code(value);
        }
        let mut brick = U8Brick { least, step, kept: 0, first: self.codes.len() };
        for (number, block) in blocks.iter().enumerate().filter(|(_, block)| **block != [0; BLOCK_VOXELS]) {
            brick.kept |= 1 << number;
            self.codes.extend(block);
        }
        self.bricks.push(brick);
    }

    pub(super) fn shrink_to_fit(&mut self) {
        self.bricks.shrink_to_fit();
        self.codes.shrink_to_fit();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn blocks_of_the_least_value_take_no_memory_and_are_still_there() {
        let one_voxel_of_each = |every: usize| -> [f32; LEAF_VOXELS] {
            std::array::from_fn(|i| if i % every == 0 { 1.0 + i as f32 / 512.0 } else { 0.5 })
        };
        // Of the second, voxels (x, 0, 0) are set: 4 of the 64 blocks.
        for (values, blocks) in
            [(one_voxel_of_each(1), 64), (one_voxel_of_each(64), 4), ([0.5; LEAF_VOXELS], 0)]
        {
            let mut bricks = U8Bricks::with_capacity(2);
            bricks.push(&one_voxel_of_each(64));
            bricks.push(&values);
            bricks.shrink_to_fit();
            assert_eq!(bricks.memory_bytes(), (4 + blocks) * BLOCK_VOXELS + 2 * size_of::<U8Brick>());
            for (offset, value) in values.iter().enumerate() {
                assert!((bricks.value(1, offset as u32) - value).abs() <= 1.5 / 510.0);
            }
        }
    }
}
