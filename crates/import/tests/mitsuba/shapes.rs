//! Shapes: where they are, which side is outside, instances.

use tyndall_import::NoteKind;
use tyndall_scene::description::{ShapeDescription, TransformDescription};

use crate::support::*;

const TWO_SIDED: &str = r#"<bsdf type="twosided"><bsdf type="diffuse"/></bsdf>"#;

fn shape(content: &str) -> ShapeDescription {
    let imported = import(&format!("<shape {content}{TWO_SIDED}</shape>"));
    assert_silent(&imported);
    imported.description.shapes[0].clone()
}

fn moved(operations: &str) -> String {
    format!("<transform name=\"to_world\">{operations}</transform>")
}

#[test]
fn operations_are_done_one_after_another() {
    let shape = shape(&format!(
        "type=\"sphere\">{}",
        moved(
            "<scale value=\"2\"/><translate x=\"3\"/><rotate z=\"1\" angle=\"90\"/><matrix value=\"1 0 0 0  0 1 0 0  0 0 1 7  0 0 0 1\"/>"
        )
    ));
    let sphere = shape.sphere.unwrap();
    assert!(near(sphere.center, [0.0, 3.0, 7.0]) && sphere.radius == 2.0, "{sphere:?}");
}

#[test]
fn rectangles_face_along_z_unless_they_are_turned() {
    let normal = |content: &str| rectangle_normal(&shape(&format!("type=\"rectangle\">{content}")));
    let flip = "<boolean name=\"flip_normals\" value=\"true\"/>";
    assert_eq!(normal(""), [0.0, 0.0, 1.0]);
    assert_eq!(normal(flip), [0.0, 0.0, -1.0]);
    assert!(near(normal(&moved("<rotate x=\"1\" angle=\"90\"/>")), [0.0, -1.0, 0.0]));
    // A mirror leaves the front in front.
    assert_eq!(normal(&moved("<scale x=\"-1\"/>")), [0.0, 0.0, 1.0]);
    assert_eq!(normal(&moved("<scale z=\"-1\"/>")), [0.0, 0.0, -1.0]);
}

#[test]
fn discs_and_cylinders_are_round_where_they_can_be() {
    let disc =
        shape(&format!("type=\"disk\">{}", moved("<scale value=\"3\"/><rotate y=\"1\" angle=\"90\"/>")));
    let round = disc.disc.unwrap();
    assert!(
        near(round.normal, [1.0, 0.0, 0.0]) && (round.radius - 3.0).abs() < 1e-12 && disc.transform.is_none()
    );
    let oval = shape(&format!("type=\"disk\">{}", moved("<scale x=\"3\"/>")));
    assert_eq!((oval.disc.unwrap().radius, oval.transform.is_some()), (1.0, true));
    let tube = shape(&format!(
        "type=\"cylinder\"><point name=\"p0\" value=\"1,0,0\"/><point name=\"p1\" value=\"1,0,5\"/><float name=\"radius\" value=\"0.5\"/>{}",
        moved("<scale value=\"2\"/>")
    ));
    let cylinder = tube.cylinder.unwrap();
    assert_eq!(
        (cylinder.from, cylinder.to, cylinder.radius, cylinder.capped),
        ([2.0, 0.0, 0.0], [2.0, 0.0, 10.0], 1.0, false)
    );
}

#[test]
fn mirrored_spheres_are_inside_out_and_boxes_are_not() {
    let mirror = moved("<scale x=\"-1\"/>");
    assert!(shape(&format!("type=\"sphere\">{mirror}")).flip);
    let cube = shape(&format!("type=\"cube\">{mirror}"));
    assert_eq!((cube.flip, cube.cuboid.unwrap().min), (false, [-1.0; 3]));
    let deformed = shape(&format!("type=\"sphere\">{}", moved("<scale x=\"2\"/>")));
    assert!(deformed.transform.is_some() && deformed.sphere.unwrap().radius == 1.0);
}

