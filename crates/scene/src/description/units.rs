//! Units of length by name, for what is given in physical units: measured media, particles.

/// Names and lengths in metres.
const UNITS: [(&[&str], f64); 10] = [
    (&["m", "metre", "metres", "meter", "meters"], 1.0),
    (&["km", "kilometre", "kilometres", "kilometer", "kilometers"], 1e3),
    (&["dm", "decimetre", "decimetres", "decimeter", "decimeters"], 1e-1),
    (&["cm", "centimetre", "centimetres", "centimeter", "centimeters"], 1e-2),
    (&["mm", "millimetre", "millimetres", "millimeter", "millimeters"], 1e-3),
    (
        &["um", "µm", "μm", "micrometre", "micrometres", "micrometer", "micrometers", "micron", "microns"],
        1e-6,
    ),
    (&["nm", "nanometre", "nanometres", "nanometer", "nanometers"], 1e-9),
    (&["in", "inch", "inches"], 0.0254),
    (&["ft", "foot", "feet"], 0.3048),
    (&["mi", "mile", "miles"], 1609.344),
];

/// Length of the unit in metres, or what is wrong with its name and the mend.
pub fn unit_in_metres(name: &str) -> Result<f64, String> {
    let wanted = name.trim().to_lowercase();
    let known = UNITS.iter().find(|(names, _)| names.contains(&wanted.as_str()));
    known.map(|(_, metres)| *metres).ok_or_else(|| {
        let names: Vec<String> = UNITS.iter().map(|(names, _)| format!("`{}`", names[0])).collect();
        format!(
            "`{name}` is no unit of length that is known: give the scene's `unit` as one of {}",
            names.join(", ")
        )
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn units_have_their_lengths() {
        for (name, metres) in [("m", 1.0), ("KM", 1e3), ("Millimeters", 1e-3), (" µm ", 1e-6), ("ft", 0.3048)]
        {
            assert_eq!(unit_in_metres(name), Ok(metres), "{name}");
        }
        let message = unit_in_metres("furlong\n").unwrap_err();
        assert!(message.contains("`unit` as one of `m`, `km`"), "{message}");
    }
}
