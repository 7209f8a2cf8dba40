//! What a reading may take.
//!
//! | | limit |
//! |---|---|
//! | memory | 64 MiB + 4 × honest content |
//! | time | 1 s for each MiB of the file, and 2 s for the sanitizers; in fuzzing only |
//!
//! The honest content of a file are its bytes, or what has come out of it if it was read and that is more: a compressed
//! file may well hold a thousand times its size. A file that is refused has only its bytes. So a size that a header
//! declares is not believed before it is checked against the bytes that are there, and where compressed bytes could hold
//! it, memory grows with what they turn out to hold. Two kinds of pictures are decoded as a whole by the libraries that read
//! them: a byte of an `.hdr` may stand for 16 texels, one of a JPEG for 256, and that counts as their content.

/// Memory that a file may take however little it holds, bytes.
const ALLOWANCE: usize = 64 << 20;
/// Memory over honest content.
const FACTOR: usize = 4;

/// Most bytes of memory that a file with so much honest content may take.
pub fn memory(content: usize) -> usize {
    ALLOWANCE.saturating_add(content.saturating_mul(FACTOR))
}

/// Longest time that reading so many bytes may take, with sanitizers on.
pub fn seconds(bytes: usize) -> f64 {
    2.0 + bytes as f64 / f64::from(1 << 20)
}
