//! Media, phase functions, and the shapes around them.

use tyndall_import::{Imported, NoteKind};
use tyndall_scene::description::{Names, PhaseDescription};

use crate::support::*;

const FOG: &str = r#"<medium type="homogeneous" id="fog"><float name="sigma_t" value="2"/><float name="albedo" value="0.5"/></medium>"#;
const NULL: &str = r#"<bsdf type="null"/>"#;

fn one(name: &str) -> Option<Names> {
    Some(Names::One(name.into()))
}

#[test]
fn coefficients_have_mitsubas_defaults() {
    let imported = import(&format!(
        "<medium type=\"homogeneous\" id=\"m\"/><shape type=\"sphere\">{NULL}<ref name=\"interior\" id=\"m\"/></shape>"
    ));
    let medium = &imported.description.volumes[0].medium;
    assert_eq!((medium.mu_t.clone(), medium.albedo.clone()), (Some(1.0.into()), Some(0.75.into())));
}

#[test]
fn a_hull_that_only_wraps_becomes_the_volumes_form() {
    let hull = |shape: &str| {
        let imported =
            import(&format!("{FOG}<shape {shape}{NULL}<ref name=\"interior\" id=\"fog\"/></shape>"));
        assert_silent(&imported);
        assert!(imported.description.shapes.is_empty(), "{:?}", imported.description.shapes);
        imported.description.volumes[0].clone()
    };
    let moved = "<transform name=\"to_world\"><scale value=\"2\"/><translate x=\"1\"/></transform>";
    let ball = hull(&format!("type=\"sphere\"><point name=\"center\" value=\"1,0,0\"/>{moved}"));
    assert_eq!(ball.sphere.map(|sphere| (sphere.center, sphere.radius)), Some(([3.0, 0.0, 0.0], 2.0)));
    let cube = hull(&format!("type=\"cube\">{moved}"));
    assert_eq!(
        cube.cuboid.map(|cuboid| (cuboid.min, cuboid.max)),
        Some(([-1.0, -2.0, -2.0], [3.0, 2.0, 2.0]))
    );
    let turned =
        hull("type=\"cube\"><transform name=\"to_world\"><rotate z=\"1\" angle=\"30\"/></transform>");
    assert!(turned.cuboid.is_some() && turned.transform.is_some());
}

#[test]
fn shapes_that_do_more_than_wrap_stay() {
    let ball = |content: &str| {
        format!("<shape type=\"sphere\">{content}<ref name=\"interior\" id=\"fog\"/></shape>")
    };
    for (content, count) in [
        (ball("<bsdf type=\"dielectric\"/>"), 1),
        (ball(NULL) + &ball(NULL), 2),
        (ball(&format!("{NULL}<ref name=\"exterior\" id=\"fog\"/>")), 1),
        (ball(&format!("{NULL}<boolean name=\"flip_normals\" value=\"true\"/>")), 1),
        (ball(NULL).replace("sphere", "disk"), 1),
    ] {
        let scene = import(&format!("{FOG}{content}")).description;
        assert_eq!(scene.shapes.len(), count, "{content}");
        assert!(scene.shapes.iter().all(|shape| shape.interior == one("fog")), "{content}");
        assert_eq!(scene.volumes[0].sphere, None, "{content}");
    }
}

#[test]
fn a_medium_within_a_medium_ends_the_outer_one() {
    let scene = import(&format!(
        "{FOG}<medium type=\"homogeneous\" id=\"drop\"/>\
         <shape type=\"cube\">{NULL}<ref name=\"interior\" id=\"fog\"/></shape>\
         <shape type=\"sphere\"><float name=\"radius\" value=\"0.5\"/>{NULL}<ref name=\"interior\" id=\"drop\"/>\
           <ref name=\"exterior\" id=\"fog\"/></shape>"
    ))
    .description;
    let sides: Vec<_> =
        scene.shapes.iter().map(|shape| (shape.interior.clone(), shape.exterior.clone())).collect();
    assert_eq!(sides, [(one("fog"), None), (one("drop"), one("fog"))]);
}

