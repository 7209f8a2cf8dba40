//! What the ranges of single keys cannot say of materials: which keys go together, and which names there are.

use tyndall_optics::{Metal, dielectric_index, dielectric_names};

use super::rules::Findings;
use super::{
    IndexChoice, KeyProblem, MaterialChoice, MaterialDescription, NamedMaterial, SceneDescription,
    SpectrumDescription, TextureDescription,
};
use crate::suggestion::did_you_mean;
use crate::surface::{MOST_PARTS, conductor_index};

/// The material of that name, or what is wrong and the mend.
pub(crate) fn material_of_name<'a>(
    name: &str,
    named: &'a [NamedMaterial],
) -> Result<&'a NamedMaterial, String> {
    named.iter().find(|material| material.name == name).ok_or_else(|| {
        let names = named.iter().map(|material| material.name.as_str());
        let mend =
            if named.is_empty() { "; add a [[material]]".to_owned() } else { did_you_mean(name, names) };
        format!("there is no material `{name}`{mend}")
    })
}

/// That there is no metal of that name.
pub(crate) fn no_metal(name: &str) -> String {
    let mend = did_you_mean(name, Metal::all().map(Metal::name));
    format!("there is no measured metal `{name}`{mend}")
}

/// That there is no transparent substance of that name.
pub(crate) fn no_substance(name: &str) -> String {
    let mend = did_you_mean(name, dielectric_names());
    format!("there is no substance `{name}`{mend}")
}

/// The materials of a scene, those with a name and those of shapes.
pub(super) fn materials(found: &mut Findings, scene: &SceneDescription) {
    let named = &scene.materials;
    let mut parts = vec![Parts::Unknown; named.len()];
    for (number, here) in named.iter().enumerate() {
        found.within("material", |found| {
            found.within(&number.to_string(), |found| {
                if named[..number].iter().any(|other| other.name == here.name) {
                    let message = format!("there are two materials `{}`: rename one", here.name);
                    found.report("name", message);
                } else if let Err(message) = count(number, named, &mut parts, &mut Vec::new()) {
                    found.report("", message);
                }
                material(found, &here.material, named);
            });
        });
    }
    for (number, shape) in scene.shapes.iter().enumerate() {
        if let Some(here) = &shape.material {
            found.within("shape", |found| {
                found.within(&number.to_string(), |found| {
                    found.within("material", |found| choice(found, here, named));
                });
            });
        }
    }
}

/// How many parts a named material is mixed of, as far as it is known.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Parts {
    Unknown,
    Known(usize),
    /// It was reported.
    Wrong,
}

/// Parts of a named material, of which `chain` leads to it; or that it is part of itself, or of too many.
fn count(
    number: usize,
    named: &[NamedMaterial],
    parts: &mut [Parts],
    chain: &mut Vec<usize>,
) -> Result<usize, String> {
    match parts[number] {
        Parts::Known(parts) => return Ok(parts),
        Parts::Wrong => return Ok(0),
        Parts::Unknown => {}
    }
    if let Some(first) = chain.iter().position(|other| *other == number) {
        let names: Vec<&str> =
            chain[first..].iter().chain([&number]).map(|number| named[*number].name.as_str()).collect();
        for wrong in &chain[first..] {
            parts[*wrong] = Parts::Wrong;
        }
        return Err(format!("a material is part of itself: {}", names.join(" -> ")));
    }
    chain.push(number);
    let sum = count_within(&named[number].material, named, parts, chain);
    chain.pop();
    let sum = sum?;
    if sum > MOST_PARTS {
        parts[number] = Parts::Wrong;
        return Err(format!("the material is mixed of more than {MOST_PARTS} parts: mix fewer"));
    }
    if parts[number] == Parts::Unknown {
        parts[number] = Parts::Known(sum);
    }
    Ok(sum)
}

