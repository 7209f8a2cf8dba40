//! Any EXR file as red, green, blue and, if it has them, their standard errors.

use std::fs::File;
use std::io::BufReader;
use std::path::Path;

use exr::block::reader::ChunksReader;
use exr::prelude::{FlatSamples, MetaData, ReadChannels, ReadLayers, Text};

use tyndall_machine::{contained, files, memory};

use crate::error::FileError;

/// A linear picture.
#[derive(Debug, Clone, PartialEq)]
pub struct Picture {
    /// Columns.
    pub width: usize,
    /// Rows.
    pub height: usize,
    /// Linear colours, row by row from the top.
    pub rgb: Vec<[f32; 3]>,
    /// Standard errors of `rgb`.
    pub standard_error: Option<Vec<[f32; 3]>>,
}

/// Pictures up to this many bytes of memory are believed as they are.
const LARGE: u64 = 16 << 20;

/// Bytes that a block may unpack to for each byte of the file, beside [`LARGE`]. Blocks are unpacked whole.
const BLOCK_RATIO: u64 = 64;

impl Picture {
    /// Reads an EXR file: the channels R, G, B, or those of the layer that looks like the picture
    /// (`ViewLayer.Combined.R`…), or the luminance Y as grey. Half, float and unsigned channels are read; of several
    /// resolutions only the finest is.
    ///
    /// It is decoded on this thread alone, so that [`contained`] holds.
    ///
    /// # Errors
    /// If the file cannot be read, is damaged, or holds no such channels.
    pub fn read(path: &Path) -> Result<Self, FileError> {
        contained(|| Self::decode(path))
            .unwrap_or_else(|| Err(FileError::unusable(path, "cannot be read as OpenEXR: it is damaged")))
    }

    fn decode(path: &Path) -> Result<Self, FileError> {
        let refuse = |what: String| FileError::unusable(path, what);
        let damaged = |error: exr::error::Error| match error {
            exr::error::Error::Io(error) if error.kind() != std::io::ErrorKind::UnexpectedEof => {
                FileError::io(path, error)
            }
            error => refuse(format!("cannot be read as OpenEXR: {error}")),
        };
        let length =
            files::open(path).and_then(|file| file.metadata()).map_err(|e| FileError::io(path, e))?.len();
        let meta = MetaData::read_from_file(path, false).map_err(damaged)?;
        let promised: u64 = meta.headers.iter().map(|h| pixel_bytes(h.layer_size, &h.channels)).sum();
        let block = meta.headers.iter().map(|header| header.max_block_byte_size() as u64).max().unwrap_or(0);
        if block > LARGE + length.saturating_mul(BLOCK_RATIO) {
            return Err(refuse(format!(
                "promises {promised} bytes of pixels, more than its {length} can hold"
            )));
        }
        // As stored, as numbers, and as colours with their errors.
        memory::ask(promised.saturating_mul(3), || format!("3 x {promised} bytes of pixels"))
            .map_err(|error| FileError::io(path, error.into()))?;
        if promised > LARGE + 2 * length {
            unpack_once(path).map_err(damaged)?;
        }
        let image = exr::prelude::read()
            .no_deep_data()
            .largest_resolution_level()
            .all_channels()
            .all_layers()
            .all_attributes()
            .non_parallel()
            .from_file(path)
            .map_err(damaged)?;
        let mut channels = Channels::default();
        for layer in image.layer_data {
            let part = layer.attributes.layer_name.map(|name| format!("{name}.")).unwrap_or_default();
            for channel in layer.channel_data.list {
                channels.push(&part, &channel.name, (layer.size.0, layer.size.1), channel.sample_data);
            }
        }
        channels.picture().map_err(refuse)
    }

    /// The same with 0 for NaN and infinities.
    pub(super) fn with_finite_colours(&self) -> Self {
        let finite = |x: f32| if x.is_finite() { x } else { 0.0 };
        Self { rgb: self.rgb.iter().map(|rgb| rgb.map(finite)).collect(), ..self.clone() }
    }

    /// Mean of each channel.
    pub(super) fn mean(&self) -> [f64; 3] {
        let sum = |c: usize| self.rgb.iter().map(|rgb| f64::from(rgb[c])).sum::<f64>();
        [0, 1, 2].map(|c| sum(c) / self.rgb.len() as f64)
    }
}

