//! From a flattened [`Tree`] back to the nodes of a NanoVDB buffer.
//!
//! Nodes stand breadth first, each level in the order of its parents' tables: root, uppers, lowers, leaves. Every node
//! carries the box of its active voxels; float nodes also their least and greatest active value.

use std::collections::BTreeMap;

use tyndall_machine::memory;

use crate::fault::Fault;
use crate::float_tree::{Voxel, active_bounds};
use crate::{LEAF_VOXELS, Tree};

use super::layout::{
    GRID_HEAD, InnerNode, LEAF_MASK_AT, LOWER, Layout, TREE_HEAD, UPPER, VALUE_MASK_AT, ValueType,
};

/// Flag of a node that has active voxels, and of one that has none (not to be rendered).
const HAS_ACTIVE: u8 = 2;
const NONE_ACTIVE: u8 = 1;

/// Values that are written to NanoVDB files.
pub(super) trait Stored: Voxel {
    /// Their type in the file.
    const TYPE: ValueType;
    /// The value as a number, if its kind has an order.
    fn number(self) -> Option<f32>;
}

impl Stored for f32 {
    const TYPE: ValueType = ValueType::Float;
    fn number(self) -> Option<f32> {
        Some(self).filter(|value| !value.is_nan())
    }
}

impl Stored for [f32; 3] {
    const TYPE: ValueType = ValueType::Vec3f;
    fn number(self) -> Option<f32> {
        None
    }
}

/// What is known of the active voxels of a node.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Summary {
    /// Least and greatest index coordinates.
    pub bounds: Option<[[i32; 3]; 2]>,
    /// Least and greatest value.
    range: Option<[f32; 2]>,
    /// How many.
    pub voxels: u64,
    /// Active tiles among the direct children.
    pub tiles: u32,
}

impl Summary {
    fn add_range(&mut self, [low, high]: [f32; 2]) {
        self.range = Some(self.range.map_or([low, high], |[min, max]| [min.min(low), max.max(high)]));
    }

    fn add_bounds(&mut self, [low, high]: [[i32; 3]; 2]) {
        let [min, max] = self.bounds.unwrap_or([low, high]);
        let pick =
            |a: [i32; 3], b: [i32; 3], of: fn(i32, i32) -> i32| [0, 1, 2].map(|axis| of(a[axis], b[axis]));
        self.bounds = Some([pick(min, low, i32::min), pick(max, high, i32::max)]);
    }

    fn add_child(&mut self, child: &Self) {
        self.voxels += child.voxels;
        child.bounds.into_iter().for_each(|bounds| self.add_bounds(bounds));
        child.range.into_iter().for_each(|range| self.add_range(range));
    }

    fn add_tile(&mut self, origin: [i32; 3], log2_edge: u32, number: Option<f32>) {
        self.voxels += 1 << (3 * log2_edge);
        self.tiles += 1;
        self.add_bounds([origin, origin.map(|index| index + ((1 << log2_edge) - 1))]);
        number.into_iter().for_each(|number| self.add_range([number; 2]));
    }
}

/// A grid's buffer with its tree in place and its head still blank.
pub(super) struct Built {
    /// The buffer.
    pub bytes: Vec<u8>,
    /// Nodes: leaves, lowers, uppers.
    pub nodes: [u32; 3],
    /// Active tiles in lowers, uppers, the root.
    pub tiles: [u32; 3],
    /// The whole tree.
    pub summary: Summary,
    /// Type of its values.
    pub value_type: ValueType,
}

/// Least corner of the cube of `2^log2` voxels that holds `origin`.
fn cube(origin: [i32; 3], log2: u32) -> [i32; 3] {
    origin.map(|index| index >> log2 << log2)
}

/// Entry of a child at `origin` in the table of its parent.
fn entry(origin: [i32; 3], parent: InnerNode) -> usize {
    let [x, y, z] =
        origin.map(|index| (index >> parent.log2_child_edge) as usize & ((1 << parent.log2_children) - 1));
    (x << parent.log2_children | y) << parent.log2_children | z
}

