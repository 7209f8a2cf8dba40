//! Pictures: every compression and type of numbers of OpenEXR, Radiance, PNG, JPEG.

use std::io::Cursor;

use exr::prelude::*;
use image::{DynamicImage, ImageFormat};

use super::put;

const SIZE: (usize, usize) = (12, 10);

pub fn write_all() {
    for (name, compression) in [
        ("none", Compression::Uncompressed),
        ("rle", Compression::RLE),
        ("zips", Compression::ZIP1),
        ("zip", Compression::ZIP16),
        ("piz", Compression::PIZ),
        ("pxr24", Compression::PXR24),
        ("b44", Compression::B44),
        ("b44a", Compression::B44A),
    ] {
        put("exr", &format!("{name}.exr"), &exr_file(compression, ["R", "G", "B"], Blocks::ScanLines));
    }
    put("exr", "tiles.exr", &exr_file(Compression::ZIP16, ["R", "G", "B"], Blocks::Tiles(Vec2(4, 4))));
    put("exr", "mixed.exr", &mixed());
    let shades: Vec<u8> = (0..SIZE.0 * SIZE.1 * 4).map(|n| (n * 5 % 250) as u8).collect();
    let rgba = image::RgbaImage::from_raw(SIZE.0 as u32, SIZE.1 as u32, shades).unwrap();
    let picture = DynamicImage::ImageRgba8(rgba);
    for (name, picture) in [
        ("rgba8", picture.clone()),
        ("rgb8", picture.to_rgb8().into()),
        ("grey8", picture.to_luma8().into()),
        ("rgb16", picture.to_rgb16().into()),
        ("grey_alpha16", picture.to_luma_alpha16().into()),
    ] {
        put("png", &format!("{name}.png"), &encoded(&picture, ImageFormat::Png));
    }
    put("png", "palette.png", &palette());
    put("jpeg", "colour.jpg", &encoded(&picture.to_rgb8().into(), ImageFormat::Jpeg));
    put("jpeg", "grey.jpg", &encoded(&picture.to_luma8().into(), ImageFormat::Jpeg));
    for (name, width) in [("flat.hdr", 6), ("runs.hdr", 16)] {
        let pixels: Vec<image::Rgb<f32>> = (0..width * 4).map(|n| image::Rgb([n as f32, 2.0, 0.5])).collect();
        let mut bytes = Vec::new();
        image::codecs::hdr::HdrEncoder::new(&mut bytes).encode(&pixels, width, 4).unwrap();
        put("hdr", name, &bytes);
    }
}

fn exr_file(compression: Compression, names: [&str; 3], blocks: Blocks) -> Vec<u8> {
    let values = |offset: usize| -> Vec<f16> {
        (0..SIZE.0 * SIZE.1).map(|n| f16::from_f32((offset + n / 3) as f32)).collect()
    };
    let channels = [0, 1, 2].map(|c| AnyChannel::new(names[c], FlatSamples::F16(values(40 * c))));
    let encoding = Encoding { compression, blocks, line_order: LineOrder::Increasing };
    let layer = Layer::new(
        SIZE,
        LayerAttributes::default(),
        encoding,
        AnyChannels::sort(channels.into_iter().collect()),
    );
    bytes_of(&Image::from_layer(layer))
}

/// Channels of every type, with layers of names.
fn mixed() -> Vec<u8> {
    let count = SIZE.0 * SIZE.1;
    let channels = [
        AnyChannel::new("Depth.Z", FlatSamples::U32((0..count as u32).collect())),
        AnyChannel::new("R", FlatSamples::F32(vec![1.0; count])),
        AnyChannel::new("G", FlatSamples::F16(vec![f16::from_f32(0.5); count])),
        AnyChannel::new("B", FlatSamples::F32((0..count).map(|n| n as f32).collect())),
    ];
    bytes_of(&Image::from_channels(SIZE, AnyChannels::sort(channels.into_iter().collect())))
}

fn bytes_of(image: &Image<Layer<AnyChannels<FlatSamples>>>) -> Vec<u8> {
    let mut bytes = Vec::new();
    image.write().to_buffered(Cursor::new(&mut bytes)).unwrap();
    bytes
}

fn encoded(picture: &DynamicImage, format: ImageFormat) -> Vec<u8> {
    let mut bytes = Vec::new();
    picture.write_to(&mut Cursor::new(&mut bytes), format).unwrap();
    bytes
}

/// Two bits a pixel and a transparent colour.
fn palette() -> Vec<u8> {
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, 9, 3);
    encoder.set_color(png::ColorType::Indexed);
    encoder.set_depth(png::BitDepth::Two);
    encoder.set_palette(vec![0, 0, 0, 255, 0, 0, 0, 255, 0, 9, 9, 9]);
    encoder.set_trns(vec![255, 0]);
    encoder.write_header().unwrap().write_image_data(&[0x1b; 9]).unwrap();
    bytes
}
