//! A folder for readers that take the name of a file, and inputs that are several files.
//!
//! The input of a reader of scenes is the scene and, where it names others, these: each after a line `%%% name`. So
//! `Include` and damaged files beside a scene are searched too.

use std::fs;
use std::path::PathBuf;

use tempfile::TempDir;

const MARK: &[u8] = b"\n%%% ";

/// A folder that is gone when this is dropped.
pub(crate) struct Folder(TempDir);

impl Folder {
    /// A folder with a single file.
    pub(crate) fn with(name: &str, bytes: &[u8]) -> Self {
        let folder = Self(tempfile::tempdir().expect("a folder can be made"));
        fs::write(folder.path(name), bytes).expect("a file can be written");
        folder
    }

    /// A folder with the scene of an input under `name`, and what files follow it.
    pub(crate) fn of_scene(name: &str, input: &[u8]) -> Self {
        let (scene, mut rest) = split(input);
        let folder = Self::with(name, scene);
        while let Some(part) = rest {
            let end = part.iter().position(|&byte| byte == b'\n').unwrap_or(part.len());
            let (name, content) = part.split_at(end);
            let (content, next) = split(content.get(1..).unwrap_or_default());
            if let Some(name) = plain(name) {
                fs::write(folder.path(name), content).expect("a file can be written");
            }
            rest = next;
        }
        folder
    }

    /// The path of a file in it.
    pub(crate) fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }
}

/// What stands before the next mark and after it.
fn split(bytes: &[u8]) -> (&[u8], Option<&[u8]>) {
    match bytes.windows(MARK.len()).position(|window| window == MARK) {
        Some(at) => (&bytes[..at], Some(&bytes[at + MARK.len()..])),
        None => (bytes, None),
    }
}

/// A name that stays in the folder.
fn plain(name: &[u8]) -> Option<&str> {
    let name = std::str::from_utf8(name).ok()?;
    let is_plain = |c: char| c.is_ascii_alphanumeric() || c == '.' || c == '_';
    (name.len() <= 32 && name.starts_with(|c: char| c.is_ascii_alphanumeric()) && name.chars().all(is_plain))
        .then_some(name)
}
