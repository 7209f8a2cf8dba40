//! NumPy arrays (`.npy`, format versions 1 to 3).
//!
//! | part | bytes |
//! |---|---|
//! | `\x93NUMPY`, major and minor version | 6 + 2 |
//! | length of the header, little-endian | 2 (version 1), 4 (2, 3) |
//! | a Python dictionary literal with `descr`, `fortran_order` and `shape` | length |
//! | the numbers | the rest |
//!
//! An array `a` of shape (X, Y, Z) has `a[i, j, k]` at voxel (i, j, k) = (x, y, z), in C and in Fortran order alike
//! (as OpenVDB's `copyFromArray` has it); one of shape (X, Y, Z, 3) is a field of vectors. Numbers are kept as they are:
//! an integer 255 is the value 255. There is no map in such a file, so voxel centres stand at integers of world space.
//!
//! Source: NumPy enhancement proposal 1 and `numpy.lib.format`.

use std::io::{Read, Write};

use glam::DAffine3;

use crate::dense::Dense;
use crate::dense_box::DenseBox;
use crate::element::{AxisOrder, ByteOrder, Element};
use crate::fault::Fault;
use crate::float_tree::{FloatTree, Voxel};
use crate::{Grid, GridClass, Tree};

/// How every such file begins.
pub(crate) const MAGIC: &[u8] = b"\x93NUMPY";
/// No array of numbers needs a longer header; NumPy itself stops at 10,000.
const LONGEST_HEADER: usize = 65_536;

/// Reads an array from a stream that holds `available` bytes.
pub(crate) fn read(source: &mut impl Read, available: u64) -> Result<Grid, Fault> {
    let mut start = [0; 8];
    source.read_exact(&mut start)?;
    let mut length = [0; 4];
    let counted = match start[6] {
        1 => 2,
        2 | 3 => 4,
        major => {
            return Err(Fault::Unsupported(format!("NumPy format version {major} is not read, only 1 to 3")));
        }
    };
    source.read_exact(&mut length[..counted])?;
    let length = u32::from_le_bytes(length) as usize;
    if length > LONGEST_HEADER {
        return Err(Fault::Damaged(format!("corrupt: a NumPy header of {length} bytes")));
    }
    let mut header = vec![0; length];
    source.read_exact(&mut header)?;
    let header = Header::parse(&String::from_utf8_lossy(&header))?;
    let available = available.saturating_sub((start.len() + counted + length) as u64);
    let dense = header.dense()?;
    let values = match header.shape.len() == 4 && header.fortran_order {
        true => {
            let interleaved = interleave(source, &dense)?;
            let len = interleaved.len() as u64;
            dense.read(&mut interleaved.as_slice(), Some(len))?
        }
        false => dense.read(source, Some(available))?,
    };
    Ok(Grid {
        name: if dense.channels == 3 { "vector" } else { "density" }.to_owned(),
        class: GridClass::Unknown,
        index_to_world: DAffine3::IDENTITY,
        saved_as_half: dense.element == Element::Float16,
        codec: "none".to_owned(),
        metadata: vec![("numpy_descr".to_owned(), header.descr)],
        values,
    })
}

/// What the dictionary says.
struct Header {
    descr: String,
    fortran_order: bool,
    shape: Vec<usize>,
}

impl Header {
    fn parse(text: &str) -> Result<Self, Fault> {
        let after = |key: &str| {
            [format!("'{key}'"), format!("\"{key}\"")]
                .iter()
                .find_map(|quoted| text.split_once(quoted.as_str()))
                .and_then(|(_, rest)| rest.trim_start().strip_prefix(':'))
                .map(str::trim_start)
                .ok_or_else(|| Fault::Damaged(format!("corrupt: the NumPy header has no `{key}`")))
        };
        let descr = after("descr")?;
        let Some(quote) = descr.chars().next().filter(|quote| matches!(quote, '\'' | '"')) else {
            return Err(Fault::unsupported(
                "structured NumPy arrays are not read; save one field as its own array",
            ));
        };
        let descr = descr[1..].split(quote).next().unwrap_or_default().to_owned();
        let fortran_order = after("fortran_order")?.starts_with("True");
        let shape = after("shape")?
            .strip_prefix('(')
            .and_then(|shape| shape.split_once(')'))
            .ok_or_else(|| Fault::damaged("corrupt: the `shape` of the NumPy header is no tuple"))?;
        let shape = shape
            .0
            .split(',')
            .map(str::trim)
            .filter(|edge| !edge.is_empty())
            .map(|edge| edge.trim_end_matches('L').parse())
            .collect::<Result<_, _>>()
            .map_err(|_| {
                Fault::damaged("corrupt: the `shape` of the NumPy header holds something else than numbers")
            })?;
        Ok(Self { descr, fortran_order, shape })
    }

