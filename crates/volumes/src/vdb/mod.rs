//! OpenVDB files (`.vdb`), versions 222 to 225: what every maker of smoke, fire and clouds writes.
//!
//! The way through a file: `header` and a descriptor for each grid; then for a grid its `metadata`,
//! `transform`, `topology` and the values of its `leaves`, which are coded as `values` tells. Writing goes
//! the same way: `nodes` hangs leaves and tiles into a tree again, `encode` is the counterpart of `values`.
//!
//! Read are trees of float, half, double, vec3s, int32, int64, bool and mask in the standard shape, with every
//! linear transform. Points, frustums and other shapes are refused by name.
//! Source of the format: OpenVDB 10 to 13, `openvdb/io` and `openvdb/tree` (Museth 2013, "VDB: High-Resolution Sparse
//! Volumes with Dynamic Topology").

mod cursor;
mod encode;
mod header;
mod leaves;
mod metadata;
mod nodes;
mod read;
mod sink;
mod topology;
mod transform;
mod tree;
mod value;
mod values;
mod write;
mod write_tree;

pub use encode::Codec;
pub use read::{SkippedGrid, VdbFile, read, read_bytes};
pub use write::{WriteOptions, write};
