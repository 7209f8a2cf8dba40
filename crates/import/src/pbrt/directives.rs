//! The directives of a scene file as data.

use super::parameters::Parameters;
use super::place::Place;
use super::tokens::{Token, Tokens, number};
use crate::ImportError;

/// Something with a type and parameters: a shape, a light, a material, …
#[derive(Debug, Clone)]
pub(super) struct Entity {
    /// Its type, such as `trianglemesh`.
    pub kind: String,
    /// Its parameters.
    pub parameters: Parameters,
    /// Where it stands.
    pub place: Place,
}

/// A directive.
#[derive(Debug, Clone)]
pub(super) enum Directive {
    Include(String),
    Import(String),
    Identity,
    Translate([f64; 3]),
    Scale([f64; 3]),
    /// Angle in degrees, and axis.
    Rotate([f64; 4]),
    /// Eye, target, up.
    LookAt([f64; 9]),
    Transform([f64; 16]),
    ConcatTransform([f64; 16]),
    CoordinateSystem(String),
    CoordSysTransform(String),
    ActiveTransform,
    TransformTimes,
    ReverseOrientation,
    AttributeBegin,
    AttributeEnd,
    Attribute(Entity),
    ObjectBegin(String),
    ObjectEnd,
    ObjectInstance(String),
    WorldBegin,
    ColorSpace(String),
    MediumInterface(String, String),
    NamedMaterial(String),
    Option(String, String),
    /// Name, type of the values (`float` or `spectrum`), and the texture.
    Texture(String, String, Entity),
    Accelerator,
    Sampler(Entity),
    Integrator(Entity),
    PixelFilter(Entity),
    Film(Entity),
    Camera(Entity),
    LightSource(Entity),
    AreaLightSource(Entity),
    Shape(Entity),
    Material(Entity),
    MakeNamedMaterial(Entity),
    MakeNamedMedium(Entity),
}

