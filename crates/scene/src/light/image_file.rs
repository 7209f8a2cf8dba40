//! Pictures of the surroundings from files: OpenEXR (channels R, G, B of any type) and Radiance HDR (RGBE).
//!
//! What a file is shows in its first bytes, not in its name.

use std::fs::File;
use std::io::{BufReader, Read, Seek};
use std::path::Path;

use exr::prelude::{ReadChannels, ReadLayers};
use image::ImageDecoder;
use tyndall_machine::{files, memory};

use super::image::LightImage;
use crate::error::SceneError;

/// Texels that a byte of a file may stand for. Constant pictures compress well, but a file that claims more
/// is damaged, and memory for it must not be asked for.
const TEXELS_A_BYTE: u64 = 4096;

/// What a texel takes while it is read: as the file has it, and as three f32.
const TEXEL_BYTES: u64 = 24;

/// Texels of the largest picture that is read, 12 bytes each in memory.
const GREATEST_TEXELS: u64 = 1 << 28;

/// Reads a picture; with a warning if it had NaN, negative or infinite values, which are mended.
pub fn read_light_image(path: &Path) -> Result<(LightImage, Option<String>), SceneError> {
    let refuse = |message: String| SceneError::file(path, message.replace('\n', " "));
    let mut file = BufReader::new(files::open(path).map_err(|error| refuse(why_not_opened(&error)))?);
    let length = file.get_ref().metadata().map_err(|error| refuse(error.to_string()))?.len();
    let mut magic = Vec::new();
    file.by_ref().take(4).read_to_end(&mut magic).map_err(|error| refuse(error.to_string()))?;
    file.rewind().map_err(|error| refuse(error.to_string()))?;

    let (width, height, texels) = match magic.as_slice() {
        [0x76, 0x2f, 0x31, 0x01] => read_exr(file, length).map_err(refuse)?,
        [b'#', b'?', ..] => read_hdr(file, length).map_err(refuse)?,
        _ => return Err(refuse("is neither an OpenEXR (.exr) nor a Radiance (.hdr) picture".to_owned())),
    };
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

/// Columns, rows, and the texels row by row from the top.
pub(crate) type Texels = (usize, usize, Vec<[f32; 3]>);

pub(crate) fn read_exr(mut file: BufReader<File>, length: u64) -> Result<Texels, String> {
    let damaged = |error: exr::error::Error| match error {
        exr::error::Error::NotSupported(what) => format!("uses an OpenEXR feature that is not read: {what}"),
        other => format!("damaged OpenEXR picture: {other}"),
    };
    let meta = exr::meta::MetaData::read_from_buffered(&mut file, false).map_err(damaged)?;
    for header in &meta.headers {
        check_size(header.layer_size.0 as u64, header.layer_size.1 as u64, length)?;
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
        .from_buffered(file)
        .map_err(damaged)?;
    let size = picture.layer_data.size;
    Ok((size.0, size.1, picture.layer_data.channel_data.pixels.1))
}

pub(crate) fn read_hdr(file: BufReader<File>, length: u64) -> Result<Texels, String> {
    let damaged = |error: image::ImageError| format!("damaged Radiance picture: {error}");
    let decoder = image::codecs::hdr::HdrDecoder::new(file).map_err(damaged)?;
    let (width, height) = decoder.dimensions();
    check_size(width.into(), height.into(), length)?;
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

pub(crate) fn check_size(width: u64, height: u64, length: u64) -> Result<(), String> {
    match width.checked_mul(height) {
        Some(texels) if texels > GREATEST_TEXELS => {
            Err(format!("has {width} x {height} texels; more than 268 million are not read: scale it down"))
        }
        Some(texels) if texels <= length.saturating_mul(TEXELS_A_BYTE) => {
            memory::ask(texels.saturating_mul(TEXEL_BYTES), || format!("{width} x {height} texels"))
                .map_err(|error| error.to_string())
        }
        _ => Err(format!("claims {width} x {height} texels in {length} bytes: the file is damaged")),
    }
}
