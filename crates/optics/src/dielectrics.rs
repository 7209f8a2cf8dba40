//! Refractive indices of transparent substances by name, for yellow light (about 589 nm) at room temperature.
//!
//! Figures: CRC Handbook of Chemistry and Physics, and of the optical glasses the nominal n_d of their makers' data sheets.
//! The spellings of pbrt (`glass-BK7`) and Mitsuba (`fused quartz`, `water ice`) are understood too, as spaces, hyphens and
//! underscores are one, and so are capitals and small letters; these renderers' own figures may differ in the third
//! decimal.

/// Name and index.
const DIELECTRICS: [(&str, f64); 33] = [
    ("acetone", 1.359),
    ("acrylic", 1.49),
    ("acrylic_glass", 1.49),
    ("air", 1.000277),
    ("amber", 1.55),
    ("baf10", 1.67003),
    ("benzene", 1.501),
    ("bk7", 1.5168),
    ("carbon_dioxide", 1.00045),
    ("carbon_tetrachloride", 1.461),
    ("diamond", 2.417),
    ("ethanol", 1.361),
    ("fk51a", 1.48656),
    ("fused_quartz", 1.4584),
    ("fused_silica", 1.4584),
    ("glycerol", 1.4729),
    ("glycerine", 1.4729),
    ("helium", 1.000036),
    ("hydrogen", 1.000132),
    ("ice", 1.31),
    ("lasf9", 1.85025),
    ("pet", 1.575),
    ("polypropylene", 1.49),
    ("pyrex", 1.47),
    ("sapphire", 1.768),
    ("sf5", 1.6727),
    ("sf10", 1.72825),
    ("sf11", 1.78472),
    ("silicone_oil", 1.52045),
    ("sodium_chloride", 1.544),
    ("vacuum", 1.0),
    ("water", 1.333),
    ("water_ice", 1.31),
];

/// The refractive index of a substance over that of vacuum.
pub fn dielectric_index(name: &str) -> Option<f64> {
    let plain = name.to_lowercase().replace([' ', '-'], "_");
    let plain = plain.strip_prefix("glass_").unwrap_or(&plain);
    DIELECTRICS.iter().find(|(known, _)| *known == plain).map(|(_, index)| *index)
}

/// The names that [`dielectric_index`] knows.
pub fn dielectric_names() -> impl Iterator<Item = &'static str> {
    DIELECTRICS.iter().map(|(name, _)| *name)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn substances_are_known_in_all_spellings() {
        assert_eq!(dielectric_index("glass-BK7"), Some(1.5168));
        assert_eq!(dielectric_index("Fused Quartz"), dielectric_index("fused_quartz"));
        assert_eq!(dielectric_index("jelly"), None);
        assert!(dielectric_names().all(|name| dielectric_index(name).is_some_and(|index| index >= 1.0)));
    }
}
