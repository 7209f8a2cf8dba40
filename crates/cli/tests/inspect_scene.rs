//! `tyndall inspect` of scenes, `schema`, `completions` and `convert`.

mod command;

use command::{Folder, SCENE, shared_volumes};
use serde_json::Value;

#[test]
fn a_scene_is_told_as_a_scene_file_and_in_json() {
    let folder = Folder::new();
    let text = folder.done("inspect scene.toml").out;
    for words in ["mu_t = 20", "# volume.0", "world box", "optical thickness", "memory"] {
        assert!(text.contains(words), "{words}: {text}");
    }
    folder.write("told.toml", &text);
    let json = |name: &str| -> Value {
        serde_json::from_str(&folder.done(&format!("inspect {name} --json")).out).unwrap()
    };
    let report = json("scene.toml");
    assert_eq!(report["scene_hash"], json("told.toml")["scene_hash"]);
    assert_eq!(report["scene"]["volume"][0]["mu_t"], 20.0);
    let volume = &report["volumes"][0];
    assert!(volume["optical_thickness"]["mean"][0].as_f64().unwrap() > 0.0, "{volume}");
    assert!(volume["memory_bytes"].as_u64().unwrap() > 0 && volume["grid"].is_null(), "{volume}");
}

#[test]
fn the_grid_that_a_scene_takes_is_told() {
    let Some(volumes) = shared_volumes() else { return };
    let folder = Folder::new();
    let base = SCENE.split("[[volume]]").next().unwrap();
    let file = volumes.join("variants/multi.vdb");
    folder.write(
        "scene.toml",
        format!("{base}\n[[volume]]\nfile = '{}'\nmu_t = 1\nalbedo = 1\n", file.display()),
    );
    let report: Value = serde_json::from_str(&folder.done("inspect scene.toml --json").out).unwrap();
    assert_eq!(report["volumes"][0]["grid"], "density");
    assert!(report["notes"].to_string().contains("temperature"), "{report}");
}

#[test]
fn the_schema_is_json_and_every_shell_has_completions() {
    let folder = Folder::new();
    let schema: Value = serde_json::from_str(&folder.done("schema").out).unwrap();
    assert!(schema["properties"]["camera"].is_object());
    for shell in ["bash", "zsh", "fish", "powershell", "elvish"] {
        assert!(folder.done(&format!("completions {shell}")).out.contains("render"), "{shell}");
    }
}

#[test]
fn converted_volumes_hold_the_same_values_in_the_codec_that_their_readers_have() {
    let Some(volumes) = shared_volumes() else { return };
    let folder = Folder::new();
    let inspect = |name: &str| -> Value {
        serde_json::from_str(&folder.done(&format!("inspect {name} --json")).out).unwrap()
    };
    let source = volumes.join("dragon.vdb").display().to_string();
    let sum = inspect(&source)["grids"][0]["sum"].as_f64().unwrap();
    for extension in ["vdb", "nvdb", "vol", "npy", "nii", "nii.gz", "raw"] {
        let run = folder.done(&format!("convert {source} dragon.{extension}"));
        let written = run.out.split_whitespace().nth(1).unwrap();
        let grid = &inspect(written)["grids"][0];
        assert!((grid["sum"].as_f64().unwrap() / sum - 1.0).abs() < 1e-6, "{written}");
        if extension == "nvdb" {
            assert_eq!(grid["codec"], "zip");
        }
    }
    assert_eq!(folder.run(&format!("convert {source} dragon.txt")).code, Some(1));
    let several = volumes.join("variants/multi.vdb");
    let run = folder.run(&format!("convert {} one.npy", several.display()));
    assert!(run.code == Some(1) && run.error().contains("`temperature`"), "{}", run.err);
}
