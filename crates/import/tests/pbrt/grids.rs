//! Media that vary from place to place.

use std::path::Path;

use glam::{DAffine3, DVec3};
use tyndall_import::NoteKind;
use tyndall_scene::description::{Names, SpectrumDescription, VolumeDescription};
use tyndall_volumes::{
    BrickGrid, Grid, GridClass, GridSelection, GridValues, LEAF_VOXELS, Leaf, ReadRequest, Storage, Tree,
    WriteOptions,
};

use crate::{Scene, scene_with, world};

/// A cube [0, 1]³ around 4 x 2 x 2 cells, with density in the cells that are listed.
fn uniform(cells: &[usize], rest: &str) -> String {
    let density: String = (0..16).map(|cell| if cells.contains(&cell) { "2 " } else { "0 " }).collect();
    format!(
        "MakeNamedMedium \"smoke\" \"string type\" \"uniformgrid\" \"integer nx\" 4 \"integer ny\" 2 \"integer nz\" 2
         \"float density\" [ {density} ] {rest}\n"
    )
}

const WRAPPED: &str = "MediumInterface \"smoke\" \"\" Material \"interface\"
    Shape \"trianglemesh\" \"point3 P\" [ 0 0 0 1 0 0 1 1 0 0 1 0 0 0 1 1 0 1 1 1 1 0 1 1 ]
    \"integer indices\" [ 0 2 1 0 3 2 4 5 6 4 6 7 0 1 5 0 5 4 3 7 6 3 6 2 0 4 7 0 7 3 1 2 6 1 6 5 ]";

fn read(file: &str) -> Grid {
    let request = ReadRequest { grids: GridSelection::All, raw: None };
    tyndall_volumes::read(file.as_ref(), &request).unwrap().grids.swap_remove(0)
}

/// The interpolated value at a place of the grid's world.
fn value(grid: &Grid, place: DVec3) -> f64 {
    let bricks = BrickGrid::new(grid, Storage::F32).unwrap();
    bricks.value(grid.index_to_world.inverse().transform_point3(place))
}

fn file(volume: &VolumeDescription) -> &str {
    volume.file.as_deref().unwrap()
}

fn volumes(scene: &Scene) -> &[VolumeDescription] {
    &scene.imported.description.volumes
}

#[test]
fn cells_are_values_at_their_centres_and_x_runs_fastest() {
    let scene = world(&format!("{}{WRAPPED}", uniform(&[1, 4], "")));
    let grid = read(file(&volumes(&scene)[0]));
    let at = |x: f64, y: f64, z: f64| value(&grid, DVec3::new(x, y, z));
    assert!((at(0.375, 0.25, 0.25) - 2.0).abs() < 1e-6);
    assert!((at(0.125, 0.75, 0.25) - 2.0).abs() < 1e-6);
    // Halfway to a cell of 0.
    assert!((at(0.5, 0.25, 0.25) - 1.0).abs() < 1e-6);
    assert_eq!(at(0.875, 0.25, 0.25), 0.0);
}

#[test]
fn a_grid_is_cut_where_its_box_ends_unless_it_is_0_there() {
    let scene = world(&format!("{}{WRAPPED}", uniform(&[1], "")));
    let shapes = &scene.imported.description.shapes;
    let cuboid = shapes[0].cuboid.unwrap();
    assert_eq!((cuboid.min, cuboid.max), ([0.0; 3], [1.0; 3]));
    assert_eq!(shapes[0].interior, Some(Names::One("smoke".to_owned())));

    // Four cells a side with matter in the inner ones alone, the box around them twice as large: nothing to cut.
    let inner: String =
        (0..64)
            .map(|cell| {
                if [cell % 4, cell / 4 % 4, cell / 16].iter().all(|i| (1..3).contains(i)) {
                    "1 "
                } else {
                    "0 "
                }
            })
            .collect();
    let text = format!(
        "MakeNamedMedium \"smoke\" \"string type\" \"uniformgrid\" \"integer nx\" 4 \"integer ny\" 4 \"integer nz\" 4
         \"float density\" [ {inner} ] {WRAPPED}"
    );
    let scene = world(&text);
    assert!(
        scene.imported.description.shapes.is_empty() && scene.imported.description.camera.inside.is_none()
    );
}

