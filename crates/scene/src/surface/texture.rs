//! Quantities from 0 to 1 that vary over a surface: constants, pictures, checkerboards.
//!
//! Texture coordinates (u, v) are multiplied by `scale` and moved by `offset`. A picture's left lower corner is at (0, 0) and
//! its right upper one at (1, 1); the centre of texel (i, j) of an n × m picture is at ((i + ½)/n, 1 − (j + ½)/m).
//! Colours become spectra as [`Spectrum::Rgb`] does, so that white light on them looks as the picture does.

use std::sync::Arc;

use glam::{DVec3, DVec4};
use tyndall_optics::{Spectrum, uplift};

use super::picture::Picture;
use crate::Channels;
use crate::description::{ImageFilter, TextureWrap};

/// A quantity over a surface.
#[derive(Debug, Clone, PartialEq)]
pub enum Texture {
    /// The same everywhere.
    Constant(Colour),
    /// A picture.
    Image(ImageLookup),
    /// Two values in turns.
    Checker {
        /// That of the square from (0, 0) to (1, 1), and the other.
        colours: Box<[Colour; 2]>,
        /// Where the squares are.
        placement: Placement,
    },
}

/// A spectrum, and its red, green and blue, at hand for every ray.
#[derive(Debug, Clone, PartialEq)]
pub struct Colour {
    spectrum: Spectrum,
    rgb: DVec3,
}

/// What texture coordinates are multiplied by and moved by.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Placement {
    /// Factors.
    pub scale: [f64; 2],
    /// Added afterwards.
    pub offset: [f64; 2],
}

/// A picture, and how it lies on the surface.
#[derive(Debug, Clone, PartialEq)]
pub struct ImageLookup {
    /// The picture, which other textures may share.
    pub picture: Arc<Picture>,
    /// Where it lies.
    pub placement: Placement,
    /// How values between the centres of texels are found.
    pub filter: ImageFilter,
    /// What lies beyond it.
    pub wrap: TextureWrap,
    /// Factor on its values; above 1 they are 1.
    pub factor: f64,
}

impl Texture {
    /// The value at texture coordinates in each channel; 0 in lanes that are none.
    pub fn at(&self, uv: [f64; 2], channels: &Channels) -> DVec4 {
        match self {
            Self::Constant(colour) => colour.in_channels(channels),
            Self::Image(image) => uplifted(image.at(uv), channels),
            Self::Checker { colours, placement } => {
                let [u, v] = placement.of(uv);
                let is_second = (u.floor() + v.floor()).rem_euclid(2.0) == 1.0;
                colours[usize::from(is_second)].in_channels(channels)
            }
        }
    }

    /// The mean of red, green and blue at texture coordinates.
    pub fn grey_at(&self, uv: [f64; 2]) -> f64 {
        self.at(uv, &Channels::Rgb).element_sum() / 3.0
    }
}

impl Colour {
    /// A spectrum of any values.
    pub fn new(spectrum: Spectrum) -> Colour {
        Colour { rgb: spectrum.rgb(), spectrum }
    }

    /// A spectrum of values from 0 to 1. A colour that a screen cannot show would have more than 1 of a primary, and send
    /// out more light than it receives: it has 1.
    pub fn fraction(spectrum: Spectrum) -> Colour {
        Colour { rgb: spectrum.rgb().min(DVec3::ONE), spectrum }
    }

    /// The value in each channel; 0 in lanes that are none.
    pub fn in_channels(&self, channels: &Channels) -> DVec4 {
        match channels {
            Channels::Rgb => self.rgb.extend(0.0),
            Channels::Wavelengths(nm) => DVec4::from_array(nm.map(|nm| self.spectrum.at(nm))),
        }
    }
}

fn uplifted(rgb: DVec3, channels: &Channels) -> DVec4 {
    match channels {
        Channels::Rgb => rgb.extend(0.0),
        Channels::Wavelengths(nm) => DVec4::from_array(nm.map(|nm| rgb.dot(uplift::basis(nm)))),
    }
}

impl Placement {
    fn of(&self, uv: [f64; 2]) -> [f64; 2] {
        [0, 1].map(|axis| uv[axis] * self.scale[axis] + self.offset[axis])
    }
}

impl ImageLookup {
    fn at(&self, uv: [f64; 2]) -> DVec3 {
        let [u, v] = self.placement.of(uv);
        let (width, height) = (self.picture.width(), self.picture.height());
        // In texels, from the middle of the first of the bottom row.
        let (x, y) = (u * width as f64 - 0.5, v * height as f64 - 0.5);
        let texel = |column: f64, row: f64| {
            let row_from_top = height - 1 - self.inside(row, height);
            self.picture.texel(self.inside(column, width), row_from_top)
        };
        let value = match self.filter {
            ImageFilter::Nearest => texel((x + 0.5).floor(), (y + 0.5).floor()),
            ImageFilter::Bilinear => {
                let (left, bottom) = (x.floor(), y.floor());
                let (x, y) = (x - left, y - bottom);
                let lower = texel(left, bottom).lerp(texel(left + 1.0, bottom), x);
                lower.lerp(texel(left, bottom + 1.0).lerp(texel(left + 1.0, bottom + 1.0), x), y)
            }
        };
        (value * self.factor).min(DVec3::ONE)
    }

