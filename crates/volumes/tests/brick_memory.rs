//! Memory of brick grids built from real files; skipped where the folder of volumes is not there.

use std::path::{Path, PathBuf};
use tyndall_volumes::{BrickGrid, Grid, GridValues, ReadRequest, Storage, read};

fn grid(file: &str) -> Option<Grid> {
    let folder: PathBuf = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/volumes");
    if !folder.is_dir() {
        eprintln!("skipped: there is no folder ../shared/volumes beside the checkout");
        return None;
    }
    let grids = read(&folder.join(file), &ReadRequest::default()).unwrap().grids;
    Some(grids.into_iter().next().unwrap())
}

#[test]
fn memory_stays_near_the_bricks() {
    for file in ["wdas_cloud_sixteenth.vdb", "smoke1.vdb", "dragon.vdb", "nebula_density_nozip.nvdb"] {
        let Some(grid) = grid(file) else { return };
        for (storage, voxel_bytes) in [(Storage::U8, 1), (Storage::F16, 2), (Storage::F32, 4)] {
            let bricks = BrickGrid::new(&grid, storage).unwrap();
            let ratio = bricks.memory_bytes() as f64 / (bricks.brick_count() * 512 * voxel_bytes) as f64;
            println!("{file} {storage:?}: {} bricks, {ratio:.3} times their values", bricks.brick_count());
            assert!(ratio < 1.5, "{file} {storage:?}: {ratio}");
        }
    }
}

/// Also where bricks are ragged: in these files 62 %, 66 %, 77 % and 29 % of the voxels of bricks are active.
#[test]
fn bytes_take_little_more_than_one_an_active_voxel() {
    for (file, most) in [
        ("wdas_cloud_sixteenth.vdb", 1.3),
        ("smoke1.vdb", 1.3),
        ("nebula_density_nozip.nvdb", 1.3),
        ("dragon.vdb", 2.0),
    ] {
        let Some(grid) = grid(file) else { return };
        let GridValues::Float(tree) = &grid.values else { panic!("{file} holds no floats") };
        let words = tree.leaves.iter().flat_map(|leaf| leaf.active);
        let active: u64 = words.map(|word| u64::from(word.count_ones())).sum();
        let bytes = BrickGrid::new(&grid, Storage::U8).unwrap().memory_bytes() as f64 / active as f64;
        println!("{file}: {bytes:.3} bytes an active voxel");
        assert!((0.8..most).contains(&bytes), "{file}: {bytes}");
    }
}

/// 69 billion active voxels, all of them in tiles.
#[test]
fn tiles_are_not_filled_with_bricks() {
    let Some(grid) = grid("variants/tiles_only.vdb") else { return };
    let bricks = BrickGrid::new(&grid, Storage::F16).unwrap();
    assert!(bricks.memory_bytes() < 8 << 20, "{} bytes", bricks.memory_bytes());
}
