//! Frames of an animation, and names that hold their numbers: `cloud.####.vdb` is `cloud.0007.vdb` in frame 7.

use std::ffi::OsString;
use std::path::{Path, PathBuf};
use std::str::FromStr;

/// Numbers of frames: from the first to the last, both included, in steps.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Frames {
    first: u32,
    last: u32,
    step: u32,
}

impl FromStr for Frames {
    type Err = String;

    /// `1..240`, `1..240:2` or `7`.
    fn from_str(text: &str) -> Result<Self, String> {
        let (range, step) = text.split_once(':').unwrap_or((text, "1"));
        let (first, last) = range.split_once("..").unwrap_or((range, range));
        let frames =
            || Some(Self { first: first.parse().ok()?, last: last.parse().ok()?, step: step.parse().ok()? });
        frames()
            .filter(|frames| frames.first <= frames.last && frames.step > 0)
            .ok_or_else(|| "write FIRST..LAST, FIRST..LAST:STEP or one number, such as 1..240".into())
    }
}

impl Frames {
    /// The first one.
    pub fn first(&self) -> u32 {
        self.first
    }

    /// How many there are.
    pub fn count(&self) -> u64 {
        u64::from((self.last - self.first) / self.step) + 1
    }

    /// All of them, in order.
    pub fn iter(&self) -> impl Iterator<Item = u32> + use<> {
        (self.first..=self.last).step_by(self.step as usize)
    }
}

/// Whether a name has a place for the number of a frame.
pub fn holds_frame(name: &str) -> bool {
    name.contains('#')
}

/// A name in a frame: each run of `#` is the frame's number, with zeros in front to fill the run.
pub fn at_frame(name: &str, frame: u32) -> String {
    let mut named = String::new();
    let mut rest = name;
    while let Some(start) = rest.find('#') {
        let after = rest[start..].trim_start_matches('#');
        let width = rest.len() - start - after.len();
        named += &rest[..start];
        named += &format!("{frame:0width$}");
        rest = after;
    }
    named + rest
}

/// The file that stands for `path` in a frame: by its `####`, or, if it has none, with the number before the extension,
/// `cloud.0007.exr` for `cloud.exr`.
pub fn file_at_frame(path: &Path, frame: u32) -> PathBuf {
    match path.to_str() {
        Some(name) if holds_frame(name) => at_frame(name, frame).into(),
        _ => {
            let mut name: OsString = path.file_stem().unwrap_or_default().to_owned();
            name.push(format!(".{frame:04}"));
            if let Some(extension) = path.extension() {
                name.push(".");
                name.push(extension);
            }
            path.with_file_name(name)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn frames_are_counted_with_both_ends() {
        let numbers = |text: &str| text.parse().map(|frames: Frames| frames.iter().collect::<Vec<_>>());
        assert_eq!(numbers("1..3"), Ok(vec![1, 2, 3]));
        assert_eq!(numbers("1..6:2"), Ok(vec![1, 3, 5]));
        assert_eq!(numbers("7"), Ok(vec![7]));
        assert_eq!("0..4294967295".parse::<Frames>().map(|frames| frames.count()), Ok(1 << 32));
        assert_eq!("1..6:2".parse::<Frames>().map(|frames| frames.count()), Ok(3));
        for wrong in ["", "..", "3..1", "1..5:0", "1-5", "-1..5", "1..5:", "1...5"] {
            assert!(wrong.parse::<Frames>().is_err(), "{wrong}");
        }
    }

    #[test]
    fn numbers_fill_their_place_and_grow_beyond_it() {
        assert_eq!(at_frame("a/b.####.vdb", 7), "a/b.0007.vdb");
        assert_eq!(at_frame("##/ä#.vdb", 123), "123/ä123.vdb");
        assert_eq!(at_frame("plain.vdb", 7), "plain.vdb");
    }

    #[test]
    fn outputs_without_a_place_get_the_number_before_the_extension() {
        let named = |name: &str| file_at_frame(Path::new(name), 7);
        assert_eq!(named("out/a.##.exr"), Path::new("out/a.07.exr"));
        assert_eq!(named("out/a.exr"), Path::new("out/a.0007.exr"));
        assert_eq!(named("a.b.acc"), Path::new("a.b.0007.acc"));
    }
}
