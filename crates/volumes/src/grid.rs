//! A grid as a file has it: a sparse tree of 8³ leaves and constant tiles over a background.
//!
//! This is the common result of every reader. It keeps what OpenVDB's tree says (Museth 2013, "VDB:
//! High-Resolution Sparse Volumes with Dynamic Topology"), flattened: which inner node a leaf hung from does not
//! matter once its origin is known.

use glam::DAffine3;

/// Edge of a leaf in voxels.
pub const LEAF_EDGE: i32 = 8;
/// Voxels in a leaf.
pub const LEAF_VOXELS: usize = 512;

/// One named grid of a volume file.
#[derive(Debug, Clone)]
pub struct Grid {
    /// Name as the user sees it, without the suffix OpenVDB adds to duplicates.
    pub name: String,
    /// What the values mean.
    pub class: GridClass,
    /// Index space to world space; integer index coordinates are voxel centres.
    pub index_to_world: DAffine3,
    /// Whether the file stores floating-point values as 16-bit halves.
    pub saved_as_half: bool,
    /// How the file compresses the values, for people: `none`, `zip`, `blosc`, `active mask + zip`, …
    pub codec: String,
    /// Further metadata of the grid, as text, in file order.
    pub metadata: Vec<(String, String)>,
    /// The values.
    pub values: GridValues,
}

/// What the values of a grid mean, as the file says.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum GridClass {
    /// Nothing is said.
    Unknown,
    /// A density: background 0, values inside.
    FogVolume,
    /// A signed distance, truncated at the background value.
    LevelSet,
    /// A staggered vector field.
    Staggered,
}

/// The tree of a grid, by the type of its values.
#[derive(Debug, Clone)]
pub enum GridValues {
    /// 32-bit floats (16-bit halves in the file become these, exactly).
    Float(Tree<f32>),
    /// 64-bit floats.
    Double(Tree<f64>),
    /// Vectors of three 32-bit floats.
    Vec3(Tree<[f32; 3]>),
    /// 32-bit integers.
    Int32(Tree<i32>),
    /// 64-bit integers.
    Int64(Tree<i64>),
    /// Booleans.
    Bool(Tree<bool>),
    /// Topology only: a voxel's value is whether it is active.
    Mask(Tree<bool>),
}

impl GridValues {
    /// Memory of its tree, bytes.
    pub fn memory_bytes(&self) -> usize {
        match self {
            Self::Float(tree) => tree.memory_bytes(),
            Self::Double(tree) => tree.memory_bytes(),
            Self::Vec3(tree) => tree.memory_bytes(),
            Self::Int32(tree) => tree.memory_bytes(),
            Self::Int64(tree) => tree.memory_bytes(),
            Self::Bool(tree) | Self::Mask(tree) => tree.memory_bytes(),
        }
    }
}

/// A sparse tree, flattened.
///
/// Every voxel belongs to at most one leaf or tile; where there is neither it has the background value and is
/// inactive. Leaves and tiles stand in no promised order.
#[derive(Debug, Clone, PartialEq)]
pub struct Tree<T> {
    /// Value of every voxel outside leaves and tiles.
    pub background: T,
    /// Constant cubes, active or not (inactive ones are kept only where they differ from the background).
    pub tiles: Vec<Tile<T>>,
    /// Origin and active mask of each 8³ leaf.
    pub leaves: Vec<Leaf>,
    /// 512 values a leaf, in the order of `leaves`; voxel (x, y, z) of a leaf stands at `x << 6 | y << 3 | z`.
    pub leaf_values: Vec<T>,
}

impl<T> Tree<T> {
    /// Memory of tiles, leaves and values, bytes.
    pub fn memory_bytes(&self) -> usize {
        size_of_val(&*self.tiles) + size_of_val(&*self.leaves) + size_of_val(&*self.leaf_values)
    }
}

/// Where a leaf is and which of its voxels are active.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Leaf {
    /// Index coordinates of the least corner; multiples of 8.
    pub origin: [i32; 3],
    /// Bit `z` of byte `y` of word `x` (little endian: bit `y << 3 | z` of word `x`) is voxel (x, y, z).
    pub active: [u64; 8],
}

/// A cube of one value.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Tile<T> {
    /// Index coordinates of the least corner; multiples of the edge.
    pub origin: [i32; 3],
    /// Base-2 logarithm of the edge in voxels: 3, 7 or 12 in files of the standard tree.
    pub log2_edge: u32,
    /// The value everywhere inside.
    pub value: T,
    /// Whether its voxels are active.
    pub active: bool,
}

impl Grid {
    /// Component 0, 1 or 2 of a grid of vectors as a grid of its own; `None` if the values are no vectors.
    pub fn component(&self, axis: usize) -> Option<Grid> {
        let GridValues::Vec3(vectors) = &self.values else { return None };
        let tile = |tile: &Tile<[f32; 3]>| Tile {
            origin: tile.origin,
            log2_edge: tile.log2_edge,
            value: tile.value[axis],
            active: tile.active,
        };
        let values = GridValues::Float(Tree {
            background: vectors.background[axis],
            tiles: vectors.tiles.iter().map(tile).collect(),
            leaves: vectors.leaves.clone(),
            leaf_values: vectors.leaf_values.iter().map(|value| value[axis]).collect(),
        });
        Some(Grid {
            name: self.name.clone(),
            class: self.class,
            index_to_world: self.index_to_world,
            saved_as_half: self.saved_as_half,
            codec: self.codec.clone(),
            metadata: self.metadata.clone(),
            values,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_components_of_vectors_are_grids_in_the_same_place() {
        let leaf = Leaf { origin: [8, 0, -8], active: [3; 8] };
        let tile = Tile { origin: [0, 0, 0], log2_edge: 3, value: [4.0, 5.0, 6.0], active: true };
        let tree = Tree {
            background: [1.0, 2.0, 3.0],
            tiles: vec![tile],
            leaves: vec![leaf],
            leaf_values: (0..LEAF_VOXELS).map(|i| [i as f32, 0.5, -(i as f32)]).collect(),
        };
        let grid = Grid {
            name: "Cd".into(),
            class: GridClass::Unknown,
            index_to_world: DAffine3::from_scale(glam::DVec3::splat(0.5)),
            saved_as_half: false,
            codec: "none".into(),
            metadata: Vec::new(),
            values: GridValues::Vec3(tree),
        };
        let last = grid.component(2).expect("vectors have components");
        assert_eq!((last.name.as_str(), last.index_to_world), ("Cd", grid.index_to_world));
        let GridValues::Float(tree) = &last.values else { panic!("{last:?}") };
        assert_eq!((tree.background, tree.tiles[0].value, tree.leaves[0]), (3.0, 6.0, leaf));
        assert_eq!((tree.leaf_values[7], tree.leaf_values.len()), (-7.0, LEAF_VOXELS));
        assert!(last.component(0).is_none());
    }
}
