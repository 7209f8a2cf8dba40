//! Colours and spectra.
//!
//! A number or an `<rgb>` of a lamp is the picture's white or colour (in spectral variants times D65), but a
//! `<spectrum value="1"/>` is the same radiance at all wavelengths, whose colour is not white. Outside the wavelengths
//! it is given at, a spectrum is 0.

use tyndall_scene::description::{SpectrumDescription, SpectrumTable};

use super::importer::Importer;
use super::object::{Object, Place, Property, Value};
use super::text;
use crate::ImportError;

/// What a spectrum is of.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Role {
    /// Light.
    Light,
    /// A number from 0 to 1 that multiplies light.
    Fraction,
    /// Any number that multiplies light.
    Coefficient,
}

/// Ends of the wavelengths that count, nm.
const VISIBLE: [f64; 2] = [360.0, 830.0];

impl<'a> Importer<'a> {
    /// The spectrum of this name, which must be the same everywhere.
    pub fn spectrum(
        &mut self,
        object: &'a Object,
        name: &str,
        role: Role,
        default: f64,
    ) -> Result<SpectrumDescription, ImportError> {
        match object.get(name) {
            Some(property) => self.spectrum_of(property, role),
            None => Ok(default.into()),
        }
    }

    /// The spectrum that a property is.
    pub fn spectrum_of(
        &mut self,
        property: &'a Property,
        role: Role,
    ) -> Result<SpectrumDescription, ImportError> {
        let place = &property.place;
        let spectrum = match &property.value {
            Value::Float(value) => SpectrumDescription::Grey(*value),
            Value::Integer(value) => SpectrumDescription::Grey(*value as f64),
            Value::Rgb(channels) | Value::Vector(channels) => colour(*channels),
            Value::Uniform(value) => uniform(*value, role),
            Value::Sampled(wavelengths, values) => sampled(wavelengths, values),
            Value::Object(number) => {
                return self.within(*number, |importer| importer.spectrum_object(*number, role));
            }
            _ => {
                return Err(
                    place.error(format!("`{}` is no colour: write an <rgb>", text::excerpt(&property.name)))
                );
            }
        };
        Ok(self.in_range(spectrum, role, place))
    }

    /// A `<spectrum type=…>`, or the average of a texture.
    fn spectrum_object(&mut self, number: usize, role: Role) -> Result<SpectrumDescription, ImportError> {
        let object = self.object(number);
        let spectrum = match object.plugin.as_str() {
            "uniform" => {
                object.ignore(&["wavelength_min", "wavelength_max"]);
                SpectrumDescription::Grey(object.float("value", 1.0)?)
            }
            "srgb" | "rgb" => match object.get("color").or_else(|| object.get("value")) {
                Some(property) => self.spectrum_of(property, role)?,
                None => SpectrumDescription::Grey(1.0),
            },
            "rawconstant" => self.spectrum(object, "value", role, 1.0)?,
            "d65" => self.daylight(object, role)?,
            "blackbody" => self.black_body(object)?,
            "regular" | "irregular" => self.list(object)?,
            "bitmap" => {
                let message = "a bitmap is not supported here: its mean colour is taken";
                self.unsupported(&object.place, message);
                self.mean_of_bitmap(object)?
            }
            "checkerboard" => {
                self.unsupported(
                    &object.place,
                    "a checkerboard is not supported here: its first colour is taken",
                );
                object.ignore(&["color1", "to_uv"]);
                self.spectrum(object, "color0", role, 0.4)?
            }
            _ => {
                let message = format!("{} is not supported: 0.5 is taken", object.title());
                self.unsupported(&object.place, message);
                return Ok(0.5.into());
            }
        };
        self.tell_unused(object);
        Ok(self.in_range(spectrum, role, &object.place))
    }

    fn daylight(&mut self, object: &'a Object, role: Role) -> Result<SpectrumDescription, ImportError> {
        let scale = object.float("scale", 1.0)?;
        let nested = object.objects().next().map(|(property, _)| property).or_else(|| object.get("color"));
        let Some(property) = nested else { return Ok(scale.into()) };
        property.is_used.set(true);
        Ok(match self.spectrum_of(property, role)? {
            SpectrumDescription::Grey(value) => (value * scale).into(),
            SpectrumDescription::Channels(channels) => colour(channels.map(|value| value * scale)),
            table => table,
        })
    }

    /// Planck's radiance, W/(m² sr nm).
    fn black_body(&mut self, object: &'a Object) -> Result<SpectrumDescription, ImportError> {
        object.ignore(&["wavelength_min", "wavelength_max"]);
        let given = object.float("temperature", 6500.0)?;
        let kelvin = given.clamp(200.0, 1e6);
        if kelvin != given {
            self.unsupported(
                &object.place,
                format!("a black body of {given} K is taken for one of {kelvin} K"),
            );
        }
        let scale = Some(object.float("scale", 1.0)?.max(0.0));
        let table = SpectrumTable { blackbody: Some(kelvin), scale, ..SpectrumTable::default() };
        Ok(SpectrumDescription::Table(table))
    }

