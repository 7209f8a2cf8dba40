//! A film as an OpenEXR picture.
//!
//! One part with one flat list of channels (`R`, `StandardError.R`, `Depth.Z`, …; see [`Film::channels`]), all
//! 32-bit float and linear with Rec.709 primaries, ZIP-compressed in scan lines: the plainest form that the format
//! has, so that every program reads it. Attributes: `seed`, `samples` (such as `0..64`), `sceneHash`, `options`
//! (text), `seconds` (double), `rejected` (text) and the standard `software`. Format: OpenEXR file layout, openexr.com.

use std::path::Path;

use exr::meta::attribute::{Chromaticities, LineOrder};
use exr::prelude::{
    AnyChannel, AnyChannels, AttributeValue, Blocks, Compression, Encoding, FlatSamples, Image, Layer,
    LayerAttributes, Text, Vec2, WritableImage,
};

use crate::atomic_write::write_atomically;
use crate::error::FileError;
use crate::film::Film;
use crate::metadata::ImageMetadata;

/// Writes all layers of a film.
pub fn write_exr(path: &Path, film: &Film, metadata: &ImageMetadata) -> Result<(), FileError> {
    let channels = film
        .channels()
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
    image.attributes.chromaticities = Some(REC_709);
    write_atomically(path, |file| {
        image.write().to_buffered(file).map_err(|error| match error {
            exr::error::Error::Io(error) => error,
            other => std::io::Error::other(other),
        })
    })
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
            seconds: 1.5,
        };
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.exr");
        write_exr(&path, &film, &metadata).unwrap();

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
    }
}
