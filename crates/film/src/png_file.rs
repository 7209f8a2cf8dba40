//! A picture for screens: 8-bit sRGB in a PNG.
//!
//! Exposure in stops (a factor of 2^exposure), [`tone_map`](crate::tone_map()), sRGB curve, and a dither of one
//! step, uniform and the same in every run, so that a clear sky does not fall into bands: floor(255 v + u) has
//! the mean 255 v. Black and white stay exact. The picture is opaque: alpha, with the shadows on catchers, is for
//! compositors and only in EXR files.

use std::io::{self, Write};
use std::path::Path;

use crate::error::{FileError, write_atomically};
use crate::film::Film;
use crate::tone_map::{srgb_signal, tone_map};

/// Writes the mean radiance of a film.
pub fn write_png(path: &Path, film: &Film, exposure: f32) -> Result<(), FileError> {
    let bytes = png_bytes(film, exposure).map_err(|error| FileError::io(path, error))?;
    write_atomically(path, |file| file.write_all(&bytes))
}

/// The content of the file that [`write_png`] writes.
///
/// # Errors
/// If the picture is too large for a PNG.
pub fn png_bytes(film: &Film, exposure: f32) -> io::Result<Vec<u8>> {
    let pixels = encode(&film.mean_image(), film.width() as usize, exposure);
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, film.width(), film.height());
    encoder.set_color(png::ColorType::Rgb);
    encoder.set_depth(png::BitDepth::Eight);
    encoder.set_source_srgb(png::SrgbRenderingIntent::Perceptual);
    let mut writer = encoder.write_header()?;
    writer.write_image_data(&pixels)?;
    writer.finish()?;
    Ok(bytes)
}

/// 8-bit sRGB, three bytes a pixel.
fn encode(image: &[[f32; 3]], width: usize, exposure: f32) -> Vec<u8> {
    let factor = libm::exp2f(exposure);
    let mut bytes = Vec::with_capacity(image.len() * 3);
    for (index, colour) in image.iter().enumerate() {
        let (x, y) = ((index % width) as u32, (index / width) as u32);
        for (channel, value) in (0..).zip(tone_map(colour.map(|c| c * factor))) {
            bytes.push((255.0 * srgb_signal(value) + dither(x, y, channel)) as u8);
        }
    }
    bytes
}

/// A number in [0, 1) from a pixel and channel: an integer hash of three rounds of multiply and xor-shift.
fn dither(x: u32, y: u32, channel: u32) -> f32 {
    let mut h = x.wrapping_mul(0x9e37_79b1) ^ y.wrapping_mul(0x85eb_ca77) ^ channel.wrapping_mul(0xc2b2_ae3d);
    for factor in [0x7feb_352d, 0x846c_a68b, 0x9e37_79b1] {
        h = (h ^ h >> 16).wrapping_mul(factor);
    }
    ((h ^ h >> 16) >> 9) as f32 / (1u32 << 23) as f32
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sample::Layers;

    #[test]
    fn black_and_white_are_exact_and_exposure_counts_in_stops() {
        assert_eq!(encode(&[[0.0; 3]; 9], 3, 0.0), [0; 27]);
        assert_eq!(encode(&[[1e9; 3]; 9], 3, 0.0), [255; 27]);
        assert_eq!(encode(&[[0.1; 3]; 9], 3, 2.0), encode(&[[0.4; 3]; 9], 3, 0.0));
    }

    #[test]
    fn dithering_keeps_the_mean_between_two_steps() {
        let value = 0.2;
        let bytes = encode(&vec![[value; 3]; 64 * 64], 64, 0.0);
        let mean = bytes.iter().map(|&b| f64::from(b)).sum::<f64>() / bytes.len() as f64;
        // Sigma of the mean of 12288 two-valued numbers is at most 0.0045.
        assert!((mean - f64::from(255.0 * srgb_signal(value))).abs() < 0.02, "{mean}");
        assert!(bytes.iter().max().unwrap() - bytes.iter().min().unwrap() == 1);
    }

    #[test]
    fn the_file_is_a_png_of_the_right_size() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.png");
        write_png(&path, &Film::new(5, 4, Layers::NONE).unwrap(), 0.0).unwrap();
        let reader = png::Decoder::new(std::io::BufReader::new(std::fs::File::open(&path).unwrap()));
        let info = reader.read_info().unwrap().info().clone();
        assert_eq!((info.width, info.height, info.color_type), (5, 4, png::ColorType::Rgb));
    }
}
