//! Planes of sums as compressed blocks of bytes; the layout is described in `accumulation_file`.

use std::io::{self, Write};

use rayon::prelude::{
    IndexedParallelIterator, IntoParallelRefIterator, ParallelIterator, ParallelSlice, ParallelSliceMut,
};

use crate::fixed_point::SquareSum;
use crate::sums::{CatcherSums, PixelSums};

/// Records in a block.
const BLOCK: usize = 1000;

/// A fixed number of bytes a pixel.
pub trait Record: Sized {
    /// How many.
    const BYTES: usize;
    /// Appends the bytes.
    fn put(&self, bytes: &mut Vec<u8>);
    /// Reads them back; `bytes` has the right length.
    fn get(bytes: &[u8]) -> Self;
}

/// Blocks that are coded at once, by all threads; memory is taken for so many.
const AT_ONCE: usize = 256;

/// Writes the blocks of a plane.
pub fn encode_plane<T: Record + Sync>(file: &mut impl Write, plane: &[T]) -> io::Result<()> {
    for blocks in plane.chunks(AT_ONCE * BLOCK) {
        let compressed: Vec<Vec<u8>> = blocks.par_chunks(BLOCK).map(encode_block).collect();
        for block in compressed {
            let length = u32::try_from(block.len()).map_err(io::Error::other)?;
            file.write_all(&length.to_le_bytes())?;
            file.write_all(&block)?;
        }
    }
    Ok(())
}

fn encode_block<T: Record>(block: &[T]) -> Vec<u8> {
    let mut records = Vec::with_capacity(block.len() * T::BYTES);
    block.iter().for_each(|record| record.put(&mut records));
    lz4_flex::block::compress(&transposed(&records, T::BYTES))
}

/// Reads the blocks of a plane of `count` records from the front of `blocks`. Memory grows only as blocks turn out
/// to be there.
pub fn decode_plane<T: Record + Default + Clone + Send>(
    blocks: &mut &[u8],
    plane: &mut Vec<T>,
    count: usize,
) -> Result<(), String> {
    if !plane.is_empty() {
        return Err("it occurs twice".into());
    }
    while plane.len() < count {
        let done = plane.len();
        let records = (AT_ONCE * BLOCK).min(count - done);
        let mut compressed = Vec::with_capacity(AT_ONCE);
        for _ in 0..records.div_ceil(BLOCK) {
            let (length, rest) = blocks.split_first_chunk().ok_or("a block is missing")?;
            let (block, rest) =
                rest.split_at_checked(u32::from_le_bytes(*length) as usize).ok_or("a block is cut short")?;
            *blocks = rest;
            compressed.push(block);
        }
        plane.resize(done + records, T::default());
        let parts = plane[done..].par_chunks_mut(BLOCK);
        compressed.par_iter().zip(parts).try_for_each(|(block, part)| decode_block(block, part))?;
    }
    Ok(())
}

fn decode_block<T: Record>(compressed: &[u8], records: &mut [T]) -> Result<(), String> {
    let length = records.len() * T::BYTES;
    let bytes = lz4_flex::block::decompress(compressed, length).map_err(|e| e.to_string())?;
    if bytes.len() != length {
        return Err("a block has the wrong length".into());
    }
    let bytes = transposed(&bytes, records.len());
    records.iter_mut().zip(bytes.chunks_exact(T::BYTES)).for_each(|(record, bytes)| *record = T::get(bytes));
    Ok(())
}

/// A matrix of bytes with rows of `columns` becomes one with its columns as rows.
fn transposed(bytes: &[u8], columns: usize) -> Vec<u8> {
    let mut turned = Vec::with_capacity(bytes.len());
    for column in 0..columns {
        turned.extend(bytes[column..].iter().step_by(columns));
    }
    turned
}

fn word<const N: usize>(bytes: &[u8], index: usize) -> [u8; N] {
    std::array::from_fn(|i| bytes[index * N + i])
}

impl Record for u16 {
    const BYTES: usize = 2;

    fn put(&self, bytes: &mut Vec<u8>) {
        bytes.extend(self.to_le_bytes());
    }

    fn get(bytes: &[u8]) -> Self {
        u16::from_le_bytes(word(bytes, 0))
    }
}

impl Record for u32 {
    const BYTES: usize = 4;

