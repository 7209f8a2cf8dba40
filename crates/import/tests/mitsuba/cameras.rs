//! Sensors, films, samplers and integrators.

use glam::DVec3;
use tyndall_import::{Imported, NoteKind};
use tyndall_scene::description::{CameraDescription, Projection};

use crate::support::*;

fn sensor(content: &str) -> Imported {
    let scene = format!("<scene version=\"3.0.0\">{content}</scene>");
    Folder::with(&[("scene.xml", scene.as_bytes())]).import()
}

fn camera(plugin: &str, content: &str, film: &str) -> CameraDescription {
    let text = format!(
        "<sensor type=\"{plugin}\">{content}<film type=\"hdrfilm\"><rfilter type=\"box\"/>{film}</film></sensor>"
    );
    let imported = sensor(&text);
    assert_silent(&imported);
    imported.description.camera
}

const WIDE: &str = r#"<integer name="width" value="200"/><integer name="height" value="100"/>"#;
const TALL: &str = r#"<integer name="width" value="100"/><integer name="height" value="200"/>"#;

#[test]
fn the_field_of_view_is_that_of_its_axis() {
    let tan = |degrees: f64| (0.5 * degrees.to_radians()).tan();
    for (axis, film, expected) in [
        ("x", WIDE, tan(60.0) / 2.0),
        ("y", WIDE, tan(60.0)),
        ("smaller", WIDE, tan(60.0)),
        ("larger", WIDE, tan(60.0) / 2.0),
        ("x", TALL, tan(60.0) * 2.0),
        ("smaller", TALL, tan(60.0) * 2.0),
        ("larger", TALL, tan(60.0)),
        ("diagonal", WIDE, tan(60.0) / 5.0_f64.sqrt()),
    ] {
        let keys = format!("<float name=\"fov\" value=\"60\"/><string name=\"fov_axis\" value=\"{axis}\"/>");
        let camera = camera("perspective", &keys, film);
        let vertical = tan(camera.vertical_fov);
        assert!((vertical / expected - 1.0).abs() < 1e-12, "{axis} {film}: {vertical} and not {expected}");
    }
    // Half the diagonal of 36 mm by 24 mm over 50 mm, of which the height has 1 in √5.
    let by_length = tan(camera("perspective", "", WIDE).vertical_fov);
    assert!((by_length - 36.0_f64.hypot(24.0) / 100.0 / 5.0_f64.sqrt()).abs() < 1e-12);
}

#[test]
fn a_look_at_is_not_mirrored_and_a_mirroring_transform_is() {
    let view = "<float name=\"fov\" value=\"90\"/><transform name=\"to_world\">MIRROR<lookat origin=\"1,2,3\" \
                target=\"1,2,0\" up=\"0,1,0\"/></transform>";
    let plain = camera("perspective", &view.replace("MIRROR", ""), WIDE);
    assert_eq!((plain.position, plain.target, plain.window), ([1.0, 2.0, 3.0], Some([1.0, 2.0, 0.0]), None));
    let mirrored = camera("perspective", &view.replace("MIRROR", "<scale x=\"-1\"/>"), WIDE);
    let window = mirrored.window.unwrap();
    assert!(window[0] > window[1] && window[2] < window[3], "{window:?}");
    assert!((window[0] - 1.0).abs() < 1e-12 && (window[3] - 0.5).abs() < 1e-12, "{window:?}");
    assert_eq!(mirrored.direction.map(|d| near(d, [0.0, 0.0, -1.0])), Some(true));
}

#[test]
fn without_a_transform_the_camera_looks_along_z_with_x_on_the_left() {
    let camera = camera("perspective", "<float name=\"fov\" value=\"90\"/>", WIDE);
    assert_eq!((camera.direction, camera.up, camera.window), (Some([0.0, 0.0, 1.0]), [0.0, 1.0, 0.0], None));
    // To the right of the picture is forward × up, which is -x.
    let right = DVec3::from(camera.direction.unwrap()).cross(camera.up.into());
    assert_eq!(right, DVec3::NEG_X);
}

#[test]
fn a_principal_point_moves_the_window() {
    let keys = "<float name=\"fov\" value=\"90\"/><float name=\"principal_point_offset_x\" value=\"0.25\"/>\
                <float name=\"principal_point_offset_y\" value=\"0.5\"/>";
    let window = camera("perspective", keys, WIDE).window.unwrap();
    // Columns from a quarter to five quarters of a film 2 wide; rows from the middle down.
    for (edge, expected) in window.into_iter().zip([-0.5, 1.5, -1.0, 0.0]) {
        assert!((edge - expected).abs() < 1e-12, "{window:?}");
    }
}

