//! What shapes refer to: files, materials and volumes.

use std::fs;

use tyndall_scene::{build, scene_hash};

use super::{built, scene};

const MILK: &str = "[medium]\nmu_t = 0.1\nalbedo = 1\n\
    [[volume]]\nname = 'nothing'\nmu_t = 0\nalbedo = 1\nbox = { min = [0, 0, 0], max = [1, 1, 1] }\n\
    [[volume]]\nname = 'milk'\nmu_t = 1\nalbedo = 1\n\
    [[shape]]\nname = 'glass'\nmaterial = { type = 'null' }\nsphere = { center = [0, 0, 0], radius = 1 }\n\
    interior = ['milk', 'nothing']\nexterior = 'medium'\n";

#[test]
fn shapes_know_the_volumes_of_the_scene_by_number() {
    let built = built(&scene(MILK));
    let names: Vec<&str> = built.scene.volumes.iter().map(|volume| volume.name.as_str()).collect();
    assert_eq!(names, ["medium", "milk"]);
    let shape = &built.scene.surfaces.shapes[0];
    assert_eq!(
        (&shape.interior[..], &shape.exterior[..]),
        (&[1][..], &[0][..]),
        "what is not there has no number"
    );
    assert!(!built.notes.iter().any(|note| note.contains("closed")), "{:?}", built.notes);
}

#[test]
fn an_open_boundary_is_noted() {
    for open in [
        "rectangle = { corner = [0, 0, 0], u = [1, 0, 0], v = [0, 1, 0] }",
        "cylinder = { from = [0, 0, 0], to = [1, 0, 0], radius = 1 }",
        "mesh = { vertices = [[0, 0, 0], [1, 0, 0], [0, 1, 0]], triangles = [[0, 1, 2]] }",
    ] {
        let built = built(&scene(&MILK.replace("sphere = { center = [0, 0, 0], radius = 1 }", open)));
        assert!(
            built.notes.iter().any(|note| note.starts_with("glass: the surface is not closed")),
            "{:?}",
            built.notes
        );
    }
}

#[test]
fn a_mesh_file_is_read_and_its_faults_are_named() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.obj");
    let description = scene("[[shape]]\nmaterial = 'grey'\nmesh = { file = 'a.obj' }\ninstances = [{}, {}]");
    let error = build(&description, folder.path()).unwrap_err().to_string();
    assert!(
        error.ends_with(
            "a.obj: there is no such file; mend the key `file`, which is relative to the scene file"
        )
    );
    fs::write(&path, "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\nf 1 2 2\n").unwrap();
    let built = build(&description, folder.path()).unwrap();
    assert_eq!(built.scene.surfaces.shapes.len(), 2);
    let note = format!("{}: 1 triangle has no area and is left out", path.display());
    assert_eq!(built.notes.iter().filter(|other| **other == note).count(), 1, "{:?}", built.notes);
}

/// What is seen depends on the bytes of a mesh and of a picture, and not on what things are called.
#[test]
fn the_hash_covers_the_files_of_shapes_and_no_names() {
    let folder = tempfile::tempdir().unwrap();
    for (name, content) in
        [("a.obj", "1"), ("same.obj", "1"), ("other.obj", "2"), ("a.png", "3"), ("other.png", "4")]
    {
        fs::write(folder.path().join(name), content).unwrap();
    }
    let text = "[[material]]\nname = 'tiles'\ntype = 'diffuse'\nreflectance = { image = 'a.png' }\n\
                [[volume]]\nname = 'milk'\nmu_t = 1\nalbedo = 1\n\
                [[volume]]\nname = 'tea'\nmu_t = 2\nalbedo = 1\n\
                [[shape]]\nname = 'jug'\nmaterial = 'tiles'\nmesh = { file = 'a.obj' }\ninterior = ['milk', 'tea']\n\
                [[shape]]\nmaterial = { type = 'mix', materials = ['grey', { type = 'null' }], amount = { image = 'a.png' } }\n\
                sphere = { center = [0, 0, 0], radius = 1 }\n";
    let hash = |from: &str, to: &str| scene_hash(&scene(&text.replace(from, to)), folder.path()).unwrap();
    let plain = hash("", "");
    for (from, to) in
        [("a.obj", "same.obj"), ("'milk'", "'cream'"), ("'tiles'", "'stone'"), ("'jug'", "'pot'")]
    {
        assert_eq!(hash(from, to), plain, "{from} {to}");
    }
    for (from, to) in [
        ("a.obj", "other.obj"),
        ("reflectance = { image = 'a.png' }", "reflectance = { image = 'other.png' }"),
        ("amount = { image = 'a.png' }", "amount = { image = 'other.png' }"),
        ("['milk', 'tea']", "['milk']\nexterior = 'tea'"),
        ("material = 'tiles'", "material = 'grey'"),
        ("['grey', {", "['tiles', {"),
        ("radius = 1", "radius = 1\n}\nflip = true\n#"),
    ] {
        let (from, to) = (from, to.replace("radius = 1\n}\nflip = true\n#", "radius = 1.5"));
        // A volume that nothing bounds is refused: both are bounded in all of these.
        let to = to.replace("['milk']\nexterior = 'tea'", "['tea', 'milk']\nexterior = 'tea'");
        assert_ne!(hash(from, &to), plain, "{from} {to}");
    }
}
