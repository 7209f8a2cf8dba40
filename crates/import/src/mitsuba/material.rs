//! `<bsdf>`: materials.
//!
//! Mitsuba's reflecting materials are black from behind unless `twosided` wraps them; Tyndall's reflect on both sides.
//! Its interfaces give the index inside, `int_ior`, and that outside, `ext_ior`; what refracts is their ratio.

use tyndall_scene::description::{
    IndexChoice, MaterialChoice, MaterialDescription, NamedMaterial, Roughness, TextureDescription,
};

use super::importer::Importer;
use super::object::{Class, Object, Value};
use super::spectrum::{Role, is_zero};
use super::text::excerpt;
use crate::ImportError;

/// Refractive indices by the names that Mitsuba's documentation lists.
const INDICES: [(&str, f64); 21] = [
    ("vacuum", 1.0),
    ("helium", 1.000_036),
    ("hydrogen", 1.000_132),
    ("air", 1.000_277),
    ("carbon dioxide", 1.000_45),
    ("water", 1.333),
    ("acetone", 1.36),
    ("ethanol", 1.361),
    ("carbon tetrachloride", 1.461),
    ("glycerol", 1.4729),
    ("benzene", 1.501),
    ("silicone oil", 1.52045),
    ("bromine", 1.661),
    ("water ice", 1.31),
    ("fused quartz", 1.458),
    ("pyrex", 1.47),
    ("acrylic glass", 1.49),
    ("polypropylene", 1.49),
    ("bk7", 1.5046),
    ("sodium chloride", 1.544),
    ("amber", 1.55),
];
/// The rest of them.
const MORE_INDICES: [(&str, f64); 2] = [("pet", 1.575), ("diamond", 2.419)];

/// Greatest number of materials in a mixture.
const PARTS: usize = 256;

/// Where a material is used.
#[derive(Debug, Clone, Copy)]
pub(super) struct Use {
    /// Whether the shape's texture coordinates run against Mitsuba's.
    pub flipped: bool,
    /// Whether it is within a `twosided`.
    pub two_sided: bool,
}

impl<'a> Importer<'a> {
    /// The material of an object: a name if the object has an id, so that it stands once.
    pub fn material(&mut self, number: usize, usage: Use) -> Result<MaterialChoice, ImportError> {
        let object = self.object(number);
        let usage = Use { flipped: usage.flipped && self.has_texture(number, 0), ..usage };
        if object.id.is_none() {
            let description = self.within(number, |importer| importer.bsdf(object, usage))?;
            return Ok(MaterialChoice::Here(Box::new(description)));
        }
        if let Some(name) = self.named_materials.get(&(number, usage.flipped)) {
            return Ok(MaterialChoice::Name(name.clone()));
        }
        let material = self.within(number, |importer| importer.bsdf(object, usage))?;
        let parts = self.count_parts(&material);
        if parts > PARTS {
            let message = format!("{} is mixed of more than {PARTS} parts: mix fewer", object.title());
            return Err(object.place.error(message));
        }
        let name = self.name(object);
        self.materials.push(NamedMaterial { name: name.clone(), material });
        self.named_materials.insert((number, usage.flipped), name.clone());
        self.material_parts.insert(name.clone(), parts);
        Ok(MaterialChoice::Name(name))
    }

    fn bsdf(&mut self, object: &'a Object, usage: Use) -> Result<MaterialDescription, ImportError> {
        let flipped = usage.flipped;
        object.ignore(&["sample_visible"]);
        let description = match object.plugin.as_str() {
            "diffuse" => self.diffuse(object, usage)?,
            "roughdiffuse" => {
                let sigma = object.float("alpha", 0.2)?.to_degrees().clamp(0.0, 90.0);
                object.ignore(&["use_fast_approx"]);
                MaterialDescription::RoughDiffuse {
                    reflectance: self.texture(object, "reflectance", 0.5, flipped)?,
                    sigma,
                }
            }
            "dielectric" => MaterialDescription::Dielectric {
                index: self.index(object, "bk7")?,
                roughness: None,
                reflection_tint: self.texture_if_given(object, "specular_reflectance", flipped)?,
                transmission_tint: self.texture_if_given(object, "specular_transmittance", flipped)?,
            },
            "roughdielectric" => MaterialDescription::Dielectric {
                index: self.index(object, "bk7")?,
                roughness: Some(self.roughness(object, "beckmann")?),
                reflection_tint: self.texture_if_given(object, "specular_reflectance", flipped)?,
                transmission_tint: self.texture_if_given(object, "specular_transmittance", flipped)?,
            },
            "thindielectric" => MaterialDescription::ThinDielectric {
                index: self.index(object, "bk7")?,
                reflection_tint: self.texture_if_given(object, "specular_reflectance", flipped)?,
                transmission_tint: self.texture_if_given(object, "specular_transmittance", flipped)?,
            },
            "conductor" | "roughconductor" => self.conductor(object, flipped)?,
            "plastic" | "roughplastic" | "pplastic" => self.plastic(object, flipped)?,
            "blendbsdf" => {
                let amount = self.texture(object, "weight", 0.5, flipped)?;
                MaterialDescription::Mix { materials: self.two_bsdfs(object, usage)?, amount }
            }
            "mask" => {
                let amount = self.texture(object, "opacity", 0.5, flipped)?;
                let null = MaterialChoice::Here(Box::new(MaterialDescription::Null));
                MaterialDescription::Mix { materials: [null, self.inner(object, usage)?], amount }
            }
            "twosided" => {
                let inner = self.children(object, Class::Bsdf);
                if inner.len() > 1 {
                    let message = "a `twosided` with two materials is not supported: that of the front is on both sides";
                    self.unsupported(&object.place, message);
                }
                return self.taken(object, Use { two_sided: true, ..usage });
            }
            "null" => MaterialDescription::Null,
            "bumpmap" | "normalmap" => {
                let message = format!("{} is not supported: the surface is smooth", object.title());
                self.unsupported(&object.place, message);
                object.ignore(&["arbitrary", "scale", "normalmap"]);
                self.children(object, Class::Texture);
                return self.taken(object, usage);
            }
            "principled" | "principledthin" => self.principled(object, flipped)?,
            _ => {
                let message = format!("{} is not supported: the surface is diffuse, 0.5", object.title());
                self.unsupported(&object.place, message);
                return Ok(MaterialDescription::Diffuse { reflectance: 0.5.into() });
            }
        };
        self.tell_unused(object);
        Ok(description)
    }

