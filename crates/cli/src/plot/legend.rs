//! Colours of curves, and the list that says which is which.

use super::{Anchor, Svg};

/// Colours that also differ for people who see fewer (Okabe & Ito 2008), without the yellow, which is faint on white.
pub const COLOURS: [&str; 7] = ["#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#000000"];

/// Lists names with the colours of their curves, downwards from `place`; later names go round the colours again.
pub fn legend<'a>(svg: &mut Svg, [x, y]: [f64; 2], names: impl Iterator<Item = &'a str>) {
    for (line, (name, colour)) in names.zip(COLOURS.iter().cycle()).enumerate() {
        let y = y + 18.0 * line as f64;
        svg.curve(colour, [Some([x, y - 4.0]), Some([x + 24.0, y - 4.0])]);
        svg.text("", Anchor::Start, [x + 32.0, y], name);
    }
}

/// How a curve looks among many: after all colours they come again with other strokes.
#[derive(Debug, Clone, Copy)]
pub struct Look {
    /// Colour of the stroke.
    pub colour: &'static str,
    /// Its dashes, as an attribute of SVG.
    pub dashes: &'static str,
    /// Whether its dots are filled.
    pub filled: bool,
}

impl Look {
    /// The look of the curve of this number.
    pub fn of(number: usize) -> Look {
        let round = number / COLOURS.len();
        let dashes = ["", "stroke-dasharray=\"6 3\"", "stroke-dasharray=\"2 3\""][round % 3];
        Look { colour: COLOURS[number % COLOURS.len()], dashes, filled: round == 0 }
    }
}

/// Lists names with the looks of their curves, downwards from a place.
pub fn styled_legend<'a>(svg: &mut Svg, [x, y]: [f64; 2], names: impl Iterator<Item = (&'a str, Look)>) {
    for (line, (name, look)) in names.enumerate() {
        let y = y + 18.0 * line as f64;
        svg.styled_curve(look.colour, look.dashes, [Some([x, y - 4.0]), Some([x + 28.0, y - 4.0])]);
        svg.dot(look.colour, look.filled, [x + 14.0, y - 4.0], 3.2);
        svg.text("", Anchor::Start, [x + 36.0, y], name);
    }
}
