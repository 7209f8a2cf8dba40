//! A medium given by its particles: what they are, how large, and how many.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use tyndall_optics::mie::Amount;

use super::quantity::{CONCENTRATIONS, NUMBER_DENSITIES, Quantity};
use super::spheres::{DistributionDescription, IndexDescription, MaterialName, SubstanceChoice, substance};

/// Spheres whose coefficients and phase function follow from Lorenz-Mie theory: of `material`, `m` or `material_file`,
/// and as many as `liquid_water`, `mass_concentration`, `number_density` or `volume_fraction` says where the density is 1.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct ParticlesDescription {
    /// A material that is built in.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub material: Option<MaterialName>,
    /// Refractive index relative to the medium around.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub m: Option<IndexDescription>,
    /// A CSV table of the refractive index, with the heading `wavelength_nm,n,k` or `wavelength_um,n,k`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub material_file: Option<String>,
    /// Sizes of the particles.
    pub distribution: DistributionDescription,
    /// Mass of the droplets in a volume, such as `"0.3 g/m3"`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub liquid_water: Option<Quantity>,
    /// The same of particles of any material, such as `"50 ug/m3"`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub mass_concentration: Option<Quantity>,
    /// Number of particles in a volume, such as `"100 /cm3"`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub number_density: Option<Quantity>,
    /// Fraction of the volume that the particles fill.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(extend("exclusiveMinimum" = 0, "maximum" = 1))]
    pub volume_fraction: Option<f64>,
    /// Mass of a volume of what the particles are made of, such as `"2.6 g/cm3"`; that of a material is known.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub density: Option<Quantity>,
}

impl ParticlesDescription {
    /// What they are made of, or the key that is wrong and the mend.
    pub fn substance(&self) -> Result<SubstanceChoice<'_>, (&'static str, String)> {
        substance(self.material, self.m.as_ref(), self.material_file.as_deref())
    }

    /// How many there are, or the key that is wrong and the mend.
    pub fn amount(&self) -> Result<Amount, (&'static str, String)> {
        let given = [
            ("liquid_water", self.liquid_water.is_some()),
            ("mass_concentration", self.mass_concentration.is_some()),
            ("number_density", self.number_density.is_some()),
            ("volume_fraction", self.volume_fraction.is_some()),
        ];
        let mut given = given.into_iter().filter_map(|(key, is_given)| is_given.then_some(key));
        let (Some(key), None) = (given.next(), given.next()) else {
            let message = "give the amount of particles in exactly one way: `liquid_water`, `mass_concentration`, \
                           `number_density` or `volume_fraction`";
            return Err(("", message.into()));
        };
        let read = |key: &'static str, quantity: &Option<Quantity>, units: &[(&str, f64)]| match quantity {
            Some(quantity) => match quantity.in_units(units) {
                Ok(value) if value > 0.0 => Ok(value),
                Ok(value) => Err((key, format!("`{key}` must be above 0, not {value}"))),
                Err(message) => Err((key, format!("`{key}`: {message}"))),
            },
            None => Ok(0.0),
        };
        match key {
            "number_density" => read(key, &self.number_density, &NUMBER_DENSITIES).map(Amount::NumberDensity),
            "volume_fraction" => Ok(Amount::VolumeFraction(self.volume_fraction.unwrap_or(0.0))),
            _ => {
                let mass = if key == "liquid_water" { &self.liquid_water } else { &self.mass_concentration };
                let concentration = read(key, mass, &CONCENTRATIONS)?;
                Ok(Amount::Mass { concentration, density: self.mass_density()? })
            }
        }
    }

    /// g/cm³.
    fn mass_density(&self) -> Result<f64, (&'static str, String)> {
        match (&self.density, self.substance()?) {
            (Some(quantity), _) => match quantity.in_units(&CONCENTRATIONS) {
                Ok(density) if density > 0.0 => Ok(density * 1e-6),
                Ok(density) => Err(("density", format!("`density` must be above 0, not {density}"))),
                Err(message) => Err(("density", format!("`density`: {message}"))),
            },
            (None, SubstanceChoice::Material(material)) => Ok(material.density()),
            (None, _) => {
                Err(("", "a mass of particles needs their `density`, such as density = \"2.6 g/cm3\"".into()))
            }
        }
    }

    /// The path of the key that is wrong, and the mend.
    pub fn violation(&self) -> Option<(&'static str, String)> {
        if let Err(violation) = self.substance().and_then(|_| self.amount()) {
            return Some(violation);
        }
        self.distribution.value().err().map(|(_, message)| ("distribution", message))
    }
}
