//! From a file's tree to bricks under bounds.
//!
//! The table is refined only where a leaf (or a tile smaller than the cell) lies inside a cell or against its upper
//! sides, where the filter's footprint reaches. Every other cell sees at most whole tiles and the background.

use super::BrickGrid;
use super::bounds::{Bounds, Content, Entry, INDEX_LIMIT};
use super::filter::Filter;
use super::storage::{Bricks, Storage};
use crate::{Grid, GridValues, LEAF_VOXELS, Tree};
use glam::DVec3;
use rustc_hash::{FxHashMap, FxHashSet};
use tyndall_machine::memory::{self, MemoryError};

/// Why a grid cannot become bricks.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum BuildError {
    /// A vector grid has no scalar value.
    #[error("grid `{0}` holds vectors; a scalar grid is needed here, such as `density`")]
    NotScalar(String),
    /// The box of active voxels is too wide to be indexed.
    #[error(
        "grid `{0}` spreads over more than 2^30 voxels along an axis: it holds stray voxels far from the body"
    )]
    TooWide(String),
    /// More bricks than an entry can number.
    #[error("grid `{0}` has more than 2^30 leaves")]
    TooMany(String),
    /// There is no memory for them.
    #[error("grid `{0}`: {1}")]
    Memory(String, MemoryError),
}

/// What finding a leaf takes in the tables made while building, about.
const LEAF_LOOKUP_BYTES: usize = 256;

/// Voxel values that can be taken as scalars.
trait Scalar: Copy {
    fn scalar(self) -> f32;
}

impl Scalar for f32 {
    fn scalar(self) -> f32 {
        self
    }
}
impl Scalar for f64 {
    fn scalar(self) -> f32 {
        self as f32
    }
}
impl Scalar for i32 {
    fn scalar(self) -> f32 {
        self as f32
    }
}
impl Scalar for i64 {
    fn scalar(self) -> f32 {
        self as f32
    }
}
impl Scalar for bool {
    fn scalar(self) -> f32 {
        f32::from(u8::from(self))
    }
}

impl BrickGrid {
    /// Builds bricks from a scalar grid of any type (integers and booleans as numbers).
    pub fn new(grid: &Grid, storage: Storage) -> Result<BrickGrid, BuildError> {
        BrickGrid::mapped(grid, storage, |value| value)
    }

    /// Builds bricks from a scalar grid whose values are first passed through `map`.
    pub fn mapped(grid: &Grid, storage: Storage, map: impl Fn(f32) -> f32) -> Result<BrickGrid, BuildError> {
        let name = &grid.name;
        match &grid.values {
            GridValues::Float(tree) => build(tree, name, storage, map),
            GridValues::Double(tree) => build(tree, name, storage, map),
            GridValues::Int32(tree) => build(tree, name, storage, map),
            GridValues::Int64(tree) => build(tree, name, storage, map),
            GridValues::Bool(tree) | GridValues::Mask(tree) => build(tree, name, storage, map),
            GridValues::Vec3(_) => Err(BuildError::NotScalar(name.clone())),
        }
    }

    /// Builds bricks from a tree; `name` is for messages.
    pub fn from_tree(tree: &Tree<f32>, name: &str, storage: Storage) -> Result<BrickGrid, BuildError> {
        build(tree, name, storage, |value| value)
    }
}

