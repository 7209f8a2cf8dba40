//! Scene files: what is read, and what is said of files that are wrong.

use tyndall_scene::description::{Integrator, Layer, LightDescription, PhaseDescription, VolumeSource};
use tyndall_scene::{SceneDescription, SceneDocument, SceneError};

fn read(text: &str) -> Result<SceneDescription, SceneError> {
    SceneDocument::parse("scene.toml", text)?.description()
}

/// The messages of all problems of a text that must not be read.
fn problems(text: &str) -> Vec<String> {
    match read(text) {
        Ok(description) => panic!("this was read: {description:?}"),
        Err(error) => error.problems().iter().map(ToString::to_string).collect(),
    }
}

const CAMERA: &str = "[camera]\nposition = [0, 0, 5]\ntarget = [0, 0, 0]\n";

#[test]
fn a_full_scene_is_read() {
    let scene = read(
        r#"
        unit = "km"
        [camera]
        position = [0, 1, 5]
        direction = [0, 0, -1]
        up = [0, 1, 0.5]
        vertical_fov = 30
        aperture_radius = 0.1
        focus_distance = 5
        [film]
        resolution = [640, 480]
        exposure = -1.5
        layers = ["depth", "standard_error"]
        [render]
        spp = 16
        seed = 7
        max_depth = 100
        integrator = "reference"
        [medium]
        mu_a = 0.1
        mu_s = [0.9, 0.9, 0.9]
        [[volume]]
        name = "cloud"
        file = "cloud.vdb"
        grid = "density"
        mean_free_path = 0.5
        albedo = [0.9, 0.8, 0.7]
        phase = { type = "hg", g = 0.85 }
        emission = [1, 0.5, 0]
        storage = "u8"
        transform = { scale = 2, rotate = [0, 90, 0], translate = [1, 2, 3] }
        [[volume]]
        sphere = { center = [0, 0, 0], radius = 1 }
        mu_t = 3
        albedo = 1
        [[volume]]
        procedural = { type = "cumulus", seed = 3 }
        mu_t = 3
        albedo = 1
        [[light]]
        type = "sky"
        sun_elevation = 30
        [[light]]
        type = "point"
        position = [1, 2, 3]
        intensity = [5, 5, 4]
        "#,
    )
    .unwrap();
    assert_eq!(scene.unit, "km");
    assert_eq!(scene.camera.direction, Some([0.0, 0.0, -1.0]));
    assert_eq!(scene.film.layers, Some(vec![Layer::Depth, Layer::StandardError]));
    assert_eq!(scene.render.integrator, Integrator::Reference);
    assert_eq!(scene.medium.as_ref().unwrap().coefficients("km", 0.0).unwrap().mu_t_rgb().x, 1.0);
    assert_eq!(scene.volumes[0].source(), Ok(VolumeSource::File("cloud.vdb")));
    assert_eq!(scene.volumes[0].medium.coefficients("km", 0.0).unwrap().mu_t_rgb().x, 2.0);
    assert_eq!(scene.volumes[0].medium.phase, Some(PhaseDescription::Hg { g: 0.85 }));
    assert_eq!(scene.volumes[0].medium.emission, Some([1.0, 0.5, 0.0].into()));
    assert!(matches!(scene.volumes[2].source(), Ok(VolumeSource::Procedural(_))));
    assert!(
        matches!(&scene.lights[0], LightDescription::Sky(sky) if sky.sun_elevation == Some(30.0) && sky.sun)
    );
}

#[test]
fn what_is_absent_has_its_default() {
    let scene = read(CAMERA).unwrap();
    assert_eq!(scene.unit, "m");
    assert_eq!(scene.camera.vertical_fov, 40.0);
    assert_eq!(scene.camera.up, [0.0, 1.0, 0.0]);
    assert_eq!(scene.film.resolution, [1280, 720]);
    assert_eq!((scene.render.spp, scene.render.max_depth), (64, None));
}

