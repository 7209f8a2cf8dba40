//! Blosc 1 containers with LZ4, the compression of OpenVDB and NanoVDB files.
//!
//! A container is a 16-byte header, a table of block starts, and blocks:
//!
//! ```text
//! u8 format (2) · u8 codec version · u8 flags · u8 typesize · u32 nbytes · u32 blocksize · u32 cbytes
//! i32 start of each block, from the container's first byte
//! block: one stream, or `typesize` streams of equal length; each an i32 length and LZ4 bytes (or the plain bytes
//!        where the length says that nothing was saved)
//! ```
//!
//! Flags: 0x01 bytes shuffled, 0x02 plain bytes follow the header, 0x04 bits shuffled, 0x10 blocks are not split
//! into streams, and the codec in the upper three bits (1 is LZ4). Shuffling stores byte 0 of every element, then
//! byte 1 of every element, and so on, block by block; a rest shorter than an element stays as it is.
//! Source: the description of the chunk format of C-Blosc (README_CHUNK_FORMAT), by F. Alted.

const HEADER: usize = 16;
const FORMAT: u8 = 2;
const LZ4_FORMAT: u8 = 1;
const BYTE_SHUFFLE: u8 = 0x01;
const PLAIN: u8 = 0x02;
const BIT_SHUFFLE: u8 = 0x04;
const ONE_STREAM: u8 = 0x10;
const CODEC_LZ4: u8 = 1;
/// Blocks are split only when every stream has at least so many elements.
const LEAST_STREAM: usize = 128;
/// Elements wider than this are never split.
const MOST_STREAMS: usize = 16;
/// Size of the blocks written: both copies of one stay in the L2 cache.
const BLOCK: usize = 1 << 18;
/// One byte of LZ4 stands for at most 255 bytes: a claim beyond that is refused before memory is taken.
const LZ4_MOST_RATIO: usize = 255;

/// Decompresses one container that must hold exactly `expected_len` bytes.
pub(crate) fn decompress(chunk: &[u8], expected_len: usize) -> Result<Vec<u8>, String> {
    let mut bytes = Vec::new();
    decompress_into(chunk, expected_len, &mut bytes, &mut Vec::new())?;
    Ok(bytes)
}

/// [`decompress`] into memory that is used again and again; `scratch` is for shuffled blocks.
pub(crate) fn decompress_into(
    chunk: &[u8],
    expected_len: usize,
    bytes: &mut Vec<u8>,
    scratch: &mut Vec<u8>,
) -> Result<(), String> {
    let header = Header::parse(chunk)?;
    if header.nbytes != expected_len {
        return Err(format!("a blosc chunk holds {} bytes instead of {expected_len}", header.nbytes));
    }
    let chunk = &chunk[..header.cbytes];
    bytes.clear();
    if header.flags & PLAIN != 0 {
        let plain = chunk.get(HEADER..).filter(|plain| plain.len() == expected_len);
        bytes.extend_from_slice(plain.ok_or("a stored blosc chunk has the wrong length")?);
        return Ok(());
    }
    if expected_len == 0 {
        return Ok(());
    }
    if header.flags & BIT_SHUFFLE != 0 {
        return Err(
            "a blosc chunk has its bits shuffled, which is not read; write it with byte shuffle".into()
        );
    }
    if header.flags >> 5 != CODEC_LZ4 {
        let name = ["BloscLZ", "LZ4", "Snappy", "zlib", "Zstandard"].get(usize::from(header.flags >> 5));
        return Err(format!(
            "a blosc chunk is compressed with {}, only LZ4 is read; write it with LZ4",
            name.unwrap_or(&"an unknown codec")
        ));
    }
    if expected_len / LZ4_MOST_RATIO > chunk.len() {
        return Err("a blosc chunk promises more bytes than LZ4 can hold".into());
    }
    bytes.resize(expected_len, 0);
    for (index, block) in bytes.chunks_mut(header.blocksize).enumerate() {
        let start = read_u32(chunk, HEADER + 4 * index)?;
        let leftover = block.len() < header.blocksize;
        let streams = stream_count(header.flags, header.typesize, header.blocksize, leftover);
        if header.flags & BYTE_SHUFFLE != 0 && header.typesize > 1 {
            scratch.resize(block.len(), 0);
            read_block(chunk, start, streams, scratch)?;
            unshuffle(scratch, header.typesize, block);
        } else {
            read_block(chunk, start, streams, block)?;
        }
    }
    Ok(())
}