fn build<T: Scalar>(
    tree: &Tree<T>,
    name: &str,
    storage: Storage,
    map: impl Fn(f32) -> f32,
) -> Result<BrickGrid, BuildError> {
    let mut non_finite = 0;
    let mut finite = |value: T| {
        let value = map(value.scalar());
        if value.is_finite() {
            value
        } else {
            non_finite += 1;
            0.0
        }
    };
    if tree.leaves.len() >= INDEX_LIMIT {
        return Err(BuildError::TooMany(name.to_string()));
    }
    let background = finite(tree.background);

    let mut range = Bounds::EMPTY;
    for &value in &tree.leaf_values {
        let value = map(value.scalar());
        if value.is_finite() {
            range = range.union(Bounds::of(value));
        }
    }
    let brick_bytes = storage.brick_bytes();
    memory::ask_for(tree.leaves.len(), brick_bytes + LEAF_LOOKUP_BYTES, || {
        format!(
            "{} bricks of 512 voxels of {} bytes and where they are",
            tree.leaves.len(),
            brick_bytes / LEAF_VOXELS
        )
    })
    .map_err(|error| BuildError::Memory(name.to_owned(), error))?;
    let mut bricks = Bricks::new(storage, tree.leaves.len(), range);
    let mut sources = Sources::new(background);
    for (leaf, values) in tree.leaves.iter().zip(tree.leaf_values.chunks_exact(LEAF_VOXELS)) {
        let mut brick = [0.0; LEAF_VOXELS];
        for (to, &from) in brick.iter_mut().zip(values) {
            *to = finite(from);
        }
        let source = if brick.iter().all(|&v| v == brick[0]) {
            Source::Constant(brick[0])
        } else {
            bricks.push(&brick);
            Source::Brick((bricks.count() - 1) as u32)
        };
        sources.leaves.insert(leaf.origin.map(|x| x >> 3), source);
    }
    bricks.shrink_to_fit();
    for tile in &tree.tiles {
        sources.insert_tile(tile.origin, tile.log2_edge, finite(tile.value));
    }

    let active = active_box(tree);
    let margin = Filter::Trilinear.margin(background);
    let domain = match active {
        Some([low, high]) => {
            [low.map(|x| x as f64 - margin), high.map(|x| x as f64 + margin)].map(DVec3::from_array)
        }
        None => [DVec3::ZERO, DVec3::ZERO],
    };
    let [low, high] = active.unwrap_or([[0; 3], [0; 3]]);
    let Table { origin, dimensions, shift } =
        Table::around(low, high).ok_or_else(|| BuildError::TooWide(name.to_string()))?;

    let mut table = TableBuilder {
        refine: sources.cells_to_refine(shift),
        sources,
        bricks: &bricks,
        entries: vec![
            Entry::new(Content::Constant(0), Bounds::of(background));
            dimensions.iter().product::<u32>() as usize
        ],
        constants: Constants::default(),
    };
    table.constants.index(background);
    let mut bounds = Bounds::EMPTY;
    for index in 0..table.entries.len() {
        let z = index as u32 % dimensions[2];
        let y = index as u32 / dimensions[2] % dimensions[1];
        let x = index as u32 / dimensions[2] / dimensions[1];
        let along = |axis: usize, i: u32| (origin[axis] >> shift) + i as i32;
        let entry = table.cell([along(0, x), along(1, y), along(2, z)], shift);
        table.entries[index] = entry;
        bounds = bounds.union(entry.bounds());
    }
    if active.is_none() {
        bounds = Bounds::of(background);
    }
    let (entries, constants) = (table.entries, table.constants.values);
    Ok(BrickGrid {
        origin,
        top_dimensions: dimensions,
        top_shift: shift,
        entries,
        constants,
        bricks,
        filter: Filter::Trilinear,
        domain,
        background,
        bounds,
        non_finite,
    })
}

/// Least and greatest active voxel.
fn active_box<T>(tree: &Tree<T>) -> Option<[[i64; 3]; 2]> {
    let mut corners: Option<[[i64; 3]; 2]> = None;
    let mut include = |low: [i64; 3], high: [i64; 3]| {
        let [old_low, old_high] = corners.unwrap_or([low, high]);
        corners = Some([
            std::array::from_fn(|a| old_low[a].min(low[a])),
            std::array::from_fn(|a| old_high[a].max(high[a])),
        ]);
    };
    for tile in tree.tiles.iter().filter(|tile| tile.active) {
        let low = tile.origin.map(i64::from);
        include(low, low.map(|x| x + (1_i64 << tile.log2_edge) - 1));
    }
    for leaf in &tree.leaves {
        for (x, word) in leaf.active.iter().enumerate().filter(|(_, word)| **word != 0) {
            let mut rows = (0..8).filter(|y| (word >> (8 * y)) & 0xff != 0);
            let columns = (0..8).fold(0, |all, y| all | (word >> (8 * y)) & 0xff) as u8;
            let first_row = rows.next().unwrap_or(0);
            let last_row = rows.next_back().unwrap_or(first_row);
            let corner = leaf.origin.map(i64::from);
            let x = corner[0] + x as i64;
            include(
                [x, corner[1] + first_row, corner[2] + i64::from(columns.trailing_zeros())],
                [x, corner[1] + last_row, corner[2] + 7 - i64::from(columns.leading_zeros())],
            );
        }
    }
    corners
}

