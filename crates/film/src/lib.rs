//! Samples become an image with its error. Knows pixels, not light paths.
//!
//! The way of the data: transport fills a [`FilmTile`] with [`Sample`]s, the [`Film`] takes the tiles up into exact
//! sums, and the sums are developed into channels with their standard error, which go to [EXR](write_exr) and
//! [PNG](write_png) files and into a [`Summary`].

#![cfg_attr(not(test), warn(clippy::disallowed_methods))]
#![forbid(unsafe_code)]

mod accumulation_file;
mod colours;
pub mod comparison;
mod error;
mod estimates;
mod exr_file;
mod film;
mod fixed_point;
mod heavy_tails;
mod metadata;
mod plane_codec;
mod png_file;
mod provenance;
mod ranges;
mod rates;
mod sample;
mod summary;
mod sums;
mod tone_map;
mod warnings;

pub use accumulation_file::Accumulation;
pub use colours::{BandMean, Colours, named_channels};
pub use error::{FileError, write_atomically};
pub use estimates::{Channel, Estimate, LUMINANCE};
pub use exr_file::{write_bands_exr, write_exr};
pub use film::{Film, FilmTile, MAX_PIXELS, MergeError, Rect, SizeError, TILE_EDGE};
pub use heavy_tails::UnseenLight;
pub use metadata::{Crop, ImageMetadata};
pub use png_file::{png_bytes, write_png};
pub use provenance::Provenance;
pub use ranges::{RangeError, SampleRanges};
pub use rates::Rates;
pub use sample::{Layers, Sample};
pub use summary::Summary;
pub use tone_map::{srgb_signal, tone_map};
pub use warnings::warnings;
