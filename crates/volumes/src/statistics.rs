//! What a grid holds, in numbers: how many active voxels, their least and greatest value, their sum, their box.
//!
//! An active tile counts as its voxels. Sums are of f64, leaf by leaf, so that millions of voxels lose no more than
//! the last digits.

use crate::{GridValues, LEAF_VOXELS, Leaf, Tile, Tree};

/// A type of voxel values, seen as one or more numbers.
pub trait Components: Copy {
    /// Numbers of a value: 3 for vectors, else 1.
    const COUNT: usize;
    /// Component `index` as f64 (integers beyond 2^53 are rounded); false is 0, true is 1.
    fn component(self, index: usize) -> f64;
}

macro_rules! scalar {
    ($($scalar:ty),*) => {$(
        impl Components for $scalar {
            const COUNT: usize = 1;
            fn component(self, _: usize) -> f64 {
                self as f64
            }
        }
    )*};
}
scalar!(f32, f64, i32, i64);

impl Components for bool {
    const COUNT: usize = 1;
    fn component(self, _: usize) -> f64 {
        f64::from(u8::from(self))
    }
}

impl Components for [f32; 3] {
    const COUNT: usize = 3;
    fn component(self, index: usize) -> f64 {
        f64::from(self[index])
    }
}

/// Statistics over the active voxels of a grid.
#[derive(Debug, Clone, PartialEq)]
pub struct GridStatistics {
    /// Active voxels, those of tiles included.
    pub active_voxels: u64,
    /// Active tiles.
    pub active_tiles: u64,
    /// Least finite value of each component; +∞ where there is none.
    pub min: Vec<f64>,
    /// Greatest finite value of each component; -∞ where there is none.
    pub max: Vec<f64>,
    /// Sum of the finite values of each component.
    pub sum: Vec<f64>,
    /// Components of active voxels that are infinite or not a number.
    pub non_finite: u64,
    /// Least and greatest index coordinates of active voxels, both included; nothing without active voxels.
    pub active_bbox: Option<[[i32; 3]; 2]>,
}

impl GridValues {
    /// Statistics over the active voxels.
    pub fn statistics(&self) -> GridStatistics {
        match self {
            Self::Float(tree) => tree.statistics(),
            Self::Double(tree) => tree.statistics(),
            Self::Vec3(tree) => tree.statistics(),
            Self::Int32(tree) => tree.statistics(),
            Self::Int64(tree) => tree.statistics(),
            Self::Bool(tree) | Self::Mask(tree) => tree.statistics(),
        }
    }

    /// The components of the background value.
    pub fn background(&self) -> Vec<f64> {
        match self {
            Self::Float(tree) => components(tree.background),
            Self::Double(tree) => components(tree.background),
            Self::Vec3(tree) => components(tree.background),
            Self::Int32(tree) => components(tree.background),
            Self::Int64(tree) => components(tree.background),
            Self::Bool(tree) | Self::Mask(tree) => components(tree.background),
        }
    }
}

/// All components of a value.
pub(crate) fn components<T: Components>(value: T) -> Vec<f64> {
    (0..T::COUNT).map(|index| value.component(index)).collect()
}

impl<T: Components> Tree<T> {
    /// Statistics over the active voxels.
    pub fn statistics(&self) -> GridStatistics {
        let mut total = Accumulator::new(T::COUNT);
        for tile in self.tiles.iter().filter(|tile| tile.active) {
            total.add_tile(tile);
        }
        for (leaf, values) in self.leaves.iter().zip(self.leaf_values.chunks_exact(LEAF_VOXELS)) {
            total.add_leaf(leaf, values);
        }
        total.statistics
    }
}

struct Accumulator {
    statistics: GridStatistics,
}

impl Accumulator {
    fn new(components: usize) -> Self {
        Self {
            statistics: GridStatistics {
                active_voxels: 0,
                active_tiles: 0,
                min: vec![f64::INFINITY; components],
                max: vec![f64::NEG_INFINITY; components],
                sum: vec![0.0; components],
                non_finite: 0,
                active_bbox: None,
            },
        }
    }

