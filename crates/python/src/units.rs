//! Quantities with units, as text (`"0.3 1/mm"`) or of the package pint, as plain numbers of a scene.
//!
//! ```text
//! text     number [unit]            unit     factor { ("*" | "/" | " ") factor }         factor   "1" | name [["^"] integer]
//! ```
//!
//! Names are those that `unit` of a scene knows, and `deg`, `rad`. Only lengths, their reciprocals and angles are needed.

use pyo3::prelude::{Bound, PyAny, PyAnyMethods, PyResult};
use tyndall_scene::description::{Dimension, unit_in_metres};

use crate::error::wrong;

/// A number in metres to some power, or in degrees.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Measured {
    value: f64,
    metres: i32,
    degrees: i32,
}

/// What a key wants, in words and as pint calls it.
fn wanted(dimension: Dimension) -> Option<(&'static str, &'static str)> {
    match dimension {
        Dimension::Length => Some(("a length, such as \"3 mm\"", "meter")),
        Dimension::PerLength => Some(("a quantity per length, such as \"0.3 1/mm\"", "1/meter")),
        Dimension::Angle => Some(("an angle, such as \"30 deg\"", "degree")),
        Dimension::Plain => None,
    }
}

/// The number that `text` stands for at `key`, in a scene of this `unit`.
pub(crate) fn from_text(text: &str, key: &str, dimension: Dimension, unit: &str) -> PyResult<f64> {
    let (words, _) = wanted(dimension).ok_or_else(|| wrong(format!("{key}: \"{text}\" is no number")))?;
    let measured = parse(text).map_err(|problem| wrong(format!("{key}: {problem}; give {words}")))?;
    let powers = match dimension {
        Dimension::Length => (1, 0),
        Dimension::PerLength => (-1, 0),
        _ => (0, 1),
    };
    if (measured.metres, measured.degrees) == (0, 0) {
        // Text as configuration files have it, but a number all the same.
        return Ok(measured.value);
    }
    if (measured.metres, measured.degrees) != powers {
        return Err(wrong(format!("{key}: \"{text}\" is not {words}")));
    }
    if measured.metres == 0 {
        return Ok(measured.value);
    }
    Ok(measured.value / metres(unit)?.powi(measured.metres))
}

/// The numbers of a pint quantity at `key`, as a NumPy array or a number; `None` if `object` is no such quantity.
pub(crate) fn from_pint<'py>(
    object: &Bound<'py, PyAny>,
    key: &str,
    dimension: Dimension,
    unit: &str,
) -> PyResult<Option<Bound<'py, PyAny>>> {
    if !(object.hasattr("magnitude")? && object.hasattr("units")? && object.hasattr("to")?) {
        return Ok(None);
    }
    let (words, wanted_unit) = wanted(dimension).unwrap_or(("a number without a unit", "dimensionless"));
    let is_plain = object.getattr("units")?.str()? == "dimensionless";
    let wanted_unit = if is_plain { "dimensionless" } else { wanted_unit };
    let converted = object.call_method1("to", (wanted_unit,)).map_err(|_| {
        let shown = object.str().map_or_else(|_| "a quantity".to_owned(), |text| text.to_string());
        wrong(format!("{key}: {shown} is not {words}"))
    })?;
    let magnitude = converted.getattr("magnitude")?;
    let factor = match dimension {
        Dimension::Length if !is_plain => 1.0 / metres(unit)?,
        Dimension::PerLength if !is_plain => metres(unit)?,
        _ => return Ok(Some(magnitude)),
    };
    // Multiplying by 1 would make floats of integers.
    Ok(Some(if factor == 1.0 { magnitude } else { magnitude.mul(factor)? }))
}

/// Metres of the scene's unit.
pub(crate) fn metres(unit: &str) -> PyResult<f64> {
    unit_in_metres(unit).map_err(|problem| wrong(format!("unit: {problem}")))
}

/// The length in metres that `text` stands for; plain numbers are refused, as there is no scene that says their unit.
pub(crate) fn length_in_metres(text: &str, key: &str) -> PyResult<f64> {
    match parse(text) {
        Ok(Measured { metres: 1, degrees: 0, value }) => Ok(value),
        Ok(_) => Err(wrong(format!("{key}: \"{text}\" is not a length, such as \"3 mm\""))),
        Err(problem) => Err(wrong(format!("{key}: {problem}; give a length, such as \"3 mm\""))),
    }
}

fn parse(text: &str) -> Result<Measured, String> {
    /// Longer than any quantity.
    const LONGEST: usize = 64;
    let text = text.trim();
    // The number is the longest beginning that is one: the `e` of 1e5 belongs to it only if digits follow.
    let ends = (1..=text.len().min(LONGEST)).rev().filter(|end| text.is_char_boundary(*end));
    let parsed =
        ends.filter_map(|end| Some((text[..end].trim_end().parse::<f64>().ok()?, &text[end..]))).next();
    let shown: String = text.chars().take(LONGEST).collect();
    let Some((number, units)) = parsed.filter(|(number, _)| number.is_finite()) else {
        return Err(format!("\"{shown}\" is no number with a unit"));
    };
    let mut measured = Measured { value: number, metres: 0, degrees: 0 };
    let mut sign = 1;
    for token in tokens(units) {
        match token {
            "*" | "·" => {}
            "/" => sign = -1,
            factor => {
                multiply(&mut measured, factor, sign).map_err(|problem| format!("\"{shown}\": {problem}"))?;
                // Of `1/m/s` both are below; of `1/m s` only the first.
                sign = 1;
            }
        }
    }
    if measured.value.is_finite() { Ok(measured) } else { Err(format!("\"{shown}\" is too large a number")) }
}

/// Factors and the signs between them; `**` is the `^` of Python.
fn tokens(units: &str) -> impl Iterator<Item = &str> {
    units.split_inclusive(['/', '*', '·', ' ']).flat_map(|part| {
        let end = part.trim_end_matches(['/', '*', '·', ' ']).len();
        let (factor, rest) = part.split_at(end);
        [factor, rest.trim()].into_iter().filter(|token| !token.is_empty())
    })
}

fn multiply(measured: &mut Measured, factor: &str, sign: i32) -> Result<(), String> {
    if factor == "1" {
        return Ok(());
    }
    let end = factor.find(|c: char| c == '^' || c == '-' || c.is_ascii_digit()).unwrap_or(factor.len());
    let (name, exponent) = factor.split_at(end);
    let exponent = exponent.trim_start_matches('^');
    let power: i32 = match exponent {
        "" => 1,
        digits => digits
            .parse()
            .ok()
            .filter(|power: &i32| power.abs() <= 3)
            .ok_or_else(|| format!("`{factor}` is no unit"))?,
    } * sign;
    match name {
        "deg" | "degree" | "degrees" | "°" => measured.degrees += power,
        "rad" | "radian" | "radians" => {
            measured.degrees += power;
            measured.value *= 1f64.to_degrees().powi(power);
        }
        name => {
            let metres =
                unit_in_metres(name).map_err(|_| format!("`{name}` is no unit of length or angle"))?;
            measured.metres += power;
            measured.value *= metres.powi(power);
        }
    }
    Ok(())
}
