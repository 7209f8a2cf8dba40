//! Parameters, includes, references, notes: what holds for all objects.

use tyndall_import::NoteKind;
use tyndall_scene::description::LightDescription;

use crate::support::*;

fn intensities(lights: &[LightDescription]) -> Vec<f64> {
    let intensity = |light: &LightDescription| match light {
        LightDescription::Point(point) => match point.intensity {
            tyndall_scene::description::SpectrumDescription::Grey(value) => value,
            _ => panic!("{light:?}"),
        },
        _ => panic!("{light:?}"),
    };
    lights.iter().map(intensity).collect()
}

#[test]
fn the_longest_parameter_is_meant_and_a_backslash_keeps_the_sign() {
    let imported = import(
        r#"<default name="a" value="2"/><default name="ab" value="3"/><default name="a" value="9"/>
           <emitter type="point"><float name="intensity" value="$ab$a"/></emitter>
           <bsdf type="diffuse" id="\$a"/>"#,
    );
    assert_eq!(intensities(&imported.description.lights), [32.0]);
    assert_silent(&imported);
}

#[test]
fn included_scenes_stand_where_they_are_included() {
    let light = |value: &str| {
        format!(
            "<scene version=\"3.0.0\"><emitter type=\"point\"><float name=\"intensity\" value=\"{value}\"/></emitter></scene>"
        )
    };
    let inner =
        "<scene version=\"3.0.0\"><include filename=\"deep.xml\"/><default name=\"x\" value=\"4\"/></scene>";
    let lone = "<emitter version=\"3.0.0\" type=\"point\"><float name=\"intensity\" value=\"5\"/></emitter>";
    let scene = format!(
        "<scene version=\"3.0.0\"><path value=\"parts\"/><include filename=\"inner.xml\"/><include filename=\"lone.xml\"/>\
         <emitter type=\"point\"><float name=\"intensity\" value=\"$x\"/></emitter>{SENSOR}</scene>"
    );
    let files: [(&str, &[u8]); 4] = [
        ("scene.xml", scene.as_bytes()),
        ("parts/inner.xml", inner.as_bytes()),
        ("parts/deep.xml", light("3").leak().as_bytes()),
        ("parts/lone.xml", lone.as_bytes()),
    ];
    let imported = Folder::with(&files).import();
    assert_eq!(intensities(&imported.description.lights), [3.0, 5.0, 4.0]);
}

#[test]
fn files_that_include_themselves_are_refused() {
    let scene = "<scene version=\"3.0.0\">\n<include filename=\"scene.xml\"/></scene>";
    let folder = Folder::with(&[("scene.xml", scene.as_bytes())]);
    let error = folder.import_with(&[]).unwrap_err();
    assert_eq!(error.line, Some(2));
    assert!(error.message.contains("scene.xml -> scene.xml: the file includes itself"), "{error}");
}

#[test]
fn files_within_files_end_somewhere() {
    let scene = |number: usize| {
        format!("<scene version=\"3.0.0\"><include filename=\"{}.xml\"/></scene>", number + 1)
    };
    let files: Vec<(String, String)> = (1..20)
        .map(|number| (format!("{number}.xml"), scene(number)))
        .chain([("scene.xml".into(), scene(0))])
        .collect();
    let files: Vec<(&str, &[u8])> =
        files.iter().map(|(name, text)| (name.as_str(), text.as_bytes())).collect();
    let error = Folder::with(&files).import_with(&[]).unwrap_err();
    assert!(error.message.contains("more than 15 deep"), "{error}");
}

#[test]
fn an_alias_is_another_name() {
    let imported = import(
        r#"<bsdf type="null" id="a"/><alias id="a" as="b"/><medium type="homogeneous" id="m"/>
           <shape type="sphere"><ref id="b"/><ref name="interior" id="m"/></shape>"#,
    );
    assert!(imported.description.volumes[0].sphere.is_some());
}

#[test]
fn names_of_mitsuba_0_are_read() {
    let scene = format!(
        "<scene version=\"0.6.0\"><emitter type=\"spot\"><transform name=\"toWorld\"><translate x=\"3\"/></transform>\
         <float name=\"cutoffAngle\" value=\"33\"/><spectrum name=\"intensity\" value=\"1,2,3\"/></emitter>{SENSOR}</scene>"
    );
    let imported = Folder::with(&[("scene.xml", scene.as_bytes())]).import();
    let LightDescription::Spot(spot) = &imported.description.lights[0] else { panic!() };
    assert_eq!(
        (spot.position, spot.angle, spot.intensity.clone()),
        ([3.0, 0.0, 0.0], 33.0, [1.0, 2.0, 3.0].into())
    );
    assert!(messages(&imported, NoteKind::Choice)[0].contains("Mitsuba 0.x"));
}

#[test]
fn what_has_no_effect_is_told_once_with_file_and_line() {
    let imported = import(
        "<emitter type=\"point\"><float name=\"glow\" value=\"1\"/></emitter>\n\
         <emitter type=\"point\"><float name=\"glow\" value=\"2\"/></emitter>\n\
         <emitter type=\"disco\"/><subsurface type=\"dipole\"/>",
    );
    let lines: Vec<(usize, NoteKind)> = imported.notes.iter().map(|note| (note.line, note.kind)).collect();
    let unsupported = NoteKind::Unsupported;
    assert_eq!(lines, [(4, unsupported), (2, unsupported), (4, unsupported)], "{:?}", imported.notes);
    let said = messages(&imported, unsupported);
    assert!(said[0].contains("<subsurface> is not known"), "{said:?}");
    assert_eq!(said[1], "`glow` in the emitter `point` is not supported and has no effect");
    assert_eq!(said[2], "the emitter `disco` is not supported and is left out");
    assert!(imported.notes[1].file.ends_with("scene.xml"));
}