/// The dense table of top cells.
struct Table {
    origin: [i32; 3],
    dimensions: [u32; 3],
    shift: u32,
}

impl Table {
    /// Most top cells before they are made larger: 2 MiB of entries.
    const MOST_CELLS: i128 = 1 << 18;

    /// The finest table that covers the active voxels `low..=high` and what a filtered lookup inside the domain,
    /// rounding included, may touch around them: two voxels more on each side.
    fn around(low: [i64; 3], high: [i64; 3]) -> Option<Table> {
        let mut shift = 5;
        loop {
            let first = low.map(|x| (x - 2) >> shift);
            let count: [i64; 3] = std::array::from_fn(|a| ((high[a] + 2) >> shift) - first[a] + 1);
            if count.iter().map(|&n| i128::from(n)).product::<i128>() <= Self::MOST_CELLS {
                let fits =
                    (0..3).all(|a| i32::try_from(first[a] << shift).is_ok() && count[a] << shift <= 1 << 31);
                return fits.then(|| Table {
                    origin: first.map(|x| (x << shift) as i32),
                    dimensions: count.map(|n| n as u32),
                    shift,
                });
            }
            shift += 2;
            if shift > 29 {
                return None;
            }
        }
    }
}

/// What an 8³ block of the tree is.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Source {
    Constant(f32),
    Brick(u32),
}

/// The tree, to be asked what is in an 8³ block.
struct Sources {
    background: f32,
    /// Leaves and 8³ tiles by block coordinates (voxel >> 3).
    leaves: FxHashMap<[i32; 3], Source>,
    /// Larger tiles: (log2 of the edge, values by voxel >> log2), smaller edges first.
    tiles: Vec<(u32, FxHashMap<[i32; 3], f32>)>,
}

impl Sources {
    fn new(background: f32) -> Sources {
        Sources { background, leaves: FxHashMap::default(), tiles: Vec::new() }
    }

    fn insert_tile(&mut self, origin: [i32; 3], log2_edge: u32, value: f32) {
        let key = origin.map(|x| x >> log2_edge);
        if log2_edge <= 3 {
            self.leaves.entry(key).or_insert(Source::Constant(value));
            return;
        }
        let place = match self.tiles.binary_search_by_key(&log2_edge, |(edge, _)| *edge) {
            Ok(place) => place,
            Err(place) => {
                self.tiles.insert(place, (log2_edge, FxHashMap::default()));
                place
            }
        };
        self.tiles[place].1.insert(key, value);
    }

    /// What the block at block coordinates `block` is.
    fn at(&self, block: [i32; 3]) -> Source {
        if let Some(&source) = self.leaves.get(&block) {
            return source;
        }
        for (log2_edge, values) in &self.tiles {
            if let Some(&value) = values.get(&block.map(|x| x >> (log2_edge - 3))) {
                return Source::Constant(value);
            }
        }
        Source::Constant(self.background)
    }

    /// For each level of cells up to `top_shift` (index 0: 8³ cells, 1: 32³, …), the cells that hold more than one
    /// value in themselves or against their upper sides.
    fn cells_to_refine(&self, top_shift: u32) -> Vec<FxHashSet<[i32; 3]>> {
        let levels = (top_shift as usize - 3) / 2 + 1;
        let mut refine = vec![FxHashSet::default(); levels];
        let mut mark = |corner: [i32; 3], log2_edge: u32| {
            for (level, cells) in refine.iter_mut().enumerate() {
                let shift = 3 + 2 * level as u32;
                if log2_edge >= shift && log2_edge > 3 {
                    continue;
                }
                for neighbour in 0..8 {
                    let back = [neighbour >> 2, neighbour >> 1 & 1, neighbour & 1];
                    // The voxel layer just below the corner belongs to cells whose footprint reaches inside.
                    let touched = |a: usize| (corner[a].wrapping_sub(back[a])) >> shift;
                    cells.insert([touched(0), touched(1), touched(2)]);
                }
            }
        };
        for block in self.leaves.keys() {
            mark(block.map(|x| x << 3), 3);
        }
        for (log2_edge, tiles) in &self.tiles {
            for key in tiles.keys() {
                mark(key.map(|x| x << log2_edge), *log2_edge);
            }
        }
        refine
    }
}

