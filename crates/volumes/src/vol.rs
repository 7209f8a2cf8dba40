//! Mitsuba's grid volumes (`.vol`, version 3), little-endian.
//!
//! | part | bytes |
//! |---|---|
//! | `VOL`, version 3 | 3 + 1 |
//! | encoding: 1 float32, 2 float16, 3 uint8 (0..255 stands for 0..1), 4 quantised directions | 4 |
//! | cells along x, y, z; channels | 12 + 4 |
//! | box: x, y, z of the least corner, then of the greatest, float32 | 24 |
//! | the values, channel by channel of a voxel, x fastest | the rest |
//!
//! As in Mitsuba 3 the box spans cell faces: with cells of size h, the centre of voxel (i, j, k) stands at
//! `min + (i + ½, j + ½, k + ½) h`. (Mitsuba 0.6 put the outermost voxel centres on the box.)
//!
//! Source: the documentation of the `gridvolume` plugins of Mitsuba 0.6 and 3.

use std::io::{Read, Write};

use glam::{DAffine3, DMat3, DVec3};

use crate::dense::Dense;
use crate::dense_box::DenseBox;
use crate::element::{AxisOrder, ByteOrder, Element};
use crate::fault::Fault;
use crate::float_tree::{FloatTree, Voxel};
use crate::little_endian::{f32_at, i32_at};
use crate::{Grid, GridClass, Tree};

/// How every such file begins.
pub(crate) const MAGIC: &[u8] = b"VOL\x03";
const HEADER: usize = 48;

/// Reads a volume from a stream that holds `available` bytes.
pub(crate) fn read(source: &mut impl Read, available: u64) -> Result<Grid, Fault> {
    let mut header = [0; HEADER];
    source.read_exact(&mut header)?;
    let (element, scale) = match i32_at(&header, 4) {
        1 => (Element::Float32, None),
        2 => (Element::Float16, None),
        3 => (Element::UInt8, Some((1.0 / 255.0, 0.0))),
        4 => {
            return Err(Fault::unsupported(
                "quantised directions (.vol encoding 4) are not read; write float32",
            ));
        }
        other => return Err(Fault::Damaged(format!("corrupt: there is no .vol encoding {other}"))),
    };
    let counts: [i32; 4] = std::array::from_fn(|n| i32_at(&header, 8 + 4 * n));
    let [x, y, z, channels] = counts.map(|count| usize::try_from(count).unwrap_or(0));
    if !matches!(channels, 1 | 3) {
        return Err(Fault::Unsupported(format!(
            "a .vol file of {} channels is not read, only 1 or 3",
            counts[3]
        )));
    }
    let dense = Dense {
        shape: [x, y, z],
        channels,
        element,
        byte_order: ByteOrder::Little,
        axis_order: AxisOrder::XFastest,
        scale,
    };
    let corner = |at| DVec3::from_array(std::array::from_fn(|axis| f32_at(&header, at + 4 * axis).into()));
    let (least, greatest): (DVec3, DVec3) = (corner(24), corner(36));
    let cell = (greatest - least) / DVec3::new(x as f64, y as f64, z as f64);
    let values = dense.read(source, Some(available.saturating_sub(HEADER as u64)))?;
    if !(cell.is_finite() && least.is_finite() && cell.min_element() > 0.0) {
        return Err(Fault::Damaged(format!("corrupt: the box from {least} to {greatest} has no volume")));
    }
    Ok(Grid {
        name: if channels == 3 { "color" } else { "density" }.to_owned(),
        class: GridClass::Unknown,
        index_to_world: DAffine3::from_scale_rotation_translation(
            cell,
            glam::DQuat::IDENTITY,
            least + 0.5 * cell,
        ),
        saved_as_half: element == Element::Float16,
        codec: "none".to_owned(),
        metadata: vec![("vol_encoding".to_owned(), format!("{element:?}").to_lowercase())],
        values,
    })
}

/// Writes the active box of a grid as float32, with its place in world space.
pub(crate) fn write(out: &mut dyn Write, grid: &Grid) -> Result<(), Fault> {
    let map = grid.index_to_world;
    let cell = DVec3::new(map.matrix3.x_axis.x, map.matrix3.y_axis.y, map.matrix3.z_axis.z);
    if map.matrix3 != DMat3::from_diagonal(cell) || cell.min_element() <= 0.0 {
        return Err(Fault::unsupported(
            "a .vol file holds only upright boxes, and this grid is turned or mirrored; write .vdb, .nvdb or .nii",
        ));
    }
    match FloatTree::of(&grid.values) {
        FloatTree::Scalar(tree) => write_tree(out, &*tree, &map),
        FloatTree::Vector(tree) => write_tree(out, tree, &map),
    }
}

fn write_tree<T: Voxel>(out: &mut dyn Write, tree: &Tree<T>, map: &DAffine3) -> Result<(), Fault> {
    let dense = DenseBox::of(tree)?;
    let least = DVec3::from_array(dense.min.map(f64::from)) - 0.5;
    let greatest = least + DVec3::from_array(dense.shape.map(|edge| edge as f64));
    let mut header = MAGIC.to_vec();
    header.extend_from_slice(&1i32.to_le_bytes());
    for count in dense.shape.into_iter().chain([T::CHANNELS]) {
        header.extend_from_slice(&(count as i32).to_le_bytes());
    }
    for corner in [least, greatest] {
        for coordinate in map.transform_point3(corner).to_array() {
            header.extend_from_slice(&(coordinate as f32).to_le_bytes());
        }
    }
    out.write_all(&header).map_err(Fault::Io)?;
    dense.write(tree, AxisOrder::XFastest, out)
}
