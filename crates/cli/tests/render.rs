//! `tyndall render`: the same bits whatever the way, stop rules, interruption, reports.

mod command;

#[cfg(unix)]
use std::io::{BufRead, BufReader};
#[cfg(unix)]
use std::process::{Child, Stdio};

use command::{Folder, shared_volumes};
use serde_json::Value;

/// The picture and all its layers, without what depends on the clock.
fn pixels(folder: &Folder, name: &str) -> Vec<u8> {
    let mut picture = folder.accumulation(name);
    picture.metadata.seconds = 0.0;
    let path = folder.path("timeless.exr");
    tyndall_film::write_exr(&path, &picture.film, &picture.metadata).unwrap();
    std::fs::read(path).unwrap()
}

fn same_film(folder: &Folder, a: &str, b: &str) {
    assert!(folder.accumulation(a).film == folder.accumulation(b).film, "{a} and {b} differ");
}

#[test]
fn threads_and_repetition_do_not_change_a_bit() {
    let folder = Folder::new();
    for integrator in ["fast", "reference"] {
        for (name, options) in [("a", "--threads 1"), ("b", "--threads 2"), ("c", "--threads 7"), ("d", "")] {
            let outputs = format!("-o {name}.png -o {name}.acc");
            folder.done(&format!("render scene.toml --integrator {integrator} {options} {outputs}"));
        }
        for other in ["b", "c", "d"] {
            same_film(&folder, "a.acc", &format!("{other}.acc"));
            assert!(folder.read("a.png") == folder.read(&format!("{other}.png")), "{integrator} {other}");
        }
    }
    folder.done("render scene.toml --seed 1 -o a.acc");
    assert!(folder.accumulation("a.acc").film != folder.accumulation("b.acc").film);
}

#[test]
fn merged_parts_are_the_whole_and_make_the_same_picture() {
    let folder = Folder::new();
    folder.done("render scene.toml --samples 0..8 -o a.acc");
    folder.done("render scene.toml --samples 8..16 -o b.acc");
    folder.done("render scene.toml --spp 16 -o whole.acc -o whole.png");
    folder.done("merge b.acc a.acc -o merged.acc -o merged.png");
    same_film(&folder, "whole.acc", "merged.acc");
    assert!(pixels(&folder, "whole.acc") == pixels(&folder, "merged.acc"));
    assert!(folder.read("whole.png") == folder.read("merged.png"));

    folder.done("render scene.toml --samples 8..16 --seed 3 -o seed.acc");
    folder.done("render scene.toml --samples 8..16 --set volume.0.mu_t=3 -o scene.acc");
    folder.done("render scene.toml --samples 8..16 --sampler sobol -o sampler.acc");
    let others =
        [("a.acc", "0..8"), ("seed.acc", "seed"), ("scene.acc", "scene"), ("sampler.acc", "sampler=sobol")];
    for (other, word) in others {
        let run = folder.run(&format!("merge a.acc {other} -o refused.exr"));
        assert!(run.code == Some(1) && run.error().contains(word), "{}", run.err);
    }
    assert!(!folder.path("refused.exr").exists());
}

#[test]
fn adaptive_parts_are_the_whole_and_know_their_numbers_of_samples() {
    let folder = Folder::new();
    folder.done("render scene.toml --adaptive --samples 0..8 -o a.acc");
    folder.done("render scene.toml --adaptive --samples 8..40 --threads 1 -o b.acc");
    folder.done("render scene.toml --adaptive --spp 40 -o whole.acc -o whole.json");
    folder.done("merge b.acc a.acc -o merged.acc");
    same_film(&folder, "whole.acc", "merged.acc");
    folder.done("render scene.toml --adaptive --spp 5 --checkpoint c.acc -o c.png");
    folder.done("render scene.toml --adaptive --spp 40 --checkpoint c.acc --resume -o c.png");
    same_film(&folder, "whole.acc", "c.acc");

    let film = folder.accumulation("whole.acc").film;
    let pixels = (0..24).flat_map(|y| (0..32).map(move |x| (x, y)));
    let counts: Vec<u64> = pixels.map(|(x, y)| film.sample_count(x, y)).collect();
    assert!(counts.iter().max() > Some(&50) && counts.iter().min() < Some(&30), "{counts:?}");
    assert!((39.5..=40.5).contains(&film.mean_sample_count()), "{}", film.mean_sample_count());
    assert_eq!(film.least_sample_count(), *counts.iter().min().unwrap());

    let run = folder.done("render scene.toml --adaptive --samples 6..7 -o part.exr");
    assert!(run.err.contains("pixels have no sample in this part"), "{}", run.err);
    let run = folder
        .run("render scene.toml --adaptive --samples 4611686018427387900..4611686018427387910 -o far.acc");
    assert!(run.code == Some(1) && run.err.contains("2^60"), "{}", run.err);

    folder.done("render scene.toml --samples 8..40 -o even.acc");
    let run = folder.run("merge a.acc even.acc -o refused.exr");
    assert!(run.code == Some(1) && run.error().contains("adaptive=yes"), "{}", run.err);
}

