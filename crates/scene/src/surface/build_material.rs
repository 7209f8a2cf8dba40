//! Descriptions of materials to materials ready to evaluate.

use std::collections::HashMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use tyndall_optics::bsdf::{Coat, Ggx};
use tyndall_optics::{dielectric_index, metal};

use super::material::{ConductorIndex, Material};
use super::picture::Picture;
use super::texture::{Colour, ImageLookup, Placement, Texture};
use crate::description::{
    CheckerTexture, ImageTexture, IndexChoice, KeyProblem, MaterialChoice, MaterialDescription,
    NamedMaterial, Roughness, SpectrumDescription, TextureDescription, material_of_name, no_metal,
    no_substance,
};
use crate::error::SceneError;

/// Builds the materials of a scene, and reads each of their pictures once.
#[derive(Debug)]
pub struct MaterialBuilder<'a> {
    named: &'a [NamedMaterial],
    folder: &'a Path,
    pictures: HashMap<(PathBuf, Option<bool>), Arc<Picture>>,
    /// Names that lead to the material at hand.
    chain: Vec<String>,
    /// How many parts the material has so far.
    parts: usize,
    /// What the user should know of it.
    notes: Vec<String>,
}

/// More parts are no material but a mistake, or a trap.
pub(crate) const MOST_PARTS: usize = 256;

impl Material {
    /// The material of a description. Names stand for those of `named`, file names are relative to `folder`; messages
    /// call it `place`, and `notes` takes what the user should know of it, one line each.
    pub fn build(
        description: &MaterialDescription,
        named: &[NamedMaterial],
        folder: &Path,
        place: &str,
        notes: &mut Vec<String>,
    ) -> Result<Material, SceneError> {
        MaterialBuilder::new(named, folder).build(description, place, notes)
    }
}

impl<'a> MaterialBuilder<'a> {
    /// Names stand for those of `named`, file names are relative to `folder`.
    pub fn new(named: &'a [NamedMaterial], folder: &'a Path) -> Self {
        Self { named, folder, pictures: HashMap::new(), chain: Vec::new(), parts: 0, notes: Vec::new() }
    }

    /// The material of a description, which messages call `place`; `notes` takes what the user should know of it.
    pub fn build(
        &mut self,
        description: &MaterialDescription,
        place: &str,
        notes: &mut Vec<String>,
    ) -> Result<Material, SceneError> {
        self.parts = 0;
        self.chain.clear();
        let material = self.material(description, place);
        notes.append(&mut self.notes);
        material
    }

    /// The material of a name or a description.
    pub fn build_choice(
        &mut self,
        choice: &MaterialChoice,
        place: &str,
        notes: &mut Vec<String>,
    ) -> Result<Material, SceneError> {
        self.parts = 0;
        self.chain.clear();
        let material = self.choice(choice, place);
        notes.append(&mut self.notes);
        material
    }

    fn choice(&mut self, choice: &MaterialChoice, place: &str) -> Result<Material, SceneError> {
        match choice {
            MaterialChoice::Here(description) => self.material(description, place),
            MaterialChoice::Name(name) => {
                let named = material_of_name(name, self.named).map_err(|message| refuse(place, message))?;
                if self.chain.contains(name) {
                    let circle = format!("{} -> {name}", self.chain.join(" -> "));
                    return Err(refuse(place, format!("a material is part of itself: {circle}")));
                }
                self.chain.push(name.clone());
                let material = self.material(&named.material, place)?;
                self.chain.pop();
                Ok(material)
            }
        }
    }

    fn material(&mut self, description: &MaterialDescription, place: &str) -> Result<Material, SceneError> {
        self.parts += 1;
        if self.parts > MOST_PARTS {
            return Err(refuse(
                place,
                format!("the material is mixed of more than {MOST_PARTS} parts: mix fewer"),
            ));
        }
        let facets =
            |roughness: &Option<Roughness>| roughness.and_then(|roughness| Ggx::new(roughness.alphas()));
        Ok(match description {
            MaterialDescription::Null => Material::Null,
            MaterialDescription::Diffuse { reflectance } => {
                Material::Diffuse { reflectance: self.texture(reflectance, place)? }
            }
            MaterialDescription::RoughDiffuse { reflectance, sigma } => {
                Material::RoughDiffuse { reflectance: self.texture(reflectance, place)?, sigma: *sigma }
            }
            MaterialDescription::Conductor { metal, eta, k, reflectance, roughness, tint } => {
                let index = conductor_index(metal.as_deref(), eta.as_ref(), k.as_ref(), reflectance.as_ref());
                let index = index.map_err(|(_, message)| refuse(place, message))?;
                Material::Conductor { index, facets: facets(roughness), tint: self.tint(tint, place)? }
            }
            MaterialDescription::Dielectric { index, roughness, reflection_tint, transmission_tint } => {
                Material::Dielectric {
                    index: refractive_index(index, place)?,
                    facets: facets(roughness),
                    reflection_tint: self.tint(reflection_tint, place)?,
                    transmission_tint: self.tint(transmission_tint, place)?,
                }
            }
            MaterialDescription::ThinDielectric { index, reflection_tint, transmission_tint } => {
                Material::ThinDielectric {
                    index: refractive_index(index, place)?,
                    reflection_tint: self.tint(reflection_tint, place)?,
                    transmission_tint: self.tint(transmission_tint, place)?,
                }
            }
            MaterialDescription::Plastic { reflectance, index, roughness, reflection_tint, nonlinear } => {
                let alphas = roughness.map_or([0.0; 2], Roughness::alphas);
                Material::Plastic {
                    reflectance: self.texture(reflectance, place)?,
                    coat: Box::new(Coat::new(refractive_index(index, place)?, alphas)),
                    reflection_tint: self.tint(reflection_tint, place)?,
                    nonlinear: *nonlinear,
                }
            }
            MaterialDescription::Mix { materials: [first, second], amount } => Material::Mix {
                amount: self.texture(amount, place)?,
                materials: Box::new([self.choice(first, place)?, self.choice(second, place)?]),
            },
        })
    }

