//! From grids to a file, which appears under its name only when it is whole.
//!
//! File version 224, with offsets, as OpenVDB 7 to 12 write it; the layout is told in `header`, `metadata`,
//! `transform`, `topology`, `leaves` and `values`. The UUID is a hash of the content: equal files for equal grids.

use super::encode::Codec;
use super::header::{HALF_SUFFIX, MAGIC, SEPARATOR, UUID_LEN};
use super::leaves::LeafKind;
use super::nodes::Root;
use super::sink::{Failure, Sink};
use super::tree::TreeType;
use super::value::Value;
use super::write_tree::TreeWriter;
use super::{metadata, transform};
use crate::{Components, Grid, GridStatistics, GridValues, Tree, WriteError};
use std::collections::{BTreeMap, HashSet};
use std::path::Path;
use tyndall_machine::{Unfinished, write_atomically};

const VERSION: u32 = 224;
/// The library whose format this is; some readers look at it.
const LIBRARY_VERSION: [u32; 2] = [10, 0];

/// How to write.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct WriteOptions {
    /// Compression, beside that inactive values are left out.
    pub codec: Codec,
    /// Whether floating-point values are rounded to 16-bit halves.
    pub half: bool,
}

/// Writes grids into a file, replacing what is there.
///
/// # Errors
/// When the file cannot be written, when leaves or tiles of a tree overlap or stand where an OpenVDB tree has no
/// place for them, and when a finite value is too large for a half that is asked for.
pub fn write(path: &Path, grids: &[Grid], options: &WriteOptions) -> Result<(), WriteError> {
    write_atomically(path, |file| write_file(file, grids, options)).map_err(|failure| match failure {
        Failure::Io(error) => WriteError::Io { path: path.to_owned(), error },
        Failure::Unwritable(what) => WriteError::Unwritable { path: path.to_owned(), what },
    })
}

/// Appends a u32 length and the bytes.
pub(super) fn string(out: &mut Vec<u8>, text: &str) {
    out.extend_from_slice(&(text.len() as u32).to_le_bytes());
    out.extend_from_slice(text.as_bytes());
}

fn write_file(file: &mut Unfinished<'_>, grids: &[Grid], options: &WriteOptions) -> Result<(), Failure> {
    let mut sink = Sink::new(file);
    let mut start = MAGIC.to_vec();
    for number in [VERSION].into_iter().chain(LIBRARY_VERSION) {
        start.extend_from_slice(&number.to_le_bytes());
    }
    start.push(1);
    let uuid_position = start.len() as u64;
    start.extend_from_slice(&[b'0'; UUID_LEN]);
    let creator = concat!("Tyndall ", env!("CARGO_PKG_VERSION"));
    put_metadata(&BTreeMap::from([("creator".to_owned(), ("string", creator.into()))]), &mut start);
    start.extend_from_slice(&(grids.len() as i32).to_le_bytes());
    sink.put(&start)?;
    for (grid, unique_name) in grids.iter().zip(unique_names(grids)) {
        let writer = GridWriter { grid, unique_name, options };
        writer.write(&mut sink).map_err(|failure| match failure {
            Failure::Unwritable(what) => {
                Failure::Unwritable(format!("grid `{}`: {what}", super::cursor::quotable(&grid.name)))
            }
            failure => failure,
        })?;
    }
    let uuid = sink.uuid();
    sink.patch(uuid_position, uuid.as_bytes())
}

/// Names with a number behind where several grids, or one without a name, would have the same.
fn unique_names(grids: &[Grid]) -> Vec<String> {
    let mut taken = HashSet::new();
    let mut names = Vec::new();
    for grid in grids {
        let alone = grids.iter().filter(|other| other.name == grid.name).count() == 1;
        let mut unique = grid.name.clone();
        if unique.is_empty() || !alone {
            let numbered = |number: usize| format!("{}{SEPARATOR}{number}", grid.name);
            unique = (0..).map(numbered).find(|name| !taken.contains(name)).unwrap_or(unique);
        }
        taken.insert(unique.clone());
        names.push(unique);
    }
    names
}

fn put_metadata(entries: &BTreeMap<String, (&str, Vec<u8>)>, out: &mut Vec<u8>) {
    out.extend_from_slice(&(entries.len() as u32).to_le_bytes());
    for (name, (kind, bytes)) in entries {
        string(out, name);
        string(out, kind);
        out.extend_from_slice(&(bytes.len() as u32).to_le_bytes());
        out.extend_from_slice(bytes);
    }
}