/// Unpacks all blocks one by one and drops them: whether they are there is known then, before memory is taken for the
/// whole.
fn unpack_once(path: &Path) -> exr::error::UnitResult {
    let file = BufReader::new(File::open(path)?);
    let chunks = exr::block::read(file, false)?.all_chunks(false)?;
    let mut blocks = chunks.sequential_decompressor(false);
    while let Some(block) = blocks.decompress_next_block() {
        block?;
    }
    Ok(())
}

fn pixel_bytes(size: exr::prelude::Vec2<usize>, channels: &exr::meta::attribute::ChannelList) -> u64 {
    let bytes: u64 = channels.list.iter().map(|c| c.sample_type.bytes_per_sample() as u64).sum();
    (size.0 as u64).saturating_mul(size.1 as u64).saturating_mul(bytes)
}

/// All channels of a file with their full names.
#[derive(Default)]
struct Channels {
    list: Vec<(String, (usize, usize), FlatSamples)>,
}

impl Channels {
    fn push(&mut self, part: &str, name: &Text, size: (usize, usize), samples: FlatSamples) {
        let name = name.to_string();
        // Some writers repeat the name of the part in the names of its channels.
        let full = if name.starts_with(part) { name } else { format!("{part}{name}") };
        self.list.push((full, size, samples));
    }

    fn picture(&self) -> Result<Picture, String> {
        let prefix = self.prefix().ok_or_else(|| {
            let names: Vec<&str> = self.list.iter().map(|(name, ..)| name.as_str()).take(12).collect();
            format!("has no channels R, G, B; it has {}", names.join(", "))
        })?;
        let (width, height) = self.size(&prefix);
        let rgb = self.colours(&prefix, (width, height)).ok_or("has channels of different sizes")?;
        let standard_error = self.colours(&format!("{prefix}StandardError."), (width, height));
        Ok(Picture { width, height, rgb, standard_error })
    }

    /// What stands before R, G and B in the names of the picture's own channels.
    fn prefix(&self) -> Option<String> {
        let candidates: Vec<&str> = self
            .list
            .iter()
            .filter_map(|(name, ..)| name.strip_suffix('R').or(name.strip_suffix('Y')))
            .filter(|prefix| prefix.is_empty() || prefix.ends_with('.'))
            .filter(|prefix| self.names(prefix).is_some())
            .collect();
        let last_part =
            |prefix: &str| prefix.trim_end_matches('.').rsplit('.').next().unwrap_or_default().to_lowercase();
        let is_picture =
            |p: &str| ["combined", "beauty", "rgba", "rgb", "color"].contains(&last_part(p).as_str());
        let is_other = |p: &str| {
            ["standarderror", "albedo", "emission", "single", "multiple", "normal"]
                .contains(&last_part(p).as_str())
        };
        candidates
            .iter()
            .find(|p| p.is_empty())
            .or_else(|| candidates.iter().find(|p| is_picture(p)))
            .or_else(|| candidates.iter().find(|p| !is_other(p)))
            .map(|p| p.to_string())
    }

    /// The names of the channels of a colour layer.
    fn names(&self, prefix: &str) -> Option<[String; 3]> {
        let colour = ["R", "G", "B"].map(|c| format!("{prefix}{c}"));
        let grey = [(); 3].map(|()| format!("{prefix}Y"));
        [colour, grey].into_iter().find(|names| names.iter().all(|name| self.find(name).is_some()))
    }

    fn find(&self, name: &str) -> Option<&(String, (usize, usize), FlatSamples)> {
        self.list.iter().find(|(n, ..)| n == name)
    }

    fn size(&self, prefix: &str) -> (usize, usize) {
        self.names(prefix).and_then(|[red, ..]| self.find(&red).map(|(_, size, _)| *size)).unwrap_or_default()
    }

    /// The colours of a layer, if it is there at that size.
    fn colours(&self, prefix: &str, size: (usize, usize)) -> Option<Vec<[f32; 3]>> {
        let names = self.names(prefix)?;
        let mut planes = Vec::new();
        for name in &names {
            let (_, channel_size, samples) = self.find(name)?;
            let plane: Vec<f32> = samples.values_as_f32().collect();
            if *channel_size != size || plane.len() != size.0 * size.1 {
                return None;
            }
            planes.push(plane);
        }
        Some((0..size.0 * size.1).map(|i| [planes[0][i], planes[1][i], planes[2][i]]).collect())
    }
}
