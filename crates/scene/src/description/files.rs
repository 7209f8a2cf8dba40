//! The files that a scene names: volumes, meshes, pictures, tables.

use super::{
    LightDescription, MaterialChoice, MaterialDescription, MediumDescription, PhaseDescription,
    SceneDescription, TextureDescription,
};

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
        for named in &mut self.materials {
            of_material(&mut named.material, &mut files);
        }
        for shape in &mut self.shapes {
            files.extend(shape.mesh.as_mut().and_then(|mesh| mesh.file.as_mut()));
            if let Some(MaterialChoice::Here(material)) = &mut shape.material {
                of_material(material, &mut files);
            }
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

fn of_material<'a>(material: &'a mut MaterialDescription, files: &mut Vec<&'a mut String>) {
    let textures: [Option<&mut TextureDescription>; 2] = match material {
        MaterialDescription::Diffuse { reflectance }
        | MaterialDescription::RoughDiffuse { reflectance, .. } => [Some(reflectance), None],
        MaterialDescription::Conductor { tint, .. } => [tint.as_mut(), None],
        MaterialDescription::Dielectric { reflection_tint, transmission_tint, .. }
        | MaterialDescription::ThinDielectric { reflection_tint, transmission_tint, .. } => {
            [reflection_tint.as_mut(), transmission_tint.as_mut()]
        }
        MaterialDescription::Plastic { reflectance, reflection_tint, .. } => {
            [Some(reflectance), reflection_tint.as_mut()]
        }
        MaterialDescription::Mix { materials, amount } => {
            for choice in materials {
                if let MaterialChoice::Here(part) = choice {
                    of_material(part, files);
                }
            }
            [Some(amount), None]
        }
        MaterialDescription::Null => [None, None],
    };
    for texture in textures.into_iter().flatten() {
        if let TextureDescription::Image(image) = texture {
            files.push(&mut image.image);
        }
    }
}
