//! Media, and the surfaces where they begin and end.

use tyndall_import::NoteKind;
use tyndall_scene::SceneDescription;
use tyndall_scene::description::{Names, PhaseDescription, VolumeDescription};

use crate::{Scene, scene, world};

const FOG: &str = "MakeNamedMedium \"fog\" \"string type\" \"homogeneous\" \"rgb sigma_s\" [ 2 2 2 ] \"rgb sigma_a\" [ 1 1 1 ]\n";
const MILK: &str = "MakeNamedMedium \"milk\" \"string type\" \"homogeneous\" \"rgb sigma_s\" [ 2.8 4.88 7.6 ] \"rgb sigma_a\" [ 0.1 0.1 0.1 ] \"float g\" 0.6 \"float scale\" 10\n";
const BOX: &str = "Shape \"trianglemesh\" \"point3 P\" [ -1 -1 -1  1 -1 -1  1 1 -1  -1 1 -1  -1 -1 1  1 -1 1  1 1 1  -1 1 1 ] \"integer indices\" [ 0 2 1 0 3 2 4 5 6 4 6 7 0 1 5 0 5 4 3 7 6 3 6 2 0 4 7 0 7 3 1 2 6 1 6 5 ]\n";

fn one(name: &str) -> Option<Names> {
    Some(Names::One(name.to_owned()))
}

fn only(description: &SceneDescription) -> &VolumeDescription {
    assert_eq!((description.volumes.len(), description.shapes.len()), (1, 0));
    &description.volumes[0]
}

/// With a camera at `place`, in `medium`.
fn seen_from(place: &str, medium: &str, text: &str) -> Scene {
    scene(&format!(
        "{FOG}{MILK}MediumInterface \"\" \"{medium}\" LookAt {place} 9 9 9 0 1 0 Camera \"perspective\" WorldBegin MediumInterface \"\" \"\"\n{text}"
    ))
}

#[test]
fn a_medium_in_a_box_or_a_sphere_needs_no_surface() {
    let boxed = world(&format!(
        "{FOG} Translate 1 2 3 Scale 2 1 -1 MediumInterface \"fog\" \"\" Material \"interface\" {BOX}"
    ));
    let volume = only(&boxed.imported.description);
    let cuboid = volume.cuboid.unwrap();
    assert_eq!((cuboid.min, cuboid.max, volume.transform.clone()), ([-1.0, 1.0, 2.0], [3.0, 3.0, 4.0], None));
    assert_eq!(
        (volume.medium.mu_s.clone(), volume.medium.mu_a.clone()),
        (Some(2.0.into()), Some(1.0.into()))
    );
    assert!(boxed.is_whole() && boxed.imported.description.camera.inside.is_none());

    let turned = world(&format!(
        "{FOG} Translate 0 0 9 Rotate 45 0 1 0 MediumInterface \"fog\" \"\" Material \"interface\" {BOX}"
    ));
    assert!(only(&turned.imported.description).transform.is_some());

    let ball = world(&format!(
        "{MILK} Translate 0 5 0 Scale 2 2 2 MediumInterface \"milk\" \"\" Material \"interface\" Shape \"sphere\""
    ));
    let volume = only(&ball.imported.description);
    let sphere = volume.sphere.as_ref().unwrap();
    assert_eq!((sphere.center, sphere.radius, volume.medium.scale), ([0.0, 5.0, 0.0], 2.0, Some(10.0)));
    assert_eq!(volume.medium.phase, Some(PhaseDescription::Hg { g: 0.6 }));
}

#[test]
fn a_box_turned_inside_out_or_with_a_hole_is_a_surface() {
    for text in [
        format!("ReverseOrientation {BOX}"),
        BOX.replace("0 2 1 0 3 2", "0 1 2 0 2 3"),
        BOX.replace("0 2 1 0 3 2 ", ""),
    ] {
        let scene = world(&format!("{FOG} MediumInterface \"fog\" \"\" Material \"interface\" {text}"));
        let description = &scene.imported.description;
        assert_eq!(
            (description.volumes[0].cuboid, description.shapes[0].interior.clone()),
            (None, one("fog"))
        );
        assert_eq!(description.camera.inside, Some(Names::Several(vec![])));
    }
}

#[test]
fn glass_with_milk_in_it_keeps_its_surface() {
    let scene = world(&format!(
        "{MILK} MediumInterface \"milk\" \"\" Material \"dielectric\" Shape \"sphere\"
         Material \"diffuse\" Shape \"disk\""
    ));
    let description = &scene.imported.description;
    assert_eq!((description.volumes.len(), description.shapes.len()), (1, 2));
    assert_eq!(
        (description.shapes[0].interior.clone(), description.shapes[0].exterior.clone()),
        (one("milk"), None)
    );
    // What lets nothing through bounds nothing.
    assert_eq!(description.shapes[1].interior, None);
    assert!(description.volumes[0].sphere.is_none());
}

