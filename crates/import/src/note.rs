//! What a user should know about an imported scene: what was left out, and what was decided.

use std::collections::HashSet;
use std::fmt::{self, Display};
use std::path::{Path, PathBuf};

use crate::error::one_line;

/// Something that a user should know about an imported scene.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Note {
    /// The file that it is about.
    pub file: PathBuf,
    /// The line of it, from 1.
    pub line: usize,
    /// Whether the picture suffers.
    pub kind: NoteKind,
    /// What it is, and what is done instead.
    pub message: String,
}

/// Whether what a note tells changes the picture.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum NoteKind {
    /// Something is not supported: the picture differs from the other renderer's.
    Unsupported,
    /// Something was decided, or is said in another way: the picture means the same.
    Choice,
}

impl Display for Note {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}:{}: {}", self.file.display(), self.line, one_line(&self.message))
    }
}

/// Notes while they are gathered: each message is kept once, where it first applied.
#[derive(Debug, Default)]
pub struct Notes {
    notes: Vec<Note>,
    said: HashSet<String>,
}

impl Notes {
    /// Tells of something that is not supported, unless the same was said before.
    pub fn unsupported(&mut self, file: &Path, line: usize, message: impl Into<String>) {
        self.say(NoteKind::Unsupported, file, line, message.into());
    }

    /// Tells of a decision, unless the same was said before.
    pub fn choice(&mut self, file: &Path, line: usize, message: impl Into<String>) {
        self.say(NoteKind::Choice, file, line, message.into());
    }

    fn say(&mut self, kind: NoteKind, file: &Path, line: usize, message: String) {
        if self.said.insert(message.clone()) {
            self.notes.push(Note { file: file.to_path_buf(), line, kind, message });
        }
    }

    /// All of them, in the order in which they were first said.
    pub fn into_vec(self) -> Vec<Note> {
        self.notes
    }
}