    fn dense(&self) -> Result<Dense, Fault> {
        let (shape, channels) = match *self.shape.as_slice() {
            [x, y, z] | [x, y, z, 1] => ([x, y, z], 1),
            [x, y, z, 3] => ([x, y, z], 3),
            ref other => {
                return Err(Fault::Unsupported(format!(
                    "an array of {} axes {other:?} is no volume; save one of shape (X, Y, Z) or (X, Y, Z, 3)",
                    other.len()
                )));
            }
        };
        let (byte_order, kind) = match self.descr.split_at_checked(1) {
            Some(("<" | "|" | "=", kind)) => (ByteOrder::Little, kind),
            Some((">", kind)) => (ByteOrder::Big, kind),
            _ => (ByteOrder::Little, self.descr.as_str()),
        };
        let element = match kind {
            "f2" => Element::Float16,
            "f4" => Element::Float32,
            "f8" => Element::Float64,
            "u1" => Element::UInt8,
            "u2" => Element::UInt16,
            "u4" => Element::UInt32,
            "i1" => Element::Int8,
            "i2" => Element::Int16,
            "i4" => Element::Int32,
            "b1" => Element::Bool,
            _ => {
                return Err(Fault::Unsupported(format!(
                    "NumPy arrays of type `{}` are not read; save the array with .astype('float32')",
                    self.descr
                )));
            }
        };
        let axis_order = if self.fortran_order { AxisOrder::XFastest } else { AxisOrder::ZFastest };
        Ok(Dense { shape, channels, element, byte_order, axis_order, scale: None })
    }
}

/// Brings the components of each voxel together: in Fortran order each component is an array of its own.
fn interleave(source: &mut impl Read, dense: &Dense) -> Result<Vec<u8>, Fault> {
    let bytes = dense.bytes()?;
    let mut planar = Vec::new();
    source.take(bytes).read_to_end(&mut planar)?;
    if (planar.len() as u64) < bytes {
        return Err(Fault::damaged("truncated: the file ends before its voxels do"));
    }
    let size = dense.element.size();
    let component = planar.len() / dense.channels;
    let mut interleaved = Vec::with_capacity(planar.len());
    for voxel in (0..component).step_by(size) {
        for channel in 0..dense.channels {
            let at = channel * component + voxel;
            interleaved.extend_from_slice(&planar[at..at + size]);
        }
    }
    Ok(interleaved)
}

/// Writes the active box of a grid as a C-ordered array of 32-bit floats, of shape (X, Y, Z) or (X, Y, Z, 3).
///
/// Such a file has no room for the map or for where the box began.
pub(crate) fn write(out: &mut dyn Write, grid: &Grid) -> Result<(), Fault> {
    match FloatTree::of(&grid.values) {
        FloatTree::Scalar(tree) => write_tree(out, &*tree),
        FloatTree::Vector(tree) => write_tree(out, tree),
    }
}

fn write_tree<T: Voxel>(out: &mut dyn Write, tree: &Tree<T>) -> Result<(), Fault> {
    let dense = DenseBox::of(tree)?;
    let [x, y, z] = dense.shape;
    let channels = if T::CHANNELS == 3 { ", 3" } else { "" };
    let mut header =
        format!("{{'descr': '<f4', 'fortran_order': False, 'shape': ({x}, {y}, {z}{channels}), }}");
    // Magic, version, length and header together are a multiple of 64 bytes and end with a line feed.
    let whole = (MAGIC.len() + 4 + header.len() + 1).next_multiple_of(64);
    let length = whole - MAGIC.len() - 4;
    while header.len() + 1 < length {
        header.push(' ');
    }
    header.push('\n');
    let mut start = MAGIC.to_vec();
    start.extend_from_slice(&[1, 0]);
    start.extend_from_slice(&(length as u16).to_le_bytes());
    start.extend_from_slice(header.as_bytes());
    out.write_all(&start).map_err(Fault::Io)?;
    dense.write(tree, AxisOrder::ZFastest, out)
}
