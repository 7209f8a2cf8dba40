//! An `.acc` file gives back the same bits, or one clear line.

use std::ops::Range;

use proptest::prelude::*;

use super::*;
use crate::colours::Colours;
use crate::film::FilmTile;
use crate::sample::Sample;

fn metadata() -> ImageMetadata {
    ImageMetadata {
        scene_hash: "0123".into(),
        version: "0.1.0".into(),
        options: "integrator=fast".into(),
        seed: 7,
        colours: Colours::Xyz,
        crop: None,
        seconds: 2.0,
    }
}

fn rendered(samples: Range<u64>, tiles: Range<usize>) -> Film {
    let mut film = Film::new(40, 17, Layers { effort: true, ..Layers::ALL }).unwrap();
    film.open_range(samples.start).unwrap();
    for number in tiles {
        let rect = film.tile_rect(number);
        let mut tile = FilmTile::new(rect, samples.clone(), film.layers());
        for index in samples.clone() {
            for y in rect.y..rect.y + rect.height {
                for x in rect.x..rect.x + rect.width {
                    let u = (x * 31 + y * 17 + index as u32 * 7) as f32 % 10.1;
                    let is_spoilt = (u64::from(x) + index).is_multiple_of(13);
                    let radiance = [u, u * 1e-7, if is_spoilt { f32::NAN } else { u * 1e6 }];
                    let single = radiance.map(|r| r * 0.5);
                    let (normal, object, catcher) = ([u * 0.1, -0.1 * u, 0.5], u as u32 % 5, [u * 0.3, u]);
                    let hit = (index + u64::from(x)).is_multiple_of(2);
                    let met = Sample {
                        hit,
                        effort: object,
                        depth: u,
                        normal,
                        object,
                        catcher,
                        ..Sample::default()
                    };
                    tile.add(x, y, &Sample { radiance, single, ..met });
                }
            }
        }
        film.merge_tile(&tile);
    }
    film
}

fn complete(samples: Range<u64>) -> Accumulation {
    let mut film = rendered(samples.clone(), 0..6);
    film.complete_through(samples.end).unwrap();
    Accumulation { film, metadata: metadata() }
}

fn bytes_of(accumulation: &Accumulation) -> Vec<u8> {
    let mut bytes = Vec::new();
    accumulation.encode(&mut bytes).unwrap();
    bytes
}

/// Sets the checksum right, so that damage reaches what lies behind it.
fn with_right_checksum(mut bytes: Vec<u8>) -> Vec<u8> {
    let end = bytes.len() - 4;
    let mut crc = flate2::Crc::new();
    crc.update(&bytes[..end]);
    bytes[end..].copy_from_slice(&crc.sum().to_le_bytes());
    bytes
}

#[test]
fn halves_merged_from_files_are_the_whole_bit_for_bit_in_either_order() {
    let folder = tempfile::tempdir().unwrap();
    let [a, b, c] = ["a.acc", "b.acc", "c.acc"].map(|name| folder.path().join(name));
    complete(0..64).write(&a).unwrap();
    complete(64..128).write(&b).unwrap();
    let whole = complete(0..128);
    for (first, second) in [(&a, &b), (&b, &a)] {
        let mut merged = Accumulation::read(first).unwrap();
        merged.merge(first, &Accumulation::read(second).unwrap(), second).unwrap();
        merged.write(&c).unwrap();
        let merged = Accumulation::read(&c).unwrap();
        assert_eq!(merged.film, whole.film);
        assert_eq!(merged.metadata.seconds, 4.0);
    }
}

#[test]
fn an_interrupted_film_comes_back_with_the_progress_of_each_tile() {
    let film = rendered(5..8, 2..4);
    let read =
        Accumulation::decode(&bytes_of(&Accumulation { film: film.clone(), metadata: metadata() })).unwrap();
    assert_eq!(read.film, film);
    assert_eq!((read.film.next_round(0), read.film.next_round(3)), (Some(5), Some(8)));
}

#[test]
fn each_reason_not_to_merge_is_one_line_that_names_both_files() {
    let refusal = |change: &dyn Fn(&mut Accumulation)| {
        let mut other = complete(2..4);
        change(&mut other);
        let mut whole = complete(0..2);
        let error = whole.merge("a.acc".as_ref(), &other, "b.acc".as_ref()).unwrap_err().to_string();
        assert_eq!(whole, complete(0..2), "a refused merge changes nothing");
        assert!(error.contains("b.acc") && !error.contains('\n'), "{error}");
        error
    };
    let scene = refusal(&|other| other.metadata.scene_hash = "4567".into());
    assert!(scene.contains("a.acc") && scene.contains("another scene (`4567`, not `0123`)"), "{scene}");
    assert!(refusal(&|other| other.metadata.seed = 8).contains("another seed"));
    assert!(refusal(&|other| other.metadata.options.clear()).contains("another options"));
    assert!(refusal(&|other| other.metadata.version.push('1')).contains("another version"));
    assert!(refusal(&|other| *other = complete(1..3)).contains("both hold samples 1..2"));
    assert!(refusal(&|other| other.film = rendered(2..4, 0..3)).contains("was interrupted"));
    let size = refusal(&|other| other.film = Film::new(8, 8, Layers::ALL).unwrap());
    assert!(size.contains("one is 40x17 pixels, the other 8x8"), "{size}");
}

