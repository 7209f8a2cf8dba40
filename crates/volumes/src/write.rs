//! Writing grids to a file whose extension says the format.
//!
//! The file is written under another name in the same folder and renamed when it is whole: a reader never sees half
//! a file, and a failure leaves what was there before.

use std::fs::{self, File};
use std::io::{BufWriter, Write};
use std::path::{Path, PathBuf};

use flate2::Compression;
use flate2::write::GzEncoder;

use crate::fault::Fault;
use crate::{Format, Grid, nifti, npy, nvdb, raw, vol};

/// Why a volume file cannot be written, as one line a user can act on.
#[derive(Debug, thiserror::Error)]
pub enum WriteError {
    /// The operating system refused.
    #[error("{}: {source}", path.display())]
    Io {
        /// The file.
        path: PathBuf,
        /// What the system said.
        source: std::io::Error,
    },
    /// The format cannot hold this.
    #[error("{}: {what}", path.display())]
    Unsupported {
        /// The file.
        path: PathBuf,
        /// What it cannot hold, and what the user can do instead.
        what: String,
    },
}

/// How the values in a file are compressed, where the format leaves a choice.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum Codec {
    /// Not at all.
    None,
    /// Deflate.
    #[default]
    Zip,
    /// LZ4 of shuffled bytes: larger, faster.
    Blosc,
}

/// Writes `grids` in the format of the extension of `path`; returns the path written, which for `.raw` is given the
/// shape if it lacks it.
///
/// OpenVDB and NanoVDB files hold all the grids as they are; the others hold the box around the active voxels of one,
/// as 32-bit floats, and forget which voxels are active.
///
/// # Errors
/// If the file cannot be written, or the format cannot hold these grids.
pub fn write(path: &Path, grids: &[Grid], codec: Codec) -> Result<PathBuf, WriteError> {
    let (path_written, result) = match Format::from_extension(path) {
        Some(Format::Raw) => match only(grids).and_then(|grid| raw::name_with_shape(path, grid)) {
            Ok(named) => (named, Ok(Format::Raw)),
            Err(fault) => (path.to_path_buf(), Err(fault)),
        },
        Some(format) => (path.to_path_buf(), Ok(format)),
        None => (
            path.to_path_buf(),
            Err(Fault::unsupported("name the file .vdb, .nvdb, .vol, .npy, .nii, .nii.gz or .raw")),
        ),
    };
    let result =
        result.and_then(|format| atomically(&path_written, |out| write_to(out, format, grids, codec)));
    match result {
        Ok(()) => Ok(path_written),
        Err(Fault::Io(source)) => Err(WriteError::Io { path: path_written, source }),
        Err(Fault::Damaged(what) | Fault::Unsupported(what)) => {
            Err(WriteError::Unsupported { path: path_written, what })
        }
    }
}

fn write_to(out: &mut dyn Write, format: Format, grids: &[Grid], codec: Codec) -> Result<(), Fault> {
    match format {
        Format::OpenVdb => Err(Fault::unsupported("OpenVDB files are not written yet")),
        Format::NanoVdb => nvdb::write(out, grids, codec),
        Format::Mitsuba => vol::write(out, only(grids)?),
        Format::NumPy => npy::write(out, only(grids)?),
        Format::Nifti => nifti::write(out, only(grids)?),
        Format::NiftiGzip => {
            let mut packed = GzEncoder::new(out, Compression::default());
            nifti::write(&mut packed, only(grids)?)?;
            packed.finish().map(drop).map_err(Fault::Io)
        }
        Format::Raw => raw::write(out, only(grids)?),
    }
}

/// The one grid there is.
fn only(grids: &[Grid]) -> Result<&Grid, Fault> {
    match grids {
        [grid] => Ok(grid),
        [] => Err(Fault::unsupported("there is no grid to write")),
        grids => {
            let names: Vec<_> = grids.iter().map(|grid| format!("`{}`", grid.name)).collect();
            Err(Fault::Unsupported(format!("this format holds one grid; choose one of {}", names.join(", "))))
        }
    }
}

/// Lets `write` fill a file beside `path`, which takes its place when all went well.
pub(crate) fn atomically(
    path: &Path,
    write: impl FnOnce(&mut dyn Write) -> Result<(), Fault>,
) -> Result<(), Fault> {
    let Some(name) = path.file_name() else {
        return Err(Fault::unsupported("is no name for a file"));
    };
    let mut unfinished = std::ffi::OsString::from(".");
    unfinished.push(name);
    unfinished.push(format!(".{}.unfinished", std::process::id()));
    let unfinished = path.with_file_name(unfinished);
    let file = File::create(&unfinished).map_err(Fault::Io)?;
    let mut out = BufWriter::with_capacity(1 << 20, file);
    let result = write(&mut out)
        .and_then(|()| out.into_inner().map_err(|error| Fault::Io(error.into_error())))
        .and_then(|file| file.sync_all().map_err(Fault::Io))
        .and_then(|()| fs::rename(&unfinished, path).map_err(Fault::Io));
    if result.is_err() {
        // The failure itself is what the user has to hear of.
        let _ = fs::remove_file(&unfinished);
    }
    result
}
