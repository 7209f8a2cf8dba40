//! Measured values with their errors, for programs and for people.

use serde::Serialize;
use tyndall_transport::walk::Estimate;

/// A value in JSON.
#[derive(Debug, Clone, Copy, Serialize)]
pub struct Value {
    mean: f64,
    standard_error: f64,
}

impl From<Estimate> for Value {
    fn from(Estimate { mean, standard_error }: Estimate) -> Self {
        Self { mean, standard_error }
    }
}

/// The value with two digits of its error, and as many of its own as those make sense of.
pub fn with_error(Estimate { mean, standard_error }: Estimate) -> String {
    if standard_error == 0.0 {
        return format!("{mean:<9.6} exact     ");
    }
    let digits = (1.0 - standard_error.log10().floor()).clamp(0.0, 15.0);
    let digits = if digits.is_finite() { digits as usize } else { 2 };
    format!("{mean:<9.digits$} +- {standard_error:<7.digits$}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_value_has_the_digits_that_its_error_leaves() {
        let shown =
            |mean, standard_error| with_error(Estimate { mean, standard_error }).trim_end().to_owned();
        assert_eq!(shown(0.123_456_7, 0.000_321), "0.12346   +- 0.00032");
        assert_eq!(shown(12.345, 1.5), "12.3      +- 1.5");
        assert_eq!(shown(0.135_335_28, 0.0), "0.135335  exact");
        assert_eq!(shown(0.0, 1e-6), "0.0000000 +- 0.0000010");
    }
}
