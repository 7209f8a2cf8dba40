//! Reading forward through bytes that may lie: every length is checked against what is left before it is used.
//!
//! All numbers of an OpenVDB file are little endian; strings are a u32 length and so many bytes.

use tyndall_machine::memory::MemoryError;

/// What is wrong with a file, before its path and grid are known.
#[derive(Debug, Clone)]
pub(super) enum Problem {
    /// The bytes contradict the format.
    Damaged(String),
    /// The bytes are sound, but not read here.
    Unsupported(String),
    /// There is no memory for what they hold.
    Memory(MemoryError),
}

impl Problem {
    /// The same problem, with the place put before it.
    pub(super) fn at(self, place: &str) -> Self {
        match self {
            Self::Damaged(what) => Self::Damaged(format!("{place}: {what}")),
            Self::Unsupported(what) => Self::Unsupported(format!("{place}: {what}")),
            Self::Memory(error) => Self::Memory(error),
        }
    }
}

impl From<MemoryError> for Problem {
    fn from(error: MemoryError) -> Self {
        Self::Memory(error)
    }
}

/// Shorthand for a contradiction.
pub(super) fn damaged(what: impl Into<String>) -> Problem {
    Problem::Damaged(what.into())
}

/// A place in the bytes of a file.
#[derive(Debug, Clone)]
pub(super) struct Cursor<'a> {
    bytes: &'a [u8],
    position: usize,
}

impl<'a> Cursor<'a> {
    /// Stands at `position`, which may be past the end, of the file's `bytes`.
    pub(super) fn new(bytes: &'a [u8], position: usize) -> Self {
        Self { bytes, position }
    }

    /// Offset from the first byte of the file.
    pub(super) fn position(&self) -> usize {
        self.position
    }

    /// Bytes from here to the end.
    pub(super) fn left(&self) -> usize {
        self.bytes.len().saturating_sub(self.position)
    }

    /// The next `count` bytes; `what` names them in the error.
    pub(super) fn take(&mut self, count: usize, what: &str) -> Result<&'a [u8], Problem> {
        let taken = self.bytes.get(self.position..).and_then(|rest| rest.get(..count));
        let taken = taken.ok_or_else(|| {
            damaged(format!(
                "truncated: {what} at byte {} takes {count} bytes, but only {} are left",
                self.position,
                self.left()
            ))
        })?;
        self.position += count;
        Ok(taken)
    }

    fn array<const N: usize>(&mut self, what: &str) -> Result<[u8; N], Problem> {
        let mut array = [0; N];
        array.copy_from_slice(self.take(N, what)?);
        Ok(array)
    }

    pub(super) fn u8(&mut self, what: &str) -> Result<u8, Problem> {
        Ok(self.array::<1>(what)?[0])
    }

    pub(super) fn u32(&mut self, what: &str) -> Result<u32, Problem> {
        Ok(u32::from_le_bytes(self.array(what)?))
    }

    pub(super) fn i32(&mut self, what: &str) -> Result<i32, Problem> {
        Ok(i32::from_le_bytes(self.array(what)?))
    }

    pub(super) fn i64(&mut self, what: &str) -> Result<i64, Problem> {
        Ok(i64::from_le_bytes(self.array(what)?))
    }

    pub(super) fn f64(&mut self, what: &str) -> Result<f64, Problem> {
        Ok(f64::from_le_bytes(self.array(what)?))
    }

    /// Index coordinates: three i32.
    pub(super) fn coordinates(&mut self, what: &str) -> Result<[i32; 3], Problem> {
        Ok([self.i32(what)?, self.i32(what)?, self.i32(what)?])
    }

    /// A u32 length and so many bytes; what is not UTF-8 is replaced.
    pub(super) fn string(&mut self, what: &str) -> Result<String, Problem> {
        let len = self.u32(what)? as usize;
        Ok(String::from_utf8_lossy(self.take(len, what)?).into_owned())
    }
}

/// One line of at most 80 characters of a text that the file provides, to be quoted in messages.
pub(super) fn quotable(text: &str) -> String {
    let mut line: String = text.chars().take(80).collect::<String>().escape_debug().to_string();
    if text.chars().nth(80).is_some() {
        line.push('…');
    }
    line
}
