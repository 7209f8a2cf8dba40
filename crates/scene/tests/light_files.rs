//! Pictures of the surroundings from files, sound and damaged.

use std::fs;
use std::path::{Path, PathBuf};

use glam::DVec3;
use tyndall_scene::light::read_light_image;

fn write_exr(folder: &Path, channel_names: [&str; 3]) -> PathBuf {
    use exr::prelude::*;
    let path = folder.join("picture.exr");
    let values = |offset: f32| (0..8 * 4).map(|index| offset + index as f32).collect::<Vec<_>>();
    let channels =
        [0, 1, 2].map(|i| AnyChannel::new(channel_names[i], FlatSamples::F32(values(100.0 * i as f32))));
    let image = Image::from_channels((8, 4), AnyChannels::sort(channels.into_iter().collect()));
    image.write().to_file(&path).unwrap();
    path
}

fn write_hdr(folder: &Path) -> PathBuf {
    let path = folder.join("picture.hdr");
    let pixels: Vec<image::Rgb<f32>> =
        (0..8 * 4).map(|index| image::Rgb([1.0 + index as f32, 2.0, 0.5])).collect();
    let mut bytes = Vec::new();
    image::codecs::hdr::HdrEncoder::new(&mut bytes).encode(&pixels, 8, 4).unwrap();
    fs::write(&path, bytes).unwrap();
    path
}

#[test]
fn exr_pictures_are_read_top_row_first() {
    let folder = tempfile::tempdir().unwrap();
    let (image, warning) = read_light_image(&write_exr(folder.path(), ["R", "G", "B"])).unwrap();
    assert_eq!((image.width(), image.height(), warning), (8, 4, None));
    assert_eq!(image.texel(3, 1), DVec3::new(11.0, 111.0, 211.0));
}

#[test]
fn radiance_pictures_are_read_top_row_first() {
    let folder = tempfile::tempdir().unwrap();
    let (image, _) = read_light_image(&write_hdr(folder.path())).unwrap();
    assert_eq!((image.width(), image.height()), (8, 4));
    // The shared exponent keeps 8 bits of the brightest channel.
    assert!((image.texel(3, 1) - DVec3::new(12.0, 2.0, 0.5)).abs().max_element() < 12.0 / 128.0);
}

#[test]
fn values_that_are_no_radiance_are_mended_with_a_warning() {
    use exr::prelude::*;
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("odd.exr");
    let odd = [f32::NAN, -1.0, f32::INFINITY, 5.0];
    write_rgb_file(&path, 4, 1, |x, _| (odd[x], 1.0_f32, 1.0_f32)).unwrap();
    let (image, warning) = read_light_image(&path).unwrap();
    let reds: Vec<f64> = (0..4).map(|column| image.texel(column, 0).x).collect();
    assert_eq!(reds, [0.0, 0.0, 5.0, 5.0]);
    assert!(warning.unwrap().contains("odd.exr: 3 values are NaN, negative, infinite or beyond 4e9"));
}

#[test]
fn files_that_are_no_pictures_are_refused_in_one_line() {
    let folder = tempfile::tempdir().unwrap();
    let check = |path: &Path, expected: &str| {
        let message = read_light_image(path).unwrap_err().to_string();
        assert!(message.contains(expected) && !message.contains('\n'), "{message}");
        assert!(message.starts_with(&path.display().to_string()), "{message}");
    };
    check(&folder.path().join("absent.exr"), "no such file");
    let text = folder.path().join("text.exr");
    fs::write(&text, "hello").unwrap();
    check(&text, "is neither an OpenEXR (.exr) nor a Radiance (.hdr) picture");
    check(&write_exr(folder.path(), ["X", "Y", "Z"]), "has no channels `R`, `G`, `B`, but `X`, `Y`, `Z`");
    let huge = folder.path().join("huge.hdr");
    fs::write(&huge, "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 1000000 +X 1000000\n").unwrap();
    check(&huge, "more than 268 million are not read");
    let large = folder.path().join("large.hdr");
    fs::write(&large, "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 10000 +X 10000\n").unwrap();
    check(&large, "claims 10000 x 10000 texels");
}

#[test]
fn damaged_pictures_never_panic() {
    let folder = tempfile::tempdir().unwrap();
    let sound = [write_exr(folder.path(), ["R", "G", "B"]), write_hdr(folder.path())]
        .map(|path| fs::read(path).unwrap());
    let path = folder.path().join("damaged");
    let mut state = 1_u64;
    let mut random = |below: usize| {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 33) as usize % below
    };
    for round in 0..2_000 {
        let mut bytes = sound[round % 2].clone();
        for _ in 0..=random(3) {
            let at = random(bytes.len());
            bytes[at] = random(256) as u8;
        }
        if random(4) == 0 {
            bytes.truncate(random(bytes.len()));
        }
        fs::write(&path, &bytes).unwrap();
        if let Err(error) = read_light_image(&path) {
            assert!(!error.to_string().contains('\n'), "{error}");
        }
    }
}
