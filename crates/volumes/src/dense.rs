//! From a dense array in a stream to a sparse [`Tree`].
//!
//! The array is read in slabs of eight planes across its slowest axis, each cut into 8³ leaves; a full leaf of one
//! value becomes a tile. Peak memory is the tree plus one slab. Every voxel of the array is active; outside the
//! array the value is 0 and inactive. Voxel (0, 0, 0) is the first of the array.

use std::io::Read;

use tyndall_machine::memory;

use crate::element::{AxisOrder, ByteOrder, Element};
use crate::fault::Fault;
use crate::{GridValues, LEAF_VOXELS, Leaf, Tile, Tree};

/// Planes in a slab, and the edge of a leaf.
pub(crate) const EDGE: usize = 8;
/// A leaf costs 512 values however few of its voxels exist: an array that would grow by more than this factor …
const MOST_GROWTH: u64 = 16;
/// … to more than this many bytes is no volume.
const GROWTH_ALLOWED: u64 = 64 << 20;

/// How a dense array is stored.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Dense {
    /// Voxels along x, y, z.
    pub shape: [usize; 3],
    /// Numbers a voxel, next to each other: 1, or 3 for vectors.
    pub channels: usize,
    /// Type of the numbers.
    pub element: Element,
    /// Order of their bytes.
    pub byte_order: ByteOrder,
    /// Order of the voxels.
    pub axis_order: AxisOrder,
    /// `(slope, intercept)`: the value is `slope · number + intercept`.
    pub scale: Option<(f64, f64)>,
}

/// Bytes of an array of such voxels, once its shape is sound.
fn bytes_of(shape: [usize; 3], voxel_bytes: u64) -> Result<u64, Fault> {
    let [x, y, z] = shape;
    if shape.contains(&0) {
        return Err(Fault::Damaged(format!("the array of {x} x {y} x {z} voxels has none at all")));
    }
    let longest = i32::MAX as usize - EDGE;
    shape
        .iter()
        .try_fold(voxel_bytes, |bytes, &edge| bytes.checked_mul(edge as u64).filter(|_| edge <= longest))
        .ok_or_else(|| {
            Fault::Damaged(format!("an array of {x} x {y} x {z} voxels is too large for any memory"))
        })
}

/// Refuses arrays that have no voxels, or that would take far more memory as a tree.
pub(crate) fn sound_shape(shape: [usize; 3], voxel_bytes: u64) -> Result<(), Fault> {
    let bytes = bytes_of(shape, voxel_bytes)?;
    let leaves = shape.iter().fold(1u64, |leaves, edge| leaves.saturating_mul(edge.div_ceil(EDGE) as u64));
    let grown = leaves.saturating_mul(LEAF_VOXELS as u64 * 4);
    if grown > GROWTH_ALLOWED && grown / MOST_GROWTH > bytes {
        let [x, y, z] = shape;
        return Err(Fault::Unsupported(format!(
            "an array of {x} x {y} x {z} voxels is too thin to be a volume; give it at least 8 voxels an axis"
        )));
    }
    Ok(())
}

impl Dense {
    /// Bytes of the array, once its shape is sound.
    pub(crate) fn bytes(&self) -> Result<u64, Fault> {
        bytes_of(self.shape, self.voxel_bytes())
    }

    fn voxel_bytes(&self) -> u64 {
        (self.channels * self.element.size()) as u64
    }

    /// Reads the array from `source`, which holds `available` bytes if that is known.
    ///
    /// Numbers that 32-bit floats hold exactly become `Float`, others `Double`; vectors become `Vec3`, rounded.
    pub(crate) fn read(&self, source: &mut impl Read, available: Option<u64>) -> Result<GridValues, Fault> {
        let bytes = self.bytes()?;
        let [x, y, z] = self.shape;
        if let Some(available) = available.filter(|&available| available < bytes) {
            return Err(Fault::Damaged(format!(
                "truncated: {x} x {y} x {z} voxels take {bytes} bytes, the file has {available} for them"
            )));
        }
        sound_shape(self.shape, self.voxel_bytes())?;
        let reserve = available.is_some();
        // Adding -0 changes nothing, not even the sign of a zero.
        let (slope, intercept) = self.scale.unwrap_or((1.0, -0.0));
        Ok(match (self.channels, self.element.fits_f32()) {
            (3, _) => GridValues::Vec3(self.build(source, reserve, |numbers| {
                [0, 1, 2].map(|channel| (slope * numbers[channel] + intercept) as f32)
            })?),
            (_, true) => GridValues::Float(
                self.build(source, reserve, |numbers| (slope * numbers[0] + intercept) as f32)?,
            ),
            (_, false) => {
                GridValues::Double(self.build(source, reserve, |numbers| slope * numbers[0] + intercept)?)
            }
        })
    }

