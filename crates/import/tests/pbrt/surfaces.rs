//! Shapes, instances, materials, textures.

use std::io::Write;

use flate2::Compression;
use flate2::write::GzEncoder;
use glam::DVec3;
use tyndall_import::NoteKind;
use tyndall_scene::description::{
    ImageFilter, IndexChoice, MaterialChoice, MaterialDescription, MeshShape, Roughness, ShapeDescription,
    SpectrumDescription, TextureDescription, TextureWrap,
};

use crate::{Scene, scene_with, world};

fn shapes(text: &str) -> Vec<ShapeDescription> {
    world(text).imported.description.shapes
}

/// Normals of a mesh's triangles, not normalised.
fn normals(mesh: &MeshShape) -> Vec<DVec3> {
    let vertices = mesh.vertices.as_ref().unwrap();
    let normal = |triangle: &[u32; 3]| {
        let [a, b, c] = triangle.map(|vertex| DVec3::from_array(vertices[vertex as usize]));
        (b - a).cross(c - a)
    };
    mesh.triangles.as_ref().unwrap().iter().map(normal).collect()
}

const TRIANGLE: &str = "Shape \"trianglemesh\" \"point3 P\" [ 0 0 0 1 0 0 0 1 0 ]";

#[test]
fn the_outer_side_of_a_triangle_is_that_of_its_own_space() {
    let side = |text: &str| {
        let shapes = shapes(text);
        let normal = normals(shapes[0].mesh.as_ref().unwrap())[0].z;
        if shapes[0].flip { -normal.signum() } else { normal.signum() }
    };
    assert_eq!(side(TRIANGLE), 1.0);
    assert_eq!(side(&format!("ReverseOrientation {TRIANGLE}")), -1.0);
    assert_eq!(side(&format!("Rotate 180 0 1 0 {TRIANGLE}")), -1.0);
    // A mirror across x leaves what faces +z facing +z.
    assert_eq!(side(&format!("Scale -1 1 1 {TRIANGLE}")), 1.0);
    assert_eq!(side(&format!("Scale 1 1 -1 {TRIANGLE}")), -1.0);
    // Normals decide where they are given.
    let with = |z: i32| format!("{TRIANGLE} \"normal N\" [ 0 0 {z} 0 0 {z} 0 0 {z} ]");
    assert_eq!((side(&with(1)), side(&with(-1))), (1.0, -1.0));
    assert_eq!(side(&format!("ReverseOrientation {}", with(-1))), 1.0);
}

#[test]
fn transforms_multiply_from_the_right_and_attributes_end() {
    let places = |text: &str| -> Vec<[f64; 3]> {
        shapes(text).iter().map(|shape| shape.sphere.as_ref().unwrap().center).collect()
    };
    let text = "AttributeBegin Translate 1 0 0 Scale 2 2 2 Translate 1 0 0 Shape \"sphere\" AttributeEnd
        Shape \"sphere\"
        TransformBegin
        Transform [ 1 0 0 0 0 1 0 0 0 0 1 0 5 6 7 1 ] ConcatTransform [ 1 0 0 0 0 1 0 0 0 0 1 0 1 1 1 1 ]
        CoordinateSystem \"here\" Shape \"sphere\" Identity Shape \"sphere\"
        CoordSysTransform \"here\" Shape \"sphere\"
        TransformEnd";
    let expected = [[3.0, 0.0, 0.0], [0.0; 3], [6.0, 7.0, 8.0], [0.0; 3], [6.0, 7.0, 8.0]];
    assert_eq!(places(text), expected);
    assert_eq!(shapes("Scale 2 2 2 Shape \"sphere\"")[0].sphere.as_ref().unwrap().radius, 2.0);
    assert!(shapes("Scale 1 2 1 Shape \"sphere\"")[0].transform.is_some());
}

