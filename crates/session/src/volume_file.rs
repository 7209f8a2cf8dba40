//! Volume files as they are named by a user, who says of a `.raw` file what it does not say itself.

use std::path::Path;

use tyndall_scene::description::{RawType, VolumeDescription};
use tyndall_volumes::{AxisOrder, ByteOrder, Element, GridSelection, RawShape, ReadRequest, VolumeFile};

use crate::SessionError;

/// Shape and type of a `.raw` file, x changing fastest, little-endian.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct RawVolume {
    /// Voxels along x, y, z.
    pub shape: [u32; 3],
    /// Type of a number.
    pub element: Element,
}

impl RawVolume {
    /// Writes it as the keys of a scene.
    pub(crate) fn describe(self, volume: &mut VolumeDescription) -> Result<(), SessionError> {
        let raw_type = match self.element {
            Element::UInt8 => RawType::U8,
            Element::UInt16 => RawType::U16,
            Element::Int16 => RawType::I16,
            Element::Float16 => RawType::F16,
            Element::Float32 => RawType::F32,
            Element::Float64 => RawType::F64,
            Element::UInt32 | Element::Int8 | Element::Int32 | Element::Bool => {
                return Err(SessionError::refuse(
                    "--raw-type",
                    "scenes have no such type; make a .vdb with `tyndall convert` and render that",
                ));
            }
        };
        volume.raw_shape = Some(self.shape);
        volume.raw_type = Some(raw_type);
        Ok(())
    }
}

/// Reads grids of a volume file: those with the given names, or all if there are none.
///
/// # Errors
/// If the file is not there, or as [`tyndall_volumes::read`].
pub fn read_volume(
    path: &Path,
    names: &[String],
    raw: Option<RawVolume>,
) -> Result<VolumeFile, SessionError> {
    check_input(path)?;
    let grids = match names {
        [] => GridSelection::All,
        names => GridSelection::Names(names.to_vec()),
    };
    let raw = raw.map(|RawVolume { shape, element }| RawShape {
        shape: shape.map(|edge| edge as usize),
        element,
        byte_order: ByteOrder::Little,
        axis_order: AxisOrder::XFastest,
    });
    Ok(tyndall_volumes::read(path, &ReadRequest { grids, raw })?)
}

/// Refuses names of files that do not exist, and folders, pipes and devices.
///
/// # Errors
/// If the path is either.
pub fn check_input(path: &Path) -> Result<(), SessionError> {
    match path.metadata() {
        Ok(metadata) if metadata.is_dir() => {
            Err(SessionError::refuse_file(path, "is a folder; give a file in it"))
        }
        Ok(metadata) if !metadata.is_file() => Err(SessionError::refuse_file(
            path,
            "is a pipe or a device; put its content into a file and give that",
        )),
        Err(error) if error.kind() == std::io::ErrorKind::NotFound => {
            Err(SessionError::NotFound(path.to_owned()))
        }
        // Whatever else keeps it from being read shows when it is.
        _ => Ok(()),
    }
}
