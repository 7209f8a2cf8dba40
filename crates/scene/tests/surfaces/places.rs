//! Where shapes are, which way their normals and texture coordinates run, and what they are for lamps.

use std::f64::consts::PI;

use glam::{DVec2, DVec3};
use tyndall_lanes::Random;
use tyndall_scene::surface::WorldPrimitive;
use tyndall_scene::{Hit, Ray, Surfaces};

use super::{cube_point, surfaces, unit};

fn hit(surfaces: &Surfaces, from: [f64; 3], to: [f64; 3]) -> Hit {
    let [origin, to] = [from, to].map(DVec3::from_array);
    surfaces.intersect(&Ray { origin, direction: (to - origin).normalize() }, f64::INFINITY).unwrap()
}

fn near(a: DVec3, b: [f64; 3]) -> bool {
    (a - DVec3::from_array(b)).length() < 1e-12
}

#[test]
fn texture_coordinates_run_as_documented() {
    let sphere = surfaces("sphere = { center = [0, 0, 1], radius = 2 }");
    let at = hit(&sphere, [0.0, 9.0, 1.0], [0.0, 0.0, 1.0]);
    assert!(near(at.position, [0.0, 2.0, 1.0]) && (at.t - 7.0).abs() < 1e-12);
    assert!((DVec2::from_array(at.uv) - DVec2::new(0.25, 0.5)).length() < 1e-12, "{:?}", at.uv);
    assert!(near(at.tangent, [-1.0, 0.0, 0.0]));

    let rectangle = surfaces("rectangle = { corner = [1, 0, 0], u = [0, 2, 0], v = [0, 0, 4] }");
    let at = hit(&rectangle, [5.0, 0.5, 3.0], [1.0, 0.5, 3.0]);
    assert_eq!((at.uv, at.primitive), ([0.25, 0.75], 0));
    assert!(near(at.normal, [1.0, 0.0, 0.0]) && near(at.tangent, [0.0, 1.0, 0.0]));

    let cylinder = surfaces("cylinder = { from = [0, 0, 0], to = [0, 0, 4], radius = 1, capped = true }");
    let at = hit(&cylinder, [5.0, 0.0, 3.0], [0.0, 0.0, 3.0]);
    assert!((at.uv[1] - 0.75).abs() < 1e-12 && at.primitive == 0 && near(at.normal, [1.0, 0.0, 0.0]));
    let top = hit(&cylinder, [0.5, 0.0, 9.0], [0.5, 0.0, 0.0]);
    assert!(top.primitive == 2 && near(top.normal, [0.0, 0.0, 1.0]) && (top.uv[1] - 0.5).abs() < 1e-12);

    let mesh = "mesh = { vertices = [[0, 0, 0], [2, 0, 0], [0, 2, 0]], triangles = [[0, 1, 2]], \
                uvs = [[0, 0], [0, 1], [1, 0]], normals = [[0, 0, -1], [0, 0, -1], [0, 1, -1]]";
    let at = hit(&surfaces(&format!("{mesh} }}")), [0.5, 1.0, 3.0], [0.5, 1.0, 0.0]);
    assert!(near(at.normal, [0.0, 0.0, 1.0]), "counter-clockwise from +z");
    assert!((at.uv[0] - 0.5).abs() < 1e-12 && (at.uv[1] - 0.25).abs() < 1e-12);
    assert!(near(at.tangent, [0.0, 1.0, 0.0]), "{}", at.tangent);
    let mean = (DVec3::Z * 0.5 + DVec3::new(0.0, -1.0, 1.0).normalize() * 0.5).normalize();
    assert!(
        (at.shading_normal - mean).length() < 1e-12,
        "on the side of the surface's own: {}",
        at.shading_normal
    );
    let flat = hit(&surfaces(&format!("{mesh}, flat = true }}")), [0.5, 1.0, 3.0], [0.5, 1.0, 0.0]);
    assert_eq!(flat.shading_normal, flat.normal);
}

