//! Which samples a film holds: a union of half-open ranges of sample indices.

use serde::{Deserialize, Serialize};
use std::fmt;
use std::ops::Range;
use std::str::FromStr;

use crate::fixed_point::MAX_SAMPLES;
use crate::rates::MAX_ROUNDS;

/// Disjoint, sorted ranges without gaps of zero width: [0,64) and [64,128) become [0,128).
#[derive(Debug, Clone, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(try_from = "Vec<(u64, u64)>", into = "Vec<(u64, u64)>")]
pub struct SampleRanges(Vec<Range<u64>>);

/// Ranges that cannot be held together.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum RangeError {
    /// Some samples would be counted twice.
    #[error("samples {}..{} would be counted twice; leave them out", .0.start, .0.end)]
    Overlap(Range<u64>),
    /// A range that ends before it starts.
    #[error("samples {0}..{1} are no range: the end must not come before the start")]
    Backwards(u64, u64),
    /// A pass was begun and not finished.
    #[error("the pass that begins at sample {0} is not finished; resume it first")]
    Unfinished(u64),
    /// A pass cannot end where it should.
    #[error("some pixels hold the samples up to {held}, not up to {end}; ask for at least the former")]
    Ragged {
        /// Where the samples of some pixels end.
        held: u64,
        /// Where they should end.
        end: u64,
    },
    /// More samples than the sums have room for.
    #[error("more than {MAX_SAMPLES} samples a pixel do not fit one film; render fewer")]
    TooMany,
    /// The same of a film whose pixels have different numbers of samples.
    #[error(
        "more than {MAX_ROUNDS} samples a pixel, or samples beyond number 2^60, do not fit one film with adaptive          sampling; render fewer"
    )]
    TooManyAdaptive,
}

impl SampleRanges {
    /// The ranges in ascending order.
    pub fn as_slice(&self) -> &[Range<u64>] {
        &self.0
    }

    /// Number of samples in all ranges.
    pub fn count(&self) -> u64 {
        self.0.iter().map(|r| r.end - r.start).sum()
    }

    /// Adds a range; unchanged on error.
    pub fn insert(&mut self, range: Range<u64>) -> Result<(), RangeError> {
        self.insert_all(&Self(vec![range]))
    }

    /// Adds all ranges of another; unchanged on error.
    pub fn insert_all(&mut self, other: &Self) -> Result<(), RangeError> {
        *self = Self::normalised([self.0.as_slice(), other.0.as_slice()].concat())?;
        Ok(())
    }

    /// The ranges of `0..end` that are not held.
    pub fn missing(&self, end: u64) -> Self {
        let mut missing = Vec::new();
        let mut next = 0;
        for held in &self.0 {
            if next < held.start.min(end) {
                missing.push(next..held.start.min(end));
            }
            next = held.end;
        }
        if next < end {
            missing.push(next..end);
        }
        Self(missing)
    }

    fn normalised(mut ranges: Vec<Range<u64>>) -> Result<Self, RangeError> {
        if let Some(backwards) = ranges.iter().find(|r| r.end < r.start) {
            return Err(RangeError::Backwards(backwards.start, backwards.end));
        }
        ranges.retain(|r| r.start < r.end);
        ranges.sort_by_key(|r| r.start);
        let mut union: Vec<Range<u64>> = Vec::new();
        let mut count = 0u64;
        for range in ranges {
            count = count.saturating_add(range.end - range.start);
            match union.last_mut() {
                Some(held) if range.start < held.end => {
                    return Err(RangeError::Overlap(range.start..held.end.min(range.end)));
                }
                Some(held) if range.start == held.end => held.end = range.end,
                _ => union.push(range),
            }
        }
        if count > MAX_SAMPLES {
            return Err(RangeError::TooMany);
        }
        Ok(Self(union))
    }
}

