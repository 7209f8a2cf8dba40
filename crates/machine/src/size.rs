//! Sizes of memory as people write them: `4GB`, `512MiB`.

/// Units and their bytes; the longer of two that end alike comes first.
const UNITS: [(&str, u64); 9] = [
    ("kib", 1 << 10),
    ("mib", 1 << 20),
    ("gib", 1 << 30),
    ("tib", 1 << 40),
    ("kb", 1_000),
    ("mb", 1_000_000),
    ("gb", 1_000_000_000),
    ("tb", 1_000_000_000_000),
    ("b", 1),
];

/// Bytes of a size such as `4GB` (10⁹ bytes each), `512MiB` (2²⁰) or `1.5 GB`.
///
/// ```
/// assert_eq!(tyndall_machine::parse_size("1.5 KiB"), Ok(1536));
/// ```
///
/// # Errors
/// If it is no number above 0 with a unit; the text says how one is written.
pub fn parse_size(text: &str) -> Result<u64, String> {
    let lower = text.trim().to_ascii_lowercase();
    let parsed = UNITS.iter().find_map(|(unit, bytes)| {
        let number = lower.strip_suffix(unit)?.trim_end().parse::<f64>().ok()?;
        Some(number * *bytes as f64)
    });
    let bytes = parsed.filter(|bytes| (1.0..u64::MAX as f64).contains(bytes));
    bytes.map(|bytes| bytes as u64).ok_or("write a size with its unit, such as 4GB or 512MiB".into())
}

/// A size to be read by people: `4.3 GB`, `12 MB`.
pub fn shown_size(bytes: u64) -> String {
    let bytes = bytes as f64;
    if bytes >= 999.5e6 { format!("{:.1} GB", bytes * 1e-9) } else { format!("{:.0} MB", bytes * 1e-6) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sizes_have_a_unit() {
        let sizes = [("4GB", 4_000_000_000), ("512MiB", 512 << 20), ("1.5 kb", 1500), ("7 b", 7)];
        for (text, bytes) in sizes {
            assert_eq!(parse_size(text), Ok(bytes), "{text}");
        }
        for wrong in ["", "4", "GB", "-1GB", "0GB", "nanGB", "infTB", "1e300GB", "4 parsecs", "4 GB b"] {
            assert!(parse_size(wrong).is_err(), "{wrong}");
        }
    }

    #[test]
    fn sizes_are_shown_in_the_unit_that_suits_them() {
        let shown = [4_294_967_296, 1_000_000_000, 999_400_000, 512 << 20].map(shown_size);
        assert_eq!(shown, ["4.3 GB", "1.0 GB", "999 MB", "537 MB"]);
    }
}
