//! NIfTI images (`.nii`, `.nii.gz`), versions 1 and 2, in either byte order.
//!
//! A header of 348 (540) bytes, extensions, then the voxels with x fastest; a value is
//! `scl_slope · number + scl_inter` unless the slope is 0. Byte offsets of what is used here:
//!
//! | field | NIfTI-1 | NIfTI-2 |
//! |---|---|---|
//! | magic | 344 `n+1` | 4 `n+2` |
//! | dim: number of axes, then lengths | 40, 8 × i16 | 16, 8 × i64 |
//! | datatype | 70, i16 | 12, i16 |
//! | pixdim: handedness, then spacings | 76, 8 × f32 | 104, 8 × f64 |
//! | vox_offset, scl_slope, scl_inter | 108, 3 × f32 | 168, i64 and 2 × f64 |
//! | qform_code, sform_code | 252, 2 × i16 | 344, 2 × i32 |
//! | quaternion b, c, d; offset x, y, z | 256, 6 × f32 | 352, 6 × f64 |
//! | srow_x, srow_y, srow_z | 280, 12 × f32 | 400, 12 × f64 |
//!
//! The map to world space (in the file's unit, mostly millimetres) takes integer indices to voxel centres: `srow` if
//! sform_code > 0, else the quaternion if qform_code > 0, else the spacings alone. Of several volumes (time steps,
//! components) the first is read, and the metadata say so.
//!
//! Source: `nifti1.h` and `nifti2.h` of the NIfTI Data Format Working Group.

use std::io::{Read, Write};

use glam::{DAffine3, DMat3, DQuat, DVec3};

use crate::dense::Dense;
use crate::dense_box::DenseBox;
use crate::element::{AxisOrder, ByteOrder, Element};
use crate::fault::Fault;
use crate::float_tree::FloatTree;
use crate::{Grid, GridClass};

const HEADER_1: usize = 348;
const HEADER_2: usize = 540;

/// Whether a file that begins with `start` (348 bytes, or as many as it has) is a NIfTI image.
pub(crate) fn recognise(start: &[u8]) -> bool {
    Fields::of(start).is_some()
}

/// Reads an image from a stream that holds `available` bytes, if that is known.
pub(crate) fn read(source: &mut impl Read, available: Option<u64>) -> Result<Grid, Fault> {
    let mut header = vec![0; HEADER_1];
    source.read_exact(&mut header)?;
    let Some(version_2) = Fields::of(&header).map(|fields| fields.version_2) else {
        return Err(Fault::damaged("not a NIfTI image"));
    };
    if version_2 {
        header.resize(HEADER_2, 0);
        source.read_exact(&mut header[HEADER_1..])?;
    }
    let Some(fields) = Fields::of(&header) else {
        return Err(Fault::damaged("not a NIfTI image"));
    };
    let image = fields.image()?;
    let skipped = image.first_voxel.saturating_sub(header.len() as u64);
    if std::io::copy(&mut source.take(skipped), &mut std::io::sink())? < skipped {
        return Err(Fault::damaged("truncated: the file ends before its voxels begin"));
    }
    let available = available.map(|bytes| bytes.saturating_sub(image.first_voxel.max(header.len() as u64)));
    let values = image.dense.read(source, available)?;
    let mut metadata = vec![("nifti_version".to_owned(), if version_2 { "2" } else { "1" }.to_owned())];
    metadata.push(("nifti_datatype".to_owned(), format!("{:?}", image.dense.element).to_lowercase()));
    metadata.push(("nifti_map".to_owned(), image.map_from.to_owned()));
    if image.volumes > 1 {
        metadata.push(("nifti_volumes".to_owned(), format!("{}, of which the first is read", image.volumes)));
    }
    Ok(Grid {
        name: "density".to_owned(),
        class: GridClass::Unknown,
        index_to_world: image.index_to_world,
        saved_as_half: false,
        codec: "none".to_owned(),
        metadata,
        values,
    })
}

/// What the header says, checked.
struct Image {
    dense: Dense,
    first_voxel: u64,
    volumes: u64,
    index_to_world: DAffine3,
    map_from: &'static str,
}

/// A header with its version and byte order.
struct Fields<'a> {
    bytes: &'a [u8],
    version_2: bool,
    byte_order: ByteOrder,
}

