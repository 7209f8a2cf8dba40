//! Memory of brick grids built from real files; skipped where the folder of volumes is not there.

use std::path::{Path, PathBuf};
use tyndall_volumes::{BrickGrid, Grid, ReadRequest, Storage, read};

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

/// 69 billion active voxels, all of them in tiles.
#[test]
fn tiles_are_not_filled_with_bricks() {
    let Some(grid) = grid("variants/tiles_only.vdb") else { return };
    let bricks = BrickGrid::new(&grid, Storage::F16).unwrap();
    assert!(bricks.memory_bytes() < 8 << 20, "{} bytes", bricks.memory_bytes());
}
