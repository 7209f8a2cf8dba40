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
        Axes::with_scales(frame, x, Scale::around(kind, values, [bottom, top]))
    }

    /// A frame with two scales that fit it.
    pub fn with_scales(frame: [f64; 4], x: Scale, y: Scale) -> Axes {
        Axes { x, y, frame }
    }

    /// A frame between `left`, `top`, `right`, `bottom` with scales of a kind around the values of both.
    pub fn around(
        frame: [f64; 4],
        (x_kind, x_values): (Kind, impl Iterator<Item = f64>),
        (y_kind, y_values): (Kind, impl Iterator<Item = f64>),
    ) -> Axes {
        let [left, top, right, bottom] = frame;
        let x = Scale::around(x_kind, x_values, [left, right]);
        Axes::with_scales(frame, x, Scale::around(y_kind, y_values, [bottom, top]))
    }

    /// Draws the frame, with grid, ticks and names; `x_step` between the ticks of x, if they are not to be chosen.
    pub fn draw(&self, svg: &mut Svg, x_name: &str, x_step: Option<f64>, y_name: &str) {
        let [left, top, right, bottom] = self.frame;
        for tick in self.x.ticks(x_step) {
            let length = if tick.label.is_empty() { 2.0 } else { 4.0 };
            if !tick.label.is_empty() {
                svg.line("grid", [tick.pixel, top], [tick.pixel, bottom]);
            }
            svg.line("tick", [tick.pixel, bottom], [tick.pixel, bottom + length]);
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
        self.styled_curve(svg, colour, "", points);
    }

    /// The same with more attributes of SVG.
    pub fn styled_curve(
        &self,
        svg: &mut Svg,
        colour: &str,
        attributes: &str,
        points: impl Iterator<Item = (f64, f64)>,
    ) {
        svg.styled_curve(colour, attributes, points.map(|(x, y)| self.place(x, y)));
    }

    /// Draws a dot, if its place is in the frame.
    pub fn dot(&self, svg: &mut Svg, colour: &str, filled: bool, (x, y): (f64, f64)) {
        if let Some(place) = self.place(x, y) {
            svg.dot(colour, filled, place, 3.2);
        }
    }

    /// Draws an error bar from `low` to `high`, cut at the lower end of the frame.
    pub fn error_bar(&self, svg: &mut Svg, colour: &str, x: f64, [low, high]: [f64; 2]) {
        let Some([x, top]) = self.place(x, high) else { return };
        let bottom = self.y.at(low).unwrap_or(self.frame[3]);
        svg.styled_curve(colour, "stroke-width=\"1\"", [Some([x, top]), Some([x, bottom])]);
    }

    /// The place of a point, if it has one.
    pub fn place(&self, x: f64, y: f64) -> Option<[f64; 2]> {
        Some([self.x.at(x)?, self.y.at(y)?])
    }
}
