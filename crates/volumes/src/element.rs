//! The types of numbers a dense array is stored in.

use half::f16;

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

    /// The numbers in little-endian `bytes`, as many as `numbers` has room for.
    pub(crate) fn decode(self, bytes: &[u8], numbers: &mut [f64]) {
        fn each<const SIZE: usize>(bytes: &[u8], numbers: &mut [f64], decode: impl Fn([u8; SIZE]) -> f64) {
            let (chunks, _) = bytes.as_chunks::<SIZE>();
            numbers.iter_mut().zip(chunks).for_each(|(number, chunk)| *number = decode(*chunk));
        }
        match self {
            Self::Float16 => each(bytes, numbers, |bytes| f16::from_le_bytes(bytes).into()),
            Self::Float32 => each(bytes, numbers, |bytes| f32::from_le_bytes(bytes).into()),
            Self::Float64 => each(bytes, numbers, f64::from_le_bytes),
            Self::UInt8 => each(bytes, numbers, |bytes| u8::from_le_bytes(bytes).into()),
            Self::UInt16 => each(bytes, numbers, |bytes| u16::from_le_bytes(bytes).into()),
            Self::UInt32 => each(bytes, numbers, |bytes| u32::from_le_bytes(bytes).into()),
            Self::Int8 => each(bytes, numbers, |bytes| i8::from_le_bytes(bytes).into()),
            Self::Int16 => each(bytes, numbers, |bytes| i16::from_le_bytes(bytes).into()),
            Self::Int32 => each(bytes, numbers, |bytes| i32::from_le_bytes(bytes).into()),
            Self::Bool => each(bytes, numbers, |bytes: [u8; 1]| f64::from(bytes[0] != 0)),
        }
    }
}
