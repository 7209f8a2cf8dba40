//! The gallery in `examples/` keeps its promises: scenes render, pictures are there, links lead somewhere.

#[path = "../examples/gallery/chapters.rs"]
#[allow(dead_code, reason = "the pictures are made by the example, not by its test")]
mod chapters;
mod command;

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use chapters::{CHAPTERS, Picture};
use command::Folder;

fn gallery() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples").canonicalize().unwrap()
}

fn chapter_folders() -> BTreeSet<String> {
    let entries = std::fs::read_dir(gallery()).unwrap().map(Result::unwrap);
    entries.filter(|e| e.path().is_dir()).map(|e| e.file_name().into_string().unwrap()).collect()
}

/// The command that renders a scene with as little work as can be.
fn small_render(scene: &Path) -> String {
    let mut line = format!("render {} --resolution 8x8 --spp 1 -o x.json", scene.display());
    let text = std::fs::read_to_string(scene).unwrap();
    for (number, volume) in text.split("[[volume]]").skip(1).enumerate() {
        if volume.contains("procedural") {
            line += &format!(" --set volume.{number}.procedural.resolution=16");
        }
        // Small droplets are soon summed up.
        if volume.contains("r_eff") {
            line += &format!(" --set volume.{number}.phase.distribution.r_eff=0.5um");
        }
    }
    line
}

#[test]
fn every_scene_renders_without_a_rejected_sample() {
    let folders = chapter_folders().into_iter().map(|folder| gallery().join(folder));
    let files =
        folders.flat_map(|folder| std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()));
    let scenes: Vec<PathBuf> = files.filter(|file| file.extension().is_some_and(|e| e == "toml")).collect();
    assert!(scenes.len() > 8, "{scenes:?}");
    let check = |scenes: &[PathBuf]| {
        let folder = Folder::new();
        for scene in scenes {
            let run = folder.done(&small_render(scene));
            let json: serde_json::Value = serde_json::from_slice(&folder.read("x.json")).unwrap();
            assert_eq!(json["rejected"], 0, "{}: {}", scene.display(), run.err);
            assert!(!run.err.contains("the scene has no light"), "{}: {}", scene.display(), run.err);
        }
    };
    let (first, second) = scenes.split_at(scenes.len() / 2);
    std::thread::scope(|scope| {
        scope.spawn(|| check(first));
        check(second);
    });
}

#[test]
fn every_panel_is_a_valid_change_of_its_scene() {
    let folder = Folder::new();
    for chapter in CHAPTERS {
        let Picture::Panels { panels, .. } = &chapter.picture else { continue };
        for panel in *panels {
            let path = gallery().join(chapter.folder);
            folder.done(&format!("render {}/{} --print-scene", path.display(), panel.render));
        }
    }
}

#[test]
fn every_folder_is_a_chapter_with_a_text_and_a_picture_and_the_index_names_it() {
    let listed: BTreeSet<String> = CHAPTERS.iter().map(|chapter| chapter.folder.to_owned()).collect();
    assert_eq!(chapter_folders(), listed);
    let index = std::fs::read_to_string(gallery().join("README.md")).unwrap();
    for folder in &listed {
        let text = std::fs::read_to_string(gallery().join(folder).join("README.md")).unwrap();
        let picture = ["picture.png", "picture.svg"]
            .into_iter()
            .find(|name| gallery().join(folder).join(name).is_file());
        let picture = picture.unwrap_or_else(|| panic!("{folder} has no picture"));
        assert!(text.contains(&format!("({picture})")), "{folder}/README.md does not show {picture}");
        let number = folder.split('_').next().unwrap();
        assert!(text.starts_with(&format!("# {number} ")), "{folder}/README.md");
        for shown in [format!("({folder}/README.md)"), format!("{folder}/{picture}")] {
            assert!(index.contains(&shown), "examples/README.md does not have {shown}");
        }
        let size = std::fs::metadata(gallery().join(folder).join(picture)).unwrap().len();
        assert!(size < 260_000, "{folder}/{picture} has {size} bytes");
    }
}

/// The links of a text as (what is written, where it leads).
fn links(text: &str) -> Vec<(&str, &str)> {
    text.split("](")
        .zip(text.split("](").skip(1))
        .filter_map(|(before, after)| Some((before.rsplit('[').next()?, after.split(')').next()?)))
        .collect()
}

/// A link that is written `fn name` or `enum Name` leads to a file that has it.
#[test]
fn every_link_leads_to_a_file_that_has_what_it_names() {
    let mut named = 0;
    let texts = chapter_folders().into_iter().map(|folder| format!("{folder}/README.md"));
    for text_file in texts.chain(["README.md".to_owned()]) {
        let path = gallery().join(&text_file);
        let text = std::fs::read_to_string(&path).unwrap();
        for (written, target) in links(&text) {
            let target_path = path.parent().unwrap().join(target);
            assert!(target_path.exists(), "{text_file}: {target} is not there");
            let name = written.trim_matches('`');
            if name.starts_with("fn ") || name.starts_with("enum ") || name.starts_with("struct ") {
                let code = std::fs::read_to_string(&target_path).unwrap();
                let is_there = code.match_indices(name).any(|(at, _)| {
                    !code[at + name.len()..].starts_with(|c: char| c.is_alphanumeric() || c == '_')
                });
                assert!(is_there, "{text_file}: {target} has no `{name}`");
                named += 1;
            }
        }
    }
    assert!(named > 20, "{named}");
}
