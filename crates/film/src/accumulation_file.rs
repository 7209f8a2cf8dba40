//! `.acc` files: the exact sums of a film, to be continued or merged later.
//!
//! All numbers little-endian:
//!
//! ```text
//! 8 bytes   "TYNDALL\x1a"
//! u32       version of the format, 3
//! u32       length of the header in bytes
//! header    JSON: size, layers, planes, ranges of samples, progress of an interrupted pass, metadata
//! blocks    for each plane, every 1000 pixels: u32 length, then LZ4 (block format)
//! u32       CRC-32 (of zlib) of all that stands before it
//! ```
//!
//! A plane holds one record a pixel: `pixels` 128 bytes (Σx of R, G, B as i128; Σx² of R, G, B as 192 bits; u64
//! hits), `largest` 4 (greatest luminance of a sample, f32), `rejected` 4 (u32 samples that the sums leave out), `depth` 16,
//! `albedo` 24, `emission`, `single` and `multiple` 48, `normal` 24, `object` 4 (u32), `catcher` 40 (Σ of both lights as
//! i128; u64 rays), `effort` 8 (u64), `rates` 2 (u16, samples a round in 1/4096; a picture without has one a round). Planes of zeros are left out. Files of versions 1 and 2, which lack `largest` and counted rejected
//! samples as black ones of unknown pixels, are refused: nothing in them tells how far their errors can be trusted. Before compression the bytes of a block are
//! transposed, all first bytes of its records, then all second ones: the high bytes of neighbouring sums are equal, most
//! of them zero, and compress well.

use std::io::{self, Read, Write};
use std::path::Path;

use serde::{Deserialize, Serialize};
use tyndall_machine::{files, memory};

use crate::error::{FileError, write_atomically};
use crate::film::{Film, OpenPass, pixel_count, tile_count};
use crate::fixed_point::MAX_SAMPLES;
use crate::metadata::ImageMetadata;
use crate::plane_codec::{decode_plane, encode_plane};
use crate::provenance::Provenance;
use crate::ranges::SampleRanges;
use crate::rates::{self, Rates};
use crate::sample::Layers;
use crate::sums::Sums;

const DAMAGED: &str = "is damaged or cut short; copy it again or render its samples anew";
const NOT_ONE: &str = "is no .acc file of tyndall";
const MAGIC: &[u8; 8] = b"TYNDALL\x1a";
const VERSION: u32 = 3;

/// A film and how its samples were made: what an `.acc` file holds.
#[derive(Debug, Clone, PartialEq)]
pub struct Accumulation {
    /// The sums.
    pub film: Film,
    /// Which picture they are of.
    pub metadata: ImageMetadata,
}

#[derive(Serialize, Deserialize)]
struct Header {
    width: u32,
    height: u32,
    layers: Layers,
    planes: Vec<Plane>,
    samples: SampleRanges,
    open: Option<OpenHeader>,
    metadata: ImageMetadata,
}

#[derive(Serialize, Deserialize)]
struct OpenHeader {
    start: u64,
    done: Vec<u64>,
}

#[derive(Serialize, Deserialize, Clone, Copy, PartialEq, Eq, Debug)]
#[serde(rename_all = "lowercase")]
enum Plane {
    Pixels,
    Largest,
    Rejected,
    Depth,
    Albedo,
    Emission,
    Single,
    Multiple,
    Normal,
    Object,
    Catcher,
    Effort,
    Rates,
}

impl Accumulation {
    /// Writes an `.acc` file.
    pub fn write(&self, path: &Path) -> Result<(), FileError> {
        write_atomically(path, |file| self.encode(file))
    }

    /// Reads an `.acc` file.
    pub fn read(path: &Path) -> Result<Self, FileError> {
        let bytes = files::read(path).map_err(|e| FileError::io(path, e))?;
        Self::decode(&bytes).map_err(|what| FileError::unusable(path, what))
    }

