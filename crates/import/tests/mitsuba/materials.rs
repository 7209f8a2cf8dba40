//! Bsdfs and textures.

use tyndall_import::{Imported, NoteKind};
use tyndall_scene::description::{
    IndexChoice, MaterialChoice, MaterialDescription, Roughness, TextureDescription, TextureWrap,
};

use crate::support::*;

fn ball(bsdf: &str) -> Imported {
    import(&format!("<shape type=\"sphere\">{bsdf}</shape>"))
}

fn material(bsdf: &str) -> MaterialDescription {
    let imported = ball(bsdf);
    assert_silent(&imported);
    let Some(MaterialChoice::Here(material)) = imported.description.shapes[0].material.clone() else {
        panic!()
    };
    *material
}

const GGX: &str = r#"<string name="distribution" value="ggx"/>"#;

#[test]
fn glass_has_the_ratio_of_its_indices() {
    let MaterialDescription::Dielectric { index: IndexChoice::Number(index), roughness: None, .. } =
        material(r#"<bsdf type="dielectric"/>"#)
    else {
        panic!()
    };
    assert!((index - 1.5046 / 1.000277).abs() < 1e-12);
    let rough = format!(
        r#"<bsdf type="roughdielectric"><string name="int_ior" value="Water"/><float name="ext_ior" value="1"/>{GGX}
           <float name="alpha" value="0.3"/><rgb name="specular_transmittance" value="1,0.5,0.5"/></bsdf>"#
    );
    assert_eq!(
        material(&rough),
        MaterialDescription::Dielectric {
            index: IndexChoice::Number(1.333),
            roughness: Some(Roughness::Equal(0.3)),
            reflection_tint: None,
            transmission_tint: Some([1.0, 0.5, 0.5].into()),
        }
    );
    assert!(matches!(
        material(r#"<bsdf type="thindielectric"/>"#),
        MaterialDescription::ThinDielectric { .. }
    ));
}

#[test]
fn metals_have_names_indices_or_reflect_everything() {
    let conductor = |content: &str| material(&format!("<bsdf type=\"conductor\">{content}</bsdf>"));
    let MaterialDescription::Conductor { metal, .. } = conductor("<string name=\"material\" value=\"Au\"/>")
    else {
        panic!()
    };
    assert_eq!(metal.as_deref(), Some("Au"));
    let MaterialDescription::Conductor { reflectance, metal: None, .. } = conductor("") else { panic!() };
    assert_eq!(reflectance, Some(1.0.into()));
    let keys = "<rgb name=\"eta\" value=\"0.2,0.9,1.1\"/><rgb name=\"k\" value=\"3.9,2.4,2.2\"/>";
    let MaterialDescription::Conductor { eta, k, .. } = conductor(keys) else { panic!() };
    assert_eq!((eta, k), (Some([0.2, 0.9, 1.1].into()), Some([3.9, 2.4, 2.2].into())));
    let rough = format!(
        "<bsdf type=\"roughconductor\">{GGX}<float name=\"alpha_u\" value=\"0.1\"/><float name=\"alpha_v\" value=\"0.4\"/></bsdf>"
    );
    let MaterialDescription::Conductor { roughness, .. } = material(&rough) else { panic!() };
    assert_eq!(roughness, Some(Roughness::Pair([0.1, 0.4])));
}

#[test]
fn blends_and_masks_are_mixtures() {
    let MaterialDescription::Mix { materials, amount } = material(
        r#"<bsdf type="mask"><float name="opacity" value="0.25"/><bsdf type="twosided"><bsdf type="diffuse"/></bsdf></bsdf>"#,
    ) else {
        panic!()
    };
    assert_eq!(amount, 0.25.into());
    assert_eq!(materials[0], here(MaterialDescription::Null));
    assert_eq!(materials[1], here(MaterialDescription::Diffuse { reflectance: 0.5.into() }));
    let MaterialDescription::Mix { materials, amount } = material(
        r#"<bsdf type="blendbsdf"><float name="weight" value="0.75"/><bsdf type="conductor"/><bsdf type="plastic"/></bsdf>"#,
    ) else {
        panic!()
    };
    assert_eq!(amount, 0.75.into());
    assert!(
        matches!(&materials[1], MaterialChoice::Here(second) if matches!(**second, MaterialDescription::Plastic { .. }))
    );
}

#[test]
fn materials_with_an_id_stand_once() {
    let imported = import(
        r#"<bsdf type="plastic" id="red"><rgb name="diffuse_reflectance" value="1,0,0"/></bsdf>
           <shape type="sphere"><ref id="red"/></shape><shape type="cube"><ref id="red"/></shape>"#,
    );
    let scene = imported.description;
    assert_eq!(scene.materials.len(), 1);
    assert!(scene.shapes.iter().all(|shape| shape.material == Some(MaterialChoice::Name("red".into()))));
}

#[test]
fn what_is_done_instead_is_told() {
    for (bsdf, kind, part) in [
        (r#"<bsdf type="diffuse"/>"#, NoteKind::Choice, "black from behind"),
        ("", NoteKind::Choice, "without a bsdf is diffuse"),
        (r#"<bsdf type="roughconductor"/>"#, NoteKind::Unsupported, "GGX"),
        (
            r#"<bsdf type="hair"/>"#,
            NoteKind::Unsupported,
            "the bsdf `hair` is not supported: the surface is diffuse",
        ),
        (r#"<bsdf type="principled"/>"#, NoteKind::Unsupported, "nearest of metal, glass and plastic"),
        (
            r#"<bsdf type="bumpmap"><texture type="checkerboard"/><bsdf type="conductor"/></bsdf>"#,
            NoteKind::Unsupported,
            "the surface is smooth",
        ),
        (
            r#"<bsdf type="conductor"><string name="material" value="Se"/></bsdf>"#,
            NoteKind::Unsupported,
            "the metal `Se` is not known",
        ),
        (
            r#"<bsdf type="plastic"><rgb name="diffuse_reflectance" value="1.5,0,0"/></bsdf>"#,
            NoteKind::Unsupported,
            "the value 1.5 is out of range",
        ),
    ] {
        let said = messages(&ball(bsdf), kind);
        assert!(said.len() == 1 && said[0].contains(part), "{bsdf}: {said:?}");
    }
}

#[test]
fn a_principled_bsdf_becomes_its_nearest_relative() {
    let of = |keys: &str| {
        let imported = ball(&format!(
            "<bsdf type=\"principled\"><float name=\"roughness\" value=\"0.5\"/>{keys}</bsdf>"
        ));
        let Some(MaterialChoice::Here(material)) = imported.description.shapes[0].material.clone() else {
            panic!()
        };
        *material
    };
    let rough = Some(Roughness::Equal(0.25));
    assert!(
        matches!(of("<float name=\"metallic\" value=\"1\"/>"), MaterialDescription::Conductor { roughness, .. } if roughness == rough)
    );
    assert!(matches!(of("<float name=\"spec_trans\" value=\"1\"/>"), MaterialDescription::Dielectric { .. }));
    let MaterialDescription::Plastic { index: IndexChoice::Number(index), .. } = of("") else { panic!() };
    assert!((index - 1.5).abs() < 1e-12);
}

#[test]
fn pictures_stand_upright_on_rectangles_and_on_meshes() {
    let scene = format!(
        r#"<scene version="3.0.0"><bsdf type="twosided" id="photo"><bsdf type="diffuse"><texture name="reflectance" type="bitmap">
             <string name="filename" value="photo.png"/><string name="wrap_mode" value="clamp"/><boolean name="raw" value="true"/>
             <transform name="to_uv"><scale x="2" y="3"/></transform></texture></bsdf></bsdf>
           <shape type="rectangle"><ref id="photo"/></shape>
           <shape type="obj"><string name="filename" value="quad.obj"/><boolean name="face_normals" value="true"/><ref id="photo"/></shape>
           {SENSOR}</scene>"#
    );
    let quad = b"v 0 0 0\nv 1 0 0\nv 1 1 0\nvt 0 0\nvt 1 0\nvt 1 1\nf 1/1 2/2 3/3\n";
    let folder =
        Folder::with(&[("scene.xml", scene.as_bytes()), ("photo.png", b"never read"), ("quad.obj", quad)]);
    let imported = folder.import();
    assert_silent(&imported);
    let scene = imported.description;
    let names: Vec<_> = scene.shapes.iter().map(|shape| shape.material.clone()).collect();
    assert_eq!(
        names,
        [Some(MaterialChoice::Name("photo".into())), Some(MaterialChoice::Name("photo-2".into()))]
    );
    let placements: Vec<_> = scene
        .materials
        .iter()
        .map(|named| match &named.material {
            MaterialDescription::Diffuse { reflectance: TextureDescription::Image(image) } => {
                assert_eq!((image.wrap, image.srgb), (TextureWrap::Clamp, Some(false)));
                (image.scale, image.offset)
            }
            other => panic!("{other:?}"),
        })
        .collect();
    // Mitsuba's v runs down the picture; that of the file of the mesh runs up.
    assert_eq!(placements, [(Some([2.0, -3.0]), Some([0.0, 1.0])), (Some([2.0, 3.0]), Some([0.0, -2.0]))]);
}

#[test]
fn squares_of_a_checkerboard_are_half_a_unit() {
    let imported = import(
        r#"<shape type="rectangle"><bsdf type="twosided"><bsdf type="diffuse"><texture name="reflectance" type="checkerboard">
             <rgb name="color0" value="0.1,0.2,0.3"/></texture></bsdf></bsdf></shape>"#,
    );
    let Some(MaterialChoice::Here(material)) = &imported.description.shapes[0].material else { panic!() };
    let MaterialDescription::Diffuse { reflectance: TextureDescription::Checker(checker) } = &**material
    else {
        panic!()
    };
    assert_eq!(checker.checker, [[0.1, 0.2, 0.3].into(), 0.2.into()]);
    assert_eq!((checker.scale, checker.offset), (Some([2.0, 2.0]), None));
}
