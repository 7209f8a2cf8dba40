//! A scalar grid made for tracking rays: sparse 8³ bricks, one for each leaf of the file, under bounds.
//!
//! # Layout
//! Three levels are usual. A dense *top table* over the grid's box has a cell for each 32³ voxels; a cell is a
//! constant, or a *node* of 4³ cells of 8³ voxels; such a cell is a constant or a *brick* of 512 voxels. Where
//! the box is so large that the table would pass 2^18 cells, the top cells are 128³, 512³, … voxels and the nodes
//! nest, so that a constant tile of 4096³ voxels stays a handful of cells.
//!
//! Every cell is one word of 8 bytes: what is there, and the least and greatest value that the *trilinearly
//! filtered* field takes inside it, each as a bfloat16 rounded outwards (0.4 % loose at most). One load thus tells
//! a tracker both the majorant and where to look next; a cell whose maximum is 0 is skipped whole.
//!
//! # Filter
//! Index space is OpenVDB's: integers are voxel centres. The cell that starts at voxel `b` is the region
//! [b, b + edge)³, whose trilinear values are mixtures of the voxels b … b + edge. Bounds are taken over those, so
//! the footprint reaches one voxel beyond a cell on its upper sides only. One voxel, drawn with its trilinear
//! weight as `floor(p + u)` with u uniform in [0, 1)³, is an unbiased estimate of the filtered value at `p`.
//!
//! A grid can be looked at without a filter instead ([`Filter::Nearest`]): constant in each voxel. Its coordinates are
//! then half a voxel further on, so that voxel `b` fills [b, b + 1)³ and is `floor(p)`; cells and bounds hold as they
//! are.
//!
//! # Values
//! Stored as f32; as f16 scaled by a power of two (relative error 2^-11, exact for half files whose range fits);
//! or as u8 with an offset and a step of its own in each brick (error at most 1/510 of the brick's range), where blocks
//! of 2³ voxels that hold nothing but the brick's least value take no memory.
//! Non-finite values become 0 and are counted.
//!
//! # Memory
//! Per brick 1024 or 2048 bytes (f16, f32), or 24 bytes and 8 for each of its 64 blocks that is kept (u8), and 8 bytes
//! for its cell; per node 512 bytes; per top cell 8 bytes. Measured in total, in f16, over the values of the bricks
//! alone: 2.9 % more on the 349,082-voxel Disney cloud (1093 bricks), 2.1 % on a million-voxel smoke (3117 bricks),
//! 5.1 % on a body of 131 bricks. In u8, by active voxel: 1.07, 1.21 and 1.84 bytes.

mod bounds;
mod build;
mod bytes;
mod cells;
mod filter;
mod lookup;
mod storage;
mod traverse;

pub use bounds::Bounds;
pub use build::BuildError;
pub use bytes::U8Bricks;
pub use filter::Filter;
pub use lookup::Cell;
pub use storage::{BrickValues, Bricks, F16Bricks, F32Bricks, Storage};
pub use traverse::Segment;

use bounds::Entry;
use glam::DVec3;

/// A scalar field on a sparse grid, with bounds; see the module head.
#[derive(Debug, Clone)]
pub struct BrickGrid {
    /// Voxel of the least corner of the top table.
    origin: [i32; 3],
    /// Top cells along each axis.
    top_dimensions: [u32; 3],
    /// Base-2 logarithm of the edge of a top cell in voxels: 5, 7, 9, …
    top_shift: u32,
    /// The top table, x slowest, followed by the nodes of 64 cells each.
    entries: Vec<Entry>,
    /// Values of constant cells.
    constants: Vec<f32>,
    bricks: Bricks,
    filter: Filter,
    /// Where the field may differ from the background, in index coordinates.
    domain: [DVec3; 2],
    background: f32,
    /// Bounds of the filtered field over the domain.
    bounds: Bounds,
    non_finite: u64,
}

impl BrickGrid {
    /// Least and greatest corner, in the coordinates of the filter, of the region that rays need to look at.
    ///
    /// With background 0 this is the box of active voxels and one voxel around it, where the filtered field fades
    /// out. With another background, which would fill all space, the field is cut at the faces of the active
    /// voxels, as is one without a filter.
    pub fn domain(&self) -> [DVec3; 2] {
        self.domain
    }

    /// Value of voxels outside the tree.
    pub fn background(&self) -> f32 {
        self.background
    }

    /// Least and greatest filtered value in the domain (rounded outwards to bfloat16).
    pub fn bounds(&self) -> Bounds {
        self.bounds
    }

    /// Number of values that were NaN or infinite in the file and are 0 here.
    pub fn non_finite(&self) -> u64 {
        self.non_finite
    }

    /// The bricks, for kernels that are compiled for one storage.
    pub fn bricks(&self) -> &Bricks {
        &self.bricks
    }

    /// Number of bricks.
    pub fn brick_count(&self) -> usize {
        self.bricks.count()
    }

    /// Bytes of the whole structure.
    pub fn memory_bytes(&self) -> usize {
        self.bricks.memory_bytes()
            + std::mem::size_of_val(&self.entries[..])
            + std::mem::size_of_val(&self.constants[..])
    }
}
