//! What is opened, on the command line: options for `.raw` volumes and for scenes of other renderers.

use std::path::Path;

use miette::miette;
use tyndall_session::{Frames, ImportOptions, Input, InputOptions, RawVolume, SessionError};
use tyndall_volumes::Element;

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
    /// What the options say, if they were given.
    pub fn volume(&self) -> Option<RawVolume> {
        let (shape, element) = self.raw_shape.zip(self.raw_type)?;
        Some(RawVolume { shape, element })
    }
}

/// Options for scenes of other renderers
#[derive(Debug, Clone, Default, clap::Args)]
pub struct ImportArgs {
    /// Refuse a .pbrt or .xml scene of which something is not supported
    #[arg(long)]
    strict: bool,
    /// What `$NAME` stands for in a Mitsuba scene; may be given several times
    #[arg(short = 'D', long, value_name = "NAME=VALUE", value_parser = parse_define)]
    define: Vec<(String, String)>,
}

impl ImportArgs {
    /// As the session takes them.
    pub fn options(&self) -> ImportOptions {
        ImportOptions { strict: self.strict, define: self.define.clone() }
    }
}

/// Opens `path`, or the built-in scene, and applies `overrides` of the form `key=value`.
pub fn open(
    path: Option<&Path>,
    overrides: &[String],
    raw: &RawArgs,
    import: &ImportArgs,
) -> Result<Input, SessionError> {
    let Some(path) = path else { return Input::built_in(overrides) };
    Input::open(path, &options(overrides, raw, import, None))
}

/// Opens `path` at the first of some frames.
pub fn open_frames(
    path: Option<&Path>,
    overrides: &[String],
    raw: &RawArgs,
    import: &ImportArgs,
    frames: Frames,
) -> miette::Result<Input> {
    let Some(path) = path else {
        return Err(miette!(
            "--frames: the built-in scene has one picture; name a scene or a volume such as smoke.####.vdb"
        ));
    };
    Ok(Input::open(path, &options(overrides, raw, import, Some(frames.first())))?)
}

fn options(overrides: &[String], raw: &RawArgs, import: &ImportArgs, frame: Option<u32>) -> InputOptions {
    InputOptions { overrides: overrides.to_vec(), raw: raw.volume(), import: import.options(), frame }
}

fn shape(text: &str) -> Result<[u32; 3], String> {
    let edges: Result<Vec<u32>, _> = text.split(['x', 'X']).map(str::parse).collect();
    let edges = edges.ok().and_then(|edges| <[u32; 3]>::try_from(edges).ok());
    edges
        .filter(|edges| !edges.contains(&0))
        .ok_or_else(|| "give three whole numbers such as 256x256x109".into())
}

fn parse_define(text: &str) -> Result<(String, String), String> {
    let pair = text.split_once('=').filter(|(name, _)| !name.is_empty());
    pair.map(|(name, value)| (name.to_owned(), value.to_owned())).ok_or("write NAME=VALUE".into())
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

    #[test]
    fn a_definition_is_a_name_and_a_value_that_may_be_empty() {
        assert_eq!(parse_define("spp=4=4"), Ok(("spp".into(), "4=4".into())));
        assert_eq!(parse_define("spp="), Ok(("spp".into(), String::new())));
        assert!(parse_define("=4").is_err() && parse_define("spp").is_err());
    }
}
