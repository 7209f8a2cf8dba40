//! Panels side by side on white paper, each with its caption, as one PNG.

use std::error::Error;
use std::path::Path;

use tyndall_film::write_atomically;

use crate::font;
use crate::layers::Image;

/// White between panels and around them, pixels.
const GAP: usize = 8;
/// Room for a line of caption.
const LINE: usize = 20;

/// Writes the panels row by row.
pub fn write(file: &Path, columns: usize, panels: &[Image]) -> Result<(), Box<dyn Error>> {
    let page = compose(columns, panels);
    write_atomically(file, |out| {
        let mut encoder = png::Encoder::new(out, page.size[0] as u32, page.size[1] as u32);
        encoder.set_color(png::ColorType::Rgb);
        encoder.set_depth(png::BitDepth::Eight);
        encoder.set_source_srgb(png::SrgbRenderingIntent::Perceptual);
        encoder.set_compression(png::Compression::High);
        let mut writer = encoder.write_header()?;
        writer.write_image_data(page.pixels.as_flattened())?;
        Ok(writer.finish()?)
    })?;
    Ok(())
}

fn compose(columns: usize, panels: &[Image]) -> Page {
    let cell = [0, 1].map(|axis| panels.iter().map(|panel| panel.size[axis]).max().unwrap_or(0));
    let rows = panels.len().div_ceil(columns);
    let mut page = Page::white([GAP + columns * (cell[0] + GAP), GAP + rows * (cell[1] + LINE + GAP)]);
    for (index, panel) in panels.iter().enumerate() {
        let corner =
            [GAP + index % columns * (cell[0] + GAP), GAP + index / columns * (cell[1] + LINE + GAP)];
        page.paste(corner, panel);
        font::draw(&mut page, [corner[0], corner[1] + panel.size[1] + 3], panel.caption);
    }
    page
}

/// A picture in the making, 8-bit sRGB.
pub struct Page {
    size: [usize; 2],
    pixels: Vec<[u8; 3]>,
}

impl Page {
    fn white(size: [usize; 2]) -> Page {
        Page { size, pixels: vec![[255; 3]; size[0] * size[1]] }
    }

    fn paste(&mut self, corner: [usize; 2], image: &Image) {
        for (y, row) in image.pixels.chunks_exact(image.size[0]).enumerate() {
            let start = (corner[1] + y) * self.size[0] + corner[0];
            self.pixels[start..start + image.size[0]].copy_from_slice(row);
        }
    }

    /// Sets a pixel; outside the page nothing happens.
    pub fn set(&mut self, [x, y]: [usize; 2], colour: [u8; 3]) {
        if x < self.size[0] && y < self.size[1] {
            self.pixels[y * self.size[0] + x] = colour;
        }
    }
}
