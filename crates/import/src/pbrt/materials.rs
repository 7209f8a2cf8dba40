//! Materials.
//!
//! pbrt-v4's roughness r is the width α = √r of the GGX distribution unless `remaproughness` is false.

use tyndall_scene::description::{
    IndexChoice, MaterialChoice, MaterialDescription, Roughness, SpectrumDescription, TextureDescription,
};

use super::directives::Entity;
use super::parameters::{Kind, Parameters, Values};
use super::spectra;
use super::textures::Textures;
use super::world::{MaterialUse, World};
use crate::ImportError;

/// What light does at a surface, as far as media behind it are concerned.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Passage {
    /// All goes on as if nothing were there.
    Free,
    /// Some goes through.
    Partial,
    /// None goes through.
    None,
}

/// The passage through what a shape is made of.
pub(super) fn passage(material: &MaterialUse, world: &World) -> Passage {
    match material {
        MaterialUse::Default => Passage::None,
        MaterialUse::Here(entity) => passage_of(&entity.kind, entity, world, 0),
        MaterialUse::Named(name, _) => named_passage(name, world, 0),
    }
}

fn named_passage(name: &str, world: &World, depth: usize) -> Passage {
    match world.materials.iter().find(|(other, _)| other == name) {
        Some((_, entity)) => {
            let kind = entity.parameters.find("type", &[Kind::String]).and_then(|kind| kind.text());
            passage_of(kind.unwrap_or("diffuse"), entity, world, depth)
        }
        None => Passage::None,
    }
}

fn passage_of(kind: &str, entity: &Entity, world: &World, depth: usize) -> Passage {
    match kind {
        "interface" | "" | "none" => Passage::Free,
        "dielectric" | "thindielectric" => Passage::Partial,
        "mix" if depth < 16 => {
            let parts = entity.parameters.find("materials", &[Kind::String]);
            let names = match parts.map(|parts| &parts.values) {
                Some(Values::Texts(names)) => names.as_slice(),
                _ => &[],
            };
            let is_closed = |name: &String| named_passage(name, world, depth + 1) == Passage::None;
            if names.iter().take(2).all(is_closed) { Passage::None } else { Passage::Partial }
        }
        _ => Passage::None,
    }
}