    /// The content of an `.acc` file.
    ///
    /// # Errors
    /// If there is no memory for it.
    pub fn to_bytes(&self) -> io::Result<Vec<u8>> {
        let mut bytes = Vec::new();
        self.encode(&mut bytes)?;
        Ok(bytes)
    }

    /// What the content of an `.acc` file holds; `name` stands for it in messages.
    ///
    /// # Errors
    /// If it is none, or damaged.
    pub fn from_bytes(bytes: &[u8], name: &Path) -> Result<Self, FileError> {
        Self::decode(bytes).map_err(|what| FileError::unusable(name, what))
    }

    /// Adds the samples of `other`. The paths only serve to name both in an error; nothing changes on error.
    pub fn merge(&mut self, path: &Path, other: &Self, other_path: &Path) -> Result<(), FileError> {
        self.provenance().join(path, &other.provenance(), other_path)?;
        self.film.merge(&other.film).map_err(|error| {
            FileError::unusable(other_path, format!("cannot be merged with {}: {error}", path.display()))
        })?;
        self.metadata.seconds += other.metadata.seconds;
        Ok(())
    }

    /// How the samples were made, and which they are.
    pub fn provenance(&self) -> Provenance {
        let ImageMetadata { scene_hash, version, options, seed, .. } = self.metadata.clone();
        let samples = self.film.complete().clone();
        Provenance { scene_hash, version, options, seed, samples, open: self.film.open_start() }
    }

    fn encode(&self, file: &mut impl Write) -> io::Result<()> {
        let film = &self.film;
        let sums = &film.sums;
        let planes = [
            (Plane::Pixels, true),
            (Plane::Largest, !sums.largest.is_empty()),
            (Plane::Rejected, !sums.rejected.is_empty()),
            (Plane::Depth, !sums.depth.is_empty()),
            (Plane::Albedo, !sums.albedo.is_empty()),
            (Plane::Emission, !sums.emission.is_empty()),
            (Plane::Single, !sums.single.is_empty()),
            (Plane::Multiple, !sums.multiple.is_empty()),
            (Plane::Normal, !sums.normal.is_empty()),
            (Plane::Object, !sums.object.is_empty()),
            (Plane::Catcher, !sums.catcher.is_empty()),
            (Plane::Effort, !sums.effort.is_empty()),
            (Plane::Rates, film.rates.is_some()),
        ];
        let header = Header {
            width: film.width,
            height: film.height,
            layers: film.layers,
            planes: planes.iter().filter(|(_, present)| *present).map(|(plane, _)| *plane).collect(),
            samples: film.complete.clone(),
            open: film.open.as_ref().map(|pass| OpenHeader { start: pass.start, done: pass.done.clone() }),
            metadata: self.metadata.clone(),
        };
        let json = serde_json::to_vec(&header)?;
        let length = u32::try_from(json.len()).map_err(io::Error::other)?;
        let mut file = ChecksumWriter { inner: file, crc: flate2::Crc::new() };
        file.write_all(MAGIC)?;
        file.write_all(&VERSION.to_le_bytes())?;
        file.write_all(&length.to_le_bytes())?;
        file.write_all(&json)?;
        for plane in header.planes {
            match plane {
                Plane::Pixels => encode_plane(&mut file, &sums.pixels)?,
                Plane::Largest => encode_plane(&mut file, &sums.largest)?,
                Plane::Rejected => encode_plane(&mut file, &sums.rejected)?,
                Plane::Depth => encode_plane(&mut file, &sums.depth)?,
                Plane::Albedo => encode_plane(&mut file, &sums.albedo)?,
                Plane::Emission => encode_plane(&mut file, &sums.emission)?,
                Plane::Single => encode_plane(&mut file, &sums.single)?,
                Plane::Multiple => encode_plane(&mut file, &sums.multiple)?,
                Plane::Normal => encode_plane(&mut file, &sums.normal)?,
                Plane::Object => encode_plane(&mut file, &sums.object)?,
                Plane::Catcher => encode_plane(&mut file, &sums.catcher)?,
                Plane::Effort => encode_plane(&mut file, &sums.effort)?,
                Plane::Rates => encode_plane(&mut file, film.rates.as_ref().map_or(&[], Rates::as_steps))?,
            }
        }
        let sum = file.crc.sum();
        file.inner.write_all(&sum.to_le_bytes())
    }