#[test]
fn parameters_that_nothing_uses_are_told() {
    let scene = format!("<scene version=\"3.0.0\">{SENSOR}</scene>");
    let folder = Folder::with(&[("scene.xml", scene.as_bytes())]);
    let imported = folder.import_with(&[("spp", "8")]).unwrap();
    assert_eq!(messages(&imported, NoteKind::Choice), ["the parameter `spp` is used nowhere in the scene"]);
}

#[test]
fn faults_are_told_in_one_line_with_the_mend() {
    for (content, part) in [
        ("<emitter type=\"point\"", "scene.xml:3: is no sound XML"),
        ("<emitter/>", "scene.xml:2: <emitter> has no `type`: add it"),
        ("<shape type=\"sphere\"><ref id=\"wall\"/></shape>", "nothing has the id `wall`: mend the <ref>"),
        ("<bsdf type=\"null\" id=\"a\"/><bsdf type=\"null\" id=\"a\"/>", "the id `a` stands twice"),
        ("<alias id=\"a\" as=\"b\"/>", "nothing before has the id `a`"),
        ("<include filename=\"none.xml\"/>", "there is no file `none.xml`"),
        ("<path value=\"nowhere\"/>", "there is no folder"),
        ("<float name=\"$x\" value=\"1\"/>", "the parameter `$x` has no value: add a <default> for it"),
        ("<default name=\"\" value=\"1\"/>", "empty name"),
        ("<float name=\"a\" value=\"nan\"/>", "`nan` is no number"),
        ("<boolean name=\"a\" value=\"maybe\"/>", "`maybe` is neither true nor false"),
        ("<integer name=\"a\" value=\"1.5\"/>", "`1.5` is no integer"),
        ("<point name=\"a\" x=\"1\"/>", "<point> has no `y`"),
        ("<rgb name=\"a\" value=\"1,2\"/>", "`value` has 2 numbers: give 1 or 3"),
        ("<spectrum name=\"a\" value=\"400:1, 300:2\"/>", "must increase"),
        ("<spectrum name=\"a\" value=\"1 2\"/>", "without wavelengths"),
        ("<transform name=\"t\"><rotate angle=\"3\"/></transform>", "the axis of <rotate> is 0"),
        ("<transform name=\"t\"><matrix value=\"1 2\"/></transform>", "the matrix has 2 numbers"),
        ("<transform name=\"t\"><lookat origin=\"0,0,0\" target=\"0,0,0\"/></transform>", "looks nowhere"),
        ("<transform name=\"t\"><scale value=\"1e200\"/><scale value=\"1e200\"/></transform>", "too large"),
        ("<transform name=\"t\"><bend/></transform>", "<bend> is no operation"),
        (
            "<bsdf type=\"twosided\" id=\"a\"><ref id=\"a\"/></bsdf><shape type=\"sphere\"><ref id=\"a\"/></shape>",
            "contains itself",
        ),
    ] {
        let message = refusal(content);
        assert!(message.contains(part), "{content}: {message}");
    }
}

#[test]
fn a_file_that_is_no_scene_is_told() {
    for (content, part) in [
        (&b"<shape version=\"3.0.0\" type=\"sphere\"/>"[..], "begins with <shape>, and not with <scene>"),
        (b"<scene version=\"three\"/>", "`three` is no version"),
        (b"\n<scene \xff/>", ":2: is no UTF-8"),
        (b"", "is no sound XML"),
    ] {
        let folder = Folder::with(&[("scene.xml", content)]);
        let error = folder.import_with(&[]).unwrap_err().to_string();
        assert!(error.contains(part), "{error}");
    }
}

#[test]
fn nothing_grows_without_bound() {
    // Every default doubles the one before it.
    let mut doubling = String::from("<default name=\"a0\" value=\"xxxxxxxx\"/>");
    for n in 1..60 {
        doubling += &format!("<default name=\"a{n}\" value=\"$a{0}$a{0}\"/>", n - 1);
    }
    let message = refusal(&doubling);
    assert!(message.contains("too long") || message.contains("make the scene too"), "{message}");
    let deep = "<bsdf type=\"twosided\">".repeat(200) + &"</bsdf>".repeat(200);
    assert!(refusal(&deep).contains("nested deeper"), "{}", refusal(&deep));
    // Materials that refer to the one before twice stand once each.
    let tower = |height: usize| {
        let mut tower = String::from("<bsdf type=\"diffuse\" id=\"m0\"/>");
        for n in 1..height {
            let below = n - 1;
            tower += &format!(
                "<bsdf type=\"blendbsdf\" id=\"m{n}\"><float name=\"weight\" value=\"0.5\"/><ref id=\"m{below}\"/><ref id=\"m{below}\"/></bsdf>"
            );
        }
        tower + &format!("<shape type=\"sphere\"><ref id=\"m{}\"/></shape>", height - 1)
    };
    assert_eq!(import(&tower(8)).description.materials.len(), 8);
    assert!(refusal(&tower(25)).contains("mixed of more than 256 parts"));
}
