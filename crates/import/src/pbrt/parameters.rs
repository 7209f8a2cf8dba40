//! Parameter lists: `"type name" value` or `"type name" [ values ]`, any number of them.
//!
//! Which parameters were asked for is kept, so that the others can be told of.

use std::cell::Cell;
use std::rc::Rc;

use super::place::Place;
use super::tokens::{Token, Tokens, number};
use crate::ImportError;

/// The type of a parameter. Names of earlier versions of the format are read as well.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Kind {
    Integer,
    Float,
    Point2,
    Point3,
    Spectrum,
    Rgb,
    Blackbody,
    Bool,
    String,
    Texture,
}

impl Kind {
    fn named(name: &str) -> Option<Kind> {
        Some(match name {
            "integer" => Kind::Integer,
            "float" => Kind::Float,
            "point2" | "vector2" => Kind::Point2,
            "point" | "point3" | "vector" | "vector3" | "normal" | "normal3" => Kind::Point3,
            "spectrum" => Kind::Spectrum,
            "rgb" | "color" => Kind::Rgb,
            "blackbody" => Kind::Blackbody,
            "bool" => Kind::Bool,
            "string" => Kind::String,
            "texture" => Kind::Texture,
            _ => return None,
        })
    }
}

/// The values of a parameter.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Values {
    Numbers(Vec<f64>),
    Texts(Vec<String>),
    Flags(Vec<bool>),
}

/// A parameter.
#[derive(Debug, Clone)]
pub(super) struct Parameter {
    pub kind: Kind,
    pub name: String,
    pub values: Values,
    pub place: Place,
    used: Cell<bool>,
}

impl Parameter {
    /// The values, if they are numbers.
    pub(super) fn numbers(&self) -> &[f64] {
        match &self.values {
            Values::Numbers(numbers) => numbers,
            _ => &[],
        }
    }

    /// The first value, if it is a string.
    pub(super) fn text(&self) -> Option<&str> {
        match &self.values {
            Values::Texts(texts) => texts.first().map(String::as_str),
            _ => None,
        }
    }

    /// An error about this parameter.
    pub(super) fn error(&self, what: &str) -> ImportError {
        self.place.error(format!("`{}`: {what}", self.name))
    }
}

/// A parameter list, and what `Attribute` directives have added to it.
#[derive(Debug, Clone, Default)]
pub(super) struct Parameters {
    own: Vec<Parameter>,
    inherited: Rc<Vec<Parameter>>,
}

impl Parameters {
    /// Reads parameters up to the first word that begins none.
    pub(super) fn read(tokens: &mut Tokens) -> Result<Parameters, ImportError> {
        let mut own = Vec::new();
        while let Some(Token::Text(declaration)) = tokens.peek()? {
            let place = tokens.place();
            tokens.next()?;
            own.push(read_parameter(&declaration, place, tokens)?);
        }
        Ok(Parameters { own, inherited: Rc::default() })
    }

    /// The same with parameters that hold where it says nothing itself.
    pub(super) fn inheriting(self, inherited: &Rc<Vec<Parameter>>) -> Parameters {
        Parameters { own: self.own, inherited: inherited.clone() }
    }

    /// The parameters themselves, without inherited ones.
    pub(super) fn into_own(self) -> Vec<Parameter> {
        self.own
    }

    /// The first parameter of this name and one of these types.
    pub(super) fn find(&self, name: &str, kinds: &[Kind]) -> Option<&Parameter> {
        let mut candidates = self.own.iter().chain(self.inherited.iter());
        let found = candidates.find(|p| p.name == name && kinds.contains(&p.kind))?;
        found.used.set(true);
        Some(found)
    }

    /// A number.
    pub(super) fn float(&self, name: &str) -> Result<Option<f64>, ImportError> {
        let Some(parameter) = self.find(name, &[Kind::Float, Kind::Integer]) else { return Ok(None) };
        match parameter.numbers() {
            [number] => Ok(Some(*number)),
            _ => Err(parameter.error("needs one number")),
        }
    }

