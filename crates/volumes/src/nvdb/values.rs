//! Decoding the values of a NanoVDB tree, plain and quantised.
//!
//! A quantised leaf holds a minimum `m`, a quantum `q` and 512 codes `c` of 4, 8 or 16 bits (`FpN`: 1 to 16, its
//! own width in every leaf); the value is `c q + m` in 32-bit floats. Codes are packed from the least bit up.

use crate::fault::Fault;
use crate::little_endian::{bytes_at, f32_at, f64_at, i16_at, i32_at, i64_at, u16_at, u32_at};
use crate::{GridValues, LEAF_VOXELS};

use super::layout::{CODES_AT, LEAF_MASK, LEAF_MASK_AT, Layout, ValueType};
use super::tree::{Decode, read_tree};

/// Reads the tree of the grid that fills `grid`.
///
/// Integers of 8 and 16 bits become `Int32`, unsigned ones of 32 bits `Int64`, `Vec3d` is rounded to 32 bits.
pub(super) fn read_values(grid: &[u8], value_type: ValueType) -> Result<GridValues, Fault> {
    let layout = Layout::of(value_type);
    Ok(match value_type {
        ValueType::Float => GridValues::Float(plain(grid, &layout, float)?),
        ValueType::Double => GridValues::Double(plain(grid, &layout, |bytes| f64_at(bytes, 0))?),
        ValueType::Int16 => GridValues::Int32(plain(grid, &layout, |bytes| i16_at(bytes, 0).into())?),
        ValueType::Int32 => GridValues::Int32(plain(grid, &layout, |bytes| i32_at(bytes, 0))?),
        ValueType::Int64 => GridValues::Int64(plain(grid, &layout, |bytes| i64_at(bytes, 0))?),
        ValueType::UInt8 => GridValues::Int32(plain(grid, &layout, |bytes| bytes[0].into())?),
        ValueType::UInt32 => GridValues::Int64(plain(grid, &layout, |bytes| u32_at(bytes, 0).into())?),
        ValueType::Vec3f => {
            GridValues::Vec3(plain(grid, &layout, |bytes| [0, 4, 8].map(|at| f32_at(bytes, at)))?)
        }
        ValueType::Vec3d => {
            GridValues::Vec3(plain(grid, &layout, |bytes| [0, 8, 16].map(|at| f64_at(bytes, at) as f32))?)
        }
        ValueType::Mask => GridValues::Mask(bits(grid, &layout, LEAF_MASK_AT)?),
        ValueType::Boolean => GridValues::Bool(bits(grid, &layout, LEAF_MASK_AT + LEAF_MASK)?),
        ValueType::Fp4 => GridValues::Float(quantised(grid, &layout, |_| Ok(4))?),
        ValueType::Fp8 => GridValues::Float(quantised(grid, &layout, |_| Ok(8))?),
        ValueType::Fp16 => GridValues::Float(quantised(grid, &layout, |_| Ok(16))?),
        ValueType::FpN => GridValues::Float(quantised(grid, &layout, own_width)?),
    })
}

fn float(bytes: &[u8]) -> f32 {
    f32_at(bytes, 0)
}

fn plain<T: Copy + PartialEq>(
    grid: &[u8],
    layout: &Layout,
    value: impl Fn(&[u8]) -> T,
) -> Result<crate::Tree<T>, Fault> {
    let leaf = |grid: &[u8], at: usize, out: &mut Vec<T>| {
        let values = bytes_at(grid, at + layout.leaf_values_at(), LEAF_VOXELS * layout.value(), "a leaf")?;
        out.extend(values.chunks_exact(layout.value()).map(&value));
        Ok(())
    };
    read_tree(grid, layout, Decode { value: &value, leaf })
}

/// Leaves whose 512 values are the bits at `bits_at`.
fn bits(grid: &[u8], layout: &Layout, bits_at: usize) -> Result<crate::Tree<bool>, Fault> {
    let leaf = |grid: &[u8], at: usize, out: &mut Vec<bool>| {
        let words = bytes_at(grid, at + bits_at, LEAF_MASK, "a leaf")?;
        out.extend(words.iter().flat_map(|byte| (0..8).map(move |bit| byte >> bit & 1 == 1)));
        Ok(())
    };
    read_tree(grid, layout, Decode { value: |bytes: &[u8]| bytes[0] != 0, leaf })
}

/// Leaves of codes, whose width in bits `width` takes from the leaf's flags.
fn quantised(
    grid: &[u8],
    layout: &Layout,
    width: impl Fn(u8) -> Result<usize, Fault>,
) -> Result<crate::Tree<f32>, Fault> {
    let leaf = |grid: &[u8], at: usize, out: &mut Vec<f32>| {
        let head = bytes_at(grid, at, CODES_AT, "a leaf")?;
        let (minimum, quantum) = (f32_at(head, 80), f32_at(head, 84));
        let width = width(head[15])?;
        let codes = bytes_at(grid, at + CODES_AT, LEAF_VOXELS * width / 8, "the codes of a leaf")?;
        let value = |code: u16| f32::from(code) * quantum + minimum;
        match width {
            16 => out.extend(codes.chunks_exact(2).map(|code| value(u16_at(code, 0)))),
            8 => out.extend(codes.iter().map(|&code| value(code.into()))),
            _ => {
                let mask = (1u16 << width) - 1;
                let in_byte =
                    move |byte: u8| (0..8 / width).map(move |n| u16::from(byte) >> (n * width) & mask);
                out.extend(codes.iter().flat_map(|&byte| in_byte(byte)).map(value));
            }
        }
        Ok(())
    };
    read_tree(grid, layout, Decode { value: float, leaf })
}

/// The width of an `FpN` leaf: the upper three bits of its flags are its base-2 logarithm.
fn own_width(flags: u8) -> Result<usize, Fault> {
    match flags >> 5 {
        log2 @ 0..=4 => Ok(1 << log2),
        log2 => Err(Fault::Damaged(format!("corrupt: a leaf claims codes of 2^{log2} bits"))),
    }
}
