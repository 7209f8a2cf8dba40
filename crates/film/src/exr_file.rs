//! A film as an OpenEXR picture.
//!
//! One part with one flat list of channels (`R`, `StandardError.R`, `Depth.Z`, …; see [`named_channels`]), all
//! 32-bit float and linear, with Rec.709 primaries if it is a picture in RGB, ZIP-compressed in scan lines: the plainest form that the format
//! has, so that every program reads it. Attributes: `seed`, `samples` (such as `0..64`), `sceneHash`, `options`
//! (text), `seconds` (double), `rejected` (text), `unseenLight` (double, the bound of [`Film::stated_unseen_light`]) and the standard `software`. A crop is a data window in the display window
//! of the whole picture. Format: OpenEXR file layout, openexr.com.

use std::io::{Cursor, Write};
use std::path::Path;

use exr::meta::attribute::{Chromaticities, IntegerBounds, LineOrder};
use exr::prelude::{
    AnyChannel, AnyChannels, AttributeValue, Blocks, Compression, Encoding, FlatSamples, Image, Layer,
    LayerAttributes, Text, Vec2, WritableImage,
};

use crate::accumulation_file::Accumulation;
use crate::colours::{Colours, channels_of_bands, named_channels};
use crate::error::{FileError, write_atomically};
use crate::estimates::Channel;
use crate::film::Film;
use crate::metadata::{Crop, ImageMetadata};

/// Writes all layers of a film.
pub fn write_exr(path: &Path, film: &Film, metadata: &ImageMetadata) -> Result<(), FileError> {
    write_channels(path, named_channels(film, &metadata.colours), film, metadata)
}

/// Writes all layers of the films that make a picture of many bands, with the first one's attributes.
pub fn write_bands_exr(path: &Path, pictures: &[Accumulation]) -> Result<(), FileError> {
    let Some(Accumulation { film, metadata }) = pictures.first() else { return Ok(()) };
    write_channels(path, channels_of_bands(pictures), film, metadata)
}

fn write_channels(
    path: &Path,
    channels: Vec<Channel>,
    film: &Film,
    metadata: &ImageMetadata,
) -> Result<(), FileError> {
    let channels = channels
        .into_iter()
        .map(|channel| AnyChannel::new(text(&channel.name), FlatSamples::F32(channel.values)))
        .collect();
    let size = Vec2(film.width() as usize, film.height() as usize);
    let encoding = Encoding {
        compression: Compression::ZIP16,
        blocks: Blocks::ScanLines,
        line_order: LineOrder::Increasing,
    };
    let layer = Layer::new(size, attributes(film, metadata), encoding, AnyChannels::sort(channels));
    let mut image = Image::from_layer(layer);
    if let Some((corner, full_size)) = metadata.crop.and_then(|crop| windows(crop, film)) {
        image.layer_data.attributes.layer_position = corner;
        image.attributes.display_window = IntegerBounds::new(Vec2(0, 0), full_size);
    }
    image.attributes.chromaticities = (metadata.colours == Colours::Rgb).then_some(REC_709);
    let mut bytes = Cursor::new(Vec::new());
    image
        .write()
        .to_buffered(&mut bytes)
        .map_err(|error| FileError::unusable(path, format!("cannot be written as OpenEXR: {error}")))?;
    let mut bytes = bytes.into_inner();
    sort_attributes(&mut bytes);
    write_atomically(path, |file| file.write_all(&bytes))
}

/// Corner of the data window and size of the display window; `None` of a crop that is no part of its whole, as a damaged
/// file may claim.
fn windows(crop: Crop, film: &Film) -> Option<(Vec2<i32>, Vec2<usize>)> {
    let along = |corner: u32, size: u32, full: u32| {
        let fits = u64::from(corner) + u64::from(size) <= u64::from(full) && full <= GREATEST_WINDOW;
        fits.then_some((i32::try_from(corner).ok()?, full as usize))
    };
    let [left, top] = crop.corner;
    let (left, width) = along(left, film.width(), crop.full_size[0])?;
    let (top, height) = along(top, film.height(), crop.full_size[1])?;
    Some((Vec2(left, top), Vec2(width, height)))
}

/// Far above any picture, far below where the sums of readers overflow.
const GREATEST_WINDOW: u32 = 1 << 24;

/// Puts the attributes of the header in the order of their names. The `exr` crate keeps some in a hash map, in an
/// order that differs from run to run, and equal pictures shall be equal files.
fn sort_attributes(file: &mut [u8]) {
    /// Magic number and version.
    const PREAMBLE: usize = 8;
    // An attribute is its name and its type, each ended by a zero, the i32 length of its value, and its value; an
    // empty name ends the header.
    let length_of = |bytes: &[u8]| -> Option<usize> {
        let name = bytes.iter().position(|&b| b == 0).filter(|&end| end > 0)? + 1;
        let kind = bytes[name..].iter().position(|&b| b == 0)? + 1;
        let value = bytes.get(name + kind..)?.first_chunk().map(|&n| i32::from_le_bytes(n))?;
        Some(name + kind + 4 + usize::try_from(value).ok()?)
    };
    let mut attributes: Vec<Vec<u8>> = Vec::new();
    let mut end = PREAMBLE;
    while let Some(attribute) = file.get(end..).and_then(|rest| rest.get(..length_of(rest)?)) {
        attributes.push(attribute.to_vec());
        end += attribute.len();
    }
    attributes.sort();
    file[PREAMBLE..end].copy_from_slice(&attributes.concat());
}

