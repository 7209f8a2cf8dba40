//! `tyndall estimators`: all estimators side by side on rays and pictures of a scene.

mod command;

use std::collections::BTreeSet;

use command::{Folder, SCENE};
use serde_json::Value;
use tyndall_transport::{DistanceSampler, TransmittanceEstimator};

/// The small cloud with a point light beside it.
fn folder() -> Folder {
    let folder = Folder::new();
    let light = "[[light]]\ntype = \"point\"\nposition = [0, 0.7, 0.7]\nintensity = 1\n";
    folder.write("scene.toml", format!("{SCENE}{light}"));
    folder
}

/// (kind, name) of all there are.
fn registered() -> BTreeSet<(String, String)> {
    let distance = DistanceSampler::ALL.iter().map(|sampler| ("distance", sampler.name()));
    let transmittance =
        TransmittanceEstimator::ALL.iter().map(|estimator| ("transmittance", estimator.name()));
    distance.chain(transmittance).map(|(kind, name)| (kind.into(), name.into())).collect()
}

fn list<'a>(value: &'a Value, key: &str) -> &'a Vec<Value> {
    value[key].as_array().unwrap_or_else(|| panic!("no list `{key}` in {value}"))
}

fn named(value: &Value) -> (String, String) {
    let text = |key: &str| value[key].as_str().unwrap().to_owned();
    (text("kind"), text("name"))
}

fn json(folder: &Folder, line: &str) -> Value {
    serde_json::from_str(&folder.done(line).out).unwrap()
}

/// What may differ between two runs.
fn without_times(value: &mut Value) {
    match value {
        Value::Object(object) => {
            for key in ["seconds", "efficiency"] {
                object.remove(key);
            }
            object.values_mut().for_each(without_times);
        }
        Value::Array(array) => array.iter_mut().for_each(without_times),
        _ => {}
    }
}

/// |z| < 5: of some 70 estimates with normal errors one in 20,000 runs had more. Those of which few samples decide are
/// marked, and left out.
#[test]
fn every_estimator_is_tried_or_refused_on_every_ray_and_the_unbiased_ones_are_right() {
    let folder = folder();
    let line = "estimators scene.toml --json --samples 3000";
    let mut report = json(&folder, line);
    let rays = list(&report, "rays");
    assert!(rays.len() == 3, "{} rays", rays.len());
    for ray in rays {
        let (tried, refused) = (list(ray, "estimators"), list(ray, "refused"));
        assert_eq!(tried.iter().chain(refused).map(named).collect::<BTreeSet<_>>(), registered());
        assert!(refused.iter().all(|refused| refused["reason"].as_str().unwrap().contains("closed form")));
        let tau = ray["optical_thickness"].as_f64().unwrap();
        assert!((ray["transmittance"].as_f64().unwrap() - (-tau).exp()).abs() < 1e-12);
        for trial in tried {
            let number = |key: &str| trial[key].as_f64();
            assert!(number("variance").is_some() && number("lookups").is_some_and(|n| n >= 0.0), "{trial}");
            assert!(number("seconds").is_some_and(|s| s > 0.0), "{trial}");
            assert_eq!(number("efficiency").is_none(), trial["exact"] == true, "{trial}");
            let is_known = number("standard_error_uncertainty").unwrap() < 0.3;
            if trial["unbiased"] == true && is_known {
                assert!(number("z").is_some_and(|z| z.abs() < 5.0), "tau {tau}: {trial}");
                let escape = &trial["escape"];
                let is_wrong = escape["z"].as_f64().is_some_and(|z| z.abs() > 5.0);
                assert!(
                    escape.is_null() == (trial["kind"] == "transmittance") && !is_wrong,
                    "tau {tau}: {trial}"
                );
            }
        }
        let exact = tried.iter().find(|t| named(t) == ("transmittance".into(), "regular-tracking".into()));
        assert_eq!(exact.unwrap()["exact"], true);
    }
    let mut again = json(&folder, line);
    without_times(&mut report);
    without_times(&mut again);
    assert_eq!(report, again);
}

