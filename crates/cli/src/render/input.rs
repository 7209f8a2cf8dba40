//! What is to be rendered: the built-in scene, a scene file, or a bare volume with a scene made up for it.

use std::path::{Path, PathBuf};

use miette::miette;
use tyndall_scene::{SceneDescription, SceneDocument};

use crate::output::Output;

/// A scene to render.
pub struct Input {
    /// The scene, with all overrides applied.
    pub description: SceneDescription,
    /// It as a scene file.
    pub text: String,
    /// What its file names are relative to.
    pub folder: PathBuf,
    /// What was guessed.
    pub notes: Vec<String>,
    /// Name for output files.
    stem: String,
}

/// A cumulus under sun and sky.
const DEFAULT_SCENE: &str = include_str!("../../../../scenes/cloud.toml");

impl Input {
    /// A picture to work with and one to look at, in the working folder.
    pub fn default_outputs(&self) -> Vec<Output> {
        [".exr", ".png"].iter().filter_map(|extension| format!("{}{extension}", self.stem).parse().ok()).collect()
    }
}

/// Loads `path`, or the built-in scene, and applies `overrides` of the form `key=value`.
pub fn load(path: Option<&Path>, overrides: &[String]) -> miette::Result<Input> {
    let Some(path) = path else {
        let document = SceneDocument::parse("the built-in scene", DEFAULT_SCENE)?;
        return from_document(document, overrides, Some(DEFAULT_SCENE), PathBuf::new(), "cloud".into());
    };
    let name = path.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default();
    let stem = name.split('.').next().filter(|stem| !stem.is_empty()).unwrap_or("picture").to_owned();
    match name.rsplit('.').next().map(str::to_ascii_lowercase).as_deref() {
        Some("toml") => {
            let folder = path.parent().unwrap_or(Path::new("")).to_owned();
            from_document(SceneDocument::read(path)?, overrides, None, folder, stem)
        }
        Some("pbrt" | "xml") => Err(miette!(
            "{}: scene files of other renderers are not read yet; give a .toml scene or a volume file",
            path.display()
        )),
        Some("exr" | "png" | "hdr" | "acc" | "json") => Err(miette!(
            "{}: is not a scene or a volume; give a .toml scene or a volume file (.vdb .nvdb .vol .npy .nii .raw)",
            path.display()
        )),
        _ => from_volume(path, overrides, stem),
    }
}

fn from_document(
    mut document: SceneDocument,
    overrides: &[String],
    text: Option<&str>,
    folder: PathBuf,
    stem: String,
) -> miette::Result<Input> {
    for assignment in overrides {
        document.set(assignment)?;
    }
    let description = document.description()?;
    // Comments survive as long as nothing is changed.
    let text = text.filter(|_| overrides.is_empty()).map_or_else(|| description.to_toml(), str::to_owned);
    Ok(Input { description, text, folder, notes: Vec::new(), stem })
}
