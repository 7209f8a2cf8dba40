//! What the tests ask of a tree, and where the shared volumes are.

use std::path::PathBuf;

use tyndall_volumes::{GridValues, LEAF_VOXELS, Tree};

/// Sums over the active voxels of a tree.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Facts {
    pub active: u64,
    pub sum: f64,
    pub min: f64,
    pub max: f64,
    pub bounds: [[i32; 3]; 2],
}

/// [`Facts`] of `tree`, its values turned into numbers by `number`.
pub fn facts<T: Copy>(tree: &Tree<T>, number: impl Fn(T) -> f64) -> Facts {
    assert_eq!(tree.leaf_values.len(), tree.leaves.len() * LEAF_VOXELS);
    let mut facts = Facts {
        active: 0,
        sum: 0.0,
        min: f64::INFINITY,
        max: f64::NEG_INFINITY,
        bounds: [[i32::MAX; 3], [i32::MIN; 3]],
    };
    let mut add = |origin: [i32; 3], edge: i32, value: f64| {
        let voxels = (edge as u64).pow(3);
        facts.active += voxels;
        facts.sum += voxels as f64 * value;
        facts.min = facts.min.min(value);
        facts.max = facts.max.max(value);
        for axis in 0..3 {
            facts.bounds[0][axis] = facts.bounds[0][axis].min(origin[axis]);
            facts.bounds[1][axis] = facts.bounds[1][axis].max(origin[axis] + edge - 1);
        }
    };
    for tile in tree.tiles.iter().filter(|tile| tile.active) {
        add(tile.origin, 1 << tile.log2_edge, number(tile.value));
    }
    for (leaf, values) in tree.leaves.iter().zip(tree.leaf_values.chunks_exact(LEAF_VOXELS)) {
        for (n, &value) in values.iter().enumerate() {
            if leaf.active[n >> 6] >> (n & 63) & 1 == 1 {
                let offset = [n >> 6, n >> 3 & 7, n & 7];
                add([0, 1, 2].map(|axis| leaf.origin[axis] + offset[axis] as i32), 1, number(value));
            }
        }
    }
    facts
}

/// [`Facts`] of a scalar grid.
pub fn scalar_facts(values: &GridValues) -> Facts {
    match values {
        GridValues::Float(tree) => facts(tree, f64::from),
        GridValues::Double(tree) => facts(tree, |value| value),
        GridValues::Int32(tree) => facts(tree, f64::from),
        GridValues::Int64(tree) => facts(tree, |value| value as f64),
        GridValues::Bool(tree) | GridValues::Mask(tree) => facts(tree, |value| f64::from(u8::from(value))),
        GridValues::Vec3(_) => panic!("not a scalar grid"),
    }
}

/// The value and state at a voxel.
pub fn probe<T: Copy>(tree: &Tree<T>, at: [i32; 3]) -> (T, bool) {
    let inside =
        |origin: [i32; 3], edge: i32| (0..3).all(|axis| (0..edge).contains(&(at[axis] - origin[axis])));
    for (leaf, values) in tree.leaves.iter().zip(tree.leaf_values.chunks_exact(LEAF_VOXELS)) {
        if inside(leaf.origin, 8) {
            let [x, y, z] = [0, 1, 2].map(|axis| (at[axis] - leaf.origin[axis]) as usize);
            return (values[x << 6 | y << 3 | z], leaf.active[x] >> (y << 3 | z) & 1 == 1);
        }
    }
    tree.tiles
        .iter()
        .find(|tile| inside(tile.origin, 1 << tile.log2_edge))
        .map_or((tree.background, false), |tile| (tile.value, tile.active))
}

/// A file of the shared folder, or `None` (said on stderr) if the folder is absent.
pub fn shared(name: &str) -> Option<PathBuf> {
    let path = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../../../shared").join(name);
    if path.exists() {
        return Some(path);
    }
    eprintln!("skipped: {} is not there", path.display());
    None
}