#[test]
fn table_and_report_name_all_estimators_and_the_report_needs_nothing_else() {
    let folder = folder();
    let run = folder.done("estimators scene.toml --pixel 16,12 --samples 256 -o report.html");
    let page = String::from_utf8(folder.read("report.html")).unwrap();
    for (_, name) in registered() {
        assert!(run.out.contains(&name) && page.contains(&name), "{name}");
    }
    let long = run.out.lines().find(|line| line.chars().count() > 100);
    assert!(long.is_none(), "{long:?}");
    assert!(page.starts_with("<!DOCTYPE html>") && page.ends_with("</html>\n"));
    assert_eq!(page.matches("<svg ").count(), 6);
    for words in
        ["optical thickness", "samples n", "error of the mean", "efficiency, 1/s", "lookups a sample"]
    {
        assert!(page.contains(words), "{words}");
    }
    for outside in ["<script", "src=", "href=", "url(", "@import", "NaN", "inf\""] {
        assert!(!page.contains(outside), "{outside}");
    }
    folder.done("estimators scene.toml --pixel 16,12 --samples 64 -o plots.svg");
    let plots = String::from_utf8(folder.read("plots.svg")).unwrap();
    assert!(plots.starts_with("<svg ") && plots.ends_with("</svg>\n") && plots.contains("Convergence"));
}

/// Differences of the means of pictures from the default's, as of two dozen normal ones.
#[test]
fn pictures_by_every_choice_that_suits_the_scene_agree() {
    let folder = folder();
    let line = "estimators scene.toml --json --samples 16 --pixel 16,12 --pictures --width 12 --spp 16";
    let report = json(&folder, line);
    let pictures = &report["pictures"];
    assert_eq!(pictures["resolution"], serde_json::json!([12, 9]));
    let (tried, refused) = (list(pictures, "estimators"), list(pictures, "refused"));
    let chosen = tried.iter().filter(|picture| picture["name"] != "default");
    assert_eq!(chosen.chain(refused).map(named).collect::<BTreeSet<_>>(), registered());
    assert_eq!(refused.len(), 2);
    for picture in tried.iter().filter(|picture| picture["name"] != "default" && picture["unbiased"] == true)
    {
        assert!(picture["z"].as_f64().is_some_and(|z| z.abs() < 5.0), "{picture}");
        assert!(picture["relmse"].as_f64().is_some_and(|error| error > 0.0), "{picture}");
    }
}

#[test]
fn without_light_or_grid_the_others_are_refused_and_homogeneous_media_are_exact() {
    let folder = Folder::new();
    let fog = SCENE.replace(
        "procedural = { type = \"cumulus\", resolution = 16, size = 2 }",
        "box = { min = [-1, -1, -1], max = [1, 1, 1] }",
    );
    folder.write("fog.toml", fog.replace("mu_t = 20", "mu_t = 0.5"));
    let report = json(&folder, "estimators fog.toml --json --samples 500");
    for ray in list(&report, "rays") {
        let refused: Vec<_> = list(ray, "refused").iter().map(named).collect();
        assert_eq!(refused, [("distance".to_owned(), "equiangular".to_owned())]);
        let is_closed = |trial: &&Value| named(trial) == ("transmittance".into(), "closed-form".into());
        assert!(list(ray, "estimators").iter().find(is_closed).is_some_and(|trial| trial["exact"] == true));
    }
}

#[test]
fn what_cannot_be_compared_is_refused_in_one_line() {
    let folder = folder();
    let light = "[[light]]\ntype = \"constant\"\nradiance = 1\n";
    folder.write("empty.toml", SCENE.split("[[volume]]").next().unwrap().to_owned() + light);
    folder.write("away.toml", SCENE.replace("target = [0, 0, 0]", "target = [0, 0, 9]"));
    for (line, words) in [
        ("empty.toml", ["empty.toml", "[[volume]]"]),
        ("away.toml", ["away.toml", "no camera ray"]),
        ("scene.toml --pixel 32,0", ["--pixel 32,0", "32x24"]),
        ("scene.toml --pixel 0,0", ["--pixel 0,0", "meets no medium"]),
        ("scene.toml --ray 0,0,4,0,0,1", ["--ray", "meets no medium"]),
        ("scene.toml -o no/such.html", ["no/such.html", "create it"]),
        ("nosuch.toml", ["nosuch.toml", "no such file"]),
    ] {
        let run = folder.run(&format!("estimators {line}"));
        assert_eq!(
            (run.code, run.out.as_str(), run.err.lines().count()),
            (Some(1), "", 1),
            "{line}: {}",
            run.err
        );
        assert!(words.iter().all(|word| run.error().contains(word)), "{line}: {}", run.error());
    }
    for line in
        ["-o a.png", "--samples 0", "--pixel 3", "--ray 0,0,0,0,0,0", "--ray 0,0,0,0,nan,1", "--width 9"]
    {
        assert_eq!(folder.run(&format!("estimators scene.toml {line}")).code, Some(2), "{line}");
    }
}
