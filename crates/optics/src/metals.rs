//! Metals: refractive indices n + ik over visible light, as measured. Each table names its source.
//!
//! Names are English or the chemical symbol, plain or as pbrt (`metal-Cu-eta`) and Mitsuba (`Cu`, `Cu_palik`) write it; the
//! measurements need not be those that these two renderers use.

use std::sync::LazyLock;

use crate::{RefractiveIndexTable, Spectrum};

/// A metal whose refractive index is built in.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct Metal(usize);

/// English name, symbol, and table of every metal.
const METALS: [(&str, &str, &str); 19] = [
    ("aluminium", "Al", include_str!("refractive_index/metals/aluminium.csv")),
    ("brass", "CuZn", include_str!("refractive_index/metals/brass.csv")),
    ("chromium", "Cr", include_str!("refractive_index/metals/chromium.csv")),
    ("cobalt", "Co", include_str!("refractive_index/metals/cobalt.csv")),
    ("copper", "Cu", include_str!("refractive_index/metals/copper.csv")),
    ("gold", "Au", include_str!("refractive_index/metals/gold.csv")),
    ("iridium", "Ir", include_str!("refractive_index/metals/iridium.csv")),
    ("iron", "Fe", include_str!("refractive_index/metals/iron.csv")),
    ("mercury", "Hg", include_str!("refractive_index/metals/mercury.csv")),
    ("molybdenum", "Mo", include_str!("refractive_index/metals/molybdenum.csv")),
    ("nickel", "Ni", include_str!("refractive_index/metals/nickel.csv")),
    ("niobium", "Nb", include_str!("refractive_index/metals/niobium.csv")),
    ("palladium", "Pd", include_str!("refractive_index/metals/palladium.csv")),
    ("platinum", "Pt", include_str!("refractive_index/metals/platinum.csv")),
    ("rhodium", "Rh", include_str!("refractive_index/metals/rhodium.csv")),
    ("silver", "Ag", include_str!("refractive_index/metals/silver.csv")),
    ("titanium", "Ti", include_str!("refractive_index/metals/titanium.csv")),
    ("tungsten", "W", include_str!("refractive_index/metals/tungsten.csv")),
    ("vanadium", "V", include_str!("refractive_index/metals/vanadium.csv")),
];

/// The metal of an English name, a symbol, or a symbol with the ornaments of other renderers.
pub fn metal(name: &str) -> Option<Metal> {
    let plain = name.strip_prefix("metal-").unwrap_or(name);
    let plain = ["-eta", "-k", "_palik"].iter().find_map(|end| plain.strip_suffix(end)).unwrap_or(plain);
    let plain = if plain.eq_ignore_ascii_case("aluminum") { "aluminium" } else { plain };
    let is_named =
        |(english, symbol, _): &(&str, &str, &str)| english.eq_ignore_ascii_case(plain) || *symbol == plain;
    METALS.iter().position(is_named).map(Metal)
}

impl Metal {
    /// All of them.
    pub fn all() -> impl Iterator<Item = Metal> {
        (0..METALS.len()).map(Metal)
    }

    /// Its English name.
    pub fn name(self) -> &'static str {
        METALS[self.0].0
    }

    /// Real part of the refractive index by wavelength.
    pub fn eta(self) -> Spectrum {
        self.spectrum(|index| index.n)
    }

    /// Imaginary part of the refractive index by wavelength.
    pub fn k(self) -> Spectrum {
        self.spectrum(|index| index.k)
    }

    /// The table of its refractive index.
    pub fn table(self) -> &'static RefractiveIndexTable {
        static TABLES: LazyLock<Vec<RefractiveIndexTable>> = LazyLock::new(|| {
            let parse = |(_, _, text): &(&str, &str, &str)| RefractiveIndexTable::parse(text);
            METALS
                .iter()
                .map(parse)
                .collect::<Result<_, _>>()
                .expect("the built-in tables are tested to be sound")
        });
        &TABLES[self.0]
    }

    fn spectrum(self, part: impl Fn(crate::RefractiveIndex) -> f64) -> Spectrum {
        let (wavelengths_nm, values) = self.table().rows().map(|(nm, index)| (nm, part(index))).unzip();
        Spectrum::Sampled { wavelengths_nm, values }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bsdf::fresnel;

    #[test]
    fn every_metal_is_known_over_visible_light_by_all_its_names() {
        for metal in Metal::all() {
            let (english, symbol, _) = METALS[metal.0];
            for name in
                [english.into(), symbol.into(), format!("metal-{symbol}-eta"), format!("metal-{symbol}-k")]
            {
                assert_eq!(super::metal(&name), Some(metal), "{name}");
            }
            let [first, last] = metal.table().range();
            assert!(first <= 360.0 && last >= 830.0, "{english}: {first} {last}");
        }
        assert_eq!(metal("Aluminum").map(Metal::name), Some("aluminium"));
        assert_eq!(metal("Ni_palik").map(Metal::name), Some("nickel"));
        assert_eq!((metal("cu"), metal(""), metal("glass")), (None, None, None));
    }

    /// Silver mirrors nearly all light, gold and copper red light, and none all of it.
    #[test]
    fn metals_have_their_colours() {
        let reflectance = |name: &str, nm: f64| {
            let metal = metal(name).unwrap();
            fresnel::conductor(1.0, metal.eta().at(nm), metal.k().at(nm))
        };
        assert!((0.97..0.995).contains(&reflectance("silver", 600.0)));
        assert!((0.90..0.93).contains(&reflectance("aluminium", 550.0)));
        assert!(reflectance("gold", 650.0) > 0.95 && reflectance("gold", 450.0) < 0.45);
        assert!(reflectance("copper", 650.0) > 0.93 && reflectance("copper", 450.0) < 0.6);
        for metal in Metal::all() {
            for nm in (360..=830).map(f64::from) {
                let reflectance = fresnel::conductor(1.0, metal.eta().at(nm), metal.k().at(nm));
                assert!((0.25..0.999).contains(&reflectance), "{} {nm}: {reflectance}", metal.name());
            }
        }
    }
}
