//! Pictures that are no RGB: bands of single wavelengths, and XYZ.

mod command;

use command::Folder;
use serde_json::Value;

/// A scene in spectral mode whose film has these keys.
fn spectral(folder: &Folder, film: &str) {
    let scene = command::SCENE
        .replace("[render]", &format!("{film}\n[render]\nmode = \"spectral\""))
        .replace("radiance = 1", "radiance = { wavelengths = [400, 800], values = [1, 5] }");
    folder.write("spectral.toml", scene);
}

fn json(folder: &Folder, name: &str) -> Value {
    serde_json::from_slice(&folder.read(name)).unwrap()
}

#[test]
fn any_number_of_bands_is_one_file_with_their_errors() {
    let folder = Folder::new();
    spectral(&folder, "bands = [650, 450, 550, 500.5]");
    folder.done("render spectral.toml --spp 8 -o a.exr -o a.json");
    let bands = json(&folder, "a.json")["bands"].clone();
    let wavelengths: Vec<f64> =
        bands.as_array().unwrap().iter().map(|band| band["wavelength_nm"].as_f64().unwrap()).collect();
    assert_eq!(wavelengths, [450.0, 500.5, 550.0, 650.0]);
    for band in bands.as_array().unwrap() {
        // An absorbing cloud before light that grows from 1 to 5 between 400 and 800 nm.
        let light = 1.0 + (band["wavelength_nm"].as_f64().unwrap() - 400.0) / 100.0;
        let (mean, error) = (band["mean"].as_f64().unwrap(), band["standard_error"].as_f64().unwrap());
        assert!(mean > 0.5 * light && mean < light + 5.0 * error && error < 0.05 * light, "{band}");
    }
    let exr = folder.read("a.exr");
    for name in ["650nm", "450nm", "550nm", "500,5nm", "StandardError.500,5nm"] {
        let name = [name.as_bytes(), b"\0"].concat();
        assert!(exr.windows(name.len()).any(|bytes| bytes == name), "no channel {name:?}");
    }
}

#[test]
fn bands_have_no_png_and_more_than_three_no_accumulation() {
    let folder = Folder::new();
    spectral(&folder, "bands = [450, 500, 550, 650]");
    for (output, reason) in [("a.png", "shows red, green and blue"), ("a.acc", "at most three bands")] {
        let run = folder.run(&format!("render spectral.toml -o {output}"));
        assert!(run.code == Some(1) && run.err.contains(reason), "{}", run.err);
    }
    spectral(&folder, "bands = [450, 500]");
    folder.done("render spectral.toml --samples 0..2 -o a.acc");
    folder.done("render spectral.toml --samples 2..4 -o b.acc");
    folder.done("render spectral.toml --spp 4 -o whole.json");
    folder.done("merge a.acc b.acc -o merged.json");
    let bands = json(&folder, "merged.json")["bands"].clone();
    assert_eq!(bands.as_array().map(Vec::len), Some(2));
    assert_eq!(bands, json(&folder, "whole.json")["bands"]);
}

#[test]
fn xyz_is_named_so_and_has_the_luminance_of_the_rgb_picture() {
    let folder = Folder::new();
    spectral(&folder, "output = \"xyz\"");
    folder.done("render spectral.toml --spp 16");
    assert!(folder.names().contains(&"spectral.json".to_owned()), "{:?}", folder.names());
    let xyz = json(&folder, "spectral.json");
    assert_eq!(xyz["colours"], "xyz");
    spectral(&folder, "");
    folder.done("render spectral.toml --spp 16 -o rgb.json");
    let mean = |json: &Value, channel: usize| json["mean"][channel]["mean"].as_f64().unwrap();
    let rgb = json(&folder, "rgb.json");
    let luminance = 0.21267 * mean(&rgb, 0) + 0.71515 * mean(&rgb, 1) + 0.07217 * mean(&rgb, 2);
    // The same samples, seen otherwise.
    assert!((luminance / mean(&xyz, 1) - 1.0).abs() < 1e-4, "{luminance}, {xyz}");
}
