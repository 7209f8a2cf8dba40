//! Options for when a render is done: a number of samples, an error, a time, whichever comes first.

use std::ops::Range;
use std::time::Duration;

use tyndall_session::Goal;

/// When to stop
#[derive(Debug, Clone, Default, clap::Args)]
pub struct GoalArgs {
    /// Samples for each pixel [default: what the scene says, or 64]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..))]
    spp: Option<u32>,
    /// Stop when the median relative standard error of the pixels is below this, such as 1%
    #[arg(long, value_name = "REL", value_parser = parse_error)]
    error: Option<f64>,
    /// Stop after this time, such as 90s, 10min, 2h
    #[arg(long, value_name = "TIME", value_parser = parse_time)]
    time: Option<Duration>,
}

impl GoalArgs {
    /// As the session takes it; with `samples`, only these are rendered.
    pub fn with_samples(&self, samples: Option<Range<u64>>) -> Goal {
        Goal { spp: self.spp, samples, error: self.error, time: self.time }
    }
}

/// A share, such as 1% or 0.01.
pub fn parse_error(text: &str) -> Result<f64, String> {
    let (number, scale) = match text.strip_suffix('%') {
        Some(percent) => (percent.trim(), 0.01),
        None => (text, 1.0),
    };
    let error = number.parse::<f64>().ok().map(|number| number * scale);
    error.filter(|e| e.is_finite() && *e > 0.0).ok_or("write a share above 0, such as 1% or 0.01".into())
}

/// A time, such as 90s, 10min or 2h.
pub fn parse_time(text: &str) -> Result<Duration, String> {
    let split = text.find(|c: char| c.is_ascii_alphabetic()).unwrap_or(text.len());
    let (number, unit) = text.split_at(split);
    let seconds = match unit {
        "" | "s" | "sec" => 1.0,
        "m" | "min" => 60.0,
        "h" => 3600.0,
        _ => return Err("write a number and s, min or h, such as 90s".into()),
    };
    let time = number.trim().parse::<f64>().ok().map(|number| number * seconds);
    time.and_then(|s| Duration::try_from_secs_f64(s).ok())
        .filter(|time| !time.is_zero())
        .ok_or("write a time above 0, such as 90s, 10min or 2h".into())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn errors_and_times_are_read_with_their_units() {
        assert_eq!(parse_error("1%"), Ok(0.01));
        assert_eq!(parse_error("0.05"), Ok(0.05));
        assert!(parse_error("-1%").is_err() && parse_error("nan").is_err() && parse_error("").is_err());
        assert_eq!(parse_time("90s"), Ok(Duration::from_secs(90)));
        assert_eq!(parse_time("1.5min"), Ok(Duration::from_secs(90)));
        assert!(parse_time("10 parsecs").is_err() && parse_time("0").is_err() && parse_time("-3s").is_err());
    }
}
