//! Volume files on the command line: what a `.raw` file does not say about itself comes from options.

use std::path::Path;

use miette::miette;
use tyndall_volumes::{AxisOrder, ByteOrder, Element, GridSelection, RawShape, ReadRequest, VolumeFile};

/// Shape and type of a `.raw` file.
#[derive(Debug, Clone, clap::Args)]
pub struct RawArgs {
    /// Voxels of a .raw file along x, y, z, x changing fastest (else taken from its name, `head_256x256x109_uint8.raw`)
    #[arg(long, value_name = "XxYxZ", value_parser = shape, requires = "raw_type")]
    raw_shape: Option<[usize; 3]>,
    /// Type of its numbers, little-endian: uint8, uint16, int16, float32, …
    #[arg(long, value_name = "TYPE", requires = "raw_shape")]
    raw_type: Option<Element>,
}

/// Reads grids of a volume file: those with the given names, or all if there are none.
pub fn read(path: &Path, names: &[String], raw: &RawArgs) -> miette::Result<VolumeFile> {
    let grids = match names {
        [] => GridSelection::All,
        names => GridSelection::Names(names.to_vec()),
    };
    let raw = raw.raw_shape.zip(raw.raw_type).map(|(shape, element)| RawShape {
        shape,
        element,
        byte_order: ByteOrder::Little,
        axis_order: AxisOrder::XFastest,
    });
    tyndall_volumes::read(path, &ReadRequest { grids, raw }).map_err(|error| miette!("{error}"))
}

fn shape(text: &str) -> Result<[usize; 3], String> {
    let edges: Result<Vec<usize>, _> = text.split(['x', 'X']).map(str::parse).collect();
    let edges = edges.ok().and_then(|edges| <[usize; 3]>::try_from(edges).ok());
    edges.ok_or_else(|| "give three whole numbers such as 256x256x109".into())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_shape_is_three_whole_numbers() {
        assert_eq!(shape("256x128X9"), Ok([256, 128, 9]));
        for wrong in ["", "1x2", "1x2x3x4", "1x-2x3", "axbxc"] {
            assert!(shape(wrong).is_err(), "{wrong}");
        }
    }
}
