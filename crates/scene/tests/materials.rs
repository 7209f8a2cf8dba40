//! Materials: what becomes of their descriptions, and what is said of those that are wrong.

use std::fs;
use std::path::Path;

use glam::{DVec3, DVec4};
use tyndall_optics::bsdf::{Bsdf, fresnel};
use tyndall_scene::description::NamedMaterial;
use tyndall_scene::surface::{Material, MaterialBuilder};
use tyndall_scene::{Channels, Hit, SceneDocument};

const CAMERA: &str = "[camera]\nposition = [0, 0, 5]\ntarget = [0, 0, 0]\n";

fn materials(text: &str) -> Vec<NamedMaterial> {
    let document = SceneDocument::parse("scene.toml", &format!("{CAMERA}{text}"));
    match document.and_then(|document| document.description()) {
        Ok(description) => description.materials,
        Err(error) => panic!("{error}"),
    }
}

/// The last material of a text, whose pictures are in `folder`.
fn build_in(text: &str, folder: &Path) -> Result<(Material, Vec<String>), String> {
    let named = materials(text);
    let mut notes = Vec::new();
    let last = &named[named.len() - 1].material;
    let material = Material::build(last, &named, folder, "material", &mut notes);
    material.map(|material| (material, notes)).map_err(|error| error.to_string())
}

fn build(text: &str) -> Material {
    build_in(text, Path::new("")).unwrap().0
}

/// The problems that a scene has, one for each.
fn problems(text: &str) -> Vec<String> {
    let document = SceneDocument::parse("scene.toml", &format!("{CAMERA}{text}"));
    match document.and_then(|document| document.description()) {
        Ok(description) => panic!("this was read: {description:?}"),
        Err(error) => error.problems().iter().map(ToString::to_string).collect(),
    }
}

fn hit(uv: [f64; 2]) -> Hit {
    Hit {
        t: 1.0,
        position: DVec3::ZERO,
        normal: DVec3::Z,
        shading_normal: DVec3::Z,
        tangent: DVec3::X,
        uv,
        shape: 0,
        primitive: 0,
        offset: 0.0,
    }
}

fn reflectance(material: &Material, uv: [f64; 2], channels: &Channels) -> DVec4 {
    match material.bsdf(&hit(uv), channels) {
        Bsdf::Diffuse { reflectance } => reflectance,
        other => panic!("{other:?}"),
    }
}

#[test]
fn every_kind_is_built() {
    let all = [
        ("type = \"diffuse\"", "Diffuse"),
        ("type = \"rough_diffuse\"\nsigma = 20", "RoughDiffuse"),
        ("type = \"conductor\"\nmetal = \"gold\"\nroughness = 0.1", "Conductor"),
        ("type = \"conductor\"\nreflectance = [0.9, 0.5, 0.2]", "Conductor"),
        ("type = \"dielectric\"\nindex = \"bk7\"\nroughness = [0.1, 0.2]", "Dielectric"),
        ("type = \"thin_dielectric\"", "ThinDielectric"),
        ("type = \"plastic\"\nreflectance = 0.3\nroughness = 0.1", "Plastic"),
        ("type = \"mix\"\nmaterials = [{ type = \"diffuse\" }, { type = \"plastic\" }]\namount = 0.3", "Mix"),
        ("type = \"null\"", "Black"),
    ];
    for (text, kind) in all {
        let material = build(&format!("[[material]]\nname = \"it\"\n{text}\n"));
        for channels in [Channels::Rgb, Channels::Wavelengths([400.0, 500.0, 600.0, 700.0])] {
            let bsdf = material.bsdf(&hit([0.3, 0.4]), &channels);
            assert!(format!("{bsdf:?}").starts_with(kind), "{text}: {bsdf:?}");
            if matches!(channels, Channels::Rgb) {
                assert_eq!(bsdf.albedo().w, 0.0, "{text}");
            }
        }
    }
}

