//! Scales: from numbers to places on the sheet, linear or logarithmic, with ticks at round numbers.

/// How numbers are spread.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// Evenly.
    Linear,
    /// By their logarithm; numbers up to 0 have no place.
    Log,
}

/// A scale between two numbers and two places.
#[derive(Debug, Clone, Copy)]
pub struct Scale {
    kind: Kind,
    numbers: [f64; 2],
    pixels: [f64; 2],
}

/// A mark on a scale.
pub struct Tick {
    /// Where.
    pub pixel: f64,
    /// What is written there; empty for minor ticks.
    pub label: String,
}

/// More decades than anyone looks at; what is below has no place.
const MOST_DECADES: f64 = 12.0;

impl Scale {
    /// A scale from the first number, at the first pixel, to the second.
    pub fn new(kind: Kind, numbers: [f64; 2], pixels: [f64; 2]) -> Scale {
        Scale { kind, numbers, pixels }
    }

    /// A scale that shows all of `values`: linear from 0, or over whole decades.
    pub fn around(kind: Kind, values: impl Iterator<Item = f64>, pixels: [f64; 2]) -> Scale {
        let shown = values.filter(|value| value.is_finite() && (kind == Kind::Linear || *value > 0.0));
        let bounds = shown.fold(None, |bounds: Option<[f64; 2]>, value| {
            let [low, high] = bounds.unwrap_or([value; 2]);
            Some([low.min(value), high.max(value)])
        });
        let numbers = match (kind, bounds) {
            (_, None) => [1.0, 10.0],
            (Kind::Linear, Some([low, high])) => {
                let high = if high > low.min(0.0) { high } else { low + 1.0 };
                [low.min(0.0), high]
            }
            (Kind::Log, Some([low, high])) => {
                let top = high.log10().ceil();
                let bottom = low.log10().floor().min(top - 1.0).max(top - MOST_DECADES);
                [10_f64.powf(bottom), 10_f64.powf(top)]
            }
        };
        Scale { kind, numbers, pixels }
    }

    /// The place of a number, if it has one.
    pub fn at(&self, number: f64) -> Option<f64> {
        let [low, high] = self.numbers;
        let share = match self.kind {
            Kind::Linear => (number - low) / (high - low),
            Kind::Log if number > 0.0 => (number / low).log10() / (high / low).log10(),
            Kind::Log => return None,
        };
        let [start, end] = self.pixels;
        // Below a logarithmic scale's end there is no place, instead of one off the sheet.
        (share.is_finite() && (self.kind == Kind::Linear || share >= -1e-9))
            .then_some(start + share * (end - start))
    }

    /// Ticks at round numbers; every `step`, if it is given, of a linear scale.
    pub fn ticks(&self, step: Option<f64>) -> Vec<Tick> {
        match self.kind {
            Kind::Linear => self.linear_ticks(step),
            Kind::Log => self.decades(),
        }
    }

    fn linear_ticks(&self, step: Option<f64>) -> Vec<Tick> {
        let [low, high] = self.numbers;
        let step = step.unwrap_or_else(|| round_step((high - low) / 6.0));
        let digits = (-step.log10().floor()).max(0.0) as usize;
        let (first, last) = ((low / step).ceil() as i64, (high / step + 1e-9).floor() as i64);
        let ticks = (first..=last).filter_map(|n| {
            let number = n as f64 * step;
            let large = number.abs() >= 1e5 || digits > 4;
            let label = if large && n != 0 { format!("{number:.1e}") } else { format!("{number:.digits$}") };
            Some(Tick { pixel: self.at(number)?, label })
        });
        ticks.collect()
    }

    fn decades(&self) -> Vec<Tick> {
        let [low, high] = self.numbers.map(|number| number.log10().round() as i32);
        let every = ((high - low + 7) / 8).max(1);
        let mut ticks = Vec::new();
        for decade in low..=high {
            let is_major = (decade - low) % every == 0;
            let number = 10_f64.powi(decade);
            let label = match decade {
                _ if !is_major => String::new(),
                0 => "1".into(),
                1 => "10".into(),
                _ => format!("10^{decade}"),
            };
            ticks.extend(self.at(number).map(|pixel| Tick { pixel, label }));
            if every == 1 && decade < high {
                let minor = (2..10).filter_map(|n| self.at(f64::from(n) * number));
                ticks.extend(minor.map(|pixel| Tick { pixel, label: String::new() }));
            }
        }
        ticks
    }
}

/// The least of 1, 2, 5 times a power of ten that is not below `step`.
fn round_step(step: f64) -> f64 {
    let power = 10_f64.powf(step.log10().floor());
    [1.0, 2.0, 5.0, 10.0].map(|digit| digit * power).into_iter().find(|s| *s >= step).unwrap_or(10.0 * power)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn labels(scale: &Scale) -> Vec<String> {
        scale.ticks(None).into_iter().map(|tick| tick.label).filter(|label| !label.is_empty()).collect()
    }

    #[test]
    fn ticks_stand_at_round_numbers() {
        let linear = Scale::around(Kind::Linear, [0.02, 0.071].into_iter(), [0.0, 100.0]);
        assert_eq!(labels(&linear), ["0.00", "0.02", "0.04", "0.06"]);
        let log = Scale::around(Kind::Log, [0.003, 20.0, 0.0, f64::NAN].into_iter(), [100.0, 0.0]);
        assert_eq!(labels(&log), ["10^-3", "10^-2", "10^-1", "1", "10", "10^2"]);
        assert_eq!((log.at(1e-3), log.at(100.0), log.at(0.0)), (Some(100.0), Some(0.0), None));
    }

    #[test]
    fn any_values_have_a_scale() {
        for values in
            [vec![], vec![0.0], vec![5.0], vec![f64::INFINITY], vec![1e-300, 1e300], vec![-1.0, -1.0]]
        {
            for kind in [Kind::Linear, Kind::Log] {
                let scale = Scale::around(kind, values.iter().copied(), [0.0, 100.0]);
                let ticks = scale.ticks(None);
                assert!(ticks.len() < 120 && ticks.iter().all(|tick| tick.pixel.is_finite()), "{values:?}");
            }
        }
    }
}
