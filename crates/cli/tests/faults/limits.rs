//! Limits on memory are held before it is taken, and told with their sum.

use crate::command::{BALL, Folder};
use crate::{refused, shell};

/// A folder with a volume of 256³ voxels, 64 MiB as floats.
fn folder() -> Folder {
    let folder = Folder::new();
    folder.write("ball.toml", BALL);
    folder.write("v_256x256x256_uint8.raw", vec![0; 1 << 24]);
    folder
}

#[test]
fn whatever_would_pass_the_limit_is_refused_with_the_sum() {
    let folder = folder();
    let volume = "v_256x256x256_uint8.raw";
    folder.done("render ball.toml --resolution 512x512 --spp 1 -o large.acc -o large.exr");
    let grid = BALL.replace("sphere = { center = [0, 0, 0], radius = 1 }", &format!("file = '{volume}'"));
    folder.write("grid.toml", grid);
    for (line, file, what) in [
        (format!("render {volume}"), volume, "256 x 256 x 256 voxels of 4 bytes: they take 67 MB"),
        (format!("inspect {volume}"), volume, "256 x 256 x 256 voxels of 4 bytes"),
        (format!("convert {volume} a.vdb"), volume, "256 x 256 x 256 voxels of 4 bytes"),
        ("inspect grid.toml".into(), volume, "256 x 256 x 256 voxels of 4 bytes"),
        ("render ball.toml --resolution 1000x1000".into(), "", "1000x1000 pixels of"),
        ("merge large.acc -o a.exr".into(), "large.acc", "the sums of 512x512 pixels"),
        ("diff large.exr large.exr".into(), "large.exr", "bytes of pixels"),
    ] {
        let error = refused(&folder, &format!("exec tyndall --max-memory 60MB {line}"));
        assert!(error.contains(file) && error.contains(what), "{line}: {error}");
        assert!(error.contains("the limit is 60 MB (--max-memory)"), "{line}: {error}");
    }
    let error = refused(&folder, "TYNDALL_MAX_MEMORY=60MB exec tyndall inspect grid.toml");
    assert!(error.contains("the limit is 60 MB (TYNDALL_MAX_MEMORY)"), "{error}");
    // The option is heard after the command as well, and goes before the variable.
    let enough = "TYNDALL_MAX_MEMORY=60MB exec tyndall inspect grid.toml --max-memory 1GB";
    assert_eq!(shell(&folder, enough).code, Some(0));
    assert_eq!(folder.run("render ball.toml --max-memory 12parsecs").code, Some(2));
    let error = refused(&folder, "TYNDALL_MAX_MEMORY=much exec tyndall inspect grid.toml");
    assert!(error.contains("TYNDALL_MAX_MEMORY=much: write a size with its unit"), "{error}");
}

/// What may be said where there is too little memory.
fn is_refusal(err: &str) -> bool {
    err.lines().any(|line| line.starts_with("error: ") && line.contains("memory"))
}

#[test]
#[cfg(target_os = "linux")]
fn under_a_limit_on_address_space_all_works_or_says_why_not() {
    let folder = Folder::new();
    folder
        .write("v_96x96x96_uint8.raw", (0..96 * 96 * 96).map(|i: u32| (i % 251) as u8).collect::<Vec<u8>>());
    let volume = "v_96x96x96_uint8.raw";
    let render = format!("render {volume} --resolution 64x48 --spp 1 -o a.exr");
    let built_in =
        "render --set volume.0.procedural.resolution=64 --resolution 320x180 --spp 1 -o a.exr -o a.png";
    let (inspect, convert) = (format!("inspect {volume}"), format!("convert {volume} a.nvdb"));
    let mut codes = Vec::new();
    for megabytes in [40, 60, 80, 100, 130, 2000] {
        for line in [&render, built_in, &inspect, &convert] {
            let run = shell(&folder, &format!("ulimit -v {}; exec tyndall {line}", megabytes * 1000));
            let is_told = run.code == Some(0) || run.code == Some(1) && is_refusal(&run.err);
            assert!(is_told, "{megabytes} MB, {line}: {:?} {}", run.code, run.err);
            codes.push((megabytes, run.code));
        }
    }
    assert!(codes[..4].iter().all(|&(_, code)| code == Some(1)), "{codes:?}");
    assert!(codes[codes.len() - 4..].iter().all(|&(_, code)| code == Some(0)), "{codes:?}");
}