#[test]
fn a_mixture_with_null_is_an_opacity() {
    let text = r#"
        [[material]]
        name = "leaf"
        type = "mix"
        materials = [{ type = "null" }, { type = "diffuse", reflectance = [0.1, 0.6, 0.1] }]
        amount = [0.2, 0.3, 0.4]
    "#;
    let leaf = build(text);
    assert!(leaf.may_pass() && !leaf.is_opaque());
    assert!((leaf.pass_probability(&hit([0.0; 2])) - 0.7).abs() < 1e-12);
    // Where it is not passed it is the leaf alone.
    let expected = DVec4::new(0.1, 0.6, 0.1, 0.0);
    assert_eq!(reflectance(&leaf, [0.0; 2], &Channels::Rgb), expected);

    let nested = format!(
        r#"{text}
        [[material]]
        name = "tree"
        type = "mix"
        materials = ["leaf", {{ type = "diffuse", reflectance = 0.9 }}]
        amount = 0.5
        "#
    );
    let tree = build(&nested);
    assert!((tree.pass_probability(&hit([0.0; 2])) - 0.35).abs() < 1e-12);
    // Of the 65 % that do not pass, leaves are 15 and the rest 50.
    let (wo, wi) = (DVec3::Z, DVec3::new(0.6, 0.0, 0.8));
    let value = tree.bsdf(&hit([0.0; 2]), &Channels::Rgb).value(wo, wi) / (0.8 / std::f64::consts::PI);
    let expected = (expected * 0.15 + DVec4::new(0.9, 0.9, 0.9, 0.0) * 0.5) / 0.65;
    assert!((value - expected).abs().max_element() < 1e-12, "{value}");
}

#[test]
fn a_mask_of_black_and_white_leaves_one_material() {
    let material = build(
        r#"
        [[material]]
        name = "it"
        type = "mix"
        materials = [{ type = "null" }, { type = "diffuse", reflectance = 0.4 }]
        amount = { checker = [0, 1] }
        "#,
    );
    assert_eq!(material.pass_probability(&hit([0.5, 0.5])), 1.0);
    assert_eq!(material.bsdf(&hit([0.5, 0.5]), &Channels::Rgb), Bsdf::Black);
    assert_eq!(material.pass_probability(&hit([1.5, 0.5])), 0.0);
    assert_eq!(reflectance(&material, [1.5, 0.5], &Channels::Rgb).x, 0.4);
}

#[test]
fn wavelengths_see_the_metal_itself() {
    let copper = build("[[material]]\nname = \"it\"\ntype = \"conductor\"\nmetal = \"metal-Cu-eta\"\n");
    let nm = [450.0, 550.0, 600.0, 700.0];
    let albedo = copper.bsdf(&hit([0.0; 2]), &Channels::Wavelengths(nm)).albedo();
    let metal = tyndall_optics::metal("copper").unwrap();
    for (channel, nm) in nm.into_iter().enumerate() {
        let expected = fresnel::conductor(1.0, metal.eta().at(nm), metal.k().at(nm));
        assert!((albedo[channel] - expected).abs() < 1e-12);
    }
    // And red, green and blue look like copper.
    let rgb = copper.bsdf(&hit([0.0; 2]), &Channels::Rgb).albedo();
    assert!(rgb.x > 0.9 && rgb.x > rgb.y && rgb.y > rgb.z && rgb.z > 0.4, "{rgb}");

    let mirror = build("[[material]]\nname = \"it\"\ntype = \"conductor\"\nreflectance = [1, 0.5, 0]\n");
    let albedo = mirror.bsdf(&hit([0.0; 2]), &Channels::Rgb).albedo();
    assert!((albedo - DVec4::new(1.0, 0.5, 0.0, 0.0)).abs().max_element() < 1e-11, "{albedo}");
}

/// Two texels, red over grey, as PNG, JPEG, OpenEXR and Radiance.
fn write_pictures(folder: &Path) {
    let mut bytes = image::RgbImage::new(8, 16);
    for (_, row, texel) in bytes.enumerate_pixels_mut() {
        *texel = image::Rgb(if row < 8 { [255, 0, 0] } else { [188, 188, 188] });
    }
    bytes.save(folder.join("it.png")).unwrap();
    let numbers = image::Rgb32FImage::from_fn(8, 16, |_, row| {
        image::Rgb(if row < 8 { [2.0, 0.0, f32::NAN] } else { [0.5, 0.5, 0.5] })
    });
    let finite = image::Rgb32FImage::from_fn(8, 16, |x, y| {
        image::Rgb(numbers.get_pixel(x, y).0.map(|value| value.max(0.0)))
    });
    let deep = image::DynamicImage::ImageRgb32F(finite).into_rgb16();
    deep.save(folder.join("deep.png")).unwrap();
    let file = fs::File::create(folder.join("it.jpg")).unwrap();
    image::codecs::jpeg::JpegEncoder::new_with_quality(file, 100).encode_image(&bytes).unwrap();
    let file = fs::File::create(folder.join("it.hdr")).unwrap();
    let texels: Vec<image::Rgb<f32>> =
        numbers.pixels().map(|texel| image::Rgb(texel.0.map(|x| x.max(0.0)))).collect();
    image::codecs::hdr::HdrEncoder::new(file).encode(&texels, 8, 16).unwrap();
    exr::prelude::write_rgb_file(folder.join("it.exr"), 8, 16, |x, y| {
        let texel = numbers.get_pixel(x as u32, y as u32).0;
        (texel[0], texel[1], texel[2])
    })
    .unwrap();
}