#[test]
fn a_crop_is_a_picture_of_its_own_size_in_the_window_of_the_whole() {
    let folder = Folder::new();
    folder.done("render scene.toml --set film.crop=[8,6,10,12] -o part.acc -o part.exr");
    let part = folder.accumulation("part.acc");
    assert_eq!((part.film.width(), part.film.height()), (10, 12));
    assert!(part.film.mean(5, 6) != [0.0; 3]);
    let windows = exr::meta::MetaData::read_from_file(folder.path("part.exr"), false).unwrap();
    let header = &windows.headers[0];
    assert_eq!(header.own_attributes.layer_position, exr::math::Vec2(8, 6));
    assert_eq!(header.shared_attributes.display_window.size, exr::math::Vec2(32, 24));
}

#[test]
fn estimators_are_chosen_by_name_and_take_the_reference_integrator() {
    let folder = Folder::new();
    folder.done("render scene.toml --integrator reference -o default.acc");
    let run = folder
        .run("render scene.toml --distance regular-tracking --transmittance p-series-cmf -o chosen.acc");
    assert!(run.code == Some(0) && run.err.contains("reference integrator"), "{}", run.err);
    let [default, chosen] = ["default.acc", "chosen.acc"].map(|name| folder.accumulation(name));
    assert!(default.film != chosen.film);
    assert_eq!(default.metadata.scene_hash, chosen.metadata.scene_hash);
    assert_eq!(
        chosen.metadata.options,
        "integrator=reference distance=regular-tracking transmittance=p-series-cmf"
    );
    let biased = folder.run("render scene.toml --distance ray-marching -o biased.acc");
    assert!(biased.code == Some(0) && biased.err.contains("biased"), "{}", biased.err);
}

#[test]
fn estimators_that_do_not_fit_are_refused_with_the_reason() {
    let folder = Folder::new();
    for (options, code, word) in [
        ("--distance equiangular", 1, "point light"),
        ("--distance delta-tracking --integrator fast", 1, "reference"),
        ("--transmittance nonsense", 2, "ratio-tracking"),
    ] {
        let run = folder.run(&format!("render scene.toml {options} -o refused.exr"));
        assert!(run.code == Some(code) && run.err.contains(word), "{options}: {:?} {}", run.code, run.err);
    }
    assert!(!folder.path("refused.exr").exists());
}

#[test]
fn pictures_of_different_size_are_not_compared() {
    let folder = Folder::new();
    folder.done("render scene.toml -o a.exr");
    folder.done("render scene.toml --resolution 8x8 -o b.exr");
    let run = folder.run("diff a.exr b.exr");
    assert_eq!(run.code, Some(1));
    assert!(["a.exr", "b.exr", "32x24", "8x8"].iter().all(|word| run.error().contains(word)), "{}", run.err);
}

#[test]
fn stop_rules_stop() {
    let folder = Folder::new();
    folder.done("render scene.toml --error 10% -o error.json");
    let summary: Value = serde_json::from_slice(&folder.read("error.json")).unwrap();
    let error = summary["median_relative_error"].as_f64().unwrap();
    assert!(error <= 0.1, "{summary}");
    folder.done("render scene.toml --error 0.0001% --spp 20 -o spp.acc");
    assert_eq!(folder.accumulation("spp.acc").film.complete().count(), 20);
    // An error of a millionth takes days: only the time can have stopped it.
    folder.done("render scene.toml --error 0.0001% --time 0.2s -o time.acc");
    assert!(folder.accumulation("time.acc").film.complete().count() > 0);
}

#[test]
fn samples_too_bright_for_the_film_are_left_out_and_told() {
    let folder = Folder::new();
    let scene = r#"
        camera = { position = [0, 0, 5], target = [0, 0, 0] }
        film = { resolution = [32, 24] }
        light = [{ type = "constant", radiance = 1 }]
        volume = [{ sphere = { center = [0, 0, 0], radius = 0.1 }, mu_t = 0.001, albedo = 0, emission_per_length = 1e13 }]
    "#;
    folder.write("bright.toml", scene);
    let run = folder.done("render bright.toml --spp 16 -o whole.acc -o whole.json");
    assert!(run.err.contains("warning: ") && run.err.contains("too large and are left out"), "{}", run.err);
    let summary: Value = serde_json::from_slice(&folder.read("whole.json")).unwrap();
    assert!(summary["rejected"].as_u64().unwrap() > 0);
    // Beside what glows, of half a pixel's radius, there is nothing but light 1; there, every mean is a number.
    let film = folder.accumulation("whole.acc").film;
    let is_beside = |x: u32, y: u32| x.abs_diff(16) > 2 || y.abs_diff(12) > 2;
    for (x, y) in (0..32 * 24).map(|i| (i % 32, i / 32)) {
        let mean = film.mean(x, y);
        assert!(mean == [1.0; 3] || !is_beside(x, y) && mean[0].is_finite(), "{x} {y}: {mean:?}");
    }
    folder.done("render bright.toml --samples 0..6 -o a.acc");
    folder.done("render bright.toml --samples 6..16 -o b.acc");
    let run = folder.done("merge b.acc a.acc -o merged.acc");
    assert!(run.err.contains("are left out"), "{}", run.err);
    same_film(&folder, "whole.acc", "merged.acc");
}

