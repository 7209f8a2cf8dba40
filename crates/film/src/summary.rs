//! A render in numbers, for scripts.

use std::path::Path;

use serde::Serialize;

use crate::accumulation_file::Accumulation;
use crate::colours::{BandMean, Colours, band_means};
use crate::error::{FileError, write_atomically};
use crate::estimates::Estimate;
use crate::film::Film;
use crate::heavy_tails::UnseenLight;
use crate::metadata::ImageMetadata;
use crate::ranges::SampleRanges;

/// What is said about a picture in one JSON object.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Summary {
    /// Columns of pixels.
    pub width: u32,
    /// Rows of pixels.
    pub height: u32,
    /// Ranges of sample indices that every pixel holds, `[[0, 64]]`; of an adaptive picture those it would hold at a rate of 1.
    pub samples: SampleRanges,
    /// Samples a pixel, the mean of all pixels (they differ in an interrupted render, and in an adaptive one).
    pub samples_per_pixel: f64,
    /// Time of rendering.
    pub seconds: f64,
    /// What the channels are.
    pub colours: Colours,
    /// Mean radiance of all bands, if the picture is one of bands.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub bands: Vec<BandMean>,
    /// Mean radiance of the first three channels and its standard error; no error (`null`) with fewer than two samples.
    pub mean: [Estimate; 3],
    /// See [`Film::median_relative_error`]; `null` if it is not known.
    pub median_relative_error: Option<f64>,
    /// See [`Film::stated_unseen_light`]; `null` if it is not known.
    pub unseen_light: Option<UnseenLight>,
    /// See [`Film::largest_sample_share`]; `null` of a black picture.
    pub largest_sample_share: Option<f64>,
    /// Samples that were not finite or too large, and which all figures leave out; the picture may be biased by it.
    pub rejected: u64,
    /// Seed of the random numbers.
    pub seed: u64,
    /// Hash of the scene.
    pub scene_hash: String,
    /// Version of the program.
    pub version: String,
    /// Options that decide which samples are drawn.
    pub options: String,
}

impl Summary {
    /// Sums up a film.
    pub fn new(film: &Film, metadata: &ImageMetadata) -> Self {
        Self {
            width: film.width(),
            height: film.height(),
            samples: film.complete().clone(),
            samples_per_pixel: film.mean_sample_count(),
            seconds: metadata.seconds,
            colours: metadata.colours,
            bands: Vec::new(),
            mean: film.image_mean(),
            median_relative_error: film.median_relative_error().filter(|e| e.is_finite()),
            unseen_light: film.stated_unseen_light(),
            largest_sample_share: film.largest_sample_share(),
            rejected: film.rejected(),
            seed: metadata.seed,
            scene_hash: metadata.scene_hash.clone(),
            version: metadata.version.clone(),
            options: metadata.options.clone(),
        }
    }

    /// Sums up the films that make a picture of bands; of what is not about one band, it gives the first film's. `None` if
    /// there is no film.
    pub fn of_bands(pictures: &[Accumulation]) -> Option<Self> {
        let Accumulation { film, metadata } = pictures.first()?;
        Some(Self { bands: band_means(pictures), ..Self::new(film, metadata) })
    }

    /// Writes it as JSON.
    pub fn write_json(&self, path: &Path) -> Result<(), FileError> {
        write_atomically(path, |file| Ok(serde_json::to_writer_pretty(file, self)?))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sample::Layers;

    #[test]
    fn the_keys_are_those_scripts_depend_on() {
        let film = Film::new(2, 2, Layers::NONE).unwrap();
        let json = serde_json::to_value(Summary::new(&film, &ImageMetadata::default())).unwrap();
        assert_eq!(json["samples"], serde_json::json!([]));
        assert_eq!(json["mean"][0], serde_json::json!({"mean": 0.0, "standard_error": null}));
        for key in [
            "median_relative_error",
            "unseen_light",
            "largest_sample_share",
            "rejected",
            "seconds",
            "seed",
            "scene_hash",
            "version",
        ] {
            assert!(json.get(key).is_some(), "{key}");
        }
    }
}
