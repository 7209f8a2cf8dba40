//! The trees that are read, by the type a descriptor names: `Tree_float_5_4_3` is a tree of floats with 32³ and 16³
//! entries in its inner nodes and 8³ voxels in its leaves.

use super::cursor::{Cursor, Problem, quotable};
use super::leaves::{self, LeafKind};
use super::topology::{self, Topology};
use super::value::{Value, Width};
use crate::{GridValues, Tree};

/// A type of trees that is read.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum TreeType {
    Half,
    Float,
    Double,
    Vec3,
    Int32,
    Int64,
    Bool,
    Mask,
}

const NAMES: [(&str, TreeType); 8] = [
    ("half", TreeType::Half),
    ("float", TreeType::Float),
    ("double", TreeType::Double),
    ("vec3s", TreeType::Vec3),
    ("int32", TreeType::Int32),
    ("int64", TreeType::Int64),
    ("bool", TreeType::Bool),
    ("mask", TreeType::Mask),
];
const STANDARD_SHAPE: &str = "5_4_3";

impl TreeType {
    /// The type by its name in a file.
    pub(super) fn parse(name: &str) -> Result<Self, Problem> {
        let unsupported = |what: String| Err(Problem::Unsupported(what));
        let quoted = quotable(name);
        let Some((values, shape)) = name.strip_prefix("Tree_").and_then(|rest| rest.split_once('_')) else {
            return unsupported(format!("its type `{quoted}` is not known"));
        };
        if values.starts_with("ptdataidx") || values.starts_with("ptidx") {
            return unsupported("it holds points, not voxels; rasterise them into a density first".into());
        }
        let Some((_, tree_type)) = NAMES.into_iter().find(|(known, _)| *known == values) else {
            let known: Vec<&str> = NAMES.into_iter().map(|(known, _)| known).collect();
            return unsupported(format!(
                "its values are of type `{}`, only {} are read",
                quotable(values),
                known.join(", ")
            ));
        };
        if shape != STANDARD_SHAPE {
            return unsupported(format!(
                "its tree `{quoted}` has other node sizes than the standard {STANDARD_SHAPE}; copy it into a standard grid"
            ));
        }
        Ok(tree_type)
    }

    /// The name of the type in a file.
    pub(super) fn name(self) -> String {
        let (name, _) = NAMES.into_iter().find(|(_, known)| *known == self).unwrap_or(NAMES[1]);
        format!("Tree_{name}_{STANDARD_SHAPE}")
    }

    /// Whether values may be saved as halves.
    pub(super) fn is_real(self) -> bool {
        matches!(self, Self::Half | Self::Float | Self::Double | Self::Vec3)
    }

    /// Reads a tree; `file` ends where its grid may end, and `cursor` stands in it.
    pub(super) fn read(
        self,
        file: &[u8],
        cursor: &mut Cursor,
        storage: Storage,
    ) -> Result<GridValues, Problem> {
        let Storage { flags, saved_as_half, .. } = storage;
        let width = match self {
            Self::Half => Width::Half,
            _ if saved_as_half => Width::HalfArrays,
            _ => Width::Full,
        };
        let source = Source { file, flags, width, decode: storage.decode };
        Ok(match self {
            Self::Half | Self::Float => GridValues::Float(source.tree(cursor, LeafKind::Values)?),
            Self::Double => GridValues::Double(source.tree(cursor, LeafKind::Values)?),
            Self::Vec3 => GridValues::Vec3(source.tree(cursor, LeafKind::Values)?),
            Self::Int32 => GridValues::Int32(source.tree(cursor, LeafKind::Values)?),
            Self::Int64 => GridValues::Int64(source.tree(cursor, LeafKind::Values)?),
            Self::Bool => GridValues::Bool(source.tree(cursor, LeafKind::Bools)?),
            Self::Mask => GridValues::Mask(source.tree(cursor, LeafKind::Mask)?),
        })
    }
}

/// How a tree stands in its file and what is wanted of it.
#[derive(Debug, Clone, Copy)]
pub(super) struct Storage {
    /// Compression flags of the grid.
    pub(super) flags: u32,
    pub(super) saved_as_half: bool,
    /// Whether the values of the leaves are wanted; without them a tree is only passed by.
    pub(super) decode: bool,
}

struct Source<'a> {
    file: &'a [u8],
    flags: u32,
    width: Width,
    decode: bool,
}

impl Source<'_> {
    fn tree<T: Value>(&self, cursor: &mut Cursor, kind: LeafKind) -> Result<Tree<T>, Problem> {
        let topology = topology::read(cursor, self.flags, self.width)?;
        let offsets = leaves::find(cursor, &topology, kind)?;
        let leaf_values = match self.decode {
            true => leaves::decode(self.file, &topology, kind, &offsets)?,
            false => Vec::new(),
        };
        let Topology { coding, tiles, leaves } = topology;
        Ok(Tree { background: coding.background, tiles, leaves, leaf_values })
    }
}
