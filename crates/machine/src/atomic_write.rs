//! Files appear whole or not at all.
//!
//! The bytes go to a temporary file beside the target, which then takes its name in one step; whoever reads the
//! name sees the old file or the new one, also if the program is killed in between. What a killed program leaves behind is
//! named after its target, and known by its lock: that of a living writer is held, that of a dead one is free.

use std::fs::File;
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};

/// A file that is being written, under another name than it will have.
pub type Unfinished<'a> = BufWriter<&'a mut File>;

/// Writes a file through `fill`, replacing what was there.
///
/// # Errors
/// What `fill` returns, or why the file cannot be made, written or named; what was there is then as before.
pub fn write_atomically<E: From<io::Error>>(
    path: &Path,
    fill: impl FnOnce(&mut Unfinished<'_>) -> Result<(), E>,
) -> Result<(), E> {
    let folder = folder_of(path);
    let told = |error: io::Error| match error.kind() {
        io::ErrorKind::NotFound => {
            let what = format!("the folder {} does not exist; create it", folder.display());
            io::Error::new(io::ErrorKind::NotFound, what)
        }
        _ => error,
    };
    let mut temporary = temporary_file(path, folder).map_err(told)?;
    let mut buffered = BufWriter::with_capacity(1 << 20, temporary.as_file_mut());
    fill(&mut buffered)?;
    buffered.flush()?;
    drop(buffered);
    temporary.as_file().sync_all()?;
    temporary.persist(path).map_err(|error| told(error.error))?;
    Ok(())
}

/// Removes what killed programs have left of writing to `path`. What another one is writing at this time stays; so does
/// what cannot be removed, as it is in nobody's way.
pub fn remove_leftovers(path: &Path) {
    let folder = folder_of(path);
    for name in leftovers(folder, path) {
        let part = folder.join(name);
        if File::open(&part).is_ok_and(|file| file.try_lock().is_ok()) {
            let _ = std::fs::remove_file(part);
        }
    }
}

/// Names of the temporary files in `folder` for the target `path`.
fn leftovers(folder: &Path, path: &Path) -> Vec<PathBuf> {
    let prefix = temporary_prefix(path);
    let entries = std::fs::read_dir(folder).into_iter().flatten().flatten();
    let names = entries.map(|entry| entry.file_name());
    let is_part = |name: &str| {
        let random = name.strip_prefix(&prefix).and_then(|rest| rest.strip_suffix(SUFFIX));
        random.is_some_and(|random| random.len() == RANDOM && random.chars().all(char::is_alphanumeric))
    };
    names.filter(|name| name.to_str().is_some_and(is_part)).map(PathBuf::from).collect()
}

fn folder_of(path: &Path) -> &Path {
    path.parent().filter(|parent| !parent.as_os_str().is_empty()).unwrap_or(Path::new("."))
}

/// How temporary files end.
const SUFFIX: &str = ".part";
/// Random letters of their names.
const RANDOM: usize = 6;
/// Longer names of targets are cut, as names of files may not be longer than 255 bytes.
const LONGEST_NAME: usize = 200;

/// How the names of temporary files for a target begin.
fn temporary_prefix(path: &Path) -> String {
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    let end = (0..=LONGEST_NAME.min(name.len())).rev().find(|&end| name.is_char_boundary(end)).unwrap_or(0);
    format!(".tyndall-{}-", &name[..end])
}

/// An empty file for the target `path`, which is removed unless it is given that name.
fn temporary_file(path: &Path, folder: &Path) -> io::Result<tempfile::NamedTempFile> {
    let mut builder = tempfile::Builder::new();
    let prefix = temporary_prefix(path);
    builder.prefix(&prefix).suffix(SUFFIX).rand_bytes(RANDOM);
    // Temporary files are private by default; this one becomes a file like any other.
    #[cfg(unix)]
    builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666));
    let temporary = builder.tempfile_in(folder)?;
    // Where there are no locks, leftovers are not told from what is being written, and stay. Nobody else has this file, so
    // that there is nothing to wait for.
    let _ = temporary.as_file().try_lock();
    Ok(temporary)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_failed_write_leaves_the_old_file_and_nothing_else() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("picture");
        write_atomically(&path, |file| file.write_all(b"old")).unwrap();
        let failure = write_atomically(&path, |file| {
            file.write_all(b"half")?;
            Err(io::Error::other("the disk is full"))
        });
        assert!(failure.unwrap_err().to_string().ends_with("the disk is full"));
        assert_eq!(std::fs::read(&path).unwrap(), b"old");
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1);
    }

    #[test]
    fn what_a_killed_writer_leaves_is_removed_and_what_a_living_one_writes_is_not() {
        let folder = tempfile::tempdir().unwrap();
        let [path, other] = ["a.acc", "a.acc-b.acc"].map(|name| folder.path().join(name));
        for name in
            [".tyndall-a.acc-x1Y2z3.part", ".tyndall-a.acc-b.acc-x1Y2z3.part", ".tyndall-a.acc-1.part"]
        {
            std::fs::write(folder.path().join(name), b"half").unwrap();
        }
        write_atomically(&path, |file| {
            remove_leftovers(&path);
            file.write_all(b"whole")
        })
        .unwrap();
        assert_eq!(std::fs::read(&path).unwrap(), b"whole");
        assert!(leftovers(folder.path(), &path).is_empty());
        assert_eq!(leftovers(folder.path(), &other).len(), 1);
        assert!(folder.path().join(".tyndall-a.acc-1.part").exists());
    }

    #[test]
    fn long_names_are_cut_between_letters() {
        let prefix = temporary_prefix(Path::new(&"ä".repeat(120)));
        assert_eq!(prefix, format!(".tyndall-{}-", "ä".repeat(100)));
    }

    #[test]
    fn a_missing_folder_is_named() {
        let folder = tempfile::tempdir().unwrap();
        let error =
            write_atomically(&folder.path().join("no/such/a.exr"), |_| io::Result::Ok(())).unwrap_err();
        assert!(error.to_string().contains("no/such does not exist"), "{error}");
    }
}