    /// Reads slab after slab; `value` takes the numbers of a voxel. `reserve` if the array is known to be
    /// there in full.
    fn build<T>(
        &self,
        source: &mut impl Read,
        reserve: bool,
        value: impl Fn(&[f64]) -> T,
    ) -> Result<Tree<T>, Fault>
    where
        T: Copy + Default + PartialEq,
    {
        let voxel = self.channels * self.element.size();
        let [nx, ny, nz] = self.shape;
        // Bytes from a voxel to its neighbour along x, y, z, within a slab.
        let (slow, strides) = match self.axis_order {
            AxisOrder::XFastest => (2, [voxel, nx * voxel, nx * ny * voxel]),
            AxisOrder::ZFastest => (0, [nz * ny * voxel, nz * voxel, voxel]),
        };
        let mut tree =
            Tree { background: T::default(), tiles: Vec::new(), leaves: Vec::new(), leaf_values: Vec::new() };
        let leaves = self.shape.iter().fold(1usize, |all, edge| all.saturating_mul(edge.div_ceil(EDGE)));
        if reserve {
            memory::ask_for(leaves, LEAF_VOXELS * size_of::<T>(), || {
                format!("{nx} x {ny} x {nz} voxels of {} bytes", size_of::<T>())
            })?;
            // Address space, not memory: pages are taken as leaves come, and nothing is ever copied to grow.
            let _ = tree.leaf_values.try_reserve_exact(leaves.saturating_mul(LEAF_VOXELS));
        }
        let mut slab = Vec::new();
        for first in (0..self.shape[slow]).step_by(EDGE) {
            let planes = EDGE.min(self.shape[slow] - first);
            if !reserve {
                // What is not known to be there is granted as it comes; growing copies what there is.
                let held = tree.leaf_values.len().saturating_mul(size_of::<T>());
                memory::ask_for(2, held, || format!("2 x {} voxels", tree.leaf_values.len()))?;
            }
            self.read_slab(source, planes * strides[slow], &mut slab)?;
            let mut corner = [0; 3];
            corner[slow] = first;
            let (a, b) = if slow == 0 { (1, 2) } else { (0, 1) };
            for along_a in (0..self.shape[a]).step_by(EDGE) {
                for along_b in (0..self.shape[b]).step_by(EDGE) {
                    (corner[a], corner[b]) = (along_a, along_b);
                    let mut in_slab = corner;
                    in_slab[slow] = 0;
                    let start: usize = (0..3).map(|axis| in_slab[axis] * strides[axis]).sum();
                    self.push_leaf(corner, &slab[start..], strides, &value, &mut tree);
                }
            }
        }
        tree.leaf_values.shrink_to_fit();
        Ok(tree)
    }

    /// The next `len` bytes, in little-endian order; memory grows only with the bytes that are really there.
    fn read_slab(&self, source: &mut impl Read, len: usize, slab: &mut Vec<u8>) -> Result<(), Fault> {
        slab.clear();
        source.take(len as u64).read_to_end(slab)?;
        if slab.len() < len {
            return Err(Fault::damaged("truncated: the file ends before its voxels do"));
        }
        let size = self.element.size();
        if self.byte_order == ByteOrder::Big && size > 1 {
            slab.chunks_exact_mut(size).for_each(<[u8]>::reverse);
        }
        Ok(())
    }

    /// Adds the leaf at `corner`, whose first voxel is at the start of `bytes`.
    fn push_leaf<T>(
        &self,
        corner: [usize; 3],
        bytes: &[u8],
        strides: [usize; 3],
        value: &impl Fn(&[f64]) -> T,
        tree: &mut Tree<T>,
    ) where
        T: Copy + Default + PartialEq,
    {
        let edges = [0, 1, 2].map(|axis| EDGE.min(self.shape[axis] - corner[axis]));
        let origin = corner.map(|index| index as i32);
        // Along the file: planes, rows of a plane, the voxels of a row.
        let (plane_axis, fast_axis) = match self.axis_order {
            AxisOrder::XFastest => (2, 0),
            AxisOrder::ZFastest => (0, 2),
        };
        let shift = |axis: usize| 6 - 3 * axis;
        let mut values = [T::default(); LEAF_VOXELS];
        let mut numbers = [0.0; 3 * EDGE];
        let in_row = edges[fast_axis] * self.channels;
        for plane in 0..edges[plane_axis] {
            for y in 0..edges[1] {
                let row = plane * strides[plane_axis] + y * strides[1];
                self.element.decode(&bytes[row..row + in_row * self.element.size()], &mut numbers[..in_row]);
                let first = plane << shift(plane_axis) | y << shift(1);
                for (n, numbers) in numbers[..in_row].chunks_exact(self.channels).enumerate() {
                    values[first | n << shift(fast_axis)] = value(numbers);
                }
            }
        }
        let row = 0xffu64 >> (EDGE - edges[2]);
        let rows = (0..edges[1]).fold(0, |rows, y| rows | row << (8 * y));
        let active = std::array::from_fn(|x| if x < edges[0] { rows } else { 0 });
        let full = edges == [EDGE; 3];
        if full && values.iter().all(|value| *value == values[0]) {
            tree.tiles.push(Tile { origin, log2_edge: 3, value: values[0], active: true });
        } else {
            tree.leaves.push(Leaf { origin, active });
            tree.leaf_values.extend_from_slice(&values);
        }
    }
}
