//! `tyndall convert`: a volume file in another format, or a scene of another renderer as Tyndall's own.

mod scene;

use std::path::{Path, PathBuf};

use miette::{bail, miette};
use tyndall_session::{check_not_same, check_writable, is_foreign, read_volume};
use tyndall_volumes::{Codec, Format, WriteOptions};

use crate::input_args::{ImportArgs, RawArgs};
use crate::terminal::{answer, tell};

/// Write a volume in another format, chosen by the extension, or a scene of pbrt or Mitsuba as a scene file
///
/// .vdb and .nvdb hold any number of sparse grids as they are. The others hold one dense array: the box around the
/// active voxels of one grid, as 32-bit floats. A scene (.pbrt .xml) becomes a .toml; meshes and grids that it writes out
/// itself become files in a folder beside it.
#[derive(Debug, clap::Args)]
#[command(after_help = "\
Examples:
  tyndall convert smoke.nvdb smoke.vdb
  tyndall convert fire.vdb fire_half.vdb --grid density --grid temperature --half --codec zip
  tyndall convert fire.vdb density.npy --grid density
  tyndall convert scene.pbrt scene.toml
  tyndall convert head.raw head.vdb --raw-shape 256x256x109 --raw-type uint8")]
pub struct Args {
    /// A volume: .vdb .nvdb .vol .npy .nii .nii.gz .raw; or a scene: .pbrt .xml
    input: PathBuf,
    /// Where to write it, with one of these extensions
    output: PathBuf,
    /// Only this grid; may be given several times
    #[arg(long, value_name = "NAME")]
    grid: Vec<String>,
    /// Round values to 16-bit floats (.vdb)
    #[arg(long)]
    half: bool,
    /// Compression of .vdb (default blosc) and .nvdb (default zip, which every NanoVDB reads)
    #[arg(long, value_enum)]
    codec: Option<CodecName>,
    #[command(flatten)]
    raw: RawArgs,
    #[command(flatten)]
    import: ImportArgs,
}

#[derive(Debug, Clone, Copy, clap::ValueEnum)]
enum CodecName {
    /// Largest, fastest
    None,
    /// Smallest, slowest
    Zip,
    /// LZ4 of shuffled bytes: nearly as small, fast
    Blosc,
}

/// Reads, writes, and says what was written.
pub fn run(args: Args) -> miette::Result<()> {
    let is_scene_file = |path: &Path| path.extension().is_some_and(|e| e.eq_ignore_ascii_case("toml"));
    if is_foreign(&args.input) || is_scene_file(&args.input) || is_scene_file(&args.output) {
        if !is_foreign(&args.input) || !is_scene_file(&args.output) {
            bail!(
                "{} to {}: only scenes of pbrt and Mitsuba (.pbrt .xml) become scene files (.toml); `tyndall render \
                 --print-scene` prints the scene of a volume or a .toml",
                args.input.display(),
                args.output.display()
            );
        }
        if !args.grid.is_empty() || args.half || args.codec.is_some() || args.raw.volume().is_some() {
            bail!("{}: --grid, --half, --codec and --raw-shape are for volumes", args.input.display());
        }
        return scene::convert(&args.input, &args.output, &args.import);
    }
    args.import.options().refuse(&args.input)?;
    let format = Format::from_extension(&args.output);
    if args.codec.is_some() && !matches!(format, Some(Format::OpenVdb | Format::NanoVdb)) {
        bail!("{}: --codec is for .vdb and .nvdb; leave it out", args.output.display());
    }
    let codec = match args.codec {
        Some(CodecName::None) => Codec::None,
        Some(CodecName::Zip) => Codec::Zip,
        Some(CodecName::Blosc) => Codec::Blosc,
        None if format == Some(Format::NanoVdb) => Codec::Zip,
        None => Codec::default(),
    };
    check_writable([args.output.as_path()])?;
    check_not_same(&args.output, &args.input)?;
    let file = read_volume(&args.input, &args.grid, args.raw.volume())?;
    for (name, why) in &file.skipped {
        tell(format!("note: grid `{name}` is left out: {why}"));
    }
    let written = tyndall_volumes::write(&args.output, &file.grids, &WriteOptions { codec, half: args.half })
        .map_err(|error| miette!("{error}"))?;
    let names: Vec<String> = file.grids.iter().map(|grid| format!("`{}`", grid.name)).collect();
    answer(format!("wrote {} with {}\n", written.display(), names.join(", ")))
}
