//! From a file to the grids that are wanted of it.

use super::cursor::{Cursor, Problem, damaged, quotable};
use super::header::{Descriptor, Header, MAGIC};
use super::tree::{Storage, TreeType};
use super::values::{ACTIVE_MASK, BLOSC, ZIP};
use super::{metadata, transform};
use crate::{Grid, GridSelection, GridValues, ReadError};
use glam::DAffine3;
use std::collections::BTreeMap;
use std::io::Read;
use std::path::Path;
use tyndall_machine::{files, memory};

/// Trees that several grids share are copied up to so many bytes a file. Past that the file is either one of its
/// kind or made to exhaust memory.
const COPY_BUDGET: usize = 32 << 20;

/// What was read of a file.
#[derive(Debug, Clone)]
pub struct VdbFile {
    /// The grids wanted, in file order.
    pub grids: Vec<Grid>,
    /// The grids that cannot be read, when all were wanted.
    pub skipped: Vec<SkippedGrid>,
}

/// A grid that is not read.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct SkippedGrid {
    /// Its name, with its number if several grids have the name, as `density[1]`.
    pub name: String,
    /// Why, in one line.
    pub why: String,
}

/// Reads grids of a file.
///
/// # Errors
/// When the file cannot be opened or is damaged, when a grid asked for by name is not there or is of a kind that is
/// not read, and when all are asked for and none can be read.
pub fn read(path: &Path, selection: &GridSelection) -> Result<VdbFile, ReadError> {
    let io = |error| ReadError::Io { path: path.to_owned(), error };
    let mut file = files::open(path).map_err(io)?;
    let mut bytes = Vec::new();
    // A large file of another kind is not read to its end.
    file.by_ref().take(MAGIC.len() as u64).read_to_end(&mut bytes).map_err(io)?;
    if bytes == MAGIC {
        let len = file.metadata().map_err(io)?.len();
        memory::ask(len, || format!("the {len} bytes of the file")).map_err(|error| io(error.into()))?;
        bytes
            .try_reserve_exact(usize::try_from(len).unwrap_or(usize::MAX))
            .map_err(|error| io(error.into()))?;
        file.read_to_end(&mut bytes).map_err(io)?;
    }
    read_bytes(&bytes, path, selection)
}

/// Reads grids of a file that is in memory already; `path` is for messages.
///
/// # Errors
/// As [`read`].
pub fn read_bytes(bytes: &[u8], path: &Path, selection: &GridSelection) -> Result<VdbFile, ReadError> {
    let archive = Archive::open(bytes).map_err(|problem| problem.of(path))?;
    let wanted = archive.select(path, selection)?;
    archive.load(&wanted, selection).map_err(|problem| problem.of(path))
}

impl Problem {
    fn of(self, path: &Path) -> ReadError {
        let path = path.to_owned();
        match self {
            Self::Damaged(what) => ReadError::Damaged { path, what },
            Self::Unsupported(what) => ReadError::Unsupported { path, what },
            Self::Memory(error) => ReadError::Io { path, error: error.into() },
        }
    }

    fn of_grid(self, descriptor: &Descriptor) -> Self {
        self.at(&format!("grid `{}`", descriptor.label()))
    }
}

/// A file whose grids are known, but not read.
struct Archive<'a> {
    bytes: &'a [u8],
    descriptors: Vec<Descriptor>,
    /// In a stream: why the last descriptor's grid cannot be passed.
    barrier: Option<Problem>,
}

/// What stands before the tree of a grid.
struct Preface {
    flags: u32,
    metadata: Vec<(String, String)>,
    /// Nothing if it is a frustum.
    index_to_world: Option<DAffine3>,
}

