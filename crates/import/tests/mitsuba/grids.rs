//! Grids stand where Mitsuba has them, with its values up to the faces of their box.

use glam::{DAffine3, DVec3};
use tyndall_import::Imported;
use tyndall_scene::SceneDescription;
use tyndall_scene::description::{GridFilter, SpectrumDescription, VolumeDescription};
use tyndall_volumes::{BrickGrid, Filter, GridValues, ReadRequest, Storage};

use crate::support::*;

const CELLS: [i32; 3] = [3, 4, 5];
const CORNERS: [[f32; 3]; 2] = [[-1.0, 0.0, 2.0], [2.0, 2.0, 7.0]];

/// Values that differ, with x fastest; 0 at the border if asked.
fn values(ends_in_zero: bool) -> Vec<f32> {
    let [x, y, z] = CELLS;
    let cells = (0..z).flat_map(move |k| (0..y).flat_map(move |j| (0..x).map(move |i| [i, j, k])));
    cells
        .map(|cell| {
            let is_border = (0..3).any(|axis| cell[axis] == 0 || cell[axis] == CELLS[axis] - 1);
            let value = 1.0 + cell[0] as f32 * 0.5 + cell[1] as f32 * 2.0 + cell[2] as f32 * 0.25;
            if is_border && ends_in_zero { 0.0 } else { value }
        })
        .collect()
}

/// What Mitsuba looks up at a point of the unit cube.
fn expected(values: &[f32], point: DVec3, filter: GridFilter) -> f64 {
    let at = |cell: [i32; 3]| {
        let [x, y, z] = std::array::from_fn(|axis| cell[axis].clamp(0, CELLS[axis] - 1));
        f64::from(values[((z * CELLS[1] + y) * CELLS[0] + x) as usize])
    };
    let place = point * DVec3::from_array(CELLS.map(f64::from));
    if filter == GridFilter::Nearest {
        return at(place.floor().to_array().map(|x| x as i32));
    }
    let (low, share) = ((place - 0.5).floor(), (place - 0.5) - (place - 0.5).floor());
    let mut sum = 0.0;
    for corner in 0..8 {
        let bit = |axis: usize| corner >> axis & 1;
        let weight: f64 =
            (0..3).map(|axis| if bit(axis) == 1 { share[axis] } else { 1.0 - share[axis] }).product();
        sum += weight * at(std::array::from_fn(|axis| low[axis] as i32 + bit(axis)));
    }
    sum
}

/// What Tyndall looks up at a point of the world, where a file stands in a volume.
fn found(file: &str, grid: usize, volume: &VolumeDescription, point: DVec3) -> f64 {
    let read = tyndall_volumes::read(file.as_ref(), &ReadRequest::default()).unwrap();
    let mut source = read.grids[0].clone();
    if matches!(source.values, GridValues::Vec3(_)) {
        source = source.component(grid).unwrap();
    }
    let filter = match volume.filter {
        Some(GridFilter::Nearest) => Filter::Nearest,
        _ => Filter::Trilinear,
    };
    let bricks = BrickGrid::new(&source, Storage::F32).unwrap().with_filter(filter);
    let own = volume.transform.as_ref().map_or(DAffine3::IDENTITY, |transform| transform.to_affine());
    let index = (own * source.index_to_world).inverse().transform_point3(point);
    // Bricks begin at the centre of a voxel, or at its corner if nothing is filtered.
    bricks.value(index + filter.offset())
}

fn cloud(keys: &str, files: &[(&str, &[u8])], shape: &str) -> (Folder, Imported) {
    let scene = format!(
        "<scene version=\"3.0.0\"><medium type=\"heterogeneous\" id=\"m\">{keys}</medium>\
         <shape {shape}<bsdf type=\"null\"/><ref name=\"interior\" id=\"m\"/></shape>{SENSOR}</scene>"
    );
    let mut all = vec![("scene.xml", scene.as_bytes())];
    all.extend(files);
    let folder = Folder::with(&all);
    let imported = folder.import();
    (folder, imported)
}

fn grid(name: &str, file: &str, keys: &str) -> String {
    format!(
        "<volume type=\"gridvolume\" name=\"{name}\"><string name=\"filename\" value=\"{file}\"/>{keys}</volume>"
    )
}

const USE_BOX: &str = "<boolean name=\"use_grid_bbox\" value=\"true\"/>";
const MOVED: &str = "<transform name=\"to_world\"><scale x=\"2\" y=\"3\" z=\"4\"/><rotate y=\"1\" angle=\"90\"/><translate x=\"5\"/></transform>";
/// Around everything.
const LARGE: &str = "type=\"cube\"><transform name=\"to_world\"><scale value=\"100\"/></transform>";

