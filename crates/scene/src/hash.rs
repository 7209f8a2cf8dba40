//! What a picture was made of, as a number: accumulations of different scenes must not be merged.

use std::collections::HashMap;
use std::fmt;
use std::io::Read;
use std::path::{Path, PathBuf};

use sha2::{Digest, Sha256};
use tyndall_machine::files;

use crate::canonical_names::without_names;
use crate::description::{RenderDescription, SceneDescription};
use crate::error::SceneError;
use crate::scene_files::SceneFiles;

/// The first 128 bits of a SHA-256 over everything that determines the expected picture.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct SceneHash(pub [u8; 16]);

impl SceneHash {
    /// The first half of what a hasher has come to.
    pub(crate) fn of(hasher: Sha256) -> Self {
        let digest: [u8; 32] = hasher.finalize().into();
        Self(std::array::from_fn(|index| digest[index]))
    }
}

impl fmt::Display for SceneHash {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0.iter().try_for_each(|byte| write!(f, "{byte:02x}"))
    }
}

/// Hash of a scene whose file names are relative to `folder`.
///
/// It covers the camera, the resolution, `max_depth`, what colours are computed with and written as, media, volumes,
/// shapes, materials, lights and the bytes of the files they name. It leaves out what does not change the expected
/// picture: where the files are, names, the unit (unless media are given in physical units), comments, samples per pixel,
/// seed, integrator, exposure, layers and meters.
pub fn scene_hash(description: &SceneDescription, folder: &Path) -> Result<SceneHash, SceneError> {
    scene_hash_with(description, &SceneFiles::in_folder(folder))
}

/// The same of a scene whose files may be grids in memory, which count by their content as well.
pub fn scene_hash_with(description: &SceneDescription, files: &SceneFiles) -> Result<SceneHash, SceneError> {
    let mut canonical = description.clone();
    // Only what is given in physical units depends on it.
    if !canonical.media().any(|medium| medium.preset.is_some() || medium.particles.is_some()) {
        canonical.unit.clear();
    }
    canonical.film.exposure = 0.0;
    canonical.film.layers = None;
    canonical.meters.clear();
    without_names(&mut canonical);
    let RenderDescription { max_depth, mode, .. } = description.render;
    canonical.render = RenderDescription { max_depth, mode, ..RenderDescription::default() };
    let mut known: HashMap<PathBuf, String> = HashMap::new();
    for file in canonical.files_mut() {
        if let Some(grid) = files.grids.get(file.as_str()) {
            *file = grid.hash().to_string();
            continue;
        }
        let path = files.folder.join(&file);
        *file = match known.get(&path) {
            Some(hash) => hash.clone(),
            None => {
                let hash = content_hash(&path)?.to_string();
                known.insert(path, hash.clone());
                hash
            }
        };
    }
    Ok(SceneHash::of(Sha256::new().chain_update(canonical.to_toml())))
}

/// Hash of a file's bytes.
///
/// # Errors
/// If it cannot be read.
pub fn content_hash(path: &Path) -> Result<SceneHash, SceneError> {
    let refuse = |error: std::io::Error| SceneError::file(path, error.to_string());
    let mut file = files::open(path).map_err(refuse)?;
    let mut hasher = Sha256::new();
    let mut block = vec![0; 1 << 20];
    loop {
        match file.read(&mut block).map_err(refuse)? {
            0 => return Ok(SceneHash::of(hasher)),
            length => hasher.update(&block[..length]),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::SceneDocument;

    const SCENE: &str = r#"
        camera = { position = [0, 0, 5], target = [0, 0, 0] }
        [[volume]]
        name = "milk"
        sphere = { center = [0, 0, 0], radius = 1 }
        mu_t = 1
        albedo = 1
        [[volume]]
        name = "water"
        sphere = { center = [0, 0, 0], radius = 1 }
        mu_t = 2
        albedo = 0
        [[shape]]
        name = "glass"
        mesh = { file = "a.ply" }
        interior = "milk"
        [shape.material]
        type = "mix"
        amount = 0.5
        materials = [
            { type = "diffuse", reflectance = { image = "a.png" } },
            { type = "plastic", reflection_tint = { image = "b.png" } },
        ]
    "#;

    #[test]
    fn files_of_shapes_count_by_their_content_and_volumes_by_the_shapes_around_them() {
        let folder = tempfile::tempdir().unwrap();
        for (name, content) in
            [("a.ply", "1"), ("same.ply", "1"), ("other.ply", "2"), ("a.png", "3"), ("b.png", "4")]
        {
            std::fs::write(folder.path().join(name), content).unwrap();
        }
        let hash = |from: &str, to: &str| {
            let description = SceneDocument::parse("test", &SCENE.replace(from, to)).unwrap().description();
            scene_hash(&description.unwrap(), folder.path()).unwrap()
        };
        let plain = hash("", "");
        assert_eq!(hash("a.ply", "same.ply"), plain);
        assert_eq!(hash("glass", "goblet"), plain);
        for (from, to) in
            [("a.ply", "other.ply"), ("a.png", "b.png"), ("b.png", "a.png"), ("interior = \"milk\"", "")]
        {
            assert_ne!(hash(from, to), plain, "{from} {to}");
        }
        assert_ne!(hash("interior = \"milk\"", "interior = \"water\""), plain);
    }
}
