//! Names replaced by numbers: what things are called does not change what is seen, but what refers to what does.

use std::collections::HashMap;

use crate::SceneDescription;
use crate::description::{MaterialChoice, MaterialDescription, Names};

/// Takes the names of volumes and shapes away, and calls volumes and materials by number wherever they are referred to.
pub(crate) fn without_names(scene: &mut SceneDescription) {
    let mut volumes = HashMap::new();
    for (number, volume) in scene.volumes.iter_mut().enumerate() {
        if let Some(name) = volume.name.take() {
            volumes.insert(name, format!("volume.{number}"));
        }
    }
    let mut materials = HashMap::new();
    for (number, material) in scene.materials.iter_mut().enumerate() {
        let canonical = format!("material.{number}");
        materials.insert(std::mem::replace(&mut material.name, canonical.clone()), canonical);
    }
    for material in &mut scene.materials {
        rename_parts(&mut material.material, &materials);
    }
    let of_shapes = scene.shapes.iter_mut().flat_map(|shape| [&mut shape.interior, &mut shape.exterior]);
    for names in of_shapes.chain([&mut scene.camera.inside]).flatten() {
        let renamed = names.all().iter().map(|name| volumes.get(name).unwrap_or(name).clone()).collect();
        *names = Names::Several(renamed);
    }
    for shape in &mut scene.shapes {
        shape.name = None;
        if let Some(material) = &mut shape.material {
            rename(material, &materials);
        }
    }
}

fn rename(choice: &mut MaterialChoice, names: &HashMap<String, String>) {
    match choice {
        MaterialChoice::Name(name) => {
            if let Some(canonical) = names.get(name) {
                name.clone_from(canonical);
            }
        }
        MaterialChoice::Here(material) => rename_parts(material, names),
    }
}

fn rename_parts(material: &mut MaterialDescription, names: &HashMap<String, String>) {
    if let MaterialDescription::Mix { materials, .. } = material {
        materials.iter_mut().for_each(|part| rename(part, names));
    }
}