/// The map of the unit cube to the world.
fn cube_to_world(keys: &str) -> DAffine3 {
    let own = if keys.contains("use_grid_bbox") {
        let [min, max] = CORNERS.map(|corner| DVec3::from_array(corner.map(f64::from)));
        DAffine3::from_translation(min) * DAffine3::from_scale(max - min)
    } else {
        DAffine3::IDENTITY
    };
    let moved = if keys.contains("to_world") {
        DAffine3::from_translation(DVec3::new(5.0, 0.0, 0.0))
            * DAffine3::from_rotation_y(std::f64::consts::FRAC_PI_2)
            * DAffine3::from_scale(DVec3::new(2.0, 3.0, 4.0))
    } else {
        DAffine3::IDENTITY
    };
    moved * own
}

/// Points of the unit cube, some close to its faces.
fn points() -> Vec<DVec3> {
    let steps = [0.001, 0.05, 0.2, 0.37, 0.5, 0.76, 0.93, 0.999];
    let point = |at: usize| DVec3::new(steps[at / 64], steps[at / 8 % 8], steps[at % 8]);
    (0..512).map(point).collect()
}

fn assert_values(scene: &SceneDescription, keys: &str, values: &[f32]) {
    let volume = &scene.volumes[0];
    let to_world = cube_to_world(keys);
    let filter = volume.filter.unwrap_or_default();
    for point in points() {
        let found = found(volume.file.as_deref().unwrap(), 0, volume, to_world.transform_point3(point));
        let expected = expected(values, point, filter);
        assert!(
            (found - expected).abs() < 1e-4 * (1.0 + expected),
            "{keys} at {point}: {found} and not {expected}"
        );
    }
}

#[test]
fn values_are_mitsubas_everywhere_in_the_box() {
    let nearest = "<string name=\"filter_type\" value=\"nearest\"/>";
    for ends_in_zero in [true, false] {
        let values = values(ends_in_zero);
        let file = volume(CELLS, 1, CORNERS, &values);
        for keys in
            [USE_BOX.to_owned(), MOVED.to_owned(), format!("{USE_BOX}{MOVED}"), format!("{MOVED}{nearest}")]
        {
            let (_folder, imported) = cloud(&grid("sigma_t", "a.vol", &keys), &[("a.vol", &file)], LARGE);
            assert_silent(&imported);
            assert_values(&imported.description, &keys, &values);
            let is_own = imported.description.volumes[0].file.as_ref().unwrap().ends_with("a.vol");
            assert_eq!(is_own, ends_in_zero || keys.contains("nearest"), "{keys}");
        }
    }
}

#[test]
fn a_grid_that_does_not_end_in_zero_is_cut_at_its_box() {
    let file = volume(CELLS, 1, CORNERS, &values(false));
    let of =
        |shape: &str| cloud(&grid("sigma_t", "a.vol", USE_BOX), &[("a.vol", &file)], shape).1.description;
    let shape = of(LARGE).shapes;
    let [hull] = &shape[..] else { panic!("{shape:?}") };
    let cuboid = hull.cuboid.unwrap();
    assert!(near(cuboid.min, [-1.0, 0.0, 2.0]) && near(cuboid.max, [2.0, 2.0, 7.0]), "{cuboid:?}");
    assert!(hull.interior.is_some());
    // What the shape leaves out is left out.
    let half =
        "type=\"cube\"><transform name=\"to_world\"><scale value=\"100\"/><translate y=\"-99\"/></transform>";
    let cuboid = of(half).shapes[0].cuboid.unwrap();
    assert!(near(cuboid.max, [2.0, 1.0, 7.0]), "{cuboid:?}");
}

#[test]
fn a_shape_that_cuts_nothing_of_a_grid_goes() {
    let file = volume(CELLS, 1, CORNERS, &values(true));
    let of =
        |shape: &str| cloud(&grid("sigma_t", "a.vol", USE_BOX), &[("a.vol", &file)], shape).1.description;
    let exact = "type=\"cube\"><transform name=\"to_world\"><scale x=\"1.5\" y=\"1\" z=\"2.5\"/><translate x=\"0.5\" y=\"1\" z=\"4.5\"/></transform>";
    assert!(of(exact).shapes.is_empty());
    assert!(of("type=\"sphere\"><float name=\"radius\" value=\"50\"/>").shapes.is_empty());
    // Cells from 0 to the middle are not 0.
    assert_eq!(of("type=\"sphere\"><float name=\"radius\" value=\"3\"/>").shapes.len(), 1);
    assert_eq!(of(&exact.replace("y=\"1\"", "y=\"0.5\"")).shapes.len(), 1);
}

