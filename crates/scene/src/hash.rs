//! What a picture was made of, as a number: accumulations of different scenes must not be merged.

use std::fmt;
use std::io::Read;
use std::path::Path;

use sha2::{Digest, Sha256};

use crate::canonical_names::without_names;
use crate::description::{
    LightDescription, MaterialChoice, PhaseDescription, RenderDescription, SceneDescription,
};
use crate::error::SceneError;

/// The first 128 bits of a SHA-256 over everything that determines the expected picture.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct SceneHash(pub [u8; 16]);

impl fmt::Display for SceneHash {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0.iter().try_for_each(|byte| write!(f, "{byte:02x}"))
    }
}

/// Hash of a scene whose file names are relative to `folder`.
///
/// It covers the camera, the resolution, `max_depth`, what colours are computed with and written as, media, volumes,
/// shapes, materials, lights and the bytes of the files they name. It leaves out what does not change the expected picture: where the files
/// are, names, the unit (unless media are given in physical units), comments, samples per pixel, seed, integrator,
/// exposure, layers and meters.
pub fn scene_hash(description: &SceneDescription, folder: &Path) -> Result<SceneHash, SceneError> {
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
    let media =
        canonical.medium.iter_mut().chain(canonical.volumes.iter_mut().map(|volume| &mut volume.medium));
    for medium in media {
        let of_phase = medium.phase.as_mut().and_then(PhaseDescription::file_mut);
        let of_particles = medium.particles.as_mut().and_then(|particles| particles.material_file.as_mut());
        for file in of_phase.into_iter().chain(of_particles) {
            *file = content_hash(&folder.join(&file))?;
        }
    }
    for volume in &mut canonical.volumes {
        let of_fields = [
            volume.emission_grid.as_mut().map(|grid| &mut grid.file),
            volume.temperature.as_mut().map(|grid| &mut grid.file),
            volume.albedo_grid.as_mut().map(|grid| &mut grid.file),
        ];
        for file in of_fields.into_iter().flatten().chain([&mut volume.file]).flatten() {
            *file = content_hash(&folder.join(&file))?;
        }
    }
    for mesh in canonical.shapes.iter_mut().filter_map(|shape| shape.mesh.as_mut()) {
        if let Some(file) = &mut mesh.file {
            *file = content_hash(&folder.join(&file))?;
        }
    }
    let in_shapes = canonical.shapes.iter_mut().filter_map(|shape| shape.material.as_mut());
    let of_materials = canonical.materials.iter_mut().flat_map(|named| named.material.pictures_mut());
    for picture in of_materials.chain(in_shapes.flat_map(MaterialChoice::pictures_mut)) {
        *picture = content_hash(&folder.join(&picture))?;
    }
    for light in &mut canonical.lights {
        if let LightDescription::Image(image) = light {
            image.file = content_hash(&folder.join(&image.file))?;
        }
    }
    Ok(SceneHash(first_half(Sha256::digest(canonical.to_toml().as_bytes()).into())))
}

fn content_hash(path: &Path) -> Result<String, SceneError> {
    let refuse = |error: std::io::Error| SceneError::file(path, error.to_string());
    let mut file = std::fs::File::open(path).map_err(refuse)?;
    let mut hasher = Sha256::new();
    let mut block = vec![0; 1 << 20];
    loop {
        match file.read(&mut block).map_err(refuse)? {
            0 => return Ok(SceneHash(first_half(hasher.finalize().into())).to_string()),
            length => hasher.update(&block[..length]),
        }
    }
}

fn first_half(digest: [u8; 32]) -> [u8; 16] {
    std::array::from_fn(|index| digest[index])
}