#[test]
fn discs_cylinders_and_flat_patches_keep_their_sides() {
    let shapes = shapes(
        "Shape \"disk\" \"float height\" 2 \"float innerradius\" 0.5
         Shape \"cylinder\" \"float radius\" 3 \"float zmin\" 0 \"float zmax\" 4
         Shape \"bilinearmesh\" \"point3 P\" [ 0 0 0 2 0 0 0 3 0 2 3 0 ]
         Scale 1 -1 1
         Shape \"bilinearmesh\" \"point3 P\" [ 0 0 0 2 0 0 0 3 0 2 3 0 ]
         Shape \"bilinearmesh\" \"point3 P\" [ 0 0 0 2 0 0 0 3 0 2 4 0 ]",
    );
    let disc = shapes[0].disc.as_ref().unwrap();
    assert_eq!(
        (disc.center, disc.normal, disc.radius, disc.inner_radius),
        ([0.0, 0.0, 2.0], [0.0, 0.0, 1.0], 1.0, 0.5)
    );
    let cylinder = shapes[1].cylinder.as_ref().unwrap();
    assert_eq!((cylinder.from, cylinder.to, cylinder.radius), ([0.0; 3], [0.0, 0.0, 4.0], 3.0));
    for patch in &shapes[2..4] {
        let rectangle = patch.rectangle.as_ref().unwrap();
        let [u, v] = [rectangle.u, rectangle.v].map(DVec3::from_array);
        assert_eq!(u.cross(v), DVec3::new(0.0, 0.0, 6.0));
    }
    assert_eq!(shapes[4].mesh.as_ref().unwrap().triangles.as_ref().unwrap().len(), 2);
}

#[test]
fn large_meshes_become_files_and_files_are_used_as_they_are() {
    let points: String = (0..300).map(|n| format!("{} {} 0 ", n % 20, n / 20)).collect();
    let indices: String = (0..200).map(|n| format!("{} {} {} ", n, n + 1, n + 20)).collect();
    let mut packed = GzEncoder::new(Vec::new(), Compression::default());
    packed.write_all(b"ply in a box").unwrap();
    let text = format!(
        "WorldBegin Shape \"trianglemesh\" \"point3 P\" [ {points} ] \"integer indices\" [ {indices} ]
         Translate 0 0 1 Shape \"plymesh\" \"string filename\" \"a.ply\"
         Shape \"plymesh\" \"string filename\" \"b.ply.gz\""
    );
    let scene = scene_with(&text, &[("a.ply", b"ply"), ("b.ply.gz", &packed.finish().unwrap())]);
    let shapes = &scene.imported.description.shapes;
    let file = |number: usize| shapes[number].mesh.as_ref().unwrap().file.clone().unwrap();
    let header = std::fs::read(file(0)).unwrap();
    assert!(header.starts_with(b"ply\nformat binary_little_endian 1.0\nelement vertex 300\n"));
    assert_eq!(file(1), scene.path("a.ply"));
    assert_eq!(shapes[1].transform.as_ref().unwrap().translate, Some([0.0, 0.0, 1.0]));
    assert_eq!(std::fs::read(file(2)).unwrap(), b"ply in a box");
}

#[test]
fn objects_stand_at_their_instances_only() {
    let shapes = shapes(
        "ObjectBegin \"unused\" Shape \"sphere\" ObjectEnd
         AttributeBegin Translate 5 0 0
         ObjectBegin \"ball\" Translate 0 1 0 Shape \"sphere\" ObjectEnd
         AttributeEnd
         ObjectInstance \"ball\"
         AttributeBegin Scale 2 2 2 ObjectInstance \"ball\" AttributeEnd",
    );
    assert_eq!(shapes.len(), 1);
    assert_eq!(shapes[0].sphere.as_ref().unwrap().center, [5.0, 1.0, 0.0]);
    let instances = shapes[0].instances.as_ref().unwrap();
    let moved: Vec<DVec3> = instances.iter().map(|t| t.to_affine().transform_point3(DVec3::X)).collect();
    assert_eq!(moved, [DVec3::X, DVec3::new(2.0, 0.0, 0.0)]);
}

fn material(text: &str) -> MaterialDescription {
    match shapes(&format!("{text} Shape \"sphere\""))[0].material.clone() {
        Some(MaterialChoice::Here(material)) => *material,
        other => panic!("{other:?}"),
    }
}