impl Textures<'_> {
    /// What a shape is made of.
    pub(super) fn material(&self, material: &MaterialUse) -> Result<MaterialChoice, ImportError> {
        match material {
            MaterialUse::Default => Ok(here(MaterialDescription::Diffuse { reflectance: 0.5.into() })),
            MaterialUse::Named(name, place) => {
                if self.world.materials.iter().any(|(other, _)| **other == **name) {
                    return Ok(MaterialChoice::Name(name.to_string()));
                }
                let message = format!("there is no material \"{name}\": make it by `MakeNamedMaterial`");
                Err(place.error(message))
            }
            MaterialUse::Here(entity) => {
                let made = self.material_of(&entity.kind, entity)?;
                self.context.tell_unused("Material", entity);
                Ok(here(made))
            }
        }
    }

    /// A material with a name, made by `MakeNamedMaterial`; `number` is its place among them.
    pub(super) fn named_material(
        &self,
        number: usize,
        entity: &Entity,
    ) -> Result<MaterialDescription, ImportError> {
        let Some(kind) = entity.parameters.text("type")? else {
            return Err(entity.place.error("the material needs its \"string type\""));
        };
        let kind = if kind == "mix" { self.check_mix(number, entity).map(|()| kind)? } else { kind };
        let made = self.material_of(kind, entity)?;
        self.context.tell_unused("MakeNamedMaterial", entity);
        Ok(made)
    }

    /// A mixture with a name is made of materials above it, so that none is made of itself.
    fn check_mix(&self, number: usize, entity: &Entity) -> Result<(), ImportError> {
        let above = &self.world.materials[..number];
        let missing = mixed_names(&entity.parameters)
            .into_iter()
            .flatten()
            .find(|name| !above.iter().any(|(other, _)| other == name));
        match missing {
            Some(name) => {
                Err(entity.place.error(format!("there is no material \"{name}\" above: make it first")))
            }
            None => Ok(()),
        }
    }

    fn material_of(&self, kind: &str, entity: &Entity) -> Result<MaterialDescription, ImportError> {
        let (parameters, place) = (&entity.parameters, &entity.place);
        let reflectance = |default: f64| -> Result<TextureDescription, ImportError> {
            Ok(self.fraction(parameters, "reflectance")?.unwrap_or(default.into()))
        };
        let instead = |what: &str| {
            let message = format!("the material \"{kind}\" is not supported: it is {what}");
            self.context.unsupported(place, message);
        };
        Ok(match kind {
            "interface" => MaterialDescription::Null,
            "" | "none" => {
                self.context.choice(place, "the material \"none\" is taken for \"interface\"");
                MaterialDescription::Null
            }
            "diffuse" => MaterialDescription::Diffuse { reflectance: reflectance(0.5)? },
            "conductor" => self.conductor(parameters, "", entity)?,
            "coatedconductor" => {
                instead("a conductor without a coat");
                parameters.pass(&[
                    "interface.roughness",
                    "interface.uroughness",
                    "interface.vroughness",
                    "interface.eta",
                    "thickness",
                    "g",
                    "albedo",
                    "maxdepth",
                    "nsamples",
                ]);
                self.conductor(parameters, "conductor.", entity)?
            }
            "dielectric" => MaterialDescription::Dielectric {
                index: self.index(parameters)?,
                roughness: self.roughness(parameters, "")?,
                reflection_tint: None,
                transmission_tint: None,
            },
            "thindielectric" => MaterialDescription::ThinDielectric {
                index: self.index(parameters)?,
                reflection_tint: None,
                transmission_tint: None,
            },
            "coateddiffuse" => {
                self.context.choice(
                    place,
                    "\"coateddiffuse\" is a plastic: its coat is computed in closed form, not by walks between layers",
                );
                parameters.pass(&["thickness", "g", "maxdepth", "nsamples"]);
                MaterialDescription::Plastic {
                    reflectance: reflectance(0.5)?,
                    index: self.index(parameters)?,
                    roughness: self.roughness(parameters, "")?,
                    reflection_tint: None,
                    nonlinear: true,
                }
            }
            "mix" => {
                let Some([first, second]) = mixed_names(parameters) else {
                    return Err(place.error("a mixture needs two names in \"string materials\""));
                };
                for name in [first, second] {
                    if !self.world.materials.iter().any(|(other, _)| other == name) {
                        return Err(place.error(format!("there is no material \"{name}\": make it first")));
                    }
                }
                let amount = self.number(parameters, "amount")?.unwrap_or(0.5.into());
                let materials = [first, second].map(|name| MaterialChoice::Name(name.to_owned()));
                MaterialDescription::Mix { materials, amount }
            }
            "diffusetransmission" => {
                instead("diffuse and lets nothing through");
                parameters.pass(&["transmittance", "scale"]);
                MaterialDescription::Diffuse { reflectance: reflectance(0.25)? }
            }
            "subsurface" | "measured" | "hair" => {
                instead("diffuse");
                let reflectance = if kind == "subsurface" { reflectance(0.5)? } else { 0.5.into() };
                MaterialDescription::Diffuse { reflectance }
            }
            _ => return Err(place.error(format!("\"{kind}\" is no material of pbrt-v4"))),
        })
    }

    fn conductor(
        &self,
        parameters: &Parameters,
        prefix: &str,
        entity: &Entity,
    ) -> Result<MaterialDescription, ImportError> {
        let [eta, k] = ["eta", "k"].map(|name| parameters.colour(&format!("{prefix}{name}")));
        let roughness = self.roughness(parameters, prefix)?;
        let conductor = |metal: Option<&str>, eta, k, reflectance, tint| MaterialDescription::Conductor {
            metal: metal.map(str::to_owned),
            eta,
            k,
            reflectance,
            roughness,
            tint,
        };
        let texture = match (eta, k) {
            (None, None) => self.fraction(parameters, "reflectance")?,
            _ => None,
        };
        match texture {
            Some(TextureDescription::Constant(colour)) => {
                return Ok(conductor(None, None, None, Some(colour), None));
            }
            Some(texture) => {
                let message = "the reflectance of a conductor that varies holds for all angles";
                self.context.unsupported(&entity.place, message);
                return Ok(conductor(None, None, None, Some(SpectrumDescription::Grey(1.0)), Some(texture)));
            }
            None => {}
        }
        let names = [eta, k].map(|parameter| parameter.and_then(|parameter| parameter.text()));
        let metals = [(names[0], "-eta"), (names[1], "-k")].map(|(name, end)| {
            name.and_then(|name| name.strip_prefix("metal-")).and_then(|name| name.strip_suffix(end))
        });
        match (eta, k, metals) {
            (None, None, _) => Ok(conductor(Some("copper"), None, None, None, None)),
            (Some(eta), Some(k), [None, None]) => {
                let [eta, k] = [eta, k].map(|parameter| spectra::coefficient(parameter, self.context));
                Ok(conductor(None, Some(eta?), Some(k?), None, None))
            }
            (_, _, [Some(one), Some(other)]) if one == other => Ok(match named_metal(one) {
                Some(NamedMetal::Known(name)) => conductor(Some(name), None, None, None, None),
                Some(NamedMetal::Transparent(eta)) => {
                    let message =
                        format!("\"metal-{one}\" has the refractive index {eta} at all wavelengths");
                    self.context.unsupported(&entity.place, message);
                    let [eta, k] = [eta, 0.0].map(|value| Some(SpectrumDescription::Grey(value)));
                    conductor(None, eta, k, None, None)
                }
                None => return Err(entity.place.error(format!("\"metal-{one}\" is no metal of pbrt-v4"))),
            }),
            (_, _, metals) => {
                let known = metals.into_iter().flatten().find_map(|metal| match named_metal(metal) {
                    Some(NamedMetal::Known(name)) => Some(name),
                    _ => None,
                });
                let name = known.unwrap_or("copper");
                let message =
                    format!("a conductor with `eta` and `k` of different kinds is taken for {name}");
                self.context.unsupported(&entity.place, message);
                Ok(conductor(Some(name), None, None, None, None))
            }
        }
    }

    /// The refractive index `eta`.
    fn index(&self, parameters: &Parameters) -> Result<IndexChoice, ImportError> {
        let Some(parameter) = parameters.colour("eta") else { return Ok(IndexChoice::default()) };
        let index = match (parameter.kind, parameter.numbers(), parameter.text()) {
            (Kind::Float, &[index], _) => index,
            (Kind::Spectrum, _, Some(name)) => {
                let Some(index) = glass(name) else {
                    return Err(parameter.error(&format!("\"{name}\" is no glass of pbrt-v4: give a number")));
                };
                let message = format!("the refractive index of \"{name}\" is {index} at all wavelengths");
                self.context.unsupported(&parameter.place, message);
                index
            }
            _ => match spectra::coefficient(parameter, self.context)? {
                SpectrumDescription::Grey(index) => index,
                SpectrumDescription::Channels([_, green, _]) => green,
                SpectrumDescription::Table(table) => {
                    let message =
                        "a refractive index that depends on the wavelength is that of its middle sample";
                    self.context.unsupported(&parameter.place, message);
                    let values = table.values.unwrap_or_default();
                    values.get(values.len() / 2).copied().unwrap_or(1.5)
                }
            },
        };
        // pbrt takes 0 for 1.
        let index = if index == 0.0 { 1.0 } else { index };
        if !(0.01..=100.0).contains(&index) {
            return Err(parameter.error("is a refractive index: give one from 0.01 to 100"));
        }
        Ok(IndexChoice::Number(index))
    }

    /// Widths of the distribution of microfacets; none if the surface is smooth.
    fn roughness(&self, parameters: &Parameters, prefix: &str) -> Result<Option<Roughness>, ImportError> {
        /// What a roughness that varies is taken for: satin.
        const INSTEAD: f64 = 0.1;
        let along = |name: &str| self.constant(parameters, &format!("{prefix}{name}"), INSTEAD);
        let both = along("roughness")?.unwrap_or(0.0);
        let roughness = [along("uroughness")?.unwrap_or(both), along("vroughness")?.unwrap_or(both)];
        let is_remapped = parameters.flag("remaproughness")?.unwrap_or(true);
        let [u, v] = roughness.map(|roughness| {
            let alpha = if is_remapped { roughness.max(0.0).sqrt() } else { roughness };
            alpha.clamp(0.0, 1.0)
        });
        Ok(match [u, v] {
            [0.0, 0.0] => None,
            [u, v] if u == v => Some(Roughness::Equal(u)),
            pair => Some(Roughness::Pair(pair)),
        })
    }
}

