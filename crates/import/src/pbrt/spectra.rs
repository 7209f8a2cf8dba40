//! Colours and spectra of parameters: `rgb`, `blackbody`, `spectrum` as pairs, as a name, as a file of pairs.
//!
//! Light is scaled as pbrt-v4 does it (`SpectrumToPhotometric` in its `lights.cpp`): an rgb is what the picture shows of
//! it, whatever else is a spectrum is brought to luminance 1 first, and then `scale` holds. Between its samples a
//! spectrum is linear, and 0 beyond them.

use std::io::Read;
use std::sync::Arc;

use tyndall_machine::files;
use tyndall_optics::{Spectrum, cie};
use tyndall_scene::description::{SpectrumDescription, SpectrumTable};

use super::context::Context;
use super::parameters::{Kind, Parameter};
use super::tokens::{Token, Tokens, number};
use crate::ImportError;

/// Samples of a spectrum: wavelengths in nm, values.
type Samples = (Vec<f64>, Vec<f64>);

/// The light of a parameter times `scale`; white if there is none.
pub(super) fn light(
    parameter: Option<&Parameter>,
    scale: f64,
    context: &Context,
) -> Result<SpectrumDescription, ImportError> {
    let Some(parameter) = parameter else { return Ok(grey_or_channels([scale; 3])) };
    match (parameter.kind, parameter.numbers()) {
        (Kind::Rgb, _) => Ok(grey_or_channels(channels(parameter)?.map(|channel| channel * scale))),
        (Kind::Float, _) => Err(parameter.error("is light: give it as `rgb`, `blackbody` or `spectrum`")),
        (Kind::Blackbody, &[kelvin, ref rest @ ..]) if rest.len() < 2 => {
            if !(200.0..=1e6).contains(&kelvin) {
                return Err(parameter.error("has an odd temperature: give 200 to 1,000,000 kelvin"));
            }
            // Version 3 had a factor after the temperature.
            let luminance = scale * rest.first().unwrap_or(&1.0);
            let table = SpectrumTable {
                blackbody: Some(kelvin),
                luminance: Some(luminance),
                ..SpectrumTable::default()
            };
            Ok(SpectrumDescription::Table(table))
        }
        (Kind::Blackbody, _) => Err(parameter.error("needs one temperature, kelvin")),
        _ => match parameter.text().and_then(illuminant) {
            Some(Illuminant::White) => Ok(grey_or_channels([scale; 3])),
            Some(Illuminant::Like(kelvin)) => {
                let name = parameter.text().unwrap_or_default();
                let message = format!("the illuminant \"{name}\" is taken for a black body of {kelvin} K");
                context.unsupported(&parameter.place, message);
                let table = SpectrumTable {
                    blackbody: Some(kelvin),
                    luminance: Some(scale),
                    ..SpectrumTable::default()
                };
                Ok(SpectrumDescription::Table(table))
            }
            None => {
                let (wavelengths, values) = samples(parameter, context)?;
                let spectrum = Spectrum::sampled(wavelengths.clone(), values.clone())
                    .map_err(|error| parameter.error(&error.to_string()))?;
                let luminance = cie::xyz(|nm| spectrum.at(nm)).y;
                if luminance <= 0.0 {
                    return Ok(SpectrumDescription::Grey(0.0));
                }
                Ok(table((wavelengths, values.iter().map(|value| value * (scale / luminance)).collect())))
            }
        },
    }
}

/// The coefficient of a parameter, which multiplies light.
pub(super) fn coefficient(
    parameter: &Parameter,
    context: &Context,
) -> Result<SpectrumDescription, ImportError> {
    match (parameter.kind, parameter.numbers()) {
        (Kind::Rgb, _) => Ok(grey_or_channels(channels(parameter)?)),
        (Kind::Float, &[value]) if value >= 0.0 => Ok(SpectrumDescription::Grey(value)),
        (Kind::Float, _) => Err(parameter.error("needs one number, at least 0")),
        (Kind::Blackbody, _) => {
            Err(parameter.error("is no light and cannot be a black body: give `rgb` or `spectrum`"))
        }
        _ => {
            let (wavelengths, values) = samples(parameter, context)?;
            let covers =
                wavelengths[0] <= cie::FIRST_NM && wavelengths[wavelengths.len() - 1] >= cie::LAST_NM;
            if covers && values.iter().all(|value| *value == values[0]) {
                return Ok(SpectrumDescription::Grey(values[0]));
            }
            Ok(table((wavelengths, values)))
        }
    }
}

/// The same where it is a fraction of light.
pub(super) fn fraction(parameter: &Parameter, context: &Context) -> Result<SpectrumDescription, ImportError> {
    let coefficient = coefficient(parameter, context)?;
    let greatest = match &coefficient {
        SpectrumDescription::Grey(value) => *value,
        SpectrumDescription::Channels(channels) => channels.iter().copied().fold(0.0, f64::max),
        SpectrumDescription::Table(table) => table.values.iter().flatten().copied().fold(0.0, f64::max),
    };
    if greatest > 1.0 {
        return Err(parameter.error("is a fraction of light: give numbers from 0 to 1"));
    }
    Ok(coefficient)
}

