//! Points with error bars, for charts.

use crate::plot::{Axes, Svg};

/// Half of the width of a mark, pixels.
const HALF: f64 = 4.0;

/// A cross at a point.
pub fn cross(svg: &mut Svg, axes: &Axes, colour: &str, point: (f64, f64)) {
    let Some([x, y]) = axes.at(point) else { return };
    for (dx, dy) in [(HALF, HALF), (HALF, -HALF)] {
        svg.curve(colour, [Some([x - dx, y - dy]), Some([x + dx, y + dy])]);
    }
}

/// A bar from `error` below a point to `error` above it, with the point as its cross-line.
pub fn error_bar(svg: &mut Svg, axes: &Axes, colour: &str, (x, y): (f64, f64), error: f64) {
    let ends = [(x, y - error), (x, y + error)].map(|end| axes.at(end));
    svg.curve(colour, ends);
    if let Some([x, y]) = axes.at((x, y)) {
        svg.curve(colour, [Some([x - HALF, y]), Some([x + HALF, y])]);
    }
}