    /// Number of materials that are no mixtures in one that may be.
    fn count_parts(&self, material: &MaterialDescription) -> usize {
        let MaterialDescription::Mix { materials, .. } = material else { return 1 };
        let count = |choice: &MaterialChoice| match choice {
            MaterialChoice::Name(name) => self.material_parts.get(name).copied().unwrap_or(1),
            MaterialChoice::Here(material) => self.count_parts(material),
        };
        materials.iter().map(count).sum()
    }

    fn diffuse(&mut self, object: &'a Object, usage: Use) -> Result<MaterialDescription, ImportError> {
        let reflectance = self.texture(object, "reflectance", 0.5, usage.flipped)?;
        let is_black = matches!(&reflectance, TextureDescription::Constant(spectrum) if is_zero(spectrum));
        if !usage.two_sided && !is_black {
            let message =
                "a `diffuse` that no `twosided` wraps is black from behind; here it reflects on both sides";
            self.choice(&object.place, message);
        }
        Ok(MaterialDescription::Diffuse { reflectance })
    }

    fn conductor(&mut self, object: &'a Object, flipped: bool) -> Result<MaterialDescription, ImportError> {
        let material = object.text("material")?.unwrap_or("none").to_owned();
        let (mut metal, mut eta, mut k, mut reflectance) = (None, None, None, None);
        if object.get("eta").is_some() || object.get("k").is_some() {
            eta = Some(self.spectrum(object, "eta", Role::Coefficient, 0.0)?);
            k = Some(self.spectrum(object, "k", Role::Coefficient, 1.0)?);
        } else if material == "none" {
            reflectance = Some(1.0.into());
        } else if tyndall_optics::metal(&material).is_some() {
            metal = Some(material);
        } else {
            let message = format!("the metal `{}` is not known: aluminium is taken", excerpt(&material));
            self.unsupported(&object.place, message);
            metal = Some("Al".to_owned());
        }
        let is_rough = object.plugin == "roughconductor";
        let roughness = is_rough.then(|| self.roughness(object, "beckmann")).transpose()?;
        let tint = self.texture_if_given(object, "specular_reflectance", flipped)?;
        Ok(MaterialDescription::Conductor { metal, eta, k, reflectance, roughness, tint })
    }

    fn plastic(&mut self, object: &'a Object, flipped: bool) -> Result<MaterialDescription, ImportError> {
        let is_rough = object.plugin != "plastic";
        Ok(MaterialDescription::Plastic {
            reflectance: self.texture(object, "diffuse_reflectance", 0.5, flipped)?,
            index: self.index(object, "polypropylene")?,
            roughness: is_rough.then(|| self.roughness(object, "beckmann")).transpose()?,
            reflection_tint: self.texture_if_given(object, "specular_reflectance", flipped)?,
            nonlinear: object.boolean("nonlinear", false)?,
        })
    }

