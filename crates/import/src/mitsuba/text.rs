//! Numbers and spectra as text, in attributes and in files of spectra.

use super::object::Value;

/// Greatest number that a scene may have.
const GREATEST: f64 = 1e30;

/// A finite number, or what is wrong.
pub(super) fn number(text: &str) -> Result<f64, String> {
    match text.trim().parse::<f64>() {
        Ok(value) if value.abs() <= GREATEST => Ok(value),
        Ok(value) if value.is_finite() => {
            Err(format!("{value:e} is too large: numbers beyond 1e30 are not computed with"))
        }
        _ => Err(format!("`{}` is no number", excerpt(text))),
    }
}

/// Numbers between commas or spaces.
pub(super) fn numbers(text: &str) -> Result<Vec<f64>, String> {
    text.split(|c: char| c == ',' || c.is_whitespace()).filter(|word| !word.is_empty()).map(number).collect()
}

/// One or three numbers.
pub(super) fn triple(text: &str) -> Result<[f64; 3], String> {
    match numbers(text)?.as_slice() {
        [all] => Ok([*all; 3]),
        [x, y, z] => Ok([*x, *y, *z]),
        values => Err(format!("`value` has {} numbers: give 1 or 3", values.len())),
    }
}

/// `0.5`, or `400:0.1, 700:0.2`.
pub(super) fn spectrum(text: &str) -> Result<Value, String> {
    if !text.contains(':') {
        return match numbers(text)?.as_slice() {
            [value] => Ok(Value::Uniform(*value)),
            values => Err(format!(
                "the spectrum has {} numbers without wavelengths: write `400:0.1, 700:0.2`, or an <rgb>",
                values.len()
            )),
        };
    }
    let mut samples = (Vec::new(), Vec::new());
    for word in text.split(|c: char| c == ',' || c.is_whitespace()).filter(|word| !word.is_empty()) {
        let (wavelength, value) = word.split_once(':').ok_or_else(|| {
            format!("`{}` is no wavelength with its value, such as `400:0.1`", excerpt(word))
        })?;
        samples.0.push(number(wavelength)?);
        samples.1.push(number(value)?);
    }
    sampled(samples.0, samples.1)
}

/// Lines of a wavelength and a value.
pub(super) fn spectrum_file(text: &str) -> Result<Value, String> {
    let mut samples = (Vec::new(), Vec::new());
    for line in text.lines().map(str::trim).filter(|line| !line.is_empty() && !line.starts_with('#')) {
        let [wavelength, value] = numbers(line)?[..] else {
            return Err(format!("`{}` is no wavelength and value", excerpt(line)));
        };
        samples.0.push(wavelength);
        samples.1.push(value);
    }
    sampled(samples.0, samples.1)
}

/// A spectrum of samples in order.
pub(super) fn sampled(wavelengths: Vec<f64>, values: Vec<f64>) -> Result<Value, String> {
    if wavelengths.len() < 2 || wavelengths.len() != values.len() {
        return Err("the spectrum needs two wavelengths at least, and a value for each".into());
    }
    let is_increasing = wavelengths.windows(2).all(|pair| pair[0] < pair[1]);
    if !is_increasing || wavelengths[0] < 1.0 {
        return Err("the wavelengths of the spectrum must increase, in nm".into());
    }
    Ok(Value::Sampled(wavelengths, values))
}

/// The beginning of a text, for messages of one line.
pub(super) fn excerpt(text: &str) -> String {
    tyndall_machine::one_line(text, 40)
}
