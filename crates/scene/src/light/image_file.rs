//! Pictures of the surroundings from files: OpenEXR (channels R, G, B of any type) and Radiance HDR (RGBE).
//!
//! What a file is shows in its first bytes, not in its name.

use std::fs::File;
use std::io::{BufReader, Read, Seek};
use std::path::Path;

use exr::block::reader::ChunksReader;
use exr::prelude::{ReadChannels, ReadLayers};
use image::ImageDecoder;
use tyndall_machine::{contained, files, memory};

use super::image::LightImage;
use crate::error::SceneError;

/// What a texel takes while it is read: as the file has it, and as three f32.
const TEXEL_BYTES: u64 = 24;

/// Texels of the largest picture that is read, 12 bytes each in memory.
const GREATEST_TEXELS: u64 = 1 << 28;

/// Texels that a byte of a Radiance picture may stand for: a run of 127 values takes two bytes in each of four channels.
const HDR_TEXELS_A_BYTE: u64 = 16;

/// Bytes that a block of an OpenEXR picture may unpack to for each byte of the file, beside [`LARGE`]. Blocks are unpacked whole.
const BLOCK_RATIO: u64 = 64;

/// Pictures up to this many bytes of memory are believed as they are.
const LARGE: u64 = 16 << 20;

/// Reads a picture; with a warning if it had NaN, negative or infinite values, which are mended.
pub fn read_light_image(path: &Path) -> Result<(LightImage, Option<String>), SceneError> {
    let refuse = |message: String| SceneError::file(path, message.replace('\n', " "));
    let mut file = BufReader::new(files::open(path).map_err(|error| refuse(why_not_opened(&error)))?);
    let length = file.get_ref().metadata().map_err(|error| refuse(error.to_string()))?.len();
    let mut magic = Vec::new();
    file.by_ref().take(4).read_to_end(&mut magic).map_err(|error| refuse(error.to_string()))?;
    file.rewind().map_err(|error| refuse(error.to_string()))?;

    let texels = decoded(|| match magic.as_slice() {
        [0x76, 0x2f, 0x31, 0x01] => read_exr(file, length),
        [b'#', b'?', ..] => read_hdr(file, length),
        _ => Err("is neither an OpenEXR (.exr) nor a Radiance (.hdr) picture".to_owned()),
    });
    let (width, height, texels) = texels.map_err(refuse)?;
    if texels.is_empty() || width.checked_mul(height) != Some(texels.len()) {
        return Err(refuse("has no texels".to_owned()));
    }
    let (image, mended) = LightImage::mended(width, height, texels);
    let warning = (mended > 0).then(|| {
        format!(
            "{}: {mended} values are NaN, negative, infinite or beyond 4e9; NaN and negative ones count as 0, infinite ones as \
             the greatest finite value, greater ones as 4e9",
            path.display()
        )
    });
    Ok((image, warning))
}

/// What `decode` makes of a picture, also where the library that it asks panics.
pub(crate) fn decoded<T>(decode: impl FnOnce() -> Result<T, String>) -> Result<T, String> {
    contained(decode).unwrap_or_else(|| Err("damaged picture: it cannot be decoded".to_owned()))
}

/// Columns, rows, and the texels row by row from the top.
pub(crate) type Texels = (usize, usize, Vec<[f32; 3]>);

