//! Textures: pictures and checkerboards.
//!
//! Mitsuba's v runs downwards over a picture: (0, 0) is its left upper corner, and a checkerboard's squares are half a
//! unit wide. Tyndall's (0, 0) is the left lower corner, and squares are a unit wide. Some shapes turn v around when they
//! read it from a file, which Tyndall does not; what is laid on them is told so by `flipped`.

use std::path::Path;

use tyndall_scene::description::{
    CheckerTexture, ImageFilter, ImageTexture, SpectrumDescription, TextureDescription, TextureWrap,
};
use tyndall_scene::light::read_light_image;

use super::importer::Importer;
use super::object::{Class, Object, Value};
use super::spectrum::{Role, colour};
use crate::ImportError;

/// Factors on texture coordinates, and what is added afterwards.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Placement {
    scale: [f64; 2],
    offset: [f64; 2],
}

impl<'a> Importer<'a> {
    /// The texture of this name, with values from 0 to 1.
    pub fn texture(
        &mut self,
        object: &'a Object,
        name: &str,
        default: f64,
        flipped: bool,
    ) -> Result<TextureDescription, ImportError> {
        let Some(property) = object.get(name) else { return Ok(default.into()) };
        if let Value::Object(number) = property.value {
            let texture = self.object(number);
            match texture.plugin.as_str() {
                "bitmap" => return self.within(number, |importer| importer.bitmap(texture, flipped)),
                "checkerboard" => {
                    return self.within(number, |importer| importer.checkerboard(texture, flipped));
                }
                _ => {}
            }
        }
        self.spectrum_of(property, Role::Fraction).map(TextureDescription::Constant)
    }

    /// The same, none if it is not given.
    pub fn texture_if_given(
        &mut self,
        object: &'a Object,
        name: &str,
        flipped: bool,
    ) -> Result<Option<TextureDescription>, ImportError> {
        if object.get(name).is_none() {
            return Ok(None);
        }
        self.texture(object, name, 1.0, flipped).map(Some)
    }

    /// Whether an object, or one within it, has a texture.
    pub fn has_texture(&self, number: usize, depth: usize) -> bool {
        let object = self.object(number);
        let is_texture =
            object.class == Class::Texture && matches!(object.plugin.as_str(), "bitmap" | "checkerboard");
        is_texture
            || depth < 4
                && object.objects().any(|(_, inner)| inner != number && self.has_texture(inner, depth + 1))
    }

    fn bitmap(&mut self, texture: &'a Object, flipped: bool) -> Result<TextureDescription, ImportError> {
        let Some(name) = texture.text("filename")? else {
            return Err(texture.place.error("the bitmap has no `filename`: add it"));
        };
        let path = self.document.find(name, &texture.place)?;
        let extension = path.extension().and_then(|extension| extension.to_str()).unwrap_or_default();
        if !["png", "exr", "hdr", "jpg", "jpeg"].contains(&extension.to_ascii_lowercase().as_str()) {
            let message = format!(
                "pictures of the kind .{extension} are not read: 0.5 is taken; convert them to .png or .exr"
            );
            self.unsupported(&texture.place, message);
            return Ok(0.5.into());
        }
        texture.ignore(&["accel", "format"]);
        let raw = texture.boolean("raw", false)?;
        let filter = match texture.text("filter_type")? {
            Some("nearest") => ImageFilter::Nearest,
            _ => ImageFilter::Bilinear,
        };
        let wrap = match texture.text("wrap_mode")? {
            Some("clamp") => TextureWrap::Clamp,
            Some("mirror") => TextureWrap::Mirror,
            _ => TextureWrap::Repeat,
        };
        let place = self.placement(texture)?.on_picture(flipped);
        self.tell_unused(texture);
        Ok(TextureDescription::Image(ImageTexture {
            image: path.to_string_lossy().into_owned(),
            srgb: raw.then_some(false),
            filter,
            wrap,
            scale: (place.scale != [1.0; 2]).then_some(place.scale),
            offset: (place.offset != [0.0; 2]).then_some(place.offset),
            factor: None,
        }))
    }