#[test]
fn the_medium_of_the_camera_that_no_shape_bounds_fills_the_scene() {
    let sensor = SENSOR.replace("</sensor>", "<ref name=\"medium\" id=\"fog\"/></sensor>");
    let scene = format!(
        "<scene version=\"3.0.0\">{FOG}<shape type=\"sphere\"><bsdf type=\"dielectric\"/><ref name=\"exterior\" id=\"fog\"/></shape>{sensor}</scene>"
    );
    let imported = Folder::with(&[("scene.xml", scene.as_bytes())]).import();
    let scene = imported.description;
    assert_eq!(scene.medium.and_then(|medium| medium.mu_t), Some(2.0.into()));
    assert_eq!((scene.volumes.len(), scene.camera.inside), (0, None));
    assert_eq!(scene.shapes[0].exterior, one("medium"));
}

#[test]
fn the_camera_is_in_the_bounded_media_that_it_names() {
    let sensor = SENSOR.replace("</sensor>", "<ref name=\"medium\" id=\"fog\"/></sensor>");
    let scene = format!(
        "<scene version=\"3.0.0\">{FOG}<shape type=\"sphere\"><float name=\"radius\" value=\"9\"/><bsdf type=\"dielectric\"/>\
         <ref name=\"interior\" id=\"fog\"/></shape>{sensor}</scene>"
    );
    let scene = Folder::with(&[("scene.xml", scene.as_bytes())]).import().description;
    assert_eq!(scene.camera.inside, one("fog"));
}

#[test]
fn a_heterogeneous_medium_of_one_value_fills_the_unit_cube_only() {
    let medium = "<medium type=\"heterogeneous\" id=\"m\"><volume type=\"constvolume\" name=\"sigma_t\"><float name=\"value\" value=\"3\"/>\
                  <transform name=\"to_world\"><scale value=\"2\"/></transform></volume><float name=\"scale\" value=\"5\"/></medium>";
    let of = |scale: &str| {
        let shape = format!(
            "<shape type=\"cube\"><transform name=\"to_world\"><scale value=\"{scale}\"/></transform>{NULL}<ref name=\"interior\" id=\"m\"/></shape>"
        );
        import(&format!("{medium}{shape}")).description
    };
    let large = of("9");
    let volume = &large.volumes[0];
    assert_eq!(volume.medium.mu_t, Some(15.0.into()));
    assert_eq!(volume.cuboid.map(|cuboid| (cuboid.min, cuboid.max)), Some(([0.0; 3], [1.0; 3])));
    assert_eq!(
        volume.transform.clone().unwrap().to_affine().transform_point3(glam::DVec3::ONE),
        glam::DVec3::splat(2.0)
    );
    assert!(large.shapes.is_empty());
    // The shape leaves a part of it.
    let small = of("1");
    assert_eq!(small.volumes[0].cuboid.map(|cuboid| cuboid.max), Some([0.5; 3]));
    assert!(small.shapes.is_empty());
}

fn phase(content: &str) -> (Imported, Option<PhaseDescription>) {
    let imported = import(&format!(
        "<medium type=\"homogeneous\" id=\"m\">{content}</medium><shape type=\"sphere\">{NULL}<ref name=\"interior\" id=\"m\"/></shape>"
    ));
    let phase = imported.description.volumes[0].medium.phase.clone();
    (imported, phase)
}

#[test]
fn phase_functions_are_those_of_mitsuba() {
    let of = |content: &str| {
        let (imported, phase) = phase(content);
        assert_silent(&imported);
        phase
    };
    assert_eq!(of(""), None);
    assert_eq!(of("<phase type=\"isotropic\"/>"), None);
    assert_eq!(of("<phase type=\"hg\"/>"), Some(PhaseDescription::Hg { g: 0.8 }));
    assert_eq!(of("<phase type=\"rayleigh\"/>"), Some(PhaseDescription::Rayleigh));
    let blend = "<phase type=\"blendphase\"><float name=\"weight\" value=\"0.25\"/><phase type=\"hg\"><float name=\"g\" \
                 value=\"0.9\"/></phase><phase type=\"isotropic\"/></phase>";
    assert_eq!(of(blend), Some(PhaseDescription::DoubleHg { g1: 0.9, g2: 0.0, weight: 0.75 }));
}

