//! Whatever can be rendered, as a description: the built-in scene, a scene file, one of another renderer, a bare volume with
//! a scene made up for it, or a scene that a program hands over.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use tyndall_scene::{BuiltScene, SceneDescription, SceneDocument, SceneHash, build, scene_hash};

use crate::bare_volume::AutomaticInput;
use crate::foreign::{self, ImportOptions, WrittenFiles};
use crate::frames::{Frames, at_frame, file_at_frame, holds_frame};
use crate::volume_file::{RawVolume, check_input};
use crate::{SessionError, bare_volume};

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
    folder: PathBuf,
    notes: Vec<String>,
    written: Option<Arc<WrittenFiles>>,
    name: String,
    stem: String,
    frames: FrameSource,
}

/// Where the scene of another frame comes from.
#[derive(Debug, Clone)]
enum FrameSource {
    /// The same scene, but for the names of its files.
    Same,
    /// The same document, with other overrides.
    Document(Box<SceneDocument>, InputOptions),
    /// A scene file of its own.
    File(PathBuf, InputOptions),
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
            folder: folder.into(),
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

    /// The scene in a frame of the animation whose first one it was [opened](InputOptions::frame) at: names of its files,
    /// and the overrides, with the frame's number. What was chosen for a bare volume stays as it is.
    ///
    /// # Errors
    /// If a scene file of the frame cannot be read, or the overrides do not fit.
    pub fn at_frame(&self, frame: u32) -> Result<Self, SessionError> {
        let mut input = match &self.frames {
            FrameSource::Same => self.clone(),
            FrameSource::Document(document, options) => {
                let options = InputOptions { frame: Some(frame), ..options.clone() };
                let changed = Self::from_document((**document).clone(), &options, None, self.folder.clone())?;
                Self { description: changed.description, text: None, ..self.clone() }
            }
            FrameSource::File(path, options) => {
                Self::open(path, &InputOptions { frame: Some(frame), ..options.clone() })?
            }
        };
        for file in input.description_mut().files_mut() {
            *file = at_frame(file, frame);
        }
        Ok(input)
    }

    /// Refuses frames of which a file is not there: it is better to hear now than after a night of rendering.
    ///
    /// # Errors
    /// If there is one; or if nothing depends on the frame, so that all would be the same picture.
    pub fn check_frames(&self, frames: &Frames) -> Result<(), SessionError> {
        let mut description = self.description.clone();
        let of_scene = description.files_mut().into_iter().filter(|file| holds_frame(file));
        let mut patterns: Vec<PathBuf> = of_scene.map(|file| self.folder.join(file)).collect();
        if let FrameSource::File(path, _) = &self.frames {
            // Which files these scenes name is not known before they are read.
            patterns = vec![path.clone()];
        }
        if patterns.is_empty() && matches!(self.frames, FrameSource::Same) {
            return Err(SessionError::refuse(
                &self.name,
                "all frames would be the same; write #### for the number of the frame in the name of a file of it",
            ));
        }
        for frame in frames.iter().filter(|_| !patterns.is_empty()) {
            let files = patterns.iter().map(|pattern| file_at_frame(pattern, frame));
            if let Some(missing) = files.into_iter().find(|file| !file.exists()) {
                return Err(SessionError::refuse_file(
                    &missing,
                    format!(
                        "there is no such file, and frame {frame} needs it; mend --frames or the file's name"
                    ),
                ));
            }
        }
        Ok(())
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
        &self.folder
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
        Ok(build(&self.description, &self.folder)?)
    }

    /// The hash of all that decides the expected picture, files included.
    ///
    /// # Errors
    /// If a file that it names cannot be read.
    pub fn scene_hash(&self) -> Result<SceneHash, SessionError> {
        Ok(scene_hash(&self.description, &self.folder)?)
    }
}

fn is_scene(name: &str) -> bool {
    name.rsplit('.').next().is_some_and(|extension| extension.eq_ignore_ascii_case("toml"))
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
