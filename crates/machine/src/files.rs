//! Files that have an end: a name in a scene may stand for a pipe that nobody writes to, or for a device without end.
//!
//! Only regular files are opened. Symbolic links are followed, as everywhere.

use std::fs::File;
use std::io::{self, ErrorKind, Read};
use std::path::Path;

use crate::memory;

/// Opens a regular file to read it. A pipe is not even opened, which would wait for somebody to write to it.
///
/// # Errors
/// If there is none, or it is something else; the text says what to do.
pub fn open(path: &Path) -> io::Result<File> {
    check_regular(&std::fs::metadata(path)?)?;
    let file = File::open(path)?;
    // Another thing may have taken the name in between.
    check_regular(&file.metadata()?)?;
    Ok(file)
}

fn check_regular(metadata: &std::fs::Metadata) -> io::Result<()> {
    if metadata.is_dir() {
        return Err(io::Error::new(ErrorKind::IsADirectory, "is a folder; give a file in it"));
    }
    if !metadata.is_file() {
        let what = "is a pipe or a device; put its content into a file and name that";
        return Err(io::Error::new(ErrorKind::Unsupported, what));
    }
    Ok(())
}

/// Reads a regular file as a whole, if there is memory for it.
///
/// # Errors
/// If it cannot be opened as by [`open`] or read, or is too large.
pub fn read(path: &Path) -> io::Result<Vec<u8>> {
    let file = open(path)?;
    let length = file.metadata()?.len();
    memory::ask(length, || format!("the {length} bytes of the file"))?;
    let mut bytes = Vec::with_capacity(usize::try_from(length).unwrap_or(0));
    // A file that grows meanwhile is cut where it ended.
    file.take(length).read_to_end(&mut bytes)?;
    Ok(bytes)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_is_read_as_a_whole() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a");
        std::fs::write(&path, b"content").unwrap();
        assert_eq!(read(&path).unwrap(), b"content");
        assert_eq!(read(&folder.path().join("b")).unwrap_err().kind(), ErrorKind::NotFound);
    }

    #[test]
    fn folders_are_refused() {
        let folder = tempfile::tempdir().unwrap();
        assert!(read(folder.path()).unwrap_err().to_string().contains("is a folder"));
    }

    #[test]
    #[cfg(unix)]
    fn devices_are_refused_through_links_too() {
        let folder = tempfile::tempdir().unwrap();
        let link = folder.path().join("link");
        std::os::unix::fs::symlink("/dev/zero", &link).unwrap();
        for path in [&link, Path::new("/dev/zero")] {
            assert!(read(path).unwrap_err().to_string().contains("a pipe or a device"));
        }
    }
}
