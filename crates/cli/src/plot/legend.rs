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
