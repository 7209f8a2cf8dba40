//! The files that the base scenes name, a few numbers each.

use std::fs;
use std::path::Path;

/// Writes all of them into `folder`.
pub fn write_files(folder: &Path) {
    let write = |name: &str, bytes: &[u8]| fs::write(folder.join(name), bytes).expect("a folder for files");
    write("density.npy", &npy([3, 4, 2], 1, |i| (i % 5) as f32 * 0.25));
    write("kelvin.npy", &npy([3, 4, 2], 1, |i| 1000.0 + 50.0 * i as f32));
    write("paint.npy", &npy([3, 4, 2], 3, |i| (i % 7) as f32 / 7.0));
    write("bytes.raw", &[10; 24]);
    write("picture.hdr", &hdr(4, 2));
    write("square.hdr", &hdr(4, 4));
    write("phase.csv", b"angle_deg,450,550,650\n0,3,2,1\n90,1,1,1\n180,2,1,1\n");
    write("index.csv", b"wavelength_nm,n,k\n300,1.5,0.01\n900,1.4,0.02\n");
    write(
        "square.obj",
        b"v -1 0 -1\nv 1 0 -1\nv 1 0 1\nv -1 0 1\nvn 0 1 0\nf 1//1 2//1 3//1\nf 1//1 3//1 4//1\n",
    );
}

/// A NumPy array of single floats, of numbers or vectors.
pub fn npy(shape: [usize; 3], components: usize, mut value: impl FnMut(usize) -> f32) -> Vec<u8> {
    let [x, y, z] = shape;
    let last = if components == 1 { String::new() } else { format!(", {components}") };
    let header = format!("{{'descr': '<f4', 'fortran_order': False, 'shape': ({x}, {y}, {z}{last}), }}\n");
    let mut bytes = b"\x93NUMPY\x01\x00".to_vec();
    bytes.extend((header.len() as u16).to_le_bytes());
    bytes.extend(header.bytes());
    bytes.extend((0..x * y * z * components).flat_map(|i| value(i).to_le_bytes()));
    bytes
}

/// A picture in the Radiance format, without compression.
fn hdr(columns: usize, rows: usize) -> Vec<u8> {
    let mut bytes = format!("#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y {rows} +X {columns}\n").into_bytes();
    bytes.extend((0..columns * rows).flat_map(|i| [40 + 10 * i as u8, 100, 90, 128]));
    bytes
}
