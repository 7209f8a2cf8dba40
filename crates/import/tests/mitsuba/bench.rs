//! The scenes of the benchmark.

use std::fs;

use tyndall_import::Imported;
use tyndall_scene::description::{LightDescription, MaterialChoice, MaterialDescription, PhaseDescription};

use crate::support::*;

/// A scene of the benchmark with a grid in the place of its own.
fn bench(name: &str) -> Option<(Folder, Imported)> {
    let scene = fs::read(bench_folder()?.join(name)).unwrap();
    let mut grid = vec![0.0; 5 * 5 * 5];
    grid[62] = 1.0;
    let cloud = volume([5; 3], 1, [[-1.0, -0.7, -1.0], [1.0, 0.7, 1.0]], &grid);
    let smoke = volume([5; 3], 1, [[-0.5, 0.0, -0.5], [0.5, 2.0, 0.5]], &grid);
    let wdas = volume([5; 3], 1, [[-225.0, -75.0, -305.0], [201.0, 218.0, 215.0]], &grid);
    let files: [(&str, &[u8]); 4] =
        [("mitsuba/scene.xml", &scene), ("cloud.vol", &cloud), ("smoke.vol", &smoke), ("wdas.vol", &wdas)];
    let folder = Folder::with(&files);
    let imported = folder.import_file("mitsuba/scene.xml", &[]).unwrap_or_else(|error| panic!("{error}"));
    assert_sound(&imported.description);
    assert_silent(&imported);
    Some((folder, imported))
}

#[test]
fn a_the_cloud_is_its_grid_alone() {
    let Some((folder, imported)) = bench("A_cloud.xml") else { return };
    let scene = imported.description;
    assert!(scene.shapes.is_empty(), "{:?}", scene.shapes);
    let [cloud] = &scene.volumes[..] else { panic!("{:?}", scene.volumes) };
    let file = folder.0.path().canonicalize().unwrap().join("cloud.vol");
    assert_eq!(cloud.file.as_deref(), file.to_str());
    assert_eq!(
        (cloud.medium.mu_t.clone(), cloud.medium.albedo.clone()),
        (Some(50.0.into()), Some(0.999.into()))
    );
    assert_eq!(cloud.medium.phase, Some(PhaseDescription::Hg { g: 0.85 }));
    assert_eq!(cloud.transform, None);
    let camera = scene.camera;
    assert_eq!(
        (camera.position, camera.target, camera.up),
        ([0.0, 0.3, 3.4], Some([0.0; 3]), [0.0, 1.0, 0.0])
    );
    assert_eq!((camera.vertical_fov, camera.window, camera.inside), (40.0, None, None));
    assert_eq!((scene.film.resolution, scene.render.spp, scene.render.max_depth), ([256, 256], 16, None));
    let [LightDescription::Constant(sky), LightDescription::Distant(sun)] = &scene.lights[..] else {
        panic!()
    };
    assert_eq!(sky.radiance, [0.5, 0.7, 1.0].into());
    assert_eq!((sun.direction, sun.irradiance.clone()), ([-0.5, -1.0, -0.3], [5.0, 4.7, 4.2].into()));
}

#[test]
fn b_the_smoke_stands_over_a_floor() {
    let Some((_, imported)) = bench("B_smoke.xml") else { return };
    let scene = imported.description;
    let [floor] = &scene.shapes[..] else { panic!("{:?}", scene.shapes) };
    let rectangle = floor.rectangle.unwrap();
    assert_eq!(
        (rectangle.corner, rectangle.u, rectangle.v),
        ([-4.0, 0.0, 4.0], [8.0, 0.0, 0.0], [0.0, 0.0, -8.0])
    );
    assert_eq!(floor.material, Some(here(MaterialDescription::Diffuse { reflectance: 0.5.into() })));
    assert_eq!(scene.volumes[0].medium.phase, None);
    let [LightDescription::Point(first), LightDescription::Point(_)] = &scene.lights[..] else { panic!() };
    assert_eq!((first.position, first.intensity.clone()), ([1.5, 2.5, 1.0], [8.0, 7.0, 5.0].into()));
}