#[test]
fn materials_are_what_they_are_called() {
    assert_eq!(material(""), MaterialDescription::Diffuse { reflectance: 0.5.into() });
    assert_eq!(
        material("Material \"diffuse\" \"rgb reflectance\" [ 0.1 0.2 0.3 ]"),
        MaterialDescription::Diffuse { reflectance: [0.1, 0.2, 0.3].into() }
    );
    let MaterialDescription::Dielectric { index, roughness, .. } =
        material("Material \"dielectric\" \"float eta\" 1.33 \"float roughness\" 0.25")
    else {
        panic!()
    };
    // The width of the distribution is the root of the roughness.
    assert_eq!((index, roughness), (IndexChoice::Number(1.33), Some(Roughness::Equal(0.5))));
    let MaterialDescription::Conductor { metal, roughness, .. } = material(
        "Material \"conductor\" \"spectrum eta\" \"metal-Au-eta\" \"spectrum k\" \"metal-Au-k\"
         \"float uroughness\" 0.2 \"float vroughness\" 0.1 \"bool remaproughness\" false",
    ) else {
        panic!()
    };
    assert_eq!((metal.as_deref(), roughness), (Some("gold"), Some(Roughness::Pair([0.2, 0.1]))));
    let copper = material("Material \"conductor\"");
    assert!(matches!(&copper, MaterialDescription::Conductor { metal: Some(name), .. } if name == "copper"));
    assert!(matches!(
        material("Material \"conductor\" \"rgb reflectance\" [ .9 .8 .7 ]"),
        MaterialDescription::Conductor {
            reflectance: Some(SpectrumDescription::Channels(_)),
            metal: None,
            ..
        }
    ));
    assert!(matches!(material("Material \"thindielectric\""), MaterialDescription::ThinDielectric { .. }));
    assert!(matches!(
        material("Material \"coateddiffuse\" \"float roughness\" 0.01"),
        MaterialDescription::Plastic { roughness: Some(Roughness::Equal(alpha)), .. } if (alpha - 0.1).abs() < 1e-12
    ));
}

#[test]
fn named_materials_keep_their_names_and_mix() {
    let scene = world(
        "MakeNamedMaterial \"red\" \"string type\" \"diffuse\" \"rgb reflectance\" [ 1 0 0 ]
         MakeNamedMaterial \"glass\" \"string type\" \"dielectric\"
         MakeNamedMaterial \"both\" \"string type\" \"mix\" \"string materials\" [ \"red\" \"glass\" ] \"float amount\" 0.3
         NamedMaterial \"both\" Shape \"sphere\"",
    );
    let description = &scene.imported.description;
    let names: Vec<&str> = description.materials.iter().map(|material| material.name.as_str()).collect();
    assert_eq!(names, ["red", "glass", "both"]);
    let MaterialDescription::Mix { materials, amount } = &description.materials[2].material else { panic!() };
    assert_eq!(materials, &["red", "glass"].map(|name| MaterialChoice::Name(name.to_owned())));
    assert_eq!(*amount, 0.3.into());
    assert_eq!(description.shapes[0].material, Some(MaterialChoice::Name("both".to_owned())));
    assert!(scene.is_whole());
}

#[test]
fn attributes_hold_for_what_comes_after_them() {
    let shapes = shapes(
        "AttributeBegin Attribute \"shape\" \"float radius\" 3 Attribute \"material\" \"rgb reflectance\" [ 0 0 0 ]
         Material \"diffuse\" Shape \"sphere\" Shape \"sphere\" \"float radius\" 2 AttributeEnd Shape \"sphere\"",
    );
    let radii: Vec<f64> = shapes.iter().map(|shape| shape.sphere.as_ref().unwrap().radius).collect();
    assert_eq!(radii, [3.0, 2.0, 1.0]);
    let black = MaterialDescription::Diffuse { reflectance: 0.0.into() };
    assert_eq!(shapes[0].material, Some(MaterialChoice::Here(Box::new(black))));
}

fn textured(text: &str) -> Scene {
    let text = format!("WorldBegin {text} Material \"diffuse\" \"texture reflectance\" \"t\" {TRIANGLE}");
    scene_with(&text, &[("wood.png", b"not looked into")])
}