/// Compresses with byte shuffle and LZ4. `typesize` is the width of an element in bytes (1 to 255); the result is
/// never more than 16 bytes longer than `bytes`, of which there are less than 2 GiB.
pub(crate) fn compress(bytes: &[u8], typesize: usize) -> Vec<u8> {
    let typesize = typesize.clamp(1, 255);
    let blocksize = match BLOCK / typesize * typesize {
        most if bytes.len() > most => most,
        _ => bytes.len(),
    };
    let mut flags = CODEC_LZ4 << 5;
    if typesize > 1 {
        flags |= BYTE_SHUFFLE;
    }
    if stream_count(0, typesize, blocksize, false) == 1 {
        flags |= ONE_STREAM;
    }
    let blocks = bytes.len().div_ceil(blocksize.max(1));
    let mut chunk = vec![0; HEADER + 4 * blocks];
    let mut shuffled = Vec::new();
    let mut packed = Vec::new();
    for (index, block) in bytes.chunks(blocksize.max(1)).enumerate() {
        let start = chunk.len() as u32;
        chunk[HEADER + 4 * index..][..4].copy_from_slice(&start.to_le_bytes());
        shuffle(block, typesize, &mut shuffled);
        let streams = stream_count(flags, typesize, blocksize, block.len() < blocksize);
        for stream in shuffled.chunks(block.len() / streams) {
            packed.resize(lz4_flex::block::get_maximum_output_size(stream.len()), 0);
            let saved =
                lz4_flex::block::compress_into(stream, &mut packed).ok().filter(|&len| len < stream.len());
            let body = saved.map_or(stream, |len| &packed[..len]);
            chunk.extend_from_slice(&(body.len() as u32).to_le_bytes());
            chunk.extend_from_slice(body);
        }
    }
    if chunk.len() >= HEADER + bytes.len() {
        flags = (flags & !ONE_STREAM) | PLAIN;
        chunk.truncate(HEADER);
        chunk.extend_from_slice(bytes);
    }
    let sizes = [bytes.len(), blocksize, chunk.len()].map(|size| (size as u32).to_le_bytes());
    chunk[..4].copy_from_slice(&[FORMAT, LZ4_FORMAT, flags, typesize as u8]);
    chunk[4..HEADER].copy_from_slice(sizes.as_flattened());
    chunk
}

struct Header {
    flags: u8,
    typesize: usize,
    nbytes: usize,
    blocksize: usize,
    cbytes: usize,
}

impl Header {
    fn parse(chunk: &[u8]) -> Result<Self, String> {
        let [format, _, flags, typesize, ..] = *chunk else {
            return Err("a blosc chunk is truncated".into());
        };
        let header = Self {
            flags,
            typesize: usize::from(typesize),
            nbytes: read_u32(chunk, 4)?,
            blocksize: read_u32(chunk, 8)?,
            cbytes: read_u32(chunk, 12)?,
        };
        if format != FORMAT {
            return Err(format!("a blosc chunk has format {format}, only format {FORMAT} is read"));
        }
        if header.cbytes < HEADER || header.cbytes > chunk.len() {
            return Err("a blosc chunk is truncated".into());
        }
        if header.typesize == 0 || (header.blocksize == 0 && header.nbytes > 0) {
            return Err("a blosc chunk has elements or blocks of no size".into());
        }
        Ok(header)
    }
}

fn stream_count(flags: u8, typesize: usize, blocksize: usize, leftover: bool) -> usize {
    let split = flags & ONE_STREAM == 0
        && !leftover
        && typesize <= MOST_STREAMS
        && blocksize / typesize >= LEAST_STREAM
        && blocksize.is_multiple_of(typesize);
    if split { typesize } else { 1 }
}

