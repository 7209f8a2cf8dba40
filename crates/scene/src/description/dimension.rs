//! Which numbers of a scene are lengths, which are per length, and which are angles.
//!
//! A scene file holds plain numbers in the scene's units. Programs that give quantities with units learn here what to make of
//! them; the test holds the lists against the schema, so that a new key cannot be forgotten.

/// What a number of the scene is measured in.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Dimension {
    /// Scene units.
    Length,
    /// Per scene unit.
    PerLength,
    /// Degrees.
    Angle,
    /// Neither: a ratio, a count, a radiance, or a number whose key names its unit.
    Plain,
}

const LENGTHS: &[&str] = &[
    "camera.position",
    "camera.target",
    "camera.height",
    "camera.aperture_radius",
    "camera.focus_distance",
    "medium.mean_free_path",
    "volume.mean_free_path",
    "volume.box.min",
    "volume.box.max",
    "volume.sphere.center",
    "volume.sphere.radius",
    "volume.slab.bottom",
    "volume.slab.top",
    "volume.atmosphere.bottom",
    "volume.atmosphere.top",
    "volume.atmosphere.scale_height",
    "volume.procedural.center",
    "volume.procedural.size",
    "volume.transform.translate",
    "shape.transform.translate",
    "shape.instances.translate",
    "shape.mesh.vertices",
    "shape.sphere.center",
    "shape.sphere.radius",
    "shape.box.min",
    "shape.box.max",
    "shape.rectangle.corner",
    "shape.rectangle.u",
    "shape.rectangle.v",
    "shape.disc.center",
    "shape.disc.radius",
    "shape.disc.inner_radius",
    "shape.cylinder.from",
    "shape.cylinder.to",
    "shape.cylinder.radius",
    "shape.plane.point",
    "light.position",
    "meter.position",
    "meter.bottom",
    "meter.top",
    "meter.periodic",
];

const PER_LENGTH: &[&str] =
    &["medium.mu_t", "medium.mu_a", "medium.mu_s", "volume.mu_t", "volume.mu_a", "volume.mu_s"];

const ANGLES: &[&str] = &[
    "camera.vertical_fov",
    "volume.transform.rotate",
    "shape.transform.rotate",
    "shape.instances.rotate",
    "light.angle",
    "light.inner_angle",
    "light.angular_diameter",
    "light.rotation",
    "light.sun_azimuth",
    "light.sun_elevation",
    "meter.radiance",
];

/// What the numbers at a path are measured in; `path` holds keys only, no places in arrays: `["volume", "box", "min"]`.
pub fn dimension(path: &[&str]) -> Dimension {
    // Of a quantity by wavelength the values are what it is.
    let quantity = match path {
        [quantity @ .., "value" | "values"] => quantity,
        path => path,
    };
    let key = quantity.join(".");
    let is_in = |keys: &[&str]| keys.contains(&key.as_str());
    match () {
        () if is_in(LENGTHS) => Dimension::Length,
        () if is_in(PER_LENGTH) => Dimension::PerLength,
        () if is_in(ANGLES) => Dimension::Angle,
        () => Dimension::Plain,
    }
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use serde_json::Value;

    use super::*;
    use crate::json_schema;

    /// The other keys with numbers, or their beginnings up to a point.
    const PLAIN: &[&str] = &[
        "camera.direction",
        "camera.up",
        // In scene units only of an orthographic camera.
        "camera.window",
        "film.",
        "render.",
        "material.",
        "shape.material.",
        "shape.emission.",
        "shape.id",
        "shape.transform.scale",
        "shape.transform.matrix",
        "shape.instances.scale",
        "shape.instances.matrix",
        "shape.mesh.normals",
        "shape.mesh.triangles",
        "shape.mesh.uvs",
        "shape.disc.normal",
        "shape.plane.normal",
        "light.altitude",
        "light.direction",
        // A matrix.
        "light.orientation",
        "light.toward_sun",
        "light.ground_albedo",
        "light.turbidity",
        "light.scale",
        "light.intensity",
        "light.irradiance",
        "light.radiance",
        "meter.direction",
        "meter.normal",
        "meter.bins",
        "meter.columns",
        "meter.ground_albedo",
        "volume.raw_shape",
        "volume.transform.scale",
        "volume.transform.matrix",
        "volume.procedural.seed",
        "volume.procedural.resolution",
        "volume.emission_grid.scale",
        "volume.emission_scale",
        "volume.temperature.",
    ];
    const PLAIN_OF_MEDIA: &[&str] =
        &["albedo", "reflectance", "scale", "emission", "emission_per_length", "particles.", "phase."];

    fn is_plain(key: &str) -> bool {
        let fits =
            |key: &str, pattern: &str| key == pattern || pattern.ends_with('.') && key.starts_with(pattern);
        let of_medium = key.strip_prefix("volume.").or(key.strip_prefix("medium."));
        PLAIN.iter().any(|pattern| fits(key, pattern))
            || of_medium.is_some_and(|key| PLAIN_OF_MEDIA.iter().any(|pattern| fits(key, pattern)))
    }

    /// The paths of all numbers, without what tells a quantity by wavelength or a texture.
    fn numbers(schema: &Value, path: &[&str], found: &mut BTreeSet<String>) {
        if let Some(branches) = schema.get("anyOf").or(schema.get("oneOf")).and_then(Value::as_array) {
            branches.iter().for_each(|branch| numbers(branch, path, found));
        }
        if let Some("number" | "integer") = schema["type"].as_str() {
            found.insert(path.join("."));
        }
        if let Some(items) = schema.get("items") {
            numbers(items, path, found);
        }
        let Some(properties) = schema.get("properties").and_then(Value::as_object) else { return };
        let is_spectrum = properties.contains_key("wavelengths");
        for (key, property) in properties.iter().filter(|_| !is_spectrum) {
            numbers(property, &[path, &[key.as_str()]].concat(), found);
        }
    }

    #[test]
    fn every_number_of_the_schema_is_known_and_every_known_one_is_there() {
        let mut found = BTreeSet::new();
        numbers(&json_schema(), &[], &mut found);
        for key in &found {
            let path: Vec<&str> = key.split('.').collect();
            let is_measured = dimension(&path) != Dimension::Plain;
            assert!(is_measured != is_plain(key), "`{key}`: say in one list what it is measured in");
        }
        for key in [LENGTHS, PER_LENGTH, ANGLES].concat() {
            assert!(found.contains(key), "`{key}` is no number of the schema");
        }
    }

    #[test]
    fn values_by_wavelength_are_measured_as_the_quantity_is() {
        assert_eq!(dimension(&["volume", "mu_t", "values"]), Dimension::PerLength);
        assert_eq!(dimension(&["volume", "mu_t", "wavelengths"]), Dimension::Plain);
        assert_eq!(dimension(&["medium", "mean_free_path", "value"]), Dimension::Length);
    }
}
