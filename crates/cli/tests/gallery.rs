//! The gallery in `examples/` keeps its promises: scenes render, pictures are there, links lead somewhere.

mod command;
#[path = "../examples/gallery/chapters.rs"]
#[allow(dead_code, reason = "the pictures are made by the example, not by its test")]
mod chapters;

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

/// The scenes of the folder, and how panels change them.
fn renders(folder: &str) -> BTreeSet<String> {
    let files = std::fs::read_dir(gallery().join(folder)).unwrap().map(|entry| entry.unwrap().file_name());
    let scenes = files.map(|name| name.into_string().unwrap()).filter(|name| name.ends_with(".toml"));
    let mut renders: BTreeSet<String> = scenes.collect();
    let chapter = CHAPTERS.iter().find(|chapter| chapter.folder == folder);
    if let Some(Picture::Panels { panels, .. }) = chapter.map(|chapter| &chapter.picture) {
        renders.extend(panels.iter().map(|panel| panel.render.to_owned()));
    }
    renders
}

/// The same with as little work as can be.
fn reduced(folder: &str, render: &str) -> String {
    let path = gallery().join(folder);
    let mut words = render.split_whitespace();
    let scene = path.join(words.next().unwrap());
    let mut line = format!("render {} --resolution 8x8 -o x.json", scene.display());
    let mut words = words.peekable();
    while let Some(word) = words.next() {
        match word {
            "--spp" | "--resolution" => drop(words.next()),
            _ => line += &format!(" {word}"),
        }
    }
    line += " --spp 1";
    let text = std::fs::read_to_string(scene).unwrap();
    let volumes = text.split("[[volume]]").skip(1).enumerate();
    for (number, _) in volumes.filter(|(_, volume)| volume.contains("procedural")) {
        line += &format!(" --set volume.{number}.procedural.resolution=16");
    }
    line
}

#[test]
fn every_scene_and_panel_renders_without_a_rejected_sample() {
    let lines: Vec<String> = chapter_folders()
        .iter()
        .flat_map(|folder| renders(folder).iter().map(|render| reduced(folder, render)).collect::<Vec<_>>())
        .collect();
    assert!(lines.len() > 20, "{lines:?}");
    let check = |lines: &[String]| {
        let folder = Folder::new();
        for line in lines {
            let run = folder.done(line);
            let json: serde_json::Value = serde_json::from_slice(&folder.read("x.json")).unwrap();
            assert_eq!(json["rejected"], 0, "{line}: {}", run.err);
            assert!(!run.err.contains("the scene has no light"), "{line}: {}", run.err);
        }
    };
    let (first, second) = lines.split_at(lines.len() / 2);
    std::thread::scope(|scope| {
        scope.spawn(|| check(first));
        check(second);
    });
}

#[test]
fn every_folder_is_a_chapter_with_a_text_and_a_picture_and_the_index_names_it() {
    let listed: BTreeSet<String> = CHAPTERS.iter().map(|chapter| chapter.folder.to_owned()).collect();
    assert_eq!(chapter_folders(), listed);
    let index = std::fs::read_to_string(gallery().join("README.md")).unwrap();
    for folder in &listed {
        let text = std::fs::read_to_string(gallery().join(folder).join("README.md")).unwrap();
        let picture = ["picture.png", "picture.svg"].into_iter().find(|name| gallery().join(folder).join(name).is_file());
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
