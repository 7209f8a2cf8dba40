//! The benchmark scenes say in pbrt's words what the benchmark's table says.

use std::path::PathBuf;

use tempfile::TempDir;
use tyndall_import::{Imported, Sidecar, import_pbrt};
use tyndall_scene::SceneDescription;
use tyndall_scene::description::{LightDescription, Names, PhaseDescription, Projection};

use crate::check;

/// A benchmark scene, unless the benchmark is not beside the checkout. Grids stay while the folder does.
fn bench(name: &str) -> Option<(SceneDescription, TempDir)> {
    let path = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../../../shared/bench/pbrt").join(name);
    if !path.exists() {
        println!("skipped: {} is not there", path.display());
        return None;
    }
    let folder = tempfile::tempdir().unwrap();
    let imported = import_pbrt(&path, &Sidecar::new(folder.path())).unwrap_or_else(|error| panic!("{error}"));
    check(&imported);
    let Imported { description, notes } = imported;
    assert!(notes.is_empty(), "{notes:?}");
    assert_eq!(description.render.max_depth, Some(1000));
    Some((description, folder))
}

#[test]
fn the_clouds_are_grids_without_surfaces() {
    for (name, mu_t, albedo, g, fov) in
        [("A.pbrt", 50.0, 0.999, 0.85, 40.0), ("G.pbrt", 0.25, 0.999, 0.8, 32.0)]
    {
        let Some((scene, _folder)) = bench(name) else { continue };
        assert!(scene.shapes.is_empty() && scene.medium.is_none());
        let medium = &scene.volumes[0].medium;
        let number = |form: &Option<tyndall_scene::description::SpectrumDescription>| {
            form.as_ref().unwrap().coefficient().unwrap().at(550.0)
        };
        let (mu_a, mu_s) = (number(&medium.mu_a), number(&medium.mu_s));
        assert!((mu_a + mu_s - mu_t).abs() < 1e-9 && (mu_s / mu_t - albedo).abs() < 1e-9, "{medium:?}");
        assert_eq!(medium.phase, Some(PhaseDescription::Hg { g }));
        assert_eq!((scene.camera.vertical_fov, scene.camera.window), (fov, None));
        assert!(matches!(scene.lights[..], [LightDescription::Constant(_), LightDescription::Distant(_)]));
    }
}

#[test]
fn the_smoke_stands_over_a_floor() {
    let Some((scene, _folder)) = bench("B.pbrt") else { return };
    assert_eq!((scene.shapes.len(), scene.volumes.len(), scene.lights.len()), (1, 1, 2));
    let LightDescription::Point(light) = &scene.lights[0] else { panic!() };
    assert_eq!((light.position, light.intensity.clone()), ([1.5, 2.5, 1.0], [8.0, 7.0, 5.0].into()));
    assert_eq!(scene.camera.position, [0.0, 1.1, 4.5]);
}

#[test]
fn the_fog_is_a_box_around_the_camera_and_the_room() {
    let Some((scene, _folder)) = bench("C.pbrt") else { return };
    let fog = &scene.volumes[0];
    assert_eq!(fog.cuboid.map(|cuboid| cuboid.max), Some([1.01, 1.01, 4.2]));
    assert_eq!((fog.medium.mu_s.clone(), fog.medium.mu_a.clone()), (Some(0.45.into()), Some(0.03.into())));
    assert!(scene.medium.is_none() && scene.camera.inside.is_none());
    let lamps: Vec<_> = scene.shapes.iter().filter_map(|shape| shape.emission.clone()).collect();
    assert_eq!((scene.shapes.len(), lamps.len()), (6, 1));
    assert_eq!((lamps[0].radiance.clone(), lamps[0].two_sided), ([17.0, 12.0, 4.0].into(), false));
}

#[test]
fn the_fire_is_cut_at_its_box() {
    let Some((scene, _folder)) = bench("D_small.pbrt") else { return };
    let fire = &scene.volumes[0];
    assert_eq!(fire.medium.emission, Some([12.0, 4.5, 1.2].into()));
    assert!(fire.emission_grid.is_some());
    // The glow reaches the floor of its box.
    let cut = scene.shapes.iter().find(|shape| shape.interior.is_some()).expect("a box bounds the fire");
    assert_eq!(
        cut.cuboid.map(|cuboid| (cuboid.min, cuboid.max)),
        Some(([-0.6, 0.001, -0.6], [0.6, 1.8, 0.6]))
    );
    assert_eq!(scene.camera.inside, Some(Names::Several(vec![])));
}

#[test]
fn the_milk_is_a_sphere_and_the_slab_a_box() {
    if let Some((scene, _folder)) = bench("E.pbrt") {
        let milk = &scene.volumes[0];
        assert_eq!(milk.sphere.as_ref().map(|sphere| (sphere.center, sphere.radius)), Some(([0.0; 3], 1.0)));
        assert_eq!(milk.medium.mu_s, Some([2.8, 4.88, 7.6].into()));
    }
    for name in ["F_R.pbrt", "F_T.pbrt"] {
        let Some((scene, _folder)) = bench(name) else { continue };
        assert_eq!(scene.volumes[0].cuboid.map(|cuboid| cuboid.max), Some([250.0, 0.0, 250.0]));
        assert_eq!((scene.camera.projection, scene.camera.height), (Projection::Orthographic, Some(2.0)));
    }
}