#[test]
fn every_truncation_is_refused_in_one_line() {
    let bytes = bytes_of(&complete(0..2));
    for length in (0..bytes.len()).step_by(97).chain([0, 1, 8, 12, 16, bytes.len() - 1]) {
        let error = Accumulation::decode(&bytes[..length]).unwrap_err();
        assert!(!error.contains('\n'));
        if length >= 16 {
            let error = Accumulation::decode(&with_right_checksum(bytes[..length].to_vec())).unwrap_err();
            assert!(!error.contains('\n'), "{error}");
        }
    }
}

/// Changes text in the header.
fn with_header(mut bytes: Vec<u8>, from: &str, to: &str) -> Vec<u8> {
    let at = bytes.windows(from.len()).position(|w| w == from.as_bytes()).unwrap();
    bytes.splice(at..at + from.len(), to.bytes());
    let length = u32::from_le_bytes(bytes[12..16].try_into().unwrap());
    bytes[12..16].copy_from_slice(&(length + to.len() as u32 - from.len() as u32).to_le_bytes());
    with_right_checksum(bytes)
}

#[test]
fn files_of_other_versions_are_refused_with_their_version() {
    let mut bytes = bytes_of(&complete(0..1));
    for version in [0, 1, 2, 4] {
        bytes[8] = version;
        let error = Accumulation::decode(&with_right_checksum(bytes.clone())).unwrap_err();
        assert!(error.contains(&format!("version {version} of")) && !error.contains('\n'), "{error}");
    }
}

#[test]
fn pixels_keep_their_own_numbers_of_samples() {
    let adaptive = |step: u16| {
        let rates = Rates::from_steps((0..40 * 17).map(|i| if i % 40 < 20 { 4096 } else { step }).collect());
        let mut film = Film::new(40, 17, Layers::NONE).unwrap();
        film.set_rates(rates.unwrap());
        film.open_range(0).unwrap();
        for number in 0..film.tile_count() {
            film.merge_tile(&film.open_tile(number, 10).unwrap());
        }
        film.complete_through(10).unwrap();
        Accumulation { film, metadata: metadata() }
    };
    let (saved, other) = (adaptive(8192), adaptive(2048));
    let mut read = Accumulation::decode(&bytes_of(&saved)).unwrap();
    assert!(read == saved && read != other);
    assert_eq!([0, 39].map(|x| read.film.sample_count(x, 16)), [10, 18]);
    assert_eq!([0, 39].map(|x| other.film.sample_count(x, 16)), [10, 6]);
    let error = read.merge(Path::new("a.acc"), &other, Path::new("b.acc")).unwrap_err().to_string();
    assert!(error.contains("both hold"), "{error}");
    let mut later = other.clone();
    later.film.complete = "10..20".parse().unwrap();
    let error = read.merge(Path::new("a.acc"), &later, Path::new("b.acc")).unwrap_err().to_string();
    assert!(error.contains("adaptive sampling"), "{error}");
    let wrong =
        Accumulation { film: Film { rates: Some(Rates::unchecked(vec![0; 680])), ..saved.film }, ..saved };
    assert!(Accumulation::decode(&bytes_of(&wrong)).unwrap_err().contains("no rate"));
}

#[test]
fn planes_that_are_damaged_are_named() {
    let good = bytes_of(&complete(0..1));
    for (from, to, words) in [
        (r#""object","catcher""#, r#""catcher","object""#, "bad plane"),
        (r#""normal","object""#, r#""normal","normal""#, "Normal: it occurs twice"),
        (r#""catcher","effort""#, r#""catcher""#, "bytes too many"),
        (r#""catcher","effort""#, r#""catcher","efforts""#, "bad header"),
    ] {
        let error = Accumulation::decode(&with_header(good.clone(), from, to)).unwrap_err();
        assert!(error.contains(words) && !error.contains('\n'), "{error}");
    }
}

#[test]
fn a_header_that_promises_a_vast_film_costs_nothing() {
    let bytes = with_header(bytes_of(&complete(0..1)), r#""width":40"#, r#""width":4000000"#);
    let error = Accumulation::decode(&bytes).unwrap_err();
    // A machine that could not hold it says that first.
    assert!(error.contains("bad plane Pixels") || error.contains("not enough memory"), "{error}");
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(2000))]
    #[test]
    fn damage_never_panics_and_without_a_right_checksum_is_always_found(
        places in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 1..4),
    ) {
        let good = bytes_of(&complete(0..1));
        let mut bytes = good.clone();
        for (place, value) in places {
            // Half of the damage goes where the structure is.
            let length = if value % 2 == 0 { 600 } else { bytes.len() };
            let at = place.index(length);
            bytes[at] = value;
        }
        if bytes != good {
            prop_assert!(Accumulation::decode(&bytes).is_err());
        }
        if let Ok(accumulation) = Accumulation::decode(&with_right_checksum(bytes)) {
            // What is accepted can be used.
            accumulation.film.median_relative_error();
            let _ = accumulation.film.clone().merge(&complete(1..2).film);
        }
    }
}
