//! NanoVDB files (`.nvdb`): OpenVDB trees laid out in memory once, for reading by offset.
//!
//! A file is a row of segments, or (from version 32.6) a bare row of grid buffers. A segment:
//!
//! | part | bytes |
//! |---|---|
//! | magic `NanoVDB0` (to 32.6) or `NanoVDB2`, version, number of grids, codec | 8 + 4 + 2 + 2 |
//! | for each grid: sizes in memory and on disk, name hash, active voxels, type, class, boxes, … name length at 136 | 176 |
//! | … its name, with a zero byte | length |
//! | for each grid: its buffer, by codec | size on disk |
//!
//! Codecs: none; ZIP: `u64` size, zlib stream; BLOSC: for each GiB of the buffer `u64` size, Blosc chunk. A buffer
//! begins with `NanoVDB0` or `NanoVDB1`. Numbers are little-endian.
//!
//! Source: `NanoVDB.h` and `io/IO.h` of the OpenVDB project; Museth 2021, "NanoVDB: A GPU-Friendly and Portable VDB
//! Data Structure For Real-Time Rendering And Simulation".

mod build;
mod grid;
mod layout;
mod tree;
mod values;
mod write;

pub(crate) use write::write;

use std::fmt;
use std::io::{Read, Seek, SeekFrom};

use flate2::read::ZlibDecoder;
use tyndall_machine::memory;

use crate::GridSelection;
use crate::fault::Fault;
use crate::little_endian::{u16_at, u32_at, u64_at};
use crate::open::Found;

use grid::{own_name, read_grid, text_until_nul};
use layout::{GRID_HEAD, TREE_HEAD};

/// `NanoVDB0`: a file or a grid, of versions before 32.7.
pub(crate) const MAGIC_0: u64 = u64::from_le_bytes(*b"NanoVDB0");
/// `NanoVDB1`: a grid.
pub(crate) const MAGIC_1: u64 = u64::from_le_bytes(*b"NanoVDB1");
/// `NanoVDB2`: a file.
pub(crate) const MAGIC_2: u64 = u64::from_le_bytes(*b"NanoVDB2");

const SEGMENT_HEAD: usize = 16;
const GRID_RECORD: usize = 176;
/// The buffer is cut into pieces of this size for Blosc.
const BLOSC_PIECE: u64 = 1 << 30;
/// No deflate or LZ4 stream expands further than this factor.
const MOST_EXPANSION: u64 = 1040;

/// 11 bits major, 11 minor, 10 patch.
#[derive(Clone, Copy)]
struct Version(u32);

impl Version {
    fn major(self) -> u32 {
        self.0 >> 21
    }

    /// The major version is that of the memory layout; only 32 is known here.
    fn check(self) -> Result<(), Fault> {
        match self.major() {
            32 => Ok(()),
            _ => Err(Fault::Unsupported(format!(
                "NanoVDB version {self} is not read, only 32.x; write the file again with a current nanovdb_convert"
            ))),
        }
    }
}

impl fmt::Display for Version {
    fn fmt(&self, out: &mut fmt::Formatter) -> fmt::Result {
        write!(out, "{}.{}.{}", self.major(), self.0 >> 10 & 0x7ff, self.0 & 0x3ff)
    }
}

/// Reads the grids of `selection`; what is not asked for is skipped, unread.
pub(crate) fn read(
    source: &mut (impl Read + Seek),
    selection: &GridSelection,
    found: &mut Found,
) -> Result<(), Fault> {
    let length = source.seek(SeekFrom::End(0))?;
    let mut at = 0;
    while at < length {
        let head = read_at(source, at, (length - at).min(GRID_HEAD as u64))?;
        let magic = u64_at(&head, 0);
        let bare = magic == MAGIC_1 || magic == MAGIC_0 && u64_at(&head, GRID_HEAD - 8) == MAGIC_1;
        at = match magic {
            _ if bare => read_bare_grid(source, at, length, &head, selection, found)?,
            MAGIC_0 | MAGIC_2 => read_segment(source, at, length, &head, selection, found)?,
            _ if [MAGIC_0, MAGIC_1, MAGIC_2].contains(&magic.swap_bytes()) => {
                return Err(Fault::unsupported(
                    "a big-endian NanoVDB file; write it again on a little-endian machine",
                ));
            }
            _ => return Err(Fault::Damaged(format!("corrupt: no NanoVDB segment begins at byte {at}"))),
        };
    }
    Ok(())
}

