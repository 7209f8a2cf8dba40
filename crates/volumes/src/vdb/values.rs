//! The values of a node, leaf or not: what is stored, how it is compressed, how what is not stored follows.
//!
//! ```text
//! i8 inactive code · inactive values, as the code says · mask that chooses between them, as the code says
//! i64 length and so many compressed bytes; or -n and n plain bytes; or, without a codec, plain bytes
//! ```
//!
//! With active-mask compression only active values are stored, and the code tells the inactive ones:
//!
//! | code | inactive values |
//! |---|---|
//! | 0 | the background |
//! | 1 | -background |
//! | 2 | one value, stored |
//! | 3 | -background, or the background where the mask is set |
//! | 4 | one value, stored, or the background where the mask is set |
//! | 5 | one value, stored, or another, stored, where the mask is set |
//! | 6 | all values are stored |
//!
//! Without it the code is 6 and all are stored. Source: OpenVDB, `io/Compression`.

use super::cursor::{Cursor, Problem, damaged};
use super::value::{self, Value, Width};
use crate::blosc;
use flate2::{Decompress, FlushDecompress, Status};

/// Flags of a grid's compression.
pub(super) const ZIP: u32 = 1;
pub(super) const ACTIVE_MASK: u32 = 2;
pub(super) const BLOSC: u32 = 4;

pub(super) const ALL_STORED: u8 = 6;

/// How a grid's values stand in its file.
#[derive(Debug, Clone, Copy)]
pub(super) struct Coding<T> {
    /// Compression flags.
    pub(super) flags: u32,
    pub(super) width: Width,
    pub(super) background: T,
}

/// The values of a node, found but not yet decoded.
#[derive(Debug)]
pub(super) struct Stored<'a, T> {
    inactive: [T; 2],
    /// Set where an inactive value is the second one.
    choice: Option<&'a [u8]>,
    /// How many values are stored.
    count: usize,
    bytes: Chunk<'a>,
}

