//! Grids from arrays that are in memory already, in whatever order and type they are, and arrays from grids.
//!
//! As a reader of files would make them: every voxel is active, those outside are inactive and 0, and a full leaf of one
//! value becomes a tile. The array is asked voxel by voxel, so that it need not be copied into another order first.

use std::io::{self, Write};

use glam::DAffine3;
use tyndall_machine::memory;

use crate::dense::{EDGE, sound_shape};
use crate::dense_box::DenseBox;
use crate::element::AxisOrder;
use crate::fault::Fault;
use crate::float_tree::{FloatTree, Voxel};
use crate::{Grid, GridClass, GridValues, LEAF_VOXELS, Leaf, Tile, Tree};

/// Why an array is no volume, as one line with the mend.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{0}")]
pub struct ArrayError(String);

/// The tree of an array whose voxel (x, y, z) is `value([x, y, z])`.
///
/// # Examples
///
/// ```
/// let tree = tyndall_volumes::tree_of_array([8, 8, 9], |[_, _, z]| if z < 8 { 1.0 } else { 2.0f32 })?;
/// assert_eq!((tree.tiles.len(), tree.leaves.len()), (1, 1));
/// # Ok::<(), tyndall_volumes::ArrayError>(())
/// ```
///
/// # Errors
/// If the array has no voxels, or as a tree would take far more memory than as an array.
pub fn tree_of_array<T>(shape: [usize; 3], value: impl Fn([usize; 3]) -> T) -> Result<Tree<T>, ArrayError>
where
    T: Copy + Default + PartialEq,
{
    sound_shape(shape, size_of::<T>() as u64).map_err(|fault| match fault {
        Fault::Damaged(what) | Fault::Unsupported(what) => ArrayError(what),
        Fault::Io(error) => ArrayError(error.to_string()),
    })?;
    let count = shape.iter().fold(1usize, |all, edge| all.saturating_mul(edge.next_multiple_of(EDGE)));
    memory::ask_for(count, size_of::<T>(), || {
        let [x, y, z] = shape;
        format!("{x} x {y} x {z} voxels of {} bytes", size_of::<T>())
    })
    .map_err(|error| ArrayError(error.to_string()))?;
    let mut tree =
        Tree { background: T::default(), tiles: Vec::new(), leaves: Vec::new(), leaf_values: Vec::new() };
    for x in (0..shape[0]).step_by(EDGE) {
        for y in (0..shape[1]).step_by(EDGE) {
            for z in (0..shape[2]).step_by(EDGE) {
                push_leaf(&mut tree, shape, [x, y, z], &value);
            }
        }
    }
    tree.leaf_values.shrink_to_fit();
    Ok(tree)
}

/// Adds the leaf whose least voxel is `corner`.
fn push_leaf<T>(tree: &mut Tree<T>, shape: [usize; 3], corner: [usize; 3], value: &impl Fn([usize; 3]) -> T)
where
    T: Copy + Default + PartialEq,
{
    let edges = [0, 1, 2].map(|axis| EDGE.min(shape[axis] - corner[axis]));
    let origin = corner.map(|index| index as i32);
    let mut values = [T::default(); LEAF_VOXELS];
    for x in 0..edges[0] {
        for y in 0..edges[1] {
            for z in 0..edges[2] {
                values[x << 6 | y << 3 | z] = value([corner[0] + x, corner[1] + y, corner[2] + z]);
            }
        }
    }
    if edges == [EDGE; 3] && values.iter().all(|value| *value == values[0]) {
        tree.tiles.push(Tile { origin, log2_edge: 3, value: values[0], active: true });
        return;
    }
    let row = 0xffu64 >> (EDGE - edges[2]);
    let rows = (0..edges[1]).fold(0, |rows, y| rows | row << (8 * y));
    let active = std::array::from_fn(|x| if x < edges[0] { rows } else { 0 });
    tree.leaves.push(Leaf { origin, active });
    tree.leaf_values.extend_from_slice(&values);
}

/// The box around the active voxels of a grid.
#[derive(Debug, Clone, PartialEq)]
pub struct DenseArray {
    /// Index coordinates of its first voxel.
    pub origin: [i32; 3],
    /// Voxels along x, y and z.
    pub shape: [usize; 3],
    /// Numbers a voxel: 1, or 3 of vectors.
    pub channels: usize,
    /// The numbers, those of a voxel next to each other and z changing fastest; inactive voxels have the value that they
    /// have in the tree.
    pub values: Vec<f32>,
}

