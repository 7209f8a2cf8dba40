//! Files that a picture is written to, chosen by their extension.

use std::path::{Path, PathBuf};

use miette::{IntoDiagnostic, miette};
use tyndall_film::{Accumulation, Colours, Summary, write_bands_exr, write_png};

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

    fn write(&self, pictures: &[Accumulation], exposure: f32) -> miette::Result<()> {
        let Some(Accumulation { film, metadata }) = pictures.first() else { return Ok(()) };
        match self.format {
            Format::Exr => write_bands_exr(&self.path, pictures),
            Format::Png => write_png(&self.path, film, exposure),
            Format::Accumulation => pictures[0].write(&self.path),
            Format::Json => {
                let summary = Summary::of_bands(pictures).unwrap_or_else(|| Summary::new(film, metadata));
                summary.write_json(&self.path)
            }
        }
        .into_diagnostic()
    }

    /// Refuses files that cannot hold a picture of these colours, made of so many films.
    pub fn check_colours(&self, colours: &Colours, films: usize) -> miette::Result<()> {
        match self.format {
            Format::Png if *colours != Colours::Rgb => Err(miette!(
                "{}: a .png shows red, green and blue, which XYZ and bands are not; name an .exr or .json",
                self.path.display()
            )),
            Format::Accumulation if films > 1 => Err(miette!(
                "{}: an .acc file holds at most three bands; give fewer in film.bands, or name an .exr or .json",
                self.path.display()
            )),
            _ => Ok(()),
        }
    }
}

/// Writes the picture, which is several films if it has more than three bands, to all of `outputs`; `exposure` in stops
/// only concerns `.png`.
///
/// One that cannot be written does not keep the picture from the others.
pub fn write_all(outputs: &[Output], pictures: &[Accumulation], exposure: f32) -> miette::Result<()> {
    let written: Vec<_> = outputs.iter().map(|output| output.write(pictures, exposure)).collect();
    written.into_iter().collect()
}

/// Refuses files that cannot be made: it is better to hear now than after an hour of rendering.
pub fn check_writable<'a>(paths: impl IntoIterator<Item = &'a Path>) -> miette::Result<()> {
    for path in paths {
        let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty());
        let folder = folder.unwrap_or(Path::new("."));
        if !folder.is_dir() {
            return Err(miette!("{}: its folder does not exist; create it first", path.display()));
        }
        if path.is_dir() {
            return Err(miette!("{}: is a folder; give the name of a file", path.display()));
        }
        // Files appear under another name first, in the same folder.
        if let Err(error) = tempfile::tempfile_in(folder) {
            return Err(miette!(
                "{}: nothing can be written in its folder ({error}); choose another",
                path.display()
            ));
        }
    }
    Ok(())
}

/// `--exposure`: more stops than any picture has would only overflow.
pub fn parse_exposure(text: &str) -> Result<f64, String> {
    let stops = text.parse::<f64>().ok().filter(|stops| stops.abs() <= 64.0);
    stops.ok_or("write stops from -64 to 64, such as 1.5".into())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_extension_decides_in_any_case_and_others_are_refused() {
        assert_eq!("a/b.EXR".parse::<Output>().map(|o| o.format), Ok(Format::Exr));
        assert!("a.exr.gz".parse::<Output>().is_err() && "exr".parse::<Output>().is_err());
    }

    #[test]
    fn exposures_are_finite() {
        assert_eq!(parse_exposure("-1.5"), Ok(-1.5));
        assert!(["nan", "inf", "1e30", ""].iter().all(|text| parse_exposure(text).is_err()));
    }
}
