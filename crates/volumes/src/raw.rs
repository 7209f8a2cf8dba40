//! Bare numbers (`.raw`): no header at all, so shape and type come from the caller or from the file's name.
//!
//! The collections of volumes on the web name such files `bonsai_256x256x256_uint8.raw`: that is understood, little
//! endian and x fastest. Numbers are kept as they are (255 is 255), and voxel centres stand at integers of world
//! space.

use std::io::{Read, Write};
use std::path::{Path, PathBuf};

use glam::DAffine3;

use crate::dense::Dense;
use crate::dense_box::DenseBox;
use crate::element::{AxisOrder, ByteOrder, Element};
use crate::fault::Fault;
use crate::float_tree::FloatTree;
use crate::{Grid, GridClass};

/// What a `.raw` file does not say about itself.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct RawShape {
    /// Voxels along x, y, z.
    pub shape: [usize; 3],
    /// Type of the numbers.
    pub element: Element,
    /// Order of their bytes.
    pub byte_order: ByteOrder,
    /// Order of the voxels.
    pub axis_order: AxisOrder,
}

impl RawShape {
    /// The shape and type in a name such as `bonsai_256x256x256_uint8.raw`; type and byte order may be followed by
    /// `_le` or `_be`. `None` where either is missing.
    pub fn from_file_name(path: &Path) -> Option<Self> {
        let name = path.file_stem()?.to_str()?.to_ascii_lowercase();
        let parts = || name.split(['_', '-', '.', ' ']);
        let shape = parts().find_map(|part| {
            let edges: Vec<usize> = part.split('x').map(str::parse).collect::<Result<_, _>>().ok()?;
            <[usize; 3]>::try_from(edges).ok()
        })?;
        let element = parts().find_map(|part| part.parse().ok())?;
        let byte_order = if parts().any(|part| part == "be") { ByteOrder::Big } else { ByteOrder::Little };
        Some(Self { shape, element, byte_order, axis_order: AxisOrder::XFastest })
    }
}

/// The names that file names and command lines use.
impl std::str::FromStr for Element {
    type Err = String;

    fn from_str(name: &str) -> Result<Self, String> {
        Ok(match name {
            "float16" | "half" | "f16" | "f2" => Self::Float16,
            "float32" | "float" | "f32" | "f4" => Self::Float32,
            "float64" | "double" | "f64" | "f8" => Self::Float64,
            "uint8" | "uchar" | "u8" | "u1" => Self::UInt8,
            "uint16" | "ushort" | "u16" | "u2" => Self::UInt16,
            "uint32" | "uint" | "u32" | "u4" => Self::UInt32,
            "int8" | "char" | "i8" | "i1" => Self::Int8,
            "int16" | "short" | "i16" | "i2" => Self::Int16,
            "int32" | "int" | "i32" | "i4" => Self::Int32,
            "bool" | "b1" => Self::Bool,
            _ => {
                return Err(format!(
                    "there is no type `{name}`; give one of float16 float32 float64 uint8 uint16 uint32 int8 int16 int32"
                ));
            }
        })
    }
}

/// Reads the numbers of a stream of `available` bytes, which must be exactly those of `raw`.
pub(crate) fn read(source: &mut impl Read, available: u64, raw: &RawShape) -> Result<Grid, Fault> {
    let RawShape { shape, element, byte_order, axis_order } = *raw;
    let dense = Dense { shape, channels: 1, element, byte_order, axis_order, scale: None };
    let bytes = dense.bytes()?;
    if bytes != available {
        let [x, y, z] = shape;
        return Err(Fault::Damaged(format!(
            "{x} x {y} x {z} voxels of {} bytes make {bytes} bytes, but the file has {available}; \
             check the shape and the type",
            element.size()
        )));
    }
    Ok(Grid {
        name: "density".to_owned(),
        class: GridClass::Unknown,
        index_to_world: DAffine3::IDENTITY,
        saved_as_half: element == Element::Float16,
        codec: "none".to_owned(),
        metadata: vec![("raw_type".to_owned(), format!("{element:?}").to_lowercase())],
        values: dense.read(source, Some(available))?,
    })
}

/// `path`, with the shape and type of what will be written in its name.
pub(crate) fn name_with_shape(path: &Path, grid: &Grid) -> Result<PathBuf, Fault> {
    let FloatTree::Scalar(tree) = FloatTree::of(&grid.values) else {
        return Err(vectors());
    };
    let shape = DenseBox::of(&tree)?.shape;
    let [x, y, z] = shape;
    let written = RawShape {
        shape,
        element: Element::Float32,
        byte_order: ByteOrder::Little,
        axis_order: AxisOrder::XFastest,
    };
    match RawShape::from_file_name(path) {
        Some(promised) if promised == written => Ok(path.to_path_buf()),
        Some(_) => Err(Fault::Unsupported(format!(
            "the name promises another shape or type than is written; leave them out or say {x}x{y}x{z}_float32"
        ))),
        None => {
            let stem = path.file_stem().unwrap_or_default().to_string_lossy();
            Ok(path.with_file_name(format!("{stem}_{x}x{y}x{z}_float32.raw")))
        }
    }
}

/// Writes the active box of a grid as little-endian 32-bit floats, x fastest.
pub(crate) fn write(out: &mut dyn Write, grid: &Grid) -> Result<(), Fault> {
    match FloatTree::of(&grid.values) {
        FloatTree::Scalar(tree) => DenseBox::of(&tree)?.write(&tree, AxisOrder::XFastest, out),
        FloatTree::Vector(_) => Err(vectors()),
    }
}

fn vectors() -> Fault {
    Fault::unsupported("a .raw file of vectors would not be understood; write .npy, .vol, .vdb or .nvdb")
}
