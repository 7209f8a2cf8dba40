//! What stands before the grids, and the descriptor before each of them.
//!
//! ```text
//! u64 magic " BDV" · u32 file version · u32 ×2 library version · u8 has offsets · 36 bytes UUID
//! metadata of the file · i32 number of grids, then for each grid:
//!     string unique name · string tree type · string name of the grid whose tree it shares, or nothing
//!     i64 grid · i64 blocks · i64 end: offsets from the start of the file (0 in streams)
//!     the grid: u32 compression (version 222 on) · metadata · transform · topology · leaf values
//! ```
//!
//! Source: OpenVDB, `io/Archive` and `io/GridDescriptor`.

use super::cursor::{Cursor, Problem, damaged, quotable};
use super::metadata;

pub(super) const MAGIC: [u8; 8] = *b" BDV\0\0\0\0";
/// From here on each grid has compression flags, each node says how it is compressed.
pub(super) const OLDEST_VERSION: u32 = 222;
pub(super) const NEWEST_VERSION: u32 = 225;
/// Stands between a name and the number that makes it unique.
pub(super) const SEPARATOR: char = '\x1e';
/// Ends the type of trees whose values are stored as halves.
pub(super) const HALF_SUFFIX: &str = "_HalfFloat";
pub(super) const UUID_LEN: usize = 36;
/// Far more than anyone writes; bounds the memory that a hostile file can take.
const MOST_GRIDS: u32 = 4096;

/// What the file says of itself.
#[derive(Debug)]
pub(super) struct Header {
    /// Whether descriptors say where grids begin and end.
    pub(super) has_offsets: bool,
    pub(super) grid_count: u32,
}

impl Header {
    pub(super) fn read(cursor: &mut Cursor) -> Result<Self, Problem> {
        if cursor.take(MAGIC.len(), "the magic number").ok() != Some(&MAGIC) {
            return Err(damaged("not an OpenVDB file (the magic number is missing)"));
        }
        let version = cursor.u32("the file version")?;
        if !(OLDEST_VERSION..=NEWEST_VERSION).contains(&version) {
            return Err(Problem::Unsupported(format!(
                "OpenVDB file version {version} is not read, only {OLDEST_VERSION} to {NEWEST_VERSION}; \
                 load it with OpenVDB and write it again"
            )));
        }
        cursor.take(8, "the library version")?;
        let has_offsets = cursor.u8("the mark of offsets")? != 0;
        cursor.take(UUID_LEN, "the UUID")?;
        metadata::read(cursor)?;
        let grid_count = cursor.i32("the number of grids")?;
        let grid_count =
            u32::try_from(grid_count).ok().filter(|&count| count <= MOST_GRIDS).ok_or_else(|| {
                damaged(format!("the number of grids is {grid_count}, at most {MOST_GRIDS} are read"))
            })?;
        Ok(Self { has_offsets, grid_count })
    }
}

/// What stands before a grid.
#[derive(Debug, Clone)]
pub(super) struct Descriptor {
    /// Name with the suffix that makes it unique.
    pub(super) unique_name: String,
    /// Type of the tree without the suffix for halves, as `Tree_float_5_4_3`.
    pub(super) tree_type: String,
    pub(super) saved_as_half: bool,
    /// Unique name of the grid that owns the tree, if this one does not.
    pub(super) instance_of: Option<String>,
    /// Where the grid begins: at its offset or, in a stream, behind the descriptor.
    pub(super) start: usize,
    /// Where it ends, if the file has offsets.
    pub(super) end: Option<usize>,
}

impl Descriptor {
    pub(super) fn read(cursor: &mut Cursor, has_offsets: bool) -> Result<Self, Problem> {
        let unique_name = cursor.string("the name of a grid")?;
        let mut tree_type = cursor.string("the type of a grid")?;
        let instance_of = Some(cursor.string("the name of a shared tree")?).filter(|name| !name.is_empty());
        let saved_as_half = tree_type.ends_with(HALF_SUFFIX);
        if saved_as_half {
            tree_type.truncate(tree_type.len() - HALF_SUFFIX.len());
        }
        let [start, _, end] = [cursor.i64("an offset")?, cursor.i64("an offset")?, cursor.i64("an offset")?];
        let mut descriptor =
            Self { unique_name, tree_type, saved_as_half, instance_of, start: cursor.position(), end: None };
        if has_offsets {
            // Grids stand one behind the other: nothing can be claimed twice, and the walk always moves on.
            let file_len = cursor.position() + cursor.left();
            let in_order = usize::try_from(start)
                .ok()
                .zip(usize::try_from(end).ok())
                .filter(|&(start, end)| cursor.position() <= start && start <= end);
            let (start, end) = in_order.ok_or_else(|| {
                damaged(format!("grid `{}` has impossible offsets: {start} to {end}", descriptor.label()))
            })?;
            if end > file_len {
                return Err(damaged(format!(
                    "truncated: grid `{}` ends at byte {end}, but the file has {file_len}",
                    descriptor.label()
                )));
            }
            descriptor.start = start;
            descriptor.end = Some(end);
        }
        Ok(descriptor)
    }

    /// Name as the user sees it.
    pub(super) fn name(&self) -> &str {
        split(&self.unique_name).0
    }

    /// Name and number, if any, as `name[1]`.
    pub(super) fn numbered_name(&self) -> String {
        match split(&self.unique_name) {
            (name, Some(number)) => format!("{name}[{number}]"),
            (name, None) => name.to_owned(),
        }
    }

    /// The numbered name for messages, in one line.
    pub(super) fn label(&self) -> String {
        quotable(&self.numbered_name())
    }
}

fn split(unique_name: &str) -> (&str, Option<&str>) {
    match unique_name.split_once(SEPARATOR) {
        Some((name, number)) => (name, Some(number)),
        None => (unique_name, None),
    }
}
