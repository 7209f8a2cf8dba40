//! What fuzzing begins with, as far as it is not text: small files of every kind that is read, by our own writers where
//! there are such. `cargo test -p tyndall-fuzz -- --ignored write_the_corpus` writes them anew.

mod meshes;
mod pictures;
mod sums;
mod volumes;

use std::fs;
use std::path::Path;

/// Puts a file into the corpus of a target.
fn put(target: &str, name: &str, bytes: &[u8]) {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("corpus").join(target);
    fs::create_dir_all(&folder).unwrap();
    fs::write(folder.join(name), bytes).unwrap();
}

#[test]
#[ignore = "writes files into the source"]
fn write_the_corpus() {
    volumes::write_all();
    meshes::write_all();
    pictures::write_all();
    sums::write_all();
}
