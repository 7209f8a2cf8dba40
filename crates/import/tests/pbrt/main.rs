//! What scenes in pbrt's words become. Every scene also reads back identically from its own scene file.

mod bench;
mod damage;
mod errors;
mod grids;
mod lights;
mod media;
mod surfaces;
mod views;

use std::fs;
use std::path::Path;

use tempfile::TempDir;
use tyndall_import::{ImportError, Imported, NoteKind, Sidecar, import_pbrt};
use tyndall_scene::SceneDocument;

/// A scene in a folder of its own.
struct Scene {
    folder: TempDir,
    imported: Imported,
}

/// The scene of a text, with further files beside it.
fn scene_with(text: &str, files: &[(&str, &[u8])]) -> Scene {
    let folder = tempfile::tempdir().expect("a folder can be made");
    for (name, content) in files {
        fs::write(folder.path().join(name), content).expect("the folder can be written");
    }
    let imported = import(text, folder.path()).unwrap_or_else(|error| panic!("{error}"));
    check(&imported);
    Scene { folder, imported }
}

fn scene(text: &str) -> Scene {
    scene_with(text, &[])
}

/// A scene of which only the world matters.
fn world(text: &str) -> Scene {
    scene(&format!(
        "Integrator \"volpath\" \"integer maxdepth\" 7\nPixelFilter \"box\"\nCamera \"perspective\"\nWorldBegin\n{text}"
    ))
}

fn import(text: &str, folder: &Path) -> Result<Imported, ImportError> {
    let path = folder.join("scene.pbrt");
    fs::write(&path, text).expect("the folder can be written");
    import_pbrt(&path, &Sidecar::new(folder.join("sidecar")))
}

/// A description is sound and reads back identically.
fn check(imported: &Imported) {
    assert_eq!(imported.description.violations(), []);
    let text = imported.description.to_toml();
    let read = SceneDocument::parse("imported", &text).and_then(|document| document.description());
    assert_eq!(read.unwrap_or_else(|error| panic!("{error}\n{text}")), imported.description, "{text}");
}

impl Scene {
    /// The messages of a kind, each with its line.
    fn notes(&self, kind: NoteKind) -> Vec<String> {
        let notes = self.imported.notes.iter().filter(|note| note.kind == kind);
        notes.map(|note| format!("{}: {}", note.line, note.message)).collect()
    }

    /// Whether nothing was left out.
    fn is_whole(&self) -> bool {
        self.notes(NoteKind::Unsupported).is_empty()
    }

    fn path(&self, name: &str) -> String {
        self.folder.path().join(name).to_str().expect("the folder has a plain name").to_owned()
    }
}