    fn decode(bytes: &[u8]) -> Result<Self, String> {
        if !bytes.starts_with(MAGIC) {
            return Err(NOT_ONE.into());
        }
        let (content, checksum) = bytes.split_last_chunk::<4>().ok_or(DAMAGED)?;
        let mut crc = flate2::Crc::new();
        crc.update(content);
        if crc.sum() != u32::from_le_bytes(*checksum) {
            return Err(DAMAGED.into());
        }
        let (version, rest) = content[MAGIC.len()..].split_first_chunk().ok_or(DAMAGED)?;
        check_version(u32::from_le_bytes(*version))?;
        let (length, rest) = rest.split_first_chunk().ok_or(DAMAGED)?;
        let (json, mut blocks) =
            rest.split_at_checked(u32::from_le_bytes(*length) as usize).ok_or(DAMAGED)?;
        let header: Header = serde_json::from_slice(json).map_err(|e| format!("has a bad header: {e}"))?;
        let film = header.film(&mut blocks)?;
        if !blocks.is_empty() {
            return Err(format!("has {} bytes too many after its sums", blocks.len()));
        }
        Ok(Self { film, metadata: header.metadata })
    }
}

fn check_version(version: u32) -> Result<(), String> {
    if version == VERSION {
        return Ok(());
    }
    Err(format!(
        "has version {version} of the .acc format, and this program reads version {VERSION}; use the program that wrote \
         it, or render its samples anew"
    ))
}

/// What an `.acc` file says of its making, once it is known to be undamaged. Takes no memory for the sums.
///
/// # Errors
/// If the file cannot be read, is damaged or is of another format.
pub(crate) fn read_provenance(path: &Path) -> Result<Provenance, FileError> {
    let refuse = |what: String| FileError::unusable(path, what);
    let io = |error| FileError::io(path, error);
    let file = files::open(path).map_err(io)?;
    let length = file.metadata().map_err(io)?.len();
    let mut file = ChecksumReader { inner: io::BufReader::new(file), crc: flate2::Crc::new() };
    let mut start = [0; 16];
    let begins = file.read_exact(&mut start).is_ok();
    if !begins || !start.starts_with(MAGIC) {
        return Err(refuse(NOT_ONE.into()));
    }
    let word = |at: usize| u32::from_le_bytes([0, 1, 2, 3].map(|i| start[at + i]));
    check_version(word(8)).map_err(refuse)?;
    let mut json = Vec::new();
    file.by_ref().take(u64::from(word(12))).read_to_end(&mut json).map_err(io)?;
    let rest = length.checked_sub(20 + json.len() as u64).ok_or_else(|| refuse(DAMAGED.into()))?;
    io::copy(&mut file.by_ref().take(rest), &mut io::sink()).map_err(io)?;
    let sum = file.crc.sum();
    let mut checksum = [0; 4];
    file.inner.read_exact(&mut checksum).map_err(|_| refuse(DAMAGED.into()))?;
    if sum != u32::from_le_bytes(checksum) {
        return Err(refuse(DAMAGED.into()));
    }
    let header: Header =
        serde_json::from_slice(&json).map_err(|error| refuse(format!("has a bad header: {error}")))?;
    let ImageMetadata { scene_hash, version, options, seed, .. } = header.metadata;
    let open = header.open.map(|pass| pass.start);
    Ok(Provenance { scene_hash, version, options, seed, samples: header.samples, open })
}

/// Reads bytes and keeps their checksum.
struct ChecksumReader<R> {
    inner: R,
    crc: flate2::Crc,
}

impl<R: Read> Read for ChecksumReader<R> {
    fn read(&mut self, bytes: &mut [u8]) -> io::Result<usize> {
        let length = self.inner.read(bytes)?;
        self.crc.update(&bytes[..length]);
        Ok(length)
    }
}