#[test]
fn lamps_shine_to_their_outer_side_and_are_black() {
    let imported = import(
        r#"<shape type="rectangle"><emitter type="area"><rgb name="radiance" value="1,2,3"/></emitter></shape>
           <shape type="sphere"><bsdf type="null"/><emitter type="area"/></shape>"#,
    );
    let lamp = &imported.description.shapes[0];
    let emission = lamp.emission.clone().unwrap();
    assert_eq!((emission.radiance, emission.two_sided), ([1.0, 2.0, 3.0].into(), false));
    let black = here(tyndall_scene::description::MaterialDescription::Diffuse { reflectance: 0.0.into() });
    assert_eq!(lamp.material, Some(black));
    assert!(messages(&imported, NoteKind::Unsupported)[0].contains("lets no light through"));
}

#[test]
fn groups_stand_where_their_instances_say() {
    let scene = import(&format!(
        r#"<shape type="shapegroup" id="pair"><shape type="sphere">{TWO_SIDED}</shape><shape type="cube">{TWO_SIDED}</shape></shape>
           <shape type="instance"><ref id="pair"/></shape>
           <shape type="instance"><ref id="pair"/>{}</shape>
           <shape type="merge"><shape type="disk">{TWO_SIDED}</shape></shape>"#,
        moved("<translate y=\"4\"/>")
    ))
    .description;
    assert_eq!(scene.shapes.len(), 3);
    assert!(scene.shapes[0].disc.is_some() && scene.shapes[0].instances.is_none());
    for shape in &scene.shapes[1..] {
        let places: Vec<_> =
            shape.instances.iter().flatten().map(|place| place.to_affine().translation.y).collect();
        assert_eq!(places, [0.0, 4.0]);
        assert_eq!(shape.instances.as_ref().unwrap()[0], TransformDescription::default());
    }
}

#[test]
fn meshes_without_normals_get_those_of_their_vertices() {
    let ply = b"ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n\
        element face 2\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 1 2\n3 0 2 3\n";
    let scene = |keys: &str| {
        let scene = format!(
            "<scene version=\"3.0.0\"><shape type=\"ply\"><string name=\"filename\" value=\"a.ply\"/>{keys}{TWO_SIDED}</shape>{SENSOR}</scene>"
        );
        let folder = Folder::with(&[("scene.xml", scene.as_bytes()), ("a.ply", ply)]);
        let imported = folder.import();
        assert_silent(&imported);
        (imported.description.shapes[0].clone(), folder)
    };
    let (flat, _folder) = scene("<boolean name=\"face_normals\" value=\"true\"/>");
    let mesh = flat.mesh.unwrap();
    assert!(mesh.flat && mesh.file.unwrap().ends_with("a.ply"));
    let (smooth, _folder) = scene("");
    let file = smooth.mesh.unwrap().file.unwrap();
    let mesh = tyndall_scene::surface::read_mesh(file.as_ref(), &mut Vec::new()).unwrap();
    let normals = mesh.normals.unwrap();
    let expected = glam::DVec3::new(1.0, 0.0, 1.0).normalize();
    assert!((normals[0].normalize() - expected).length() < 1e-6, "{normals:?}");
}

#[test]
fn what_is_invisible_or_not_read_is_left_out() {
    let imported = import(
        r#"<shape type="sphere"><bsdf type="null"/></shape>
           <shape type="serialized"><string name="filename" value="a.serialized"/></shape>
           <shape type="sdfgrid"/>
           <shape type="rectangle"><transform name="to_world"><scale x="0"/></transform></shape>"#,
    );
    assert!(imported.description.shapes.is_empty());
    let said = messages(&imported, NoteKind::Unsupported);
    assert!(
        said.len() == 2 && said[0].contains("convert them to .ply") && said[1].contains("`sdfgrid`"),
        "{said:?}"
    );
    assert!(messages(&imported, NoteKind::Choice)[0].contains("no extent"));
}
