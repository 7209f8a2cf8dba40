//! Files appear whole or not at all.
//!
//! The bytes go to a temporary file beside the target, which then takes its name in one step; whoever reads the
//! name sees the old file or the new one, also if the program is killed in between.

use std::fs::File;
use std::io::{self, BufWriter, Write};
use std::path::Path;

use crate::error::FileError;

/// Writes a file through `fill`, replacing what was there.
pub fn write_atomically(
    path: &Path,
    fill: impl FnOnce(&mut BufWriter<&mut File>) -> io::Result<()>,
) -> Result<(), FileError> {
    let folder = match path.parent() {
        Some(parent) if !parent.as_os_str().is_empty() => parent,
        _ => Path::new("."),
    };
    write_beside(path, folder, fill).map_err(|source| match source.kind() {
        io::ErrorKind::NotFound => {
            FileError::unusable(path, format!("the folder {} does not exist; create it", folder.display()))
        }
        _ => FileError::io(path, source),
    })
}

fn write_beside(
    path: &Path,
    folder: &Path,
    fill: impl FnOnce(&mut BufWriter<&mut File>) -> io::Result<()>,
) -> io::Result<()> {
    let mut builder = tempfile::Builder::new();
    builder.prefix(".tyndall-").suffix(".part");
    // Temporary files are private by default; this one becomes a file like any other.
    #[cfg(unix)]
    builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666));
    let mut temporary = builder.tempfile_in(folder)?;
    let mut buffered = BufWriter::with_capacity(1 << 20, temporary.as_file_mut());
    fill(&mut buffered)?;
    buffered.flush()?;
    drop(buffered);
    temporary.as_file().sync_all()?;
    temporary.persist(path).map_err(|e| e.error)?;
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_failed_write_leaves_the_old_file_and_nothing_else() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("picture");
        write_atomically(&path, |w| w.write_all(b"old")).unwrap();
        let failure = write_atomically(&path, |w| {
            w.write_all(b"half")?;
            Err(io::Error::other("the disk is full"))
        });
        assert!(failure.unwrap_err().to_string().ends_with("the disk is full"));
        assert_eq!(std::fs::read(&path).unwrap(), b"old");
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1);
    }

    #[test]
    fn a_missing_folder_is_named() {
        let folder = tempfile::tempdir().unwrap();
        let error = write_atomically(&folder.path().join("no/such/a.exr"), |_| Ok(())).unwrap_err();
        assert!(error.to_string().contains("no/such does not exist"), "{error}");
    }
}