/// Text after the camera's three lines, and the one problem it has.
#[test]
fn every_mistake_is_named_with_its_place_and_mend() {
    let volume = "[[volume]]\nfile = 'a.vdb'\n";
    let cases = [
        (
            format!("{volume}mu_t = 1\nalbdeo = 0.5"),
            "scene.toml:7:1: unknown key `albdeo` in [[volume]], did you mean `albedo`?",
        ),
        (
            format!("{volume}mu_t = 1\nalbedo = 1.5"),
            "scene.toml:7:10: `albedo` must be a number from 0 to 1, not 1.5",
        ),
        (
            format!("{volume}mu_t = 1\nalbedo = [1, 1]"),
            "scene.toml:7:10: `albedo` must be an array of 3 numbers from 0 to 1, not 2 of them",
        ),
        (
            format!("{volume}mu_t = 1\nalbedo = [1, 1, -1]"),
            "scene.toml:7:17: `albedo[2]` must be a number from 0 to 1, not -1",
        ),
        (
            format!("{volume}mu_t = 1\nalbedo = 'white'"),
            "scene.toml:7:10: `albedo` must be a number from 0 to 1 or an array of 3 numbers from 0 to 1 or a table, not a string",
        ),
        (
            format!("{volume}mu_t = {{ wavelengths = [400, 500], values = [1] }}\nalbedo = 1"),
            "scene.toml:6:10: `mu_t`: the spectrum has 2 wavelengths but 1 values: give one value for each",
        ),
        (
            format!("{volume}mu_t = {{ wavelengths = [500, 400], values = [1, 1] }}\nalbedo = 1"),
            "scene.toml:6:10: `mu_t`: the spectrum is out of order: wavelength number 2 must be above 0 and above the one before it",
        ),
        (
            format!("{volume}mu_t = {{ wavelength = [500], values = [1] }}\nalbedo = 1"),
            "scene.toml:6:10: unknown key `wavelength` in `mu_t`, did you mean `wavelengths`?",
        ),
        (
            format!("{volume}mu_t = {{ blackbody = 3000 }}\nalbedo = 1"),
            "scene.toml:6:10: `mu_t`: a black body is light and no coefficient: give `wavelengths` and `values`",
        ),
        (
            format!("{volume}mu_t = 1\nalbedo = {{ wavelengths = [500, 600], values = [1, 2] }}"),
            "scene.toml:7:38: `albedo`: the `values` must be numbers from 0 to 1",
        ),
        (
            format!("{volume}mu_t = 1\nalbedo = 1\nemission = {{ blackbody = 3000, value = 1 }}"),
            "scene.toml:8:1: `emission`: the spectrum is given in several ways: give `wavelengths` with `values`, or \
             `blackbody`, or `power_law` with `at` and `value`",
        ),
        (
            format!("{volume}preset = 'Whole milk'\nmu_t = 2"),
            "scene.toml:6:1: the coefficients are given as `mu_t` and `preset`: give exactly one of the pairs `mu_t` + \
             `albedo`, `mean_free_path` + `albedo`, `mean_free_path` + `reflectance`, `mu_a` + `mu_s`, a `preset`, or `particles`",
        ),
        (
            format!("{volume}preset = 'Hole milk'"),
            "scene.toml:6:1: `preset`: there is no measured medium `Hole milk`, did you mean `Wholemilk`?",
        ),
        (
            format!("{volume}mu_t = 2\nalbedo = 1\nscale = 1e30"),
            "scene.toml:8:1: `scale` makes the extinction 2e30: numbers beyond 1e30 are not computed with",
        ),
        (
            format!("{volume}mu_t = 1\nalbedo = 1\nemission = 1\ntemperature = {{}}"),
            "scene.toml:8:1: the volume glows by both `emission` and `temperature`: keep one",
        ),
        (
            format!("{volume}mu_t = 1\nalbedo = 1\nemission_grid = {{}}"),
            "scene.toml:8:1: `emission_grid` multiplies what is not there: give `emission`, `emission_per_length` or \
             `temperature`",
        ),
        (
            "[[volume]]\nsphere = { center = [0, 0, 0], radius = 1 }\nmu_t = 1\nalbedo = 1\ntemperature = {}"
                .into(),
            "scene.toml:8:1: `temperature` needs a `file`: the volume itself is from none",
        ),
        (
            "[medium]\nmu_t = [0, 1, 1]\nalbedo = 1\nemission_per_length = 1".into(),
            "scene.toml:7:1: a medium that fills all space and does not weaken light would shine without end: give it an \
             extinction above 0",
        ),
        (
            "[film]\nbands = [450, 550]".into(),
            "scene.toml:5:1: `bands` is computed from wavelengths: give `mode = \"spectral\"` in [render]",
        ),
        (
            "[film]\noutput = 'xyz'".into(),
            "scene.toml:5:1: `output` is computed from wavelengths: give `mode = \"spectral\"` in [render]",
        ),
        (format!("{volume}mu_t = nan\nalbedo = 1"), "scene.toml:6:8: `mu_t` must be finite, not NaN"),
        (
            format!("{volume}mu_t = 1e200\nalbedo = 1"),
            "scene.toml:6:8: `mu_t` is 1e200: numbers beyond 1e30 are not computed with",
        ),
        (
            format!("{volume}mu_t = 1\nalbedo = 1\nphase = {{ type = 'hgg', g = 0 }}"),
            "scene.toml:8:18: unknown type `hgg` of `phase`, did you mean `hg`?",
        ),
        (
            format!("{volume}mu_t = 1\nalbedo = 1\nphase = {{ type = 'hg', g = 1 }}"),
            "scene.toml:8:28: `g` must be a number between -1 and 1, both excluded, not 1",
        ),
        (
            format!("{volume}mu_t = 1\nalbedo = 1\nphase = {{ type = 'hg' }}"),
            "scene.toml:8:9: `phase` of type `hg` lacks `g`: give a number between -1 and 1, both excluded",
        ),
        (
            format!("{volume}mu_t = 1"),
            "scene.toml:4:1: `mu_t` alone does not say the coefficients: give exactly one of the pairs \
             `mu_t` + `albedo`, `mean_free_path` + `albedo`, `mean_free_path` + `reflectance`, `mu_a` + `mu_s`, a `preset`, or `particles`",
        ),
        (
            format!("{volume}mu_t = 1\nalbedo = 1\nmu_a = 1"),
            "scene.toml:8:1: the coefficients are given as `mu_t` and `albedo` and `mu_a`: give exactly one of the \
             pairs `mu_t` + `albedo`, `mean_free_path` + `albedo`, `mean_free_path` + `reflectance`, `mu_a` + `mu_s`, a `preset`, or `particles`",
        ),
        (
            "[[volume]]\nmu_t = 1\nalbedo = 1".to_owned(),
            "scene.toml:4:1: the volume has no shape: give one of `file`, `box`, `sphere`, `slab`, `atmosphere`, `procedural`, or a [[shape]] with its `name` for `interior`",
        ),
        (
            format!("{volume}mu_t = 1\nalbedo = 1\nslab = {{ bottom = 0, top = 1 }}"),
            "scene.toml:8:1: the volume has both `file` and `slab`: keep one, or write two [[volume]] tables",
        ),
        (
            "[[volume]]\nmu_t = 1\nalbedo = 1\nslab = { bottom = 1, top = 0 }".to_owned(),
            "scene.toml:7:1: `slab` is empty: `bottom` must be less than `top`",
        ),
        (
            format!("{volume}mu_t = 1\nalbedo = 1\ntransform = {{ scale = [1, 0, 1] }}"),
            "scene.toml:8:15: `scale` makes the volume flat: no factor may be 0",
        ),
        (
            "[[light]]\ntype = 'sun'\ndirection = [0, 0, 0]\nirradiance = 1".to_owned(),
            "scene.toml:6:1: `direction` is a direction and must not be [0, 0, 0]",
        ),
        (
            "[[light]]\ntype = 'stars'".to_owned(),
            "scene.toml:5:8: unknown type `stars` of [[light]]; there is `constant`, `image`, `sky`, `sun`, \
             `distant`, `point`, `spot`",
        ),
        (
            "[[light]]\ntype = 'spot'\nposition = [0, 1, 0]\ndirection = [0, 0, 0]\nintensity = 1\nangle = 30".to_owned(),
            "scene.toml:7:1: `direction` is a direction and must not be [0, 0, 0]",
        ),
        (
            "[[light]]\ntype = 'spot'\nposition = [0, 1, 0]\ndirection = [0, -1, 0]\nintensity = 1\nangle = 30\n\
             inner_angle = 31".to_owned(),
            "scene.toml:10:1: `inner_angle` must not be greater than `angle`, the edge of the cone",
        ),
        (
            "[[light]]\ntype = 'image'\nfile = 'sky.exr'\norientation = [2, 0, 0, 0, 1, 0, 0, 0, 1]".to_owned(),
            "scene.toml:7:1: `orientation` must be a rotation, mirrored or not: three rows of length 1 at right angles to \
             each other",
        ),
        (
            "[light]\ntype = 'sky'".to_owned(),
            "scene.toml:4:1: [[light]] must be an array of tables, not a table",
        ),
        (
            "[render]\nintegrator = 'fats'".to_owned(),
            "scene.toml:5:14: unknown value `fats` of `integrator`, did you mean `fast`?",
        ),
        (
            "[render]\nspp = 0".to_owned(),
            "scene.toml:5:7: `spp` must be an integer from 1 to 4294967295, not 0",
        ),
        (
            "[render]\nspp = 1.5".to_owned(),
            "scene.toml:5:7: `spp` must be an integer from 1 to 4294967295, not 1.5",
        ),
        (
            "[render]\nseed = 5_000_000_000".to_owned(),
            "scene.toml:5:8: `seed` must be an integer from 0 to 4294967295, not 5000000000",
        ),
        (
            "[render]\nseed = 99999999999999999999".to_owned(),
            "scene.toml:5:8: 99999999999999999999 is too large an integer",
        ),
        (
            "[film]\nresolution = [0, 10]".to_owned(),
            "scene.toml:5:15: `resolution[0]` must be an integer from 1 to 65536, not 0",
        ),
        (
            "[film]\nlayers = ['dept']".to_owned(),
            "scene.toml:5:11: unknown value `dept` of `layers`, did you mean `depth`?",
        ),
        (
            "[film]\nexposure = 2026-01-01".to_owned(),
            "scene.toml:5:12: `exposure` must be a number from -100 to 100, not a date",
        ),
        (
            "[flim]\nexposure = 1".to_owned(),
            "scene.toml:4:2: unknown key `flim` in the scene, did you mean `film`?",
        ),
        (
            "up = [0, 0, 1]".to_owned(),
            "scene.toml:4:1: `up` points along the view: choose another `up`, such as [0, 0, -1] to look down",
        ),
        (
            "direction = [0, 0, 1]".to_owned(),
            "scene.toml:4:1: the camera has both `target` and `direction`: keep one",
        ),
        ("position = 3".to_owned(), "scene.toml:4:1: not TOML: duplicate key"),
    ];
    for (text, expected) in cases {
        assert_eq!(problems(&format!("{CAMERA}{text}")), [expected], "of {text}");
    }
    let lacking = problems(&format!("{CAMERA}{volume}mu_t = 1\nalbedo = 1\nphase = {{ g = 0 }}"));
    let start = "scene.toml:8:9: `phase` lacks `type`: give one of `isotropic`, `hg`, ";
    assert!(lacking.len() == 1 && lacking[0].starts_with(start), "{lacking:?}");
}