#[test]
fn the_transform_of_the_medium_and_that_of_the_box_are_two() {
    let grid = uniform(&[0, 15], "\"point3 p0\" [ -1 -1 -1 ] \"point3 p1\" [ 1 1 1 ]");
    // In the medium's space the box reaches from -1 to 0 along x: half the grid.
    let text = format!("AttributeBegin Translate 5 0 0 {grid} AttributeEnd Translate 4 -0.5 -0.5 {WRAPPED}");
    let scene = world(&text);
    let description = &scene.imported.description;
    assert_eq!(description.volumes[0].transform.as_ref().unwrap().translate, Some([5.0, 0.0, 0.0]));
    let cuboid = description.shapes[0].cuboid.unwrap();
    assert_eq!((cuboid.min, cuboid.max), ([4.0, -0.5, -0.5], [5.0, 0.5, 0.5]));
}

#[test]
fn a_grid_glows_by_its_light_times_the_glow_of_each_cell() {
    let glow: String = (0..16).map(|cell| format!("{cell} ")).collect();
    let rest = format!("\"rgb Le\" [ 3 2 1 ] \"float Lescale\" [ {glow} ] \"rgb sigma_a\" [ 4 4 4 ]");
    let scene = world(&format!("{}{WRAPPED}", uniform(&[1], &rest)));
    let volume = &volumes(&scene)[0];
    assert_eq!(volume.medium.emission, Some([3.0, 2.0, 1.0].into()));
    assert_eq!(volume.medium.mu_a, Some(4.0.into()));
    let glow = read(volume.emission_grid.as_ref().unwrap().file.as_deref().unwrap());
    assert!((value(&glow, DVec3::new(0.875, 0.75, 0.75)) - 15.0).abs() < 1e-6);
}

#[test]
fn temperatures_are_normalised_black_bodies() {
    let kelvin: String = (0..16).map(|_| "2000 ").collect();
    let rest = format!(
        "\"float temperature\" [ {kelvin} ] \"float temperatureoffset\" 300 \"float temperaturescale\" 2"
    );
    let scene = world(&format!("{}{WRAPPED}", uniform(&[1], &rest)));
    let volume = &volumes(&scene)[0];
    let temperature = volume.temperature.as_ref().unwrap();
    assert_eq!((temperature.scale, temperature.offset, temperature.normalised), (2.0, -600.0, true));
    // pbrt's film does not divide by the integral of the observer's y.
    assert!((volume.emission_scale.unwrap() - 106.857).abs() < 1e-3);
}

#[test]
fn an_rgbgrid_of_one_hue_is_one_volume_and_of_several_one_for_each_channel() {
    let grid = |a: &str, s: &str| {
        format!(
            "MakeNamedMedium \"smoke\" \"string type\" \"rgbgrid\" \"integer nx\" 2 \"rgb sigma_a\" [ {a} ]
             \"rgb sigma_s\" [ {s} ] \"float scale\" 5 \"float g\" 0.3 {WRAPPED}"
        )
    };
    let scene = world(&grid("1 2 3 2 4 6", "3 3 3 6 6 6"));
    assert_eq!(volumes(&scene).len(), 1);
    let volume = &volumes(&scene)[0];
    let at = |grid: &Grid, x: f64| value(grid, DVec3::new(x, 0.5, 0.5));
    let density = at(&read(file(volume)), 0.75);
    let channels = |spectrum: &Option<SpectrumDescription>| match spectrum {
        Some(SpectrumDescription::Grey(grey)) => [*grey; 3],
        Some(SpectrumDescription::Channels(channels)) => *channels,
        other => panic!("{other:?}"),
    };
    let near = |a: [f64; 3], b: [f64; 3]| a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-5);
    assert!(near(channels(&volume.medium.mu_a).map(|mu| mu * density), [2.0, 4.0, 6.0]), "{volume:?}");
    assert!(near(channels(&volume.medium.mu_s).map(|mu| mu * density), [6.0; 3]));
    assert_eq!(volume.medium.scale, Some(5.0));

    let scene = world(&grid("0 0 0 0 0 0", "1 0 0 0 1 0"));
    let names: Vec<&str> = volumes(&scene).iter().filter_map(|volume| volume.name.as_deref()).collect();
    assert_eq!(names, ["smoke", "smoke 2"], "red and green scatter, blue does not");
    let interior = scene.imported.description.shapes[0].interior.clone();
    assert_eq!(interior, Some(Names::Several(vec!["smoke".to_owned(), "smoke 2".to_owned()])));
    let [red, green] = volumes(&scene) else { panic!() };
    assert_eq!(
        (channels(&red.medium.mu_s), channels(&green.medium.mu_s)),
        ([1.0, 0.0, 0.0], [0.0, 1.0, 0.0])
    );
    assert!((at(&read(file(red)), 0.25) - 1.0).abs() < 1e-6 && at(&read(file(green)), 0.25) < 1e-6);
}

