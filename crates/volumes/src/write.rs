//! Writing grids to a file whose extension says the format.
//!
//! The file is written under another name in the same folder and renamed when it is whole: a reader never sees half
//! a file, and a failure leaves what was there before.

use std::io::Write;
use std::path::{Path, PathBuf};

use flate2::Compression;
use flate2::write::GzEncoder;
use tyndall_machine::{memory, write_atomically};

use crate::fault::Fault;
use crate::float_tree::converted_bytes;
use crate::{Codec, Format, Grid, WriteError, WriteOptions, nifti, npy, nvdb, raw, vdb, vol};

/// Writes `grids` in the format of the extension of `path`; returns the path written, which for `.raw` is given the
/// shape if it lacks it.
///
/// OpenVDB and NanoVDB files hold all the grids as they are; the others hold the box around the active voxels of one,
/// as 32-bit floats, and forget which voxels are active.
///
/// # Errors
/// If the file cannot be written, or the format cannot hold these grids.
pub fn write(path: &Path, grids: &[Grid], options: &WriteOptions) -> Result<PathBuf, WriteError> {
    let error = |fault| match fault {
        Fault::Io(error) => WriteError::Io { path: path.to_path_buf(), error },
        Fault::Damaged(what) | Fault::Unsupported(what) => {
            WriteError::Unwritable { path: path.to_path_buf(), what }
        }
    };
    let format = Format::from_extension(path).ok_or_else(|| {
        error(Fault::unsupported("name the file .vdb, .nvdb, .vol, .npy, .nii, .nii.gz or .raw"))
    })?;
    if format == Format::OpenVdb {
        return vdb::write(path, grids, options).map(|()| path.to_path_buf());
    }
    if options.half {
        return Err(error(Fault::unsupported(
            "only OpenVDB files are written in halves; name the file .vdb",
        )));
    }
    let path_written = match format {
        Format::Raw => only(grids).and_then(|grid| raw::name_with_shape(path, grid)).map_err(error)?,
        _ => path.to_path_buf(),
    };
    if path.file_name().is_none() {
        return Err(error(Fault::unsupported("is no name for a file")));
    }
    write_atomically(&path_written, |out| write_to(out, format, grids, options.codec)).map_err(error)?;
    Ok(path_written)
}

/// Writes a file of any format but that of OpenVDB, whose writer makes its own file.
fn write_to(out: &mut dyn Write, format: Format, grids: &[Grid], codec: Codec) -> Result<(), Fault> {
    let converted = grids.iter().map(|grid| converted_bytes(&grid.values)).max().unwrap_or(0);
    memory::ask(converted, || "its values as floats".to_owned())?;
    match format {
        Format::OpenVdb => Ok(()),
        Format::NanoVdb => nvdb::write(out, grids, codec),
        Format::Mitsuba => vol::write(out, only(grids)?),
        Format::NumPy => npy::write(out, only(grids)?),
        Format::Nifti => nifti::write(out, only(grids)?),
        Format::NiftiGzip => {
            let mut packed = GzEncoder::new(out, Compression::default());
            nifti::write(&mut packed, only(grids)?)?;
            packed.finish().map_err(Fault::Io)?;
            Ok(())
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
