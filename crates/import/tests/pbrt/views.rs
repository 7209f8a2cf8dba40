//! Cameras, films, and the settings of a render.

use tyndall_import::NoteKind;
use tyndall_scene::description::{CameraDescription, Layer, Projection};

use crate::{scene, world};

const END: &str = "\nWorldBegin\n";

fn camera(text: &str) -> CameraDescription {
    scene(&format!("{text}{END}")).imported.description.camera
}

fn near(a: f64, b: f64) -> bool {
    (a - b).abs() < 1e-9
}

#[test]
fn the_field_of_view_is_that_of_the_shorter_axis() {
    let film = |width, height| {
        format!("Film \"rgb\" \"integer xresolution\" {width} \"integer yresolution\" {height}\n")
    };
    let view = "Scale -1 1 1 LookAt 0 1 5 0 1 0 0 1 0 Camera \"perspective\" \"float fov\" 40";
    let wide = camera(&format!("{}{view}", film(200, 100)));
    assert_eq!((wide.vertical_fov, wide.window), (40.0, None));
    let tall = camera(&format!("{}{view}", film(100, 200)));
    let expected = 2.0 * (2.0 * 20.0_f64.to_radians().tan()).atan().to_degrees();
    assert!(near(tall.vertical_fov, expected) && tall.window.is_none(), "{tall:?}");
    assert_eq!(
        (wide.position, wide.direction, wide.up),
        ([0.0, 1.0, 5.0], Some([0.0, 0.0, -1.0]), [0.0, 1.0, 0.0])
    );
}

#[test]
fn without_a_mirror_before_it_a_camera_shows_the_world_mirrored() {
    let mirrored = camera("LookAt 0 0 5 0 0 0 0 1 0 Camera \"perspective\" \"float fov\" 90");
    let [left, right, bottom, top] = mirrored.window.expect("a mirrored window is given");
    let aspect = 1280.0 / 720.0;
    assert!(
        near(left, aspect) && near(right, -aspect) && near(bottom, -1.0) && near(top, 1.0),
        "{mirrored:?}"
    );
    assert_eq!(camera("Scale -1 1 1 LookAt 0 0 5 0 0 0 0 1 0 Camera \"perspective\"").window, None);
}

#[test]
fn the_screen_window_says_what_is_seen() {
    let text = "Film \"rgb\" \"integer xresolution\" 100 \"integer yresolution\" 100
        Scale -1 1 1 LookAt 0 0 5 0 0 0 0 1 0
        Camera \"perspective\" \"float fov\" 90 \"float screenwindow\" [ -1 0.5 0 1.5 ]";
    let [left, right, bottom, top] = camera(text).window.expect("the window is not symmetric");
    assert!(near(left, -1.0) && near(right, 0.5) && near(bottom, 0.0) && near(top, 1.5));
}

#[test]
fn scales_before_a_camera_scale_what_it_sees() {
    // The world at half size before the camera: an orthographic screen of 2 is 4 in the world.
    let text = "Film \"rgb\" \"integer xresolution\" 100 \"integer yresolution\" 100
        Scale -0.5 0.5 0.5 LookAt 0 0 5 0 0 0 0 1 0 Camera ";
    let view = camera(&format!("{text}\"orthographic\""));
    assert_eq!(view.projection, Projection::Orthographic);
    assert!(near(view.height.unwrap(), 4.0), "{view:?}");
    let view = camera(&format!(
        "{text}\"perspective\" \"float fov\" 30 \"float lensradius\" 0.1 \"float focaldistance\" 3"
    ));
    assert!(near(view.vertical_fov, 30.0), "{view:?}");
    assert!(near(view.aperture_radius, 0.2) && near(view.focus_distance.unwrap(), 6.0), "{view:?}");
}

#[test]
fn exposure_is_a_factor_on_all_light() {
    let text = "Film \"rgb\" \"float iso\" 200
        Camera \"perspective\" \"float shutterclose\" 0.5
        WorldBegin
        LightSource \"infinite\" \"rgb L\" [1 2 3] \"float scale\" 4
        AreaLightSource \"diffuse\" \"rgb L\" [1 1 1]
        Shape \"sphere\"";
    let description = scene(text).imported.description;
    // 0.5 s at ISO 200 is a ratio of 1.
    assert!(description.to_toml().contains("radiance = [4, 8, 12]"), "{}", description.to_toml());
    let brighter =
        scene(&text.replace("\"float iso\" 200", "\"float iso\" 400")).imported.description.to_toml();
    assert!(brighter.contains("radiance = [8, 16, 24]") && brighter.contains("radiance = 2"), "{brighter}");
}

#[test]
fn crops_count_from_the_left_upper_corner() {
    let film = |rest: &str| {
        format!("Film \"rgb\" \"integer xresolution\" 200 \"integer yresolution\" 100 {rest}{END}")
    };
    let crop = |rest: &str| scene(&film(rest)).imported.description.film.crop;
    assert_eq!(crop("\"integer pixelbounds\" [ 10 60 20 50 ]"), Some([10, 20, 50, 30]));
    assert_eq!(crop("\"float cropwindow\" [ 0.25 0.5 0 0.333 ]"), Some([50, 0, 50, 34]));
    assert_eq!(crop("\"float cropwindow\" [ 0 1 0 1 ]"), None);
}

#[test]
fn samples_seed_and_depth_are_hints() {
    let text = "Sampler \"halton\" \"integer pixelsamples\" 128
        Integrator \"volpath\" \"integer maxdepth\" 12
        PixelFilter \"box\" \"float xradius\" 0.5
        Option \"seed\" 7
        Film \"gbuffer\"
        Camera \"perspective\"
        WorldBegin";
    let scene = scene(text);
    let description = &scene.imported.description;
    assert_eq!((description.render.spp, description.render.seed), (128, 7));
    assert_eq!(description.render.max_depth, Some(12));
    assert_eq!(description.film.layers, Some(vec![Layer::Depth, Layer::Normal, Layer::Albedo]));
    assert!(scene.imported.notes.is_empty(), "{:?}", scene.imported.notes);
}

#[test]
fn what_is_not_supported_is_told_once_with_its_line() {
    let text = "Film \"rgb\" \"string sensor\" \"canon_eos_5d\"
        PixelFilter \"gaussian\"
        Integrator \"path\"
        Camera \"perspective\" \"float odd\" 1
        WorldBegin
        ColorSpace \"rec2020\"
        Shape \"sphere\" \"float zmax\" 0.5
        Shape \"sphere\" \"float zmax\" 0.5
        Material \"hair\"
        Shape \"curve\"";
    let scene = scene(text);
    let lines: Vec<String> = scene.notes(NoteKind::Unsupported);
    let about = |line: &str, word: &str| {
        lines.iter().filter(|note| note.starts_with(line) && note.contains(word)).count()
    };
    for (line, word) in [
        ("1:", "sensor"),
        ("2:", "gaussian"),
        ("4:", "`odd`"),
        ("6:", "rec2020"),
        ("7:", "part of a sphere"),
        ("9:", "hair"),
        ("10:", "curve"),
    ] {
        assert_eq!(about(line, word), 1, "{word}: {lines:#?}");
    }
    assert_eq!(lines.len(), 7, "{lines:#?}");
    assert_eq!(scene.notes(NoteKind::Choice).len(), 1);
    assert!(world("").imported.notes.is_empty());
}