fn picture(name: &str, more: &str) -> String {
    let texture = format!("{{ image = \"{name}\"{more} }}");
    format!("[[material]]\nname = \"it\"\ntype = \"diffuse\"\nreflectance = {texture}\n")
}

#[test]
fn pictures_of_every_format_are_read() {
    let folder = tempfile::tempdir().unwrap();
    write_pictures(folder.path());
    let grey = 0.502_886_5;
    for (name, more, expected, tolerance) in [
        ("it.png", "", grey, 1e-6),
        ("it.png", ", srgb = false", 188.0 / 255.0, 1e-6),
        ("it.png", ", factor = 0.5", 0.5 * grey, 1e-6),
        ("deep.png", ", srgb = false", 0.5, 1e-4),
        ("it.jpg", "", grey, 2e-2),
        ("it.exr", "", 0.5, 1e-6),
        ("it.hdr", "", 0.5, 5e-3),
    ] {
        let (material, _) = build_in(&picture(name, more), folder.path()).unwrap();
        let below = reflectance(&material, [0.5, 0.25], &Channels::Rgb);
        assert!((below.x - expected).abs() < tolerance && below.w == 0.0, "{name}{more}: {below}");
        let above = reflectance(&material, [0.5, 0.75], &Channels::Rgb);
        let red = above.x > 0.45 && above.x <= 1.0 && above.y < 0.02 && above.z < 0.02;
        assert!(red, "{name}{more}: {above}");
    }
    // What no surface reflects is said.
    let (_, notes) = build_in(&picture("it.exr", ""), folder.path()).unwrap();
    assert!(notes.len() == 1 && notes[0].contains("above 1"), "{notes:?}");
}

#[test]
fn one_picture_is_read_once() {
    let folder = tempfile::tempdir().unwrap();
    write_pictures(folder.path());
    let named = materials(&picture("it.png", ""));
    let mut builder = MaterialBuilder::new(&named, folder.path());
    let mut notes = Vec::new();
    builder.build(&named[0].material, "first", &mut notes).unwrap();
    fs::remove_file(folder.path().join("it.png")).unwrap();
    builder.build(&named[0].material, "second", &mut notes).unwrap();
}

#[test]
fn pictures_that_are_none_are_refused_in_one_line() {
    let folder = tempfile::tempdir().unwrap();
    write_pictures(folder.path());
    fs::write(folder.path().join("text.png"), "a text").unwrap();
    fs::write(folder.path().join("empty.png"), "").unwrap();
    // A PNG that claims 65535 × 65535 texels.
    let mut bytes = fs::read(folder.path().join("it.png")).unwrap();
    bytes[16..24].copy_from_slice(&[0, 0, 0xff, 0xff, 0, 0, 0xff, 0xff]);
    fs::write(folder.path().join("vast.png"), bytes).unwrap();
    for (name, part) in [
        ("text.png", "is neither a PNG"),
        ("empty.png", "is neither a PNG"),
        ("vast.png", ""),
        ("absent.png", "no such file"),
    ] {
        let message = build_in(&picture(name, ""), folder.path()).unwrap_err();
        assert!(message.contains(name) && message.contains(part) && !message.contains('\n'), "{message}");
    }
}

