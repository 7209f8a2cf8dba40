//! Walking a NanoVDB tree: root → upper (32³) → lower (16³) → leaf (8³), by byte offsets.
//!
//! Every offset in the file is relative to the node that holds it and is checked before use. Nodes of a level
//! may not overlap: so the work and the memory a file can ask for are bounded by its own bytes, whatever its
//! counts say. Origins follow from the position in the tree, not from the boxes stored in the nodes.

use tyndall_machine::memory;

use crate::fault::Fault;
use crate::little_endian::{bytes_at, i64_at, u32_at, u64_at};
use crate::{Leaf, Tile, Tree};

use super::layout::{GRID_HEAD, InnerNode, LEAF_MASK_AT, LOWER, Layout, TREE_HEAD, UPPER, VALUE_MASK_AT};

/// How values of the type at hand are decoded.
pub(super) struct Decode<V, L> {
    /// One value from the bytes of a tile or the background.
    pub value: V,
    /// Appends the 512 values of the leaf at an offset of the grid's buffer.
    pub leaf: L,
}

/// A node: the index coordinates of its least corner, and its offset in the grid's buffer.
type Node = ([i32; 3], usize);

/// Reads the tree of the grid that fills `grid`.
pub(super) fn read_tree<T, V, L>(grid: &[u8], layout: &Layout, decode: Decode<V, L>) -> Result<Tree<T>, Fault>
where
    T: Copy + PartialEq,
    V: Fn(&[u8]) -> T,
    L: Fn(&[u8], usize, &mut Vec<T>) -> Result<(), Fault>,
{
    let head = bytes_at(grid, GRID_HEAD, TREE_HEAD, "the head of the tree")?;
    let root_at = follow(GRID_HEAD, i64_at(head, 24), "the root")?;
    let root = bytes_at(grid, root_at, layout.root_head(), "the root")?;
    let mut tree = Tree {
        background: (decode.value)(&root[layout.background_at()..]),
        tiles: Vec::new(),
        leaves: Vec::new(),
        leaf_values: Vec::new(),
    };
    let uppers = root_children(grid, root_at, u32_at(root, 24), layout, &decode.value, &mut tree)?;
    let lowers = inner_children(grid, uppers, UPPER, layout, &decode.value, &mut tree)?;
    let leaves = inner_children(grid, lowers, LOWER, layout, &decode.value, &mut tree)?;

    let leaves = apart(leaves, layout.leaf(), grid.len(), "leaves")?;
    memory::ask_for(leaves.len(), crate::LEAF_VOXELS * size_of::<T>(), || {
        format!("{} leaves of 512 voxels of {} bytes", leaves.len(), size_of::<T>())
    })?;
    tree.leaves.reserve_exact(leaves.len());
    tree.leaf_values.reserve_exact(leaves.len() * crate::LEAF_VOXELS);
    for (origin, at) in leaves {
        let mask = &grid[at + LEAF_MASK_AT..at + LEAF_MASK_AT + 64];
        tree.leaves.push(Leaf { origin, active: std::array::from_fn(|x| u64_at(mask, 8 * x)) });
        (decode.leaf)(grid, at, &mut tree.leaf_values)?;
    }
    Ok(tree)
}

/// Takes the root's tiles into `tree` and returns its child nodes.
fn root_children<T: Copy + PartialEq>(
    grid: &[u8],
    root_at: usize,
    entries: u32,
    layout: &Layout,
    value: &impl Fn(&[u8]) -> T,
    tree: &mut Tree<T>,
) -> Result<Vec<Node>, Fault> {
    let size = (entries as usize).saturating_mul(layout.root_entry());
    let table = bytes_at(grid, root_at + layout.root_head(), size, "the root's table")?;
    let mut children = Vec::new();
    let mut origins = Vec::with_capacity(entries as usize);
    for entry in table.chunks_exact(layout.root_entry()) {
        let key = u64_at(entry, 0);
        // 21 bits an axis (20 of them significant): the coordinates divided by 4096, x on top.
        let origin = [42, 21, 0].map(|shift| (((key >> shift) as u32) << 12) as i32);
        origins.push(origin);
        match i64_at(entry, 8) {
            0 => {
                let active = u32_at(entry, 16) != 0;
                push_tile(tree, origin, 12, value(&entry[layout.root_value_at()..]), active);
            }
            offset => children.push((origin, follow(root_at, offset, "an upper node")?)),
        }
    }
    origins.sort_unstable();
    if origins.windows(2).any(|pair| pair[0] == pair[1]) {
        return Err(Fault::damaged("corrupt: the root's table has two entries for one place"));
    }
    Ok(children)
}

/// Takes the tiles of inner `nodes` into `tree` and returns their child nodes.
fn inner_children<T: Copy + PartialEq>(
    grid: &[u8],
    nodes: Vec<Node>,
    kind: InnerNode,
    layout: &Layout,
    value: &impl Fn(&[u8]) -> T,
    tree: &mut Tree<T>,
) -> Result<Vec<Node>, Fault> {
    let size = layout.inner(kind);
    let mut children = Vec::new();
    for (origin, at) in apart(nodes, size, grid.len(), "inner nodes")? {
        let node = &grid[at..at + size];
        let value_mask = &node[VALUE_MASK_AT..][..kind.mask()];
        let child_mask = &node[kind.child_mask_at()..][..kind.mask()];
        let table = &node[layout.table_at(kind)..];
        for (n, entry) in table.chunks_exact(layout.table_entry()).enumerate() {
            let on = |mask: &[u8]| mask[n / 8] >> (n % 8) & 1 == 1;
            let offset = kind.child_offset(n);
            let place = [0, 1, 2].map(|axis| origin[axis] + offset[axis]);
            if on(child_mask) {
                children.push((place, follow(at, i64_at(entry, 0), "a node")?));
            } else {
                push_tile(tree, place, kind.log2_child_edge, value(entry), on(value_mask));
            }
        }
    }
    Ok(children)
}

/// Keeps a tile unless it says the same as the background.
fn push_tile<T: PartialEq>(tree: &mut Tree<T>, origin: [i32; 3], log2_edge: u32, value: T, active: bool) {
    if active || value != tree.background {
        tree.tiles.push(Tile { origin, log2_edge, value, active });
    }
}

/// The place `offset` bytes from `from`.
fn follow(from: usize, offset: i64, what: &str) -> Result<usize, Fault> {
    isize::try_from(offset)
        .ok()
        .and_then(|offset| from.checked_add_signed(offset))
        .ok_or_else(|| Fault::Damaged(format!("corrupt: the offset of {what} points outside the data")))
}

/// `nodes` of `size` bytes in the order of the file, once none leaves the buffer or overlaps another.
fn apart(mut nodes: Vec<Node>, size: usize, buffer: usize, what: &str) -> Result<Vec<Node>, Fault> {
    nodes.sort_unstable_by_key(|&(_, at)| at);
    if nodes.windows(2).any(|pair| pair[1].1 - pair[0].1 < size) {
        return Err(Fault::Damaged(format!("corrupt: {what} of the tree overlap")));
    }
    match nodes.last() {
        Some(&(_, at)) if at.checked_add(size).is_none_or(|end| end > buffer) => {
            Err(Fault::Damaged(format!("truncated or corrupt: {what} of the tree lie outside the data")))
        }
        _ => Ok(nodes),
    }
}
