//! Volume files on the command line: what a `.raw` file does not say about itself comes from options.

use std::path::Path;

use miette::miette;
use tyndall_scene::description::{RawType, VolumeDescription};
use tyndall_volumes::{AxisOrder, ByteOrder, Element, GridSelection, RawShape, ReadRequest, VolumeFile};

/// Shape and type of a `.raw` file.
#[derive(Debug, Clone, Default, clap::Args)]
pub struct RawArgs {
    /// Voxels of a .raw file along x, y, z, x changing fastest (else taken from its name, `head_256x256x109_uint8.raw`)
    #[arg(long, value_name = "XxYxZ", value_parser = shape, requires = "raw_type")]
    raw_shape: Option<[u32; 3]>,
    /// Type of its numbers, little-endian: uint8, uint16, int16, float32, …
    #[arg(long, value_name = "TYPE", requires = "raw_shape")]
    raw_type: Option<Element>,
}

impl RawArgs {
    /// Whether the options were given.
    pub fn is_given(&self) -> bool {
        self.raw_shape.is_some()
    }

    /// Writes the options as the keys of a scene.
    pub fn describe(&self, volume: &mut VolumeDescription) -> miette::Result<()> {
        let Some((shape, element)) = self.raw_shape.zip(self.raw_type) else { return Ok(()) };
        let raw_type = match element {
            Element::UInt8 => RawType::U8,
            Element::UInt16 => RawType::U16,
            Element::Int16 => RawType::I16,
            Element::Float16 => RawType::F16,
            Element::Float32 => RawType::F32,
            Element::Float64 => RawType::F64,
            Element::UInt32 | Element::Int8 | Element::Int32 | Element::Bool => {
                return Err(miette!(
                    "--raw-type: scenes have no such type; make a .vdb with `tyndall convert` and render that"
                ));
            }
        };
        volume.raw_shape = Some(shape);
        volume.raw_type = Some(raw_type);
        Ok(())
    }
}

/// Reads grids of a volume file: those with the given names, or all if there are none.
pub fn read(path: &Path, names: &[String], raw: &RawArgs) -> miette::Result<VolumeFile> {
    check_input(path)?;
    let grids = match names {
        [] => GridSelection::All,
        names => GridSelection::Names(names.to_vec()),
    };
    let raw = raw.raw_shape.zip(raw.raw_type).map(|(shape, element)| RawShape {
        shape: shape.map(|edge| edge as usize),
        element,
        byte_order: ByteOrder::Little,
        axis_order: AxisOrder::XFastest,
    });
    tyndall_volumes::read(path, &ReadRequest { grids, raw }).map_err(|error| miette!("{error}"))
}

/// Refuses names of files that do not exist, and folders.
pub fn check_input(path: &Path) -> miette::Result<()> {
    match path.metadata() {
        Ok(metadata) if metadata.is_dir() => {
            Err(miette!("{}: is a folder; give a file in it", path.display()))
        }
        Err(error) if error.kind() == std::io::ErrorKind::NotFound => {
            Err(miette!("{}: there is no such file; check its name and folder", path.display()))
        }
        // Whatever else keeps it from being read shows when it is.
        _ => Ok(()),
    }
}

fn shape(text: &str) -> Result<[u32; 3], String> {
    let edges: Result<Vec<u32>, _> = text.split(['x', 'X']).map(str::parse).collect();
    let edges = edges.ok().and_then(|edges| <[u32; 3]>::try_from(edges).ok());
    edges
        .filter(|edges| !edges.contains(&0))
        .ok_or_else(|| "give three whole numbers such as 256x256x109".into())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_shape_is_three_whole_numbers() {
        assert_eq!(shape("256x128X9"), Ok([256, 128, 9]));
        for wrong in ["", "1x2", "1x2x3x4", "1x-2x3", "axbxc", "0x1x1"] {
            assert!(shape(wrong).is_err(), "{wrong}");
        }
    }
}
