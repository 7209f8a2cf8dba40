//! A refractive index as a table over wavelength, read from text.
//!
//! The format is CSV: lines that begin with `#` are comments, the first other line is `wavelength_um,n,k` or
//! `wavelength_nm,n,k`, and each line after it is one wavelength, in increasing order. Between two wavelengths n is
//! linear; so is the logarithm of k, which runs over many orders of magnitude (unless one of them is 0, where k itself
//! is linear).

use thiserror::Error;

use super::RefractiveIndex;

/// Tables are short; more lines than this are something else.
const MOST_LINES: usize = 100_000;

/// A refractive index over wavelength.
#[derive(Debug, Clone, PartialEq)]
pub struct RefractiveIndexTable {
    /// Wavelength in nm with the index there; increasing, at least one.
    rows: Vec<(f64, RefractiveIndex)>,
}

/// What is wrong with a table, with the line, from 1.
#[derive(Debug, Clone, PartialEq, Error)]
#[error("line {line}: {message}")]
pub struct TableError {
    /// The line, from 1.
    pub line: usize,
    /// What is wrong, and the mend.
    pub message: String,
}

impl RefractiveIndexTable {
    /// Reads the text of a table.
    pub fn parse(text: &str) -> Result<Self, TableError> {
        let mut lines = text
            .lines()
            .enumerate()
            .map(|(index, line)| (index + 1, line.trim()))
            .filter(|(_, line)| !line.is_empty() && !line.starts_with('#'));
        let refuse = |line, message: String| Err(TableError { line, message });
        let heading = lines.next().map(|(line, text)| (line, text.replace(' ', "")));
        let nm_per_unit = match heading {
            Some((_, heading)) if heading == "wavelength_um,n,k" => 1e3,
            Some((_, heading)) if heading == "wavelength_nm,n,k" => 1.0,
            other => {
                let mend = "the first line must be `wavelength_um,n,k` or `wavelength_nm,n,k`";
                return refuse(other.map_or(1, |(line, _)| line), mend.into());
            }
        };
        let mut rows: Vec<(f64, RefractiveIndex)> = Vec::new();
        for (line, text) in lines {
            if rows.len() == MOST_LINES {
                return refuse(line, format!("a table has at most {MOST_LINES} wavelengths"));
            }
            let numbers: Vec<f64> = text.split(',').filter_map(|field| field.trim().parse().ok()).collect();
            let &[wavelength, n, k] = numbers.as_slice() else {
                return refuse(line, "each line is three numbers: wavelength, n, k".into());
            };
            let wavelength = wavelength * nm_per_unit;
            if !(wavelength > 0.0 && wavelength.is_finite()) {
                return refuse(line, "the wavelength must be greater than 0".into());
            }
            if rows.last().is_some_and(|(before, _)| *before >= wavelength) {
                return refuse(line, "wavelengths must increase from line to line".into());
            }
            let index = RefractiveIndex { n, k };
            if let Err(error) = index.check() {
                return refuse(line, error.to_string());
            }
            rows.push((wavelength, index));
        }
        if rows.is_empty() {
            return refuse(1, "the table has no wavelengths".into());
        }
        Ok(Self { rows })
    }

    /// Wavelengths in nm, increasing, with the index at each.
    pub fn rows(&self) -> impl Iterator<Item = (f64, RefractiveIndex)> + '_ {
        self.rows.iter().copied()
    }

    /// First and last wavelength, nm.
    pub fn range(&self) -> [f64; 2] {
        [self.rows[0].0, self.rows[self.rows.len() - 1].0]
    }

    /// The index at a wavelength in nm; `None` outside the table.
    pub fn at(&self, wavelength: f64) -> Option<RefractiveIndex> {
        let [first, last] = self.range();
        if !(first..=last).contains(&wavelength) {
            return None;
        }
        let above = self.rows.partition_point(|(row, _)| *row < wavelength);
        let (long, high) = self.rows[above];
        if above == 0 || long == wavelength {
            return Some(high);
        }
        let (short, low) = self.rows[above - 1];
        let part = (wavelength - short) / (long - short);
        let between = |a: f64, b: f64| a + part * (b - a);
        let k = match (low.k, high.k) {
            (a, b) if a > 0.0 && b > 0.0 => libm::exp(between(libm::log(a), libm::log(b))),
            (a, b) => between(a, b),
        };
        Some(RefractiveIndex { n: between(low.n, high.n), k })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn n_is_linear_and_k_geometric_between_wavelengths() {
        let table =
            RefractiveIndexTable::parse("# of nothing\nwavelength_um, n, k\n0.4,1.4,1e-9\n0.6,1.2,1e-5\n")
                .unwrap();
        let middle = table.at(500.0).unwrap();
        assert!((middle.n - 1.3).abs() < 1e-12 && (middle.k / 1e-7 - 1.0).abs() < 1e-9, "{middle:?}");
        assert_eq!(table.at(400.0), Some(RefractiveIndex { n: 1.4, k: 1e-9 }));
        assert_eq!(table.at(600.0), Some(RefractiveIndex { n: 1.2, k: 1e-5 }));
        assert_eq!((table.at(399.9), table.at(600.1), table.at(f64::NAN)), (None, None, None));
    }

    #[test]
    fn k_of_zero_is_met_on_a_line() {
        let table = RefractiveIndexTable::parse("wavelength_nm,n,k\n400,1.4,0\n600,1.2,2e-5\n").unwrap();
        assert!((table.at(500.0).unwrap().k - 1e-5).abs() < 1e-18);
    }

    #[test]
    fn a_wrong_table_is_refused_with_its_line() {
        for (text, line, part) in [
            ("", 1, "first line"),
            ("#\n\n0.5,1.3,0\n", 3, "first line"),
            ("wavelength_nm,n,k\n", 1, "no wavelengths"),
            ("wavelength_nm,n,k\n500,1.3\n", 2, "three numbers"),
            ("wavelength_nm,n,k\n500,1.3,zero\n", 2, "three numbers"),
            ("wavelength_nm,n,k\n500,1.3,0\n400,1.3,0\n", 3, "increase"),
            ("wavelength_nm,n,k\n500,1.3,-1e-9\n", 2, "k from 0"),
            ("wavelength_nm,n,k\n500,NaN,0\n", 2, "n must be"),
            ("wavelength_nm,n,k\n-5,1.3,0\n", 2, "greater than 0"),
            ("wavelength_nm,n,k\ninf,1.3,0\n", 2, "greater than 0"),
        ] {
            let error = RefractiveIndexTable::parse(text).unwrap_err();
            assert!(error.line == line && error.message.contains(part), "{text:?}: {error}");
        }
    }
}