/// A floor under light 1 and a bright lamp. Glass about the lamp bends no light, but no ray can be aimed at it: only one
/// path in 170 finds it by chance.
const LAMP_IN_GLASS: &str = r#"
    camera = { position = [0, 6, 0], target = [0, 0, 0], up = [0, 0, 1], vertical_fov = 40 }
    film = { resolution = [32, 18] }
    light = [{ type = "constant", radiance = 1 }]
    [[shape]]
    rectangle = { corner = [-9, 0, -9], u = [0, 0, 18], v = [18, 0, 0] }
    material = { type = "diffuse", reflectance = 0.5 }
    [[shape]]
    sphere = { center = [0, 9, 0], radius = 0.25 }
    material = { type = "diffuse", reflectance = 0 }
    emission = { radiance = 393 }
    [[shape]]
    sphere = { center = [0, 9, 0], radius = 1.2 }
    material = { type = "dielectric", index = 1.0001 }
"#;

/// Median over the pixels of the true relative error: a sphere of radius r and radiance L at distance d gives the irradiance
/// π L (r/d)² cos θ, and hides as much of the light behind it.
fn true_error_of_lamp_in_glass(film: &tyndall_film::Film) -> f64 {
    let size = 6.0 * 20f64.to_radians().tan() / 9.0;
    let mut errors: Vec<f64> = (0..32 * 18)
        .map(|pixel| {
            let [x, y] = [f64::from(pixel % 32) - 15.5, f64::from(pixel / 32) - 8.5].map(|i| i * size);
            let distance = (81.0 + x * x + y * y).sqrt();
            let truth = 0.5 * (1.0 + 392.0 * (0.25 / distance).powi(2) * 9.0 / distance);
            (film.mean(pixel % 32, pixel / 32)[0] / truth - 1.0).abs()
        })
        .collect();
    errors.sort_by(f64::total_cmp);
    errors[errors.len() / 2]
}

#[test]
fn an_error_is_not_reached_while_most_pixels_have_not_seen_a_rare_path() {
    let folder = Folder::new();
    folder.write("lamp.toml", LAMP_IN_GLASS);
    let run = folder.done("render lamp.toml --spp 16 -o early.acc -o early.json");
    let film = folder.accumulation("early.acc").film;
    assert!(film.median_relative_error().unwrap() < 0.01 && true_error_of_lamp_in_glass(&film) > 0.2);
    assert!(run.err.contains("owe more than 1.0 % of their light to one sample"), "{}", run.err);
    let summary: Value = serde_json::from_slice(&folder.read("early.json")).unwrap();
    assert!(summary["unseen_light"]["bound"].as_f64().unwrap() > 0.1, "{summary}");

    let run = folder.done("render lamp.toml --error 15% --spp 10000 -o late.acc");
    let film = folder.accumulation("late.acc").film;
    let (spp, error) = (film.complete().count(), true_error_of_lamp_in_glass(&film));
    assert!((64..2000).contains(&spp) && error < 0.15, "{spp} {error}");
    assert!(!run.err.contains("warning"), "{}", run.err);
}

#[test]
fn progress_in_json_is_an_object_a_line() {
    let folder = Folder::new();
    let run = folder.done("render scene.toml --progress json -o a.png");
    let lines: Vec<Value> = run.out.lines().map(|line| serde_json::from_str(line).unwrap()).collect();
    for key in ["samples", "seconds", "rate", "error", "time_left"] {
        assert!(lines.iter().all(|line| line.get(key).is_some()), "{key}");
    }
    assert_eq!(lines.last().unwrap()["samples"], 4.0);
}

