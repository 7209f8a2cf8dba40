//! Numbers as they count: those nearer to 0 than 1e-37 are 0. Single floats hardly hold them, and their reciprocals and
//! squares are lost in floating point.

use toml::Value;

use crate::SceneDescription;

/// The number as it counts.
pub(crate) fn counted(number: f64) -> f64 {
    if number.abs() < 1e-37 { 0.0_f64.copysign(number) } else { number }
}

impl SceneDescription {
    /// The description with its numbers as they count, as if it had been read from its own scene file.
    pub fn with_counted_numbers(self) -> Self {
        let Ok(mut tree) = Value::try_from(&self) else { return self };
        if count_within(&mut tree) { tree.try_into().unwrap_or(self) } else { self }
    }
}

/// Whether any number below counts as another than it is; then it is changed.
fn count_within(value: &mut Value) -> bool {
    match value {
        Value::Float(number) => {
            let before = std::mem::replace(number, counted(*number));
            before.to_bits() != number.to_bits()
        }
        Value::Array(values) => {
            values.iter_mut().filter_map(|value| count_within(value).then_some(())).count() > 0
        }
        Value::Table(table) => {
            table.iter_mut().filter_map(|(_, value)| count_within(value).then_some(())).count() > 0
        }
        _ => false,
    }
}

#[cfg(test)]
mod tests {
    use crate::SceneDocument;

    #[test]
    fn a_description_counts_its_numbers_as_its_scene_file_does() {
        let text = "[camera]\nposition = [0, 0, 1]\ntarget = [0, 0, 0]\naperture_radius = 0.5";
        let mut description = SceneDocument::parse("test", text).unwrap().description().unwrap();
        assert_eq!(description.clone().with_counted_numbers(), description);
        description.camera.aperture_radius = 1e-310;
        let counted = description.with_counted_numbers();
        assert_eq!(counted.camera.aperture_radius, 0.0);
        let read = SceneDocument::parse("test", &counted.to_toml()).unwrap().description().unwrap();
        assert_eq!(read, counted);
    }
}
