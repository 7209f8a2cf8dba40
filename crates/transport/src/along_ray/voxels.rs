//! A ray cut at the planes between which a filtered grid is smooth.
//!
//! Regular tracking's walk (Amanatides & Woo 1987, "A fast voxel traversal algorithm for ray tracing"), with plane
//! positions computed afresh at each step, so that errors do not add up.

use std::ops::ControlFlow;

use tyndall_scene::Ray;

/// Visits the intervals of [start, end] between crossings of the planes at whole numbers: planes of voxel centres in the
/// coordinates of the trilinear filter, faces between voxels in those without a filter.
pub(super) fn voxel_intervals<B>(
    local: &Ray,
    (start, end): (f64, f64),
    visit: &mut impl FnMut(f64, f64) -> ControlFlow<B>,
) -> ControlFlow<B> {
    // From so far away that planes cannot be told apart, nor can what lies between them.
    let rounding = 4.0 * f64::EPSILON * start.abs().max(end.abs());
    if rounding * local.direction.abs().max_element() >= 1.0 {
        return visit(start, end);
    }
    let at_start = local.at(start);
    let mut planes = [0.0; 3];
    let mut crossings = [f64::INFINITY; 3];
    let crossing = |axis: usize, plane: f64| (plane - local.origin[axis]) / local.direction[axis];
    for axis in 0..3 {
        let direction = local.direction[axis];
        if direction != 0.0 {
            let at = at_start[axis];
            planes[axis] = if direction > 0.0 { at.floor() + 1.0 } else { at.ceil() - 1.0 };
            crossings[axis] = crossing(axis, planes[axis]);
        }
    }
    let mut a = start;
    while a < end {
        let b = crossings.into_iter().fold(end, f64::min);
        if b > a {
            visit(a, b)?;
            a = b;
        }
        for axis in 0..3 {
            if crossings[axis] <= b {
                planes[axis] += local.direction[axis].signum();
                crossings[axis] = crossing(axis, planes[axis]);
            }
        }
    }
    ControlFlow::Continue(())
}