    /// The nearest of a metal, a glass and a plastic.
    fn principled(&mut self, object: &'a Object, flipped: bool) -> Result<MaterialDescription, ImportError> {
        let message =
            format!("{} is not supported: the nearest of metal, glass and plastic is taken", object.title());
        self.unsupported(&object.place, message);
        let base = self.texture(object, "base_color", 0.5, flipped)?;
        let metallic = self.number(object, "metallic", 0.0)?;
        let transmission = self.number(object, "spec_trans", 0.0)?;
        let alpha = self.number(object, "roughness", 0.5)?.clamp(0.0, 1.0).powi(2);
        let roughness = Some(Roughness::Equal(alpha)).filter(|_| alpha > 0.0);
        // Burley 2015: reflectance at normal incidence is 0.08 times `specular`.
        let root = (0.08 * object.float("specular", 0.5)?.clamp(0.0, 1.0)).sqrt();
        let index = object.float_if_given("eta")?.unwrap_or((1.0 + root) / (1.0 - root));
        let index = IndexChoice::Number(index.clamp(1e-3, 1e3));
        for property in &object.properties {
            property.is_used.set(true);
        }
        Ok(if metallic >= 0.5 {
            MaterialDescription::Conductor {
                metal: None,
                eta: None,
                k: None,
                reflectance: Some(1.0.into()),
                roughness,
                tint: Some(base),
            }
        } else if transmission >= 0.5 {
            MaterialDescription::Dielectric {
                index,
                roughness,
                reflection_tint: None,
                transmission_tint: Some(base),
            }
        } else {
            MaterialDescription::Plastic {
                reflectance: base,
                index,
                roughness,
                reflection_tint: None,
                nonlinear: false,
            }
        })
    }

    /// A number, or that of a texture which is the same everywhere; the default otherwise.
    fn number(&mut self, object: &'a Object, name: &str, default: f64) -> Result<f64, ImportError> {
        let Some(property) = object.get(name) else { return Ok(default) };
        match &property.value {
            Value::Float(value) | Value::Uniform(value) => Ok(*value),
            Value::Integer(value) => Ok(*value as f64),
            _ => {
                let message =
                    format!("`{name}` that varies or has a colour is not supported: {default} is taken");
                self.unsupported(&property.place, message);
                Ok(default)
            }
        }
    }

    fn index(&mut self, object: &'a Object, inside: &str) -> Result<IndexChoice, ImportError> {
        let inner = self.index_of(object, "int_ior", inside)?;
        let outer = self.index_of(object, "ext_ior", "air")?;
        let ratio = inner / outer;
        if !(ratio.is_finite() && ratio > 1e-3 && ratio < 1e3) {
            return Err(object
                .place
                .error("the refractive indices must be above 0: mend `int_ior` and `ext_ior`"));
        }
        Ok(IndexChoice::Number(ratio))
    }

    fn index_of(&mut self, object: &'a Object, name: &str, default: &str) -> Result<f64, ImportError> {
        let text = match object.get(name).map(|property| &property.value) {
            Some(Value::Text(text)) => text.clone(),
            Some(_) => return object.float(name, 1.0),
            None => default.to_owned(),
        };
        let text = text.to_ascii_lowercase();
        let known = INDICES.iter().chain(&MORE_INDICES).find(|(known, _)| *known == text);
        known.map(|(_, index)| *index).ok_or_else(|| {
            let message = format!("there is no substance `{}`: give `{name}` as a <float>", excerpt(&text));
            object.place.error(message)
        })
    }

    fn roughness(&mut self, object: &'a Object, default: &str) -> Result<Roughness, ImportError> {
        let distribution = object.text("distribution")?.unwrap_or(default);
        if !distribution.eq_ignore_ascii_case("ggx") {
            let message = "microfacets are distributed as GGX with the same alpha, not Beckmann's";
            self.unsupported(&object.place, message);
        }
        let alpha = |importer: &mut Self, name| Ok(importer.number(object, name, 0.1)?.clamp(0.0, 1.0));
        if object.get("alpha_u").is_some() || object.get("alpha_v").is_some() {
            return Ok(Roughness::Pair([alpha(self, "alpha_u")?, alpha(self, "alpha_v")?]));
        }
        Ok(Roughness::Equal(alpha(self, "alpha")?))
    }

    fn two_bsdfs(&mut self, object: &'a Object, usage: Use) -> Result<[MaterialChoice; 2], ImportError> {
        let [first, second] = self.children(object, Class::Bsdf)[..] else {
            return Err(object.place.error(format!("{} needs two <bsdf>s", object.title())));
        };
        Ok([self.material(first, usage)?, self.material(second, usage)?])
    }

    fn inner(&mut self, object: &'a Object, usage: Use) -> Result<MaterialChoice, ImportError> {
        match self.child(object, Class::Bsdf) {
            Some(number) => self.material(number, usage),
            None => Err(object.place.error(format!("{} needs a <bsdf> within", object.title()))),
        }
    }

    /// The material within another that adds nothing.
    fn taken(&mut self, object: &'a Object, usage: Use) -> Result<MaterialDescription, ImportError> {
        let Some(number) = self.child(object, Class::Bsdf) else {
            return Err(object.place.error(format!("{} needs a <bsdf> within", object.title())));
        };
        self.children(object, Class::Bsdf);
        self.tell_unused(object);
        let inner = self.object(number);
        self.within(number, |importer| importer.bsdf(inner, usage))
    }
}
