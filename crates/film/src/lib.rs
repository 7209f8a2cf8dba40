//! Samples become an image with its error. Knows pixels, not light paths.
//!
//! The way of the data: transport fills a [`FilmTile`] with [`Sample`]s, the [`Film`] takes the tiles up into exact
//! sums, and the sums are developed into channels with their standard error.

#![forbid(unsafe_code)]

mod estimates;
mod film;
mod fixed_point;
mod ranges;
mod sample;
mod sums;

pub use estimates::{Channel, Estimate, LUMINANCE};
pub use film::{Film, FilmTile, MAX_PIXELS, MergeError, Rect, SizeError, TILE_EDGE};
pub use ranges::{RangeError, SampleRanges};
pub use sample::{Layers, Sample};