/// Reads a picture on this thread alone, so that [`contained`] holds.
pub(crate) fn read_exr(mut file: BufReader<File>, length: u64) -> Result<Texels, String> {
    let damaged = |error: exr::error::Error| match error {
        exr::error::Error::NotSupported(what) => format!("uses an OpenEXR feature that is not read: {what}"),
        other => format!("damaged OpenEXR picture: {other}"),
    };
    let meta = exr::meta::MetaData::read_from_buffered(&mut file, false).map_err(damaged)?;
    let mut bytes: u64 = 0;
    for header in &meta.headers {
        let (width, height) = (header.layer_size.0 as u64, header.layer_size.1 as u64);
        check_size(width, height)?;
        if header.max_block_byte_size() as u64 > LARGE + length.saturating_mul(BLOCK_RATIO) {
            return Err(unlikely(width, height, length));
        }
        let texel = size_of::<[f32; 3]>().max(header.channels.bytes_per_pixel) as u64;
        bytes = bytes.saturating_add((width * height).saturating_mul(texel));
    }
    let has_rgb = meta.headers.iter().any(|header| {
        ["R", "G", "B"].iter().all(|name| header.channels.list.iter().any(|channel| channel.name.eq(name)))
    });
    if !has_rgb {
        let names: Vec<String> = meta
            .headers
            .iter()
            .flat_map(|header| &header.channels.list)
            .map(|c| format!("`{}`", c.name))
            .collect();
        return Err(format!("has no channels `R`, `G`, `B`, but {}", names.join(", ")));
    }
    if is_far_more(bytes, length) {
        file.rewind().map_err(|error| error.to_string())?;
        unpack_once(&mut file).map_err(damaged)?;
    }
    file.rewind().map_err(|error| error.to_string())?;
    let picture = exr::prelude::read()
        .no_deep_data()
        .largest_resolution_level()
        .rgb_channels(
            |size, _| (size.0, vec![[0.0_f32; 3]; size.0 * size.1]),
            |(width, texels): &mut (usize, Vec<[f32; 3]>), position, (r, g, b): (f32, f32, f32)| {
                texels[position.1 * *width + position.0] = [r, g, b];
            },
        )
        .first_valid_layer()
        .all_attributes()
        .non_parallel()
        .from_buffered(file)
        .map_err(damaged)?;
    let size = picture.layer_data.size;
    Ok((size.0, size.1, picture.layer_data.channel_data.pixels.1))
}

/// Unpacks all blocks of an OpenEXR picture one by one and drops them: whether they are there is known then, before memory is
/// taken for the whole.
fn unpack_once(file: impl Read + Seek) -> exr::error::UnitResult {
    let chunks = exr::block::read(file, false)?.all_chunks(false)?;
    let mut blocks = chunks.sequential_decompressor(false);
    while let Some(block) = blocks.decompress_next_block() {
        block?;
    }
    Ok(())
}

pub(crate) fn read_hdr(file: BufReader<File>, length: u64) -> Result<Texels, String> {
    let damaged = |error: image::ImageError| format!("damaged Radiance picture: {error}");
    let decoder = image::codecs::hdr::HdrDecoder::new(file).map_err(damaged)?;
    let (width, height) = decoder.dimensions();
    check_size(width.into(), height.into())?;
    if u64::from(width) * u64::from(height) > length.saturating_mul(HDR_TEXELS_A_BYTE) {
        return Err(unlikely(width.into(), height.into(), length));
    }
    let picture = image::DynamicImage::from_decoder(decoder).map_err(damaged)?.into_rgb32f();
    Ok((width as usize, height as usize, picture.pixels().map(|pixel| pixel.0).collect()))
}

/// Why a picture that a scene names cannot be opened, and the mend.
pub(crate) fn why_not_opened(error: &std::io::Error) -> String {
    match error.kind() {
        std::io::ErrorKind::NotFound => {
            "there is no such file; mend its name, which is relative to the scene file".to_owned()
        }
        _ => error.to_string(),
    }
}

/// Refuses pictures that are too large.
pub(crate) fn check_size(width: u64, height: u64) -> Result<(), String> {
    match width.checked_mul(height) {
        Some(texels) if texels <= GREATEST_TEXELS => {
            memory::ask(texels.saturating_mul(TEXEL_BYTES), || format!("{width} x {height} texels"))
                .map_err(|error| error.to_string())
        }
        _ => Err(format!("has {width} x {height} texels; more than 268 million are not read: scale it down")),
    }
}

/// Whether a picture that takes so many bytes of memory has to show that a file of this length holds it.
pub(crate) fn is_far_more(bytes: u64, length: u64) -> bool {
    bytes > LARGE + length.saturating_mul(2)
}

/// The refusal of a picture whose file is too short for it.
pub(crate) fn unlikely(width: u64, height: u64, length: u64) -> String {
    format!("claims {width} x {height} texels in {length} bytes: the file is damaged")
}
