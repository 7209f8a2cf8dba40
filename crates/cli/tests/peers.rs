//! Scenes written for pbrt-v4 and Mitsuba 3 against pictures of them by these renderers.
//!
//! The mean of every block of 16x16 pixels agrees (`TYNDALL_PROOF=full`; otherwise of 64x64, at few samples, of which small
//! blocks would have too few for the normal distribution): within 1 %, or within what noise explains (z-tests of the
//! differences of the pixels, which have both errors in them, at a level of 1e-3 for all blocks of all pictures). Where the two models of
//! colour differ, in the coloured walls and the coloured milk that pbrt turns from RGB into spectra, Mitsuba's picture is
//! the reference for both dialects; the mean of that of the fog is 0.45 % too bright by all other evidence, for which 0.7 %
//! are allowed in its blocks.

mod command;

use std::path::{Path, PathBuf};

use command::Folder;
use tyndall_film::comparison::Picture;

/// Two-sided 1e-3 over 7 pictures of 768 blocks and channels each, by Bonferroni.
const GREATEST_Z: f64 = 5.2;

fn bench() -> Option<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/bench");
    if !folder.is_dir() {
        println!("skipped: {} is not there", folder.display());
    }
    folder.canonicalize().ok()
}

/// Renders a scene and holds it against a reference; `allowed` is a relative difference that is no error.
fn agrees(scene: &str, reference: &str, allowed: f64) {
    let Some(bench) = bench() else { return };
    let is_full = std::env::var("TYNDALL_PROOF").is_ok_and(|effort| effort == "full");
    let (spp, edge) = if is_full { (256, 16) } else { (4, 64) };
    let folder = Folder::new();
    let scene_file = bench.join(scene);
    folder.done(&format!("render {} --spp {spp} --progress none -o picture.exr", scene_file.display()));
    let picture = Picture::read(&folder.path("picture.exr")).unwrap();
    let reference = Picture::read(&bench.join("references").join(reference)).unwrap();
    assert_eq!((picture.width, picture.height), (reference.width, reference.height));
    let mean = reference.rgb.iter().flatten().map(|value| f64::from(*value)).sum::<f64>()
        / (3 * reference.rgb.len()) as f64;
    let mut noise = 0.0;
    let mut tests = 0.0;
    for block_y in 0..picture.height / edge {
        for block_x in 0..picture.width / edge {
            for channel in 0..3 {
                let row = |i| (block_y * edge + i / edge) * picture.width;
                let pixels = (0..edge * edge).map(|i| row(i) + block_x * edge + i % edge);
                let pairs: Vec<[f64; 2]> = pixels
                    .map(|i| [picture.rgb[i][channel], reference.rgb[i][channel]].map(f64::from))
                    .collect();
                let count = pairs.len() as f64;
                let difference = pairs.iter().map(|[a, b]| a - b).sum::<f64>() / count;
                let variance = pairs.iter().map(|[a, b]| (a - b - difference).powi(2)).sum::<f64>();
                let error = (variance / (count * (count - 1.0))).sqrt();
                let expected = pairs.iter().map(|[_, b]| b).sum::<f64>() / count;
                // Where there is next to nothing, a part of the whole picture's brightness counts.
                let tolerance = allowed * expected.max(0.1 * mean);
                let z = (difference.abs() - tolerance).max(0.0) / error.max(1e-12);
                assert!(
                    difference.abs() <= tolerance || z < GREATEST_Z,
                    "{scene}, block {block_x},{block_y}, channel {channel}: {expected} + {difference} ± {error}"
                );
                noise += error / expected.max(0.1 * mean);
                tests += 1.0;
            }
        }
    }
    println!("{scene}: {tests} blocks, mean error {:.2} %", 100.0 * noise / tests);
}

#[test]
fn pbrt_scenes_agree_with_the_references() {
    agrees("pbrt/A.pbrt", "A.exr", 0.01);
    agrees("pbrt/B.pbrt", "B.exr", 0.01);
    agrees("pbrt/C.pbrt", "C.exr", 0.017);
    agrees("pbrt/E.pbrt", "E.exr", 0.01);
    agrees("pbrt/G.pbrt", "G.exr", 0.01);
}

#[test]
fn mitsuba_scenes_agree_with_the_references() {
    agrees("mitsuba/C_fogbox.xml", "C.exr", 0.017);
    agrees("mitsuba/E_milk.xml", "E.exr", 0.01);
}
