//! `tyndall merge` and `tyndall diff` on pictures made here.

use std::ops::Range;
use std::path::Path;
use std::process::{Command, Output};

use tyndall_film::{Accumulation, Film, FilmTile, ImageMetadata, Layers, Sample};

fn tyndall(folder: &Path, arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_tyndall")).current_dir(folder).args(arguments).output().unwrap()
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}

/// Brightness `level` under uniform noise that depends on the seed and the sample.
fn write_render(folder: &Path, name: &str, samples: Range<u64>, seed: u64, level: f32) {
    let mut film = Film::new(48, 32, Layers::NONE).unwrap();
    film.open_range(samples.start).unwrap();
    for number in 0..film.tile_count() {
        let rect = film.tile_rect(number);
        let mut tile = FilmTile::new(rect, samples.clone(), film.layers());
        for index in samples.clone() {
            for y in rect.y..rect.y + rect.height {
                for x in rect.x..rect.x + rect.width {
                    let mut hash = seed << 48 ^ index << 24 ^ u64::from(y * 48 + x);
                    for _ in 0..3 {
                        hash = (hash ^ hash >> 31).wrapping_mul(0x9e37_79b9_7f4a_7c15);
                    }
                    let noise = (hash >> 40) as f32 / (1 << 24) as f32 - 0.5;
                    tile.add(x, y, &Sample { radiance: [level + noise; 3], ..Sample::default() });
                }
            }
        }
        film.merge_tile(&tile);
    }
    film.complete_through(samples.end).unwrap();
    let metadata = ImageMetadata { scene_hash: "s".into(), seed, ..ImageMetadata::default() };
    Accumulation { film, metadata }.write(&folder.join(name)).unwrap();
}

#[test]
fn parts_merged_in_any_order_are_the_same_file_as_the_whole() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    write_render(folder, "a.acc", 0..3, 1, 1.0);
    write_render(folder, "b.acc", 3..4, 1, 1.0);
    write_render(folder, "c.acc", 4..16, 1, 1.0);
    write_render(folder, "whole.acc", 0..16, 1, 1.0);
    for (order, name) in [(["a.acc", "b.acc", "c.acc"], "abc"), (["c.acc", "a.acc", "b.acc"], "cab")] {
        for extension in ["acc", "exr", "png"] {
            let output =
                tyndall(folder, &[&["merge"], &order[..], &["-o", &format!("{name}.{extension}")]].concat());
            assert!(output.status.success(), "{}", text(&output.stderr));
        }
    }
    for extension in ["acc", "exr", "png"] {
        tyndall(folder, &["merge", "whole.acc", "-o", &format!("one.{extension}")]);
        let read = |name: &str| std::fs::read(folder.join(format!("{name}.{extension}"))).unwrap();
        assert!(read("abc") == read("one") && read("cab") == read("one"), "{extension}");
    }
}

#[test]
fn what_cannot_be_merged_ends_with_code_1_and_names_both_files() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    write_render(folder, "a.acc", 0..3, 1, 1.0);
    write_render(folder, "b.acc", 2..4, 1, 1.0);
    let output = tyndall(folder, &["merge", "a.acc", "b.acc", "-o", "c.exr"]);
    assert_eq!(output.status.code(), Some(1));
    let message = text(&output.stderr);
    assert!(message.contains("a.acc") && message.contains("b.acc") && message.contains("2..3"), "{message}");
    assert!(!folder.join("c.exr").exists());
}

#[test]
fn noise_is_told_from_a_difference_of_one_percent() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    for (name, seed, level) in [("a", 1, 1.0), ("b", 2, 1.0), ("c", 3, 1.01)] {
        write_render(folder, "part.acc", 0..16, seed, level);
        let output = tyndall(folder, &["merge", "part.acc", "-o", &format!("{name}.exr")]);
        assert!(output.status.success(), "{}", text(&output.stderr));
    }
    let significant = |other: &str| {
        let output = tyndall(folder, &["diff", "a.exr", other, "--json"]);
        assert!(output.status.success(), "{}", text(&output.stderr));
        let json: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
        for key in ["mse", "relmse", "relmse_trimmed", "mean_a", "mean_b", "mean_difference", "z"] {
            assert!(json.get(key).is_some(), "{key}");
        }
        assert_eq!(json["standard_error_from"], "standard_error_layers");
        json["significant"].as_bool()
    };
    assert_eq!(significant("b.exr"), Some(false));
    assert_eq!(significant("c.exr"), Some(true));
    assert!(text(&tyndall(folder, &["diff", "a.exr", "c.exr"]).stdout).contains("by more than noise"));
}