#[test]
fn what_an_rgbgrid_does_not_say_is_1_in_its_box() {
    let scene = world(&format!(
        "MakeNamedMedium \"smoke\" \"string type\" \"rgbgrid\" \"rgb sigma_a\" [ 1 2 3 ] \"rgb Le\" [ 1 1 1 ] {WRAPPED}"
    ));
    let [absorbing, scattering] = volumes(&scene) else { panic!("{:?}", volumes(&scene)) };
    assert!(absorbing.emission_grid.is_some() && scattering.cuboid.is_some());
    assert_eq!(
        (scattering.medium.mu_a.clone(), scattering.medium.mu_s.clone()),
        (Some(0.0.into()), Some(1.0.into()))
    );
}

#[test]
fn a_cloud_is_a_grid_of_its_noise_in_its_box() {
    let scene = world(&format!(
        "MakeNamedMedium \"smoke\" \"string type\" \"cloud\" \"point3 p1\" [ 1 0.1 0.1 ] \"float density\" 2 {WRAPPED}"
    ));
    let cuboid = scene.imported.description.shapes[0].cuboid.unwrap();
    assert_eq!((cuboid.min, cuboid.max), ([0.0; 3], [1.0, 0.1, 0.1]));
    // At the bottom a cloud is solid, but for half a cell's worth of its thinning with height.
    let bottom = value(&read(file(&volumes(&scene)[0])), DVec3::new(0.5, 0.0, 0.05));
    assert!((bottom - 1.0).abs() < 0.005, "{bottom}");
    assert!(scene.notes(NoteKind::Choice)[0].contains("194 x 22 x 22"), "{:?}", scene.imported.notes);
}

/// A grid with one voxel that is 1.
fn voxel(name: &str, value: f32) -> Grid {
    let mut leaf_values = vec![0.0; LEAF_VOXELS];
    let (x, y, z) = (3, 4, 5);
    leaf_values[x << 6 | y << 3 | z] = value;
    let mut active = [0; 8];
    active[x] = 1 << (y << 3 | z);
    Grid {
        name: name.to_owned(),
        class: GridClass::FogVolume,
        index_to_world: DAffine3::from_scale(DVec3::splat(0.1)),
        saved_as_half: false,
        codec: String::new(),
        metadata: Vec::new(),
        values: GridValues::Float(Tree {
            background: 0.0,
            tiles: Vec::new(),
            leaves: vec![Leaf { origin: [0; 3], active }],
            leaf_values,
        }),
    }
}

fn nano(rest: &str) -> Scene {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("fire.nvdb");
    let grids = [voxel("density", 1.0), voxel("temperature", 0.5)];
    tyndall_volumes::write(&path, &grids, &WriteOptions::default()).unwrap();
    let content = std::fs::read(Path::new(&path)).unwrap();
    let text = format!(
        "WorldBegin MakeNamedMedium \"smoke\" \"string type\" \"nanovdb\" \"string filename\" \"fire.nvdb\" {rest} {WRAPPED}"
    );
    scene_with(&text, &[("fire.nvdb", &content)])
}

#[test]
fn a_nanovdb_file_is_used_as_it_is_with_its_temperatures() {
    let scene = nano("\"float Lescale\" 2 \"float temperaturescale\" 1000");
    let volume = &volumes(&scene)[0];
    assert_eq!(volume.file, Some(scene.path("fire.nvdb")));
    assert_eq!(volume.grid.as_deref(), Some("density"));
    let temperature = volume.temperature.as_ref().unwrap();
    assert_eq!((temperature.grid.as_deref(), temperature.scale), (Some("temperature"), 1000.0));
    assert!((volume.emission_scale.unwrap() - 2.0 * 106.857).abs() < 1e-2);
    // The voxel at (0.3, 0.4, 0.5) and its slopes are within the box: no surface is needed.
    assert!(scene.imported.description.shapes.is_empty());
    assert!(volumes(&nano("\"string temperaturename\" \"none\""))[0].temperature.is_none());
}
