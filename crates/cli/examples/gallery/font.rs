//! Captions in a bitmap font that has Greek letters.

use std::convert::Infallible;

use embedded_graphics::Drawable;
use embedded_graphics::Pixel;
use embedded_graphics::draw_target::DrawTarget;
use embedded_graphics::geometry::{OriginDimensions, Point, Size};
use embedded_graphics::mono_font::MonoTextStyle;
use embedded_graphics::mono_font::iso_8859_7::FONT_9X15;
use embedded_graphics::pixelcolor::BinaryColor;
use embedded_graphics::text::{Baseline, Text};

use crate::compose::Page;

/// Nearly black.
const INK: [u8; 3] = [32, 32, 32];

/// Writes a line with its left upper corner at `corner`.
pub fn draw(page: &mut Page, corner: [usize; 2], line: &str) {
    let style = MonoTextStyle::new(&FONT_9X15, BinaryColor::On);
    let place = Point::new(corner[0] as i32, corner[1] as i32);
    let Ok(_) = Text::with_baseline(line, place, style, Baseline::Top).draw(&mut Paper(page));
}

/// The page as the font's author wants it.
struct Paper<'a>(&'a mut Page);

impl OriginDimensions for Paper<'_> {
    fn size(&self) -> Size {
        Size::new(u32::MAX, u32::MAX)
    }
}

impl DrawTarget for Paper<'_> {
    type Color = BinaryColor;
    type Error = Infallible;

    fn draw_iter<I: IntoIterator<Item = Pixel<BinaryColor>>>(&mut self, pixels: I) -> Result<(), Infallible> {
        for Pixel(place, colour) in pixels {
            if let (BinaryColor::On, Ok(x), Ok(y)) = (colour, place.x.try_into(), place.y.try_into()) {
                self.0.set([x, y], INK);
            }
        }
        Ok(())
    }
}
