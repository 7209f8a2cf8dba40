//! Grids that a scene file writes out cell by cell, x fastest, as [`Grid`]s for files.

use glam::{DAffine3, DVec3};
use tyndall_volumes::{Grid, GridClass, GridValues, LEAF_VOXELS, Leaf, Tree};

use super::media::Corners;

/// A box cut into equal cells.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Lattice {
    /// Cells along x, y, z.
    pub cells: [usize; 3],
    /// The box.
    pub bounds: Corners,
}

/// A value for each cell of a lattice.
#[derive(Debug, Clone)]
pub(super) struct Cells {
    pub lattice: Lattice,
    values: Vec<f32>,
}

impl Lattice {
    /// Edges of a cell.
    pub(super) fn cell_size(&self) -> DVec3 {
        let counts = DVec3::from_array(self.cells.map(|count| count as f64));
        (self.bounds[1] - self.bounds[0]) / counts
    }
}

impl Cells {
    /// The values of a lattice's cells; what is wrong if they are not as many.
    pub(super) fn new(lattice: Lattice, values: impl ExactSizeIterator<Item = f64>) -> Result<Cells, String> {
        let [nx, ny, nz] = lattice.cells;
        let expected = nx.saturating_mul(ny).saturating_mul(nz);
        if values.len() != expected {
            let given = values.len();
            return Err(format!(
                "has {given} values for {nx} x {ny} x {nz} = {expected} cells: give one for each"
            ));
        }
        Ok(Cells { lattice, values: values.map(|value| value as f32).collect() })
    }

    /// The values of a lattice's cells, one for each.
    pub(super) fn of(lattice: Lattice, values: Vec<f32>) -> Cells {
        debug_assert_eq!(values.len(), lattice.cells.iter().product::<usize>());
        Cells { lattice, values }
    }

    /// The box outside which the interpolated values are 0; `None` if they are 0 everywhere.
    pub(super) fn support(&self) -> Option<Corners> {
        let [nx, ny, _] = self.lattice.cells;
        let mut range = [[usize::MAX; 3], [0; 3]];
        for (place, _) in self.values.iter().enumerate().filter(|(_, value)| **value != 0.0) {
            let cell = [place % nx, place / nx % ny, place / (nx * ny)];
            for axis in 0..3 {
                range[0][axis] = range[0][axis].min(cell[axis]);
                range[1][axis] = range[1][axis].max(cell[axis]);
            }
        }
        let [first, last] = range.map(|cell| DVec3::from_array(cell.map(|index| index as f64)));
        let (size, least) = (self.lattice.cell_size(), self.lattice.bounds[0]);
        (range[0][0] != usize::MAX).then(|| [least + (first - 0.5) * size, least + (last + 1.5) * size])
    }

    /// The grid: voxels are the cells' centres, and active where they are not 0.
    pub(super) fn grid(&self) -> Grid {
        let [nx, ny, nz] = self.lattice.cells;
        let size = self.lattice.cell_size();
        let mut tree =
            Tree { background: 0.0, tiles: Vec::new(), leaves: Vec::new(), leaf_values: Vec::new() };
        let mut block = [0.0_f32; LEAF_VOXELS];
        let starts = |count: usize| (0..count).step_by(8);
        for x0 in starts(nx) {
            for y0 in starts(ny) {
                for z0 in starts(nz) {
                    let mut active = [0_u64; 8];
                    block.fill(0.0);
                    for z in z0..nz.min(z0 + 8) {
                        for y in y0..ny.min(y0 + 8) {
                            let row = (z * ny + y) * nx;
                            for x in x0..nx.min(x0 + 8) {
                                let value = self.values[row + x];
                                if value != 0.0 {
                                    block[(x - x0) << 6 | (y - y0) << 3 | (z - z0)] = value;
                                    active[x - x0] |= 1 << ((y - y0) << 3 | (z - z0));
                                }
                            }
                        }
                    }
                    if active != [0; 8] {
                        let origin = [x0, y0, z0].map(|index| index as i32);
                        tree.leaves.push(Leaf { origin, active });
                        tree.leaf_values.extend_from_slice(&block);
                    }
                }
            }
        }
        Grid {
            name: "density".to_owned(),
            class: GridClass::FogVolume,
            index_to_world: DAffine3::from_translation(self.lattice.bounds[0] + size * 0.5)
                * DAffine3::from_scale(size),
            saved_as_half: false,
            codec: String::new(),
            metadata: Vec::new(),
            values: GridValues::Float(tree),
        }
    }
}
