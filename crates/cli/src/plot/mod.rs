//! Charts as SVG files, which any browser shows: curves over axes with linear or logarithmic scales, and polar ones.
//!
//! A chart is drawn from its parts: [`Svg`] is the sheet, a [`Scale`] turns numbers into places on it, [`Axes`] and
//! [`Polar`] are frames that take curves, [`legend()`] says which is which.

mod axes;
mod bars;
mod legend;
mod polar;
mod scale;
mod svg;

pub use axes::Axes;
pub use bars::{Bar, Bars};
pub use legend::{COLOURS, Look, legend, styled_legend};
pub use polar::Polar;
pub use scale::{Kind, Scale};
pub use svg::{Anchor, Svg, escaped};
