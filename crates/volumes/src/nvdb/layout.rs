//! Where things stand inside the nodes of a NanoVDB tree, by the type of its values.
//!
//! NanoVDB is a C++ struct dump, so offsets follow from the sizes of two types: the value and the type of its
//! statistics (float, or double for 8-byte values). With `V`, `S` the sizes and everything aligned to 32 bytes:
//!
//! | node | parts |
//! |---|---|
//! | root | box 24, table size 4, background, min, max `3V`, average, deviation `2S`; then the table |
//! | root table entry | key 8, child 8, state 4, value `V` |
//! | upper (32³), lower (16³) | box 24, flags 8, value mask, child mask, `2V + 2S`; then a table of `max(8, V)` an entry |
//! | leaf (8³) | box 15, flags 1, mask 64, `2V + 2S`; then 512 values |
//!
//! Source: the structures of `NanoVDB.h` (OpenVDB project), the same in ABI versions 32.3 to 32.9.

use crate::fault::Fault;

/// The alignment of every node in bytes.
pub(super) const ALIGNMENT: usize = 32;
/// Bytes of the grid's head; the tree's head follows.
pub(super) const GRID_HEAD: usize = 672;
/// Bytes of the tree's head.
pub(super) const TREE_HEAD: usize = 64;
/// Bytes of the active mask of a leaf.
pub(super) const LEAF_MASK: usize = 64;
/// Where the active mask stands in a leaf.
pub(super) const LEAF_MASK_AT: usize = 16;
/// Where the codes stand in a quantised leaf.
pub(super) const CODES_AT: usize = 96;

/// The types of values a NanoVDB grid can have and that are read here.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum ValueType {
    Float = 1,
    Double = 2,
    Int16 = 3,
    Int32 = 4,
    Int64 = 5,
    Vec3f = 6,
    Vec3d = 7,
    Mask = 8,
    UInt32 = 10,
    Boolean = 11,
    Fp4 = 13,
    Fp8 = 14,
    Fp16 = 15,
    FpN = 16,
    UInt8 = 26,
}

impl ValueType {
    /// From the number in the file.
    pub(super) fn from_number(number: u32) -> Result<Self, Fault> {
        const ALL: [ValueType; 15] = {
            use ValueType::*;
            [
                Float, Double, Int16, Int32, Int64, Vec3f, Vec3d, Mask, UInt32, Boolean, Fp4, Fp8, Fp16, FpN,
                UInt8,
            ]
        };
        if let Some(known) = ALL.into_iter().find(|known| known.number() == number) {
            return Ok(known);
        }
        let name = match number {
            9 => "half",
            12 => "RGBA8",
            17 => "Vec4f",
            18 => "Vec4d",
            19 | 20 => "index",
            23 => "point",
            24 => "Vec3u8",
            25 => "Vec3u16",
            other => return Err(Fault::Damaged(format!("corrupt: there is no NanoVDB grid type {other}"))),
        };
        Err(Fault::Unsupported(format!(
            "NanoVDB grids of type {name} are not read; write the grid as float or Vec3f"
        )))
    }

    /// The number in the file.
    pub(super) fn number(self) -> u32 {
        self as u32
    }

    /// Bytes of a value, and of each of its two statistics.
    fn sizes(self) -> (usize, usize) {
        match self {
            Self::Float | Self::Int32 | Self::UInt32 | Self::Fp4 | Self::Fp8 | Self::Fp16 | Self::FpN => {
                (4, 4)
            }
            Self::Double | Self::Int64 => (8, 8),
            Self::Int16 => (2, 4),
            Self::UInt8 => (1, 4),
            Self::Vec3f => (12, 4),
            Self::Vec3d => (24, 8),
            Self::Mask | Self::Boolean => (1, 1),
        }
    }
}

/// Offsets inside the nodes for one type of values.
#[derive(Debug, Clone, Copy)]
pub(super) struct Layout {
    value: usize,
    statistic: usize,
    alignment: usize,
    leaf: usize,
}

/// What tells the two kinds of inner nodes apart.
#[derive(Debug, Clone, Copy)]
pub(super) struct InnerNode {
    /// Base-2 logarithm of the children along an edge.
    pub log2_children: u32,
    /// Base-2 logarithm of a child's edge in voxels.
    pub log2_child_edge: u32,
}