fn count_within(
    material: &MaterialDescription,
    named: &[NamedMaterial],
    parts: &mut [Parts],
    chain: &mut Vec<usize>,
) -> Result<usize, String> {
    let MaterialDescription::Mix { materials, .. } = material else { return Ok(1) };
    let mut sum = 1_usize;
    for choice in materials {
        let inner = match choice {
            MaterialChoice::Here(inner) => count_within(inner, named, parts, chain)?,
            MaterialChoice::Name(name) => match named.iter().position(|other| other.name == *name) {
                Some(number) => count(number, named, parts, chain)?,
                None => 0,
            },
        };
        sum = sum.saturating_add(inner);
    }
    Ok(sum)
}

fn choice(found: &mut Findings, choice: &MaterialChoice, named: &[NamedMaterial]) {
    match choice {
        MaterialChoice::Here(here) => material(found, here, named),
        MaterialChoice::Name(name) => {
            if let Err(message) = material_of_name(name, named) {
                found.report("", message);
            }
        }
    }
}

fn material(found: &mut Findings, material: &MaterialDescription, named: &[NamedMaterial]) {
    for (key, description) in material.textures() {
        texture(found, key, description);
    }
    match material {
        MaterialDescription::Conductor { metal, eta, k, reflectance, .. } => {
            let index = conductor_index(metal.as_deref(), eta.as_ref(), k.as_ref(), reflectance.as_ref());
            if let Err((key, message)) = index {
                found.report(key, message);
            }
        }
        MaterialDescription::Dielectric { index: IndexChoice::Name(name), .. }
        | MaterialDescription::ThinDielectric { index: IndexChoice::Name(name), .. }
        | MaterialDescription::Plastic { index: IndexChoice::Name(name), .. } => {
            if dielectric_index(name).is_none() {
                found.report("index", format!("`index`: {}", no_substance(name)));
            }
        }
        MaterialDescription::Dielectric { index: IndexChoice::Number(index), .. }
        | MaterialDescription::ThinDielectric { index: IndexChoice::Number(index), .. }
        | MaterialDescription::Plastic { index: IndexChoice::Number(index), .. } => {
            if !(0.01..=100.0).contains(index) {
                found.report("index", format!("`index` must be from 0.01 to 100, not {index}"));
            }
        }
        MaterialDescription::Mix { materials, .. } => found.within("materials", |found| {
            for (number, inner) in materials.iter().enumerate() {
                found.within(&number.to_string(), |found| choice(found, inner, named));
            }
        }),
        MaterialDescription::Diffuse { .. }
        | MaterialDescription::RoughDiffuse { .. }
        | MaterialDescription::Null => {}
    }
}

fn texture(found: &mut Findings, key: &'static str, description: &TextureDescription) {
    let spectra: Vec<(Vec<String>, &SpectrumDescription)> = match description {
        TextureDescription::Constant(spectrum) => vec![(vec![], spectrum)],
        TextureDescription::Image(_) => vec![],
        TextureDescription::Checker(checker) => {
            let place = |number: usize| vec!["checker".to_owned(), number.to_string()];
            checker.checker.iter().enumerate().map(|(number, spectrum)| (place(number), spectrum)).collect()
        }
    };
    for (mut place, spectrum) in spectra {
        let Err((inner, message)): Result<_, KeyProblem> = spectrum.fraction() else { continue };
        place.insert(0, key.to_owned());
        place.extend((!inner.is_empty()).then(|| inner.to_owned()));
        within_all(found, &place, |found| found.report("", format!("`{key}`: {message}")));
    }
    if let TextureDescription::Image(image) = description
        && image.image.is_empty()
    {
        found.within(key, |found| found.report("image", "`image` is empty: give the name of a picture"));
    }
}

fn within_all(found: &mut Findings, place: &[String], inspect: impl FnOnce(&mut Findings)) {
    match place {
        [] => inspect(found),
        [first, rest @ ..] => found.within(first, |found| within_all(found, rest, inspect)),
    }
}
