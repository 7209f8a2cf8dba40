//! Phase functions in text files: an angle and a value on each line, or a value for each of some wavelengths.
//!
//! - I3RC (Cahalan et al. 2005): two columns of blanks and numbers, angle in degrees and value;
//! - libRadtran (Emde et al. 2016) and its like: the same with comments after `#` or `!`, perhaps more columns;
//! - CSV with a header: `angle_deg,value`, or `angle_deg,450,550,650` with wavelengths in nm, or `cos_theta,…`.
//!
//! Numbers may be separated by commas, semicolons, tabs or blanks. Without a header the first column is the angle in
//! degrees. More than one column of values needs a header that tells their wavelengths; it may stand in a comment.
//! Values have any normalisation.

use std::fmt;
use std::io::Read;
use std::path::Path;
use std::sync::Arc;

use tyndall_machine::files;

use super::{PhaseFunction, SpectralPhase, TabulatedPhase};

/// A larger file is no table of a phase function.
const GREATEST_FILE: u64 = 16 << 20;

/// Why a file is no table of a phase function; displays as one line.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct PhaseTableError {
    /// The line, from 1, if it is one line's fault.
    pub line: Option<usize>,
    /// What is wrong, and the mend.
    pub message: String,
}

impl fmt::Display for PhaseTableError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.line {
            Some(line) => write!(f, "line {line}: {}", self.message),
            None => f.write_str(&self.message),
        }
    }
}

impl std::error::Error for PhaseTableError {}

fn refuse<T>(line: Option<usize>, message: impl Into<String>) -> Result<T, PhaseTableError> {
    Err(PhaseTableError { line, message: message.into() })
}

/// Reads the table of a file; errors do not repeat its name.
pub fn read_phase_table(path: &Path) -> Result<SpectralPhase, PhaseTableError> {
    let mut bytes = Vec::new();
    let read = files::open(path).and_then(|file| file.take(GREATEST_FILE + 1).read_to_end(&mut bytes));
    if let Err(error) = read {
        let message = match error.kind() {
            std::io::ErrorKind::NotFound => "there is no such file; mend the name".into(),
            _ => error.to_string(),
        };
        return refuse(None, message);
    }
    if bytes.len() as u64 > GREATEST_FILE {
        return refuse(None, "more than 16 MiB of text is no table of a phase function");
    }
    match std::str::from_utf8(&bytes) {
        Ok(text) => parse_phase_table(text),
        Err(_) => refuse(None, "is not text, so it is no table of a phase function"),
    }
}

/// What the columns mean.
#[derive(Default)]
struct Header {
    has_cosines: bool,
    /// Of each column of values; empty if there is but one.
    wavelengths_nm: Vec<f64>,
}

/// Reads a table from text.
pub fn parse_phase_table(text: &str) -> Result<SpectralPhase, PhaseTableError> {
    let mut header = None;
    // (number of the line, its numbers)
    let mut rows: Vec<(usize, Vec<f64>)> = Vec::new();
    for (index, line) in text.trim_start_matches('\u{feff}').lines().enumerate() {
        let number = index + 1;
        let (content, comment) = match line.find(['#', '!']) {
            Some(at) => (&line[..at], &line[at + 1..]),
            None => (line, ""),
        };
        if content.trim().is_empty() {
            if rows.is_empty() && header.is_none() {
                header = parse_header(comment);
            }
            continue;
        }
        let numbers: Option<Vec<f64>> = fields(content).map(|field| field.parse().ok()).collect();
        match numbers {
            Some(numbers) => match rows.first() {
                Some((_, first)) if first.len() != numbers.len() => {
                    let message =
                        format!("{} numbers, where the rows above have {}", numbers.len(), first.len());
                    return refuse(Some(number), message);
                }
                _ => rows.push((number, numbers)),
            },
            None if rows.is_empty() => match parse_header(content) {
                Some(found) => header = Some(found),
                None => {
                    return refuse(
                        Some(number),
                        "neither numbers nor a header such as `angle_deg,value` or `angle_deg,450,550,650` (nm)",
                    );
                }
            },
            None => return refuse(Some(number), "not a row of numbers"),
        }
    }
    build(&header.unwrap_or_default(), &rows)
}

fn fields(line: &str) -> impl Iterator<Item = &str> {
    line.split([',', ';', '\t', ' ', '\r']).map(str::trim).filter(|field| !field.is_empty())
}

/// Names of columns, if these words are such.
fn parse_header(line: &str) -> Option<Header> {
    let mut words = fields(line);
    let first = words.next()?.to_ascii_lowercase();
    let has_cosines = first.starts_with("cos") || first == "mu";
    if !has_cosines && !first.starts_with("angle") && !first.starts_with("theta") {
        return None;
    }
    let wavelength = |word: &str| {
        let digits = word.trim_start_matches(|c: char| !c.is_ascii_digit());
        digits.trim_end_matches("nm").trim_end_matches('_').parse::<f64>().ok()
    };
    let wavelengths: Vec<Option<f64>> = words.map(wavelength).collect();
    // `angle_deg,value` names no wavelength, and need not.
    let wavelengths_nm = wavelengths.into_iter().collect::<Option<Vec<f64>>>().unwrap_or_default();
    Some(Header { has_cosines, wavelengths_nm })
}

fn build(header: &Header, rows: &[(usize, Vec<f64>)]) -> Result<SpectralPhase, PhaseTableError> {
    let Some((first_line, first)) = rows.first() else {
        return refuse(None, "has no rows of numbers: give an angle in degrees and a value on each line");
    };
    let columns = first.len().saturating_sub(1);
    if columns == 0 {
        return refuse(Some(*first_line), "a row needs an angle in degrees and a value");
    }
    let has_wavelengths = header.wavelengths_nm.len() == columns;
    if columns > 1 && !has_wavelengths {
        let message = format!(
            "{columns} values a row need a header that tells their wavelengths in nm, such as `angle_deg,450,550,650`"
        );
        return refuse(Some(*first_line), message);
    }
    let mut phases = Vec::with_capacity(columns);
    for column in 1..=columns {
        let pairs: Vec<(f64, f64)> = rows.iter().map(|(_, numbers)| (numbers[0], numbers[column])).collect();
        let table = if header.has_cosines {
            TabulatedPhase::from_cosines(&pairs)
        } else {
            TabulatedPhase::from_degrees(&pairs)
        };
        let table = table.or_else(|error| {
            let mend = match error.row {
                Some(row) if !header.has_cosines && rows[row].1[0] < 0.0 => {
                    "; cosines need a header such as `cos_theta,value`"
                }
                _ => "",
            };
            refuse(error.row.map(|row| rows[row].0), format!("{}{mend}", error.message))
        })?;
        phases.push(PhaseFunction::Tabulated(Arc::new(table)));
    }
    if !has_wavelengths {
        return Ok(SpectralPhase::from(phases.swap_remove(0)));
    }
    let by_wavelength = header.wavelengths_nm.iter().copied().zip(phases).collect();
    match SpectralPhase::new(by_wavelength) {
        Some(phase) => Ok(phase),
        None => refuse(None, "the header's wavelengths in nm must be above 0 and differ"),
    }
}