struct GridWriter<'a> {
    grid: &'a Grid,
    unique_name: String,
    options: &'a WriteOptions,
}

impl GridWriter<'_> {
    fn write(&self, sink: &mut Sink) -> Result<(), Failure> {
        match &self.grid.values {
            GridValues::Float(tree) => self.write_tree(tree, TreeType::Float, LeafKind::Values, sink),
            GridValues::Double(tree) => self.write_tree(tree, TreeType::Double, LeafKind::Values, sink),
            GridValues::Vec3(tree) => self.write_tree(tree, TreeType::Vec3, LeafKind::Values, sink),
            GridValues::Int32(tree) => self.write_tree(tree, TreeType::Int32, LeafKind::Values, sink),
            GridValues::Int64(tree) => self.write_tree(tree, TreeType::Int64, LeafKind::Values, sink),
            GridValues::Bool(tree) => self.write_tree(tree, TreeType::Bool, LeafKind::Bools, sink),
            GridValues::Mask(tree) => self.write_tree(tree, TreeType::Mask, LeafKind::Mask, sink),
        }
    }

    fn write_tree<T: Value + Components>(
        &self,
        tree: &Tree<T>,
        tree_type: TreeType,
        kind: LeafKind,
        sink: &mut Sink,
    ) -> Result<(), Failure> {
        let half = self.options.half && tree_type.is_real();
        let root = Root::build(tree).map_err(Failure::Unwritable)?;
        let tree = TreeWriter::new(tree, self.options.codec, half, kind).map_err(Failure::Unwritable)?;
        let mut out = Vec::new();
        string(&mut out, &self.unique_name);
        string(&mut out, &format!("{}{}", tree_type.name(), if half { HALF_SUFFIX } else { "" }));
        string(&mut out, "");
        sink.put(&out)?;
        let offsets_position = sink.position;
        sink.put(&[0; 24])?;
        let start = sink.position;

        out.clear();
        out.extend_from_slice(&self.options.codec.flags().to_le_bytes());
        put_metadata(&self.metadata(&tree.tree.statistics(), half, tree.tree.memory_bytes()), &mut out);
        transform::write(&self.grid.index_to_world, &mut out);
        out.extend_from_slice(&1u32.to_le_bytes());
        sink.put(&out)?;
        tree.write_topology(&root, sink)?;
        let blocks = sink.position;
        tree.write_leaves(&root.leaves(), sink)?;

        let offsets = [start, blocks, sink.position].map(u64::to_le_bytes);
        sink.patch(offsets_position, offsets.as_flattened())?;
        Ok(())
    }

    /// The grid's own, those that OpenVDB understands with their types, and the statistics that it adds itself.
    fn metadata(
        &self,
        statistics: &GridStatistics,
        half: bool,
        memory: usize,
    ) -> BTreeMap<String, (&str, Vec<u8>)> {
        let mut entries = BTreeMap::new();
        for (name, text) in &self.grid.metadata {
            let value = match name.as_str() {
                "" => continue,
                metadata::LOCAL_SPACE => ("bool", vec![u8::from(text == "true")]),
                name if name.starts_with(metadata::FILE_PREFIX) => continue,
                _ => ("string", text.clone().into_bytes()),
            };
            entries.insert(name.clone(), value);
        }
        let mut set = |name: &str, kind, bytes| entries.insert(name.to_owned(), (kind, bytes));
        set(metadata::NAME, "string", self.grid.name.clone().into_bytes());
        set(metadata::CLASS, "string", metadata::class_name(self.grid.class).into());
        set(metadata::HALF, "bool", vec![u8::from(half)]);
        let [min, max] = statistics.active_bbox.unwrap_or([[i32::MAX; 3], [i32::MIN; 3]]);
        set("file_bbox_min", "vec3i", min.map(i32::to_le_bytes).as_flattened().to_vec());
        set("file_bbox_max", "vec3i", max.map(i32::to_le_bytes).as_flattened().to_vec());
        set("file_voxel_count", "int64", statistics.active_voxels.to_le_bytes().to_vec());
        set("file_mem_bytes", "int64", (memory as u64).to_le_bytes().to_vec());
        let codec = match self.options.codec {
            Codec::None => "active values",
            Codec::Zip => "zip + active values",
            Codec::Blosc => "blosc + active values",
        };
        set("file_compression", "string", codec.into());
        entries
    }
}