/// 32³ children of 128³ voxels.
pub(super) const UPPER: InnerNode = InnerNode { log2_children: 5, log2_child_edge: 7 };
/// 16³ children (leaves) of 8³ voxels.
pub(super) const LOWER: InnerNode = InnerNode { log2_children: 4, log2_child_edge: 3 };

impl InnerNode {
    /// Children in the table.
    pub(super) fn children(self) -> usize {
        1 << (3 * self.log2_children)
    }

    /// Bytes of one of the two masks.
    pub(super) fn mask(self) -> usize {
        self.children() / 8
    }

    /// Where the child mask stands.
    pub(super) fn child_mask_at(self) -> usize {
        VALUE_MASK_AT + self.mask()
    }

    /// Offset of child `n` from the node's origin in voxels.
    pub(super) fn child_offset(self, n: usize) -> [i32; 3] {
        let log2 = self.log2_children;
        let along = |shift: u32| ((n >> shift) as i32 & ((1 << log2) - 1)) << self.log2_child_edge;
        [along(2 * log2), along(log2), along(0)]
    }
}

/// Where the value mask stands in an inner node.
pub(super) const VALUE_MASK_AT: usize = 32;

impl Layout {
    /// The offsets for `value_type`.
    pub(super) fn of(value_type: ValueType) -> Self {
        let (value, statistic) = value_type.sizes();
        let alignment = match value_type {
            ValueType::Vec3f => 4,
            ValueType::Vec3d => 8,
            _ => value,
        };
        let mut layout = Self { value, statistic, alignment, leaf: 0 };
        layout.leaf = match value_type {
            // The least a leaf of variable width can take; its own width is added when it is read.
            ValueType::Mask | ValueType::FpN => CODES_AT,
            ValueType::Boolean => align(LEAF_MASK_AT + 2 * LEAF_MASK, ALIGNMENT),
            ValueType::Fp4 => CODES_AT + 256,
            ValueType::Fp8 => CODES_AT + 512,
            ValueType::Fp16 => CODES_AT + 1024,
            _ => layout.leaf_values_at() + 512 * value,
        };
        layout
    }

    /// Bytes of a value.
    pub(super) fn value(&self) -> usize {
        self.value
    }

    /// The end of minimum, maximum, average and deviation that begin at `start`.
    fn after_statistics(&self, start: usize) -> usize {
        align(start + 2 * self.value, self.statistic) + 2 * self.statistic
    }

    /// Where the background stands in the root.
    pub(super) fn background_at(&self) -> usize {
        align(28, self.alignment)
    }

    /// Bytes of the root before its table.
    pub(super) fn root_head(&self) -> usize {
        align(self.after_statistics(self.background_at() + self.value), ALIGNMENT)
    }

    /// Where the value stands in an entry of the root's table.
    pub(super) fn root_value_at(&self) -> usize {
        align(20, self.alignment)
    }

    /// Bytes of an entry of the root's table.
    pub(super) fn root_entry(&self) -> usize {
        align(self.root_value_at() + self.value, ALIGNMENT)
    }

    /// Where minimum and maximum stand in an inner node.
    pub(super) fn inner_minimum_at(&self, node: InnerNode) -> usize {
        VALUE_MASK_AT + 2 * node.mask()
    }

    /// Where the table of an inner node stands.
    pub(super) fn table_at(&self, node: InnerNode) -> usize {
        align(self.after_statistics(self.inner_minimum_at(node)), ALIGNMENT)
    }

    /// Bytes of an entry of that table: a value or a 64-bit offset.
    pub(super) fn table_entry(&self) -> usize {
        align(self.value, 8)
    }

    /// Bytes of an inner node.
    pub(super) fn inner(&self, node: InnerNode) -> usize {
        self.table_at(node) + node.children() * self.table_entry()
    }

    /// Where minimum and maximum stand in an unquantised leaf.
    pub(super) fn leaf_minimum_at(&self) -> usize {
        LEAF_MASK_AT + LEAF_MASK
    }

    /// Where the values of an unquantised leaf stand.
    pub(super) fn leaf_values_at(&self) -> usize {
        align(self.after_statistics(self.leaf_minimum_at()), ALIGNMENT)
    }

    /// Bytes of a leaf (of `FpN`: at least).
    pub(super) fn leaf(&self) -> usize {
        self.leaf
    }
}

/// `offset` rounded up to a multiple of `to`.
pub(super) fn align(offset: usize, to: usize) -> usize {
    offset.next_multiple_of(to)
}
