//! Every fault is one line that names the file, its line, and the mend.

use std::io::Write;

use flate2::Compression;
use flate2::write::GzEncoder;

use crate::{import, scene_with};

fn error(text: &str) -> String {
    let folder = tempfile::tempdir().unwrap();
    let error = import(text, folder.path()).map(|_| ()).expect_err(text).to_string();
    error.replace(&format!("{}/", folder.path().display()), "")
}

#[test]
fn faults_name_their_line() {
    for (text, line, word) in [
        ("", 0, "WorldBegin"),
        ("Film", 1, "string"),
        ("\n\nFlim \"rgb\"", 3, "`Flim` is no directive"),
        ("3 WorldBegin", 1, "`3` is no directive"),
        ("WorldBegin\nShape \"sphere\" \"float radius\" [ 1", 2, "not closed"),
        ("WorldBegin\nShape \"sphere\" \"float radius\" true", 2, "not of its type `float`"),
        ("WorldBegin\nShape \"sphere\" \"radius\" 1", 2, "no parameter"),
        ("WorldBegin\nShape \"sphere\" \"quux radius\" 1", 2, "no type"),
        ("WorldBegin\nShape \"sphere\" \"float radius\" -1", 2, "above 0"),
        ("WorldBegin\nShape \"sphere\" \"float radius\" [ 1 2 ]", 2, "one number"),
        ("WorldBegin\nShape \"sphere\" \"float radius\" 1e999", 2, "no value"),
        ("WorldBegin\nShape \"cube\"", 2, "\"cube\" is no shape"),
        ("WorldBegin\nMaterial \"gold\" Shape \"sphere\"", 2, "\"gold\" is no material"),
        ("WorldBegin\nNamedMaterial \"x\"\nShape \"sphere\"", 2, "no material \"x\""),
        (
            "WorldBegin\nMediumInterface \"x\" \"\"\nMaterial \"interface\" Shape \"sphere\"",
            3,
            "no medium \"x\"",
        ),
        (
            "WorldBegin\nMaterial \"diffuse\" \"texture reflectance\" \"t\" Shape \"sphere\"",
            2,
            "no texture \"t\"",
        ),
        ("WorldBegin\nMaterial \"diffuse\" \"rgb reflectance\" [ 2 0 0 ] Shape \"sphere\"", 2, "0 to 1"),
        ("WorldBegin\nLightSource \"infinite\" \"rgb L\" [ 1 2 ]", 2, "three numbers"),
        ("WorldBegin\nLightSource \"infinite\" \"string filename\" \"x.exr\"", 2, "cannot be read"),
        ("WorldBegin\nLightSource \"distant\" \"point3 to\" [ 0 0 0 ]", 2, "direction"),
        ("WorldBegin\nLightSource \"moon\"", 2, "no light"),
        ("WorldBegin\nAttributeBegin\n", 2, "AttributeEnd"),
        ("WorldBegin\n\nAttributeEnd", 3, "nothing was begun"),
        ("WorldBegin\nObjectBegin \"a\"\nAttributeEnd", 3, "ObjectEnd"),
        ("WorldBegin\nObjectInstance \"a\"", 2, "no object \"a\""),
        ("WorldBegin\nScale 1 0 1\nShape \"sphere\"", 3, "flattens"),
        ("WorldBegin\nTransform [ 1 0 0 1 0 1 0 0 0 0 1 0 0 0 0 1 ]", 2, "not affine"),
        ("WorldBegin\nRotate 10 0 0 0", 2, "axis"),
        ("WorldBegin\nTranslate 1 2", 2, "3 numbers"),
        ("LookAt 0 0 0 0 0 0 0 1 0", 1, "camera"),
        ("Shape \"sphere\"", 1, "after `WorldBegin`"),
        ("WorldBegin\nFilm \"rgb\"", 2, "before `WorldBegin`"),
        ("WorldBegin\nWorldEnd", 2, "pbrt-v3"),
        ("Camera \"perspective\" \"float fov\" 180 WorldBegin", 1, "`fov`"),
        ("Camera \"fish\" WorldBegin", 1, "no camera"),
        ("Film \"rgb\" \"integer xresolution\" 0 WorldBegin", 1, "`xresolution`"),
        ("Film \"rgb\" \"integer xresolution\" 10.5 WorldBegin", 1, "whole number"),
        ("Include \"nowhere.pbrt\"", 1, "cannot be read"),
        ("\nInclude \"scene.pbrt\"", 2, "includes itself"),
        (
            "WorldBegin\nShape \"trianglemesh\" \"point3 P\" [ 0 0 0 ] \"integer indices\" [ 0 1 2 ]",
            2,
            "not there",
        ),
        ("WorldBegin\nShape \"trianglemesh\" \"point3 P\" [ 0 0 0 1 ]", 2, "3 numbers"),
        (
            "WorldBegin\nMakeNamedMaterial \"a\" \"string type\" \"mix\" \"string materials\" [ \"a\" \"a\" ]",
            2,
            "\"a\" above",
        ),
    ] {
        let found = error(text);
        let place = if line == 0 { "scene.pbrt: ".to_owned() } else { format!("scene.pbrt:{line}: ") };
        assert!(found.starts_with(&place) && found.contains(word), "{text}\n{found}");
        assert!(!found.contains('\n'), "{found}");
    }
}

