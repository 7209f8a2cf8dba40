//! All cells of a grid in turn.

use super::bounds::{Bounds, KIND_NODE};
use super::{BrickGrid, Cell};

impl BrickGrid {
    /// Calls `visit` with every smallest cell, each once, and the bounds of the filtered field in it. Together they fill
    /// the grid's table, which may reach beyond its domain.
    pub fn visit_cells(&self, mut visit: impl FnMut(Cell, Bounds)) {
        let [width, height, depth] = self.top_dimensions;
        for x in 0..width {
            for y in 0..height {
                for z in 0..depth {
                    let corner = [x, y, z].map(|top| top << self.top_shift);
                    let top = (x * height + y) * depth + z;
                    self.visit_below(top, corner, self.top_shift, &mut visit);
                }
            }
        }
    }

    fn visit_below(&self, number: u32, corner: [u32; 3], shift: u32, visit: &mut impl FnMut(Cell, Bounds)) {
        let entry = self.entries[number as usize];
        if entry.kind() != KIND_NODE {
            return visit(Cell { corner, shift, max: entry.max() }, entry.bounds());
        }
        let shift = shift - 2;
        for child in 0..64 {
            let within = [child >> 4, child >> 2 & 3, child & 3];
            let corner = std::array::from_fn(|axis| corner[axis] + (within[axis] << shift));
            self.visit_below(entry.index() + child, corner, shift, visit);
        }
    }
}
