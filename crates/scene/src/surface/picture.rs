//! Pictures for surfaces from files: PNG, JPEG, OpenEXR and Radiance HDR, as linear red, green and blue from 0 up.
//!
//! What a file is shows in its first bytes, not in its name. Numbers of PNG and JPEG are sRGB-coded (IEC 61966-2-1) unless the
//! scene says otherwise, those of the others linear. Bytes stay bytes in memory and are decoded when looked at.

use std::io::{BufReader, Read, Seek};
use std::path::Path;

use glam::DVec3;
use image::{DynamicImage, ImageDecoder};
use tyndall_machine::files;

use crate::error::SceneError;
use crate::light::image_file::{check_size, read_exr, read_hdr, why_not_opened};

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
        read(path, srgb).map_err(|message| SceneError::file(path, message))
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
            let decoder = image::codecs::png::PngDecoder::new(file);
            of_bytes(decoder.map_err(|error| format!("damaged PNG picture: {error}"))?, length, srgb)?
        }
        [0xff, 0xd8, ..] => {
            let decoder = image::codecs::jpeg::JpegDecoder::new(file);
            of_bytes(decoder.map_err(|error| format!("damaged JPEG picture: {error}"))?, length, srgb)?
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

fn of_bytes(decoder: impl ImageDecoder, length: u64, srgb: Option<bool>) -> Result<Picture, String> {
    let (width, height) = decoder.dimensions();
    check_size(width.into(), height.into(), length)?;
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
