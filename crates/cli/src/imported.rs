//! Scenes of other renderers as Tyndall's own, with what they write out themselves in files of a folder.

use std::path::{Path, PathBuf};

use miette::{IntoDiagnostic, WrapErr, miette};
use tempfile::TempDir;
use tyndall_import::{Imported, Note, NoteKind, Sidecar, import_mitsuba, import_pbrt};

/// Options for scenes of other renderers
#[derive(Debug, Clone, Default, clap::Args)]
pub struct ImportArgs {
    /// Refuse a .pbrt or .xml scene of which something is not supported
    #[arg(long)]
    strict: bool,
    /// What `$NAME` stands for in a Mitsuba scene; may be given several times
    #[arg(short = 'D', long, value_name = "NAME=VALUE", value_parser = parse_define)]
    define: Vec<(String, String)>,
}

impl ImportArgs {
    /// Refuses the options for `path`, which is no scene of another renderer.
    pub fn refuse(&self, path: &Path) -> miette::Result<()> {
        let option = if self.strict { "--strict" } else { "--define" };
        if self.strict || !self.define.is_empty() {
            return Err(miette!(
                "{}: {option} is for scenes of other renderers (.pbrt .xml); leave it out",
                path.display()
            ));
        }
        Ok(())
    }
}

/// Which renderer a scene is for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Dialect {
    Pbrt,
    Mitsuba,
}

fn dialect(path: &Path) -> Option<Dialect> {
    let name = path.file_name()?.to_string_lossy().to_ascii_lowercase();
    match name.strip_suffix(".gz").unwrap_or(&name).rsplit_once('.')?.1 {
        "pbrt" => Some(Dialect::Pbrt),
        "xml" if !name.ends_with(".gz") => Some(Dialect::Mitsuba),
        _ => None,
    }
}

/// Whether a file is a scene of another renderer, by its name.
pub fn is_foreign(path: &Path) -> bool {
    dialect(path).is_some()
}

/// A scene of another renderer, and a folder with the files that it wrote out; the folder goes when this is dropped.
pub struct Foreign {
    /// The scene and what is to be known of it.
    pub imported: Imported,
    /// Its files.
    pub files: WrittenFiles,
}

/// Files that last as long as this.
pub struct WrittenFiles(TempDir);

impl WrittenFiles {
    /// The files, in the order of their names.
    pub fn paths(&self) -> Vec<PathBuf> {
        let entries = std::fs::read_dir(self.0.path()).into_iter().flatten();
        let mut paths: Vec<PathBuf> = entries.filter_map(|entry| Some(entry.ok()?.path())).collect();
        paths.sort();
        paths
    }
}

/// Imports the scene at `path`.
///
/// # Errors
/// If it cannot be read, or if something of it is not supported and the options are strict.
pub fn import(path: &Path, args: &ImportArgs) -> miette::Result<Foreign> {
    let folder = tempfile::Builder::new().prefix("tyndall-").tempdir();
    let folder = folder.into_diagnostic().wrap_err("no temporary folder can be made")?;
    let sidecar = Sidecar::new(folder.path());
    let imported = match dialect(path) {
        Some(Dialect::Mitsuba) => import_mitsuba(path, &sidecar, &args.define),
        _ if !args.define.is_empty() => {
            return Err(miette!("{}: --define is for Mitsuba scenes (.xml); leave it out", path.display()));
        }
        _ => import_pbrt(path, &sidecar),
    };
    let imported = imported.map_err(|error| miette!("{error}"))?;
    if args.strict {
        refuse_unsupported(&imported.notes)?;
    }
    Ok(Foreign { imported, files: WrittenFiles(folder) })
}

/// All that is not supported of a scene, one line each.
#[derive(Debug, thiserror::Error, miette::Diagnostic)]
#[error("{}", .0.join("; "))]
pub struct Unsupported(pub Vec<String>);

fn refuse_unsupported(notes: &[Note]) -> Result<(), Unsupported> {
    let is_unsupported = |note: &&Note| note.kind == NoteKind::Unsupported;
    let lines: Vec<String> =
        notes.iter().filter(is_unsupported).map(|note| format!("{note} (--strict)")).collect();
    if lines.is_empty() { Ok(()) } else { Err(Unsupported(lines)) }
}

fn parse_define(text: &str) -> Result<(String, String), String> {
    let pair = text.split_once('=').filter(|(name, _)| !name.is_empty());
    pair.map(|(name, value)| (name.to_owned(), value.to_owned())).ok_or("write NAME=VALUE".into())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn scenes_are_told_by_their_names() {
        for (name, expected) in [
            ("a.pbrt", Some(Dialect::Pbrt)),
            ("a/b.PBRT.gz", Some(Dialect::Pbrt)),
            ("a.v2.XML", Some(Dialect::Mitsuba)),
            ("a.xml.gz", None),
            ("a.nii.gz", None),
            ("a.toml", None),
            ("pbrt", None),
        ] {
            assert_eq!(dialect(Path::new(name)), expected, "{name}");
        }
    }

    #[test]
    fn a_definition_is_a_name_and_a_value_that_may_be_empty() {
        assert_eq!(parse_define("spp=4=4"), Ok(("spp".into(), "4=4".into())));
        assert_eq!(parse_define("spp="), Ok(("spp".into(), String::new())));
        assert!(parse_define("=4").is_err() && parse_define("spp").is_err());
    }
}