#[test]
fn media_say_what_is_wrong_with_them() {
    let used = "MediumInterface \"m\" \"\" Material \"interface\" Shape \"sphere\"";
    for (medium, word) in [
        ("", "string type"),
        ("\"string type\" \"jelly\"", "no medium"),
        ("\"string type\" \"homogeneous\" \"float g\" 1", "`g`"),
        ("\"string type\" \"homogeneous\" \"string preset\" \"Tar\"", "no measured medium"),
        ("\"string type\" \"homogeneous\" \"float scale\" -1", "`scale`"),
        ("\"string type\" \"uniformgrid\"", "`density`"),
        (
            "\"string type\" \"uniformgrid\" \"integer nx\" 3 \"float density\" [ 1 2 ]",
            "2 values for 3 x 1 x 1",
        ),
        ("\"string type\" \"uniformgrid\" \"float density\" 1 \"point3 p1\" [ 0 1 1 ]", "flat"),
        ("\"string type\" \"rgbgrid\"", "needs `sigma_a` or `sigma_s`"),
        ("\"string type\" \"rgbgrid\" \"rgb sigma_a\" [ 1 2 ]", "three numbers"),
        ("\"string type\" \"nanovdb\" \"string filename\" \"scene.pbrt\"", "scene.pbrt"),
    ] {
        let found = error(&format!("WorldBegin\nMakeNamedMedium \"m\" {medium}\n{used}"));
        assert!(found.starts_with("scene.pbrt:2: ") && found.contains(word), "{medium}\n{found}");
    }
}

#[test]
fn faults_in_included_files_name_these() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("part.pbrt"), "\n\nShape \"cube\"").unwrap();
    let error = import("WorldBegin\nInclude \"part.pbrt\"", folder.path()).map(|_| ()).unwrap_err();
    assert!(error.file.ends_with("part.pbrt") && error.line == Some(3), "{error}");
}

#[test]
fn included_and_packed_files_go_on_where_they_are_named() {
    let mut packed = GzEncoder::new(Vec::new(), Compression::default());
    packed.write_all(b"Translate 1 0 0 Shape \"sphere\"").unwrap();
    let packed = packed.finish().unwrap();
    let text =
        "WorldBegin Include \"part.pbrt.gz\" Shape \"sphere\" Import \"part.pbrt.gz\" Shape \"sphere\"";
    let scene = scene_with(text, &[("part.pbrt.gz", &packed)]);
    let shapes = &scene.imported.description.shapes;
    let x: Vec<f64> = shapes.iter().map(|shape| shape.sphere.as_ref().unwrap().center[0]).collect();
    // What is included moves the rest, what is imported does not.
    assert_eq!(x, [1.0, 1.0, 2.0, 1.0]);
}
