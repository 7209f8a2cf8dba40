//! OpenVDB itself reads what is written here as it reads the original. Runs where Python finds OpenVDB and NumPy.

use std::path::Path;
use std::process::Command;
use tyndall_volumes::GridSelection;
use tyndall_volumes::vdb::{self, Codec, WriteOptions};

/// One of each kind: several grids, names given twice, vectors, tiles, level sets, halves, maps, odd values, no grid.
const FILES: [&str; 14] = [
    "mantaflow_0001.vdb",
    "sn_box.vdb",
    "dragon_with_xform.vdb",
    "oiio_sphereCd_a.vdb",
    "arnold_grids.vdb",
    "variants/dup_names.vdb",
    "variants/multi.vdb",
    "variants/levelset.vdb",
    "variants/tiles_mixed.vdb",
    "variants/bool.vdb",
    "variants/nan_inf_neg.vdb",
    "variants/xform_affine.vdb",
    "variants/xform_nonuniform.vdb",
    "variants/half_zip_active.vdb",
];

fn python_with_openvdb() -> Option<&'static str> {
    ["/usr/bin/python3", "python3"].into_iter().find(|python| {
        ["import openvdb", "import pyopenvdb"].iter().any(|import| {
            Command::new(python).args(["-c", import]).output().is_ok_and(|run| run.status.success())
        })
    })
}

#[test]
fn openvdb_reads_what_is_written_as_it_reads_the_original() {
    let manifest = Path::new(env!("CARGO_MANIFEST_DIR"));
    let volumes = manifest.join("../../../shared/volumes");
    let Some(python) = python_with_openvdb() else {
        return eprintln!("skipped: Python has no OpenVDB or no NumPy");
    };
    if !volumes.is_dir() {
        return eprintln!("skipped: {} is not there", volumes.display());
    }
    let folder = tempfile::tempdir().unwrap();
    let written = folder.path().join("written.vdb");
    for (number, file) in FILES.into_iter().enumerate() {
        let original = volumes.join(file);
        let grids = vdb::read(&original, &GridSelection::All).unwrap().grids;
        let half = grids.iter().any(|grid| grid.saved_as_half);
        let codec = [Codec::Blosc, Codec::Zip, Codec::None][number % 3];
        vdb::write(&written, &grids, &WriteOptions { codec, half }).unwrap();
        let script = manifest.join("tests/openvdb_roundtrip.py");
        let run = Command::new(python).arg(script).args([&original, &written]).output().unwrap();
        let said = String::from_utf8_lossy(&run.stderr);
        assert!(run.status.success(), "{file} {codec:?}: {said}");
    }
}
