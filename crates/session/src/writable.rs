//! Refusals before rendering: it is better to hear now than after an hour that a file cannot be written.

use std::path::{Path, PathBuf};

use tyndall_machine::remove_leftovers;

use crate::{Input, SessionError};

/// Refuses files that cannot be made. What killed runs have left of writing them is cleared away.
///
/// # Errors
/// If there is one, or one is given twice.
pub fn check_writable<'a>(paths: impl IntoIterator<Item = &'a Path>) -> Result<(), SessionError> {
    let mut places: Vec<PathBuf> = Vec::new();
    for path in paths {
        check_one(path)?;
        let place = place(path);
        if places.contains(&place) {
            return Err(SessionError::refuse_file(path, "is to be written twice; give each file once"));
        }
        places.push(place);
        remove_leftovers(path);
    }
    Ok(())
}

fn check_one(path: &Path) -> Result<(), SessionError> {
    let folder = folder_of(path);
    if !folder.is_dir() {
        return Err(SessionError::refuse_file(path, "its folder does not exist; create it first"));
    }
    if let Ok(metadata) = path.metadata() {
        let refuse = |why| Err(SessionError::refuse_file(path, why));
        if metadata.is_dir() {
            return refuse("is a folder; give the name of a file");
        }
        if !metadata.is_file() {
            return refuse("is a pipe or a device; give the name of a file");
        }
        // It would be replaced all the same, as its folder decides about that; but somebody did not want this.
        if metadata.permissions().readonly() {
            return refuse("is there and read-only; make it writable, or give another name");
        }
    }
    // Files appear under another name first, in the same folder.
    tempfile::tempfile_in(folder).map(drop).map_err(|error| {
        SessionError::refuse_file(
            path,
            format!("nothing can be written in its folder ({error}); choose another"),
        )
    })
}

/// Refuses files that the scene is made of: they would be replaced by pictures of them.
///
/// # Errors
/// If there is one.
pub fn check_no_input<'a>(
    outputs: impl IntoIterator<Item = &'a Path>,
    input: &Input,
) -> Result<(), SessionError> {
    let mut description = input.description().clone();
    let files = description.files_mut().into_iter().map(|file| input.folder().join(file.as_str()));
    let inputs: Vec<PathBuf> = files.chain([PathBuf::from(input.name())]).map(|file| place(&file)).collect();
    check_none_of(outputs, &inputs)
}

/// Refuses to write to `input`.
///
/// # Errors
/// If both are one file.
pub fn check_not_same(output: &Path, input: &Path) -> Result<(), SessionError> {
    check_none_of([output], &[place(input)])
}

fn check_none_of<'a>(
    outputs: impl IntoIterator<Item = &'a Path>,
    inputs: &[PathBuf],
) -> Result<(), SessionError> {
    match outputs.into_iter().find(|output| inputs.contains(&place(output))) {
        Some(output) => Err(SessionError::refuse_file(
            output,
            "is read as well, and would be replaced; give another name",
        )),
        None => Ok(()),
    }
}

/// Where a file is, by which two names of it can be told to be one.
fn place(path: &Path) -> PathBuf {
    path.canonicalize().unwrap_or_else(|_| {
        let folder = folder_of(path).canonicalize().unwrap_or_else(|_| folder_of(path).to_owned());
        folder.join(path.file_name().unwrap_or_default())
    })
}

fn folder_of(path: &Path) -> &Path {
    path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."))
}
