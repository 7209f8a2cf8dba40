//! Numbers out of byte buffers, with every offset checked.

use crate::fault::Fault;

/// `len` bytes at `offset`, or the fault that names `what` lies outside.
pub(crate) fn bytes_at<'a>(
    buffer: &'a [u8],
    offset: usize,
    len: usize,
    what: &str,
) -> Result<&'a [u8], Fault> {
    offset
        .checked_add(len)
        .and_then(|end| buffer.get(offset..end))
        .ok_or_else(|| Fault::Damaged(format!("truncated or corrupt: {what} lies outside the data")))
}

macro_rules! number {
    ($(#[$doc:meta])* $name:ident, $type:ty) => {
        $(#[$doc])*
        ///
        /// Missing bytes count as zero: callers slice the record they read from with [`bytes_at`] first.
        pub(crate) fn $name(buffer: &[u8], offset: usize) -> $type {
            let mut bytes = [0; size_of::<$type>()];
            if let Some(tail) = buffer.get(offset..) {
                let there = tail.len().min(bytes.len());
                bytes[..there].copy_from_slice(&tail[..there]);
            }
            <$type>::from_le_bytes(bytes)
        }
    };
}

number!(
    /// The unsigned 16-bit number at `offset`.
    u16_at,
    u16
);
number!(
    /// The unsigned 32-bit number at `offset`.
    u32_at,
    u32
);
number!(
    /// The unsigned 64-bit number at `offset`.
    u64_at,
    u64
);
number!(
    /// The signed 16-bit number at `offset`.
    i16_at,
    i16
);
number!(
    /// The signed 32-bit number at `offset`.
    i32_at,
    i32
);
number!(
    /// The signed 64-bit number at `offset`.
    i64_at,
    i64
);
number!(
    /// The 32-bit float at `offset`.
    f32_at,
    f32
);
number!(
    /// The 64-bit float at `offset`.
    f64_at,
    f64
);