#[test]
fn an_orthographic_film_is_two_units_wide_under_the_scale() {
    let scale = |scale: &str| {
        let keys = format!(
            "<transform name=\"to_world\"><scale {scale}/><lookat origin=\"0,5,0\" target=\"0,0,0\" up=\"0,0,1\"/></transform>"
        );
        camera("orthographic", &keys, WIDE)
    };
    let even = scale("value=\"3\"");
    assert_eq!(even.projection, Projection::Orthographic);
    assert!((even.height.unwrap() - 3.0).abs() < 1e-12);
    let stretched = scale("x=\"3\" y=\"6\" z=\"1\"");
    let window = stretched.window.unwrap();
    for (edge, expected) in window.into_iter().zip([-3.0, 3.0, -3.0, 3.0]) {
        assert!((edge - expected).abs() < 1e-12, "{window:?}");
    }
}

#[test]
fn a_thin_lens_has_its_radius_and_focus() {
    let keys = "<float name=\"fov\" value=\"30\"/><float name=\"aperture_radius\" value=\"0.1\"/>\
                <float name=\"focus_distance\" value=\"7\"/>";
    let camera = camera("thinlens", keys, WIDE);
    assert_eq!((camera.aperture_radius, camera.focus_distance), (0.1, Some(7.0)));
}

#[test]
fn the_film_has_its_size_crop_and_filter() {
    let film = "<film type=\"hdrfilm\"><integer name=\"width\" value=\"640\"/><integer name=\"height\" value=\"480\"/>\
                <integer name=\"crop_offset_x\" value=\"10\"/><integer name=\"crop_offset_y\" value=\"20\"/>\
                <integer name=\"crop_width\" value=\"30\"/><integer name=\"crop_height\" value=\"40\"/></film>";
    let imported =
        sensor(&format!("<sensor type=\"perspective\">{film}<sampler type=\"independent\"/></sensor>"));
    let film = &imported.description.film;
    assert_eq!((film.resolution, film.crop), ([640, 480], Some([10, 20, 30, 40])));
    let said = messages(&imported, NoteKind::Choice);
    assert_eq!(said.len(), 1, "{said:?}");
    assert!(said[0].contains("not by `gaussian`"), "{said:?}");
}

#[test]
fn depth_counts_scatterings() {
    for (depth, expected) in [("-1", None), ("1", Some(0)), ("9", Some(8))] {
        let integrator = format!(
            "<integrator type=\"volpath\"><integer name=\"max_depth\" value=\"{depth}\"/></integrator>"
        );
        assert_eq!(import(&integrator).description.render.max_depth, expected);
    }
    let imported = import(
        "<integrator type=\"volpathmis\"><boolean name=\"hide_emitters\" value=\"true\"/></integrator>",
    );
    assert!(messages(&imported, NoteKind::Unsupported)[0].contains("hide_emitters"));
    assert_eq!(import("<integrator type=\"direct\"/>").description.render.max_depth, Some(1));
}

#[test]
fn faults_of_cameras_are_told() {
    let refused = |content: &str| {
        let scene = format!("<scene version=\"3.0.0\">\n{content}\n</scene>");
        let folder = Folder::with(&[("scene.xml", scene.as_bytes())]);
        folder.import_with(&[]).expect_err(content).to_string()
    };
    for (content, part) in [
        ("", "the scene has no camera"),
        ("<sensor type=\"perspective\"><float name=\"fov\" value=\"180\"/></sensor>", "angle of view"),
        ("<sensor type=\"perspective\"><float name=\"fov\" value=\"wide\"/></sensor>", "`wide` is no number"),
        (
            "<sensor type=\"perspective\"><string name=\"fov\" value=\"9\"/></sensor>",
            "`fov` is a string: write a <float>",
        ),
        (
            "<sensor type=\"perspective\"><film type=\"hdrfilm\"><integer name=\"width\" value=\"-1\"/></film></sensor>",
            "`width` must be from 0 to 65536",
        ),
        (
            "<sensor type=\"perspective\"><transform name=\"to_world\"><scale value=\"0\"/></transform></sensor>",
            "is flat",
        ),
    ] {
        let message = refused(content);
        assert!(message.contains(part) && message.contains("scene.xml"), "{content}: {message}");
    }
}