/// Lays out `tree`.
pub(super) fn build<T: Stored>(tree: &Tree<T>) -> Result<Built, Fault> {
    if let Some(tile) = tree.tiles.iter().find(|tile| !matches!(tile.log2_edge, 3 | 7 | 12)) {
        return Err(Fault::Unsupported(format!(
            "a NanoVDB tree has no tiles of {} voxels an edge",
            1u64 << tile.log2_edge
        )));
    }
    let mut leaf_order: Vec<_> = (0..tree.leaves.len()).collect();
    let place = |leaf: &usize| {
        let origin = tree.leaves[*leaf].origin;
        (cube(origin, 12), cube(origin, 7), origin)
    };
    leaf_order.sort_unstable_by_key(place);

    let tiles_of = |log2_edge| tree.tiles.iter().filter(move |tile| tile.log2_edge == log2_edge);
    let in_lowers = tree.leaves.iter().map(|leaf| leaf.origin).chain(tiles_of(3).map(|tile| tile.origin));
    let lowers = numbered(in_lowers.map(|origin| (cube(origin, 12), cube(origin, 7))));
    let in_uppers = lowers.keys().map(|&(upper, _)| upper);
    let uppers = numbered(in_uppers.chain(tiles_of(7).map(|tile| cube(tile.origin, 12))));

    let layout = Layout::of(T::TYPE);
    let root_entries = uppers.len() + tiles_of(12).count();
    let root = GRID_HEAD + TREE_HEAD;
    let first_upper = root + layout.root_head() + root_entries * layout.root_entry();
    let first_lower = first_upper + uppers.len() * layout.inner(UPPER);
    let first_leaf = first_lower + lowers.len() * layout.inner(LOWER);
    let size = first_leaf + leaf_order.len() * layout.leaf();
    memory::ask(size as u64, || format!("the {size} bytes of a grid to be written"))?;
    let mut buffer = Buffer { bytes: vec![0; size], layout };

    let uppers_at = |n: usize| first_upper + n * layout.inner(UPPER);
    let lowers_at = |n: usize| first_lower + n * layout.inner(LOWER);
    (0..uppers.len()).for_each(|n| buffer.fill_table(uppers_at(n), UPPER, tree.background));
    (0..lowers.len()).for_each(|n| buffer.fill_table(lowers_at(n), LOWER, tree.background));

    let mut lower_summaries = vec![Summary::default(); lowers.len()];
    for (n, &leaf) in leaf_order.iter().enumerate() {
        let (upper, lower, origin) = place(&leaf);
        let at = first_leaf + n * layout.leaf();
        let parent = lowers[&(upper, lower)];
        lower_summaries[parent].add_child(&buffer.put_leaf(at, tree, leaf));
        buffer.put_child(lowers_at(parent), LOWER, entry(origin, LOWER), at);
    }
    for tile in tiles_of(3) {
        let parent = lowers[&(cube(tile.origin, 12), cube(tile.origin, 7))];
        buffer.put_tile(lowers_at(parent), LOWER, entry(tile.origin, LOWER), tile.value, tile.active);
        if tile.active {
            lower_summaries[parent].add_tile(tile.origin, 3, tile.value.number());
        }
    }
    let mut upper_summaries = vec![Summary::default(); uppers.len()];
    for (&(upper, lower), &n) in &lowers {
        let parent = uppers[&upper];
        buffer.put_summary(lowers_at(n), LOWER, &lower_summaries[n]);
        upper_summaries[parent].add_child(&lower_summaries[n]);
        buffer.put_child(uppers_at(parent), UPPER, entry(lower, UPPER), lowers_at(n));
    }
    for tile in tiles_of(7) {
        let parent = uppers[&cube(tile.origin, 12)];
        buffer.put_tile(uppers_at(parent), UPPER, entry(tile.origin, UPPER), tile.value, tile.active);
        if tile.active {
            upper_summaries[parent].add_tile(tile.origin, 7, tile.value.number());
        }
    }
    let mut summary = Summary::default();
    let mut entry_at = root + layout.root_head();
    for (&origin, &n) in &uppers {
        buffer.put_summary(uppers_at(n), UPPER, &upper_summaries[n]);
        summary.add_child(&upper_summaries[n]);
        buffer.put_root_entry(entry_at, origin, (uppers_at(n) - root) as i64, tree.background, false);
        entry_at += layout.root_entry();
    }
    for tile in tiles_of(12) {
        buffer.put_root_entry(entry_at, tile.origin, 0, tile.value, tile.active);
        entry_at += layout.root_entry();
        if tile.active {
            summary.add_tile(tile.origin, 12, tile.value.number());
        }
    }
    buffer.put_root(root, root_entries, tree.background, &summary);
    let active_tiles = |summaries: &[Summary]| summaries.iter().map(|summary| summary.tiles).sum();
    Ok(Built {
        bytes: buffer.bytes,
        nodes: [leaf_order.len(), lowers.len(), uppers.len()].map(|count| count as u32),
        tiles: [active_tiles(&lower_summaries), active_tiles(&upper_summaries), summary.tiles],
        summary,
        value_type: T::TYPE,
    })
}

/// The distinct `keys` in ascending order, each with its place.
fn numbered<K: Ord>(keys: impl Iterator<Item = K>) -> BTreeMap<K, usize> {
    let mut places: BTreeMap<K, usize> = keys.map(|key| (key, 0)).collect();
    places.values_mut().enumerate().for_each(|(n, place)| *place = n);
    places
}

/// The buffer and where things stand in its nodes.
struct Buffer {
    bytes: Vec<u8>,
    layout: Layout,
}

