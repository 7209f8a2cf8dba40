//! Files that include each other in a circle.

use std::path::{Path, PathBuf};

/// The way from a file that is being read back to itself, if `path` is one of `open`, of which each includes the next:
/// `a.pbrt -> b.pbrt -> a.pbrt`. All paths are canonical.
pub(crate) fn include_chain(open: &[PathBuf], path: &Path) -> Option<String> {
    let first = open.iter().position(|file| file == path)?;
    let names = open[first..].iter().map(PathBuf::as_path).chain([path]);
    // The folder is told once; names alone are what is looked for.
    let names: Vec<String> = names
        .map(|file| file.file_name().unwrap_or(file.as_os_str()).to_string_lossy().into_owned())
        .collect();
    Some(names.join(" -> "))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_chain_begins_with_the_file_that_is_met_again() {
        let open = ["/s/main.pbrt", "/s/a.pbrt", "/s/b.pbrt"].map(PathBuf::from);
        assert_eq!(
            include_chain(&open, Path::new("/s/a.pbrt")).as_deref(),
            Some("a.pbrt -> b.pbrt -> a.pbrt")
        );
        assert_eq!(include_chain(&open, Path::new("/s/c.pbrt")), None);
    }
}