impl Grid {
    /// The box around the active voxels as an array, doubles and integers rounded to floats.
    ///
    /// # Errors
    /// If no voxel is active, or the array would be larger than 4 GiB.
    pub fn to_array(&self) -> Result<DenseArray, ArrayError> {
        let error = |fault| match fault {
            Fault::Damaged(what) | Fault::Unsupported(what) => ArrayError(what),
            Fault::Io(error) => ArrayError(error.to_string()),
        };
        match FloatTree::of(&self.values) {
            FloatTree::Scalar(tree) => array_of(&tree),
            FloatTree::Vector(tree) => array_of(tree),
        }
        .map_err(error)
    }

    /// A grid that no file has: a name, where it is, and values.
    pub fn in_memory(name: &str, index_to_world: DAffine3, values: GridValues) -> Self {
        Self {
            name: name.to_owned(),
            class: GridClass::Unknown,
            index_to_world,
            saved_as_half: false,
            codec: "none".to_owned(),
            metadata: Vec::new(),
            values,
        }
    }
}

fn array_of<T: Voxel>(tree: &Tree<T>) -> Result<DenseArray, Fault> {
    let dense = DenseBox::of(tree)?;
    let count = dense.shape.iter().product::<usize>();
    // Growing copies what there is.
    memory::ask_for(count, 2 * T::CHANNELS * size_of::<f32>(), || format!("2 arrays of {count} voxels"))?;
    let mut sink = Floats(Vec::new());
    dense.write(tree, AxisOrder::ZFastest, &mut sink)?;
    Ok(DenseArray { origin: dense.min, shape: dense.shape, channels: T::CHANNELS, values: sink.0 })
}

/// Takes the bytes of whole floats.
struct Floats(Vec<f32>);

impl Write for Floats {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let (floats, _) = bytes.as_chunks();
        self.0.extend(floats.iter().map(|float| f32::from_le_bytes(*float)));
        Ok(floats.len() * size_of::<f32>())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{ReadRequest, read_bytes};

    #[test]
    fn an_array_makes_the_same_grid_as_its_file() {
        let shape = [9, 16, 11];
        let number = |[x, y, z]: [usize; 3]| if y < 8 { 0.0 } else { (x * 1000 + y * 50 + z) as f32 };
        let mut bytes = Vec::new();
        for z in 0..shape[2] {
            for y in 0..shape[1] {
                (0..shape[0]).for_each(|x| bytes.extend_from_slice(&number([x, y, z]).to_le_bytes()));
            }
        }
        let name = "a_9x16x11_float32.raw";
        let file = read_bytes(&bytes, name.as_ref(), &ReadRequest::default()).unwrap();
        let GridValues::Float(read) = &file.grids[0].values else { panic!("floats are read as floats") };
        let mut made = tree_of_array(shape, number).unwrap();
        let by_origin = |tree: &mut Tree<f32>| tree.tiles.sort_by_key(|tile| tile.origin);
        let mut read = read.clone();
        by_origin(&mut read);
        by_origin(&mut made);
        assert_eq!(made.tiles, read.tiles);
        assert_eq!(made.leaves.len(), read.leaves.len());
        for (leaf, values) in made.leaves.iter().zip(made.leaf_values.chunks(LEAF_VOXELS)) {
            let same = read.leaves.iter().position(|other| other.origin == leaf.origin).unwrap();
            assert_eq!(leaf.active, read.leaves[same].active);
            assert_eq!(values, &read.leaf_values[same * LEAF_VOXELS..][..LEAF_VOXELS]);
        }
    }

    #[test]
    fn a_grid_gives_back_the_array_it_was_made_of() {
        let number = |[x, y, z]: [usize; 3]| [(x * 100 + y * 10 + z) as f32, 0.5, -1.0];
        let tree = tree_of_array([3, 9, 2], number).unwrap();
        let array = Grid::in_memory("v", DAffine3::IDENTITY, GridValues::Vec3(tree)).to_array().unwrap();
        assert_eq!((array.origin, array.shape, array.channels), ([0; 3], [3, 9, 2], 3));
        assert_eq!(array.values[(2 * 9 + 7) * 2 * 3..][..3], number([2, 7, 0]));
        assert_eq!(array.values.len(), 3 * 9 * 2 * 3);
    }

    #[test]
    fn arrays_that_are_no_volumes_are_refused() {
        let refused = |shape| tree_of_array(shape, |_| 0u8).unwrap_err().to_string();
        assert!(refused([4, 0, 4]).contains("has none at all"));
        assert!(refused([1, 1, 100_000_000]).contains("too thin"));
        assert!(refused([1 << 40, 1, 1]).contains("too large"));
    }
}