    /// `regular` and `irregular`.
    fn list(&mut self, object: &'a Object) -> Result<SpectrumDescription, ImportError> {
        if let Some(property) = object.get("value") {
            return match &property.value {
                Value::Sampled(wavelengths, values) => Ok(sampled(wavelengths, values)),
                _ => Err(property.place.error("write the `value` as `400:0.1, 700:0.2`")),
            };
        }
        let fault = |message: String| object.place.error(message);
        let list = |name: &str| match object.text(name)? {
            Some(text) => text::numbers(text).map_err(fault),
            None => Err(object.place.error(format!("{} has no `{name}`: add it", object.title()))),
        };
        let values = list("values")?;
        let wavelengths = if object.plugin == "irregular" {
            list("wavelengths")?
        } else {
            let (first, last) =
                (object.float("wavelength_min", VISIBLE[0])?, object.float("wavelength_max", VISIBLE[1])?);
            let steps = values.len().saturating_sub(1).max(1) as f64;
            (0..values.len()).map(|step| first + (last - first) * step as f64 / steps).collect()
        };
        match text::sampled(wavelengths, values).map_err(fault)? {
            Value::Sampled(wavelengths, values) => Ok(sampled(&wavelengths, &values)),
            _ => Ok(1.0.into()),
        }
    }

    /// Takes values that no such spectrum can have for the nearest that it can.
    fn in_range(&mut self, spectrum: SpectrumDescription, role: Role, place: &Place) -> SpectrumDescription {
        let greatest = match role {
            Role::Fraction => 1.0,
            // The factor on it may be large too.
            Role::Coefficient => 1e18,
            Role::Light => 1e30,
        };
        let mut changed = None;
        let mut clamp = |value: f64| {
            let sound = value.clamp(0.0, greatest);
            if sound != value {
                changed = Some((value, sound));
            }
            super::transform::plain(sound)
        };
        let spectrum = match spectrum {
            SpectrumDescription::Grey(value) => SpectrumDescription::Grey(clamp(value)),
            SpectrumDescription::Channels(channels) => SpectrumDescription::Channels(channels.map(clamp)),
            SpectrumDescription::Table(table) => {
                let values = table.values.map(|values| values.into_iter().map(clamp).collect());
                SpectrumDescription::Table(SpectrumTable { values, ..table })
            }
        };
        if let Some((value, sound)) = changed {
            self.unsupported(place, format!("the value {value} is out of range and taken for {sound}"));
        }
        spectrum
    }
}

/// A colour, grey if it is.
pub(super) fn colour([r, g, b]: [f64; 3]) -> SpectrumDescription {
    if r == g && g == b { SpectrumDescription::Grey(r) } else { SpectrumDescription::Channels([r, g, b]) }
}

fn uniform(value: f64, role: Role) -> SpectrumDescription {
    if role != Role::Light || value == 0.0 {
        return SpectrumDescription::Grey(value);
    }
    SpectrumDescription::Table(SpectrumTable {
        wavelengths: Some(VISIBLE.to_vec()),
        values: Some(vec![value; 2]),
        ..SpectrumTable::default()
    })
}

/// Samples, and 0 beyond them.
fn sampled(wavelengths: &[f64], values: &[f64]) -> SpectrumDescription {
    let (mut wavelengths, mut values) = (wavelengths.to_vec(), values.to_vec());
    /// Width of the step down to 0, nm.
    const STEP: f64 = 1e-3;
    if let Some(&first) = wavelengths.first().filter(|first| **first > VISIBLE[0]) {
        wavelengths.insert(0, first - STEP);
        values.insert(0, 0.0);
    }
    if let Some(&last) = wavelengths.last().filter(|last| **last < VISIBLE[1]) {
        wavelengths.push(last + STEP);
        values.push(0.0);
    }
    SpectrumDescription::Table(SpectrumTable {
        wavelengths: Some(wavelengths),
        values: Some(values),
        ..SpectrumTable::default()
    })
}

/// Whether a spectrum is 0 by its form.
pub(super) fn is_zero(spectrum: &SpectrumDescription) -> bool {
    match spectrum {
        SpectrumDescription::Grey(value) => *value == 0.0,
        SpectrumDescription::Channels(channels) => *channels == [0.0; 3],
        SpectrumDescription::Table(table) => {
            table.values.as_ref().is_some_and(|values| values.iter().all(|v| *v == 0.0))
        }
    }
}