#[test]
fn a_scene_needs_a_camera_that_looks_somewhere() {
    assert_eq!(problems(""), ["scene.toml:1:1: the scene lacks [camera]: give a table"]);
    assert_eq!(
        problems("[camera]\ntarget = [0, 0, 0]"),
        ["scene.toml:1:1: [camera] lacks `position`: give an array of 3 numbers"]
    );
    assert_eq!(
        problems("[camera]\nposition = [0, 0, 0]"),
        ["scene.toml:1:2: the camera looks nowhere: give `target` or `direction`"]
    );
}

#[test]
fn all_mistakes_of_a_file_are_reported_at_once() {
    let error = read("[camera]\nposition = 1\nfov = 3\n[render]\nspp = 'many'").unwrap_err();
    assert_eq!(error.problems().len(), 3);
    assert_eq!(
        error.to_string(),
        "scene.toml:2:12: `position` must be an array of 3 numbers, not an integer (and 2 more problems)"
    );
}

#[test]
fn columns_count_characters() {
    assert_eq!(
        problems(
            "unit = 'm' # µµµ\ncamera = { position = [0, 0, 5], target = [0, 0, 0], \"µ\" = 1, roll = 2 }"
        ),
        [
            "scene.toml:2:54: unknown key `µ` in [camera]; there is `aperture_radius`, `direction`, \
             `focus_distance`, `height`, `inside`, `projection`, `up`, `vertical_fov`, `window`",
            "scene.toml:2:63: unknown key `roll` in [camera]; there is `aperture_radius`, `direction`, \
             `focus_distance`, `height`, `inside`, `projection`, `up`, `vertical_fov`, `window`",
        ]
    );
}