    fn put(&self, bytes: &mut Vec<u8>) {
        bytes.extend(self.to_le_bytes());
    }

    fn get(bytes: &[u8]) -> Self {
        u32::from_le_bytes(word(bytes, 0))
    }
}

impl Record for u64 {
    const BYTES: usize = 8;

    fn put(&self, bytes: &mut Vec<u8>) {
        bytes.extend(self.to_le_bytes());
    }

    fn get(bytes: &[u8]) -> Self {
        u64::from_le_bytes(word(bytes, 0))
    }
}

impl Record for f32 {
    const BYTES: usize = 4;

    fn put(&self, bytes: &mut Vec<u8>) {
        bytes.extend(self.to_le_bytes());
    }

    fn get(bytes: &[u8]) -> Self {
        f32::from_le_bytes(word(bytes, 0))
    }
}

impl Record for i128 {
    const BYTES: usize = 16;

    fn put(&self, bytes: &mut Vec<u8>) {
        bytes.extend(self.to_le_bytes());
    }

    fn get(bytes: &[u8]) -> Self {
        i128::from_le_bytes(word(bytes, 0))
    }
}

impl Record for [u64; 3] {
    const BYTES: usize = 24;

    fn put(&self, bytes: &mut Vec<u8>) {
        self.iter().for_each(|x| bytes.extend(x.to_le_bytes()));
    }

    fn get(bytes: &[u8]) -> Self {
        [0, 1, 2].map(|i| u64::from_le_bytes(word(bytes, i)))
    }
}

impl Record for [i128; 3] {
    const BYTES: usize = 48;

    fn put(&self, bytes: &mut Vec<u8>) {
        self.iter().for_each(|x| x.put(bytes));
    }

    fn get(bytes: &[u8]) -> Self {
        [0, 1, 2].map(|i| i128::from_le_bytes(word(bytes, i)))
    }
}

impl Record for CatcherSums {
    const BYTES: usize = 40;

    fn put(&self, bytes: &mut Vec<u8>) {
        self.light.iter().for_each(|light| light.put(bytes));
        bytes.extend(self.rays.to_le_bytes());
    }

    fn get(bytes: &[u8]) -> Self {
        Self {
            light: [0, 16].map(|at| Record::get(&bytes[at..at + 16])),
            rays: u64::from_le_bytes(word(&bytes[32..], 0)),
        }
    }
}

impl Record for PixelSums {
    const BYTES: usize = 128;

    fn put(&self, bytes: &mut Vec<u8>) {
        self.radiance.put(bytes);
        self.squares.iter().for_each(|square| square.0.put(bytes));
        bytes.extend(self.hits.to_le_bytes());
    }

    fn get(bytes: &[u8]) -> Self {
        Self {
            radiance: Record::get(&bytes[..48]),
            squares: [48, 72, 96].map(|at| SquareSum(Record::get(&bytes[at..at + 24]))),
            hits: u64::from_le_bytes(word(&bytes[120..], 0)),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn records_take_the_bytes_they_say_and_come_back() {
        let pixel = PixelSums {
            radiance: [i128::MIN, 7, -1],
            squares: [SquareSum([1, 2, 3]), SquareSum([4, u64::MAX, 6]), SquareSum([7, 8, 9])],
            hits: 1 << 40,
        };
        let mut bytes = Vec::new();
        pixel.put(&mut bytes);
        assert_eq!(bytes.len(), PixelSums::BYTES);
        assert_eq!(PixelSums::get(&bytes), pixel);
        let catcher = CatcherSums { light: [i128::MAX, -2], rays: u64::MAX };
        let mut bytes = Vec::new();
        catcher.put(&mut bytes);
        assert_eq!(bytes.len(), CatcherSums::BYTES);
        assert_eq!(CatcherSums::get(&bytes), catcher);
    }

    #[test]
    fn a_plane_of_several_blocks_comes_back() {
        let plane: Vec<i128> = (0..10_000).map(|i| i128::from(i) << (i % 100)).collect();
        let mut file = Vec::new();
        encode_plane(&mut file, &plane).unwrap();
        let mut read = Vec::new();
        let mut rest = file.as_slice();
        decode_plane(&mut rest, &mut read, plane.len()).unwrap();
        assert_eq!((read, rest.len()), (plane, 0));
    }
}
