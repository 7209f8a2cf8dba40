//! A rectangular frame with two scales, and curves in it.

use super::{Anchor, Kind, Scale, Svg};

/// A frame that takes curves.
pub struct Axes {
    x: Scale,
    y: Scale,
    /// Left, top, right, bottom, in pixels.
    frame: [f64; 4],
}

impl Axes {
    /// A frame between `left`, `top`, `right`, `bottom`: `x` from the first to the second number, linear, `y` of a kind
    /// around `values`.
    pub fn new(frame: [f64; 4], x: [f64; 2], kind: Kind, values: impl Iterator<Item = f64>) -> Axes {
        let [left, top, right, bottom] = frame;
        let x = Scale::new(Kind::Linear, x, [left, right]);
        Axes { x, y: Scale::around(kind, values, [bottom, top]), frame }
    }

    /// Draws the frame, with grid, ticks and names; `x_step` between the ticks of x, if they are not to be chosen.
    pub fn draw(&self, svg: &mut Svg, x_name: &str, x_step: Option<f64>, y_name: &str) {
        let [left, top, right, bottom] = self.frame;
        for tick in self.x.ticks(x_step) {
            svg.line("grid", [tick.pixel, top], [tick.pixel, bottom]);
            svg.line("tick", [tick.pixel, bottom], [tick.pixel, bottom + 4.0]);
            svg.text("small", Anchor::Middle, [tick.pixel, bottom + 17.0], &tick.label);
        }
        for tick in self.y.ticks(None) {
            let length = if tick.label.is_empty() { 2.0 } else { 4.0 };
            if !tick.label.is_empty() {
                svg.line("grid", [left, tick.pixel], [right, tick.pixel]);
            }
            svg.line("tick", [left - length, tick.pixel], [left, tick.pixel]);
            svg.text("small", Anchor::End, [left - 7.0, tick.pixel + 4.0], &tick.label);
        }
        svg.rectangle("frame", [left, top], [right, bottom]);
        svg.text("", Anchor::Middle, [0.5 * (left + right), bottom + 36.0], x_name);
        let beside = [left - 46.0, 0.5 * (top + bottom)];
        svg.turned_text("", Anchor::Middle, beside, -90.0, y_name);
    }

    /// Draws a curve; points that have no place on the scales are left out.
    pub fn curve(&self, svg: &mut Svg, colour: &str, points: impl Iterator<Item = (f64, f64)>) {
        svg.curve(colour, points.map(|(x, y)| Some([self.x.at(x)?, self.y.at(y)?])));
    }
}