/// Reads the segment at `at`; returns where the next begins.
fn read_segment(
    source: &mut (impl Read + Seek),
    mut at: u64,
    length: u64,
    head: &[u8],
    selection: &GridSelection,
    found: &mut Found,
) -> Result<u64, Fault> {
    if head.len() < SEGMENT_HEAD {
        return Err(Fault::damaged("truncated: the file ends inside the head of a segment"));
    }
    Version(u32_at(head, 8)).check()?;
    let (grids, codec) = (u16_at(head, 12), u16_at(head, 14));
    let codec = Codec::from_number(codec)?;
    at += SEGMENT_HEAD as u64;
    let mut records = Vec::new();
    for _ in 0..grids {
        let record = read_at(source, at, GRID_RECORD as u64)?;
        at += GRID_RECORD as u64;
        let name_length = u64::from(u32_at(&record, 136));
        if name_length > length - at {
            return Err(Fault::damaged("truncated or corrupt: the name of a grid lies outside the file"));
        }
        records.push((record, text_until_nul(&read_at(source, at, name_length)?)));
        at += name_length;
    }
    for (record, name) in records {
        let (size, on_disk) = (u64_at(&record, 0), u64_at(&record, 8));
        if on_disk > length - at {
            return Err(Fault::Damaged(format!("truncated: grid `{name}` lies outside the file")));
        }
        if found.wants(selection, &name) {
            source.seek(SeekFrom::Start(at))?;
            let grid = read_buffer(source, codec, size, on_disk)
                .and_then(|buffer| read_grid(&buffer, Some(&name), codec.name()));
            found.take(&name, grid)?;
        } else {
            found.pass(&name);
        }
        at += on_disk;
    }
    Ok(at)
}

/// Reads the grid buffer at `at`, which no segment introduces; returns where the next begins.
fn read_bare_grid(
    source: &mut (impl Read + Seek),
    at: u64,
    length: u64,
    head: &[u8],
    selection: &GridSelection,
    found: &mut Found,
) -> Result<u64, Fault> {
    let size = u64_at(head, 32);
    if size < (GRID_HEAD + TREE_HEAD) as u64 || size > length - at {
        return Err(Fault::damaged("truncated or corrupt: a grid's size does not fit the file"));
    }
    // The name can stand at the very end of the buffer, so the choice comes after the reading.
    let buffer = read_at(source, at, size)?;
    let name = own_name(&buffer, head)?;
    match found.wants(selection, &name) {
        true => found.take(&name, read_grid(&buffer, Some(&name), Codec::None.name()))?,
        false => found.pass(&name),
    }
    Ok(at + size)
}

/// How the buffers of a segment are compressed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Codec {
    None,
    Zip,
    Blosc,
}

impl Codec {
    fn from_number(number: u16) -> Result<Self, Fault> {
        match number {
            0 => Ok(Self::None),
            1 => Ok(Self::Zip),
            2 => Ok(Self::Blosc),
            _ => Err(Fault::Damaged(format!("corrupt: there is no NanoVDB codec {number}"))),
        }
    }

    fn name(self) -> &'static str {
        match self {
            Self::None => "none",
            Self::Zip => "zip",
            Self::Blosc => "blosc",
        }
    }
}

/// The `size` bytes of a grid, from the `on_disk` bytes that come next in `source`.
fn read_buffer(source: &mut impl Read, codec: Codec, size: u64, on_disk: u64) -> Result<Vec<u8>, Fault> {
    if size > on_disk.saturating_mul(MOST_EXPANSION) {
        return Err(Fault::Damaged(format!("corrupt: {on_disk} bytes cannot hold a grid of {size} bytes")));
    }
    memory::ask(size, || format!("the {size} bytes of a grid"))?;
    let mut stored = source.take(on_disk);
    let mut buffer = Vec::new();
    match codec {
        Codec::None => {
            buffer.reserve_exact(size.min(on_disk) as usize);
            stored.take(size).read_to_end(&mut buffer)?;
        }
        Codec::Zip => {
            stored.read_exact(&mut [0; 8])?;
            ZlibDecoder::new(stored).take(size).read_to_end(&mut buffer)?;
        }
        Codec::Blosc => {
            while (buffer.len() as u64) < size {
                let mut prefix = [0; 8];
                stored.read_exact(&mut prefix)?;
                let mut chunk = Vec::new();
                stored.by_ref().take(u64::from_le_bytes(prefix)).read_to_end(&mut chunk)?;
                let expected = BLOSC_PIECE.min(size - buffer.len() as u64);
                let piece = crate::blosc::decompress(&chunk, expected as usize)
                    .map_err(|what| Fault::Damaged(format!("corrupt Blosc chunk: {what}")))?;
                match buffer.is_empty() {
                    true => buffer = piece,
                    false => buffer.extend_from_slice(&piece),
                }
            }
        }
    }
    match buffer.len() as u64 == size {
        true => Ok(buffer),
        false => Err(Fault::damaged("truncated: a grid holds fewer bytes than its record says")),
    }
}

/// `len` bytes at `at`, which are known to be no more than the file has.
fn read_at(source: &mut (impl Read + Seek), at: u64, len: u64) -> Result<Vec<u8>, Fault> {
    source.seek(SeekFrom::Start(at))?;
    memory::ask(len, || format!("{len} bytes of the file"))?;
    let mut bytes = Vec::new();
    bytes.reserve_exact(len as usize);
    source.take(len).read_to_end(&mut bytes)?;
    match bytes.len() as u64 == len {
        true => Ok(bytes),
        false => Err(Fault::damaged("truncated: the file ends before its data do")),
    }
}