/// Reads the streams of one block, as they are stored, into `block`.
fn read_block(chunk: &[u8], start: usize, streams: usize, block: &mut [u8]) -> Result<(), String> {
    let mut at = start;
    for stream in block.chunks_mut(block.len() / streams) {
        let len = read_u32(chunk, at)?;
        let body =
            chunk.get(at + 4..).and_then(|rest| rest.get(..len)).ok_or("a blosc block is truncated")?;
        at += 4 + len;
        if len == stream.len() {
            stream.copy_from_slice(body);
        } else {
            let whole = lz4_flex::block::decompress_into(body, stream).is_ok_and(|read| read == stream.len());
            if !whole {
                return Err("a blosc block is damaged".into());
            }
        }
    }
    Ok(())
}

fn read_u32(chunk: &[u8], at: usize) -> Result<usize, String> {
    match chunk.get(at..).and_then(|rest| rest.first_chunk::<4>()) {
        Some(bytes) => Ok(u32::from_le_bytes(*bytes) as usize),
        None => Err("a blosc chunk is truncated".into()),
    }
}

fn shuffle(block: &[u8], typesize: usize, shuffled: &mut Vec<u8>) {
    let whole = block.len() / typesize * typesize;
    shuffled.clear();
    for byte in 0..typesize {
        shuffled.extend(block[..whole].iter().skip(byte).step_by(typesize));
    }
    shuffled.extend_from_slice(&block[whole..]);
}

fn unshuffle(shuffled: &[u8], typesize: usize, block: &mut [u8]) {
    let count = block.len() / typesize;
    let (planes, rest) = shuffled.split_at(count * typesize);
    let (elements, block_rest) = block.split_at_mut(count * typesize);
    block_rest.copy_from_slice(rest);
    if typesize == 4 {
        // The common width, written so that the compiler interleaves whole vectors.
        let (low, high) = planes.split_at(2 * count);
        let (first, second) = low.split_at(count);
        let (third, fourth) = high.split_at(count);
        let bytes = first.iter().zip(second).zip(third.iter().zip(fourth));
        for (element, ((&a, &b), (&c, &d))) in elements.as_chunks_mut::<4>().0.iter_mut().zip(bytes) {
            *element = [a, b, c, d];
        }
        return;
    }
    for (byte, plane) in planes.chunks(count.max(1)).enumerate() {
        for (element, &value) in elements.chunks_mut(typesize).zip(plane) {
            element[byte] = value;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn what_is_compressed_comes_back(
            seed in proptest::collection::vec(0u8..20, 0..700),
            repeats in 1usize..900,
            typesize in 1usize..9,
        ) {
            let bytes = seed.repeat(repeats);
            let chunk = compress(&bytes, typesize);
            prop_assert!(chunk.len() <= bytes.len() + HEADER);
            prop_assert_eq!(decompress(&chunk, bytes.len()).unwrap(), bytes);
        }

        #[test]
        fn a_damaged_chunk_is_an_error_or_has_the_expected_length(
            at in 0usize..400,
            value: u8,
            keep in 0usize..2000,
        ) {
            let bytes: Vec<u8> = (0..2000u32).map(|i| ((i * i) >> 7) as u8).collect();
            let mut chunk = compress(&bytes, 4);
            let at = at % chunk.len();
            chunk[at] = value;
            chunk.truncate(keep.max(at));
            if let Ok(read) = decompress(&chunk, bytes.len()) {
                prop_assert_eq!(read.len(), bytes.len());
            }
        }
    }

    #[test]
    fn a_chunk_that_promises_more_than_it_can_hold_is_refused() {
        let mut chunk = compress(&[7; 4096], 4);
        chunk[4..8].copy_from_slice(&u32::MAX.to_le_bytes());
        chunk[8..12].copy_from_slice(&u32::MAX.to_le_bytes());
        assert!(decompress(&chunk, u32::MAX as usize).unwrap_err().contains("promises"));
    }
}
