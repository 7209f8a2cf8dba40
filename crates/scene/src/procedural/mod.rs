//! Volumes that are computed instead of read.

mod cumulus;
mod noise;

pub use cumulus::cumulus;
