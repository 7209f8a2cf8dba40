//! Volume files and sparse brick grids. Knows no light.
//!
//! The way of the data: a file is read into [`Grid`]s (one leaf an 8³ block of an OpenVDB tree, exactly as the
//! file has it), and a grid is built into bricks made for tracking rays.
//!
//! ```
//! use tyndall_volumes::{BrickGrid, ReadRequest, Storage, read_bytes};
//!
//! // A file of 16³ bytes whose name says so; `read` takes the path of a file of any format.
//! let name = "ramp_16x16x16_uint8.raw";
//! let bytes: Vec<u8> = (0..16 * 16 * 16).map(|i| (i % 16) as u8).collect();
//! let file = read_bytes(&bytes, name.as_ref(), &ReadRequest::default())?;
//! assert_eq!(file.grids[0].values.statistics().active_voxels, 4096);
//!
//! let bricks = BrickGrid::new(&file.grids[0], Storage::F16)?;
//! assert_eq!(bricks.value(glam::DVec3::new(2.5, 7.0, 7.0)), 2.5);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

#![cfg_attr(not(test), warn(clippy::disallowed_methods))]
#![forbid(unsafe_code)]

mod array;
mod blosc;
pub mod bricks;
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

pub use array::{ArrayError, DenseArray, tree_of_array};
pub use bricks::{BrickGrid, Filter, Storage};
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

/// The example of the README compiles.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
