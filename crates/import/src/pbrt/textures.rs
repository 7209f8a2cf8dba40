//! Textures, as far as they are constants, pictures, checkerboards, and multiples of these.

use tyndall_scene::description::{
    CheckerTexture, ImageFilter, ImageTexture, SpectrumDescription, TextureDescription, TextureWrap,
};

use super::context::Context;
use super::directives::Entity;
use super::parameters::{Parameter, Parameters};
use super::spectra;
use super::world::World;
use crate::ImportError;

/// Textures within textures.
const DEEPEST: usize = 16;

/// Finds textures by name.
#[derive(Debug, Clone, Copy)]
pub(super) struct Textures<'a> {
    pub world: &'a World,
    pub context: &'a Context<'a>,
}

impl Textures<'_> {
    /// A colour from 0 to 1 that may vary over a surface.
    pub(super) fn fraction(
        &self,
        parameters: &Parameters,
        name: &str,
    ) -> Result<Option<TextureDescription>, ImportError> {
        self.colour(parameters, name, true, 0)
    }

    /// A number that may vary over a surface.
    pub(super) fn number(
        &self,
        parameters: &Parameters,
        name: &str,
    ) -> Result<Option<TextureDescription>, ImportError> {
        self.colour(parameters, name, false, 0)
    }

    /// A number that is the same everywhere; of a texture that varies `instead` is taken.
    pub(super) fn constant(
        &self,
        parameters: &Parameters,
        name: &str,
        instead: f64,
    ) -> Result<Option<f64>, ImportError> {
        let Some(texture) = self.number(parameters, name)? else { return Ok(None) };
        if let TextureDescription::Constant(SpectrumDescription::Grey(value)) = texture {
            return Ok(Some(value));
        }
        if let Some((_, parameter)) = parameters.texture(name)? {
            let message = format!("`{name}` cannot vary over a surface: it is {instead} everywhere");
            self.context.unsupported(&parameter.place, message);
        }
        Ok(Some(instead))
    }

    fn colour(
        &self,
        parameters: &Parameters,
        name: &str,
        is_fraction: bool,
        depth: usize,
    ) -> Result<Option<TextureDescription>, ImportError> {
        if let Some((texture, parameter)) = parameters.texture(name)? {
            return self.named(texture, parameter, is_fraction, depth).map(Some);
        }
        let Some(parameter) = parameters.colour(name) else { return Ok(None) };
        let read = if is_fraction { spectra::fraction } else { spectra::coefficient };
        Ok(Some(TextureDescription::Constant(read(parameter, self.context)?)))
    }

    fn named(
        &self,
        name: &str,
        parameter: &Parameter,
        is_fraction: bool,
        depth: usize,
    ) -> Result<TextureDescription, ImportError> {
        let Some(texture) = self.world.textures.get(name) else {
            return Err(parameter.error(&format!("there is no texture \"{name}\": define it by `Texture`")));
        };
        if depth == DEEPEST {
            return Err(parameter.error(&format!("the texture \"{name}\" is made of more than 16 others")));
        }
        let entity = &texture.entity;
        let parameters = &entity.parameters;
        let part = |name: &str, default: f64| -> Result<TextureDescription, ImportError> {
            Ok(self.colour(parameters, name, is_fraction, depth + 1)?.unwrap_or(default.into()))
        };
        let made = match entity.kind.as_str() {
            "constant" => part("value", 1.0)?,
            "imagemap" => self.image(entity, texture.is_float)?,
            "checkerboard" => self.checkerboard(entity, [part("tex1", 1.0)?, part("tex2", 0.0)?])?,
            "scale" => {
                let scale = self.colour(parameters, "scale", false, depth + 1)?.unwrap_or(1.0.into());
                self.product(entity, part("tex", 1.0)?, scale)
            }
            "mix" => {
                let amount = self.colour(parameters, "amount", false, depth + 1)?.unwrap_or(0.5.into());
                self.mixture(entity, [part("tex1", 0.0)?, part("tex2", 1.0)?], amount)
            }
            kind => {
                let message = format!("the texture \"{kind}\" is not supported: it is 0.5 everywhere");
                self.context.unsupported(&entity.place, message);
                return Ok(0.5.into());
            }
        };
        self.context.tell_unused("Texture", entity);
        Ok(made)
    }

    fn image(&self, entity: &Entity, is_float: bool) -> Result<TextureDescription, ImportError> {
        let (parameters, place) = (&entity.parameters, &entity.place);
        let Some(name) = parameters.text("filename")? else {
            return Err(place.error("the texture needs a `filename`"));
        };
        let image = self.context.file(name, place)?;
        let srgb = match parameters.text("encoding")? {
            None => None,
            Some("sRGB") => Some(true),
            Some("linear") => Some(false),
            Some(other) => {
                let message = format!("the encoding \"{other}\" of a picture is taken for sRGB");
                self.context.unsupported(place, message);
                Some(true)
            }
        };
        let wrap = match parameters.text("wrap")? {
            None | Some("repeat") => TextureWrap::Repeat,
            Some("clamp") => TextureWrap::Clamp,
            Some(other) => {
                let message = format!("beyond a picture that wraps as \"{other}\" its border goes on");
                self.context.unsupported(place, message);
                TextureWrap::Clamp
            }
        };
        if parameters.flag("invert")? == Some(true) {
            self.context.unsupported(place, "a picture is inverted: it is taken as it is");
        }
        let filter = match parameters.text("filter")? {
            Some("point") => ImageFilter::Nearest,
            _ => ImageFilter::Bilinear,
        };
        // Textures are looked at in a point; single numbers are the mean of a picture's channels in both programs.
        parameters.pass(&["maxanisotropy"]);
        let _ = is_float;
        let (scale, offset) = self.mapping(entity)?;
        let factor = parameters.float("scale")?.filter(|factor| *factor != 1.0);
        if factor.is_some_and(|factor| factor < 0.0) {
            return Err(place.error("`scale` of a picture must be at least 0"));
        }
        Ok(TextureDescription::Image(ImageTexture { image, srgb, filter, wrap, scale, offset, factor }))
    }

    fn checkerboard(
        &self,
        entity: &Entity,
        values: [TextureDescription; 2],
    ) -> Result<TextureDescription, ImportError> {
        let is_solid = entity.parameters.integer("dimension")? == Some(3);
        let (scale, offset) = self.mapping(entity)?;
        match values {
            [TextureDescription::Constant(even), TextureDescription::Constant(odd)] if !is_solid => {
                Ok(TextureDescription::Checker(CheckerTexture { checker: [even, odd], scale, offset }))
            }
            [first, _] => {
                let message =
                    "a checkerboard in space, or of textures, is not supported: its `tex1` is everywhere";
                self.context.unsupported(&entity.place, message);
                Ok(first)
            }
        }
    }

    /// How texture coordinates are made: factors, and what is added.
    fn mapping(&self, entity: &Entity) -> Result<(Option<[f64; 2]>, Option<[f64; 2]>), ImportError> {
        let parameters = &entity.parameters;
        if let Some(mapping) = parameters.text("mapping")?.filter(|mapping| *mapping != "uv") {
            let message =
                format!("the \"{mapping}\" mapping of a texture is not supported: it lies along u and v");
            self.context.unsupported(&entity.place, message);
        }
        let scale = [parameters.float_or("uscale", 1.0)?, parameters.float_or("vscale", 1.0)?];
        let offset = [parameters.float_or("udelta", 0.0)?, parameters.float_or("vdelta", 0.0)?];
        Ok((
            Some(scale).filter(|scale| *scale != [1.0; 2]),
            Some(offset).filter(|offset| *offset != [0.0; 2]),
        ))
    }

    fn product(
        &self,
        entity: &Entity,
        texture: TextureDescription,
        scale: TextureDescription,
    ) -> TextureDescription {
        use TextureDescription::{Checker, Constant, Image};
        let factor = match &scale {
            Constant(SpectrumDescription::Grey(factor)) => Some(*factor),
            _ => None,
        };
        match (texture, factor, scale) {
            (Constant(colour), Some(factor), _) => Constant(spectra::scaled(colour, factor)),
            (Constant(SpectrumDescription::Grey(grey)), None, Constant(colour)) => {
                Constant(spectra::scaled(colour, grey))
            }
            (
                Constant(SpectrumDescription::Channels(a)),
                None,
                Constant(SpectrumDescription::Channels(b)),
            ) => Constant([a[0] * b[0], a[1] * b[1], a[2] * b[2]].into()),
            (Image(image), Some(factor), _) => {
                Image(ImageTexture { factor: Some(image.factor.unwrap_or(1.0) * factor), ..image })
            }
            (Checker(board), Some(factor), _) => {
                let checker = board.checker.map(|colour| spectra::scaled(colour, factor));
                Checker(CheckerTexture { checker, ..board })
            }
            (texture, ..) => {
                let message = "a texture times a texture or a colour is not supported: the factor is 1";
                self.context.unsupported(&entity.place, message);
                texture
            }
        }
    }

    fn mixture(
        &self,
        entity: &Entity,
        textures: [TextureDescription; 2],
        amount: TextureDescription,
    ) -> TextureDescription {
        use TextureDescription::Constant;
        let channels = |colour: &SpectrumDescription| match colour {
            SpectrumDescription::Grey(grey) => Some([*grey; 3]),
            SpectrumDescription::Channels(channels) => Some(*channels),
            SpectrumDescription::Table(_) => None,
        };
        if let ([Constant(a), Constant(b)], Constant(SpectrumDescription::Grey(t))) = (&textures, &amount) {
            if let (Some(a), Some(b)) = (channels(a), channels(b)) {
                let mixed = std::array::from_fn(|i| a[i] + (b[i] - a[i]) * t);
                return Constant(spectra::grey_or_channels(mixed));
            }
        }
        let message = "a mixture of textures that vary is not supported: it is the first of them";
        self.context.unsupported(&entity.place, message);
        let [first, _] = textures;
        first
    }
}
