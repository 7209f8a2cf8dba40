//! Where what a scene names as files comes from: a folder, or grids in memory that have names as files have.
//!
//! A description stays plain text also if a program made the grids of its volumes: `file = "<volume 1>"` then names one of
//! [`SceneFiles`], and the scene's hash holds its content as it would hold a file's.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::{Arc, OnceLock};

use glam::DAffine3;
use sha2::{Digest, Sha256};
use tyndall_volumes::{Grid, GridValues, LEAF_VOXELS, Tree};

use crate::hash::SceneHash;

/// What the file names of a description stand for.
#[derive(Debug, Clone, Default)]
pub struct SceneFiles {
    /// The folder that names are relative to.
    pub folder: PathBuf,
    /// Names that stand for grids in memory, and not for files.
    pub grids: BTreeMap<String, MemoryGrid>,
}

impl SceneFiles {
    /// Files of a folder only.
    pub fn in_folder(folder: &Path) -> Self {
        Self { folder: folder.to_owned(), grids: BTreeMap::new() }
    }
}

/// A grid in memory that stands for a volume file. Clones share the voxels.
#[derive(Debug, Clone)]
pub struct MemoryGrid {
    grid: Arc<Grid>,
    scale: f64,
    content: Arc<OnceLock<SceneHash>>,
}

impl MemoryGrid {
    /// A grid whose world space is in scene units.
    pub fn new(grid: Grid) -> Self {
        Self { grid: Arc::new(grid), scale: 1.0, content: Arc::default() }
    }

    /// The same voxels in a world `scale` times as large as before.
    pub fn scaled(&self, scale: f64) -> Self {
        Self { scale: self.scale * scale, ..self.clone() }
    }

    /// The grid.
    pub fn grid(&self) -> &Arc<Grid> {
        &self.grid
    }

    /// Whether both are clones of one, at one scale.
    pub fn is_same(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.grid, &other.grid) && self.scale == other.scale
    }

    /// From the grid's own world space, to which its `index_to_world` leads, to that of the scene.
    pub fn place(&self) -> DAffine3 {
        DAffine3::from_scale(glam::DVec3::splat(self.scale))
    }

    /// Hash of all that a volume has from the grid.
    pub fn hash(&self) -> SceneHash {
        let content = *self.content.get_or_init(|| SceneHash::of(hash_of_values(&self.grid)));
        let mut hasher = Sha256::new().chain_update(content.0);
        let to_scene = self.place() * self.grid.index_to_world;
        to_scene.to_cols_array().iter().for_each(|number| hasher.update(number.to_le_bytes()));
        SceneHash::of(hasher)
    }
}

/// The name of the grid is left out, as it is only for messages.
fn hash_of_values(grid: &Grid) -> Sha256 {
    let mut hasher = Sha256::new();
    hasher.update([grid.class as u8]);
    match &grid.values {
        GridValues::Float(tree) => hash_tree(&mut hasher, 0, tree, |value| value.to_le_bytes()),
        GridValues::Double(tree) => hash_tree(&mut hasher, 1, tree, |value| value.to_le_bytes()),
        GridValues::Vec3(tree) => hash_tree(&mut hasher, 2, tree, |[x, y, z]| {
            let [x, y, z] = [x, y, z].map(|value| value.to_le_bytes());
            [x[0], x[1], x[2], x[3], y[0], y[1], y[2], y[3], z[0], z[1], z[2], z[3]]
        }),
        GridValues::Int32(tree) => hash_tree(&mut hasher, 3, tree, |value| value.to_le_bytes()),
        GridValues::Int64(tree) => hash_tree(&mut hasher, 4, tree, |value| value.to_le_bytes()),
        GridValues::Bool(tree) => hash_tree(&mut hasher, 5, tree, |value| [u8::from(value)]),
        GridValues::Mask(tree) => hash_tree(&mut hasher, 6, tree, |value| [u8::from(value)]),
    }
    hasher
}

/// By place, as leaves and tiles stand in no promised order.
fn hash_tree<T: Copy, const N: usize>(
    hasher: &mut Sha256,
    kind: u8,
    tree: &Tree<T>,
    bytes: impl Fn(T) -> [u8; N],
) {
    hasher.update([kind]);
    hasher.update(bytes(tree.background));
    let mut tiles: Vec<_> = tree.tiles.iter().collect();
    tiles.sort_unstable_by_key(|tile| (tile.origin, tile.log2_edge));
    for tile in tiles {
        tile.origin.iter().for_each(|index| hasher.update(index.to_le_bytes()));
        hasher.update([tile.log2_edge as u8, u8::from(tile.active)]);
        hasher.update(bytes(tile.value));
    }
    hasher.update([u8::MAX]);
    let mut order: Vec<usize> = (0..tree.leaves.len()).collect();
    order.sort_unstable_by_key(|&number| tree.leaves[number].origin);
    let mut block = Vec::with_capacity(N * LEAF_VOXELS);
    for number in order {
        let leaf = &tree.leaves[number];
        leaf.origin.iter().for_each(|index| hasher.update(index.to_le_bytes()));
        leaf.active.iter().for_each(|word| hasher.update(word.to_le_bytes()));
        block.clear();
        let values = &tree.leaf_values[number * LEAF_VOXELS..][..LEAF_VOXELS];
        values.iter().for_each(|value| block.extend_from_slice(&bytes(*value)));
        hasher.update(&block);
    }
}
