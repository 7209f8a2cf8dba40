//! Pictures for surfaces from files: PNG, JPEG, OpenEXR and Radiance HDR, as linear red, green and blue from 0 up.
//!
//! What a file is shows in its first bytes, not in its name. Numbers of PNG and JPEG are sRGB-coded (IEC 61966-2-1) unless the
//! scene says otherwise, those of the others linear. Bytes stay bytes in memory and are decoded when looked at.

use std::io::{BufRead, BufReader, Read, Seek};
use std::path::Path;

use glam::DVec3;
use image::codecs::png::PngDecoder;
use image::{DynamicImage, ImageDecoder};
use tyndall_machine::files;

use crate::error::SceneError;
use crate::light::image_file::{
    check_size, decoded, is_far_more, read_exr, read_hdr, unlikely, why_not_opened,
};

/// Bytes that the buffers for a PNG's rows may take.
const PNG_BUFFERS: u64 = 32 << 20;

/// Texels that a byte of a JPEG may stand for, beside a million: one colour all over takes about two bits for 64 texels.
const JPEG_TEXELS_A_BYTE: u64 = 256;

/// A picture, row by row from the top.
#[derive(Debug, Clone, PartialEq)]
pub struct Picture {
    width: usize,
    height: usize,
    texels: Texels,
}

#[derive(Debug, Clone, PartialEq)]
enum Texels {
    /// Bytes, and what each of the 256 stands for.
    Bytes(Vec<[u8; 3]>, Box<[f32; 256]>),
    /// Finite numbers of at least 0.
    Numbers(Vec<[f32; 3]>),
}

impl Picture {
    /// A picture of linear numbers, as many as `width` times `height`; at least one. What is no number or below 0
    /// counts as 0, what is infinite as 1.
    pub fn linear(width: usize, height: usize, texels: Vec<[f32; 3]>) -> Picture {
        Picture {
            width,
            height,
            texels: Texels::Numbers(texels.into_iter().map(|texel| texel.map(sound)).collect()),
        }
    }

    /// Reads a file; `srgb` says whether its numbers are sRGB-coded, if it is not as usual for its kind.
    pub fn read(path: &Path, srgb: Option<bool>) -> Result<Picture, SceneError> {
        decoded(|| read(path, srgb)).map_err(|message| SceneError::file(path, message))
    }

    /// Texels in a row.
    pub fn width(&self) -> usize {
        self.width
    }

    /// Rows.
    pub fn height(&self) -> usize {
        self.height
    }

    /// The greatest of all numbers.
    pub fn greatest(&self) -> f64 {
        let greatest = match &self.texels {
            Texels::Bytes(..) => 1.0,
            Texels::Numbers(numbers) => numbers.iter().flatten().copied().fold(0.0, f32::max),
        };
        f64::from(greatest)
    }

    /// The texel of a column and a row, which must be inside.
    pub fn texel(&self, column: usize, row: usize) -> DVec3 {
        let number = row * self.width + column;
        let texel = match &self.texels {
            Texels::Bytes(bytes, meanings) => bytes[number].map(|byte| meanings[usize::from(byte)]),
            Texels::Numbers(numbers) => numbers[number],
        };
        DVec3::from_array(texel.map(f64::from))
    }
}