#[test]
fn a_printed_scene_is_the_same_scene() {
    let folder = Folder::new();
    let changes = "--set volume.0.mu_t=3 --resolution 20x10 --seed 5";
    folder.write("printed.toml", folder.done(&format!("render scene.toml {changes} --print-scene")).out);
    folder.done(&format!("render scene.toml {changes} -o a.acc"));
    folder.done("render printed.toml -o b.acc");
    same_film(&folder, "a.acc", "b.acc");
    let hash = |name: &str| folder.accumulation(name).metadata.scene_hash;
    assert_eq!(hash("a.acc"), hash("b.acc"));

    let Some(volumes) = shared_volumes() else { return };
    let volume = volumes.join("buckyball.raw");
    let raw = format!("{} --raw-shape 32x32x32 --raw-type uint8 --resolution 24x16", volume.display());
    folder.write("raw.toml", folder.done(&format!("render {raw} --print-scene")).out);
    folder.done(&format!("render {raw} --spp 1 -o raw.acc"));
    folder.done("render raw.toml --spp 1 -o printed.acc");
    same_film(&folder, "raw.acc", "printed.acc");
    assert_eq!(hash("raw.acc"), hash("printed.acc"));
}

#[test]
fn outputs_are_named_after_the_input_and_nothing_else_is_left() {
    let folder = Folder::new();
    let run = folder.done("render scene.toml");
    assert_eq!(folder.names(), ["scene.exr", "scene.png", "scene.toml"]);
    assert!(run.err.contains("wrote scene.exr\nwrote scene.png"), "{}", run.err);
}

/// Samples that take many minutes: only an interruption ends them, or the time if a test fails.
#[cfg(unix)]
const LONG: &str = "render scene.toml --resolution 160x90 --spp 100000 --time 60s";

#[cfg(unix)]
fn signal(child: &Child, name: &str) {
    let id = child.id().to_string();
    assert!(std::process::Command::new("kill").args([name, &id]).status().unwrap().success());
}

/// Starts a long render and sends `name` once it has reported its progress `reports` times: the first comes when it
/// begins, the others half a second apart.
#[cfg(unix)]
fn interrupt(folder: &Folder, options: &str, reports: usize, name: &str) -> Option<i32> {
    let mut command = folder.command(&format!("{LONG} {options} --progress json"));
    let mut child = command.stdout(Stdio::piped()).stderr(Stdio::null()).spawn().unwrap();
    let lines = BufReader::new(child.stdout.take().unwrap()).lines();
    assert_eq!(lines.take(reports).filter(Result::is_ok).count(), reports);
    signal(&child, name);
    child.wait().unwrap().code()
}

#[cfg(unix)]
#[test]
fn an_interrupted_render_saves_what_there_is_and_goes_on_from_it_to_the_same_bits() {
    let folder = Folder::new();
    let saved = || folder.path("check.acc").exists().then(|| folder.accumulation("check.acc").film);
    for reports in [1, 2] {
        let code = interrupt(&folder, "-o part.exr -o part.acc --checkpoint check.acc", reports, "-INT");
        assert_eq!(code, Some(130));
        let part = saved();
        // A first pass of which no tile was done leaves nothing to save.
        assert!(part.is_some() || reports == 1);
        if let Some(part) = &part {
            assert!(part.mean_sample_count() > 0.0 && folder.path("part.exr").exists());
            assert!(*part == folder.accumulation("part.acc").film);
        }
        // Killed while it goes on, without a chance to save: the checkpoint stays whole.
        let code = interrupt(&folder, "-o part.exr --checkpoint check.acc --resume", reports, "-KILL");
        assert!(code.is_none() && saved() == part);

        // Beyond the end of the pass that was interrupted, which some tiles may have reached.
        let end = part.map_or(0, |part| part.complete().count()) + 20;
        let size = format!("render scene.toml --resolution 160x90 --spp {end}");
        folder.done(&format!("{size} -o resumed.acc --checkpoint check.acc --resume"));
        folder.done(&format!("{size} -o whole.acc"));
        same_film(&folder, "resumed.acc", "whole.acc");
        std::fs::remove_file(folder.path("check.acc")).unwrap();
    }
}

#[test]
fn a_checkpoint_of_another_scene_is_refused() {
    let folder = Folder::new();
    folder.done("render scene.toml --checkpoint check.acc -o a.png");
    for other in ["--seed 2", "--resolution 9x9", "--set volume.0.mu_t=1", "--integrator reference"] {
        let run = folder.run(&format!("render scene.toml {other} --checkpoint check.acc --resume -o a.png"));
        assert!(
            run.code == Some(1) && run.error().contains("check.acc: is of another"),
            "{other}: {}",
            run.err
        );
    }
}

#[cfg(unix)]
#[test]
fn a_termination_request_and_a_closed_terminal_save_as_well() {
    let folder = Folder::new();
    for (name, code) in [("-TERM", 143), ("-HUP", 129)] {
        assert_eq!(interrupt(&folder, "-o part.acc", 2, name), Some(code));
        assert!(folder.accumulation("part.acc").film.mean_sample_count() > 0.0);
        std::fs::remove_file(folder.path("part.acc")).unwrap();
    }
}