/// A material given in place.
pub(super) fn here(material: MaterialDescription) -> MaterialChoice {
    MaterialChoice::Here(Box::new(material))
}

fn mixed_names(parameters: &Parameters) -> Option<[&str; 2]> {
    match &parameters.find("materials", &[Kind::String])?.values {
        Values::Texts(names) => match names.as_slice() {
            [first, second] => Some([first, second]),
            _ => None,
        },
        _ => None,
    }
}

enum NamedMetal {
    /// Name of its optical constants here.
    Known(&'static str),
    /// Not a metal: a refractive index at 589 nm, without absorption.
    Transparent(f64),
}

/// Metals that pbrt has by name.
fn named_metal(name: &str) -> Option<NamedMetal> {
    Some(match name {
        "Ag" => NamedMetal::Known("silver"),
        "Al" => NamedMetal::Known("aluminium"),
        "Au" => NamedMetal::Known("gold"),
        "Cu" => NamedMetal::Known("copper"),
        "CuZn" => NamedMetal::Known("brass"),
        "MgO" => NamedMetal::Transparent(1.7373),
        "TiO2" => NamedMetal::Transparent(2.6142),
        _ => return None,
    })
}

/// Refractive indices of the glasses that pbrt has by name, at 587.6 nm (catalogues of Schott and Ohara).
fn glass(name: &str) -> Option<f64> {
    Some(match name {
        "glass-BK7" => 1.5168,
        "glass-BAF10" => 1.6700,
        "glass-FK51A" => 1.4866,
        "glass-LASF9" => 1.8503,
        "glass-F5" | "glass-SF5" => 1.6727,
        "glass-SF10" => 1.7283,
        "glass-SF11" => 1.7847,
        _ => return None,
    })
}
