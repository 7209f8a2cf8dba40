//! The materials that are built in, with their mass densities. Each table names its source.
//!
//! The densities of the aerosols are those of Hess, Koepke & Schult 1998, table 1c; ice has that of Ih at 0 °C.

use std::sync::LazyLock;

use super::RefractiveIndexTable;

/// A material whose refractive index is built in.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Material {
    /// Liquid water (Segelstein 1981), 190 to 2550 nm.
    Water,
    /// Ice (Warren & Brandt 2008), 191 to 2550 nm.
    Ice,
    /// Soot (Hess et al. 1998, as are those that follow), 250 to 2500 nm.
    Soot,
    /// Mineral dust.
    Dust,
    /// Dry sea salt.
    SeaSalt,
    /// Dry water-soluble particles: sulphates, nitrates, organic matter.
    WaterSoluble,
    /// Insoluble particles of soil with organic matter.
    Insoluble,
    /// Droplets of 75 % sulphuric acid.
    Sulfate,
}

impl Material {
    /// All of them.
    pub const ALL: [Self; 8] = [
        Self::Water,
        Self::Ice,
        Self::Soot,
        Self::Dust,
        Self::SeaSalt,
        Self::WaterSoluble,
        Self::Insoluble,
        Self::Sulfate,
    ];

    /// Its name in scene files.
    pub fn name(self) -> &'static str {
        match self {
            Self::Water => "water",
            Self::Ice => "ice",
            Self::Soot => "soot",
            Self::Dust => "dust",
            Self::SeaSalt => "sea_salt",
            Self::WaterSoluble => "water_soluble",
            Self::Insoluble => "insoluble",
            Self::Sulfate => "sulfate",
        }
    }

    /// The material of that name.
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|material| material.name() == name)
    }

    /// Mass of a volume, g/cm³.
    pub fn density(self) -> f64 {
        match self {
            Self::Water | Self::Soot => 1.0,
            Self::Ice => 0.917,
            Self::Dust => 2.6,
            Self::SeaSalt => 2.2,
            Self::WaterSoluble => 1.8,
            Self::Insoluble => 2.0,
            Self::Sulfate => 1.7,
        }
    }

    /// The table of its refractive index.
    pub fn table(self) -> &'static RefractiveIndexTable {
        static TABLES: LazyLock<[RefractiveIndexTable; 8]> = LazyLock::new(|| {
            Material::ALL.map(|material| {
                RefractiveIndexTable::parse(material.text())
                    .expect("the built-in tables are tested to be sound")
            })
        });
        &TABLES[self as usize]
    }

    fn text(self) -> &'static str {
        match self {
            Self::Water => include_str!("tables/water.csv"),
            Self::Ice => include_str!("tables/ice.csv"),
            Self::Soot => include_str!("tables/soot.csv"),
            Self::Dust => include_str!("tables/dust.csv"),
            Self::SeaSalt => include_str!("tables/sea_salt.csv"),
            Self::WaterSoluble => include_str!("tables/water_soluble.csv"),
            Self::Insoluble => include_str!("tables/insoluble.csv"),
            Self::Sulfate => include_str!("tables/sulfate.csv"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_material_is_known_over_visible_light_by_its_name() {
        for material in Material::ALL {
            assert_eq!(Material::from_name(material.name()), Some(material));
            for wavelength in [360.0, 555.5, 830.0] {
                assert!(material.table().at(wavelength).is_some_and(|m| m.check().is_ok()));
            }
        }
    }

    /// Rows of Segelstein's table between which the index of water at 550 nm lies.
    #[test]
    fn water_at_550_nm_lies_between_its_rows() {
        let m = Material::Water.table().at(550.0).unwrap();
        assert!((m.n - 1.3359435).abs() < 1e-7 && (m.k / 2.4611102e-9 - 1.0).abs() < 1e-5, "{m:?}");
    }
}