impl fmt::Display for SampleRanges {
    /// `0..64,128..192`, or `none`.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.0.is_empty() {
            return f.write_str("none");
        }
        for (i, range) in self.0.iter().enumerate() {
            let comma = if i > 0 { "," } else { "" };
            write!(f, "{comma}{}..{}", range.start, range.end)?;
        }
        Ok(())
    }
}

impl FromStr for SampleRanges {
    type Err = String;

    /// The reverse of its display.
    fn from_str(text: &str) -> Result<Self, String> {
        let range = |text: &str| {
            let (start, end) = text.split_once("..")?;
            Some((start.parse().ok()?, end.parse().ok()?))
        };
        let ranges = match text {
            "none" => Some(Vec::new()),
            text => text.split(',').map(range).collect::<Option<Vec<(u64, u64)>>>(),
        };
        let ranges =
            ranges.ok_or_else(|| format!("`{text}` are no ranges of samples such as 0..64,128..192"))?;
        Self::try_from(ranges).map_err(|error| error.to_string())
    }
}

impl TryFrom<Vec<(u64, u64)>> for SampleRanges {
    type Error = RangeError;

    fn try_from(pairs: Vec<(u64, u64)>) -> Result<Self, RangeError> {
        Self::normalised(pairs.into_iter().map(|(start, end)| start..end).collect())
    }
}

impl From<SampleRanges> for Vec<(u64, u64)> {
    fn from(ranges: SampleRanges) -> Self {
        ranges.0.into_iter().map(|r| (r.start, r.end)).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ranges(pairs: &[(u64, u64)]) -> Result<SampleRanges, RangeError> {
        SampleRanges::try_from(pairs.to_vec())
    }

    #[test]
    fn any_order_gives_the_same_union() {
        let whole = ranges(&[(0, 128)]);
        assert_eq!(ranges(&[(64, 128), (0, 64)]), whole);
        assert_eq!(ranges(&[(0, 10), (100, 128), (10, 100), (5, 5)]), whole);
        assert_eq!(ranges(&[(0, 1), (2, 3)]).map(|r| r.to_string()), Ok("0..1,2..3".to_string()));
    }

    #[test]
    fn ranges_are_read_as_they_are_shown() {
        for pairs in [&[][..], &[(0, 64)], &[(3, 7), (9, 12)]] {
            let shown = ranges(pairs).unwrap().to_string();
            assert_eq!(shown.parse(), Ok(ranges(pairs).unwrap()), "{shown}");
        }
        for wrong in ["", "0", "0..", "5..3", "0..4,2..6", "a..b"] {
            assert!(wrong.parse::<SampleRanges>().is_err(), "{wrong}");
        }
    }

    #[test]
    fn what_is_missing_completes_the_whole() {
        let missing = |held: &[(u64, u64)], end| ranges(held).unwrap().missing(end).to_string();
        assert_eq!(missing(&[], 8), "0..8");
        assert_eq!(missing(&[(2, 4), (6, 7)], 10), "0..2,4..6,7..10");
        assert_eq!(missing(&[(2, 4), (6, 7)], 6), "0..2,4..6");
        assert_eq!(missing(&[(2, 4), (6, 9)], 3), "0..2");
        assert_eq!(missing(&[(0, 4)], 4), "none");
        assert_eq!(missing(&[(0, 4)], 0), "none");
    }

    #[test]
    fn overlaps_name_what_is_common() {
        assert_eq!(ranges(&[(0, 64), (50, 70)]), Err(RangeError::Overlap(50..64)));
        assert_eq!(ranges(&[(0, 64), (0, 64)]), Err(RangeError::Overlap(0..64)));
    }

    #[test]
    fn impossible_ranges_are_refused() {
        assert_eq!(ranges(&[(0, u64::MAX)]), Err(RangeError::TooMany));
        assert_eq!(ranges(&[(0, MAX_SAMPLES), (MAX_SAMPLES, MAX_SAMPLES + 1)]), Err(RangeError::TooMany));
        assert_eq!(ranges(&[(7, 3)]), Err(RangeError::Backwards(7, 3)));
    }
}
