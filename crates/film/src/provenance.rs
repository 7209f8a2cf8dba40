//! What a written picture says about its making: enough to tell whether it has to be rendered (again).

use std::path::Path;

use exr::prelude::{AttributeValue, MetaData};
use serde::Deserialize;
use tyndall_machine::files;

use crate::accumulation_file::read_provenance;
use crate::comparison::Picture;
use crate::error::FileError;
use crate::ranges::{RangeError, SampleRanges};

/// How the samples of a written picture were made, and which they are.
#[derive(Debug, Clone, PartialEq, Eq, Deserialize)]
pub struct Provenance {
    /// Hash of the scene and of all files that it names.
    pub scene_hash: String,
    /// Version of the program.
    pub version: String,
    /// The options that decide which samples are drawn.
    pub options: String,
    /// Seed of the random numbers.
    pub seed: u64,
    /// Samples that every pixel holds.
    pub samples: SampleRanges,
    /// The first sample of a pass that was interrupted, if the file is an `.acc` and tells.
    #[serde(skip)]
    pub open: Option<u64>,
}

impl Provenance {
    /// Adds the samples of `other`, if it is of the same scene and made in the same way. The paths only serve to name both
    /// in an error; nothing changes on error.
    ///
    /// # Errors
    /// If scene, version, options or seed differ, a pass was interrupted, or both hold the same samples.
    pub fn join(&mut self, path: &Path, other: &Self, other_path: &Path) -> Result<(), FileError> {
        let refuse = |what: String| {
            FileError::unusable(other_path, format!("cannot be merged with {}: {what}", path.display()))
        };
        for (name, a, b) in [
            ("scene", &self.scene_hash, &other.scene_hash),
            ("version of tyndall", &self.version, &other.version),
            ("options", &self.options, &other.options),
            ("seed", &self.seed.to_string(), &other.seed.to_string()),
        ] {
            if a != b {
                return Err(refuse(format!(
                    "another {name} (`{b}`, not `{a}`); only renders of one scene with the same seed and options add up"
                )));
            }
        }
        for (path, open) in [(path, self.open), (other_path, other.open)] {
            if let Some(start) = open {
                return Err(FileError::unusable(
                    path,
                    format!(
                        "was interrupted in the pass that begins at sample {start}; resume it to its end first"
                    ),
                ));
            }
        }
        self.samples.insert_all(&other.samples).map_err(|error| match error {
            RangeError::Overlap(common) => {
                refuse(format!("both hold samples {}..{}; leave one of them out", common.start, common.end))
            }
            error => refuse(error.to_string()),
        })
    }

    /// That of an `.acc` file, which is read as a whole to know that it is undamaged, but not kept in memory.
    ///
    /// # Errors
    /// If the file cannot be read, is damaged or is no `.acc` file.
    pub fn of_accumulation(path: &Path) -> Result<Self, FileError> {
        read_provenance(path)
    }

    /// That of an `.exr` file, whose pixels are read as well to know that they are there.
    ///
    /// # Errors
    /// If the file cannot be read, is damaged or does not say.
    pub fn of_exr(path: &Path) -> Result<Self, FileError> {
        Picture::read(path)?;
        let header =
            MetaData::read_from_file(path, false).ok().and_then(|meta| meta.headers.into_iter().next());
        let attributes = header.map(|header| header.own_attributes).unwrap_or_default();
        let text = |name: &str| {
            attributes.other.iter().find_map(|(key, value)| match value {
                AttributeValue::Text(value) if *key == *name => Some(value.to_string()),
                _ => None,
            })
        };
        let provenance = || {
            Some(Self {
                scene_hash: text("sceneHash")?,
                version: attributes.software_name.as_ref()?.to_string().strip_prefix("Tyndall ")?.to_owned(),
                options: text("options")?,
                seed: text("seed")?.parse().ok()?,
                samples: text("samples")?.parse().ok()?,
                open: None,
            })
        };
        provenance().ok_or_else(|| FileError::unusable(path, "does not say how Tyndall made it"))
    }

    /// That of a `.json` summary.
    ///
    /// # Errors
    /// If the file cannot be read, or is none.
    pub fn of_summary(path: &Path) -> Result<Self, FileError> {
        let text = files::read(path).map_err(|error| FileError::io(path, error))?;
        serde_json::from_slice(&text)
            .map_err(|error| FileError::unusable(path, format!("is no summary of a picture: {error}")))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::accumulation_file::Accumulation;
    use crate::film::{Film, FilmTile};
    use crate::metadata::ImageMetadata;
    use crate::sample::Layers;
    use crate::{Summary, write_exr};

    fn picture() -> Accumulation {
        let mut film = Film::new(5, 4, Layers::NONE).unwrap();
        film.open_range(3).unwrap();
        let mut tile = FilmTile::new(film.tile_rect(0), 3..5, film.layers());
        (0..20).for_each(|pixel| tile.add(pixel % 5, pixel / 5, &Default::default()));
        film.merge_tile(&tile);
        film.complete_through(5).unwrap();
        let metadata = ImageMetadata {
            scene_hash: "12ab".into(),
            version: "0.1.0".into(),
            options: "integrator=fast".into(),
            seed: 7,
            ..ImageMetadata::default()
        };
        Accumulation { film, metadata }
    }

    #[test]
    fn every_kind_of_file_says_the_same_and_one_cut_short_nothing() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("picture");
        let Accumulation { film, metadata } = &picture();
        let expected = Provenance {
            scene_hash: "12ab".into(),
            version: "0.1.0".into(),
            options: "integrator=fast".into(),
            seed: 7,
            samples: "3..5".parse().unwrap(),
            open: None,
        };
        type Of = fn(&Path) -> Result<Provenance, FileError>;
        let write: [(&dyn Fn(), Of); 3] = [
            (&|| picture().write(&path).unwrap(), Provenance::of_accumulation),
            (&|| write_exr(&path, film, metadata).unwrap(), Provenance::of_exr),
            (&|| Summary::new(film, metadata).write_json(&path).unwrap(), Provenance::of_summary),
        ];
        for (write, provenance_of) in write {
            write();
            assert_eq!(provenance_of(&path).unwrap(), expected);
            let whole = std::fs::read(&path).unwrap();
            for length in [0, 10, whole.len() / 2, whole.len() - 1] {
                std::fs::write(&path, &whole[..length]).unwrap();
                let error = provenance_of(&path).unwrap_err().to_string();
                assert!(error.contains("picture: ") && !error.contains('\n'), "{error}");
            }
        }
    }

    #[test]
    fn an_open_pass_is_told() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.acc");
        let mut picture = picture();
        picture.film.open_range(5).unwrap();
        picture.write(&path).unwrap();
        assert_eq!(Provenance::of_accumulation(&path).unwrap().open, Some(5));
    }
}