#[test]
fn coloured_extinction_is_three_volumes() {
    let scalar = values(true);
    let values: Vec<f32> = scalar.iter().flat_map(|value| [*value, 2.0 * value, 0.0]).collect();
    let file = volume(CELLS, 3, CORNERS, &values);
    let keys = grid("sigma_t", "a.vol", USE_BOX) + "<float name=\"scale\" value=\"4\"/>";
    let (_folder, imported) = cloud(&keys, &[("a.vol", &file)], LARGE);
    let volumes = imported.description.volumes;
    let mu_t: Vec<_> = volumes.iter().map(|volume| volume.medium.mu_t.clone().unwrap()).collect();
    assert_eq!(mu_t, [[4.0, 0.0, 0.0], [0.0, 4.0, 0.0], [0.0, 0.0, 4.0]].map(SpectrumDescription::from));
    let point = DVec3::new(0.5, 0.6, 0.45);
    let world = cube_to_world(USE_BOX).transform_point3(point);
    for (volume, factor) in volumes.iter().zip([1.0, 2.0, 0.0]) {
        let found = found(volume.file.as_deref().unwrap(), 0, volume, world);
        let expected = factor * expected(&scalar, point, GridFilter::Trilinear);
        assert!((found - expected).abs() < 1e-4, "{found} {expected}");
    }
    assert!(imported.description.shapes.is_empty());
}

#[test]
fn the_albedo_stands_where_it_does_in_mitsuba() {
    let density = volume(CELLS, 1, CORNERS, &values(true));
    let scalar: Vec<f32> = values(false).iter().map(|value| value / 10.0).collect();
    let rgb: Vec<f32> = scalar.iter().flat_map(|value| [*value, 0.5 * value, 0.25 * value]).collect();
    let albedo = volume(CELLS, 3, [[0.0; 3], [1.0; 3]], &rgb);
    let own = format!("{USE_BOX}{MOVED}");
    let keys = grid("sigma_t", "a.vol", &own) + &grid("albedo", "b.vol", MOVED);
    let (_folder, imported) = cloud(&keys, &[("a.vol", &density), ("b.vol", &albedo)], LARGE);
    assert_silent(&imported);
    let volume = &imported.description.volumes[0];
    assert_eq!(volume.medium.albedo, Some(1.0.into()));
    let file = volume.albedo_grid.as_ref().unwrap().file.clone().unwrap();
    let to_world = cube_to_world(MOVED);
    for point in points() {
        for (channel, factor) in [1.0, 0.5, 0.25].into_iter().enumerate() {
            let found = found(&file, channel, volume, to_world.transform_point3(point));
            let expected = factor * expected(&scalar, point, GridFilter::Trilinear);
            assert!((found - expected).abs() < 1e-5, "{point}: {found} and not {expected}");
        }
    }
}

#[test]
fn a_box_without_meaning_does_not_matter_where_it_is_not_used() {
    let values = values(true);
    let file = volume(CELLS, 1, [[0.0; 3]; 2], &values);
    let (_folder, imported) = cloud(&grid("sigma_t", "a.vol", MOVED), &[("a.vol", &file)], LARGE);
    assert_values(&imported.description, MOVED, &values);
}

#[test]
fn files_that_are_no_grids_are_told() {
    let keys = grid("sigma_t", "a.vol", USE_BOX);
    let scene = format!(
        "<scene version=\"3.0.0\"><medium type=\"heterogeneous\" id=\"m\">{keys}</medium>\
         <shape type=\"cube\"><bsdf type=\"null\"/><ref name=\"interior\" id=\"m\"/></shape>{SENSOR}</scene>"
    );
    let sound = volume(CELLS, 1, CORNERS, &values(true));
    for (file, part) in [
        (&b"VOL"[..], "is no grid volume of Mitsuba, version 3"),
        (&sound[..100], "truncated"),
        (&volume(CELLS, 1, [[0.0; 3]; 2], &values(true))[..], "has no volume"),
    ] {
        let folder = Folder::with(&[("scene.xml", scene.as_bytes()), ("a.vol", file)]);
        let error = folder.import_with(&[]).unwrap_err().to_string();
        assert!(error.contains("a.vol: ") && error.contains(part) && error.lines().count() == 1, "{error}");
    }
}
