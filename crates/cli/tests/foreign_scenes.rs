//! Scenes of pbrt and Mitsuba, from the file to the picture, and as scene files.

mod command;

use command::Folder;
use serde_json::Value;

/// A ball of fog over a bumpy floor, which has so many vertices that it becomes a file.
fn pbrt_scene() -> String {
    let (mut points, mut indices) = (String::new(), String::new());
    for i in 0..100 {
        let (x, z) = (f64::from(i % 10) - 4.5, f64::from(i / 10) - 4.5);
        points += &format!("{x} {} {z} ", -1.5 + 0.1 * (x * z).sin());
    }
    for row in 0..9 {
        for corner in row * 10..row * 10 + 9 {
            let [a, b, c, d] = [corner, corner + 1, corner + 10, corner + 11];
            indices += &format!("{a} {c} {b} {b} {c} {d} ");
        }
    }
    format!(
        r#"
        LookAt 0 1 7  0 0 0  0 1 0
        Camera "perspective" "float fov" 40
        Film "rgb" "integer xresolution" 16 "integer yresolution" 12
        Sampler "independent" "integer pixelsamples" 2
        WorldBegin
        LightSource "infinite" "rgb L" [1 1 1]
        MakeNamedMedium "fog" "string type" "homogeneous" "rgb sigma_a" [0 0 0] "rgb sigma_s" [2 2 2]
        AttributeBegin
            Material "interface"
            MediumInterface "fog" ""
            Shape "sphere" "float radius" 1
        AttributeEnd
        Material "diffuse" "rgb reflectance" [0.5 0.5 0.5]
        Shape "trianglemesh" "point3 P" [{points}] "integer indices" [{indices}]
        "#
    )
}

const MITSUBA_SCENE: &str = r#"<scene version="3.0.0">
    <default name="spp" value="4"/>
    <integrator type="volpath"/>
    <sensor type="perspective">
        <float name="fov" value="40"/>
        <transform name="to_world"><lookat origin="0,0,5" target="0,0,0" up="0,1,0"/></transform>
        <sampler type="independent"><integer name="sample_count" value="$spp"/></sampler>
        <film type="hdrfilm">
            <integer name="width" value="16"/><integer name="height" value="12"/><rfilter type="box"/>
        </film>
    </sensor>
    <emitter type="constant"><rgb name="radiance" value="1, 1, 1"/></emitter>
    <shape type="sphere"><bsdf type="diffuse"><rgb name="reflectance" value="0.5, 0.5, 0.5"/></bsdf></shape>
</scene>"#;

fn json(folder: &Folder, line: &str) -> Value {
    serde_json::from_str(&folder.done(line).out).unwrap()
}

#[test]
fn a_pbrt_scene_renders_the_same_bits_as_what_it_is_converted_to() {
    let folder = Folder::new();
    folder.write("fog.pbrt", pbrt_scene());
    folder.done("render fog.pbrt -o a.acc");
    let run = folder.done("convert fog.pbrt native.toml");
    assert!(run.out.contains("native.toml and 1 file in native_files"), "{}", run.out);
    let text = String::from_utf8(folder.read("native.toml")).unwrap();
    assert!(text.contains("\"native_files/") && !text.contains("/tmp"), "{text}");
    folder.done("render native.toml -o b.acc");
    let [a, b] = ["a.acc", "b.acc"].map(|name| folder.accumulation(name));
    assert_eq!(a.metadata.scene_hash, b.metadata.scene_hash);
    assert!(a.film == b.film && a.film.complete().count() == 2);
    let layers = a.film.layers();
    assert!(layers.normal && layers.object_id && !layers.shadow_catcher);

    // What is this scene's own is written anew, what is not is left alone.
    folder.done("convert fog.pbrt native.toml");
    folder.write("native_files/notes.txt", "mine");
    let run = folder.run("convert fog.pbrt native.toml");
    assert!(run.code == Some(1) && run.error().contains("`notes.txt`"), "{}", run.err);
}

#[test]
fn a_mitsuba_scene_takes_definitions_and_changes_and_prints_as_a_scene_file() {
    let folder = Folder::new();
    folder.write("ball.xml", MITSUBA_SCENE);
    folder.done("render ball.xml -D spp=3 --set shape.0.id=7 -o a.acc");
    let picture = folder.accumulation("a.acc");
    assert_eq!(picture.film.complete().count(), 3);
    let channels = picture.film.channels();
    let objects = &channels.iter().find(|channel| channel.name == "ObjectId.Id").unwrap().values;
    assert_eq!((objects[0], objects[6 * 16 + 8]), (0.0, 7.0));
    folder.write("told.toml", folder.done("render ball.xml --print-scene --spp 1").out);
    let scene = json(&folder, "inspect told.toml --json");
    assert_eq!(scene["scene"]["render"]["spp"], 4);
    assert_eq!(scene["scene_hash"], json(&folder, "inspect ball.xml --json")["scene_hash"]);
}

#[test]
fn what_is_in_a_scene_is_counted() {
    let folder = Folder::new();
    folder.write("fog.pbrt", pbrt_scene());
    let contents = &json(&folder, "inspect fog.pbrt --json")["contents"];
    assert_eq!((&contents["shapes"], &contents["triangles"]), (&1.into(), &162.into()), "{contents}");
    assert_eq!(contents["materials"]["diffuse"], 1);
    assert_eq!(contents["lights"]["constant"], 1);
    assert_eq!(contents["world_box"][0][0], -4.5);
    let text = folder.done("inspect fog.pbrt").out;
    assert!(text.contains("162 triangles") && text.contains("1 diffuse"), "{text}");
}

#[test]
fn what_is_not_supported_is_said_and_strictly_refused() {
    let folder = Folder::new();
    let strange = "\nTexture \"t\" \"spectrum\" \"marble\"\nLightSource \"projection\"\n";
    folder.write("strange.pbrt", pbrt_scene() + strange);
    let run = folder.done("render strange.pbrt -o a.png --progress none");
    let notes: Vec<&str> = run.err.lines().filter(|line| line.starts_with("note: strange.pbrt:")).collect();
    assert!(notes.iter().any(|note| note.contains("projection")), "{}", run.err);
    for line in ["render strange.pbrt --strict -o b.png", "inspect strange.pbrt --strict"] {
        let run = folder.run(line);
        assert_eq!((run.code, run.out.as_str()), (Some(1), ""), "{line}");
        assert!(run.err.lines().all(|line| line.starts_with("error: strange.pbrt:")), "{}", run.err);
        assert!(run.err.contains("projection"), "{}", run.err);
    }
    assert!(!folder.path("b.png").exists());
}
