//! Comparison against numbers worked out by hand, against statistics, and on damaged files.

use exr::prelude::Compression;
use proptest::prelude::*;

use super::*;

struct Noise(u64);

impl Noise {
    /// Nearly normal, mean 0, variance 1: twelve uniform numbers.
    fn next(&mut self) -> f32 {
        let mut uniform = || {
            self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (self.0 >> 40) as f32 / (1u64 << 24) as f32
        };
        (0..12).map(|_| uniform()).sum::<f32>() - 6.0
    }
}

/// Brightness 1, noise of `sigma` a pixel, and `shift` added to a block in the middle.
fn picture(seed: u64, sigma: f32, shift: f32, with_layer: bool) -> Picture {
    let (width, height) = (96, 64);
    let mut noise = Noise(seed);
    let inside = |i: usize| (32..48).contains(&(i % width)) && (32..48).contains(&(i / width));
    let rgb = (0..width * height)
        .map(|i| [0; 3].map(|_| 1.0 + sigma * noise.next() + if inside(i) { shift } else { 0.0 }))
        .collect();
    let standard_error = with_layer.then(|| vec![[sigma; 3]; width * height]);
    Picture { width, height, rgb, standard_error }
}

#[test]
fn the_measures_are_those_defined() {
    let a = Picture { width: 2, height: 1, rgb: vec![[1.0, 2.0, 3.0], [0.0; 3]], standard_error: None };
    let b = Picture { rgb: vec![[1.0, 1.0, 1.0], [0.0, 0.3, 0.0]], ..a.clone() };
    let c = compare(&a, &b).unwrap();
    assert!((c.mse - (1.0 + 4.0 + 0.09) / 6.0).abs() < 1e-7);
    let relative = [(1.0 + 4.0) / 1.01 / 3.0, 0.09 / 0.1 / 3.0];
    assert!((c.relmse - (relative[0] + relative[1]) / 2.0).abs() < 1e-7);
    assert!((c.relmse_trimmed - relative[1]).abs() < 1e-7, "the worst pixel is left out");
    assert_eq!(c.mean_a, [0.5, 1.0, 1.5]);
    assert_eq!(c.mean_difference[2], 1.0);
    assert_eq!(c.blocks.tests, 0);
}

#[test]
fn equal_pictures_do_not_differ() {
    let a = picture(1, 0.1, 0.0, false);
    let c = compare(&a, &a).unwrap();
    assert_eq!((c.mse, c.relmse, c.flip_like, c.z, c.significant), (0.0, 0.0, 0.0, [0.0; 3], false));
}

#[test]
fn noise_alone_is_significant_as_seldom_as_stated() {
    for with_layer in [true, false] {
        let (mut significant, mut beyond, mut expected) = (0, 0, 0.0);
        for seed in 0..200 {
            let (a, b) =
                (picture(2 * seed, 0.2, 0.0, with_layer), picture(2 * seed + 1, 0.2, 0.0, with_layer));
            let c = compare(&a, &b).unwrap();
            significant += u32::from(c.significant);
            beyond += c.blocks.beyond_3_sigma;
            expected += c.blocks.expected_beyond_3_sigma;
        }
        // Of 200 at 1 %: 2 expected; more than 8 has a probability of 2e-4.
        assert!(significant <= 8, "{significant}");
        assert!((beyond as f64 - expected).abs() < 4.0 * expected.sqrt(), "{beyond} {expected}");
    }
}

#[test]
fn a_block_that_is_off_by_half_its_noise_is_found() {
    for with_layer in [true, false] {
        let c = compare(&picture(1, 0.2, 0.1, with_layer), &picture(2, 0.2, 0.0, with_layer)).unwrap();
        assert!(c.significant && c.blocks.beyond_3_sigma >= 3, "{:?}", c.blocks);
    }
}

#[test]
fn a_layer_of_unknown_errors_is_not_used() {
    let mut a = picture(1, 0.2, 0.0, true);
    let b = picture(2, 0.2, 0.0, true);
    assert_eq!(compare(&a, &b).unwrap().standard_error_from, ErrorSource::StandardErrorLayers);
    a.standard_error.as_mut().unwrap()[5] = [f32::INFINITY; 3];
    assert_eq!(compare(&a, &b).unwrap().standard_error_from, ErrorSource::PixelDifferences);
}

#[test]
fn pictures_of_different_sizes_are_refused() {
    let a = picture(1, 0.2, 0.0, false);
    let b = Picture { width: 1, height: 1, rgb: vec![[0.0; 3]], standard_error: None };
    assert!(compare(&a, &b).unwrap_err().contains("96x64 and 1x1"));
}

