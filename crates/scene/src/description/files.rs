//! The files that a scene names: volumes, meshes, pictures, tables.

use super::{LightDescription, MaterialChoice, MediumDescription, PhaseDescription, SceneDescription};

impl SceneDescription {
    /// The names of all files that the scene is made of, to be read or changed. A name may come several times.
    pub fn files_mut(&mut self) -> Vec<&mut String> {
        let mut files = Vec::new();
        if let Some(medium) = &mut self.medium {
            of_medium(medium, &mut files);
        }
        for volume in &mut self.volumes {
            of_medium(&mut volume.medium, &mut files);
            files.extend(volume.file.as_mut());
            files.extend(volume.emission_grid.as_mut().and_then(|grid| grid.file.as_mut()));
            files.extend(volume.temperature.as_mut().and_then(|grid| grid.file.as_mut()));
            files.extend(volume.albedo_grid.as_mut().and_then(|grid| grid.file.as_mut()));
        }
        files.extend(self.materials.iter_mut().flat_map(|named| named.material.pictures_mut()));
        for shape in &mut self.shapes {
            files.extend(shape.mesh.as_mut().and_then(|mesh| mesh.file.as_mut()));
            files.extend(shape.material.iter_mut().flat_map(MaterialChoice::pictures_mut));
        }
        for light in &mut self.lights {
            if let LightDescription::Image(image) = light {
                files.push(&mut image.file);
            }
        }
        files
    }
}

fn of_medium<'a>(medium: &'a mut MediumDescription, files: &mut Vec<&'a mut String>) {
    files.extend(medium.phase.as_mut().and_then(PhaseDescription::file_mut));
    files.extend(medium.particles.as_mut().and_then(|particles| particles.material_file.as_mut()));
}
