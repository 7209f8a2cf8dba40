//! Scenes: Tyndall's own, those of other renderers, and what options say of them.

use tyndall_import::{ImportError, Imported, Sidecar, import_mitsuba, import_pbrt};
use tyndall_optics::mie::MieCache;
use tyndall_scene::description::{LightDescription, PhaseDescription, phase_spec};
use tyndall_scene::{SceneDescription, SceneDocument, SceneFiles, build_with};

use crate::folder::Folder;
use crate::{Outcome, assert_message};

/// Scene files in TOML, with the files that they name; built, if that is a matter of the files alone.
pub(crate) fn toml(bytes: &[u8]) -> Outcome {
    let folder = Folder::of_scene("scene.toml", bytes);
    let read = SceneDocument::read(&folder.path("scene.toml")).and_then(|document| document.description());
    match read {
        Ok(description) => {
            reads_back(&description);
            if is_quickly_built(&description) {
                let files = SceneFiles::in_folder(&folder.path(""));
                if let Err(error) = build_with(&description, &files, &MieCache::none()) {
                    Outcome::refused(&error);
                }
            }
            Outcome::Read(0)
        }
        Err(error) => Outcome::refused(&error),
    }
}

/// Options that change a scene: each line is one of `--set`.
pub(crate) fn option(bytes: &[u8]) -> Outcome {
    const SCENE: &str = "camera = { position = [0, 0, 5], target = [0, 0, 0] }\n\
        volume = [{ sphere = { center = [0, 0, 0], radius = 1 }, mu_t = 1, albedo = 0.5 }]\n\
        light = [{ type = 'constant', radiance = 1 }]\n";
    let mut document = SceneDocument::parse("scene.toml", SCENE).expect("the scene is sound");
    for line in String::from_utf8_lossy(bytes).lines() {
        if let Err(error) = document.set(line) {
            return Outcome::refused(&error);
        }
    }
    match document.description() {
        Ok(description) => {
            reads_back(&description);
            Outcome::Read(0)
        }
        Err(error) => Outcome::refused(&error),
    }
}

/// Phase functions in one line.
pub(crate) fn phase_spec(bytes: &[u8]) -> Outcome {
    match phase_spec::parse(&String::from_utf8_lossy(bytes)) {
        Ok(_) => Outcome::Read(0),
        Err(error) => Outcome::refused(&error),
    }
}

/// Scenes of pbrt-v4, with the files that they name; without clouds, which are computed, not read.
pub(crate) fn pbrt(bytes: &[u8]) -> Outcome {
    if bytes.windows(7).any(|word| word == b"\"cloud\"") {
        return Outcome::Refused;
    }
    let folder = Folder::of_scene("scene.pbrt", bytes);
    imported(import_pbrt(&folder.path("scene.pbrt"), &Sidecar::new(folder.path("sidecar"))))
}

/// Scenes of Mitsuba 3, with the files that they name.
pub(crate) fn mitsuba(bytes: &[u8]) -> Outcome {
    let folder = Folder::of_scene("scene.xml", bytes);
    let defined = [("spp".to_owned(), "8".to_owned())];
    imported(import_mitsuba(&folder.path("scene.xml"), &Sidecar::new(folder.path("sidecar")), &defined))
}

fn imported(imported: Result<Imported, ImportError>) -> Outcome {
    match imported {
        Ok(Imported { description, notes }) => {
            notes.iter().for_each(|note| assert_message(&note.to_string()));
            reads_back(&description);
            Outcome::Read(0)
        }
        Err(error) => Outcome::refused(&error),
    }
}

/// A description is sound and the same when it is read from its own scene file.
fn reads_back(description: &SceneDescription) {
    assert_eq!(description.violations(), []);
    let text = description.to_toml();
    let read = SceneDocument::parse("written.toml", &text).and_then(|document| document.description());
    let read = read.unwrap_or_else(|error| panic!("{error}\n{text}"));
    assert!(read == *description, "reads back as another scene:\n{text}");
}

/// Whether building is a matter of the files: no sky, no droplets and no cumulus to compute.
fn is_quickly_built(description: &SceneDescription) -> bool {
    let computed = description.media().any(|medium| {
        medium.particles.is_some() || matches!(medium.phase, Some(PhaseDescription::Mie { .. }))
    });
    let grown = description.volumes.iter().any(|volume| volume.procedural.is_some());
    let sky = description.lights.iter().any(|light| matches!(light, LightDescription::Sky(_)));
    !computed && !grown && !sky
}
