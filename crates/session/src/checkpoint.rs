//! Checkpoints: the exact sums of a render under way, from which another one goes on to the same bits.
//!
//! One process writes to a checkpoint at a time. It holds a lock on a file beside it, in which its number stands; the lock
//! is the system's and ends with the process, however that ends, also over NFS.

use std::fs::{File, OpenOptions, TryLockError};
use std::io::{ErrorKind, Read, Seek, Write};
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use tyndall_film::{Accumulation, FileError};
use tyndall_machine::remove_leftovers;

use crate::SessionError;

/// A file that takes the sums every now and then.
#[derive(Debug)]
pub struct Checkpoint {
    path: PathBuf,
    every: Duration,
    last: Instant,
    /// Held until the end; where there are no locks, nothing.
    _lock: Option<Lock>,
}

impl Checkpoint {
    /// A checkpoint to be written `every` so often, counted from now. What killed runs have left of writing it is cleared
    /// away.
    ///
    /// # Errors
    /// If another process uses it.
    pub fn open(path: impl Into<PathBuf>, every: Duration) -> Result<Self, SessionError> {
        let path = path.into();
        let lock = Lock::take(&path)?;
        remove_leftovers(&path);
        Ok(Self { path, every, last: Instant::now(), _lock: lock })
    }

    /// Where it is.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// How often it is to be written.
    pub fn every(&self) -> Duration {
        self.every
    }

    /// Writes the picture, replacing what was there in one step.
    ///
    /// # Errors
    /// If the file cannot be written; what was there stays.
    pub fn save(&mut self, picture: &Accumulation) -> Result<(), FileError> {
        self.last = Instant::now();
        picture.write(&self.path)
    }

    /// The same, if it is time for that; `None` if it is not.
    pub fn save_if_due(&mut self, picture: &Accumulation) -> Option<Result<(), FileError>> {
        (self.last.elapsed() >= self.every).then(|| self.save(picture))
    }
}

/// A lock on a file, which is removed in the end.
#[derive(Debug)]
struct Lock {
    path: PathBuf,
    _file: File,
}

impl Lock {
    /// The lock for a checkpoint; none where files cannot be locked.
    fn take(checkpoint: &Path) -> Result<Option<Self>, SessionError> {
        let name = checkpoint.file_name().unwrap_or_default().to_string_lossy();
        let path = checkpoint.with_file_name(format!(".tyndall-{name}.lock"));
        let own = std::process::id().to_string();
        // Whoever held it may remove the file between our opening and our locking it: then we hold a lock on nothing.
        for _ in 0..ATTEMPTS {
            let options = OpenOptions::new().read(true).write(true).create(true).truncate(false).open(&path);
            let mut file = options
                .map_err(|error| SessionError::refuse_file(&path, format!("cannot be made: {error}")))?;
            match file.try_lock() {
                Ok(()) => {}
                Err(TryLockError::WouldBlock) => return Err(in_use(checkpoint, &file)),
                Err(TryLockError::Error(_)) => {
                    let _ = std::fs::remove_file(&path);
                    return Ok(None);
                }
            }
            // The number is for people only, but shows as well whether this is the file that others find.
            let _ =
                file.set_len(0).and_then(|()| file.rewind()).and_then(|()| file.write_all(own.as_bytes()));
            let is_found = match std::fs::read_to_string(&path) {
                Ok(number) => number == own,
                // Some systems let nobody read what is locked.
                Err(error) => error.kind() != ErrorKind::NotFound,
            };
            if is_found {
                return Ok(Some(Self { path, _file: file }));
            }
        }
        Ok(None)
    }
}

/// Times that a lock is tried for.
const ATTEMPTS: u32 = 5;

impl Drop for Lock {
    fn drop(&mut self) {
        // Left behind, it is in nobody's way: without its lock it means nothing.
        let _ = std::fs::remove_file(&self.path);
    }
}

fn in_use(checkpoint: &Path, file: &File) -> SessionError {
    let mut number = String::new();
    let _ = Read::take(file, 20).read_to_string(&mut number);
    let process = if number.is_empty() { "another process".into() } else { format!("process {number}") };
    SessionError::refuse_file(
        checkpoint,
        format!("{process} renders to this checkpoint; wait until it is done, or name another --checkpoint"),
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_checkpoint_has_one_user_at_a_time() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.acc");
        let open = || Checkpoint::open(&path, Duration::ZERO);
        let first = open().unwrap();
        let refusal = open().unwrap_err().to_string();
        assert!(refusal.contains(&format!("process {} renders to this", std::process::id())), "{refusal}");
        assert!(Checkpoint::open(folder.path().join("b.acc"), Duration::ZERO).is_ok());
        drop(first);
        open().unwrap();
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 0);
    }
}