    /// A number, or what it is where it is not given.
    pub(super) fn float_or(&self, name: &str, default: f64) -> Result<f64, ImportError> {
        Ok(self.float(name)?.unwrap_or(default))
    }

    /// A whole number.
    pub(super) fn integer(&self, name: &str) -> Result<Option<i32>, ImportError> {
        let Some(parameter) = self.find(name, &[Kind::Integer]) else { return Ok(None) };
        match parameter.numbers() {
            [number] if *number == f64::from(*number as i32) => Ok(Some(*number as i32)),
            _ => Err(parameter.error("needs one whole number")),
        }
    }

    /// A truth value.
    pub(super) fn flag(&self, name: &str) -> Result<Option<bool>, ImportError> {
        let Some(parameter) = self.find(name, &[Kind::Bool]) else { return Ok(None) };
        match &parameter.values {
            Values::Flags(flags) if flags.len() == 1 => Ok(Some(flags[0])),
            _ => Err(parameter.error("needs `true` or `false`")),
        }
    }

    /// A string.
    pub(super) fn text(&self, name: &str) -> Result<Option<&str>, ImportError> {
        let Some(parameter) = self.find(name, &[Kind::String]) else { return Ok(None) };
        parameter.text().map(Some).ok_or_else(|| parameter.error("needs one string"))
    }

    /// Name of a texture.
    pub(super) fn texture(&self, name: &str) -> Result<Option<(&str, &Parameter)>, ImportError> {
        let Some(parameter) = self.find(name, &[Kind::Texture]) else { return Ok(None) };
        let texture = parameter.text().ok_or_else(|| parameter.error("needs the name of a texture"))?;
        Ok(Some((texture, parameter)))
    }

    /// Numbers, any count.
    pub(super) fn floats(&self, name: &str) -> Option<&[f64]> {
        self.find(name, &[Kind::Float, Kind::Integer]).map(Parameter::numbers)
    }

    /// Exactly `N` numbers.
    pub(super) fn exactly<const N: usize>(&self, name: &str) -> Result<Option<[f64; N]>, ImportError> {
        let Some(parameter) = self.find(name, &[Kind::Float, Kind::Integer, Kind::Point3]) else {
            return Ok(None);
        };
        let numbers = parameter.numbers().try_into();
        numbers.map(Some).map_err(|_| parameter.error(&format!("needs {N} numbers")))
    }

    /// Points, vectors or normals of `N` numbers each.
    pub(super) fn points<const N: usize>(&self, name: &str) -> Result<Option<Vec<[f64; N]>>, ImportError> {
        let kinds: &[Kind] = if N == 2 { &[Kind::Point2, Kind::Float] } else { &[Kind::Point3] };
        let Some(parameter) = self.find(name, kinds) else { return Ok(None) };
        let (points, rest) = parameter.numbers().as_chunks::<N>();
        match rest {
            [] => Ok(Some(points.to_vec())),
            _ => Err(parameter.error(&format!("needs {N} numbers for each point"))),
        }
    }

    /// Numbers of vertices, from 0 up to `count`.
    pub(super) fn indices(&self, name: &str, count: usize) -> Result<Option<Vec<u32>>, ImportError> {
        let Some(parameter) = self.find(name, &[Kind::Integer]) else { return Ok(None) };
        let index = |&number: &f64| (number >= 0.0 && number < count as f64).then_some(number as u32);
        let indices: Option<Vec<u32>> = parameter.numbers().iter().map(index).collect();
        indices.map(Some).ok_or_else(|| {
            parameter.error(&format!("numbers vertices that are not there: the last is {}", count.max(1) - 1))
        })
    }

    /// A colour: of type rgb, spectrum or blackbody, or one number.
    pub(super) fn colour(&self, name: &str) -> Option<&Parameter> {
        self.find(name, &[Kind::Rgb, Kind::Spectrum, Kind::Blackbody, Kind::Float])
    }

    /// Makes parameters that change nothing count as used.
    pub(super) fn pass(&self, names: &[&str]) {
        self.own.iter().filter(|p| names.contains(&p.name.as_str())).for_each(|p| p.used.set(true));
    }

