//! A phase function from a table: linear in cos θ between rows, constant beyond the first and last.
//!
//! The density p(μ) = 2π f_p of μ = cos θ is piecewise linear, so its cumulative distribution is piecewise quadratic:
//! a cell is found by bisection and the quadratic in it inverted in closed form. Samples follow the table exactly.

use std::f64::consts::TAU;
use std::fmt;

/// A table of f_p over cos θ, normalised.
#[derive(Debug, Clone, PartialEq)]
pub struct TabulatedPhase {
    /// From −1 to 1, increasing.
    cosines: Vec<f64>,
    /// f_p at them, 1/sr.
    values: Vec<f64>,
    /// Probability of lesser cosines, from 0 to 1.
    cumulative: Vec<f64>,
    mean_cosine: f64,
}

/// Why rows are no phase function.
#[derive(Debug, Clone, PartialEq)]
pub struct UnsoundTable {
    /// The row, from 0, if it is one row's fault.
    pub row: Option<usize>,
    /// What is wrong, and the mend.
    pub message: String,
}

impl fmt::Display for UnsoundTable {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.message)
    }
}

impl std::error::Error for UnsoundTable {}

impl TabulatedPhase {
    /// The phase function through rows of (cos θ, value), in increasing or decreasing order of cos θ, with values of any
    /// normalisation. At least two rows; cosines in [−1, 1], values not negative, and not all 0.
    pub fn from_cosines(rows: &[(f64, f64)]) -> Result<TabulatedPhase, UnsoundTable> {
        check(rows)?;
        let mut rows = rows.to_vec();
        if rows[0].0 > rows[1].0 {
            rows.reverse();
        }
        let (first, last) = (rows[0], rows[rows.len() - 1]);
        if first.0 > -1.0 {
            rows.insert(0, (-1.0, first.1));
        }
        if last.0 < 1.0 {
            rows.push((1.0, last.1));
        }
        // Numbers of any size: the greatest becomes 1 before anything is multiplied.
        let greatest = rows.iter().fold(0.0, |greatest: f64, row| greatest.max(row.1));
        let (cosines, mut values): (Vec<f64>, Vec<f64>) =
            rows.iter().map(|(cos, value)| (*cos, value / greatest)).unzip();

        let mut cumulative = vec![0.0];
        let (mut integral, mut moment) = (0.0, 0.0);
        for (cos, value) in cosines.windows(2).zip(values.windows(2)) {
            let width = TAU * (cos[1] - cos[0]);
            integral += width * 0.5 * (value[0] + value[1]);
            moment += width / 6.0 * (value[0] * (2.0 * cos[0] + cos[1]) + value[1] * (cos[0] + 2.0 * cos[1]));
            cumulative.push(integral);
        }
        let unsound = |row, message: &str| UnsoundTable { row, message: message.into() };
        if integral.is_nan() || integral <= 0.0 {
            return Err(unsound(None, "the values are 0 but for single angles: give some light an angle"));
        }
        values.iter_mut().for_each(|value| *value /= integral);
        cumulative.iter_mut().for_each(|probability| *probability /= integral);
        Ok(TabulatedPhase { cosines, values, cumulative, mean_cosine: moment / integral })
    }

    /// The same through rows of (θ in degrees, value).
    pub fn from_degrees(rows: &[(f64, f64)]) -> Result<TabulatedPhase, UnsoundTable> {
        if let Some(row) = rows.iter().position(|row| !(0.0..=180.0).contains(&row.0)) {
            let message = format!("the angle {} is not from 0 to 180 degrees", rows[row].0);
            return Err(UnsoundTable { row: Some(row), message });
        }
        // cos 180° is −1 to the last digit, cos 90° is 0 only nearly, which does no harm.
        let rows: Vec<(f64, f64)> =
            rows.iter().map(|(angle, value)| (libm::cos(angle.to_radians()), *value)).collect();
        TabulatedPhase::from_cosines(&rows)
    }

    /// cos θ of the rows, from −1 to 1.
    pub fn cosines(&self) -> &[f64] {
        &self.cosines
    }

    /// f_p at [`cosines`](Self::cosines), 1/sr.
    pub fn values(&self) -> &[f64] {
        &self.values
    }

    pub(super) fn value(&self, cos_theta: f64) -> f64 {
        let i = cell(&self.cosines, cos_theta);
        let (left, right) = (self.cosines[i], self.cosines[i + 1]);
        let x = (cos_theta - left) / (right - left);
        self.values[i] + x * (self.values[i + 1] - self.values[i])
    }

    pub(super) fn sample(&self, u: f64) -> f64 {
        let i = cell(&self.cumulative, u);
        let (from, to) = (self.cumulative[i], self.cumulative[i + 1]);
        let (a, b) = (self.values[i], self.values[i + 1]);
        // The share r of the cell's probability lies below x: a x + (b − a) x²/2 = r (a + b)/2.
        let r = (u - from) / (to - from);
        let root = (a * a + r * (b - a) * (b + a)).max(0.0).sqrt();
        // a = b = 0 cannot be: such a cell has no probability.
        let x = if a + root > 0.0 { r * (a + b) / (a + root) } else { 0.0 };
        let (left, right) = (self.cosines[i], self.cosines[i + 1]);
        left + x * (right - left)
    }

    pub(super) fn mean_cosine(&self) -> f64 {
        self.mean_cosine
    }
}

/// The cell of increasing `bounds` that holds `x`: the last one that starts at or below it.
fn cell(bounds: &[f64], x: f64) -> usize {
    bounds.partition_point(|bound| *bound <= x).clamp(1, bounds.len() - 1) - 1
}

fn check(rows: &[(f64, f64)]) -> Result<(), UnsoundTable> {
    let unsound = |row, message: String| Err(UnsoundTable { row, message });
    let [first, second, ..] = rows else {
        return unsound(None, "a table needs at least two rows".into());
    };
    let is_rising = first.0 < second.0;
    for (row, (cos, value)) in rows.iter().enumerate() {
        if !(-1.0..=1.0).contains(cos) {
            return unsound(Some(row), format!("the cosine {cos} is not from -1 to 1"));
        }
        if !value.is_finite() || *value < 0.0 {
            return unsound(Some(row), format!("the value {value} is negative or not finite"));
        }
        if row > 0 && (rows[row - 1].0 == *cos || (rows[row - 1].0 < *cos) != is_rising) {
            return unsound(
                Some(row),
                "the angle repeats or turns back: sort the rows, one for each angle".into(),
            );
        }
    }
    if rows.iter().all(|row| row.1 == 0.0) {
        return unsound(None, "all values are 0".into());
    }
    Ok(())
}
