//! Volume files and sparse brick grids. Knows no light.
//!
//! The way of the data: a file is read into [`Grid`]s (one leaf an 8³ block of an OpenVDB tree, exactly as the
//! file has it), and a grid is built into bricks made for tracking rays.

#![forbid(unsafe_code)]

mod blosc;
mod dense;
mod dense_box;
mod element;
mod error;
mod fault;
mod float_tree;
mod grid;
mod little_endian;
mod nifti;
mod npy;
mod nvdb;
mod open;
mod probe;
mod raw;
mod selection;
mod statistics;
pub mod vdb;
mod vol;
mod write;

pub use element::{AxisOrder, ByteOrder, Element};
pub use error::{ReadError, WriteError};
pub use grid::{Grid, GridClass, GridValues, LEAF_EDGE, LEAF_VOXELS, Leaf, Tile, Tree};
pub use open::{Format, ReadRequest, VolumeFile, read, read_bytes};
pub use probe::Lookup;
pub use raw::RawShape;
pub use selection::GridSelection;
pub use statistics::{Components, GridStatistics};
pub use vdb::{Codec, WriteOptions};
pub use write::write;