impl<'a> Archive<'a> {
    fn open(bytes: &'a [u8]) -> Result<Self, Problem> {
        let mut cursor = Cursor::new(bytes, 0);
        let header = Header::read(&mut cursor)?;
        let mut archive = Self { bytes, descriptors: Vec::new(), barrier: None };
        for _ in 0..header.grid_count {
            let mut descriptor = Descriptor::read(&mut cursor, header.has_offsets)?;
            let passed = match descriptor.end {
                Some(end) => {
                    cursor = Cursor::new(bytes, end);
                    Ok(())
                }
                None => pass(bytes, &mut cursor, &descriptor).map_err(|problem| problem.of_grid(&descriptor)),
            };
            descriptor.end = Some(cursor.position());
            archive.descriptors.push(descriptor);
            match passed {
                Ok(()) => {}
                Err(problem @ Problem::Unsupported(_)) => {
                    archive.barrier = Some(problem);
                    break;
                }
                Err(problem) => return Err(problem),
            }
        }
        Ok(archive)
    }

    /// The numbers of the descriptors wanted, in file order.
    fn select(&self, path: &Path, selection: &GridSelection) -> Result<Vec<usize>, ReadError> {
        let GridSelection::Names(names) = selection else {
            return Ok((0..self.descriptors.len()).collect());
        };
        let mut wanted = Vec::new();
        for name in names {
            let matching = |is: &dyn Fn(&Descriptor) -> bool| {
                (0..self.descriptors.len()).filter(|&index| is(&self.descriptors[index])).collect::<Vec<_>>()
            };
            let mut found = matching(&|descriptor| descriptor.name() == name);
            if found.is_empty() {
                found = matching(&|descriptor| descriptor.numbered_name() == *name);
            }
            if found.is_empty() {
                return Err(match &self.barrier {
                    Some(barrier) => {
                        barrier.clone().at(&format!("grid `{}` cannot be reached", quotable(name))).of(path)
                    }
                    None => ReadError::NoSuchGrid {
                        path: path.to_owned(),
                        name: quotable(name),
                        available: self.descriptors.iter().map(|it| format!("`{}`", it.label())).collect(),
                    },
                });
            }
            wanted.extend(found);
        }
        wanted.sort_unstable();
        wanted.dedup();
        Ok(wanted)
    }

    fn load(&self, wanted: &[usize], selection: &GridSelection) -> Result<VdbFile, Problem> {
        let mut users = BTreeMap::<usize, usize>::new();
        for &index in wanted {
            *users.entry(self.owner_of_tree(index)?).or_default() += 1;
        }
        let mut trees = BTreeMap::new();
        let mut copied = 0;
        let mut loaded = VdbFile { grids: Vec::new(), skipped: Vec::new() };
        let mut first_refusal = None;
        for &index in wanted {
            let descriptor = &self.descriptors[index];
            match self.load_grid(index, &mut users, &mut trees, &mut copied) {
                Ok(grid) => loaded.grids.push(grid),
                Err(Problem::Unsupported(why)) if *selection == GridSelection::All => {
                    first_refusal.get_or_insert(Problem::Unsupported(why.clone()).of_grid(descriptor));
                    loaded.skipped.push(SkippedGrid { name: descriptor.numbered_name(), why });
                }
                Err(problem) => return Err(problem.of_grid(descriptor)),
            }
        }
        match first_refusal {
            Some(refusal) if loaded.grids.is_empty() => Err(refusal),
            _ => Ok(loaded),
        }
    }

    /// The number of the descriptor whose tree this grid has: its own, unless it is an instance.
    fn owner_of_tree(&self, index: usize) -> Result<usize, Problem> {
        let descriptor = &self.descriptors[index];
        let Some(owner) = &descriptor.instance_of else {
            return Ok(index);
        };
        self.descriptors
            .iter()
            .position(|other| other.unique_name == *owner && other.instance_of.is_none())
            .ok_or_else(|| {
                damaged(format!("it shares the tree of `{}`, which is not there", quotable(owner)))
                    .of_grid(descriptor)
            })
    }