impl Header {
    /// The film, its sums read from `blocks`.
    fn film(&self, blocks: &mut &[u8]) -> Result<Film, String> {
        let count = pixel_count(self.width, self.height).map_err(|e| format!("has a bad header: {e}"))?;
        memory::ask(Sums::bytes(count, self.layers) as u64, || {
            format!("the sums of {}x{} pixels", self.width, self.height)
        })
        .map_err(|error| error.to_string())?;
        let (mut sums, mut steps) = (Sums::default(), Vec::new());
        for plane in &self.planes {
            match plane {
                Plane::Pixels => decode_plane(blocks, &mut sums.pixels, count),
                Plane::Largest => decode_plane(blocks, &mut sums.largest, count),
                Plane::Rejected => decode_plane(blocks, &mut sums.rejected, count),
                Plane::Depth => decode_plane(blocks, &mut sums.depth, count),
                Plane::Albedo => decode_plane(blocks, &mut sums.albedo, count),
                Plane::Emission => decode_plane(blocks, &mut sums.emission, count),
                Plane::Single => decode_plane(blocks, &mut sums.single, count),
                Plane::Multiple => decode_plane(blocks, &mut sums.multiple, count),
                Plane::Normal => decode_plane(blocks, &mut sums.normal, count),
                Plane::Object => decode_plane(blocks, &mut sums.object, count),
                Plane::Catcher => decode_plane(blocks, &mut sums.catcher, count),
                Plane::Effort => decode_plane(blocks, &mut sums.effort, count),
                Plane::Rates => decode_plane(blocks, &mut steps, count),
            }
            .map_err(|what| format!("has a bad plane {plane:?}: {what}"))?;
        }
        if sums.pixels.is_empty() {
            return Err("has a bad header: the plane of pixels is missing".into());
        }
        if !sums.largest.iter().all(|&luminance| (0.0..f32::INFINITY).contains(&luminance)) {
            return Err("has a bad plane Largest: it holds what is no luminance".into());
        }
        let rates = (!steps.is_empty()).then(|| Rates::from_steps(steps)).transpose();
        let rates = rates.map_err(|what| format!("has a bad plane Rates: {what}"))?;
        let open = self.open.as_ref().map(|open| self.open_pass(open)).transpose()?;
        if rates.is_some() {
            let most = |pass: &OpenPass| pass.start + pass.done.iter().copied().max().unwrap_or(0);
            let mut held = self.samples.clone();
            let held_all = open.as_ref().map_or(Ok(()), |pass| held.insert(pass.start..most(pass)));
            held_all.and_then(|()| rates::check(&held)).map_err(|e| format!("has a bad header: {e}"))?;
        }
        Ok(Film {
            width: self.width,
            height: self.height,
            layers: self.layers,
            sums,
            rates,
            complete: self.samples.clone(),
            open,
        })
    }

    fn open_pass(&self, open: &OpenHeader) -> Result<OpenPass, String> {
        if open.done.len() != tile_count(self.width, self.height) {
            return Err("has a bad header: its progress has the wrong number of tiles".into());
        }
        let most = open.done.iter().copied().max().unwrap_or(0);
        let end = open.start.checked_add(most).filter(|_| most <= MAX_SAMPLES);
        let end = end.ok_or("has a bad header: its progress is impossible")?;
        let range = self.samples.clone().insert(open.start..end);
        range.map_err(|e| format!("has a bad header: {e}"))?;
        Ok(OpenPass { start: open.start, done: open.done.clone() })
    }
}

/// Passes bytes on and keeps their checksum.
struct ChecksumWriter<'a, W> {
    inner: &'a mut W,
    crc: flate2::Crc,
}

impl<W: Write> Write for ChecksumWriter<'_, W> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let written = self.inner.write(bytes)?;
        self.crc.update(&bytes[..written]);
        Ok(written)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.inner.flush()
    }
}

#[cfg(test)]
mod tests;
