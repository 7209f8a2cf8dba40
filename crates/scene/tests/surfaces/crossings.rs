//! A ray that begins and ends outside of something closed crosses inwards as often as outwards, and is never inside twice:
//! also through edges and vertices, along faces and along edges, under all kinds of transforms.

use glam::{DAffine3, DVec3};
use tyndall_lanes::Random;
use tyndall_scene::description::{Scale, ShapeDescription, TransformDescription};
use tyndall_scene::{Ray, Surfaces};

use super::closed_shapes::{self, ClosedMesh};
use super::{cube_point, surfaces, surfaces_of, unit};

fn transforms() -> Vec<TransformDescription> {
    let rotate = Some([20.0, -50.0, 70.0]);
    vec![
        TransformDescription::default(),
        TransformDescription { rotate, ..Default::default() },
        TransformDescription {
            scale: Some(Scale::PerAxis([2.0, -0.3, 1.0])),
            rotate,
            translate: Some([-7.0, 30.0, 12.0]),
            matrix: None,
        },
        TransformDescription {
            scale: Some(Scale::Uniform(1e-3)),
            rotate,
            translate: Some([1e3, 2e3, -1e3]),
            matrix: None,
        },
    ]
}

/// The depth of a ray after each crossing; panics if it is ever outside of outside or inside twice, or does not end.
fn follow(surfaces: &Surfaces, ray: Ray, what: &dyn Fn() -> String) {
    let (mut depth, mut ray) = (0, ray);
    for _ in 0..1000 {
        let Some(hit) = surfaces.intersect(&ray, f64::INFINITY) else {
            assert_eq!(depth, 0, "{}: a ray ends inside", what());
            return;
        };
        depth += if ray.direction.dot(hit.normal) < 0.0 { 1 } else { -1 };
        assert!((0..=1).contains(&depth), "{}: a ray is inside {depth} times", what());
        ray.origin = hit.leave(ray.direction);
    }
    panic!("{}: a ray does not get away", what());
}

/// Two points through which a ray goes, in coordinates of the mesh: in general, through a vertex, through an edge, in the
/// plane of a face, along an edge.
fn aim(kind: usize, mesh: &ClosedMesh, random: &mut Random) -> [DVec3; 2] {
    let triangle = (random.bits() % mesh.triangles.len() as u64) as usize;
    let [a, b, c] = mesh.corners(triangle);
    match kind {
        0 => [cube_point(random), cube_point(random)],
        1 => [a, cube_point(random)],
        2 => [a.lerp(b, 0.5), cube_point(random)],
        3 => [a.lerp(b, random.f64()), c],
        4 => [a, b],
        _ => [a, a + DVec3::AXES[triangle % 3]],
    }
}

fn outside_ray([from, to]: [DVec3; 2], to_world: &DAffine3) -> Option<Ray> {
    let [from, to] = [from, to].map(|point| to_world.transform_point3(point));
    let reach = 5.0 * to_world.matrix3.to_cols_array().iter().fold(0.0, |all: f64, x| all.max(x.abs()));
    let direction = (to - from).try_normalize()?;
    Some(Ray { origin: from - direction * reach, direction })
}

fn meshes_are_crossed_in_and_out(transform: usize, rays: u64) {
    let description = transforms().swap_remove(transform);
    let to_world = description.to_affine();
    for mesh in closed_shapes::all() {
        let mut shape = mesh.description();
        shape.transform = Some(description.clone());
        shape.material =
            super::scene("[[shape]]\nmaterial = 'grey'\nsphere = { center = [0, 0, 0], radius = 1 }").shapes
                [0]
            .material
            .clone();
        let surfaces = surfaces_of(shape);
        let mut random = Random::new(5, transform as u64, 0);
        for number in 0..rays {
            let kind = (number % 6) as usize;
            let Some(ray) = outside_ray(aim(kind, &mesh, &mut random), &to_world) else { continue };
            let what =
                || format!("{} under transform {transform}, ray {number} of kind {kind}, {ray:?}", mesh.name);
            follow(&surfaces, ray, &what);
        }
    }
}

/// Rays through each mesh; 5 meshes and 4 transforms make 1.2 million.
const RAYS: u64 = 60_000;

#[test]
fn meshes_are_crossed_in_and_out_alike() {
    meshes_are_crossed_in_and_out(0, RAYS);
}

#[test]
fn rotated_meshes_are_crossed_in_and_out_alike() {
    meshes_are_crossed_in_and_out(1, RAYS);
}

#[test]
fn stretched_and_mirrored_meshes_are_crossed_in_and_out_alike() {
    meshes_are_crossed_in_and_out(2, RAYS);
}

#[test]
fn small_meshes_far_away_are_crossed_in_and_out_alike() {
    meshes_are_crossed_in_and_out(3, RAYS);
}

#[test]
fn closed_primitives_are_crossed_in_and_out_alike() {
    let shapes = [
        "sphere = { center = [0, 0, 0], radius = 1 }",
        "box = { min = [-1, -1, -1], max = [1, 1, 1] }",
        "cylinder = { from = [0, 0, -1], to = [0, 0, 1], radius = 1, capped = true }",
    ];
    let mut random = Random::new(6, 0, 0);
    for shape in shapes {
        for transform in transforms() {
            let mut description: ShapeDescription =
                super::scene(&format!("[[shape]]\nmaterial = 'grey'\n{shape}")).shapes.remove(0);
            description.transform = Some(transform.clone());
            let surfaces = surfaces_of(description);
            let to_world = transform.to_affine();
            for number in 0..20_000 {
                // Whole coordinates are corners, edges, and tangents.
                let mut point = || {
                    let point = cube_point(&mut random) * 1.2;
                    if number % 3 == 0 { point } else { point.map(f64::round) }
                };
                let [from, to] = [point(), point()];
                let to = if number % 3 == 1 { to } else { from + unit(&mut random) };
                let Some(ray) = outside_ray([from, to], &to_world) else { continue };
                follow(&surfaces, ray, &|| format!("{shape}, {transform:?}, {ray:?}"));
            }
        }
    }
}

/// A flipped shape is inside where it was outside.
#[test]
fn a_flipped_shape_is_crossed_the_other_way() {
    let ray = Ray { origin: DVec3::new(0.1, 0.2, 5.0), direction: DVec3::NEG_Z };
    for shape in
        ["sphere = { center = [0, 0, 0], radius = 1 }", "box = { min = [-1, -1, -1], max = [1, 1, 1] }"]
    {
        for (keys, sign) in [("", 1.0), ("flip = true", -1.0), ("transform = { scale = [1, 1, -1] }", 1.0)] {
            let hit = surfaces(&format!("{shape}\n{keys}")).intersect(&ray, 100.0).unwrap();
            assert!(hit.normal.z * sign > 0.5 && hit.shading_normal.z * sign > 0.5, "{shape} {keys}");
        }
    }
}
