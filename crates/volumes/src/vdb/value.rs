//! The types a voxel can have, and how one stands in a file.
//!
//! Little endian; a bool is a byte; a grid saved as half has binary16 instead of each float, except for its
//! background, root tiles and inactive values, which stay whole.

use half::f16;
use half::slice::{HalfBitsSliceExt, HalfFloatSliceExt};

/// How the values of one grid stand in its file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Width {
    /// Every value whole.
    Full,
    /// Arrays of values as halves, single values whole (the type of the tree ends with `_HalfFloat`).
    HalfArrays,
    /// Everything as halves (`Tree_half_5_4_3`, file version 225).
    Half,
}

/// A type of voxels.
pub(super) trait Value: Copy + PartialEq + Send + Sync + 'static {
    /// Bytes of a value.
    const BYTES: usize;
    /// Bytes of a value saved as half; the same as [`Self::BYTES`] for what is not floating point.
    const HALF_BYTES: usize;
    /// What is there before values are read.
    const ZERO: Self;

    /// One whole value from exactly [`Self::BYTES`] bytes.
    fn from_bytes(bytes: &[u8]) -> Self;
    /// As many values as fit both, from halves.
    fn from_halves(bytes: &[u8], values: &mut [Self]);
    /// The value of the other side: -v, or not v.
    fn negated(self) -> Self;
    /// Appends the value, whole.
    fn put(self, out: &mut Vec<u8>);
    /// Appends the value as half.
    fn put_half(self, out: &mut Vec<u8>);
    /// The value that a half can hold, or nothing where a finite number would become infinite.
    fn rounded_to_half(self) -> Option<Self>;

    /// As many values as fit both, whole.
    fn from_all_bytes(bytes: &[u8], values: &mut [Self]) {
        for (value, bytes) in values.iter_mut().zip(bytes.chunks_exact(Self::BYTES)) {
            *value = Self::from_bytes(bytes);
        }
    }

    /// Whether both have the same bits, so that -0 is told from 0 and NaN is itself.
    fn same(self, other: Self) -> bool;
}

/// Bytes of one value in an array of values.
pub(super) fn bytes_in_arrays<T: Value>(width: Width) -> usize {
    match width {
        Width::Full => T::BYTES,
        Width::HalfArrays | Width::Half => T::HALF_BYTES,
    }
}

/// Bytes of a value that stands alone.
pub(super) fn bytes_alone<T: Value>(width: Width) -> usize {
    match width {
        Width::Full | Width::HalfArrays => T::BYTES,
        Width::Half => T::HALF_BYTES,
    }
}

/// A value that stands alone, from exactly [`bytes_alone`] bytes.
pub(super) fn alone<T: Value>(width: Width, bytes: &[u8]) -> T {
    match width {
        Width::Full | Width::HalfArrays => T::from_bytes(bytes),
        Width::Half => {
            let mut value = [T::ZERO];
            T::from_halves(bytes, &mut value);
            value[0]
        }
    }
}

fn array<const N: usize>(bytes: &[u8]) -> [u8; N] {
    let mut array = [0; N];
    array.copy_from_slice(bytes);
    array
}

/// Converts in pieces that fit the registers' cache, with the hardware's instructions where there are any.
fn halves_to_floats(bytes: &[u8], floats: &mut [f32]) {
    for (bytes, floats) in bytes.chunks(256).zip(floats.chunks_mut(128)) {
        let mut bits = [0u16; 128];
        for (bits, bytes) in bits.iter_mut().zip(bytes.as_chunks().0) {
            *bits = u16::from_le_bytes(*bytes);
        }
        bits[..floats.len()].reinterpret_cast::<f16>().convert_to_f32_slice(floats);
    }
}

fn float_to_half(value: f32) -> Option<f32> {
    let half = f16::from_f32(value).to_f32();
    (half.is_infinite() == value.is_infinite()).then_some(half)
}

impl Value for f32 {
    const BYTES: usize = 4;
    const HALF_BYTES: usize = 2;
    const ZERO: Self = 0.0;

    fn from_bytes(bytes: &[u8]) -> Self {
        Self::from_le_bytes(array(bytes))
    }

    fn from_halves(bytes: &[u8], values: &mut [Self]) {
        halves_to_floats(bytes, values);
    }

    fn negated(self) -> Self {
        -self
    }

