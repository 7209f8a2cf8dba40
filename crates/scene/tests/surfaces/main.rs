//! Surfaces: where rays meet them, on which side they leave, and what is built from their descriptions.

mod building;
mod closed_shapes;
mod crossings;
mod leaving;
mod messages;
mod places;

use std::path::Path;

use glam::DVec3;
use tyndall_lanes::Random;
use tyndall_scene::description::ShapeDescription;
use tyndall_scene::{BuiltScene, SceneDescription, SceneDocument, Surfaces, build};

/// A scene of this text, after a camera and a material `grey`.
fn scene(text: &str) -> SceneDescription {
    let camera = "camera = { position = [0, 0, 5], target = [0, 0, 0] }\n";
    let material = "[[material]]\nname = 'grey'\ntype = 'diffuse'\n";
    let document = SceneDocument::parse("scene.toml", &format!("{camera}{material}{text}")).unwrap();
    document.description().unwrap_or_else(|error| panic!("{error}"))
}

fn built(description: &SceneDescription) -> BuiltScene {
    build(description, Path::new("")).unwrap_or_else(|error| panic!("{error}"))
}

/// The surfaces of one shape of these keys.
fn surfaces(keys: &str) -> Surfaces {
    built(&scene(&format!("[[shape]]\nmaterial = 'grey'\n{keys}"))).scene.surfaces
}

fn surfaces_of(shape: ShapeDescription) -> Surfaces {
    let mut description = scene("");
    description.shapes.push(shape);
    built(&description).scene.surfaces
}

/// Uniform in the cube [-1, 1]³.
fn cube_point(random: &mut Random) -> DVec3 {
    DVec3::from_array(std::array::from_fn(|_| 2.0 * random.f64() - 1.0))
}

fn unit(random: &mut Random) -> DVec3 {
    loop {
        let point = cube_point(random);
        if point.length_squared() <= 1.0 && point.length_squared() > 1e-4 {
            return point.normalize();
        }
    }
}
