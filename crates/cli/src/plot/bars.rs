//! Horizontal bars on a logarithmic scale, several to a row: how names compare in several cases.

use super::{Anchor, Kind, Scale, Svg};

/// What a bar shows.
#[derive(Debug, Clone, PartialEq)]
pub enum Bar {
    /// A number above 0.
    Number(f64),
    /// Words in place of a bar.
    Words(&'static str),
}

/// Rows of bars.
pub struct Bars {
    scale: Scale,
    /// Left, top and right of the bars, in pixels.
    frame: [f64; 3],
    per_row: usize,
}

/// Height of a bar, and space below a row.
const HEIGHT: f64 = 7.0;
const SPACE: f64 = 6.0;

impl Bars {
    /// A frame between `left`, `top` and `right` for rows of `per_row` bars.
    pub fn new(frame: [f64; 3], per_row: usize, numbers: impl Iterator<Item = f64>) -> Bars {
        let [left, _, right] = frame;
        Bars { scale: Scale::around(Kind::Log, numbers, [left, right]), frame, per_row }
    }

    fn row_height(&self) -> f64 {
        (HEIGHT * self.per_row as f64).max(11.0) + SPACE
    }

    /// Height of so many rows, with the axis below them.
    pub fn height(&self, rows: usize) -> f64 {
        SPACE + rows as f64 * self.row_height() + 42.0
    }

    /// Draws names and bars, bar by bar in the given colours, and the axis.
    pub fn draw(&self, svg: &mut Svg, x_name: &str, colours: &[&str], rows: &[(String, Vec<Bar>)]) {
        let [left, top, right] = self.frame;
        let bottom = top + SPACE + rows.len() as f64 * self.row_height();
        for tick in self.scale.ticks(None) {
            let is_major = !tick.label.is_empty();
            if is_major {
                svg.line("grid", [tick.pixel, top], [tick.pixel, bottom]);
            }
            let length = if is_major { 4.0 } else { 2.0 };
            svg.line("tick", [tick.pixel, bottom], [tick.pixel, bottom + length]);
            svg.text("small", Anchor::Middle, [tick.pixel, bottom + 17.0], &tick.label);
        }
        for (row, (name, bars)) in rows.iter().enumerate() {
            let y = top + SPACE + row as f64 * self.row_height();
            let middle = y + 0.5 * (self.row_height() - SPACE);
            svg.text("", Anchor::End, [left - 8.0, middle + 4.5], name);
            self.draw_row(svg, y, middle, colours, bars);
        }
        svg.rectangle("frame", [left, top], [right, bottom]);
        svg.text("", Anchor::Middle, [0.5 * (left + right), bottom + 36.0], x_name);
    }

    fn draw_row(&self, svg: &mut Svg, y: f64, middle: f64, colours: &[&str], bars: &[Bar]) {
        let left = self.frame[0];
        // The same words for all of a row are said once.
        if let [Bar::Words(words), others @ ..] = bars
            && others.iter().all(|bar| *bar == bars[0])
        {
            svg.text("small", Anchor::Start, [left + 6.0, middle + 4.0], words);
            return;
        }
        for (number, (bar, colour)) in bars.iter().zip(colours.iter().cycle()).enumerate() {
            let top = y + HEIGHT * number as f64;
            match bar {
                Bar::Number(value) => {
                    if let Some(end) = self.scale.at(*value) {
                        svg.bar(colour, [left, top], [end.max(left + 1.0), top + HEIGHT - 1.0]);
                    }
                }
                Bar::Words(words) => svg.text("tiny", Anchor::Start, [left + 6.0, top + HEIGHT - 0.5], words),
            }
        }
    }
}
