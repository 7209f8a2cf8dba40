//! `tyndall convert scene.pbrt scene.toml`: a scene of another renderer as a scene file, with its files beside it.
//!
//! Meshes and grids that the scene writes out itself go to the folder `scene_files`; what is in files already stays where
//! it is. The scene file names all of them relative to itself, so that it may move together with them.

use std::collections::HashMap;
use std::ffi::OsString;
use std::io::Write as _;
use std::path::{Path, PathBuf};

use miette::{IntoDiagnostic, miette};
use tyndall_session::{WrittenFiles, check_writable};

use crate::input_args::{ImportArgs, RawArgs, open};
use crate::terminal::{answer, tell};

/// Imports, writes, and says what was written.
pub fn convert(input: &Path, output: &Path, args: &ImportArgs) -> miette::Result<()> {
    check_writable([output])?;
    let scene = open(Some(input), &[], &RawArgs::default(), args)?;
    scene.notes().iter().for_each(|note| tell(format!("note: {note}")));
    let folder = output.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let beside = files_folder(output);
    let kept = scene.written().map_or(Ok(HashMap::new()), |written| keep(written, &folder.join(&beside)))?;

    let folder = absolute(folder)?;
    let mut description = scene.description().clone();
    for file in description.files_mut() {
        let path = scene.folder().join(&*file);
        *file = match kept.get(&path) {
            Some(name) => in_scene(&beside.join(name)),
            None => in_scene(&relative(&absolute(&path)?, &folder)),
        };
    }
    let text = description.to_toml();
    tyndall_film::write_atomically(output, |file| file.write_all(text.as_bytes())).into_diagnostic()?;
    let files = match kept.len() {
        0 => String::new(),
        1 => format!(" and 1 file in {}", beside.display()),
        count => format!(" and {count} files in {}", beside.display()),
    };
    answer(format!("wrote {}{files}\n", output.display()))
}

/// `scene_files` for `scene.toml`.
fn files_folder(output: &Path) -> PathBuf {
    let mut name = output.file_stem().unwrap_or_default().to_owned();
    name.push("_files");
    name.into()
}

/// Copies files into a folder; gives the name of each there.
fn keep(written: &WrittenFiles, folder: &Path) -> miette::Result<HashMap<PathBuf, OsString>> {
    let named = |path: PathBuf| Some((path.clone(), path.file_name()?.to_owned()));
    let kept: HashMap<PathBuf, OsString> = written.paths().into_iter().filter_map(named).collect();
    if kept.is_empty() {
        return Ok(kept);
    }
    let unwritable = |error: std::io::Error| miette!("{}: cannot be written: {error}", folder.display());
    std::fs::create_dir_all(folder).map_err(unwritable)?;
    for entry in std::fs::read_dir(folder).map_err(unwritable)? {
        let name = entry.map_err(unwritable)?.file_name();
        if !kept.values().any(|own| *own == name) {
            return Err(miette!(
                "{}: holds `{}`, which is not of this scene; empty the folder, or give the .toml another name",
                folder.display(),
                name.display()
            ));
        }
    }
    for (path, name) in &kept {
        std::fs::copy(path, folder.join(name)).map_err(unwritable)?;
    }
    Ok(kept)
}

fn absolute(path: &Path) -> miette::Result<PathBuf> {
    path.canonicalize().map_err(|error| miette!("{}: cannot be found: {error}", path.display()))
}

/// The way from an absolute folder to an absolute path.
fn relative(path: &Path, folder: &Path) -> PathBuf {
    let common = path.components().zip(folder.components()).take_while(|(a, b)| a == b).count();
    if common == 0 {
        // Another drive.
        return path.to_owned();
    }
    let up = folder.components().skip(common).map(|_| Path::new("..").as_os_str());
    let down = path.components().skip(common).map(|part| part.as_os_str());
    up.chain(down).collect()
}

/// With slashes, which every system reads.
fn in_scene(path: &Path) -> String {
    let text = path.display().to_string();
    if cfg!(windows) { text.replace('\\', "/") } else { text }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ways_go_up_to_what_is_common() {
        let way = |path: &str| relative(Path::new(path), Path::new("/home/a/scenes"));
        assert_eq!(way("/home/a/scenes/x.vdb"), Path::new("x.vdb"));
        assert_eq!(way("/home/a/volumes/x.vdb"), Path::new("../volumes/x.vdb"));
        assert_eq!(way("/data/x.vdb"), Path::new("../../../data/x.vdb"));
    }

    #[test]
    fn files_go_beside_the_scene() {
        assert_eq!(files_folder(Path::new("a/scene.v2.toml")), Path::new("scene.v2_files"));
    }
}
