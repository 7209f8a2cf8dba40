//! The file that is written: it grows, its offsets are filled in afterwards, and its content is hashed on the way.

use std::io::{self, Seek, SeekFrom, Write};

use tyndall_machine::Unfinished;

/// Why writing stopped, before the path and grid are known.
pub(super) enum Failure {
    /// The operating system refused.
    Io(io::Error),
    /// The format has no place for it.
    Unwritable(String),
}

impl From<io::Error> for Failure {
    fn from(error: io::Error) -> Self {
        Self::Io(error)
    }
}

/// The file as it grows.
pub(super) struct Sink<'a, 'f> {
    file: &'a mut Unfinished<'f>,
    /// Bytes written so far.
    pub(super) position: u64,
    hash: Hash,
}

impl<'a, 'f> Sink<'a, 'f> {
    /// Begins an empty file.
    pub(super) fn new(file: &'a mut Unfinished<'f>) -> Self {
        Self { file, position: 0, hash: Hash::new() }
    }

    /// Appends bytes.
    pub(super) fn put(&mut self, bytes: &[u8]) -> Result<(), Failure> {
        self.file.write_all(bytes)?;
        self.position += bytes.len() as u64;
        self.hash.add(bytes);
        Ok(())
    }

    /// Replaces bytes written before.
    pub(super) fn patch(&mut self, position: u64, bytes: &[u8]) -> Result<(), Failure> {
        self.file.seek(SeekFrom::Start(position))?;
        self.file.write_all(bytes)?;
        self.file.seek(SeekFrom::Start(self.position))?;
        Ok(())
    }

    /// A UUID made of everything put so far.
    pub(super) fn uuid(&self) -> String {
        self.hash.uuid()
    }
}

/// FNV-1a (Fowler, Noll, Vo), 128 bits.
struct Hash(u128);

impl Hash {
    fn new() -> Self {
        Self(0x6c62_272e_07bb_0142_62b8_2175_6295_c58d)
    }

    fn add(&mut self, bytes: &[u8]) {
        for &byte in bytes {
            self.0 = (self.0 ^ u128::from(byte)).wrapping_mul(0x0100_0000_0000_0000_0000_013b);
        }
    }

    fn uuid(&self) -> String {
        let hex = format!("{:032x}", self.0);
        [&hex[..8], &hex[8..12], &hex[12..16], &hex[16..20], &hex[20..]].join("-")
    }
}
