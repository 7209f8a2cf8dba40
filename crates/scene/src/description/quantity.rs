//! A quantity with its unit, as text: `"10 um"`, `"0.3 g/m3"`, `"100 /cm3"`.

use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::{Deserialize, Serialize};

/// A number with a unit. A number without one is read as well, so that its message can say which units there are.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(untagged)]
pub enum Quantity {
    /// Such as `10 um`.
    Text(String),
    /// Without its unit.
    Number(f64),
}

/// Lengths, in micrometres.
pub const LENGTHS: [(&str, f64); 6] =
    [("nm", 1e-3), ("um", 1.0), ("mm", 1e3), ("cm", 1e4), ("m", 1e6), ("km", 1e9)];

/// Masses in a volume, in g/m³.
pub const CONCENTRATIONS: [(&str, f64); 5] =
    [("ug/m3", 1e-6), ("mg/m3", 1e-3), ("g/m3", 1.0), ("kg/m3", 1e3), ("g/cm3", 1e6)];

/// Numbers in a volume, in 1/cm³.
pub const NUMBER_DENSITIES: [(&str, f64); 5] =
    [("/cm3", 1.0), ("/m3", 1e-6), ("/mm3", 1e3), ("cm-3", 1.0), ("m-3", 1e-6)];

/// No number with a unit is longer.
const LONGEST: usize = 64;

impl Quantity {
    /// The number in terms of `units`: names, with their size in the unit of the result. Or what is wrong.
    pub fn in_units(&self, units: &[(&str, f64)]) -> Result<f64, String> {
        let names = || {
            let names: Vec<&str> = units.iter().map(|(name, _)| *name).collect();
            names.join(", ")
        };
        let text = match self {
            Self::Text(text) => text,
            Self::Number(number) => {
                return Err(format!(
                    "{number} has no unit; write \"{number} {}\" (or {})",
                    units[0].0,
                    names()
                ));
            }
        };
        // The number is the longest beginning that is one: the `e` of 1e5 belongs to it only if digits follow.
        let text = text.trim();
        let ends = (0..=text.len().min(LONGEST)).rev().filter(|end| text.is_char_boundary(*end));
        let parsed = ends.filter_map(|end| Some((text[..end].parse::<f64>().ok()?, &text[end..]))).next();
        let Some((number, unit)) = parsed.filter(|(number, _)| number.is_finite()) else {
            return Err(format!("\"{text}\" is no number with a unit, such as \"10 {}\"", units[0].0));
        };
        let unit = unit.replace(['µ', 'μ'], "u").replace('³', "3").replace(['^', ' '], "");
        let unit = unit.strip_prefix('1').filter(|rest| rest.starts_with('/')).unwrap_or(&unit);
        match units.iter().find(|(name, _)| *name == unit) {
            Some((_, size)) => Ok(number * size),
            None => Err(format!("\"{text}\" has none of the units {}", names())),
        }
    }
}

impl JsonSchema for Quantity {
    fn schema_name() -> std::borrow::Cow<'static, str> {
        "Quantity".into()
    }

    fn json_schema(_: &mut SchemaGenerator) -> Schema {
        json_schema!({ "anyOf": [{ "type": "string" }, { "type": "number" }] })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(text: &str, units: &[(&str, f64)]) -> Result<f64, String> {
        Quantity::Text(text.into()).in_units(units)
    }

    #[test]
    fn units_are_read_however_they_are_written() {
        for (text, micrometres) in [
            ("10 um", 10.0),
            ("10um", 10.0),
            ("0.01mm", 10.0),
            (" 1e1 µm", 10.0),
            ("+1e-5 m", 10.0),
            ("10000nm", 10.0),
        ] {
            assert!((read(text, &LENGTHS).unwrap() / micrometres - 1.0).abs() < 1e-12, "{text}");
        }
        for text in ["0.3 g/m3", "0.3 g/m^3", "0.3g/m³", "300 mg/m3", "3e-7 g/cm3"] {
            assert!((read(text, &CONCENTRATIONS).unwrap() / 0.3 - 1.0).abs() < 1e-12, "{text}");
        }
        for (text, expected) in [("1 /cm3", 1.0), ("11 /cm3", 11.0), ("1/cm3", 1.0), ("2 1/cm3", 2.0)] {
            assert_eq!(read(text, &NUMBER_DENSITIES), Ok(expected), "{text}");
        }
        for text in ["100 /cm3", "100 1/cm3", "100cm-3", "100 cm^-3", "1e8 /m3", "1e8 m-3"] {
            assert!((read(text, &NUMBER_DENSITIES).unwrap() / 100.0 - 1.0).abs() < 1e-12, "{text}");
        }
    }

    #[test]
    fn what_is_no_quantity_is_told_with_the_units() {
        for (text, part) in [
            ("10", "has none of the units nm, um"),
            ("10 kg", "has none of the units"),
            ("um", "is no number with a unit"),
            ("", "is no number"),
            ("inf um", "is no number"),
            ("10 µ€", "has none of the units"),
        ] {
            let message = read(text, &LENGTHS).unwrap_err();
            assert!(message.contains(part), "{text}: {message}");
        }
        let message = Quantity::Number(10.0).in_units(&LENGTHS).unwrap_err();
        assert!(message.contains("10 has no unit"), "{message}");
    }
}