/// Values of constant cells, each kept once.
#[derive(Default)]
struct Constants {
    values: Vec<f32>,
    known: FxHashMap<u32, u32>,
}

impl Constants {
    fn index(&mut self, value: f32) -> u32 {
        let next = self.values.len() as u32;
        let index = *self.known.entry(value.to_bits()).or_insert(next);
        if index == next {
            self.values.push(value);
        }
        index
    }
}

struct TableBuilder<'a> {
    sources: Sources,
    refine: Vec<FxHashSet<[i32; 3]>>,
    bricks: &'a Bricks,
    entries: Vec<Entry>,
    constants: Constants,
}

impl TableBuilder<'_> {
    /// The entry of the cell at cell coordinates `cell` (voxel >> shift), with the nodes below it.
    fn cell(&mut self, cell: [i32; 3], shift: u32) -> Entry {
        let refined = self.refine[(shift as usize - 3) / 2].contains(&cell);
        if !refined || shift == 3 {
            return self.leaf_cell(cell, shift, refined);
        }
        let children: Vec<Entry> = (0..64)
            .map(|i| [i >> 4, i >> 2 & 3, i & 3])
            .map(|child| self.cell(std::array::from_fn(|a| (cell[a] << 2) + child[a]), shift - 2))
            .collect();
        let bounds = children.iter().fold(Bounds::EMPTY, |all, child| all.union(child.bounds()));
        let first = self.entries.len() as u32;
        self.entries.extend(children);
        Entry::new(Content::Node(first), bounds)
    }

    /// A cell without cells below it: a constant or a brick. Its footprint overlaps eight cells of its size; unless
    /// it is `refined`, each of those is one value.
    fn leaf_cell(&mut self, cell: [i32; 3], shift: u32, refined: bool) -> Entry {
        let around: [Source; 8] = std::array::from_fn(|i| {
            let step = [i >> 2, i >> 1 & 1, i & 1];
            self.sources.at(std::array::from_fn(|a| (cell[a].wrapping_add(step[a] as i32)) << (shift - 3)))
        });
        let bounds = if refined { self.footprint_bounds(&around) } else { bounds_of_constants(&around) };
        let content = match around[0] {
            Source::Constant(value) => Content::Constant(self.constants.index(value)),
            Source::Brick(brick) => Content::Brick(brick),
        };
        Entry::new(content, bounds)
    }

    /// Bounds over the 9³ voxels that the filtered values of an 8³ cell are mixtures of; `around[4x + 2y + z]` is
    /// the block one step up along the marked axes.
    fn footprint_bounds(&self, around: &[Source; 8]) -> Bounds {
        let mut bounds = Bounds::EMPTY;
        for (i, source) in around.iter().enumerate() {
            let span = |axis: usize| if i >> (2 - axis) & 1 == 1 { 1 } else { 8 };
            match *source {
                Source::Constant(value) => bounds = bounds.union(Bounds::of(value)),
                Source::Brick(brick) => {
                    for x in 0..span(0) {
                        for y in 0..span(1) {
                            for z in 0..span(2) {
                                let value = self.bricks.value(brick, x << 6 | y << 3 | z);
                                bounds = bounds.union(Bounds::of(value));
                            }
                        }
                    }
                }
            }
        }
        bounds
    }
}

fn bounds_of_constants(around: &[Source; 8]) -> Bounds {
    around.iter().fold(Bounds::EMPTY, |all, source| match source {
        Source::Constant(value) => all.union(Bounds::of(*value)),
        Source::Brick(_) => all,
    })
}