#[test]
fn tables_and_other_blends_are_tabulated() {
    let scene = |content: &str| {
        let scene = format!(
            "<scene version=\"3.0.0\"><medium type=\"homogeneous\" id=\"m\">{content}</medium>\
             <shape type=\"sphere\">{NULL}<ref name=\"interior\" id=\"m\"/></shape>{SENSOR}</scene>"
        );
        let folder = Folder::with(&[("scene.xml", scene.as_bytes())]);
        let imported = folder.import();
        let phase = imported.description.volumes[0].medium.phase.clone().unwrap();
        assert!(matches!(phase, PhaseDescription::Tabulated { .. }));
        let built = tyndall_scene::build_phase(&phase, folder.0.path()).unwrap();
        move |cosine: f64| -> f64 {
            built
                .at(550.0)
                .value(glam::DVec3::Z, glam::DVec3::new((1.0 - cosine * cosine).sqrt(), 0.0, cosine))
        }
    };
    let pi = std::f64::consts::PI;
    let table = scene("<phase type=\"tabphase\"><string name=\"values\" value=\"1, 2, 5\"/></phase>");
    // The integral over the cosine is (1.5 + 3.5) · 1.
    for (cosine, value) in [(-1.0, 1.0), (-0.5, 1.5), (0.0, 2.0), (0.5, 3.5), (1.0, 5.0)] {
        assert!((table(cosine) / (value / (2.0 * pi * 5.0)) - 1.0).abs() < 1e-6, "{cosine}");
    }
    let blend = scene(
        "<phase type=\"blendphase\"><float name=\"weight\" value=\"0.5\"/><phase type=\"hg\"><float name=\"g\" value=\"0.9\"/></phase>\
         <phase type=\"rayleigh\"/></phase>",
    );
    for cosine in [-1.0_f64, -0.3, 0.0, 0.7, 0.95, 0.999, 1.0] {
        let root = 1.81 - 1.8 * cosine;
        let hg = 0.19 / (4.0 * pi * root.powf(1.5));
        let expected = 0.5 * hg + 0.5 * 3.0 / (16.0 * pi) * (1.0 + cosine * cosine);
        assert!((blend(cosine) / expected - 1.0).abs() < 2e-3, "{cosine}: {} {expected}", blend(cosine));
    }
}

#[test]
fn faults_and_gaps_of_media_are_told() {
    let (imported, phase) = phase("<phase type=\"sggx\"/>");
    assert_eq!(phase, None);
    assert!(messages(&imported, NoteKind::Unsupported)[0].contains("orientations"));
    let ball = format!("<shape type=\"sphere\">{NULL}<ref name=\"interior\" id=\"m\"/></shape>");
    for (medium, part) in [
        ("<phase type=\"hg\"><float name=\"g\" value=\"1\"/></phase>", "`g` must be between -1 and 1"),
        ("<phase type=\"tabphase\"><string name=\"values\" value=\"0,0\"/></phase>", "not all 0"),
        ("<phase type=\"blendphase\"><float name=\"weight\" value=\"1\"/></phase>", "needs two <phase>s"),
        ("<float name=\"scale\" value=\"-1\"/>", "`scale` of the medium is negative"),
        ("<volume type=\"gridvolume\" name=\"sigma_t\"/>", "no `filename`"),
    ] {
        let message = refusal(&format!("<medium type=\"homogeneous\" id=\"m\">{medium}</medium>{ball}"));
        assert!(message.contains(part), "{message}");
    }
}
