//! Volume files and sparse brick grids. Knows no light.
//!
//! The way of the data: a file is read into [`Grid`]s (one leaf an 8³ block of an OpenVDB tree, exactly as the
//! file has it), and a grid is built into bricks made for tracking rays.

#![forbid(unsafe_code)]

mod blosc;
mod error;
mod grid;
mod probe;
mod selection;
mod statistics;
pub mod vdb;

pub use error::{ReadError, WriteError};
pub use grid::{Grid, GridClass, GridValues, LEAF_EDGE, LEAF_VOXELS, Leaf, Tile, Tree};
pub use probe::Lookup;
pub use selection::GridSelection;
pub use statistics::{Components, GridStatistics};
