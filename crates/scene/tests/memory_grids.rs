//! Grids in memory stand for files: the same scene, and a hash that holds what is in them.

use std::collections::BTreeMap;
use std::path::Path;

use glam::{DAffine3, DVec3};
use tyndall_optics::mie::MieCache;
use tyndall_scene::{
    BuiltScene, Density, MemoryGrid, SceneDescription, SceneDocument, SceneError, SceneFiles, build,
    build_with, scene_hash_with,
};
use tyndall_volumes::{Grid, GridValues, WriteOptions, tree_of_array};

const SCENE: &str = r#"
    camera = { position = [0, 0, 5], target = [0, 0, 0] }
    volume = [{ file = "a.npy", mu_t = 1, albedo = 0.5, albedo_grid = {} }]
"#;

fn description(text: &str) -> SceneDescription {
    SceneDocument::parse("test", text).unwrap().description().unwrap()
}

/// A slope, `height` at its foot.
fn grid(height: f32) -> Grid {
    let tree = tree_of_array([9, 8, 7], |[x, y, z]| height + (x + 10 * y + 100 * z) as f32).unwrap();
    Grid::in_memory("density", DAffine3::IDENTITY, GridValues::Float(tree))
}

fn in_memory(text: &str, grid: MemoryGrid) -> Result<BuiltScene, SceneError> {
    build_with(&description(text), &files(grid), &MieCache::none())
}

fn files(grid: MemoryGrid) -> SceneFiles {
    SceneFiles { folder: "no/such/folder".into(), grids: BTreeMap::from([("a.npy".into(), grid)]) }
}

fn density_at(built: &BuiltScene, place: DVec3) -> f64 {
    let volume = &built.scene.volumes[0];
    let Density::Grid(bricks) = &volume.density else { panic!("a grid") };
    bricks.value(volume.world_to_local.transform_point3(place))
}

#[test]
fn a_grid_in_memory_is_the_same_volume_as_its_file() {
    let folder = tempfile::tempdir().unwrap();
    tyndall_volumes::write(&folder.path().join("a.npy"), &[grid(1.0)], &WriteOptions::default()).unwrap();
    let from_file = build(&description(SCENE), folder.path()).unwrap();
    let from_memory = in_memory(SCENE, MemoryGrid::new(grid(1.0))).unwrap();
    for place in [DVec3::new(1.0, 2.0, 3.0), DVec3::new(6.3, 2.9, 4.5), DVec3::splat(-3.0)] {
        assert_eq!(density_at(&from_memory, place), density_at(&from_file, place));
    }
    assert_eq!(density_at(&from_memory, DVec3::new(1.0, 2.0, 3.0)), 322.0);
    assert!(from_memory.scene.volumes[0].fields.is_some());
}

#[test]
fn a_scaled_world_has_the_voxels_further_apart() {
    let built = in_memory(SCENE, MemoryGrid::new(grid(0.0)).scaled(1e3)).unwrap();
    assert_eq!(density_at(&built, DVec3::new(1e3, 2e3, 3e3)), 321.0);
}

#[test]
fn the_hash_is_that_of_values_and_place() {
    let hash = |grid| scene_hash_with(&description(SCENE), &files(grid)).unwrap();
    let plain = hash(MemoryGrid::new(grid(1.0)));
    assert_eq!(hash(MemoryGrid::new(Grid { name: "other".into(), ..grid(1.0) })), plain);
    assert_ne!(hash(MemoryGrid::new(grid(2.0))), plain);
    assert_ne!(hash(MemoryGrid::new(grid(1.0)).scaled(2.0)), plain);
    let moved = DAffine3::from_translation(DVec3::X);
    assert_ne!(hash(MemoryGrid::new(Grid { index_to_world: moved, ..grid(1.0) })), plain);
}

#[test]
fn a_grid_of_another_name_is_refused() {
    let text = SCENE.replace("mu_t", "grid = \"heat\", mu_t");
    let error = in_memory(&text, MemoryGrid::new(grid(1.0))).unwrap_err().to_string();
    assert_eq!(error, "a.npy: no grid named `heat`; it is `density`");
    assert!(build(&description(SCENE), Path::new("no/such/folder")).is_err());
}