    fn load_grid(
        &self,
        index: usize,
        users: &mut BTreeMap<usize, usize>,
        trees: &mut BTreeMap<usize, (GridValues, u32)>,
        copied: &mut usize,
    ) -> Result<Grid, Problem> {
        let descriptor = &self.descriptors[index];
        let Preface { metadata, index_to_world, .. } = self.open_grid(descriptor)?.1;
        let index_to_world = index_to_world.ok_or_else(|| {
            Problem::Unsupported(
                "its transform is a frustum, only linear transforms are read; resample it onto a linear grid"
                    .into(),
            )
        })?;
        let owner = self.owner_of_tree(index)?;
        let shared = match trees.remove(&owner) {
            Some(tree) => tree,
            None => self.load_tree(owner)?,
        };
        let left = users.get_mut(&owner).map_or(0, |users| {
            *users = users.saturating_sub(1);
            *users
        });
        let (values, flags) = if left == 0 {
            shared
        } else {
            let bytes = shared.0.memory_bytes();
            if *copied + bytes > COPY_BUDGET {
                trees.insert(owner, shared);
                return Err(Problem::Unsupported(format!(
                    "it shares its tree of {} MiB with other grids; read it alone, by its name",
                    bytes >> 20
                )));
            }
            *copied += bytes;
            trees.insert(owner, shared.clone());
            shared
        };
        Ok(Grid {
            name: descriptor.name().to_owned(),
            class: metadata::class(&metadata),
            index_to_world,
            saved_as_half: descriptor.saved_as_half || self.descriptors[owner].tree_type.contains("_half_"),
            codec: codec_name(flags),
            metadata,
            values,
        })
    }

    fn load_tree(&self, index: usize) -> Result<(GridValues, u32), Problem> {
        let descriptor = &self.descriptors[index];
        let tree_type = TreeType::parse(&descriptor.tree_type)?;
        let (mut cursor, preface) = self.open_grid(descriptor)?;
        let storage = Storage { flags: preface.flags, saved_as_half: descriptor.saved_as_half, decode: true };
        let file = &self.bytes[..descriptor.end.unwrap_or(self.bytes.len())];
        Ok((tree_type.read(file, &mut cursor, storage)?, preface.flags))
    }

    fn open_grid(&self, descriptor: &Descriptor) -> Result<(Cursor<'a>, Preface), Problem> {
        TreeType::parse(&descriptor.tree_type)?;
        let file = &self.bytes[..descriptor.end.unwrap_or(self.bytes.len())];
        let mut cursor = Cursor::new(file, descriptor.start);
        let preface = Preface::read(&mut cursor)?;
        Ok((cursor, preface))
    }
}

impl Preface {
    fn read(cursor: &mut Cursor) -> Result<Self, Problem> {
        let flags = cursor.u32("the compression flags")?;
        if flags & !(ZIP | ACTIVE_MASK | BLOSC) != 0 {
            return Err(damaged(format!("its compression flags are {flags:#x}")));
        }
        let metadata = metadata::read(cursor)?;
        let index_to_world = transform::read(cursor)?;
        Ok(Self { flags, metadata, index_to_world })
    }
}

/// Moves past the grid of a stream, which does not say where it ends.
fn pass(bytes: &[u8], cursor: &mut Cursor, descriptor: &Descriptor) -> Result<(), Problem> {
    let tree_type = TreeType::parse(&descriptor.tree_type)?;
    let preface = Preface::read(cursor)?;
    if descriptor.instance_of.is_none() {
        let storage =
            Storage { flags: preface.flags, saved_as_half: descriptor.saved_as_half, decode: false };
        tree_type.read(bytes, cursor, storage)?;
    }
    Ok(())
}

fn codec_name(flags: u32) -> String {
    let names = [(ACTIVE_MASK, "active mask"), (ZIP, "zip"), (BLOSC, "blosc")];
    let used: Vec<&str> =
        names.into_iter().filter(|(flag, _)| flags & flag != 0).map(|(_, name)| name).collect();
    if used.is_empty() { "none".to_owned() } else { used.join(" + ") }
}
