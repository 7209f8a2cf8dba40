//! From a sparse [`Tree`] to the dense box around its active voxels, for formats that are arrays.
//!
//! The box is put together and written in slabs of leaf thickness across the slowest axis. Inactive voxels inside it
//! have the value they have in the tree, the background where it has none.

use std::io::Write;

use crate::Tree;
use crate::element::AxisOrder;
use crate::fault::Fault;
use crate::float_tree::{Voxel, active_bounds};

/// Larger boxes are refused: a sparse grid is cheap in memory and ruinous as an array.
const LARGEST: u64 = 4 << 30;
/// Voxels along the edge of a leaf.
const EDGE: i64 = 8;

/// The box around the active voxels of a grid.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct DenseBox {
    /// Index coordinates of the least voxel.
    pub min: [i32; 3],
    /// Voxels along x, y, z.
    pub shape: [usize; 3],
}

impl DenseBox {
    /// The box of `tree`, if it has active voxels and the box as floats is small enough to write.
    pub(crate) fn of<T: Voxel>(tree: &Tree<T>) -> Result<Self, Fault> {
        let (mut min, mut end) = ([i64::MAX; 3], [i64::MIN; 3]);
        let mut grow = |from: [i64; 3], to: [i64; 3]| {
            for axis in 0..3 {
                min[axis] = min[axis].min(from[axis]);
                end[axis] = end[axis].max(to[axis]);
            }
        };
        for [least, greatest] in tree.leaves.iter().filter_map(active_bounds) {
            grow(least.map(i64::from), greatest.map(|index| i64::from(index) + 1));
        }
        for tile in tree.tiles.iter().filter(|tile| tile.active) {
            let from = tile.origin.map(i64::from);
            grow(from, from.map(|index| index + (1 << tile.log2_edge)));
        }
        if min[0] > end[0] {
            return Err(Fault::unsupported("a grid without active voxels has no array; write .vdb or .nvdb"));
        }
        let shape = [0, 1, 2].map(|axis| (end[axis] - min[axis]) as usize);
        let bytes =
            shape.iter().fold(4 * T::CHANNELS as u64, |bytes, &edge| bytes.saturating_mul(edge as u64));
        if bytes > LARGEST {
            let [x, y, z] = shape;
            return Err(Fault::Unsupported(format!(
                "the active box of {x} x {y} x {z} voxels is larger than 4 GiB as an array; write .vdb or .nvdb"
            )));
        }
        Ok(Self { min: min.map(|index| index as i32), shape })
    }

    /// Writes the voxels of the box as little-endian floats.
    pub(crate) fn write<T: Voxel>(
        &self,
        tree: &Tree<T>,
        order: AxisOrder,
        out: &mut dyn Write,
    ) -> Result<(), Fault> {
        let [nx, ny, nz] = self.shape;
        let (slow, strides) = match order {
            AxisOrder::XFastest => (2, [1, nx, nx * ny]),
            AxisOrder::ZFastest => (0, [nz * ny, nz, 1]),
        };
        let first_leaf = i64::from(self.min[slow]).div_euclid(EDGE);
        let end = i64::from(self.min[slow]) + self.shape[slow] as i64;
        let slabs = (end - first_leaf * EDGE).div_euclid(EDGE) + 1;
        let slab_of = |index: i64| (index.div_euclid(EDGE) - first_leaf).clamp(0, slabs - 1) as usize;
        let mut leaves_of = vec![Vec::new(); slabs as usize];
        let mut tiles_of = vec![Vec::new(); slabs as usize];
        for (n, leaf) in tree.leaves.iter().enumerate() {
            leaves_of[slab_of(leaf.origin[slow].into())].push(n);
        }
        for (n, tile) in tree.tiles.iter().enumerate() {
            let start = i64::from(tile.origin[slow]);
            for slab in &mut tiles_of[slab_of(start)..=slab_of(start + (1 << tile.log2_edge) - 1)] {
                slab.push(n);
            }
        }
        let (mut values, mut bytes) = (Vec::new(), Vec::new());
        for (number, (leaves, tiles)) in leaves_of.iter().zip(&tiles_of).enumerate() {
            let mut least = self.min.map(i64::from);
            let mut greatest = [0, 1, 2].map(|axis| least[axis] + self.shape[axis] as i64);
            let leaf_plane = (first_leaf + number as i64) * EDGE;
            least[slow] = least[slow].max(leaf_plane);
            greatest[slow] = greatest[slow].min(leaf_plane + EDGE);
            if least[slow] >= greatest[slow] {
                continue;
            }
            let slab = Slab { least, greatest, strides };
            values.clear();
            values.resize(strides[slow] * (greatest[slow] - least[slow]) as usize, tree.background);
            for &tile in tiles {
                let tile = &tree.tiles[tile];
                slab.fill(tile.origin, 1 << tile.log2_edge, |_| tile.value, &mut values);
            }
            for &leaf in leaves {
                let of_leaf = &tree.leaf_values[leaf * crate::LEAF_VOXELS..];
                slab.fill(
                    tree.leaves[leaf].origin,
                    EDGE,
                    |[x, y, z]| of_leaf[x << 6 | y << 3 | z],
                    &mut values,
                );
            }
            bytes.clear();
            values.iter().for_each(|value| value.put(&mut bytes));
            out.write_all(&bytes).map_err(Fault::Io)?;
        }
        Ok(())
    }
}

/// A part of the box: from `least` up to, but without, `greatest`.
struct Slab {
    least: [i64; 3],
    greatest: [i64; 3],
    strides: [usize; 3],
}

impl Slab {
    /// Sets the voxels of a cube that lie in the slab; `value` takes their place in the cube.
    fn fill<T>(&self, origin: [i32; 3], edge: i64, value: impl Fn([usize; 3]) -> T, values: &mut [T]) {
        let origin = origin.map(i64::from);
        let [xs, ys, zs] = [0, 1, 2].map(|axis| {
            let end = (origin[axis] + edge).min(self.greatest[axis]);
            origin[axis].max(self.least[axis])..end
        });
        let place = |axis: usize, index: i64| (index - self.least[axis]) as usize * self.strides[axis];
        for x in xs {
            for y in ys.clone() {
                let row = place(0, x) + place(1, y);
                for z in zs.clone() {
                    let inside = [x - origin[0], y - origin[1], z - origin[2]].map(|index| index as usize);
                    values[row + place(2, z)] = value(inside);
                }
            }
        }
    }
}
