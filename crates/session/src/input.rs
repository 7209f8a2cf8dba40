//! Whatever can be rendered, as a description: the built-in scene, a scene file, one of another renderer, a bare volume with
//! a scene made up for it, or a scene that a program hands over.

mod frame;

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use tyndall_optics::mie::MieCache;
use tyndall_scene::{
    BuiltScene, MemoryGrid, SceneDescription, SceneDocument, SceneFiles, SceneHash, build_with,
    scene_hash_with,
};

use crate::bare_volume::AutomaticInput;
use crate::foreign::{self, ImportOptions, WrittenFiles};
use crate::frames::{at_frame, holds_frame};
use crate::volume_file::{RawVolume, check_input};
use crate::{SessionError, bare_volume};
use frame::FrameSource;

/// A cumulus under sun and sky.
const DEFAULT_SCENE: &str = include_str!("../../../scenes/cloud.toml");

/// How something is opened.
#[derive(Debug, Clone, Default)]
pub struct InputOptions {
    /// Values of the scene to change, of the form `key=value`; see [`SceneDocument::set`].
    pub overrides: Vec<String>,
    /// What a bare `.raw` volume does not say itself.
    pub raw: Option<RawVolume>,
    /// For scenes of other renderers.
    pub import: ImportOptions,
    /// The frame of an animation that is looked at first. `####` in the path and in overrides is then its number, and that
    /// in names of files, which stays, will be that of [any frame](Input::at_frame).
    pub frame: Option<u32>,
}

impl InputOptions {
    /// The overrides in the frame that is looked at.
    fn overrides(&self) -> Vec<String> {
        match self.frame {
            Some(frame) => self.overrides.iter().map(|assignment| at_frame(assignment, frame)).collect(),
            None => self.overrides.clone(),
        }
    }
}

/// A scene to render.
#[derive(Debug, Clone)]
pub struct Input {
    description: SceneDescription,
    /// The scene file with its comments, as long as it says the same as the description.
    text: Option<String>,
    files: SceneFiles,
    notes: Vec<String>,
    written: Option<Arc<WrittenFiles>>,
    name: String,
    stem: String,
    frames: FrameSource,
}

impl Input {
    /// The scene that Tyndall brings along: a cumulus under sun and sky.
    ///
    /// # Errors
    /// If an override does not fit the scene.
    pub fn built_in(overrides: &[String]) -> Result<Self, SessionError> {
        let mut input = Self::from_text("the built-in scene", DEFAULT_SCENE, "", overrides)?;
        input.stem = "cloud".into();
        Ok(input)
    }

    /// Opens a scene file (`.toml`), a scene of another renderer (`.pbrt`, `.xml`), or a volume file, for which a scene is
    /// made up.
    ///
    /// # Errors
    /// If the file cannot be read, is damaged or of no known kind, or if an option does not fit it.
    pub fn open(path: &Path, options: &InputOptions) -> Result<Self, SessionError> {
        let pattern = path.to_str().filter(|name| options.frame.is_some() && holds_frame(name));
        let file = match (pattern, options.frame) {
            (Some(pattern), Some(frame)) => at_frame(pattern, frame).into(),
            _ => path.to_owned(),
        };
        check_input(&file)?;
        let name = path.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default();
        let mut input = Self::open_kind(&file, path, &name, options)?;
        if pattern.is_some() && (is_scene(&name) || foreign::is_foreign(path)) {
            input.frames = FrameSource::File(path.to_owned(), options.clone());
        }
        input.name = path.display().to_string();
        input.stem = stem(&name);
        Ok(input)
    }

