//! Particles of Lorenz-Mie theory as a user writes them.

use std::path::Path;

use tyndall_optics::PhaseFunction;
use tyndall_optics::mie::MieCache;
use tyndall_scene::description::{PhaseDescription, phase_spec};
use tyndall_scene::{
    Medium, SceneDescription, SceneDocument, SceneError, SceneFiles, build_with, mie_spheres, scene_hash,
};

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

/// A scene in kilometres filled with `medium`.
fn scene(medium: &str, mode: &str) -> Result<SceneDescription, SceneError> {
    let text = format!(
        "unit = 'km'\ncamera = {{ position = [0, 0, 5], target = [0, 0, 0] }}\n\
         render = {{ mode = '{mode}' }}\nmedium = {medium}"
    );
    SceneDocument::parse("scene.toml", &text)?.description()
}

fn medium(text: &str, mode: &str) -> Medium {
    let description = scene(text, mode).unwrap_or_else(|error| panic!("{error}"));
    let built = build_with(&description, &SceneFiles::default(), &MieCache::none()).unwrap();
    built.scene.volumes[0].medium.clone()
}

const HAZE: &str =
    "{ material = 'water', distribution = { type = 'log_normal', r_g = '0.2 um', sigma_g = 1.6 },
    number_density = '1000 /cm3' }";

fn haze() -> String {
    format!("{{ particles = {} }}", HAZE.replace('\n', " "))
}

/// Cross sections of water haze, µm², by an independent code; 1 µm² in each of 1000/cm³ is 1/km.
#[test]
fn particles_give_extinction_and_phase_function_of_each_wavelength() {
    let spectral = medium(&haze(), "spectral");
    let spectra = spectral.spectra.clone().unwrap();
    for (nm, expected, g) in
        [(450.0, 0.53184859, 0.8074379), (550.0, 0.45059299, 0.80504118), (650.0, 0.37074823, 0.79507278)]
    {
        // Linear between wavelengths 20 nm apart.
        let mu_t = spectra.coefficients.mu_t(nm);
        assert!((mu_t / expected - 1.0).abs() < 2e-3, "{mu_t} at {nm} nm");
        assert!((spectra.phase.at(nm).mean_cosine() - g).abs() < 2e-3, "{nm} nm");
        assert!((spectra.coefficients.albedo(nm) - 1.0).abs() < 1e-6);
    }
    let rgb = medium(&haze(), "rgb");
    let colours = rgb.chromatic.clone().unwrap();
    assert!(colours.mu_t.z > colours.mu_t.y && colours.mu_t.y > colours.mu_t.x, "{}", colours.mu_t);
    assert!((colours.mu_t.y / 0.4506 - 1.0).abs() < 0.02, "{}", colours.mu_t);
    let phases = colours.phase_functions.clone().unwrap();
    assert!(phases[2].value_at_cosine(1.0) > phases[0].value_at_cosine(1.0));
    assert!((rgb.albedo - 1.0).abs().max_element() < 1e-6);
}

/// The same droplets by number, by mass and by volume; the factor `scale`, another phase function.
#[test]
fn amounts_agree_and_the_phase_function_can_be_another() {
    let by = |amount: &str, rest: &str| {
        let distribution = "{ type = 'single', r = '0.5 um' }";
        let text =
            format!("{{ particles = {{ m = 1.33, distribution = {distribution}, {amount} }}, {rest} }}");
        medium(&text, "rgb")
    };
    let volume = 4.0 / 3.0 * std::f64::consts::PI * 0.125;
    let by_number = by("number_density = '1000 /cm3'", "scale = 1");
    let mass = format!("liquid_water = '{} g/m3', density = '1 g/cm3'", 1e9 * volume * 1e-12);
    let fraction = format!("volume_fraction = {}", 1e9 * volume * 1e-18);
    for other in
        [by(&mass, "scale = 1"), by(&fraction, "scale = 1"), by("number_density = '1e9 /m3'", "scale = 1")]
    {
        assert!((other.mu_t / by_number.mu_t - 1.0).abs() < 1e-12);
    }
    let other = by("number_density = '500 /cm3'", "scale = 4, phase = { type = 'hg', g = 0.5 }");
    assert!((other.mu_t / by_number.mu_t - 2.0).abs() < 1e-12);
    assert_eq!(other.phase_function, PhaseFunction::HenyeyGreenstein { g: 0.5 });
}

