//! `tyndall inspect`: what is in a volume file or a scene.

mod contents;
mod report;
mod scene;
mod table;

use std::path::PathBuf;

use miette::{IntoDiagnostic, miette};
use tyndall_session::{is_foreign, read_volume};

use crate::input_args::{ImportArgs, RawArgs, open};
use crate::terminal::answer;
use report::Report;

/// Tell what is in a volume file or a scene: grids, types, boxes, ranges, memory, optical thickness
#[derive(Debug, clap::Args)]
#[command(after_help = "\
Examples:
  tyndall inspect smoke.vdb
  tyndall inspect smoke.vdb --grid density --probe=10,-3,7 --json
  tyndall inspect cloud.toml
  tyndall inspect scene.pbrt --strict
  tyndall inspect head.raw --raw-shape 256x256x109 --raw-type uint8")]
pub struct Args {
    /// A volume (.vdb .nvdb .vol .npy .nii .nii.gz .raw) or a scene (.toml, or .pbrt and Mitsuba's .xml)
    file: PathBuf,
    /// Only this grid; may be given several times
    #[arg(long, value_name = "NAME")]
    grid: Vec<String>,
    /// Tell the value of the voxel at these index coordinates too; may be given several times
    #[arg(long, value_name = "I,J,K", value_parser = voxel, allow_hyphen_values = true)]
    probe: Vec<[i32; 3]>,
    /// Answer in JSON
    #[arg(long)]
    json: bool,
    #[command(flatten)]
    raw: RawArgs,
    #[command(flatten)]
    import: ImportArgs,
}

/// Reads and prints.
pub fn run(args: Args) -> miette::Result<()> {
    let is_native = args.file.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("toml"));
    if is_native || is_foreign(&args.file) {
        return inspect_scene(&args);
    }
    args.import.options().refuse(&args.file)?;
    let file = read_volume(&args.file, &args.grid, args.raw.volume())?;
    let report = Report::new(&file, &args.probe);
    if args.json {
        answer(serde_json::to_string(&report).into_diagnostic()? + "\n")
    } else {
        answer(table::table(&args.file, &report))
    }
}

fn inspect_scene(args: &Args) -> miette::Result<()> {
    if !args.grid.is_empty() || !args.probe.is_empty() {
        return Err(miette!(
            "{}: --grid and --probe are for volume files; inspect the file that the scene names",
            args.file.display()
        ));
    }
    let input = open(Some(&args.file), &[], &args.raw, &args.import)?;
    let report = scene::SceneReport::new(&input)?;
    if args.json {
        answer(serde_json::to_string(&report).into_diagnostic()? + "\n")
    } else {
        answer(scene::text(&input, &report))
    }
}

fn voxel(text: &str) -> Result<[i32; 3], String> {
    let indices: Result<Vec<i32>, _> = text.split(',').map(|index| index.trim().parse()).collect();
    let indices = indices.ok().and_then(|indices| <[i32; 3]>::try_from(indices).ok());
    indices.ok_or_else(|| "give three whole numbers such as 10,-3,7".into())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_voxel_is_three_whole_numbers_of_either_sign() {
        assert_eq!(voxel("-1,2,-2147483648"), Ok([-1, 2, i32::MIN]));
        for wrong in ["1,2", "1,2,3,4", "1,2,x", "1,2,2147483648"] {
            assert!(voxel(wrong).is_err(), "{wrong}");
        }
    }
}
