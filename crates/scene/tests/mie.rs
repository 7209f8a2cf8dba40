//! Particles of Lorenz-Mie theory as a user writes them.

use std::path::Path;

use tyndall_optics::mie::MieCache;
use tyndall_scene::description::{PhaseDescription, phase_spec};
use tyndall_scene::{SceneDocument, SceneError, build_phase_with, mie_spheres};

fn parse(line: &str) -> PhaseDescription {
    phase_spec::parse(line).unwrap_or_else(|error| panic!("{error}"))
}

fn read(table: &str) -> Result<PhaseDescription, SceneError> {
    let text = format!(
        "camera = {{ position = [0, 0, 5], target = [0, 0, 0] }}\n\
         medium = {{ mu_t = 1, albedo = 1, phase = {table} }}"
    );
    let description = SceneDocument::parse("scene.toml", &text)?.description()?;
    Ok(description.medium.unwrap().phase.unwrap())
}

#[test]
fn one_line_says_what_a_scene_file_says() {
    for (line, table) in [
        ("mie(m=1.33+1e-5i,x=10)", "{ type = 'mie', m = '1.33+1e-5i', x = 10 }"),
        ("mie(m=1.5,x=1e-3)", "{ type = 'mie', m = 1.5, x = 1e-3 }"),
        ("mie(m=[1.5,0.1],x=0.5)", "{ type = 'mie', m = [1.5, 0.1], x = 0.5 }"),
        (
            "mie(material=water,wavelength=550nm,distribution=gamma(r_eff=10um,v_eff=0.1))",
            "{ type = 'mie', material = 'water', wavelength_nm = 550,
               distribution = { type = 'gamma', r_eff = '10um', v_eff = 0.1 } }",
        ),
        (
            "mie:water:10um:gamma(0.1)",
            "{ type = 'mie', material = 'water', distribution = { type = 'gamma', r_eff = '10um', v_eff = 0.1 } }",
        ),
        (
            "mie:ice:2 um",
            "{ type = 'mie', material = 'ice', distribution = { type = 'single', r = '2 um' } }",
        ),
        (
            "mie(material=sea_salt, distribution=lognormal(0.2um, 1.6, r_max=9um))",
            "{ type = 'mie', material = 'sea_salt',
               distribution = { type = 'log_normal', r_g = '0.2um', sigma_g = 1.6, r_max = '9um' } }",
        ),
        (
            "mie(material_file=a.csv, distribution=modified_gamma(4um,6,1))",
            "{ type = 'mie', material_file = 'a.csv',
               distribution = { type = 'modified_gamma', r_mode = '4um', alpha = 6, gamma = 1 } }",
        ),
        (
            "mie(m=1.5, distribution=power_law(4, 0.1um, 10um))",
            "{ type = 'mie', m = 1.5,
               distribution = { type = 'power_law', exponent = 4, r_min = '0.1um', r_max = '10um' } }",
        ),
    ] {
        let table = table.replace('\n', " ");
        assert_eq!(parse(line), read(&table).unwrap_or_else(|error| panic!("{error}")), "{line}");
    }
}