fn read(path: &Path, srgb: Option<bool>) -> Result<Picture, String> {
    let io = |error: std::io::Error| error.to_string();
    let mut file = BufReader::new(files::open(path).map_err(|error| why_not_opened(&error))?);
    let length = file.get_ref().metadata().map_err(io)?.len();
    let mut magic = Vec::new();
    file.by_ref().take(4).read_to_end(&mut magic).map_err(io)?;
    file.rewind().map_err(io)?;
    let picture = match magic.as_slice() {
        [0x76, 0x2f, 0x31, 0x01] => of_numbers(read_exr(file, length)?, srgb.unwrap_or(false)),
        [b'#', b'?', ..] => of_numbers(read_hdr(file, length)?, srgb.unwrap_or(false)),
        [0x89, b'P', b'N', b'G'] => {
            let damaged = |error: &dyn std::fmt::Display| format!("damaged PNG picture: {error}");
            let decoder = png_decoder(&mut file).map_err(|error| damaged(&error))?;
            let bytes = decoder.total_bytes();
            if is_far_more(bytes, length) {
                drop(decoder);
                file.rewind().map_err(io)?;
                unpack_once(&mut file).map_err(|error| damaged(&error))?;
            }
            file.rewind().map_err(io)?;
            let decoder = png_decoder(file).map_err(|error| damaged(&error))?;
            of_bytes(decoder, srgb)?
        }
        [0xff, 0xd8, ..] => {
            let decoder = image::codecs::jpeg::JpegDecoder::new(file);
            let decoder = decoder.map_err(|error| format!("damaged JPEG picture: {error}"))?;
            let (width, height) = decoder.dimensions();
            // How much is there shows only when it is decoded, and decoders fill up what is missing.
            let most = (1 << 20) + length.saturating_mul(JPEG_TEXELS_A_BYTE);
            if u64::from(width) * u64::from(height) > most {
                return Err(unlikely(width.into(), height.into(), length));
            }
            of_bytes(decoder, srgb)?
        }
        _ => {
            let kinds = "PNG (.png), a JPEG (.jpg), an OpenEXR (.exr) nor a Radiance (.hdr)";
            return Err(format!("is neither a {kinds} picture: convert it to one of these"));
        }
    };
    let texels = match &picture.texels {
        Texels::Bytes(bytes, _) => bytes.len(),
        Texels::Numbers(numbers) => numbers.len(),
    };
    if texels == 0 || picture.width.checked_mul(picture.height) != Some(texels) {
        return Err("has no texels".to_owned());
    }
    Ok(picture)
}

fn of_numbers((width, height, mut texels): (usize, usize, Vec<[f32; 3]>), srgb: bool) -> Picture {
    if srgb {
        texels.iter_mut().flatten().for_each(|value| *value = srgb_to_linear(*value));
    }
    Picture::linear(width, height, texels)
}

fn png_decoder<R: BufRead + Seek>(file: R) -> image::ImageResult<PngDecoder<R>> {
    let mut limits = image::Limits::no_limits();
    limits.max_alloc = Some(PNG_BUFFERS);
    PngDecoder::with_limits(file, limits)
}

/// Unpacks the rows of a PNG one by one and drops them: whether they are there is known then, before memory is taken for
/// the whole.
fn unpack_once(file: impl BufRead + Seek) -> Result<(), png::DecodingError> {
    let limits = png::Limits { bytes: PNG_BUFFERS as usize };
    let mut rows = png::Decoder::new_with_limits(file, limits).read_info()?;
    while rows.next_row()?.is_some() {}
    Ok(())
}

fn of_bytes(decoder: impl ImageDecoder, srgb: Option<bool>) -> Result<Picture, String> {
    let (width, height) = decoder.dimensions();
    check_size(width.into(), height.into())?;
    let is_deep = decoder.color_type().bytes_per_pixel() > decoder.color_type().channel_count();
    let picture = DynamicImage::from_decoder(decoder).map_err(|error| format!("damaged picture: {error}"))?;
    let (width, height, srgb) = (width as usize, height as usize, srgb.unwrap_or(true));
    if is_deep {
        let texels = picture.into_rgb32f().pixels().map(|texel| texel.0).collect();
        return Ok(of_numbers((width, height, texels), srgb));
    }
    let texels = picture.into_rgb8().pixels().map(|texel| texel.0).collect();
    let meanings = std::array::from_fn(|byte| {
        let value = byte as f32 / 255.0;
        if srgb { srgb_to_linear(value) } else { value }
    });
    Ok(Picture { width, height, texels: Texels::Bytes(texels, Box::new(meanings)) })
}

fn sound(value: f32) -> f32 {
    if value == f32::INFINITY { 1.0 } else { value.max(0.0) }
}

fn srgb_to_linear(value: f32) -> f32 {
    if value <= 0.04045 { value / 12.92 } else { libm::powf((value + 0.055) / 1.055, 2.4) }
}
