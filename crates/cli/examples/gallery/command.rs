//! The command `tyndall`, built by the same cargo and with the same profile as this program.

use std::error::Error;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

/// The command, ready to run.
pub struct Tyndall(PathBuf);

impl Tyndall {
    /// Builds the command if it is not up to date.
    pub fn build() -> Result<Tyndall, Box<dyn Error>> {
        let cargo = std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into());
        let profile = if cfg!(debug_assertions) { "dev" } else { "release" };
        // Together with this program, so that the libraries below both are built once.
        let status = Command::new(cargo)
            .args(["build", "--quiet", "--bin", "tyndall", "--example", "gallery", "--profile", profile])
            .current_dir(env!("CARGO_MANIFEST_DIR"))
            .status()?;
        if !status.success() {
            return Err("the command `tyndall` could not be built".into());
        }
        // This program is target/PROFILE/examples/gallery.
        let here = std::env::current_exe()?;
        let folder = here.ancestors().nth(2).ok_or("this program is in no folder of cargo's")?;
        Ok(Tyndall(folder.join(format!("tyndall{}", std::env::consts::EXE_SUFFIX))))
    }

    /// Runs `tyndall` with these words, none of which holds a blank, in `folder`.
    pub fn run(&self, folder: &Path, line: &str) -> Result<(), Box<dyn Error>> {
        let output = Command::new(&self.0)
            .args(line.split_whitespace())
            .current_dir(folder)
            .stdin(Stdio::null())
            .output()
            .map_err(|error| format!("{}: {error}", self.0.display()))?;
        if output.status.success() {
            return Ok(());
        }
        let said = String::from_utf8_lossy(&output.stderr);
        Err(format!("{}: tyndall {line}\n{}", folder.display(), said.trim_end()).into())
    }
}
