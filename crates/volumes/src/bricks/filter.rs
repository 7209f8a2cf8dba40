//! How a field comes about between the centres of voxels.

use super::BrickGrid;
use glam::DVec3;

/// How a field comes about between the centres of voxels.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Filter {
    /// The mixture of the eight voxels around a point. Coordinates are the index coordinates.
    #[default]
    Trilinear,
    /// The voxel that a point lies in: a field constant in each voxel. Coordinates are the index coordinates plus a
    /// half, so that voxel `b` fills [b, b + 1)³.
    Nearest,
}

impl Filter {
    /// What is added to index coordinates to give the coordinates that the grid is looked up in.
    pub fn offset(self) -> f64 {
        match self {
            Filter::Trilinear => 0.0,
            Filter::Nearest => 0.5,
        }
    }

    /// Index coordinates from the outermost active voxels to the faces of the domain.
    pub(super) fn margin(self, background: f32) -> f64 {
        match self {
            Filter::Trilinear if background == 0.0 => 1.0,
            Filter::Trilinear | Filter::Nearest => 0.5,
        }
    }
}

impl BrickGrid {
    /// The same values under another filter; coordinates of lookups change with it (see [`Filter`]).
    #[must_use]
    pub fn with_filter(mut self, filter: Filter) -> BrickGrid {
        let shift =
            |filter: Filter, sign: f64| DVec3::splat(filter.offset() + sign * filter.margin(self.background));
        let is_empty = self.domain[0] == self.domain[1];
        if !is_empty {
            for (corner, sign) in self.domain.iter_mut().zip([-1.0, 1.0]) {
                *corner += shift(filter, sign) - shift(self.filter, sign);
            }
        }
        self.filter = filter;
        self
    }

    /// The filter of this grid.
    pub fn filter(&self) -> Filter {
        self.filter
    }

    /// The filtered field at `p`, in the coordinates of the filter.
    #[inline]
    pub fn value(&self, p: DVec3) -> f64 {
        match self.filter {
            Filter::Trilinear => self.trilinear(p),
            Filter::Nearest => f64::from(self.voxel(p.floor().as_ivec3().to_array())),
        }
    }
}
