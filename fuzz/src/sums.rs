//! Sums of samples, and the summaries that are written beside pictures.

use std::path::Path;

use tyndall_film::{Accumulation, Provenance};

use crate::Outcome;
use crate::folder::Folder;

/// `.acc` files, as they are and with the right checksum, so that damage reaches what lies behind it.
pub(crate) fn acc(bytes: &[u8]) -> Outcome {
    if let Err(error) = Accumulation::from_bytes(bytes, Path::new("a.acc")) {
        Outcome::refused(&error);
    }
    let mended = with_checksum(bytes);
    if let Err(error) = Provenance::of_accumulation(&Folder::with("a.acc", &mended).path("a.acc")) {
        Outcome::refused(&error);
    }
    match Accumulation::from_bytes(&mended, Path::new("a.acc")) {
        Ok(accumulation) => {
            // What was read can be written, and reads the same again.
            let written = accumulation.to_bytes().expect("there is memory for it");
            let again = Accumulation::from_bytes(&written, Path::new("a.acc")).expect("it was just written");
            assert!(again.film == accumulation.film && again.metadata.seed == accumulation.metadata.seed);
            Outcome::Read(accumulation.film.bytes())
        }
        Err(error) => Outcome::refused(&error),
    }
}

fn with_checksum(bytes: &[u8]) -> Vec<u8> {
    let mut mended = bytes.to_vec();
    if let Some((content, checksum)) = mended.split_last_chunk_mut::<4>() {
        let mut crc = flate2::Crc::new();
        crc.update(content);
        *checksum = crc.sum().to_le_bytes();
    }
    mended
}

/// Summaries in JSON.
pub(crate) fn summary(bytes: &[u8]) -> Outcome {
    match Provenance::of_summary(&Folder::with("a.json", bytes).path("a.json")) {
        Ok(_) => Outcome::Read(0),
        Err(error) => Outcome::refused(&error),
    }
}
