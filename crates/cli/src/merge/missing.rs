//! `tyndall merge --missing`: which samples no file holds, and the commands that would render them.

use std::fmt::Write;
use std::path::{Path, PathBuf};

use miette::{IntoDiagnostic, miette};
use tyndall_film::Provenance;

use crate::terminal::{answer, tell};

/// Prints a command for each range of samples below `of`, or below the greatest one that is held, that none of the files
/// holds. Files that are damaged count as not there.
pub fn run(files: &[PathBuf], of: Option<u64>) -> miette::Result<()> {
    let mut held: Option<(&Path, Provenance)> = None;
    for file in files {
        let part = match Provenance::of_accumulation(file) {
            Ok(part) if part.open.is_none() => part,
            Ok(_) => {
                tell(format!("note: {}: was interrupted; its samples count as missing", file.display()));
                continue;
            }
            Err(error) => {
                tell(format!("note: {error}; its samples count as missing"));
                continue;
            }
        };
        match &mut held {
            Some((first, held)) => held.join(first, &part, file).into_diagnostic()?,
            None => held = Some((file, part)),
        }
    }
    let Some((first, held)) = held else {
        return Err(miette!(
            "--missing: no file is whole, so that it is not known of which render; see the notes"
        ));
    };
    let end = of.or(held.samples.as_slice().last().map(|range| range.end)).unwrap_or(0);
    let missing = held.samples.missing(end);
    tell(match missing.count() {
        0 => format!("of the samples 0..{end} none is missing"),
        _ => format!("of the samples 0..{end} these are missing: {missing}"),
    });
    let commands = missing.as_slice().iter().map(|range| {
        let name = format!("samples-{}-{}.acc", range.start, range.end);
        let samples = format!("--samples {}..{}", range.start, range.end);
        let output = quoted(&first.with_file_name(name).display().to_string());
        format!("tyndall render INPUT {samples}{} -o {output}\n", options(&held))
    });
    answer(commands.collect::<String>())
}

/// What the command line has to say for the same samples, beside the scene.
fn options(made: &Provenance) -> String {
    let mut options = format!(" --seed {}", made.seed);
    for option in made.options.split_whitespace() {
        if let Some((name @ ("integrator" | "sampler" | "distance" | "transmittance"), value)) =
            option.split_once('=')
        {
            // Writing to a string cannot fail.
            let _ = write!(options, " --{name} {value}");
        }
        if option == "adaptive=yes" {
            options.push_str(" --adaptive");
        }
    }
    options
}

/// A word of a shell's command line.
fn quoted(word: &str) -> String {
    let is_plain = |c: char| c.is_alphanumeric() || "/._-+=:,@%".contains(c);
    if word.chars().all(is_plain) { word.to_owned() } else { format!("'{}'", word.replace('\'', r"'\''")) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_with_blanks_and_quotes_are_quoted_for_the_shell() {
        assert_eq!(quoted("parts/a-1.acc"), "parts/a-1.acc");
        assert_eq!(quoted("my parts/a.acc"), "'my parts/a.acc'");
        assert_eq!(quoted("it's"), r"'it'\''s'");
    }
}
