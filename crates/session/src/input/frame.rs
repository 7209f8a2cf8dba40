//! The scene of a frame of an animation: the same but for the number in names of files and in overrides, or one of its own.

use std::path::PathBuf;

use tyndall_scene::SceneDocument;

use super::{Input, InputOptions};
use crate::SessionError;
use crate::frames::{Frames, at_frame, file_at_frame, holds_frame};

/// Where the scene of another frame comes from.
#[derive(Debug, Clone)]
pub(super) enum FrameSource {
    /// The same scene, but for the names of its files.
    Same,
    /// The same document, with other overrides.
    Document(Box<SceneDocument>, InputOptions),
    /// A scene file of its own.
    File(PathBuf, InputOptions),
}

impl Input {
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
                let changed =
                    Self::from_document((**document).clone(), &options, None, self.files.folder.clone())?;
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
        let mut patterns: Vec<PathBuf> = of_scene.map(|file| self.files.folder.join(file)).collect();
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
}
