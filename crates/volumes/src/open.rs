//! Any volume file: its format from its content, then its grids.
//!
//! Magic bytes decide; the extension is asked only where there are none (`.raw`) and to word a refusal. So a NanoVDB
//! file named `.vdb` is read as what it is.

use std::fmt;
use std::io::{BufReader, Cursor, Read, Seek, SeekFrom};
use std::path::Path;

use flate2::read::MultiGzDecoder;
use tyndall_machine::files;

use crate::fault::{Fault, one_line};
use crate::raw::RawShape;
use crate::{Grid, GridSelection, ReadError, nifti, npy, nvdb, raw, vdb, vol};

/// A format of volume files.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Format {
    /// OpenVDB, `.vdb`.
    OpenVdb,
    /// NanoVDB, `.nvdb`.
    NanoVdb,
    /// Mitsuba's grid volume, `.vol`.
    Mitsuba,
    /// NumPy array, `.npy`.
    NumPy,
    /// NIfTI image, `.nii`.
    Nifti,
    /// NIfTI image in gzip, `.nii.gz`.
    NiftiGzip,
    /// Bare numbers, `.raw`.
    Raw,
}

impl fmt::Display for Format {
    fn fmt(&self, out: &mut fmt::Formatter) -> fmt::Result {
        out.write_str(match self {
            Self::OpenVdb => "OpenVDB",
            Self::NanoVdb => "NanoVDB",
            Self::Mitsuba => "Mitsuba volume",
            Self::NumPy => "NumPy array",
            Self::Nifti => "NIfTI",
            Self::NiftiGzip => "NIfTI (gzip)",
            Self::Raw => "raw",
        })
    }
}

impl Format {
    /// The format that the name of a file promises.
    pub fn from_extension(path: &Path) -> Option<Self> {
        let name = path.file_name()?.to_str()?.to_ascii_lowercase();
        [
            (".vdb", Self::OpenVdb),
            (".nvdb", Self::NanoVdb),
            (".vol", Self::Mitsuba),
            (".npy", Self::NumPy),
            (".nii", Self::Nifti),
            (".nii.gz", Self::NiftiGzip),
            (".raw", Self::Raw),
        ]
        .into_iter()
        .find_map(|(extension, format)| name.ends_with(extension).then_some(format))
    }

    /// The format of a file that begins with `start` (348 bytes, or as many as the file has), if that tells it.
    fn from_content(start: &[u8]) -> Option<Self> {
        let magic = start.get(..8).and_then(|magic| Some(u64::from_le_bytes(magic.try_into().ok()?)));
        let nano = [nvdb::MAGIC_0, nvdb::MAGIC_1, nvdb::MAGIC_2];
        match magic {
            Some(OPEN_VDB) => Some(Self::OpenVdb),
            Some(magic) if nano.contains(&magic) || nano.contains(&magic.swap_bytes()) => Some(Self::NanoVdb),
            _ if start.starts_with(npy::MAGIC) => Some(Self::NumPy),
            _ if start.starts_with(vol::MAGIC) => Some(Self::Mitsuba),
            _ if nifti::recognise(start) => Some(Self::Nifti),
            _ if start.starts_with(&[0x1f, 0x8b]) => Some(Self::NiftiGzip),
            _ => None,
        }
    }
}

/// The first eight bytes of an OpenVDB file.
const OPEN_VDB: u64 = 0x5644_4220;
/// As many bytes as telling a format takes.
const START: u64 = 348;

/// What to read of a file.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ReadRequest {
    /// The grids wanted.
    pub grids: GridSelection,
    /// Shape and type of a `.raw` file; otherwise they are taken from its name.
    pub raw: Option<RawShape>,
}

impl Default for ReadRequest {
    fn default() -> Self {
        Self { grids: GridSelection::All, raw: None }
    }
}

/// What a file holds.
#[derive(Debug, Clone)]
pub struct VolumeFile {
    /// The format its content has.
    pub format: Format,
    /// The grids asked for, in file order.
    pub grids: Vec<Grid>,
    /// Grids that are sound but of a kind not read here: name and reason.
    pub skipped: Vec<(String, String)>,
}

/// Reads a volume file.
///
/// # Errors
/// If the file cannot be opened, is damaged or of no known format, lacks a grid asked for by name, or has none that
/// can be read.
pub fn read(path: &Path, request: &ReadRequest) -> Result<VolumeFile, ReadError> {
    let file = files::open(path).map_err(|error| Fault::Io(error).at(path))?;
    read_source(BufReader::new(file), path, request, || vdb::read(path, &request.grids))
}

/// Reads a volume file whose content is `bytes`; `path` stands in messages and gives the extension.
///
/// # Errors
/// As [`read`].
pub fn read_bytes(bytes: &[u8], path: &Path, request: &ReadRequest) -> Result<VolumeFile, ReadError> {
    read_source(Cursor::new(bytes), path, request, || vdb::read_bytes(bytes, path, &request.grids))
}

/// Reads `source` by its format; `read_open_vdb` reads the same file if it is one of OpenVDB.
fn read_source(
    mut source: impl Read + Seek,
    path: &Path,
    request: &ReadRequest,
    read_open_vdb: impl FnOnce() -> Result<vdb::VdbFile, ReadError>,
) -> Result<VolumeFile, ReadError> {
    let format = format_of(&mut source, path, request).map_err(|fault| fault.at(path))?;
    if format == Format::OpenVdb {
        let vdb::VdbFile { grids, skipped } = read_open_vdb()?;
        let skipped = skipped.into_iter().map(|skipped| (skipped.name, skipped.why)).collect();
        return Ok(VolumeFile { format, grids, skipped });
    }
    let mut found = Found::default();
    read_found(&mut source, format, path, request, &mut found).map_err(|fault| fault.at(path))?;
    found.into_file(format, path, &request.grids)
}