impl Directive {
    /// The next directive and its place, if there is one.
    pub(super) fn read(tokens: &mut Tokens) -> Result<Option<(Directive, Place)>, ImportError> {
        let place = tokens.place();
        let Some(token) = tokens.next()? else { return Ok(None) };
        let Token::Word(word) = token else {
            let message = format!("{} stands where a directive is expected, such as `Shape`", token.shown());
            return Err(place.error(message));
        };
        let directive = match word {
            b"Include" => Self::Include(text(tokens)?),
            b"Import" => Self::Import(text(tokens)?),
            b"Identity" => Self::Identity,
            b"Translate" => Self::Translate(numbers(tokens)?),
            b"Scale" => Self::Scale(numbers(tokens)?),
            b"Rotate" => Self::Rotate(numbers(tokens)?),
            b"LookAt" => Self::LookAt(numbers(tokens)?),
            b"Transform" => Self::Transform(numbers(tokens)?),
            b"ConcatTransform" => Self::ConcatTransform(numbers(tokens)?),
            b"CoordinateSystem" => Self::CoordinateSystem(text(tokens)?),
            b"CoordSysTransform" => Self::CoordSysTransform(text(tokens)?),
            b"ActiveTransform" => {
                word_or_text(tokens)?;
                Self::ActiveTransform
            }
            b"TransformTimes" => {
                numbers::<2>(tokens)?;
                Self::TransformTimes
            }
            b"ReverseOrientation" => Self::ReverseOrientation,
            // Version 3 had a pair that kept the transform alone; both are the same where nothing else is set.
            b"AttributeBegin" | b"TransformBegin" => Self::AttributeBegin,
            b"AttributeEnd" | b"TransformEnd" => Self::AttributeEnd,
            b"Attribute" => Self::Attribute(entity(tokens, &place)?),
            b"ObjectBegin" => Self::ObjectBegin(text(tokens)?),
            b"ObjectEnd" => Self::ObjectEnd,
            b"ObjectInstance" => Self::ObjectInstance(text(tokens)?),
            b"WorldBegin" => Self::WorldBegin,
            b"ColorSpace" => Self::ColorSpace(text(tokens)?),
            b"MediumInterface" => {
                let inside = text(tokens)?;
                let outside = match tokens.peek()? {
                    Some(Token::Text(_)) => text(tokens)?,
                    _ => inside.clone(),
                };
                Self::MediumInterface(inside, outside)
            }
            b"NamedMaterial" => Self::NamedMaterial(text(tokens)?),
            b"Option" => {
                let declaration = text(tokens)?;
                let name = declaration.split_whitespace().last().unwrap_or_default().to_owned();
                Self::Option(name, word_or_text(tokens)?)
            }
            b"Texture" => {
                let (name, values) = (text(tokens)?, text(tokens)?);
                Self::Texture(name, values, entity(tokens, &place)?)
            }
            b"Accelerator" => {
                entity(tokens, &place)?;
                Self::Accelerator
            }
            b"Sampler" => Self::Sampler(entity(tokens, &place)?),
            b"Integrator" => Self::Integrator(entity(tokens, &place)?),
            b"PixelFilter" => Self::PixelFilter(entity(tokens, &place)?),
            b"Film" => Self::Film(entity(tokens, &place)?),
            b"Camera" => Self::Camera(entity(tokens, &place)?),
            b"LightSource" => Self::LightSource(entity(tokens, &place)?),
            b"AreaLightSource" => Self::AreaLightSource(entity(tokens, &place)?),
            b"Shape" => Self::Shape(entity(tokens, &place)?),
            b"Material" => Self::Material(entity(tokens, &place)?),
            b"MakeNamedMaterial" => Self::MakeNamedMaterial(entity(tokens, &place)?),
            b"MakeNamedMedium" => Self::MakeNamedMedium(entity(tokens, &place)?),
            b"WorldEnd" => {
                let message = "`WorldEnd` is of pbrt-v3: this format has none, the world ends with the file";
                return Err(place.error(message));
            }
            _ => return Err(place.error(format!("{} is no directive of pbrt-v4", token.shown()))),
        };
        Ok(Some((directive, place)))
    }
}

fn entity(tokens: &mut Tokens, place: &Place) -> Result<Entity, ImportError> {
    let kind = text(tokens)?;
    Ok(Entity { kind, parameters: Parameters::read(tokens)?, place: place.clone() })
}

fn text(tokens: &mut Tokens) -> Result<String, ImportError> {
    let place = tokens.place();
    match tokens.next()? {
        Some(Token::Text(text)) => Ok(text),
        Some(token) => Err(place.error(format!("{} stands where a \"string\" is expected", token.shown()))),
        None => Err(place.error("the file ends where a \"string\" is expected")),
    }
}

fn word_or_text(tokens: &mut Tokens) -> Result<String, ImportError> {
    let place = tokens.place();
    match tokens.next()? {
        Some(Token::Text(text)) => Ok(text),
        Some(Token::Word(word)) => Ok(String::from_utf8_lossy(word).into_owned()),
        _ => Err(place.error("a value is expected here")),
    }
}

/// `N` numbers; brackets around them are as good as none.
fn numbers<const N: usize>(tokens: &mut Tokens) -> Result<[f64; N], ImportError> {
    let start = tokens.place();
    let has_brackets = tokens.peek()? == Some(Token::Open);
    if has_brackets {
        tokens.next()?;
    }
    let mut numbers = [0.0; N];
    for value in &mut numbers {
        let place = tokens.place();
        *value = match tokens.next()? {
            Some(Token::Word(word)) => number(word),
            _ => None,
        }
        .ok_or_else(|| place.error(format!("{N} numbers within 1e30 are expected here")))?;
    }
    if has_brackets && tokens.next()? != Some(Token::Close) {
        return Err(start.error(format!("`]` is expected after {N} numbers")));
    }
    Ok(numbers)
}