#[derive(Debug)]
enum Chunk<'a> {
    Plain(&'a [u8]),
    Zip(&'a [u8]),
    Blosc(&'a [u8]),
}

impl<'a, T: Value> Stored<'a, T> {
    /// Finds the values of a node with these `active` bits and moves past them. Everything that is claimed is
    /// there when this succeeds.
    pub(super) fn find(cursor: &mut Cursor<'a>, coding: &Coding<T>, active: &[u64]) -> Result<Self, Problem> {
        let code = cursor.u8("the code of inactive values")?;
        if code > ALL_STORED {
            return Err(damaged(format!(
                "{code} at byte {} is no code of inactive values",
                cursor.position() - 1
            )));
        }
        let background = coding.background;
        let mut inactive = [if code == 0 { background } else { background.negated() }, background];
        let stored_inactive = match code {
            2 | 4 => 1,
            5 => 2,
            _ => 0,
        };
        for value in &mut inactive[..stored_inactive] {
            let bytes = cursor.take(value::bytes_alone::<T>(coding.width), "an inactive value")?;
            *value = value::alone(coding.width, bytes);
        }
        let choice = match code {
            3..=5 => Some(cursor.take(active.len() * 8, "the mask of inactive values")?),
            _ => None,
        };
        let only_active = coding.flags & ACTIVE_MASK != 0 && code != ALL_STORED;
        let count = if only_active { count_ones(active) } else { active.len() * 64 };
        let bytes = find_chunk(cursor, coding, count * value::bytes_in_arrays::<T>(coding.width))?;
        Ok(Self { inactive, choice, count, bytes })
    }

    /// Decodes into `values`, one for each bit of `active`.
    pub(super) fn decode(
        &self,
        width: Width,
        active: &[u64],
        decoder: &mut Decoder<T>,
        values: &mut [T],
    ) -> Result<(), Problem> {
        let len = self.count * value::bytes_in_arrays::<T>(width);
        let Decoder { inflate, bytes, scratch, packed } = decoder;
        let bytes = match self.bytes {
            Chunk::Plain(plain) => plain,
            Chunk::Zip(zipped) => {
                unzip(inflate, zipped, len, bytes)?;
                bytes
            }
            Chunk::Blosc(chunk) => {
                blosc::decompress_into(chunk, len, bytes, scratch).map_err(Problem::Damaged)?;
                bytes
            }
        };
        let convert = match width {
            Width::Full => T::from_all_bytes,
            Width::HalfArrays | Width::Half => T::from_halves,
        };
        if self.count == values.len() {
            convert(bytes, values);
            return Ok(());
        }
        packed.resize(self.count, T::ZERO);
        convert(bytes, packed);
        self.spread(active, packed, values);
        Ok(())
    }

    /// Puts the packed active values where they belong and the inactive ones between them.
    fn spread(&self, active: &[u64], mut packed: &[T], values: &mut [T]) {
        for (word, (&active, values)) in active.iter().zip(values.chunks_mut(64)).enumerate() {
            let (here, later) = packed.split_at(active.count_ones() as usize);
            packed = later;
            if active == u64::MAX {
                values.copy_from_slice(here);
                continue;
            }
            match self.choice.and_then(|choice| choice[word * 8..].first_chunk()) {
                None => values.fill(self.inactive[0]),
                Some(choice) => {
                    let choice = u64::from_le_bytes(*choice);
                    for (bit, value) in values.iter_mut().enumerate() {
                        *value = self.inactive[(choice >> bit & 1) as usize];
                    }
                }
            }
            let mut left = active;
            for &value in here {
                values[left.trailing_zeros() as usize] = value;
                left &= left - 1;
            }
        }
    }
}

/// Memory for decoding, used again for each node.
pub(super) struct Decoder<T> {
    inflate: Decompress,
    bytes: Vec<u8>,
    scratch: Vec<u8>,
    packed: Vec<T>,
}

impl<T> Decoder<T> {
    pub(super) fn new() -> Self {
        Self { inflate: Decompress::new(true), bytes: Vec::new(), scratch: Vec::new(), packed: Vec::new() }
    }
}

/// Number of set bits.
pub(super) fn count_ones(mask: &[u64]) -> usize {
    mask.iter().map(|word| word.count_ones() as usize).sum()
}

/// Whether bit `index` of a mask is set.
pub(super) fn is_set(mask: &[u64], index: usize) -> bool {
    mask[index / 64] >> (index % 64) & 1 != 0
}

fn find_chunk<'a, T: Value>(
    cursor: &mut Cursor<'a>,
    coding: &Coding<T>,
    len: usize,
) -> Result<Chunk<'a>, Problem> {
    // OpenVDB writes nothing at all, not even a length, for no halves.
    let nothing = len == 0 && coding.width == Width::HalfArrays && T::HALF_BYTES < T::BYTES;
    if nothing || coding.flags & (ZIP | BLOSC) == 0 {
        return Ok(Chunk::Plain(cursor.take(len, "values")?));
    }
    let at = cursor.position();
    let claimed = cursor.i64("the length of compressed values")?;
    match usize::try_from(claimed) {
        Ok(claimed) if claimed > 0 => {
            let bytes = cursor.take(claimed, "compressed values")?;
            Ok(if coding.flags & BLOSC != 0 { Chunk::Blosc(bytes) } else { Chunk::Zip(bytes) })
        }
        _ if claimed.unsigned_abs() == len as u64 => Ok(Chunk::Plain(cursor.take(len, "values")?)),
        _ => Err(damaged(format!("the chunk at byte {at} has {claimed} bytes instead of {len}"))),
    }
}

fn unzip(inflate: &mut Decompress, zipped: &[u8], len: usize, bytes: &mut Vec<u8>) -> Result<(), Problem> {
    inflate.reset(true);
    bytes.resize(len, 0);
    match inflate.decompress(zipped, bytes, FlushDecompress::Finish) {
        Ok(Status::StreamEnd) if inflate.total_out() == len as u64 => Ok(()),
        Ok(Status::StreamEnd) => {
            Err(damaged(format!("zipped values are {} bytes instead of {len}", inflate.total_out())))
        }
        Ok(_) => Err(damaged("zipped values do not end where they should")),
        Err(error) => Err(damaged(format!("zipped values cannot be inflated ({error})"))),
    }
}