    /// What was given and never asked for. Another of the same name may have been.
    pub(super) fn unused(&self) -> impl Iterator<Item = &Parameter> {
        let is_shadowed =
            |name: &str| self.own.iter().any(|parameter| parameter.name == name && parameter.used.get());
        self.own.iter().filter(move |parameter| !parameter.used.get() && !is_shadowed(&parameter.name))
    }
}

fn read_parameter(declaration: &str, place: Place, tokens: &mut Tokens) -> Result<Parameter, ImportError> {
    let mut words = declaration.split_whitespace();
    let (Some(type_name), Some(name), None) = (words.next(), words.next(), words.next()) else {
        let shown = Token::Text(declaration.to_owned()).shown();
        return Err(place.error(format!("{shown} is no parameter: write \"type name\", then its value")));
    };
    let Some(kind) = Kind::named(type_name) else {
        let shown = Token::Text(type_name.to_owned()).shown();
        return Err(place.error(format!(
            "{shown} is no type of parameter: there are integer, float, point2, vector2, point3, vector3, normal, \
             spectrum, rgb, blackbody, bool, string and texture"
        )));
    };
    let values = read_values(kind, tokens)?;
    let is_sound = match (kind, &values) {
        (_, None) | (Kind::Spectrum, Some(Values::Numbers(_) | Values::Texts(_))) => true,
        (Kind::String | Kind::Texture, Some(values)) => matches!(values, Values::Texts(_)),
        (Kind::Bool, Some(values)) => matches!(values, Values::Flags(_)),
        (_, Some(values)) => matches!(values, Values::Numbers(_)),
    };
    if !is_sound {
        return Err(place.error(format!("`{name}` has values that are not of its type `{type_name}`")));
    }
    let nothing = match kind {
        Kind::Bool => Values::Flags(Vec::new()),
        Kind::String | Kind::Texture => Values::Texts(Vec::new()),
        _ => Values::Numbers(Vec::new()),
    };
    let values = values.unwrap_or(nothing);
    Ok(Parameter { kind, name: name.to_owned(), values, place, used: Cell::new(false) })
}

/// One value, or several in brackets; none if the brackets are empty.
fn read_values(kind: Kind, tokens: &mut Tokens) -> Result<Option<Values>, ImportError> {
    let place = tokens.place();
    let Some(first) = tokens.next()? else {
        return Err(place.error("the file ends where a value is expected: give it"));
    };
    let mut values = None;
    if first != Token::Open {
        add_value(&mut values, first, kind, &place)?;
        return Ok(values);
    }
    loop {
        let here = tokens.place();
        match tokens.next()? {
            None => return Err(place.error("the brackets are not closed: add `]`")),
            Some(Token::Close) => return Ok(values),
            Some(token) => add_value(&mut values, token, kind, &here)?,
        }
    }
}

fn add_value(
    values: &mut Option<Values>,
    token: Token,
    kind: Kind,
    place: &Place,
) -> Result<(), ImportError> {
    let flag = match &token {
        Token::Word(b"true") => Some(true),
        Token::Word(b"false") => Some(false),
        // Version 3 had truth values in quotes.
        Token::Text(text) if kind == Kind::Bool => text.parse().ok(),
        _ => None,
    };
    let number = match &token {
        Token::Word(word) => number(word),
        _ => None,
    };
    match (values.as_mut(), flag, number, token) {
        (None, Some(flag), ..) => *values = Some(Values::Flags(vec![flag])),
        (None, None, Some(number), _) => *values = Some(Values::Numbers(vec![number])),
        (None, None, None, Token::Text(text)) => *values = Some(Values::Texts(vec![text])),
        (Some(Values::Flags(flags)), Some(flag), ..) => flags.push(flag),
        (Some(Values::Numbers(numbers)), _, Some(number), _) => numbers.push(number),
        (Some(Values::Texts(texts)), None, None, Token::Text(text)) => texts.push(text),
        (_, _, _, token) => {
            let shown = token.shown();
            return Err(place
                .error(format!("{shown} is no value here: numbers are within 1e30 and strings are quoted")));
        }
    }
    Ok(())
}