#[test]
fn c_the_fog_is_a_box_of_its_own_and_the_lamp_faces_down() {
    let Some((_, imported)) = bench("C_fogbox.xml") else { return };
    let scene = imported.description;
    let fog = scene.volumes[0].clone();
    let cuboid = fog.cuboid.unwrap();
    assert!(near(cuboid.min, [-1.01; 3]) && near(cuboid.max, [1.01, 1.01, 4.2]), "{cuboid:?}");
    assert_eq!((fog.medium.mu_t, fog.medium.albedo), (Some(0.48.into()), Some(0.9375.into())));
    assert_eq!(scene.camera.inside, None);
    assert_eq!(scene.shapes.len(), 6);
    let inward = [
        [1.0, 0.0, 0.0],
        [-1.0, 0.0, 0.0],
        [0.0, 1.0, 0.0],
        [0.0, -1.0, 0.0],
        [0.0, 0.0, 1.0],
        [0.0, -1.0, 0.0],
    ];
    for (shape, expected) in scene.shapes.iter().zip(inward) {
        assert!(near(rectangle_normal(shape), expected), "{shape:?}");
    }
    let lamp = &scene.shapes[5];
    let emission = lamp.emission.clone().unwrap();
    assert_eq!((emission.radiance, emission.two_sided, lamp.flip), ([17.0, 12.0, 4.0].into(), false, false));
    assert_eq!(lamp.rectangle.unwrap().corner, [-0.25, 0.99, -0.25]);
    let Some(MaterialChoice::Here(red)) = &scene.shapes[0].material else { panic!() };
    assert_eq!(**red, MaterialDescription::Diffuse { reflectance: [0.63, 0.065, 0.05].into() });
}

#[test]
fn e_the_milk_is_a_ball_of_its_own() {
    let Some((_, imported)) = bench("E_milk.xml") else { return };
    let scene = imported.description;
    assert!(scene.shapes.is_empty());
    let milk = &scene.volumes[0];
    assert_eq!(milk.sphere.map(|sphere| (sphere.center, sphere.radius)), Some(([0.0; 3], 1.0)));
    assert_eq!(milk.medium.mu_t, Some([8.0 * 0.3507, 8.0 * 0.61125, 8.0 * 0.9571].into()));
    assert_eq!(milk.medium.scale, None);
}

#[test]
fn f_the_slab_is_seen_from_above_and_from_below() {
    for (name, height) in [("F_slab_R.xml", 2.0), ("F_slab_T.xml", -2.0)] {
        let Some((_, imported)) = bench(name) else { return };
        let scene = imported.description;
        assert_eq!(scene.volumes[0].cuboid.map(|cuboid| cuboid.max), Some([250.0, 1.0, 250.0]));
        let camera = scene.camera;
        assert_eq!((camera.position, camera.target), ([0.0, height, 0.0], Some([0.0; 3])));
        // The film is 2 units wide, under a scale of 0.01.
        assert!((camera.height.unwrap() - 0.02).abs() < 1e-15 && camera.window.is_none());
        assert_eq!(scene.film.resolution, [64, 64]);
        assert!(near(rectangle_normal(&scene.shapes[0]), [0.0, -1.0, 0.0]));
    }
}

#[test]
fn g_the_large_cloud_keeps_its_place() {
    let Some((_, imported)) = bench("G_wdas.xml") else { return };
    let scene = imported.description;
    assert!(scene.shapes.is_empty(), "{:?}", scene.shapes);
    assert_eq!(scene.volumes[0].medium.mu_t, Some(0.25.into()));
    assert_eq!(scene.camera.target, Some([-11.67, 66.0, -45.0]));
}

#[test]
fn parameters_from_outside_take_the_place_of_defaults() {
    let Some(folder) = bench_folder() else { return };
    let scene = fs::read(folder.join("E_milk.xml")).unwrap();
    let folder = Folder::with(&[("scene.xml", &scene)]);
    let imported = folder.import_with(&[("spp", "1024"), ("md", "5"), ("res", "128")]).unwrap();
    let scene = imported.description;
    assert_eq!((scene.render.spp, scene.render.max_depth), (1024, Some(4)));
    assert_eq!(scene.film.resolution, [128, 128]);
}