#[test]
fn mistakes_in_particles_are_told_with_their_place_and_their_mend() {
    for (text, words) in [
        ("{ particles = { m = 1.5, DISTRIBUTION } }", ["exactly one way", "`liquid_water`"]),
        ("{ particles = { m = 1.5, DISTRIBUTION, liquid_water = '1 g/m3' } }", ["`density`", "2.6 g/cm3"]),
        ("{ particles = { m = 1.5, DISTRIBUTION, number_density = 100 } }", ["100 has no unit", "/cm3"]),
        (
            "{ particles = { m = 1.5, DISTRIBUTION, number_density = '-1 /cm3' } }",
            ["`number_density`", "above 0"],
        ),
        (
            "{ particles = { m = 1.5, DISTRIBUTION, volume_fraction = 0.1 }, albedo = 1 }",
            ["`albedo` and `particles`", "exactly one"],
        ),
        (
            "{ particles = { m = 1.5, DISTRIBUTION, volume_fraction = 2 } }",
            ["`volume_fraction`", "at most 1"],
        ),
        ("{ particles = { DISTRIBUTION, volume_fraction = 0.1 } }", ["of nothing", "`material`"]),
        ("{ particles = { m = 1.5, volume_fraction = 0.1 } }", ["lacks `distribution`", "a table"]),
        ("{ mu_t = 1 }", ["`mu_t` alone", "`particles`"]),
    ] {
        let text = text.replace("DISTRIBUTION", "distribution = { type = 'single', r = '1 um' }");
        let message = scene(&text, "rgb").unwrap_err().to_string();
        assert!(message.starts_with("scene.toml:4:"), "{message}");
        assert!(
            words.iter().all(|word| message.contains(word)) && !message.contains('\n'),
            "{text}: {message}"
        );
    }
    let description = scene(&haze(), "rgb").unwrap();
    let furlongs = SceneDescription { unit: "furlong".into(), ..description };
    let message = &furlongs.violations()[0].message;
    assert!(
        message.contains("physical units") && message.contains("`unit` as one of `m`, `km`"),
        "{message}"
    );
}

#[test]
fn the_hash_of_a_scene_knows_its_particles_and_their_unit() {
    let folder = tempfile::tempdir().unwrap();
    let file = "{ particles = { material_file = 'm.csv', distribution = { type = 'single', r = '1 um' },
        number_density = '1 /cm3' } }";
    let from_file = scene(&file.replace('\n', " "), "rgb").unwrap();
    let haze = scene(&haze(), "rgb").unwrap();
    let hash = |scene: &SceneDescription| scene_hash(scene, folder.path()).unwrap();
    assert_ne!(hash(&haze), hash(&SceneDescription { unit: "m".into(), ..haze.clone() }));
    let with = |text: &str| {
        std::fs::write(folder.path().join("m.csv"), text).unwrap();
        hash(&from_file)
    };
    assert_ne!(
        with("wavelength_nm,n,k\n300,1.3,0\n800,1.3,0\n"),
        with("wavelength_nm,n,k\n300,1.3,0\n800,1.4,0\n")
    );
}

#[test]
fn the_phase_function_is_that_of_the_spheres_at_each_colour() {
    let phase = |table: &str| medium(&format!("{{ mu_t = 1, albedo = 1, phase = {table} }}"), "rgb");
    let one = phase("{ type = 'mie', m = '1.33+1e-5i', x = 10 }");
    assert!(one.chromatic.is_none() && (one.phase_function.mean_cosine() - 0.712504141).abs() < 1e-4);
    let table = "{ type = 'mie', material = 'water', distribution = { type = 'log_normal', r_g = '0.2um', sigma_g = 1.4 } }";
    let [red, _, blue] = phase(table).chromatic.unwrap().phase_functions.clone().unwrap();
    let description = parse("mie:water:0.2um:lognormal(1.4)");
    for (colour, nm) in [(red, 611.4), (blue, 464.3)] {
        let spheres = mie_spheres(&description, nm, Path::new(""), &MieCache::none()).unwrap().unwrap();
        assert!((colour.mean_cosine() - spheres.average.g).abs() < 1e-4, "{nm} nm");
    }
    assert!(
        mie_spheres(&PhaseDescription::Rayleigh, 550.0, Path::new(""), &MieCache::none()).unwrap().is_none()
    );
}

#[test]
fn a_table_of_the_user_is_read_and_its_mistakes_are_told_with_the_line() {
    let folder = tempfile::tempdir().unwrap();
    let phase = parse("mie(material_file=m.csv,x=10)");
    let solve = || mie_spheres(&phase, 500.0, folder.path(), &MieCache::none());
    let read = |text: &str| {
        std::fs::write(folder.path().join("m.csv"), text).unwrap();
        solve().map(|spheres| spheres.unwrap().average.g)
    };
    let g = read("wavelength_um,n,k\n0.4,1.34,1e-5\n0.6,1.32,1e-5\n").unwrap();
    assert!((g - 0.712504141).abs() < 1e-8, "{g}");
    let message = read("wavelength_um,n,k\n0.4,1.34\n").unwrap_err().to_string();
    assert!(message.contains("m.csv: line 2: each line is three numbers"), "{message}");
    let message = read("wavelength_um,n,k\n0.6,1.34,0\n").unwrap_err().to_string();
    assert!(message.contains("is known from 600 to 600 nm, not at 500 nm"), "{message}");
    std::fs::remove_file(folder.path().join("m.csv")).unwrap();
    assert!(solve().unwrap_err().to_string().contains("m.csv"));
}
