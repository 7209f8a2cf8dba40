//! How the 512 values of each brick are kept: u8, f16 or f32.

use super::bounds::Bounds;
use super::bytes::U8Bricks;
use crate::LEAF_VOXELS;

/// The type that voxels are stored as.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Storage {
    /// One byte a voxel at most, with an offset and a step in each brick.
    U8,
    /// Half precision, scaled by a power of two.
    F16,
    /// As read.
    F32,
}

impl Storage {
    /// Memory of a brick at most; those of halves may turn out to be of f32, where values are beyond what halves reach.
    pub(super) fn brick_bytes(self) -> usize {
        match self {
            Self::U8 => U8Bricks::MOST_BRICK_BYTES,
            Self::F16 => 2 * LEAF_VOXELS,
            Self::F32 => 4 * LEAF_VOXELS,
        }
    }
}

/// Bricks of one storage; kernels are compiled for each.
pub trait BrickValues: Sync {
    /// Value of voxel `offset` (x << 6 | y << 3 | z) of brick `brick`.
    fn value(&self, brick: u32, offset: u32) -> f32;
}

/// The bricks of a grid, in one of the storages.
#[derive(Debug, Clone)]
pub enum Bricks {
    /// One byte a voxel at most.
    U8(U8Bricks),
    /// Half precision.
    F16(F16Bricks),
    /// Single precision.
    F32(F32Bricks),
}

/// Bricks of IEEE halves; value = half·scale with `scale` a power of two.
#[derive(Debug, Clone)]
pub struct F16Bricks {
    halves: Vec<u16>,
    /// scale · 2^112: the second factor moves an f16's exponent, shifted into place, to f32's bias.
    factor: f32,
}

/// Bricks of f32.
#[derive(Debug, Clone)]
pub struct F32Bricks {
    values: Vec<f32>,
}

impl BrickValues for F16Bricks {
    #[inline(always)]
    fn value(&self, brick: u32, offset: u32) -> f32 {
        half_times(self.halves[brick as usize * LEAF_VOXELS + offset as usize], self.factor)
    }
}

impl BrickValues for F32Bricks {
    #[inline(always)]
    fn value(&self, brick: u32, offset: u32) -> f32 {
        self.values[brick as usize * LEAF_VOXELS + offset as usize]
    }
}

/// A finite half times factor/2^112, without needing the F16C instructions.
#[inline(always)]
fn half_times(half: u16, factor: f32) -> f32 {
    let half = u32::from(half);
    f32::from_bits((half & 0x8000) << 16 | (half & 0x7fff) << 13) * factor
}

impl Bricks {
    /// Empty storage for `count` bricks whose values all lie within `bounds`; values of 2^30 and above are past
    /// what scaled halves reach and are kept as f32.
    pub(super) fn new(storage: Storage, count: usize, bounds: Bounds) -> Bricks {
        match storage {
            Storage::U8 => Bricks::U8(U8Bricks::with_capacity(count)),
            Storage::F16 if largest_magnitude(bounds) < HALF_LIMIT => Bricks::F16(F16Bricks {
                halves: Vec::with_capacity(count * LEAF_VOXELS),
                factor: half_factor(bounds),
            }),
            Storage::F16 | Storage::F32 => {
                Bricks::F32(F32Bricks { values: Vec::with_capacity(count * LEAF_VOXELS) })
            }
        }
    }

    /// Appends a brick of 512 finite values.
    pub(super) fn push(&mut self, values: &[f32; LEAF_VOXELS]) {
        match self {
            Bricks::U8(bricks) => bricks.push(values),
            Bricks::F16(bricks) => {
                let inverse_scale = libm::ldexp(1.0, 112) / f64::from(bricks.factor);
                let halves =
                    values.iter().map(|&v| half::f16::from_f64(f64::from(v) * inverse_scale).to_bits());
                bricks.halves.extend(halves);
            }
            Bricks::F32(bricks) => bricks.values.extend(values),
        }
    }

