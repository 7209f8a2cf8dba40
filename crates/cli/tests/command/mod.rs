//! A small language for tests of the command: a folder with a scene in it, and runs of `tyndall` there.

// Each test binary uses its own part of it.
#![allow(dead_code)]

use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};

use tyndall_film::Accumulation;

/// A ball of fog, which is quick to build and to render.
pub const BALL: &str = r#"
camera = { position = [0, 0, 4], target = [0, 0, 0] }
film = { resolution = [16, 12] }
volume = [{ sphere = { center = [0, 0, 0], radius = 1 }, mu_t = 4, albedo = 0.9 }]
light = [{ type = "constant", radiance = 1 }]
"#;

/// A small cloud in even light: a hundredth of a second for some samples.
pub const SCENE: &str = r#"
[camera]
position = [0, 0, 4]
target = [0, 0, 0]
[film]
resolution = [32, 24]
[render]
spp = 4
[[volume]]
procedural = { type = "cumulus", resolution = 16, size = 2 }
mu_t = 20
albedo = 0.9
[[light]]
type = "constant"
radiance = 1
"#;

/// A folder of its own, with `scene.toml` in it.
pub struct Folder(tempfile::TempDir);

/// What a run of the command came to.
pub struct Run {
    pub code: Option<i32>,
    pub out: String,
    pub err: String,
}

impl Folder {
    pub fn new() -> Self {
        let folder = Self(tempfile::tempdir().unwrap());
        folder.write("scene.toml", SCENE);
        folder
    }

    pub fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    pub fn write(&self, name: &str, content: impl AsRef<[u8]>) {
        std::fs::write(self.path(name), content).unwrap();
    }

    pub fn read(&self, name: &str) -> Vec<u8> {
        std::fs::read(self.path(name)).unwrap_or_else(|error| panic!("{name}: {error}"))
    }

    pub fn names(&self) -> Vec<String> {
        let entries = std::fs::read_dir(self.0.path()).unwrap();
        let mut names: Vec<_> =
            entries.map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
        names.sort();
        names
    }

    pub fn command(&self, line: &str) -> Command {
        let mut command = Command::new(env!("CARGO_BIN_EXE_tyndall"));
        command.current_dir(self.0.path()).args(line.split_whitespace()).stdin(Stdio::null());
        // A cache of its own, which leaves the user's alone.
        command.env("TYNDALL_CACHE", self.path("cache"));
        command
    }

    /// Runs `tyndall` with these words; none of them holds a blank.
    pub fn run(&self, line: &str) -> Run {
        let run = Run::from(self.command(line).output().unwrap());
        assert!(!run.err.contains("panicked"), "{line}: {}", run.err);
        run
    }

    /// Runs and expects success.
    pub fn done(&self, line: &str) -> Run {
        let run = self.run(line);
        assert_eq!(run.code, Some(0), "{line}: {}", run.err);
        run
    }

    pub fn accumulation(&self, name: &str) -> Accumulation {
        Accumulation::read(&self.path(name)).unwrap()
    }
}

impl From<Output> for Run {
    fn from(output: Output) -> Self {
        let text = |bytes| String::from_utf8(bytes).unwrap();
        Self { code: output.status.code(), out: text(output.stdout), err: text(output.stderr) }
    }
}

impl Run {
    /// The first line of standard error if it is an error, without `error: `.
    pub fn error(&self) -> &str {
        let line = self.err.lines().next().unwrap_or_default();
        line.strip_prefix("error: ").unwrap_or_else(|| panic!("no error: {}", self.err))
    }
}

/// The real volume files, where they are there.
pub fn shared_volumes() -> Option<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/volumes");
    let there = folder.is_dir();
    if !there {
        eprintln!("skipped: {} is not there", folder.display());
    }
    there.then_some(folder)
}
