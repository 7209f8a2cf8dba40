//! The types of numbers a dense array is stored in.

use half::f16;

use crate::little_endian::{f32_at, f64_at, i16_at, i32_at, u16_at, u32_at};

/// Type of the numbers of a dense array.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Element {
    /// 16-bit floats (IEEE 754 binary16).
    Float16,
    /// 32-bit floats.
    Float32,
    /// 64-bit floats.
    Float64,
    /// Unsigned bytes; the number 255 stays 255.
    UInt8,
    /// Unsigned 16-bit integers.
    UInt16,
    /// Unsigned 32-bit integers.
    UInt32,
    /// Signed bytes.
    Int8,
    /// Signed 16-bit integers.
    Int16,
    /// Signed 32-bit integers.
    Int32,
    /// Bytes, of which 0 is 0 and every other is 1.
    Bool,
}

/// Which byte of a number comes first.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ByteOrder {
    /// The least significant one, as on nearly every machine of today.
    Little,
    /// The most significant one.
    Big,
}

/// Which index changes fastest from one number to the next.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum AxisOrder {
    /// x, then y, then z: usual for raw volumes, Mitsuba, NIfTI and Fortran.
    XFastest,
    /// z, then y, then x: an array `a[x][y][z]` in C and NumPy.
    ZFastest,
}

impl Element {
    /// Bytes of one number.
    pub fn size(self) -> usize {
        match self {
            Self::UInt8 | Self::Int8 | Self::Bool => 1,
            Self::Float16 | Self::UInt16 | Self::Int16 => 2,
            Self::Float32 | Self::UInt32 | Self::Int32 => 4,
            Self::Float64 => 8,
        }
    }

    /// Whether 32-bit floats hold every such number exactly.
    pub fn fits_f32(self) -> bool {
        !matches!(self, Self::Float64 | Self::UInt32 | Self::Int32)
    }

    /// The number in little-endian `bytes`.
    #[inline]
    pub(crate) fn decode(self, bytes: &[u8]) -> f64 {
        match self {
            Self::Float16 => f16::from_bits(u16_at(bytes, 0)).into(),
            Self::Float32 => f32_at(bytes, 0).into(),
            Self::Float64 => f64_at(bytes, 0),
            Self::UInt8 => bytes[0].into(),
            Self::UInt16 => u16_at(bytes, 0).into(),
            Self::UInt32 => u32_at(bytes, 0).into(),
            Self::Int8 => (bytes[0] as i8).into(),
            Self::Int16 => i16_at(bytes, 0).into(),
            Self::Int32 => i32_at(bytes, 0).into(),
            Self::Bool => f64::from(bytes[0] != 0),
        }
    }
}