    /// Gives back what was set aside for bricks that have not come, and for blocks of them that are left out.
    pub(super) fn shrink_to_fit(&mut self) {
        match self {
            Bricks::U8(bricks) => bricks.shrink_to_fit(),
            Bricks::F16(bricks) => bricks.halves.shrink_to_fit(),
            Bricks::F32(bricks) => bricks.values.shrink_to_fit(),
        }
    }

    /// Value of voxel `offset` of brick `brick`.
    pub fn value(&self, brick: u32, offset: u32) -> f32 {
        match self {
            Bricks::U8(bricks) => bricks.value(brick, offset),
            Bricks::F16(bricks) => bricks.value(brick, offset),
            Bricks::F32(bricks) => bricks.value(brick, offset),
        }
    }

    /// Number of bricks.
    pub fn count(&self) -> usize {
        match self {
            Bricks::U8(bricks) => bricks.count(),
            Bricks::F16(bricks) => bricks.halves.len() / LEAF_VOXELS,
            Bricks::F32(bricks) => bricks.values.len() / LEAF_VOXELS,
        }
    }

    pub(super) fn memory_bytes(&self) -> usize {
        match self {
            Bricks::U8(bricks) => bricks.memory_bytes(),
            Bricks::F16(bricks) => size_of_val(&bricks.halves[..]),
            Bricks::F32(bricks) => size_of_val(&bricks.values[..]),
        }
    }
}

/// Values from here on do not fit [`F16Bricks`]: the factor would pass f32's range.
const HALF_LIMIT: f32 = (1_u32 << 30) as f32;

fn largest_magnitude(bounds: Bounds) -> f32 {
    bounds.min.abs().max(bounds.max.abs())
}

/// The factor of [`F16Bricks`] for values within `bounds`: no scaling where the range fits well, otherwise the
/// power of two that brings the largest magnitude into [2^14, 2^15).
fn half_factor(bounds: Bounds) -> f32 {
    let largest = largest_magnitude(bounds);
    let exponent = if largest > 0.0 && largest.is_finite() { libm::log2f(largest).floor() as i32 } else { 0 };
    // Between 2^-3 and 2^15 halves resolve the range to 2^-21 of its largest value without help.
    let scale = if (-3..15).contains(&exponent) { 0 } else { exponent - 14 };
    libm::ldexpf(1.0, 112 + scale)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn stored(storage: Storage, values: &[f32; LEAF_VOXELS]) -> Vec<f32> {
        let bounds = values.iter().fold(Bounds::EMPTY, |b, &v| b.union(Bounds::of(v)));
        let mut bricks = Bricks::new(storage, 1, bounds);
        bricks.push(values);
        assert_eq!(bricks.count(), 1);
        (0..LEAF_VOXELS as u32).map(|i| bricks.value(0, i)).collect()
    }

    #[test]
    fn each_storage_keeps_values_within_its_stated_error() {
        for range in [1e-12_f32, 1e-3, 1.0, 100.0, 1e9, 1e30] {
            let values: [f32; LEAF_VOXELS] = std::array::from_fn(|i| range * ((i as f32 * 0.77).sin() + 0.2));
            assert_eq!(stored(Storage::F32, &values), values);
            for (a, b) in stored(Storage::F16, &values).iter().zip(&values) {
                assert!((a - b).abs() <= b.abs() / 2048.0 + range * 1e-7, "{a} {b}");
            }
            for (a, b) in stored(Storage::U8, &values).iter().zip(&values) {
                assert!((a - b).abs() <= 2.0 * range * (1.0 / 510.0 + 1e-6), "{a} {b}");
            }
        }
    }

    #[test]
    fn halves_of_ordinary_range_are_kept_exactly() {
        let values: [f32; LEAF_VOXELS] =
            std::array::from_fn(|i| half::f16::from_f32(i as f32 / 512.0).to_f32());
        assert_eq!(stored(Storage::F16, &values), values);
        assert_eq!(stored(Storage::U8, &[0.25; LEAF_VOXELS]), [0.25; LEAF_VOXELS]);
    }
}