    fn tint(
        &mut self,
        description: &Option<TextureDescription>,
        place: &str,
    ) -> Result<Option<Texture>, SceneError> {
        description.as_ref().map(|description| self.texture(description, place)).transpose()
    }

    fn texture(&mut self, description: &TextureDescription, place: &str) -> Result<Texture, SceneError> {
        let colour = |spectrum: &SpectrumDescription| {
            let spectrum = spectrum.fraction().map_err(|(_, message)| refuse(place, message))?;
            Ok::<_, SceneError>(Colour::fraction(spectrum))
        };
        Ok(match description {
            TextureDescription::Constant(spectrum) => Texture::Constant(colour(spectrum)?),
            TextureDescription::Checker(CheckerTexture { checker: [first, second], scale, offset }) => {
                let colours = Box::new([colour(first)?, colour(second)?]);
                Texture::Checker { colours, placement: placement(*scale, *offset) }
            }
            TextureDescription::Image(texture) => Texture::Image(self.image(texture)?),
        })
    }

    fn image(&mut self, texture: &ImageTexture) -> Result<ImageLookup, SceneError> {
        let key = (self.folder.join(&texture.image), texture.srgb);
        let picture = match self.pictures.get(&key) {
            Some(picture) => Arc::clone(picture),
            None => {
                let picture = Arc::new(Picture::read(&key.0, texture.srgb)?);
                let greatest = picture.greatest() * texture.factor.unwrap_or(1.0);
                if greatest > 1.0 {
                    let path = key.0.display();
                    self.notes
                        .push(format!("{path}: its values reach {greatest:.3}; above 1 they count as 1"));
                }
                self.pictures.insert(key, Arc::clone(&picture));
                picture
            }
        };
        Ok(ImageLookup {
            picture,
            placement: placement(texture.scale, texture.offset),
            filter: texture.filter,
            wrap: texture.wrap,
            factor: texture.factor.unwrap_or(1.0),
        })
    }
}

/// The refractive index of a conductor, which is given in one of three ways; or the key that is wrong and the mend.
pub(crate) fn conductor_index(
    name: Option<&str>,
    eta: Option<&SpectrumDescription>,
    k: Option<&SpectrumDescription>,
    reflectance: Option<&SpectrumDescription>,
) -> Result<ConductorIndex, KeyProblem> {
    const WAYS: &str = "give one of `metal`, `eta` with `k`, and `reflectance`";
    let colour = |spectrum: tyndall_optics::Spectrum| Box::new(Colour::new(spectrum));
    match (name, eta, k, reflectance) {
        (Some(name), None, None, None) => {
            let metal = metal(name).ok_or_else(|| ("metal", no_metal(name)))?;
            Ok(ConductorIndex::Complex { eta: colour(metal.eta()), k: colour(metal.k()) })
        }
        (None, Some(eta), Some(k), None) => {
            let of = |key, spectrum: &SpectrumDescription| {
                spectrum
                    .coefficient()
                    .map(colour)
                    .map_err(|(_, message)| (key, format!("`{key}`: {message}")))
            };
            Ok(ConductorIndex::Complex { eta: of("eta", eta)?, k: of("k", k)? })
        }
        (None, None, None, Some(reflectance)) => {
            let spectrum = reflectance.fraction();
            let spectrum =
                spectrum.map_err(|(_, message)| ("reflectance", format!("`reflectance`: {message}")))?;
            Ok(ConductorIndex::Reflectance(Box::new(Colour::fraction(spectrum))))
        }
        (None, None, None, None) => Err(("", format!("the conductor has no refractive index: {WAYS}"))),
        (None, Some(_), None, None) => Err(("eta", "`eta` and `k` belong together: give both".into())),
        (None, None, Some(_), None) => Err(("k", "`eta` and `k` belong together: give both".into())),
        _ => {
            let key = if reflectance.is_some() { "reflectance" } else { "eta" };
            let key = if key == "eta" && eta.is_none() { "k" } else { key };
            Err((key, format!("the conductor is given in several ways: {WAYS}")))
        }
    }
}

fn refractive_index(choice: &IndexChoice, place: &str) -> Result<f64, SceneError> {
    match choice {
        IndexChoice::Number(index) => Ok(*index),
        IndexChoice::Name(name) => dielectric_index(name).ok_or_else(|| refuse(place, no_substance(name))),
    }
}

fn placement(scale: Option<[f64; 2]>, offset: Option<[f64; 2]>) -> Placement {
    Placement { scale: scale.unwrap_or([1.0; 2]), offset: offset.unwrap_or([0.0; 2]) }
}

fn refuse(place: &str, message: String) -> SceneError {
    SceneError::file(Path::new(place), message)
}