/// A colour times a factor.
pub(super) fn scaled(spectrum: SpectrumDescription, factor: f64) -> SpectrumDescription {
    match spectrum {
        SpectrumDescription::Grey(value) => SpectrumDescription::Grey(value * factor),
        SpectrumDescription::Channels(channels) => {
            SpectrumDescription::Channels(channels.map(|channel| channel * factor))
        }
        SpectrumDescription::Table(mut table) => {
            if let Some(values) = &mut table.values {
                values.iter_mut().for_each(|value| *value *= factor);
            }
            for value in [&mut table.luminance, &mut table.scale, &mut table.value].into_iter().flatten() {
                *value *= factor;
            }
            SpectrumDescription::Table(table)
        }
    }
}

/// Three channels, as one number if they are equal.
pub(super) fn grey_or_channels(channels: [f64; 3]) -> SpectrumDescription {
    let [red, green, blue] = channels;
    if red == green && green == blue { SpectrumDescription::Grey(red) } else { channels.into() }
}

fn table((wavelengths, values): Samples) -> SpectrumDescription {
    let table =
        SpectrumTable { wavelengths: Some(wavelengths), values: Some(values), ..SpectrumTable::default() };
    SpectrumDescription::Table(table)
}

fn channels(parameter: &Parameter) -> Result<[f64; 3], ImportError> {
    match parameter.numbers() {
        &[red, green, blue] if red.min(green).min(blue) >= 0.0 => Ok([red, green, blue]),
        _ => Err(parameter.error("needs three numbers, at least 0")),
    }
}

/// The samples of a spectrum, from the parameter itself or from the file that it names; they end with zeros where they
/// do not cover all that is seen.
fn samples(parameter: &Parameter, context: &Context) -> Result<Samples, ImportError> {
    let pairs = match parameter.text() {
        Some(name) => read_file(name, parameter, context)?,
        None => parameter.numbers().to_vec(),
    };
    let (pairs, rest) = pairs.as_chunks::<2>();
    let is_ordered = pairs.windows(2).all(|pair| pair[0][0] < pair[1][0]);
    let is_sound = pairs.iter().all(|[nm, value]| *nm >= 1.0 && *value >= 0.0);
    if pairs.is_empty() || !rest.is_empty() || !is_ordered || !is_sound {
        let message = "needs pairs of a wavelength in nm, ever greater, and a value, at least 0";
        return Err(parameter.error(message));
    }
    let (mut wavelengths, mut values): Samples = pairs.iter().map(|[nm, value]| (*nm, *value)).unzip();
    /// Width of the edge where a spectrum ends, nm.
    const EDGE: f64 = 0.01;
    if wavelengths[0] > cie::FIRST_NM {
        wavelengths.insert(0, wavelengths[0] - EDGE);
        values.insert(0, 0.0);
    }
    let last = wavelengths[wavelengths.len() - 1];
    if last < cie::LAST_NM {
        wavelengths.push(last + EDGE);
        values.push(0.0);
    }
    Ok((wavelengths, values))
}

/// A larger file is no spectrum.
const GREATEST_FILE: u64 = 16 << 20;

/// Numbers in a text file, with comments after `#`.
fn read_file(name: &str, parameter: &Parameter, context: &Context) -> Result<Vec<f64>, ImportError> {
    let path = context.path(name);
    let mut bytes = Vec::new();
    files::open(&path).and_then(|file| file.take(GREATEST_FILE + 1).read_to_end(&mut bytes)).map_err(
        |error| {
            let message = format!("\"{name}\" is no spectrum known by name, and {}: {error}", path.display());
            parameter.error(&message)
        },
    )?;
    if bytes.len() as u64 > GREATEST_FILE {
        return Err(parameter.error(&format!("{} is too large for a spectrum", path.display())));
    }
    let mut tokens = Tokens::new(&bytes, Arc::from(path.as_path()));
    let mut numbers = Vec::new();
    loop {
        let place = tokens.place();
        match tokens.next()? {
            None => return Ok(numbers),
            Some(Token::Word(word)) if number(word).is_some() => numbers.extend(number(word)),
            Some(token) => return Err(place.error(format!("{} is no number", token.shown()))),
        }
    }
}

/// What a standard illuminant is taken for.
enum Illuminant {
    /// D65, which is the white of the picture.
    White,
    /// A black body of this temperature, kelvin.
    Like(f64),
}

/// Illuminants that pbrt has by name, with their correlated colour temperatures (CIE 15:2004).
fn illuminant(name: &str) -> Option<Illuminant> {
    let kelvin = match name {
        "stdillum-D65" => return Some(Illuminant::White),
        "stdillum-A" => 2856.0,
        "stdillum-D50" => 5003.0,
        "illum-acesD60" => 6000.0,
        "stdillum-F1" => 6430.0,
        "stdillum-F2" => 4230.0,
        "stdillum-F3" => 3450.0,
        "stdillum-F4" => 2940.0,
        "stdillum-F5" => 6350.0,
        "stdillum-F6" => 4150.0,
        "stdillum-F7" => 6500.0,
        "stdillum-F8" => 5000.0,
        "stdillum-F9" => 4150.0,
        "stdillum-F10" => 5000.0,
        "stdillum-F11" => 4000.0,
        "stdillum-F12" => 3000.0,
        _ => return None,
    };
    Some(Illuminant::Like(kelvin))
}
