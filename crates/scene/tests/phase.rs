//! Phase functions as a user writes them: in a scene file, in one line, as a table in a file.

use std::path::Path;

use tyndall_optics::PhaseFunction;
use tyndall_scene::description::{PhaseDescription, SggxShape, phase_spec};
use tyndall_scene::{BuiltScene, SceneDocument, SceneError, build, build_phase, scene_hash};

fn document(phase: &str) -> SceneDocument {
    let text = format!(
        "camera = {{ position = [0, 0, 5], target = [0, 0, 0] }}\n\
         medium = {{ mu_t = 1, albedo = 1, phase = {phase} }}\n\
         volume = [{{ sphere = {{ center = [0, 0, 0], radius = 1 }}, mu_t = 1, albedo = 1, phase = {phase} }}]"
    );
    SceneDocument::parse("scene.toml", &text).unwrap_or_else(|error| panic!("{error}: {text}"))
}

fn built(phase: &str, folder: &Path) -> Result<BuiltScene, SceneError> {
    build(&document(phase).description()?, folder)
}

/// One line and the table of a scene file that says the same.
const BOTH: [(&str, &str); 16] = [
    ("isotropic", "{ type = 'isotropic' }"),
    ("hg(g=0.85)", "{ type = 'hg', g = 0.85 }"),
    ("hg:-0.5", "{ type = 'hg', g = -0.5 }"),
    ("HG(0)", "{ type = 'hg', g = 0 }"),
    ("rayleigh", "{ type = 'rayleigh' }"),
    ("draine(g=0.6,alpha=0.5)", "{ type = 'draine', g = 0.6, alpha = 0.5 }"),
    ("cornette-shanks(g=0.5)", "{ type = 'cornette_shanks', g = 0.5 }"),
    ("double-hg(g1=0.9, g2=-0.3, weight=0.7)", "{ type = 'double_hg', g1 = 0.9, g2 = -0.3, weight = 0.7 }"),
    ("schlick(k=0.5)", "{ type = 'schlick', k = 0.5 }"),
    ("fog(d=10um)", "{ type = 'fog', droplet_diameter_um = 10 }"),
    ("fog(diameter=0.01 mm)", "{ type = 'fog', droplet_diameter_um = 10 }"),
    ("fog:7µm", "{ type = 'fog', droplet_diameter_um = 7 }"),
    (
        "sggx(kind=fibre,roughness=0.3,axis=[0,0,1])",
        "{ type = 'sggx', kind = 'fibre', roughness = 0.3, axis = [0, 0, 1] }",
    ),
    (
        "sggx(kind=surface,roughness=1)",
        "{ type = 'sggx', kind = 'surface', roughness = 1, axis = [0, 1, 0] }",
    ),
    ("tabulated(file=a/b.txt)", "{ type = 'tabulated', file = 'a/b.txt' }"),
    ("tabulated(file='7', wavelength=0.55um)", "{ type = 'tabulated', file = '7', wavelength_nm = 550 }"),
];

#[test]
fn one_line_says_what_a_scene_file_says() {
    for (line, table) in BOTH {
        let parsed = phase_spec::parse(line).unwrap_or_else(|error| panic!("{error}"));
        let read = document(table).description().unwrap_or_else(|error| panic!("{error}"));
        assert_eq!(Some(parsed), read.medium.and_then(|medium| medium.phase), "{line}");
    }
}

#[test]
fn mistakes_in_one_line_are_told_with_their_mend() {
    for (line, words) in [
        ("hgg(g=0.5)", ["unknown type `hgg`", "did you mean `hg`?"]),
        ("hg(gg=0.5)", ["unknown key `gg`", "there is `g`"]),
        ("hg(g=1)", ["`g` must be a number between -1 and 1", "not 1"]),
        ("hg(g=nan)", ["`g` must be finite", "NaN"]),
        ("hg(g=high)", ["`g` must be a number", "not a string"]),
        ("hg", ["of type `hg` lacks `g`", "give a number"]),
        ("hg(g=0.1,g=0.2)", ["`g`", "twice"]),
        ("hg(0.1,0.2)", ["names of the values of `hg`", "key=value"]),
        ("draine:0.5", ["names of the values", "key=value"]),
        ("nonsense:0.5", ["unknown type `nonsense`", "there is `isotropic`"]),
        ("fog(d=60um)", ["`droplet_diameter_um`", "at most 50"]),
        ("fog(d=10kg)", ["`droplet_diameter_um` must be a number", "not a string"]),
        ("sggx(kind=flake,roughness=0.3)", ["unknown value `flake`", "`surface`"]),
        ("sggx(kind=fibre,roughness=0)", ["`roughness`", "above 0"]),
        ("sggx(kind=fibre,roughness=0.5,axis=[0,0,0])", ["`axis`", "[0, 0, 0]"]),
        ("sggx(kind=fibre,roughness=0.5,axis=[0,1])", ["`axis`", "3 numbers"]),
        ("tabulated(file=a.txt,wavelength=-1nm)", ["`wavelength_nm`", "above 0"]),
        ("hg(g=rayleigh(x=1))", ["`g` must be a number", "not a table"]),
        ("hg(g=0.5", ["hg(g=0.5: ", "`)`"]),
        ("", ["the phase function: ", "no name"]),
        (&"x".repeat(5000), ["too long", "one line"]),
    ] {
        let error = phase_spec::parse(line).expect_err(line);
        let shown = error.problems()[0].to_string();
        assert!(words.iter().all(|word| shown.contains(word)), "{line}: {shown}");
        assert!(!shown.contains('\n') && shown.len() < 400, "{shown}");
    }
}