    /// The column or row of the picture that stands at a place which may be beyond.
    fn inside(&self, place: f64, count: usize) -> usize {
        let n = count as f64;
        let place = match self.wrap {
            TextureWrap::Repeat => place.rem_euclid(n),
            TextureWrap::Clamp => place,
            TextureWrap::Mirror => {
                let place = place.rem_euclid(2.0 * n);
                place.min(2.0 * n - 1.0 - place)
            }
        };
        // The cast takes what is no number as 0.
        (place.max(0.0) as usize).min(count - 1)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const PLAIN: Placement = Placement { scale: [1.0, 1.0], offset: [0.0, 0.0] };

    /// Two columns and rows: 0.1 0.2 above 0.3 0.4.
    fn image(filter: ImageFilter, wrap: TextureWrap) -> Texture {
        let texels = [0.1, 0.2, 0.3, 0.4].map(|value| [value; 3]);
        let picture = Arc::new(Picture::linear(2, 2, texels.to_vec()));
        Texture::Image(ImageLookup { picture, placement: PLAIN, filter, wrap, factor: 1.0 })
    }

    fn value(texture: &Texture, uv: [f64; 2]) -> f64 {
        texture.at(uv, &Channels::Rgb).x
    }

    #[test]
    fn a_picture_stands_upright() {
        let texture = image(ImageFilter::Nearest, TextureWrap::Repeat);
        for (uv, expected) in
            [([0.1, 0.9], 0.1), ([0.9, 0.9], 0.2), ([0.1, 0.1], 0.3), ([0.9, 0.1], 0.4), ([0.0, 0.0], 0.3)]
        {
            assert!((value(&texture, uv) - expected).abs() < 1e-7, "{uv:?}");
        }
    }

    #[test]
    fn the_bilinear_filter_meets_the_centres_and_is_linear_between() {
        let texture = image(ImageFilter::Bilinear, TextureWrap::Clamp);
        for (uv, expected) in [
            ([0.25, 0.75], 0.1),
            ([0.75, 0.25], 0.4),
            ([0.5, 0.5], 0.25),
            ([0.5, 0.75], 0.15),
            ([0.0, 1.0], 0.1),
        ] {
            assert!((value(&texture, uv) - expected).abs() < 1e-7, "{uv:?}");
        }
    }

    #[test]
    fn beyond_its_border_a_picture_goes_on_as_asked() {
        let at = |wrap, uv| value(&image(ImageFilter::Nearest, wrap), uv);
        for (wrap, left, right) in
            [(TextureWrap::Repeat, 0.2, 0.1), (TextureWrap::Clamp, 0.1, 0.2), (TextureWrap::Mirror, 0.1, 0.2)]
        {
            assert!((at(wrap, [-0.2, 0.9]) - left).abs() < 1e-7, "{wrap:?}");
            assert!((at(wrap, [1.2, 0.9]) - right).abs() < 1e-7, "{wrap:?}");
        }
        // Two pictures on, a mirrored one is as it was.
        assert!((at(TextureWrap::Mirror, [1.9, 0.9]) - 0.1).abs() < 1e-7);
        for wrap in [TextureWrap::Repeat, TextureWrap::Clamp, TextureWrap::Mirror] {
            for uv in [[f64::NAN, 0.5], [f64::INFINITY, -f64::INFINITY], [1e300, -1e300], [-1e-17, -1e-17]] {
                assert!(at(wrap, uv) > 0.0, "{wrap:?} {uv:?}");
            }
        }
    }

    #[test]
    fn squares_of_a_checkerboard_alternate() {
        let colours = Box::new([0.2, 0.7].map(|value| Colour::new(Spectrum::Constant(value))));
        let placement = Placement { scale: [2.0, 2.0], offset: [0.0, 0.0] };
        let texture = Texture::Checker { colours, placement };
        for (uv, expected) in [([0.1, 0.1], 0.2), ([0.6, 0.1], 0.7), ([0.6, 0.6], 0.2), ([-0.1, 0.1], 0.7)] {
            assert_eq!(value(&texture, uv), expected, "{uv:?}");
        }
    }

    #[test]
    fn wavelengths_see_a_spectrum_of_the_pictures_colour() {
        let picture = Arc::new(Picture::linear(1, 1, vec![[0.9, 0.5, 0.1]]));
        let (filter, wrap) = (ImageFilter::Nearest, TextureWrap::Repeat);
        let texture = Texture::Image(ImageLookup { picture, placement: PLAIN, filter, wrap, factor: 1.0 });
        let nm = [420.0, 510.0, 590.0, 680.0];
        let colour = Colour::new(Spectrum::Rgb(texture.at([0.5; 2], &Channels::Rgb).truncate()));
        let channels = Channels::Wavelengths(nm);
        assert_eq!(texture.at([0.5; 2], &channels), colour.in_channels(&channels));
    }
}
