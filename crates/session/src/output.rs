//! Files that a picture is written to, chosen by their extension.

use std::path::{Path, PathBuf};

use tyndall_film::{Accumulation, Colours, ImageMetadata, Provenance, Summary, write_bands_exr, write_png};

use crate::frames::file_at_frame;
use crate::{Plan, SessionError};

/// A file for a picture: `.exr`, `.png`, `.acc` or `.json`.
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

    /// The same in a frame of an animation; see [`file_at_frame`].
    pub fn at_frame(&self, frame: u32) -> Self {
        Self { path: file_at_frame(&self.path, frame), format: self.format }
    }

    /// Whether the file is whole and of this picture, with the samples of the plan. A `.png` does not say of which picture
    /// it is.
    pub(crate) fn holds(&self, making: &ImageMetadata, plan: &Plan) -> bool {
        let provenance = match self.format {
            Format::Png => return is_whole_png(&self.path),
            Format::Exr => Provenance::of_exr(&self.path),
            Format::Accumulation => Provenance::of_accumulation(&self.path),
            Format::Json => Provenance::of_summary(&self.path),
        };
        provenance.is_ok_and(|of| {
            (&of.scene_hash, &of.version, &of.options, of.seed)
                == (&making.scene_hash, &making.version, &making.options, making.seed)
                && plan.is_fulfilled_by(&of.samples)
        })
    }

    fn write(&self, pictures: &[Accumulation], exposure: f32) -> Result<(), SessionError> {
        let Some(Accumulation { film, metadata }) = pictures.first() else { return Ok(()) };
        Ok(match self.format {
            Format::Exr => write_bands_exr(&self.path, pictures),
            Format::Png => write_png(&self.path, film, exposure),
            Format::Accumulation => pictures[0].write(&self.path),
            Format::Json => {
                let summary = Summary::of_bands(pictures).unwrap_or_else(|| Summary::new(film, metadata));
                summary.write_json(&self.path)
            }
        }?)
    }

    /// Refuses files that cannot hold a picture of these colours, made of so many films.
    ///
    /// # Errors
    /// If this is one.
    pub fn check_colours(&self, colours: &Colours, films: usize) -> Result<(), SessionError> {
        match self.format {
            Format::Png if *colours != Colours::Rgb => Err(SessionError::refuse_file(
                &self.path,
                "a .png shows red, green and blue, which XYZ and bands are not; name an .exr or .json",
            )),
            Format::Accumulation if films > 1 => Err(SessionError::refuse_file(
                &self.path,
                "an .acc file holds at most three bands; give fewer in film.bands, or name an .exr or .json",
            )),
            _ => Ok(()),
        }
    }
}

fn is_whole_png(path: &Path) -> bool {
    std::fs::read(path).is_ok_and(|bytes| {
        bytes.starts_with(b"\x89PNG\r\n\x1a\n") && bytes.ends_with(b"IEND\xae\x42\x60\x82")
    })
}

/// Writes the picture, which is several films if it has more than three bands, to all of `outputs`; `exposure` in stops
/// only concerns `.png`.
///
/// One that cannot be written does not keep the picture from the others.
///
/// # Errors
/// If a file cannot be written; the first such.
pub fn write_all(outputs: &[Output], pictures: &[Accumulation], exposure: f32) -> Result<(), SessionError> {
    let written: Vec<_> = outputs.iter().map(|output| output.write(pictures, exposure)).collect();
    written.into_iter().collect()
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
