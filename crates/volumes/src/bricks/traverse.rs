//! A ray through the grid as segments between bounds.

use super::{Bounds, BrickGrid};
use glam::DVec3;
use std::ops::ControlFlow;

/// A stretch of a ray inside one cell.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Segment {
    /// Parameter of the ray where the stretch starts.
    pub start: f64,
    /// Parameter where it ends.
    pub end: f64,
    /// Bounds of the filtered field along it.
    pub bounds: Bounds,
}

impl BrickGrid {
    /// Calls `visit` with each segment of the ray `origin + t·direction` (the filter's coordinates, any length of
    /// `direction`) for `t` in [start, end], in order and without gaps inside the grid's domain, until `visit`
    /// breaks.
    ///
    /// Large constant cells are single segments, so empty space costs a step for each 32 voxels or more.
    pub fn segments<B>(
        &self,
        origin: DVec3,
        direction: DVec3,
        (start, end): (f64, f64),
        mut visit: impl FnMut(Segment) -> ControlFlow<B>,
    ) -> ControlFlow<B> {
        let inverse = direction.recip();
        let Some((start, end)) = clip(self.domain, origin, inverse, (start, end)) else {
            return ControlFlow::Continue(());
        };
        let table = DVec3::new(self.origin[0].into(), self.origin[1].into(), self.origin[2].into());
        // A point this little further along each axis, in voxels, decides which cell comes next. Further along the
        // ray instead, one that runs nearly in the plane of a face would not get across it and crawl.
        let nudge = 1e-9_f64.max(4.0 * f64::EPSILON * (self.domain[1] - table).max_element());
        let least_step = nudge / direction.abs().max_element();
        // A ray from so far away that steps are lost in the rounding of `t`, and it would stand still, begins anew where it
        // comes in.
        let is_far = 4.0 * f64::EPSILON * start.abs().max(end.abs()) > least_step;
        let base = if is_far { start } else { 0.0 };
        let origin = origin + direction * base;
        let range = (start - base, end - base);
        let inside = if is_far { clip(self.domain, origin, inverse, range) } else { Some(range) };
        let Some((mut t, end)) = inside else {
            return ControlFlow::Continue(());
        };
        let local_origin = origin - table;
        let ahead = local_origin + direction.signum() * nudge;
        while t < end {
            let voxel = (ahead + direction * t).max(DVec3::ZERO).as_uvec3().to_array();
            let cell = self.cell(voxel);
            let edge = f64::from(1_u32 << cell.shift);
            let mut exit = end;
            for axis in 0..3 {
                let far = f64::from(cell.corner[axis]) + if direction[axis] > 0.0 { edge } else { 0.0 };
                if direction[axis] != 0.0 {
                    exit = exit.min((far - local_origin[axis]) * inverse[axis]);
                }
            }
            let exit = exit.max(t + least_step).min(end);
            let segment = Segment { start: base + t, end: base + exit, bounds: self.cell_bounds(voxel) };
            if segment.start < segment.end {
                visit(segment)?;
            }
            t = exit;
        }
        ControlFlow::Continue(())
    }
}

/// The part of `range` in which the ray is inside the box (slab method), if any.
fn clip(corners: [DVec3; 2], origin: DVec3, inverse: DVec3, range: (f64, f64)) -> Option<(f64, f64)> {
    let (mut start, mut end) = range;
    for axis in 0..3 {
        let (low, high) = (corners[0][axis], corners[1][axis]);
        if inverse[axis].is_infinite() {
            if origin[axis] < low || origin[axis] > high {
                return None;
            }
            continue;
        }
        let a = (low - origin[axis]) * inverse[axis];
        let b = (high - origin[axis]) * inverse[axis];
        start = start.max(a.min(b));
        end = end.min(a.max(b));
    }
    (start < end).then_some((start, end))
}