#[test]
fn mistakes_are_told_with_their_place_and_their_mend() {
    for (table, words) in [
        ("{ type = 'mie', x = 1 }", ["of nothing", "`material`, `m` or `material_file`"]),
        ("{ type = 'mie', m = 1.5 }", ["no size", "`distribution` or `x`"]),
        ("{ type = 'mie', m = 1.5, material = 'ice', x = 1 }", ["only one of", "`material_file`"]),
        ("{ type = 'mie', m = [1.5, -1], x = 1 }", ["k from 0", "-1i"]),
        ("{ type = 'mie', m = 'dense', x = 1 }", ["\"dense\"", "1.33+1e-5i"]),
        ("{ type = 'mie', m = 1.5, x = 1e9 }", ["`x`", "100000"]),
        ("{ type = 'mie', material = 'watr', x = 1 }", ["unknown value `watr`", "did you mean `water`?"]),
        ("{ type = 'mie', m = 1.5, distribution = { type = 'gama' } }", ["unknown type `gama`", "`gamma`"]),
        (
            "{ type = 'mie', m = 1.5, distribution = { type = 'single', r = 10 } }",
            ["`r`: 10 has no unit", "um"],
        ),
        (
            "{ type = 'mie', m = 1.5, distribution = { type = 'single', r = '10 kg' } }",
            ["\"10 kg\"", "none of the units nm, um"],
        ),
        (
            "{ type = 'mie', m = 1.5, distribution = { type = 'gamma', r_eff = '10 um', v_eff = 0.6 } }",
            ["`v_eff`", "0.49"],
        ),
        (
            "{ type = 'mie', m = 1.5, x = 1, distribution = { type = 'single', r = '1 um' } }",
            ["both `x` and `distribution`", "keep one"],
        ),
    ] {
        let message = read(table).unwrap_err().to_string();
        assert!(message.starts_with("scene.toml:2:"), "{message}");
        assert!(
            words.iter().all(|word| message.contains(word)) && !message.contains('\n'),
            "{table}: {message}"
        );
    }
    for (line, word) in [
        ("mie:water", "key=value"),
        ("mie:water:10um:gamma", "key=value"),
        ("mie:water:10um:gamma(0.1,0.2,0.3)", "key=value"),
        ("mie", "of nothing"),
    ] {
        let message = phase_spec::parse(line).unwrap_err().to_string();
        assert!(message.contains(word), "{line}: {message}");
    }
}

#[test]
fn the_phase_function_is_that_of_the_spheres_at_each_colour() {
    let cache = MieCache::none();
    let build = |line: &str| build_phase_with(&parse(line), Path::new(""), &cache).unwrap();
    let one = build("mie(m=1.33+1e-5i,x=10)");
    assert!(one.is_grey() && (one.at(400.0).mean_cosine() - 0.712504141).abs() < 1e-4);
    let haze = build("mie:water:0.2um:lognormal(1.4)");
    assert_eq!(haze.wavelengths_nm(), [465.0, 550.0, 610.0]);
    let description = parse("mie:water:0.2um:lognormal(1.4)");
    let green = mie_spheres(&description, 550.0, Path::new(""), &cache).unwrap().unwrap().average;
    assert!((haze.at(550.0).mean_cosine() - green.g).abs() < 1e-4 && green.q_ext > 0.5);
    assert!(haze.at(465.0).value_at_cosine(1.0) > haze.at(610.0).value_at_cosine(1.0));
    assert!(mie_spheres(&PhaseDescription::Rayleigh, 550.0, Path::new(""), &cache).unwrap().is_none());
}

#[test]
fn a_table_of_the_user_is_read_and_its_mistakes_are_told_with_the_line() {
    let folder = tempfile::tempdir().unwrap();
    let build = |text: &str| {
        std::fs::write(folder.path().join("m.csv"), text).unwrap();
        let phase = parse("mie(material_file=m.csv,x=10,wavelength=500nm)");
        build_phase_with(&phase, folder.path(), &MieCache::none()).map(|phase| phase.at(500.0).mean_cosine())
    };
    let g = build("wavelength_um,n,k\n0.4,1.34,1e-5\n0.6,1.32,1e-5\n").unwrap();
    assert!((g - 0.712504141).abs() < 1e-4, "{g}");
    let message = build("wavelength_um,n,k\n0.4,1.34\n").unwrap_err().to_string();
    assert!(message.contains("m.csv: line 2: each line is three numbers"), "{message}");
    let message = build("wavelength_um,n,k\n0.6,1.34,0\n").unwrap_err().to_string();
    assert!(message.contains("is known from 600 to 600 nm, not at 500 nm"), "{message}");
    std::fs::remove_file(folder.path().join("m.csv")).unwrap();
    let phase = parse("mie(material_file=m.csv,x=10)");
    assert!(build_phase_with(&phase, folder.path(), &MieCache::none()).is_err());
}
