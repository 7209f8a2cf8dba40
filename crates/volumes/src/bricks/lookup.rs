//! Looking a value up: the cell of a point, one voxel, the trilinear mixture of eight.

use super::bounds::{Bounds, Entry, KIND_BRICK, KIND_NODE};
use super::storage::BrickValues;
use super::{BrickGrid, Bricks};
use glam::DVec3;

/// The cell of the grid that a point lies in: a cube with bounds of the filtered field inside.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Cell {
    /// Local voxel coordinates of the least corner.
    pub corner: [u32; 3],
    /// Base-2 logarithm of the edge in voxels.
    pub shift: u32,
    /// Greatest filtered value inside.
    pub max: f32,
}

impl BrickGrid {
    /// Voxel of the least corner of the table; local coordinates are index coordinates less this.
    #[inline]
    pub fn origin(&self) -> [i32; 3] {
        self.origin
    }

    /// The smallest cell around the local voxel `p`; points outside the table give the nearest cell inside.
    #[inline(always)]
    fn entry(&self, p: [u32; 3]) -> (Entry, u32) {
        let mut shift = self.top_shift;
        let along = |axis: usize| (p[axis] >> shift).min(self.top_dimensions[axis] - 1);
        let top = (along(0) * self.top_dimensions[1] + along(1)) * self.top_dimensions[2] + along(2);
        let mut entry = self.entries[top as usize];
        while entry.kind() == KIND_NODE {
            shift -= 2;
            let child = ((p[0] >> shift) & 3) << 4 | ((p[1] >> shift) & 3) << 2 | ((p[2] >> shift) & 3);
            entry = self.entries[(entry.index() + child) as usize];
        }
        (entry, shift)
    }

    /// The cell around the local voxel `p` (see [`BrickGrid::origin`]).
    #[inline(always)]
    pub fn cell(&self, p: [u32; 3]) -> Cell {
        let (entry, shift) = self.entry(p);
        // Written out: what is given to `map` may be compiled apart, and this is asked at every step of a march.
        let least = |x: u32| x >> shift << shift;
        Cell { corner: [least(p[0]), least(p[1]), least(p[2])], shift, max: entry.max() }
    }

    /// Bounds of the filtered field in the cell around the local voxel `p`.
    pub fn cell_bounds(&self, p: [u32; 3]) -> Bounds {
        self.entry(p).0.bounds()
    }

    /// Value of the local voxel `p`, for a kernel compiled for the storage `bricks` (of this grid).
    #[inline(always)]
    pub fn local_voxel<B: BrickValues>(&self, bricks: &B, p: [u32; 3]) -> f32 {
        let (entry, _) = self.entry(p);
        if entry.kind() == KIND_BRICK {
            bricks.value(entry.index(), (p[0] & 7) << 6 | (p[1] & 7) << 3 | (p[2] & 7))
        } else {
            self.constants[entry.index() as usize]
        }
    }

    /// Value of the voxel at index coordinates `index`.
    pub fn voxel(&self, index: [i32; 3]) -> f32 {
        let edge = |axis: usize| i64::from(self.top_dimensions[axis]) << self.top_shift;
        let mut local = [0; 3];
        for axis in 0..3 {
            let offset = i64::from(index[axis]) - i64::from(self.origin[axis]);
            if offset < 0 || offset >= edge(axis) {
                return self.background;
            }
            local[axis] = offset as u32;
        }
        match &self.bricks {
            Bricks::U8(bricks) => self.local_voxel(bricks, local),
            Bricks::F16(bricks) => self.local_voxel(bricks, local),
            Bricks::F32(bricks) => self.local_voxel(bricks, local),
        }
    }

    /// The field at index coordinates `p`: eight voxels mixed by their trilinear weights.
    pub(super) fn trilinear(&self, p: DVec3) -> f64 {
        let base = p.floor();
        let f = p - base;
        let i = base.as_ivec3();
        // Far off, where indices end, there is the background.
        let next = |index: i32, step| index.saturating_add(step);
        let v = |x, y, z| f64::from(self.voxel([next(i.x, x), next(i.y, y), next(i.z, z)]));
        let mix = |a: f64, b: f64, w: f64| a + (b - a) * w;
        let face = |x| mix(mix(v(x, 0, 0), v(x, 0, 1), f.z), mix(v(x, 1, 0), v(x, 1, 1), f.z), f.y);
        mix(face(0), face(1), f.x)
    }
}