/// Every hit is on the primitive of its number, with its normal; and points drawn on the primitives are hit. The pieces
/// have a closed form for the area where the shape has one.
#[test]
fn pieces_in_the_world_are_the_surface_itself() {
    let mut random = Random::new(12, 0, 0);
    let shear = "[1, 0.5, 0, 3, 0, 2, 0.25, -1, 0, 0, -4, 0, 0, 0, 0, 1]";
    let transforms = [
        String::new(),
        "transform = { scale = 3, rotate = [10, 20, 30], translate = [1, 2, 3] }".into(),
        "transform = { scale = [-2, 2, 2], rotate = [10, 20, 30], translate = [1, 2, 3] }\nflip = true"
            .into(),
        "transform = { scale = [2, 2, -2], rotate = [10, 20, 30], translate = [1, 2, 3] }".into(),
        format!("transform = {{ matrix = {shear} }}"),
    ];
    for (shape, area) in [
        ("sphere = { center = [1, 0, 0], radius = 0.5 }", PI),
        ("box = { min = [0, 0, 0], max = [1, 2, 3] }", 22.0),
        ("rectangle = { corner = [0, 0, 0], u = [1, 0, 1], v = [0, 1, 0] }", 2_f64.sqrt()),
        ("disc = { center = [0, 0, 0], normal = [1, 2, 3], radius = 1, inner_radius = 0.5 }", 0.75 * PI),
        (
            "cylinder = { from = [0, 0, 0], to = [0, 1, 2], radius = 0.5, capped = true }",
            PI * (5_f64.sqrt() + 0.5),
        ),
        ("cylinder = { from = [0, 0, 0], to = [0, 1, 2], radius = 0.5 }", PI * 5_f64.sqrt()),
        (
            "mesh = { vertices = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], triangles = [[0, 2, 1], [1, 2, 3]] }",
            0.5 + 0.75_f64.sqrt(),
        ),
    ] {
        for (number, transform) in transforms.iter().enumerate() {
            let surfaces = surfaces(&format!("{shape}\n{transform}"));
            let is_round = ["sphere", "disc", "cylinder"].iter().any(|round| shape.starts_with(round));
            let Some(pieces) = surfaces.world_primitives(0) else {
                assert!(is_round && number == 4, "{shape} {transform}");
                continue;
            };
            assert!(!is_round || number < 4);
            if number < 4 {
                let whole: f64 = pieces.iter().map(WorldPrimitive::area).sum();
                let scale = [1.0, 9.0, 4.0, 4.0][number];
                assert!((whole / (area * scale) - 1.0).abs() < 1e-12, "{shape}: {whole}");
            }
            for _ in 0..200 {
                let piece = (random.bits() % pieces.len() as u64) as usize;
                let point = pieces[piece].sample([random.f64(), random.f64()]);
                let mut away = unit(&mut random);
                away *= if away.dot(point.normal) < 0.0 { -1.0 } else { 1.0 };
                if away.dot(point.normal) < 0.05 {
                    continue;
                }
                let ray = Ray { origin: point.position + away * 1e-6, direction: -away };
                let hit = surfaces.intersect(&ray, 1.1e-6).unwrap();
                assert_eq!(hit.primitive, piece);
                assert!((hit.position - point.position).length() < 1e-9);
                assert!(
                    (hit.normal - point.normal).length() < 1e-9,
                    "{shape} {transform}: {} {}",
                    hit.normal,
                    point.normal
                );
            }
        }
    }
}

/// Against the normal of the surface F = 0 by differences of F, for deformed round shapes.
#[test]
fn normals_of_deformed_shapes_are_gradients() {
    let mut random = Random::new(13, 0, 0);
    let ellipsoid = surfaces(
        "sphere = { center = [0, 0, 0], radius = 1 }\ntransform = { scale = [1, 2, 0.5], translate = [0, 1, 0] }",
    );
    for _ in 0..500 {
        let ray = Ray { origin: cube_point(&mut random) * 9.0, direction: unit(&mut random) };
        let Some(hit) = ellipsoid.intersect(&ray, f64::INFINITY) else { continue };
        let place = (hit.position - DVec3::Y) / DVec3::new(1.0, 2.0, 0.5);
        assert!((place.length() - 1.0).abs() < 1e-12);
        let gradient = (place / DVec3::new(1.0, 2.0, 0.5)).normalize();
        assert!((hit.normal - gradient).length() < 1e-9);
    }
}

#[test]
fn the_nearest_of_several_shapes_is_met_before_the_end_and_planes_have_none() {
    let text = "[[shape]]\nmaterial = 'grey'\nplane = { point = [0, -1, 0], normal = [0, 1, 0] }\n\
                [[shape]]\nmaterial = 'grey'\nsphere = { center = [0, 0, 0], radius = 0.5 }\n\
                instances = [{}, { translate = [0, 0, -3] }, { scale = [1, 4, 1], translate = [5, 0, 0] }]\nid = 7";
    let built = super::built(&super::scene(text));
    let surfaces = &built.scene.surfaces;
    let down = Ray { origin: DVec3::new(0.0, 5.0, 0.0), direction: DVec3::NEG_Y };
    let first = surfaces.intersect(&down, 100.0).unwrap();
    assert_eq!((first.shape, first.t), (1, 4.5));
    assert!(surfaces.intersect(&down, 4.5).is_none());
    let along = Ray { origin: DVec3::new(0.0, 0.0, -1.0), direction: DVec3::NEG_Z };
    assert_eq!(surfaces.intersect(&along, 100.0).map(|hit| (hit.shape, hit.t)), Some((2, 1.5)));
    let tall = Ray { origin: DVec3::new(5.0, 9.0, 0.0), direction: DVec3::NEG_Y };
    assert_eq!(surfaces.intersect(&tall, 100.0).map(|hit| (hit.shape, hit.t)), Some((3, 7.0)));
    let beside = Ray { origin: DVec3::new(-900.0, 9.0, 0.0), direction: DVec3::NEG_Y };
    assert_eq!(surfaces.intersect(&beside, 100.0).map(|hit| (hit.shape, hit.t)), Some((0, 10.0)));
    let ids: Vec<u32> = surfaces.shapes.iter().map(|shape| shape.id).collect();
    assert_eq!(ids, [1, 7, 7, 7]);
    let [min, max] = surfaces.bounds().unwrap();
    assert!((min - DVec3::new(-0.5, -2.0, -3.5)).length() < 1e-5, "{min}");
    assert!((max - DVec3::new(5.5, 2.0, 0.5)).length() < 1e-5, "{max}");
}