#[test]
fn values_that_are_not_finite_are_counted_and_left_out() {
    let a = Picture { width: 2, height: 1, rgb: vec![[f32::NAN, 1.0, 1.0], [1.0; 3]], standard_error: None };
    let b = Picture { rgb: vec![[1.0; 3]; 2], ..a.clone() };
    let c = compare(&a, &b).unwrap();
    assert_eq!(c.non_finite_pixels, 1);
    assert!((c.mse - 1.0 / 6.0).abs() < 1e-12);
}

/// A small EXR file with channels of the given names and mixed types.
fn exr_file(names: &[&str], compression: Compression) -> Vec<u8> {
    use exr::meta::attribute::LineOrder;
    use exr::prelude::*;
    let channel = |(i, name): (usize, &&str)| {
        let values: Vec<f32> = (0..12 * 10).map(|p| (p + i) as f32 * 0.25).collect();
        let samples = match i % 3 {
            0 => FlatSamples::F32(values),
            1 => FlatSamples::F16(values.into_iter().map(f16::from_f32).collect()),
            _ => FlatSamples::U32(values.into_iter().map(|x| x as u32).collect()),
        };
        AnyChannel::new(*name, samples)
    };
    let list = names.iter().enumerate().map(channel).collect();
    let encoding = Encoding { compression, blocks: Blocks::ScanLines, line_order: LineOrder::Increasing };
    let layer = Layer::new((12, 10), LayerAttributes::default(), encoding, AnyChannels::sort(list));
    let mut bytes = std::io::Cursor::new(Vec::new());
    Image::from_layer(layer).write().to_buffered(&mut bytes).unwrap();
    bytes.into_inner()
}

fn read(bytes: &[u8]) -> Result<Picture, String> {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.exr");
    std::fs::write(&path, bytes).unwrap();
    Picture::read(&path).map_err(|e| e.to_string())
}

#[test]
fn the_colours_are_found_whatever_stands_before_them() {
    for prefix in ["", "ViewLayer.Combined.", "beauty."] {
        let names: Vec<String> = ["Albedo.R", "Albedo.G", "Albedo.B"]
            .map(String::from)
            .into_iter()
            .chain(["R", "G", "B"].map(|c| format!("{prefix}{c}")))
            .collect();
        let names: Vec<&str> = names.iter().map(String::as_str).collect();
        let picture = read(&exr_file(&names, Compression::ZIP16)).unwrap();
        assert_eq!((picture.width, picture.height), (12, 10));
        assert_eq!(picture.rgb[4], [1.75, 2.0, 2.0], "{prefix}");
    }
    assert_eq!(read(&exr_file(&["Y"], Compression::RLE)).unwrap().rgb[4], [1.0; 3]);
    assert!(
        read(&exr_file(&["Z"], Compression::Uncompressed))
            .unwrap_err()
            .ends_with("has no channels R, G, B; it has Z")
    );
}

#[test]
fn standard_errors_are_found_beside_the_colours() {
    let names = ["R", "G", "B", "StandardError.R", "StandardError.G", "StandardError.B"];
    let error = read(&exr_file(&names, Compression::ZIP16)).unwrap().standard_error.unwrap();
    assert_eq!(error[4], [1.75, 2.0, 2.0]);
}

#[test]
fn a_file_that_is_no_exr_or_does_not_exist_is_named() {
    assert!(read(b"P6 1 1 255").unwrap_err().contains("a.exr: cannot be read as OpenEXR"));
    let error = Picture::read("no/such.exr".as_ref()).unwrap_err().to_string();
    assert!(error.starts_with("no/such.exr: "), "{error}");
}

const KINDS: [Compression; 5] =
    [Compression::Uncompressed, Compression::RLE, Compression::ZIP16, Compression::PIZ, Compression::PXR24];

proptest! {
    #![proptest_config(ProptestConfig::with_cases(1000))]
    #[test]
    fn damaged_files_are_refused_or_read_but_never_end_the_program(
        places in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 1..4),
        cut in any::<prop::sample::Index>(), compression in 0usize..5,
    ) {
        let mut bytes = exr_file(&["R", "G", "B", "StandardError.R"], KINDS[compression]);
        for (place, value) in places {
            // Half of the damage goes to the header.
            let length = if value % 2 == 0 { 400 } else { bytes.len() };
            bytes[place.index(length)] = value;
        }
        if cut.index(4) == 0 {
            bytes.truncate(cut.index(bytes.len()));
        }
        let _ = read(&bytes);
    }
}