    fn put(self, out: &mut Vec<u8>) {
        out.extend_from_slice(&self.to_le_bytes());
    }

    fn put_half(self, out: &mut Vec<u8>) {
        out.extend_from_slice(&f16::from_f32(self).to_le_bytes());
    }

    fn rounded_to_half(self) -> Option<Self> {
        float_to_half(self)
    }

    fn same(self, other: Self) -> bool {
        self.to_bits() == other.to_bits()
    }
}

impl Value for f64 {
    const BYTES: usize = 8;
    const HALF_BYTES: usize = 2;
    const ZERO: Self = 0.0;

    fn from_bytes(bytes: &[u8]) -> Self {
        Self::from_le_bytes(array(bytes))
    }

    fn from_halves(bytes: &[u8], values: &mut [Self]) {
        for (value, bits) in values.iter_mut().zip(bytes.as_chunks().0) {
            *value = f16::from_le_bytes(*bits).to_f64();
        }
    }

    fn negated(self) -> Self {
        -self
    }

    fn put(self, out: &mut Vec<u8>) {
        out.extend_from_slice(&self.to_le_bytes());
    }

    fn put_half(self, out: &mut Vec<u8>) {
        // By way of f32, as OpenVDB rounds.
        (self as f32).put_half(out);
    }

    fn rounded_to_half(self) -> Option<Self> {
        let single = self as f32;
        float_to_half(single).filter(|_| single.is_infinite() == self.is_infinite()).map(Self::from)
    }

    fn same(self, other: Self) -> bool {
        self.to_bits() == other.to_bits()
    }
}

impl Value for [f32; 3] {
    const BYTES: usize = 12;
    const HALF_BYTES: usize = 6;
    const ZERO: Self = [0.0; 3];

    fn from_bytes(bytes: &[u8]) -> Self {
        let mut vector = Self::ZERO;
        f32::from_all_bytes(bytes, &mut vector);
        vector
    }

    fn from_halves(bytes: &[u8], values: &mut [Self]) {
        halves_to_floats(bytes, values.as_flattened_mut());
    }

    fn negated(self) -> Self {
        self.map(|component| -component)
    }

    fn put(self, out: &mut Vec<u8>) {
        self.into_iter().for_each(|component| component.put(out));
    }

    fn put_half(self, out: &mut Vec<u8>) {
        self.into_iter().for_each(|component| component.put_half(out));
    }

    fn rounded_to_half(self) -> Option<Self> {
        let [x, y, z] = self.map(float_to_half);
        Some([x?, y?, z?])
    }

    fn same(self, other: Self) -> bool {
        self.map(f32::to_bits) == other.map(f32::to_bits)
    }
}

macro_rules! integer {
    ($integer:ty) => {
        impl Value for $integer {
            const BYTES: usize = size_of::<$integer>();
            const HALF_BYTES: usize = Self::BYTES;
            const ZERO: Self = 0;

            fn from_bytes(bytes: &[u8]) -> Self {
                Self::from_le_bytes(array(bytes))
            }

            fn from_halves(bytes: &[u8], values: &mut [Self]) {
                Self::from_all_bytes(bytes, values);
            }

            fn negated(self) -> Self {
                self.wrapping_neg()
            }

            fn put(self, out: &mut Vec<u8>) {
                out.extend_from_slice(&self.to_le_bytes());
            }

            fn put_half(self, out: &mut Vec<u8>) {
                self.put(out);
            }

            fn rounded_to_half(self) -> Option<Self> {
                Some(self)
            }

            fn same(self, other: Self) -> bool {
                self == other
            }
        }
    };
}
integer!(i32);
integer!(i64);

impl Value for bool {
    const BYTES: usize = 1;
    const HALF_BYTES: usize = 1;
    const ZERO: Self = false;

    fn from_bytes(bytes: &[u8]) -> Self {
        bytes[0] != 0
    }

    fn from_halves(bytes: &[u8], values: &mut [Self]) {
        Self::from_all_bytes(bytes, values);
    }

    fn negated(self) -> Self {
        !self
    }

    fn put(self, out: &mut Vec<u8>) {
        out.push(u8::from(self));
    }

    fn put_half(self, out: &mut Vec<u8>) {
        self.put(out);
    }

    fn rounded_to_half(self) -> Option<Self> {
        Some(self)
    }

    fn same(self, other: Self) -> bool {
        self == other
    }
}