    /// Opens `path`; a volume is called `shown` in the scene that is made up for it.
    fn open_kind(
        path: &Path,
        shown: &Path,
        name: &str,
        options: &InputOptions,
    ) -> Result<Self, SessionError> {
        let InputOptions { raw, import, .. } = options;
        if foreign::is_foreign(path) && raw.is_none() {
            return Self::from_foreign(path, options);
        }
        import.refuse(path)?;
        match name.rsplit('.').next().map(str::to_ascii_lowercase).as_deref() {
            Some("toml" | "pbrt" | "xml") if raw.is_some() => Err(SessionError::refuse_file(
                path,
                "--raw-shape is for a .raw file; a scene says it itself, by raw_shape and raw_type in its [[volume]]",
            )),
            Some("toml") => {
                Self::from_document(SceneDocument::read(path)?, options, None, parent_folder(path))
            }
            Some("exr" | "png" | "hdr" | "acc" | "json") => Err(SessionError::refuse_file(
                path,
                "is not a scene or a volume; give a .toml scene, one of pbrt or Mitsuba (.pbrt .xml), or a volume file \
                 (.vdb .nvdb .vol .npy .nii .raw)",
            )),
            _ => Self::from_volume(path, shown, options),
        }
    }

    /// The scene that is the text of a scene file; `name` stands for it in messages, and its file names are relative to
    /// `folder`.
    ///
    /// # Errors
    /// If the text is no sound scene, or an override does not fit it.
    pub fn from_text(
        name: &str,
        text: &str,
        folder: impl Into<PathBuf>,
        overrides: &[String],
    ) -> Result<Self, SessionError> {
        let document = SceneDocument::parse(name, text)?;
        let options = InputOptions { overrides: overrides.to_vec(), ..InputOptions::default() };
        let mut input = Self::from_document(document, &options, Some(text), folder.into())?;
        input.name = name.to_owned();
        Ok(input)
    }

    /// A scene that was put together by a program; as for [`from_text`](Self::from_text). The description is taken as it
    /// is: only that of a [`SceneDocument`] is known to be sound.
    pub fn from_description(name: &str, description: SceneDescription, folder: impl Into<PathBuf>) -> Self {
        Self {
            description,
            text: None,
            files: SceneFiles { folder: folder.into(), grids: BTreeMap::new() },
            notes: Vec::new(),
            written: None,
            name: name.to_owned(),
            stem: "picture".into(),
            frames: FrameSource::Same,
        }
    }

    fn from_document(
        document: SceneDocument,
        options: &InputOptions,
        text: Option<&str>,
        folder: PathBuf,
    ) -> Result<Self, SessionError> {
        let mut changed = document.clone();
        for assignment in options.overrides() {
            changed.set(&assignment)?;
        }
        let mut input = Self::from_description("", changed.description()?, folder);
        // Comments survive as long as nothing is changed.
        input.text = text.filter(|_| options.overrides.is_empty()).map(str::to_owned);
        if options.frame.is_some() && options.overrides.iter().any(|assignment| holds_frame(assignment)) {
            input.frames = FrameSource::Document(Box::new(document), options.clone());
        }
        Ok(input)
    }

    /// The scene of another renderer; file names of `overrides` are relative to it.
    fn from_foreign(path: &Path, options: &InputOptions) -> Result<Self, SessionError> {
        let (imported, written) = foreign::import(path, &options.import)?;
        let name = format!("{} as a scene of Tyndall", path.display());
        let document = SceneDocument::parse(&name, &imported.description.to_toml())?;
        let mut input = Self::from_document(document, options, None, parent_folder(path))?;
        input.notes = imported.notes.iter().map(ToString::to_string).collect();
        input.written = Some(Arc::new(written));
        Ok(input)
    }

    /// The scene of a bare volume, made up from its data.
    fn from_volume(path: &Path, shown: &Path, options: &InputOptions) -> Result<Self, SessionError> {
        let AutomaticInput { text, notes } = bare_volume::make_up(path, shown, options.raw)?;
        let document = SceneDocument::parse("the scene made up for the volume", &text)?;
        let mut input = Self::from_document(document, options, Some(&text), PathBuf::new())?;
        input.notes = notes;
        Ok(input)
    }

