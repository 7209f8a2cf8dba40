//! Writing the values of a node: the counterpart of `values`, where the layout is told.
//!
//! Active-mask compression is always used: it loses nothing, since values are told apart by their bits, and the code
//! falls back to storing all values where inactive ones differ in more than two ways.

use super::value::Value;
use super::values::{ACTIVE_MASK, ALL_STORED, BLOSC, ZIP, count_ones, is_set};
use crate::blosc;
use flate2::Compression;
use flate2::write::ZlibEncoder;
use std::io::Write;

/// Compression of the values in a file.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Codec {
    /// None.
    None,
    /// Deflate: smallest, slow.
    Zip,
    /// LZ4 with shuffled bytes: OpenVDB's own choice.
    #[default]
    Blosc,
}

impl Codec {
    /// The flags that a grid carries.
    pub(super) fn flags(self) -> u32 {
        ACTIVE_MASK
            | match self {
                Self::None => 0,
                Self::Zip => ZIP,
                Self::Blosc => BLOSC,
            }
    }
}

/// How a tree is written.
#[derive(Debug, Clone, Copy)]
pub(super) struct Encoding<T> {
    pub(super) codec: Codec,
    /// Whether arrays of values are stored as halves; the values are rounded already.
    pub(super) half: bool,
    pub(super) background: T,
}

impl<T: Value> Encoding<T> {
    /// Appends the values of a node; entries that are `children` have none.
    pub(super) fn put(&self, values: &[T], active: &[u64], children: &[u64], out: &mut Vec<u8>) {
        let inactive = |&index: &usize| !is_set(active, index) && !is_set(children, index);
        let mut distinct: Vec<T> = Vec::with_capacity(3);
        for index in (0..values.len()).filter(inactive) {
            if !distinct.iter().any(|known| known.same(values[index])) {
                distinct.push(values[index]);
            }
            if distinct.len() > 2 {
                break;
            }
        }
        // The background, if it is one of two, is the one that the mask marks.
        if distinct.len() == 2 && distinct[0].same(self.background) {
            distinct.swap(0, 1);
        }
        let background = |value: T| value.same(self.background);
        let opposite = |value: T| value.same(self.background.negated());
        let code = match distinct[..] {
            [] => 0,
            [value] if background(value) => 0,
            [value] if opposite(value) => 1,
            [_] => 2,
            [value, other] if background(other) && opposite(value) => 3,
            [_, other] if background(other) => 4,
            [_, _] => 5,
            _ => ALL_STORED,
        };
        out.push(code);
        let stored_alone = match code {
            2 | 4 => 1,
            5 => 2,
            _ => 0,
        };
        distinct.iter().take(stored_alone).for_each(|value| value.put(out));
        if let (3..=5, [_, marked]) = (code, &distinct[..]) {
            for (word, values) in values.chunks(64).enumerate() {
                let marks = values.iter().enumerate().fold(0, |marks, (bit, value)| {
                    marks | u64::from(inactive(&(word * 64 + bit)) && value.same(*marked)) << bit
                });
                out.extend_from_slice(&marks.to_le_bytes());
            }
        }
        let mut bytes = Vec::with_capacity(count_ones(active) * T::BYTES);
        for (index, value) in values.iter().enumerate() {
            if code == ALL_STORED || is_set(active, index) {
                if self.half { value.put_half(&mut bytes) } else { value.put(&mut bytes) }
            }
        }
        self.put_chunk(&bytes, out);
    }

    fn put_chunk(&self, bytes: &[u8], out: &mut Vec<u8>) {
        // OpenVDB expects nothing at all, not even a length, for no halves.
        let nothing = bytes.is_empty() && self.half && T::HALF_BYTES < T::BYTES;
        let packed = match self.codec {
            _ if nothing => return,
            Codec::None => return out.extend_from_slice(bytes),
            Codec::Zip => zip(bytes),
            Codec::Blosc => Some(blosc::compress(bytes, size_of::<f32>())),
        };
        match packed.filter(|packed| packed.len() < bytes.len()) {
            Some(packed) => {
                out.extend_from_slice(&(packed.len() as i64).to_le_bytes());
                out.extend_from_slice(&packed);
            }
            None => {
                out.extend_from_slice(&(-(bytes.len() as i64)).to_le_bytes());
                out.extend_from_slice(bytes);
            }
        }
    }
}

fn zip(bytes: &[u8]) -> Option<Vec<u8>> {
    let mut encoder = ZlibEncoder::new(Vec::new(), Compression::default());
    encoder.write_all(bytes).ok()?;
    encoder.finish().ok()
}