    fn add_tile<T: Components>(&mut self, tile: &Tile<T>) {
        let voxels = 1u64.checked_shl(3 * tile.log2_edge).unwrap_or(u64::MAX);
        let statistics = &mut self.statistics;
        statistics.active_tiles += 1;
        statistics.active_voxels = statistics.active_voxels.saturating_add(voxels);
        for index in 0..T::COUNT {
            let value = tile.value.component(index);
            if value.is_finite() {
                self.add_finite(index, value, value, value * voxels as f64);
            } else {
                self.statistics.non_finite = self.statistics.non_finite.saturating_add(voxels);
            }
        }
        let last =
            tile.origin.map(|least| least.saturating_add(((1i64 << tile.log2_edge.min(31)) - 1) as i32));
        self.add_box(tile.origin, last);
    }

    fn add_leaf<T: Components>(&mut self, leaf: &Leaf, values: &[T]) {
        for index in 0..T::COUNT {
            let (mut min, mut max, mut sum) = (f64::INFINITY, f64::NEG_INFINITY, 0.0);
            for (&word, values) in leaf.active.iter().zip(values.chunks_exact(64)) {
                let mut left = word;
                while left != 0 {
                    let value = values[left.trailing_zeros() as usize].component(index);
                    left &= left - 1;
                    if value.is_finite() {
                        min = min.min(value);
                        max = max.max(value);
                        sum += value;
                    } else {
                        self.statistics.non_finite += 1;
                    }
                }
            }
            self.add_finite(index, min, max, sum);
        }
        self.statistics.active_voxels +=
            leaf.active.iter().map(|word| u64::from(word.count_ones())).sum::<u64>();
        if let Some([first, last]) = extent(&leaf.active) {
            let corner = |offset: [i32; 3]| [0, 1, 2].map(|axis| leaf.origin[axis] + offset[axis]);
            self.add_box(corner(first), corner(last));
        }
    }

    fn add_finite(&mut self, index: usize, min: f64, max: f64, sum: f64) {
        let statistics = &mut self.statistics;
        statistics.min[index] = statistics.min[index].min(min);
        statistics.max[index] = statistics.max[index].max(max);
        statistics.sum[index] += sum;
    }

    fn add_box(&mut self, first: [i32; 3], last: [i32; 3]) {
        let [least, greatest] = self.statistics.active_bbox.get_or_insert([first, last]);
        for axis in 0..3 {
            least[axis] = least[axis].min(first[axis]);
            greatest[axis] = greatest[axis].max(last[axis]);
        }
    }
}

/// First and last active voxel of a leaf along each axis.
fn extent(active: &[u64; 8]) -> Option<[[i32; 3]; 2]> {
    let first_x = active.iter().position(|&word| word != 0)?;
    let last_x = active.iter().rposition(|&word| word != 0)?;
    let rows = active.iter().fold(0, |rows, word| rows | word).to_le_bytes();
    let first_y = rows.iter().position(|&row| row != 0)?;
    let last_y = rows.iter().rposition(|&row| row != 0)?;
    let columns = rows.iter().fold(0, |columns, row| columns | row);
    let (first_z, last_z) = (columns.trailing_zeros(), 7 - columns.leading_zeros());
    Some([[first_x as i32, first_y as i32, first_z as i32], [last_x as i32, last_y as i32, last_z as i32]])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_tile_counts_as_its_voxels_and_what_is_not_finite_is_counted_apart() {
        let mut leaf_values = vec![0.0f32; LEAF_VOXELS];
        leaf_values[2 << 6 | 3 << 3 | 4] = -7.0;
        leaf_values[5 << 6 | 6 << 3 | 1] = f32::NAN;
        let mut active = [0; 8];
        active[2] = 1 << (3 << 3 | 4);
        active[5] = 1 << (6 << 3 | 1);
        let tree = Tree {
            background: 0.0,
            tiles: vec![
                Tile { origin: [-128, 0, 0], log2_edge: 7, value: 0.5, active: true },
                Tile { origin: [4096, 0, 0], log2_edge: 12, value: 9.0, active: false },
            ],
            leaves: vec![Leaf { origin: [8, 16, 24], active }],
            leaf_values,
        };
        let statistics = GridValues::Float(tree).statistics();
        assert_eq!(
            statistics,
            GridStatistics {
                active_voxels: (1 << 21) + 2,
                active_tiles: 1,
                min: vec![-7.0],
                max: vec![0.5],
                sum: vec![f64::from(1 << 20) - 7.0],
                non_finite: 1,
                active_bbox: Some([[-128, 0, 0], [13, 127, 127]]),
            }
        );
    }
}