impl Buffer {
    fn put(&mut self, at: usize, bytes: &[u8]) {
        self.bytes[at..at + bytes.len()].copy_from_slice(bytes);
    }

    fn put_value<T: Stored>(&mut self, at: usize, value: T) {
        let mut bytes = Vec::with_capacity(12);
        value.put(&mut bytes);
        self.put(at, &bytes);
    }

    /// The bounds of an empty node are the wrong way round, as in an empty `CoordBBox`.
    fn put_bounds(&mut self, at: usize, bounds: Option<[[i32; 3]; 2]>) {
        let bounds = bounds.unwrap_or([[i32::MAX; 3], [i32::MIN; 3]]);
        for (n, index) in bounds.into_iter().flatten().enumerate() {
            self.put(at + 4 * n, &index.to_le_bytes());
        }
    }

    fn put_range(&mut self, at: usize, range: Option<[f32; 2]>) {
        for (n, value) in range.into_iter().flatten().enumerate() {
            self.put_value(at + 4 * n, value);
        }
    }

    fn fill_table<T: Stored>(&mut self, node: usize, kind: InnerNode, background: T) {
        for n in 0..kind.children() {
            self.put_value(self.table_entry_at(node, kind, n), background);
        }
    }

    fn table_entry_at(&self, node: usize, kind: InnerNode, n: usize) -> usize {
        node + self.layout.table_at(kind) + n * self.layout.table_entry()
    }

    fn put_child(&mut self, node: usize, kind: InnerNode, n: usize, child: usize) {
        self.bytes[node + kind.child_mask_at() + n / 8] |= 1 << (n % 8);
        let at = self.table_entry_at(node, kind, n);
        self.put(at, &((child - node) as i64).to_le_bytes());
    }

    fn put_tile<T: Stored>(&mut self, node: usize, kind: InnerNode, n: usize, value: T, active: bool) {
        self.bytes[node + VALUE_MASK_AT + n / 8] |= u8::from(active) << (n % 8);
        self.put_value(self.table_entry_at(node, kind, n), value);
    }

    fn put_summary(&mut self, node: usize, kind: InnerNode, summary: &Summary) {
        self.put_bounds(node, summary.bounds);
        self.bytes[node + 24] = if summary.bounds.is_some() { HAS_ACTIVE } else { NONE_ACTIVE };
        self.put_range(node + self.layout.inner_minimum_at(kind), summary.range);
    }

    /// Writes leaf number `leaf` of `tree`.
    fn put_leaf<T: Stored>(&mut self, at: usize, tree: &Tree<T>, leaf: usize) -> Summary {
        let values = &tree.leaf_values[leaf * LEAF_VOXELS..][..LEAF_VOXELS];
        let leaf = &tree.leaves[leaf];
        let mut summary = Summary { bounds: active_bounds(leaf), ..Summary::default() };
        for (n, value) in values.iter().enumerate() {
            if leaf.active[n / 64] >> (n % 64) & 1 == 1 {
                summary.voxels += 1;
                value.number().into_iter().for_each(|number| summary.add_range([number; 2]));
            }
        }
        let [min, max] = summary.bounds.unwrap_or([leaf.origin; 2]);
        for axis in 0..3 {
            self.put(at + 4 * axis, &min[axis].to_le_bytes());
            self.bytes[at + 12 + axis] = (max[axis] - min[axis]) as u8;
        }
        self.bytes[at + 15] = if summary.bounds.is_some() { HAS_ACTIVE } else { NONE_ACTIVE };
        for (x, word) in leaf.active.iter().enumerate() {
            self.put(at + LEAF_MASK_AT + 8 * x, &word.to_le_bytes());
        }
        self.put_range(at + self.layout.leaf_minimum_at(), summary.range);
        let mut bytes = Vec::with_capacity(LEAF_VOXELS * self.layout.value());
        values.iter().for_each(|value| value.put(&mut bytes));
        self.put(at + self.layout.leaf_values_at(), &bytes);
        summary
    }

    fn put_root_entry<T: Stored>(&mut self, at: usize, origin: [i32; 3], child: i64, value: T, active: bool) {
        let [x, y, z] = origin.map(|index| u64::from(index as u32 >> 12));
        self.put(at, &(x << 42 | y << 21 | z).to_le_bytes());
        self.put(at + 8, &child.to_le_bytes());
        self.put(at + 16, &u32::from(active).to_le_bytes());
        self.put_value(at + self.layout.root_value_at(), value);
    }

    fn put_root<T: Stored>(&mut self, at: usize, entries: usize, background: T, summary: &Summary) {
        self.put_bounds(at, summary.bounds);
        self.put(at + 24, &(entries as u32).to_le_bytes());
        let background_at = at + self.layout.background_at();
        self.put_value(background_at, background);
        self.put_range(background_at + self.layout.value(), summary.range);
    }
}