#[test]
fn a_medium_around_the_camera_and_everything_fills_the_scene() {
    let scene = seen_from(
        "0 0 5",
        "fog",
        "MediumInterface \"milk\" \"fog\" Material \"dielectric\" Shape \"sphere\"",
    );
    let description = &scene.imported.description;
    assert_eq!(description.medium.as_ref().unwrap().mu_s, Some(2.0.into()));
    assert_eq!(
        (description.shapes[0].interior.clone(), description.shapes[0].exterior.clone()),
        (one("milk"), one("medium"))
    );
    assert_eq!(description.camera.inside, Some(Names::Several(vec![])));
    let alone = seen_from("0 0 5", "fog", "Shape \"disk\"");
    assert!(
        alone.imported.description.medium.is_some() && alone.imported.description.camera.inside.is_none()
    );
}

#[test]
fn nested_media_end_where_others_begin() {
    let text = "Material \"interface\"
        AttributeBegin Scale 3 3 3 MediumInterface \"fog\" \"\" Shape \"sphere\" AttributeEnd
        MediumInterface \"milk\" \"fog\" Shape \"sphere\"";
    let description = seen_from("0 0 2", "fog", text).imported.description;
    assert_eq!((description.volumes.len(), description.shapes.len()), (2, 2));
    assert_eq!(
        (description.shapes[0].interior.clone(), description.shapes[0].exterior.clone()),
        (one("fog"), None)
    );
    assert_eq!(
        (description.shapes[1].interior.clone(), description.shapes[1].exterior.clone()),
        (one("milk"), one("fog"))
    );
    assert_eq!(description.camera.inside, Some(Names::Several(vec!["fog".to_owned()])));
    let outside = seen_from("0 0 7", "", text).imported.description;
    assert_eq!(outside.camera.inside, Some(Names::Several(vec![])));
}

#[test]
fn a_camera_that_is_told_another_medium_than_it_stands_in_is_believed() {
    let text = format!("Material \"interface\" MediumInterface \"fog\" \"\" {BOX}");
    // In the box and in fog, or out of both: the box alone says it.
    for (place, medium) in [("0 0 0", "fog"), ("0 0 5", "")] {
        only(&seen_from(place, medium, &text).imported.description);
    }
    let unaware = seen_from("0 0 0", "", &text).imported.description;
    assert_eq!((unaware.shapes.len(), unaware.camera.inside), (1, Some(Names::Several(vec![]))));
    let beyond = seen_from("0 0 5", "fog", &text).imported.description;
    assert_eq!(
        (beyond.shapes.len(), beyond.camera.inside),
        (1, Some(Names::Several(vec!["fog".to_owned()])))
    );
}

#[test]
fn surfaces_between_a_medium_and_itself_are_nothing() {
    let scene =
        seen_from("0 0 5", "fog", "MediumInterface \"fog\" \"fog\" Material \"interface\" Shape \"sphere\"");
    assert!(scene.imported.description.shapes.is_empty() && scene.imported.description.medium.is_some());
}

#[test]
fn two_boxes_of_one_medium_are_surfaces_of_one_volume() {
    let scene = world(&format!(
        "{FOG} MediumInterface \"fog\" \"\" Material \"interface\" {BOX} Translate 5 0 0 {BOX}"
    ));
    let description = &scene.imported.description;
    assert_eq!((description.volumes.len(), description.shapes.len()), (1, 2));
    assert!(description.shapes.iter().all(|shape| shape.interior == one("fog")));
}

#[test]
fn measured_media_have_the_reduced_coefficient_of_pbrt() {
    let medium = |preset: &str| {
        let text = format!(
            "MakeNamedMedium \"m\" \"string type\" \"homogeneous\" \"string preset\" \"{preset}\"
             MediumInterface \"m\" \"\" Material \"interface\" Shape \"sphere\""
        );
        world(&text).imported.description.volumes[0].medium.clone()
    };
    assert_eq!(medium("Skimmilk").mu_s, Some([0.7, 1.22, 1.9].into()));
    // Narasimhan et al. 2006 measured 9.12 (1 - 0.902) and so on of low-fat milk.
    let text = format!("{:?}", medium("Lowfat Milk").mu_s);
    let numbers: Vec<f64> = text.split(['[', ']', ',']).filter_map(|word| word.trim().parse().ok()).collect();
    for (number, expected) in numbers.iter().zip([0.89187, 1.5136, 2.532]) {
        assert!((number / expected - 1.0).abs() < 1e-3, "{text}");
    }
    assert_eq!(medium("Skimmilk").phase, None);
}

#[test]
fn media_that_are_nowhere_are_told_of() {
    let scene = world(FOG);
    assert!(scene.imported.description.volumes.is_empty());
    let notes = scene.notes(NoteKind::Choice);
    assert!(notes.len() == 1 && notes[0].contains("\"fog\""), "{notes:?}");
}

#[test]
fn emission_is_normalised_as_light_is() {
    let text = "MakeNamedMedium \"m\" \"string type\" \"homogeneous\" \"spectrum Le\" [ 300 50 900 50 ] \"float Lescale\" 3
        MediumInterface \"m\" \"\" Material \"interface\" Shape \"sphere\"";
    let description = world(text).imported.description;
    let emission = description.volumes[0].medium.emission.clone().unwrap().light().unwrap();
    assert!((emission.at(550.0) - 3.0).abs() < 1e-9, "{emission:?}");
}
