//! The benchmark scenes say in pbrt's words what the benchmark's table says.

use std::path::{Path, PathBuf};

use tyndall_import::{Imported, Sidecar, import_pbrt};

/// A benchmark scene, unless the benchmark is not beside the checkout.
fn import(name: &str, sidecar: &Path) -> Option<Imported> {
    let path = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../../../shared/bench/pbrt").join(name);
    if !path.exists() {
        println!("skipped: {} is not there", path.display());
        return None;
    }
    Some(import_pbrt(&path, &Sidecar::new(sidecar)).expect("the scene is sound"))
}

#[test]
fn look() {
    let folder = tempfile::tempdir().unwrap();
    for name in ["A", "B", "C", "D_small", "E", "F_R", "F_T", "G"] {
        if let Some(imported) = import(&format!("{name}.pbrt"), folder.path()) {
            println!("== {name}\n{}", imported.description.to_toml());
            for note in &imported.notes {
                println!("# {note}");
            }
        }
    }
}