#[test]
fn damaged_text_is_one_clear_line_and_depth_is_bounded() {
    for text in ["[camera", "a = [", "x = {{{{", "\u{0}", "a = 1 b = 2", "= 3"] {
        let messages = problems(text);
        assert_eq!(messages.len(), 1, "{messages:?}");
        assert!(messages[0].starts_with("scene.toml:1:") && !messages[0].contains('\n'), "{messages:?}");
    }
    for deep in ["a.".repeat(100_000) + "a = 1", "a = ".to_owned() + &"[".repeat(100_000)] {
        assert_eq!(problems(&deep).len(), 1);
    }
}

#[test]
fn options_change_the_scene() {
    let mut document = SceneDocument::parse(
        "scene.toml",
        &format!("{CAMERA}[[volume]]\nfile = 'a.vdb'\nmu_t = 1\nalbedo = 1\n"),
    )
    .unwrap();
    for option in [
        "camera.vertical_fov=30",
        "volume.0.mu_t = 3",
        "render.integrator=reference",
        "camera.position=[1, 2, 3]",
        "light.0.type=constant",
        "light.0.radiance=2",
    ] {
        document.set(option).unwrap();
    }
    let scene = document.description().unwrap();
    assert_eq!(scene.camera.vertical_fov, 30.0);
    assert_eq!(scene.camera.position, [1.0, 2.0, 3.0]);
    assert_eq!(scene.volumes[0].medium.mu_t, Some(3.0.into()));
    assert_eq!(scene.render.integrator, Integrator::Reference);
    assert!(matches!(&scene.lights[..], [LightDescription::Constant(_)]));
}