    fn checkerboard(
        &mut self,
        texture: &'a Object,
        flipped: bool,
    ) -> Result<TextureDescription, ImportError> {
        let first = self.spectrum(texture, "color0", Role::Fraction, 0.4)?;
        let second = self.spectrum(texture, "color1", Role::Fraction, 0.2)?;
        let place = self.placement(texture)?.on_checkers(flipped);
        self.tell_unused(texture);
        Ok(TextureDescription::Checker(CheckerTexture {
            checker: [first, second],
            scale: (place.scale != [1.0; 2]).then_some(place.scale),
            offset: (place.offset != [0.0; 2]).then_some(place.offset),
        }))
    }

    /// `to_uv`, as far as it scales and moves.
    fn placement(&mut self, texture: &'a Object) -> Result<Placement, ImportError> {
        let map = texture.transform("to_uv")?.map;
        let [x, y] = [map.matrix3.x_axis, map.matrix3.y_axis];
        if x.y != 0.0 || y.x != 0.0 {
            let message =
                "a `to_uv` that turns or shears is not supported: the picture is only scaled and moved";
            self.unsupported(&texture.place, message);
        }
        Ok(Placement { scale: [x.x, y.y], offset: [map.translation.x, map.translation.y] })
    }

    /// Mean of the texels of a picture.
    pub fn mean_of_bitmap(&mut self, texture: &'a Object) -> Result<SpectrumDescription, ImportError> {
        texture.ignore(&["raw", "filter_type", "wrap_mode", "to_uv", "accel", "format"]);
        let Some(name) = texture.text("filename")? else { return Ok(0.5.into()) };
        let path = self.document.find(name, &texture.place)?;
        match mean_colour(&path) {
            Some(mean) => Ok(colour(mean)),
            None => {
                self.unsupported(
                    &texture.place,
                    "a picture that is neither .exr nor .hdr is not read here: 0.5 is taken",
                );
                Ok(0.5.into())
            }
        }
    }
}

fn mean_colour(path: &Path) -> Option<[f64; 3]> {
    let (image, _) = read_light_image(path).ok()?;
    let rows = 0..image.height();
    let texels = rows.flat_map(|row| (0..image.width()).map(move |column| (column, row)));
    let sum: glam::DVec3 = texels.map(|(column, row)| image.texel(column, row)).sum();
    Some((sum / (image.width() * image.height()) as f64).to_array())
}

impl Placement {
    /// Of a picture: its height is 1 − v.
    fn on_picture(self, flipped: bool) -> Self {
        let ([sx, sy], [ox, oy]) = (self.scale, self.offset);
        if flipped {
            Self { scale: [sx, sy], offset: [ox, 1.0 - sy - oy] }
        } else {
            Self { scale: [sx, -sy], offset: [ox, 1.0 - oy] }
        }
    }

    /// Of a checkerboard: its squares are as wide as two.
    fn on_checkers(self, flipped: bool) -> Self {
        let ([sx, sy], [ox, oy]) = (self.scale, self.offset);
        if flipped {
            Self { scale: [2.0 * sx, -2.0 * sy], offset: [2.0 * ox, 2.0 * (sy + oy)] }
        } else {
            Self { scale: [2.0 * sx, 2.0 * sy], offset: [2.0 * ox, 2.0 * oy] }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_flipped_shape_shows_the_same_texel() {
        let place = Placement { scale: [2.0, 3.0], offset: [0.25, 0.5] };
        for v in [0.0, 0.3, 1.0] {
            // Mitsuba's v of a place, of which a file of a flipped shape says 1 − v.
            let [upright, flipped] = [place.on_picture(false), place.on_picture(true)];
            let height = |place: Placement, v: f64| place.scale[1] * v + place.offset[1];
            assert!((height(upright, v) - (1.0 - (3.0 * v + 0.5))).abs() < 1e-12);
            assert!((height(flipped, 1.0 - v) - height(upright, v)).abs() < 1e-12);
            let [upright, flipped] = [place.on_checkers(false), place.on_checkers(true)];
            assert!((height(upright, v) - 2.0 * (3.0 * v + 0.5)).abs() < 1e-12);
            assert!((height(flipped, 1.0 - v) - height(upright, v)).abs() < 1e-12);
        }
    }
}