    /// The scene of a bare grid in memory, made up from its data; `name` stands for its file.
    ///
    /// # Errors
    /// If the grid has nothing to be seen.
    pub fn from_grid(name: &str, grid: MemoryGrid) -> Result<Self, SessionError> {
        let AutomaticInput { text, notes } = bare_volume::make_up_of_grid(name, &grid)?;
        let mut input = Self::from_text("the scene made up for the volume", &text, "", &[])?;
        input.notes = notes;
        input.name = name.to_owned();
        Ok(input.with_grids(BTreeMap::from([(name.to_owned(), grid)])))
    }

    /// The scene, with all overrides applied.
    pub fn description(&self) -> &SceneDescription {
        &self.description
    }

    /// The scene, to be changed.
    pub fn description_mut(&mut self) -> &mut SceneDescription {
        self.text = None;
        &mut self.description
    }

    /// It as a scene file.
    pub fn to_toml(&self) -> String {
        self.text.clone().unwrap_or_else(|| self.description.to_toml())
    }

    /// What its file names are relative to.
    pub fn folder(&self) -> &Path {
        &self.files.folder
    }

    /// The same, with grids in memory that stand for files of these names.
    pub fn with_grids(mut self, grids: BTreeMap<String, MemoryGrid>) -> Self {
        self.files.grids = grids;
        self
    }

    /// What was guessed, and what is not as in the renderer that the scene is for.
    pub fn notes(&self) -> &[String] {
        &self.notes
    }

    /// Files that the scene of another renderer has written out, and which its description names.
    pub fn written(&self) -> Option<&WrittenFiles> {
        self.written.as_deref()
    }

    /// What it is called in messages.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// A name for what is made of it: that of its file, up to the first dot.
    pub fn stem(&self) -> &str {
        &self.stem
    }

    /// The scene ready to trace.
    ///
    /// # Errors
    /// If a file that it names cannot be read or used.
    pub fn build(&self) -> Result<BuiltScene, SessionError> {
        Ok(build_with(&self.description, &self.files, &MieCache::from_environment())?)
    }

    /// The scene ready to trace with its hash, for as many [jobs](crate::Job) as are wanted.
    ///
    /// # Errors
    /// If a file that it names cannot be read or used.
    pub fn ready(&self) -> Result<ReadyScene, SessionError> {
        Ok(ReadyScene { built: self.build()?, hash: self.scene_hash()? })
    }

    /// The hash of all that decides the expected picture, files included.
    ///
    /// # Errors
    /// If a file that it names cannot be read.
    pub fn scene_hash(&self) -> Result<SceneHash, SessionError> {
        Ok(scene_hash_with(&self.description, &self.files)?)
    }
}

fn is_scene(name: &str) -> bool {
    name.rsplit('.').next().is_some_and(|extension| extension.eq_ignore_ascii_case("toml"))
}

/// A scene ready to trace, and which it is.
#[derive(Debug, Clone)]
pub struct ReadyScene {
    /// The scene.
    pub built: BuiltScene,
    /// Its hash.
    pub hash: SceneHash,
}

fn parent_folder(path: &Path) -> PathBuf {
    path.parent().unwrap_or(Path::new("")).to_owned()
}

fn stem(name: &str) -> String {
    name.split('.').next().filter(|stem| !stem.is_empty()).unwrap_or("picture").to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn comments_are_kept_until_something_is_changed() {
        let comment = |input: &Input| input.to_toml().lines().any(|line| line.starts_with('#'));
        let mut input = Input::built_in(&[]).unwrap();
        assert!(comment(&input));
        let changed = Input::built_in(&["render.spp=3".into()]).unwrap();
        assert!(!comment(&changed) && changed.description().render.spp == 3);
        input.description_mut().render.spp = 5;
        assert!(input.to_toml().contains("spp = 5"));
    }

    #[test]
    fn the_stem_is_the_name_up_to_its_first_dot() {
        assert_eq!([stem("a.nii.gz"), stem("a"), stem(".vdb")], ["a", "a", "picture"]);
    }
}