impl<'a> Fields<'a> {
    /// `None` if this is no NIfTI header.
    fn of(bytes: &'a [u8]) -> Option<Self> {
        let size = <[u8; 4]>::try_from(bytes.get(..4)?).ok()?;
        let byte_order = match (i32::from_le_bytes(size), i32::from_be_bytes(size)) {
            (348 | 540, _) => ByteOrder::Little,
            (_, 348 | 540) => ByteOrder::Big,
            _ => return None,
        };
        let version_2 = bytes.get(4..7) == Some(b"n+2");
        let version_1 = matches!(bytes.get(344..347), Some(b"n+1" | b"ni1"));
        (version_1 || version_2).then_some(Self { bytes, version_2, byte_order })
    }

    fn bytes_at<const N: usize>(&self, at: usize) -> [u8; N] {
        let mut bytes: [u8; N] = std::array::from_fn(|n| self.bytes.get(at + n).copied().unwrap_or(0));
        if self.byte_order == ByteOrder::Big {
            bytes.reverse();
        }
        bytes
    }

    /// Item `n` of the whole numbers at the offset of this version; `size` is that in NIfTI-2.
    fn whole(&self, at_1: usize, at_2: (usize, usize), n: usize) -> i64 {
        match (self.version_2, at_2.1) {
            (false, _) => i16::from_le_bytes(self.bytes_at(at_1 + 2 * n)).into(),
            (true, 8) => i64::from_le_bytes(self.bytes_at(at_2.0 + 8 * n)),
            (true, 4) => i32::from_le_bytes(self.bytes_at(at_2.0 + 4 * n)).into(),
            (true, _) => i16::from_le_bytes(self.bytes_at(at_2.0 + 2 * n)).into(),
        }
    }

    /// Item `n` of the floats at the offset of this version.
    fn float(&self, at_1: usize, at_2: usize, n: usize) -> f64 {
        match self.version_2 {
            false => f32::from_le_bytes(self.bytes_at(at_1 + 4 * n)).into(),
            true => f64::from_le_bytes(self.bytes_at(at_2 + 8 * n)),
        }
    }

    fn image(&self) -> Result<Image, Fault> {
        if !self.version_2 && self.bytes.get(344..347) == Some(b"ni1") {
            return Err(Fault::unsupported(
                "a NIfTI header whose voxels are in a separate .img is not read; write .nii",
            ));
        }
        let (shape, volumes) = self.shape()?;
        let first_voxel = match self.version_2 {
            false => self.float(108, 0, 0),
            true => self.whole(0, (168, 8), 0) as f64,
        };
        if !(0.0..1e15).contains(&first_voxel) {
            return Err(Fault::damaged("corrupt: `vox_offset` of the NIfTI header is not a place in a file"));
        }
        let (slope, intercept) = (self.float(112, 176, 0), self.float(116, 184, 0));
        let scaled =
            slope != 0.0 && slope.is_finite() && intercept.is_finite() && (slope, intercept) != (1.0, 0.0);
        let (index_to_world, map_from) = self.index_to_world()?;
        let dense = Dense {
            shape,
            channels: 1,
            element: self.element()?,
            byte_order: self.byte_order,
            axis_order: AxisOrder::XFastest,
            scale: scaled.then_some((slope, intercept)),
        };
        Ok(Image { dense, first_voxel: first_voxel as u64, volumes, index_to_world, map_from })
    }

    /// Voxels along x, y, z, and how many such volumes there are.
    fn shape(&self) -> Result<([usize; 3], u64), Fault> {
        let dim = |n| self.whole(40, (16, 8), n);
        let axes = dim(0);
        if !(1..=7).contains(&axes) {
            return Err(Fault::Damaged(format!("corrupt: a NIfTI image of {axes} axes")));
        }
        if axes < 3 {
            return Err(Fault::Unsupported(format!("a NIfTI image of {axes} axes is no volume; it needs 3")));
        }
        let mut lengths = [0; 7];
        for (n, length) in lengths.iter_mut().enumerate().take(axes as usize) {
            *length = u64::try_from(dim(n + 1)).map_err(|_| {
                Fault::Damaged(format!("corrupt: axis {} of the NIfTI image has a negative length", n + 1))
            })?;
        }
        let volumes =
            lengths[3..axes as usize].iter().fold(1, |volumes: u64, &length| volumes.saturating_mul(length));
        Ok(([0, 1, 2].map(|axis| usize::try_from(lengths[axis]).unwrap_or(usize::MAX)), volumes))
    }