#[test]
fn options_that_are_wrong_are_named() {
    let cases = [
        ("camera.fov=30", "--set camera.fov=30: unknown key `fov` in [camera]"),
        (
            "camera.vertical_fov=300",
            "--set camera.vertical_fov=300: `vertical_fov` must be a number between 0 and 180",
        ),
        ("camera.vertical_fov", "--set camera.vertical_fov: lacks `=`"),
        ("camera..x=1", "--set camera..x=1: write path.to.key=value"),
        ("volume.1.mu_t=3", "--set volume.1.mu_t=3: `1` is no entry: the array has 0, counted from 0"),
        (
            "camera.position.x=3",
            "--set camera.position.x=3: `x` is no entry: the array has 3, counted from 0",
        ),
        (
            "camera.vertical_fov.x=3",
            "--set camera.vertical_fov.x=3: `vertical_fov` must be a number between 0 and 180, both excluded, not a table",
        ),
        ("camera.up=[0, 0, 1]", "--set camera.up=[0, 0, 1]: `up` points along the view"),
        (
            "render.integrator=fats",
            "--set render.integrator=fats: unknown value `fats` of `integrator`, did you mean",
        ),
    ];
    for (option, expected) in cases {
        let mut document = SceneDocument::parse("scene.toml", CAMERA).unwrap();
        let message = match document.set(option).and_then(|()| document.description().map(drop)) {
            Ok(()) => panic!("{option} was taken"),
            Err(error) => error.to_string(),
        };
        assert!(message.starts_with(expected), "{option}: {message}");
    }
}
