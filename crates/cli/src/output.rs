//! Files that a picture is written to, chosen by their extension.

use std::path::{Path, PathBuf};

use miette::IntoDiagnostic;
use tyndall_film::{Accumulation, Summary, write_exr, write_png};

/// A file that `-o` names: `.exr`, `.png`, `.acc` or `.json`.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Output {
    path: PathBuf,
    format: Format,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Format {
    Exr,
    Png,
    Accumulation,
    Json,
}

impl std::str::FromStr for Output {
    type Err = String;

    fn from_str(path: &str) -> Result<Self, String> {
        let path = PathBuf::from(path);
        let extension = path.extension().map(|e| e.to_string_lossy().to_lowercase());
        let format = match extension.as_deref() {
            Some("exr") => Format::Exr,
            Some("png") => Format::Png,
            Some("acc") => Format::Accumulation,
            Some("json") => Format::Json,
            _ => return Err("the name must end in .exr, .png, .acc or .json".into()),
        };
        Ok(Self { path, format })
    }
}

impl Output {
    /// Where it goes.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Writes the picture; `exposure` in stops only concerns `.png`.
    pub fn write(&self, picture: &Accumulation, exposure: f32) -> miette::Result<()> {
        let Accumulation { film, metadata } = picture;
        match self.format {
            Format::Exr => write_exr(&self.path, film, metadata),
            Format::Png => write_png(&self.path, film, exposure),
            Format::Accumulation => picture.write(&self.path),
            Format::Json => Summary::new(film, metadata).write_json(&self.path),
        }
        .into_diagnostic()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_extension_decides_in_any_case_and_others_are_refused() {
        assert_eq!("a/b.EXR".parse::<Output>().map(|o| o.format), Ok(Format::Exr));
        assert!("a.exr.gz".parse::<Output>().is_err() && "exr".parse::<Output>().is_err());
    }
}