fn format_of(source: &mut (impl Read + Seek), path: &Path, request: &ReadRequest) -> Result<Format, Fault> {
    let mut start = Vec::new();
    source.by_ref().take(START).read_to_end(&mut start)?;
    let promised = Format::from_extension(path);
    match Format::from_content(&start) {
        Some(format) => Ok(format),
        None if promised == Some(Format::Raw) || request.raw.is_some() => Ok(Format::Raw),
        None => Err(unknown(&start, promised)),
    }
}

/// Reads a file of any format but that of OpenVDB, whose reader has its own way of finding grids.
fn read_found(
    source: &mut (impl Read + Seek),
    format: Format,
    path: &Path,
    request: &ReadRequest,
    found: &mut Found,
) -> Result<(), Fault> {
    let available = source.seek(SeekFrom::End(0))?;
    source.rewind()?;
    let grid = match format {
        Format::OpenVdb => return Ok(()),
        Format::NanoVdb => return nvdb::read(source, &request.grids, found),
        Format::Mitsuba => vol::read(source, available)?,
        Format::NumPy => npy::read(source, available)?,
        Format::Nifti => nifti::read(source, Some(available))?,
        Format::NiftiGzip => read_gzip(source)?,
        Format::Raw => {
            let shape = request.raw.or_else(|| RawShape::from_file_name(path)).ok_or_else(|| {
                Fault::unsupported(
                    "a .raw file does not say its shape; give shape and type (such as 256x256x256 uint8), \
                     or name the file like volume_256x256x256_uint8.raw",
                )
            })?;
            raw::read(source, available, &shape)?
        }
    };
    let name = grid.name.clone();
    match found.wants(&request.grids, &name) {
        true => found.take(&name, Ok(grid)),
        false => {
            found.pass(&name);
            Ok(())
        }
    }
}

/// Only the bytes that the image's own header promises are ever decompressed.
fn read_gzip(source: &mut impl Read) -> Result<Grid, Fault> {
    let mut unpacked = MultiGzDecoder::new(source);
    let mut start = Vec::new();
    unpacked.by_ref().take(START).read_to_end(&mut start)?;
    if !nifti::recognise(&start) {
        return Err(Fault::unsupported(
            "in gzip only NIfTI images (.nii.gz) are read; decompress the file first",
        ));
    }
    nifti::read(&mut start.as_slice().chain(unpacked), None)
}

/// The refusal of a file that begins with `start`.
fn unknown(start: &[u8], promised: Option<Format>) -> Fault {
    let what = match (start.is_empty(), promised) {
        (true, _) => "the file is empty".to_owned(),
        (false, Some(format)) => {
            format!("not a file of the format {format}, in spite of its name: no such magic number")
        }
        (false, None) => "not a volume file: neither its content nor its name is that of \
                          .vdb, .nvdb, .vol, .npy, .nii, .nii.gz or .raw"
            .to_owned(),
    };
    Fault::Damaged(what)
}

/// What a reader has come upon so far.
#[derive(Debug, Default)]
pub(crate) struct Found {
    grids: Vec<Grid>,
    skipped: Vec<(String, String)>,
    /// Every name, plain and numbered.
    names: Vec<(String, String)>,
}

impl Found {
    /// Whether the next grid, of this name, is asked for: by its name alone, or as `name[n]` after `n` others.
    pub(crate) fn wants(&self, selection: &GridSelection, name: &str) -> bool {
        match selection {
            GridSelection::All => true,
            GridSelection::Names(names) => {
                let numbered = self.numbered(name);
                names.iter().any(|wanted| wanted == name || *wanted == numbered)
            }
        }
    }

    /// The name that the next grid of this name has among its likes.
    fn numbered(&self, name: &str) -> String {
        let before = self.names.iter().filter(|(other, _)| other == name).count();
        format!("{name}[{before}]")
    }

    /// Keeps a grid that was asked for, or the reason why it is not read; damage ends the reading.
    pub(crate) fn take(&mut self, name: &str, grid: Result<Grid, Fault>) -> Result<(), Fault> {
        self.pass(name);
        match grid {
            Ok(grid) => self.grids.push(grid),
            Err(Fault::Unsupported(reason)) => self.skipped.push((name.to_owned(), reason)),
            Err(fault) => return Err(fault),
        }
        Ok(())
    }

    /// Notes a grid that was not asked for.
    pub(crate) fn pass(&mut self, name: &str) {
        self.names.push((name.to_owned(), self.numbered(name)));
    }

    /// The answer, once it is known that it holds what was asked for.
    fn into_file(
        self,
        format: Format,
        path: &Path,
        selection: &GridSelection,
    ) -> Result<VolumeFile, ReadError> {
        let Self { grids, skipped, names } = self;
        let refused = |(name, reason): &(String, String)| {
            Fault::Unsupported(format!("grid `{name}`: {reason}")).at(path)
        };
        if let GridSelection::Names(wanted) = selection {
            if let Some(name) = wanted
                .iter()
                .find(|&wanted| !names.iter().any(|(plain, numbered)| [plain, numbered].contains(&wanted)))
            {
                let available = match names.is_empty() {
                    true => vec!["none".to_owned()],
                    false => names.iter().map(|(name, _)| format!("`{}`", one_line(name))).collect(),
                };
                return Err(ReadError::NoSuchGrid {
                    path: path.to_path_buf(),
                    name: name.clone(),
                    available,
                });
            }
            if let Some(skipped) = skipped.first() {
                return Err(refused(skipped));
            }
        }
        match skipped.first() {
            Some(skipped) if grids.is_empty() => Err(refused(skipped)),
            _ => Ok(VolumeFile { format, grids, skipped }),
        }
    }
}