#[test]
fn textures_are_pictures_checkerboards_constants_and_multiples_of_them() {
    let reflectance = |text: &str| {
        let scene = textured(text);
        let Some(MaterialChoice::Here(material)) = &scene.imported.description.shapes[0].material else {
            panic!()
        };
        let MaterialDescription::Diffuse { reflectance } = material.as_ref() else { panic!() };
        assert!(scene.is_whole(), "{:?}", scene.imported.notes);
        reflectance.clone()
    };
    let picture = "\"spectrum\" \"imagemap\" \"string filename\" \"wood.png\" \"string filter\" \"point\"
        \"string wrap\" \"clamp\" \"float uscale\" 2 \"float vdelta\" 0.5 \"string encoding\" \"linear\"";
    let TextureDescription::Image(image) = reflectance(&format!("Texture \"t\" {picture}")) else { panic!() };
    assert!(image.image.ends_with("wood.png") && image.image.starts_with('/'));
    assert_eq!((image.scale, image.offset), (Some([2.0, 1.0]), Some([0.0, 0.5])));
    assert_eq!(
        (image.filter, image.wrap, image.srgb),
        (ImageFilter::Nearest, TextureWrap::Clamp, Some(false))
    );
    let scaled = format!(
        "Texture \"w\" {picture} Texture \"t\" \"spectrum\" \"scale\" \"texture tex\" \"w\" \"float scale\" 0.5"
    );
    assert!(matches!(reflectance(&scaled), TextureDescription::Image(image) if image.factor == Some(0.5)));
    let checker = "Texture \"t\" \"spectrum\" \"checkerboard\" \"rgb tex1\" [ .1 .2 .3 ] \"float uscale\" 8 \"float vscale\" 8";
    let TextureDescription::Checker(board) = reflectance(checker) else { panic!() };
    assert_eq!((board.checker, board.scale), ([[0.1, 0.2, 0.3].into(), 0.0.into()], Some([8.0, 8.0])));
    let constant = "Texture \"t\" \"spectrum\" \"constant\" \"rgb value\" [ .2 .2 .2 ]";
    assert_eq!(reflectance(constant), 0.2.into());
}

#[test]
fn triangles_without_texture_coordinates_get_those_of_pbrt_where_they_are_needed() {
    let scene = textured("Texture \"t\" \"spectrum\" \"checkerboard\"");
    let mesh = scene.imported.description.shapes[0].mesh.clone().unwrap();
    assert_eq!(mesh.uvs, Some(vec![[0.0, 0.0], [1.0, 0.0], [1.0, 1.0]]));
    assert_eq!(shapes(TRIANGLE)[0].mesh.as_ref().unwrap().uvs, None);
}

#[test]
fn alpha_is_a_share_of_nothing() {
    let shapes = shapes(
        "Shape \"sphere\" \"float alpha\" 0 Shape \"sphere\" \"float alpha\" 0.25 Shape \"sphere\" \"float alpha\" 1",
    );
    assert_eq!(shapes.len(), 2);
    let Some(MaterialChoice::Here(material)) = &shapes[0].material else { panic!() };
    let MaterialDescription::Mix { materials, amount } = material.as_ref() else { panic!() };
    assert_eq!(materials[0], MaterialChoice::Here(Box::new(MaterialDescription::Null)));
    assert_eq!(*amount, 0.25.into());
}

#[test]
fn lamps_shine_outwards_unless_they_are_two_sided() {
    let scene = world(
        "AreaLightSource \"diffuse\" \"rgb L\" [ 17 12 4 ]
         Shape \"sphere\"
         ReverseOrientation Shape \"sphere\"
         ObjectBegin \"lamp\" Shape \"sphere\" ObjectEnd ObjectInstance \"lamp\"
         Material \"interface\" Shape \"sphere\"",
    );
    let shapes = &scene.imported.description.shapes;
    let lights: Vec<Option<SpectrumDescription>> = shapes
        .iter()
        .map(|shape| shape.emission.as_ref().map(|emission| emission.radiance.clone()))
        .collect();
    assert_eq!(lights, [Some([17.0, 12.0, 4.0].into()), Some([17.0, 12.0, 4.0].into()), None]);
    assert_eq!((shapes[0].flip, shapes[1].flip), (false, true));
    assert_eq!(scene.notes(NoteKind::Choice).len(), 2);
}