#[test]
fn any_text_leads_to_a_phase_function_or_an_error() {
    let mut random = tyndall_lanes::Random::new(3, 0, 0);
    let pieces =
        ["hg", "(", ")", "[", "]", ",", "=", ":", "g", "0.5", "'", "fog", "d", "um", " ", "µ", "-", "\n"];
    for _ in 0..20_000 {
        let length = 1 + (random.f64() * 12.0) as usize;
        let text: String =
            (0..length).map(|_| pieces[(random.f64() * pieces.len() as f64) as usize]).collect();
        if let Err(error) = phase_spec::parse(&text) {
            assert!(!error.to_string().is_empty());
        }
    }
}

#[test]
fn every_description_becomes_its_phase_function() {
    for (line, expected) in [
        ("isotropic", PhaseFunction::Isotropic),
        ("hg:0.3", PhaseFunction::HenyeyGreenstein { g: 0.3 }),
        ("schlick:0.3", PhaseFunction::Schlick { k: 0.3 }),
        ("rayleigh", PhaseFunction::Rayleigh),
        ("cornette-shanks:0.3", PhaseFunction::Draine { g: 0.3, alpha: 1.0 }),
        ("draine(g=0.3,alpha=5)", PhaseFunction::Draine { g: 0.3, alpha: 5.0 }),
        ("fog:20um", PhaseFunction::fog(20.0)),
        ("double-hg(g1=0.9,g2=-0.3,weight=0.7)", PhaseFunction::double_henyey_greenstein(0.9, -0.3, 0.7)),
    ] {
        let phase = build_phase(&phase_spec::parse(line).unwrap(), Path::new("")).unwrap();
        assert!(phase.is_grey() && phase.phases() == [expected], "{line}");
    }
    let sggx = PhaseDescription::Sggx { kind: SggxShape::Fibre, axis: [0.0, 0.0, 3.0], roughness: 0.25 };
    let sggx = build_phase(&sggx, Path::new("")).unwrap().at(550.0);
    assert_eq!(sggx.projected_area(glam::DVec3::Z), 0.25);
    assert_eq!(sggx.projected_area(glam::DVec3::X), 1.0);
}

#[test]
fn tables_are_read_beside_the_scene_file_and_belong_to_its_hash() {
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, text: &str| std::fs::write(folder.path().join(name), text).unwrap();
    write("one.txt", "0 2\n180 1\n");
    write("copy.txt", "0 2\n180 1\n");
    write("other.txt", "0 3\n180 1\n");
    write("two.csv", "angle_deg,450,650\n0,1,2\n180,1,1\n");
    write("wrong.txt", "0 2\n180 -1\n");
    let table = |name: &str| format!("{{ type = 'tabulated', file = '{name}' }}");
    let hash =
        |name: &str| scene_hash(&document(&table(name)).description().unwrap(), folder.path()).unwrap();
    assert_eq!(hash("one.txt"), hash("copy.txt"));
    assert_ne!(hash("one.txt"), hash("other.txt"));

    let one = built(&table("one.txt"), folder.path()).unwrap();
    assert!(one.notes.iter().all(|note| !note.contains("nm")));
    // Half of the light between 1 and 2: 2 forward, 1 backward, linear in the cosine, of mean 3/2 in 4π.
    let value = one.scene.volumes[1].medium.phase_function.value_at_cosine(1.0);
    assert!((value - 2.0 / (6.0 * std::f64::consts::PI)).abs() < 1e-12);

    let two = built(&table("two.csv"), folder.path()).unwrap();
    let medium = &two.scene.volumes[0].medium;
    let chromatic = medium.chromatic.as_ref().expect("phase functions that differ make a medium chromatic");
    let [red, _, blue] = chromatic.phase_functions.as_ref().expect("one for each channel");
    // Blue's is nearer to that at 450 nm, which is even.
    assert!(red.value_at_cosine(1.0) > 1.2 * blue.value_at_cosine(1.0));
    let at = "{ type = 'tabulated', file = 'two.csv', wavelength_nm = 650 }";
    assert_eq!(built(at, folder.path()).unwrap().scene.volumes[0].medium.phase_function, one_phase(&folder));

    for (name, words) in
        [("wrong.txt", ["wrong.txt: line 2", "negative"]), ("no.txt", ["no.txt", "no such file"])]
    {
        let error = built(&table(name), folder.path()).unwrap_err().to_string();
        assert!(words.iter().all(|word| error.contains(word)), "{error}");
    }
}

fn one_phase(folder: &tempfile::TempDir) -> PhaseFunction {
    let description = PhaseDescription::Tabulated { file: "one.txt".into(), wavelength_nm: None };
    build_phase(&description, folder.path()).unwrap().at(550.0)
}

#[test]
fn an_axis_of_no_length_is_refused_with_its_place() {
    let error =
        document("{ type = 'sggx', kind = 'fibre', roughness = 0.5, axis = [0, 0, 0] }").description();
    let error = error.unwrap_err();
    assert_eq!(error.problems().len(), 2);
    assert!(error.to_string().starts_with("scene.toml:2:"), "{error}");
    assert!(error.to_string().contains("`axis` is a direction"), "{error}");
}
