//! A ray that leaves a surface does not meet the same place again, whatever the size of the scene and the angle.

use glam::{DAffine3, DMat3, DQuat, DVec3};
use tyndall_lanes::Random;
use tyndall_scene::description::{ShapeDescription, TransformDescription};
use tyndall_scene::{Ray, Surfaces};

use super::{cube_point, scene, surfaces_of, unit};

const SHAPES: [&str; 8] = [
    "rectangle = { corner = [-1, -1, 0], u = [2, 0, 0], v = [0.5, 2, 0] }",
    "disc = { center = [0, 0, 0], normal = [0, 0, 1], radius = 1 }",
    "plane = { point = [0, 0, 0], normal = [0, 0, 1] }",
    "mesh = { vertices = [[-1, -1, 0.1], [1, -1, 0], [0, 1, 0.2]], triangles = [[0, 1, 2]] }",
    "sphere = { center = [0, 0, 0], radius = 1 }",
    "box = { min = [-1, -1, -1], max = [1, 1, 1] }",
    "cylinder = { from = [0, 0, -1], to = [0, 0, 1], radius = 1 }",
    "cylinder = { from = [0, 0, -1], to = [0, 0, 1], radius = 1, capped = true }",
];

fn matrix(to_world: DAffine3) -> TransformDescription {
    let rows = to_world.matrix3.transpose();
    let t = to_world.translation;
    let mut matrix = [0.0; 16];
    for (row, (axis, shift)) in
        [(rows.x_axis, t.x), (rows.y_axis, t.y), (rows.z_axis, t.z)].into_iter().enumerate()
    {
        matrix[4 * row..4 * row + 4].copy_from_slice(&[axis.x, axis.y, axis.z, shift]);
    }
    matrix[15] = 1.0;
    TransformDescription { matrix: Some(matrix), ..Default::default() }
}

fn placed(shape: &str, to_world: DAffine3) -> Surfaces {
    let mut description: ShapeDescription =
        scene(&format!("[[shape]]\nmaterial = 'grey'\n{shape}")).shapes.remove(0);
    description.transform = Some(matrix(to_world));
    surfaces_of(description)
}

/// On the side that a ray goes to nothing is met again nearby; through a round thing the way is a chord.
#[test]
fn a_ray_does_not_meet_the_place_it_left() {
    let mut random = Random::new(9, 0, 0);
    for shape in SHAPES {
        let is_flat = !shape.starts_with("sphere") && !shape.starts_with("cylinder");
        for (size, shift) in
            [(1e-3, 0.0), (1.0, 0.0), (1.0, 100.0), (1e5, 0.0), (1e5, 1e5), (1e-3, 10.0), (1.0, 1e5)]
        {
            let turn = DMat3::from_quat(DQuat::from_axis_angle(unit(&mut random), 1.0 + random.f64()));
            let to_world = DAffine3::from_mat3_translation(turn * size, cube_point(&mut random) * shift);
            let surfaces = placed(shape, to_world);
            for number in 0..3000 {
                let target = to_world.transform_point3(cube_point(&mut random));
                let origin = to_world.transform_point3(cube_point(&mut random) * 4.0);
                let Some(direction) = (target - origin).try_normalize() else { continue };
                let Some(hit) = surfaces.intersect(&Ray { origin, direction }, f64::INFINITY) else {
                    continue;
                };
                let along = hit.normal.any_orthonormal_vector();
                let along = DQuat::from_axis_angle(hit.normal, 6.3 * random.f64()) * along;
                let sine = [0.3, 1e-3, 1e-6, 1e-9, 1e-12, 1e-15, 0.0][number % 7];
                let side = if random.f64() < 0.5 { 1.0 } else { -1.0 };
                let direction = (along + hit.normal * (side * sine)).normalize();
                let ray = Ray { origin: hit.leave(direction), direction };
                let greatest = size + 3.0 * shift + hit.position.length();
                assert!((ray.origin - hit.position).length() < 1e-9 * greatest, "{shape}");
                let Some(again) = surfaces.intersect(&ray, f64::INFINITY) else { continue };
                let what = format!("{shape}, size {size}, shift {shift}, sine {sine}, side {side}");
                let is_inside = direction.dot(hit.normal) < 0.0;
                if shape.starts_with("plane") {
                    // The direction is rounded, and so does not quite run along the plane.
                    assert!(sine == 0.0 && again.t > 1e3 * size, "{what}");
                    continue;
                }
                // What is met is another part of the shape, from inside or from behind.
                assert!(!is_flat || again.primitive != hit.primitive, "{what}: {hit:?} {again:?}");
                if !shape.contains("cylinder") || shape.contains("capped") {
                    assert!(is_inside && direction.dot(again.normal) >= 0.0, "{what}: {hit:?} {again:?}");
                }
                if shape.starts_with("sphere") {
                    let chord = 2.0 * sine * size;
                    // At grazing angles the offset makes the chord longer: (chord/2)² + offset * 2 * radius.
                    let longest = (chord * chord + 16.0 * hit.offset * size).sqrt() + 1e-6 * chord;
                    assert!(again.t <= longest && again.t >= 0.9 * chord, "{what}: {} {chord}", again.t);
                }
            }
        }
    }
}

/// The place of a hit is on the surface within a few roundings, from however far it is seen.
#[test]
fn places_are_on_the_surface_also_from_afar() {
    let mut random = Random::new(10, 0, 0);
    for (shape, distance) in [
        (SHAPES[0], (|p| p.z.abs()) as fn(DVec3) -> f64),
        (SHAPES[4], |p| (p.length() - 1.0).abs()),
        (SHAPES[6], |p| (p.truncate().length() - 1.0).abs()),
        (SHAPES[3], |p| {
            (p - DVec3::new(-1.0, -1.0, 0.1))
                .dot(DVec3::new(2.0, 0.0, -0.1).cross(DVec3::new(1.0, 2.0, 0.1)))
                .abs()
        }),
    ] {
        let surfaces = placed(shape, DAffine3::IDENTITY);
        let mut count = 0;
        for _ in 0..2000 {
            let origin = unit(&mut random) * 1e6;
            let direction = (cube_point(&mut random) * 0.7 - origin).normalize();
            let Some(hit) = surfaces.intersect(&Ray { origin, direction }, f64::INFINITY) else { continue };
            count += 1;
            assert!(distance(hit.position) < 1e-14, "{shape}: {}", distance(hit.position));
            assert!((hit.position - origin - direction * hit.t).length() < 1e-6);
        }
        assert!(count > 500, "{count}");
    }
}