    fn element(&self) -> Result<Element, Fault> {
        Ok(match self.whole(70, (12, 2), 0) {
            2 => Element::UInt8,
            4 => Element::Int16,
            8 => Element::Int32,
            16 => Element::Float32,
            64 => Element::Float64,
            256 => Element::Int8,
            512 => Element::UInt16,
            768 => Element::UInt32,
            other => {
                return Err(Fault::Unsupported(format!(
                    "NIfTI voxels of datatype {other} are not read; write the image as float32 (16)"
                )));
            }
        })
    }

    /// The map of integer indices to voxel centres, and where in the header it stands.
    fn index_to_world(&self) -> Result<(DAffine3, &'static str), Fault> {
        let spacing = |n| self.float(76, 104, n);
        let spacings =
            DVec3::from_array([1, 2, 3].map(|n| if spacing(n) == 0.0 { 1.0 } else { spacing(n).abs() }));
        let (map, map_from) = if self.whole(254, (348, 4), 0) > 0 {
            let row =
                |n: usize| DVec3::from_array([0, 1, 2].map(|column| self.float(280, 400, 4 * n + column)));
            let matrix = DMat3::from_cols(row(0), row(1), row(2)).transpose();
            let translation = DVec3::from_array([3, 7, 11].map(|n| self.float(280, 400, n)));
            (DAffine3::from_mat3_translation(matrix, translation), "sform")
        } else if self.whole(252, (344, 4), 0) > 0 {
            let [b, c, d, x, y, z] = [0, 1, 2, 3, 4, 5].map(|n| self.float(256, 352, n));
            let a = (1.0 - (b * b + c * c + d * d)).max(0.0).sqrt();
            let rotation = DQuat::from_xyzw(b, c, d, a).normalize();
            let handed = DVec3::new(1.0, 1.0, if spacing(0) < 0.0 { -1.0 } else { 1.0 });
            let translation = DVec3::new(x, y, z);
            (DAffine3::from_scale_rotation_translation(spacings * handed, rotation, translation), "qform")
        } else {
            (DAffine3::from_scale(spacings), "pixdim")
        };
        match map.is_finite() && map.matrix3.determinant() != 0.0 {
            true => Ok((map, map_from)),
            false => Err(Fault::Damaged(format!(
                "corrupt: the {map_from} of the NIfTI header is singular or not finite"
            ))),
        }
    }
}

/// Writes the active box of a grid as float32, version 1, with its map as `sform`.
pub(crate) fn write(out: &mut dyn Write, grid: &Grid) -> Result<(), Fault> {
    let FloatTree::Scalar(tree) = FloatTree::of(&grid.values) else {
        return Err(Fault::unsupported(
            "NIfTI images of vectors are not written; write .npy, .vol, .vdb or .nvdb",
        ));
    };
    let dense = DenseBox::of(&tree)?;
    let first = DVec3::from_array(dense.min.map(f64::from));
    let map = grid.index_to_world * DAffine3::from_translation(first);
    // An extension flag of four zero bytes follows the header.
    let mut header = vec![0; HEADER_1 + 4];
    let mut put = |at: usize, bytes: &[u8]| header[at..at + bytes.len()].copy_from_slice(bytes);
    put(0, &(HEADER_1 as i32).to_le_bytes());
    put(40, &3i16.to_le_bytes());
    put(76, &1f32.to_le_bytes());
    for axis in 0..3 {
        let edge = i16::try_from(dense.shape[axis]).map_err(|_| {
            Fault::unsupported(
                "an axis of more than 32767 voxels does not fit a NIfTI-1 file; write .npy or .nvdb",
            )
        })?;
        put(42 + 2 * axis, &edge.to_le_bytes());
        put(80 + 4 * axis, &(map.matrix3.col(axis).length() as f32).to_le_bytes());
        let row = map.matrix3.row(axis).extend(map.translation[axis]).to_array();
        for (column, value) in row.into_iter().enumerate() {
            put(280 + 16 * axis + 4 * column, &(value as f32).to_le_bytes());
        }
    }
    for axis in 3..7 {
        put(42 + 2 * axis, &1i16.to_le_bytes());
    }
    put(70, &16i16.to_le_bytes());
    put(72, &32i16.to_le_bytes());
    put(108, &((HEADER_1 + 4) as f32).to_le_bytes());
    put(112, &1f32.to_le_bytes());
    put(254, &2i16.to_le_bytes());
    put(344, b"n+1\0");
    out.write_all(&header).map_err(Fault::Io)?;
    dense.write(&tree, AxisOrder::XFastest, out)
}