/// Cut short or changed anywhere, a picture is read or refused.
#[test]
fn damaged_pictures_do_no_harm() {
    let folder = tempfile::tempdir().unwrap();
    write_pictures(folder.path());
    let mut random = tyndall_lanes::Random::new(1, 0, 0);
    for name in ["it.png", "deep.png", "it.jpg", "it.exr", "it.hdr"] {
        let sound = fs::read(folder.path().join(name)).unwrap();
        let path = format!("damaged_{name}");
        let named = materials(&picture(&path, ""));
        for _ in 0..150 {
            let mut bytes = sound.clone();
            let at = (random.f64() * bytes.len() as f64) as usize;
            if random.f64() < 0.3 {
                bytes.truncate(at)
            } else {
                bytes[at] = random.bits() as u8
            }
            fs::write(folder.path().join(&path), bytes).unwrap();
            let material = Material::build(&named[0].material, &named, folder.path(), "it", &mut Vec::new());
            if let Err(error) = material {
                let message = error.to_string();
                assert!(message.contains(&path) && !message.contains('\n'), "{message}");
            }
        }
    }
}

#[test]
fn what_is_wrong_with_a_material_is_said_where_it_stands() {
    let named = |text: &str| format!("[[material]]\nname = \"it\"\n{text}\n");
    for (text, expected) in [
        ("type = \"conductor\"", "scene.toml:4:1: the conductor has no refractive index"),
        (
            "type = \"conductor\"\nmetal = \"coper\"",
            "scene.toml:7:1: there is no measured metal `coper`, did you mean `copper`?",
        ),
        (
            "type = \"conductor\"\nmetal = \"gold\"\nreflectance = 1",
            "scene.toml:8:1: the conductor is given in several ways",
        ),
        ("type = \"conductor\"\neta = 1", "scene.toml:7:1: `eta` and `k` belong together"),
        (
            "type = \"dielectric\"\nindex = \"watr\"",
            "scene.toml:7:1: `index`: there is no substance `watr`, did you mean `water`?",
        ),
        ("type = \"dielectric\"\nindex = 0.001", "`index` must be from 0.01 to 100"),
        ("type = \"dielectric\"\nindex = 0", "above 0"),
        ("type = \"diffuse\"\nreflectance = 1.5", "from 0 to 1"),
        ("type = \"diffuse\"\nreflectance = { blackbody = 3000 }", "is light and no coefficient"),
        ("type = \"diffuse\"\nreflectance = { image = \"\" }", "`image` is empty"),
        ("type = \"plastic\"\nroughness = 2", "roughness"),
        (
            "type = \"mix\"\nmaterials = [\"it\", { type = \"null\" }]\namount = 0.5",
            "part of itself: it -> it",
        ),
        (
            "type = \"mix\"\nmaterials = [\"is\", { type = \"null\" }]\namount = 0.5",
            "there is no material `is`; there is `it`",
        ),
        (
            "type = \"mix\"\nmaterials = [{ type = \"conductor\", eta = 2 }, { type = \"null\" }]\namount = 0.5",
            "belong together",
        ),
    ] {
        let found = problems(&named(text));
        assert!(
            found.len() == 1 && found[0].contains(expected) && !found[0].contains('\n'),
            "{text}: {found:#?}"
        );
    }
}

#[test]
fn circles_of_materials_are_named_once() {
    let mix = |name: &str, of: &str| {
        format!(
            "[[material]]\nname = \"{name}\"\ntype = \"mix\"\nmaterials = [\"{of}\", {{ type = \"null\" }}]\namount = 0.5\n"
        )
    };
    let found = problems(&[mix("a", "b"), mix("b", "c"), mix("c", "a")].concat());
    assert_eq!(found.len(), 1, "{found:?}");
    assert!(found[0].ends_with("a material is part of itself: a -> b -> c -> a"), "{found:?}");
}

/// Thirty materials, each mixed of the one before it twice, would have a billion parts.
#[test]
fn materials_do_not_multiply_without_end() {
    let mut text = "[[material]]\nname = \"m0\"\ntype = \"diffuse\"\n".to_owned();
    for number in 1..=30 {
        let of = format!("\"m{}\"", number - 1);
        text += &format!(
            "[[material]]\nname = \"m{number}\"\ntype = \"mix\"\nmaterials = [{of}, {of}]\namount = 0.5\n"
        );
    }
    let found = problems(&text);
    assert!(found[0].contains("more than 256 parts") && found.len() < 30, "{found:#?}");
}