/// CIE 1931 xy of the primaries and of the white point D65 (ITU-R BT.709).
const REC_709: Chromaticities = Chromaticities {
    red: Vec2(0.64, 0.33),
    green: Vec2(0.30, 0.60),
    blue: Vec2(0.15, 0.06),
    white: Vec2(0.3127, 0.3290),
};

fn attributes(film: &Film, metadata: &ImageMetadata) -> LayerAttributes {
    let mut attributes = LayerAttributes {
        software_name: Some(text(&format!("Tyndall {}", metadata.version))),
        ..LayerAttributes::default()
    };
    for (name, value) in [
        ("seed", metadata.seed.to_string()),
        ("samples", film.complete().to_string()),
        ("sceneHash", metadata.scene_hash.clone()),
        ("options", metadata.options.clone()),
        ("rejected", film.rejected().to_string()),
    ] {
        attributes.other.insert(text(name), AttributeValue::Text(text(&value)));
    }
    attributes.other.insert(text("seconds"), AttributeValue::F64(metadata.seconds));
    if let Some(unseen) = film.stated_unseen_light() {
        attributes.other.insert(text("unseenLight"), AttributeValue::F64(unseen.bound));
    }
    attributes
}

/// EXR text holds one byte a character; what does not fit becomes `?`.
fn text(string: &str) -> Text {
    let ascii: String = string.chars().map(|c| if c.is_ascii() { c } else { '?' }).collect();
    Text::new_or_none(ascii).unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::comparison::Picture;
    use crate::film::FilmTile;
    use crate::sample::{Layers, Sample};
    use exr::prelude::{ReadChannels, ReadLayers};

    #[test]
    fn another_reading_gives_back_names_values_and_attributes() {
        let mut film = Film::new(20, 3, Layers::ALL).unwrap();
        film.open_range(8).unwrap();
        for number in 0..film.tile_count() {
            let rect = film.tile_rect(number);
            let mut tile = FilmTile::new(rect, 8..10, Layers::ALL);
            for x in rect.x..rect.x + rect.width {
                for brightness in [1.0, 3.0] {
                    let radiance = [x as f32 * brightness, 0.5, 1e-7];
                    tile.add(x, 2, &Sample { radiance, single: radiance, ..Sample::default() });
                }
            }
            film.merge_tile(&tile);
        }
        film.complete_through(10).unwrap();
        let metadata = ImageMetadata {
            scene_hash: "abc".into(),
            version: "1.2.3".into(),
            options: "integrator=fast".into(),
            seed: u64::MAX,
            crop: Some(Crop { corner: [30, 40], full_size: [640, 480] }),
            colours: Colours::Rgb,
            seconds: 1.5,
        };
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.exr");
        write_exr(&path, &film, &metadata).unwrap();

        let bytes = std::fs::read(&path).unwrap();
        write_exr(&path, &film, &metadata).unwrap();
        assert_eq!(std::fs::read(&path).unwrap(), bytes, "equal pictures are equal files");

        let image = exr::prelude::read()
            .no_deep_data()
            .largest_resolution_level()
            .all_channels()
            .first_valid_layer()
            .all_attributes()
            .from_file(&path)
            .unwrap();
        let list = &image.layer_data.channel_data.list;
        for channel in film.channels() {
            let Some(read) = list.iter().find(|c| c.name.eq(channel.name.as_str())) else {
                panic!("no channel {}", channel.name)
            };
            assert_eq!(read.sample_data, FlatSamples::F32(channel.values), "{}", channel.name);
        }
        assert_eq!(list.len(), film.channels().len());
        let other = &image.layer_data.attributes.other;
        let attribute = |name: &str| other.get(&text(name)).cloned();
        assert_eq!(attribute("seed"), Some(AttributeValue::Text(text("18446744073709551615"))));
        assert_eq!(attribute("samples"), Some(AttributeValue::Text(text("8..10"))));
        assert_eq!(attribute("sceneHash"), Some(AttributeValue::Text(text("abc"))));
        assert_eq!(attribute("seconds"), Some(AttributeValue::F64(1.5)));
        assert_eq!(image.layer_data.attributes.layer_position, Vec2(30, 40));
        assert_eq!(image.attributes.display_window, IntegerBounds::new(Vec2(0, 0), Vec2(640, 480)));
        let picture = Picture::read(&path).unwrap();
        assert_eq!((picture.width, picture.height), (20, 3));
    }

    #[test]
    fn a_crop_that_is_no_part_of_its_whole_is_left_out() {
        let film = Film::new(20, 3, Layers::NONE).unwrap();
        let outside = |corner, full_size| windows(Crop { corner, full_size }, &film).is_none();
        assert!(outside([30, 40], [49, 480]) && outside([u32::MAX; 2], [u32::MAX; 2]));
        assert!(!outside([29, 477], [49, 480]));
    }
}
