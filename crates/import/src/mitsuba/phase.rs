//! `<phase>`: phase functions.
//!
//! Blends are flattened to weights of simple ones. Two Henyey-Greenstein lobes are said as such; whatever else there is
//! becomes a table of angles, dense where it is steep.

use std::fmt::Write as _;

use tyndall_scene::description::PhaseDescription;

use super::importer::Importer;
use super::object::{Class, Object, Value};
use super::text;
use crate::ImportError;

/// A phase function that is no blend.
#[derive(Debug, Clone, PartialEq)]
enum Simple {
    /// Henyey and Greenstein's of this mean cosine; isotropic if 0.
    HenyeyGreenstein(f64),
    Rayleigh,
    /// Values at cosines from −1 to 1, equally far apart, of integral 1.
    Table(Vec<f64>),
}

impl<'a> Importer<'a> {
    /// The phase function of an object; none if it is isotropic.
    pub fn phase(&mut self, number: usize) -> Result<Option<PhaseDescription>, ImportError> {
        let mut parts = Vec::new();
        self.parts(number, 1.0, &mut parts)?;
        parts.retain(|(weight, _)| *weight > 0.0);
        Ok(match parts.as_slice() {
            [] | [(_, Simple::HenyeyGreenstein(0.0))] => None,
            [(_, Simple::HenyeyGreenstein(g))] => Some(PhaseDescription::Hg { g: *g }),
            [(_, Simple::Rayleigh)] => Some(PhaseDescription::Rayleigh),
            [(weight, Simple::HenyeyGreenstein(g1)), (_, Simple::HenyeyGreenstein(g2))] => {
                Some(PhaseDescription::DoubleHg { g1: *g1, g2: *g2, weight: *weight })
            }
            parts => Some(self.tabulated(number, parts)?),
        })
    }

    /// Adds the phase functions that an object is made of, with their weights.
    fn parts(
        &mut self,
        number: usize,
        weight: f64,
        parts: &mut Vec<(f64, Simple)>,
    ) -> Result<(), ImportError> {
        let object = self.object(number);
        match object.plugin.as_str() {
            "isotropic" => parts.push((weight, Simple::HenyeyGreenstein(0.0))),
            "hg" => {
                let g = object.float("g", 0.8)?;
                if g.abs() >= 1.0 {
                    return Err(object.place.error(format!("`g` must be between -1 and 1, and not {g}")));
                }
                parts.push((weight, Simple::HenyeyGreenstein(g)));
            }
            "rayleigh" => parts.push((weight, Simple::Rayleigh)),
            "tabphase" => parts.push((weight, table(object)?)),
            "blendphase" => {
                let second = self.blend_weight(object)?;
                let [one, other] = self.children(object, Class::Phase)[..] else {
                    return Err(object.place.error("a blendphase needs two <phase>s"));
                };
                if parts.len() > 64 {
                    return Err(object.place.error("the blends of phase functions are too many"));
                }
                self.within(number, |importer| {
                    importer.parts(one, weight * (1.0 - second), parts)?;
                    importer.parts(other, weight * second, parts)
                })?;
            }
            "sggx" => {
                let message = "the orientations of an `sggx` vary as a grid says, which is not supported: light is scattered equally in all directions";
                self.unsupported(&object.place, message);
                object.ignore(&["S"]);
                parts.push((weight, Simple::HenyeyGreenstein(0.0)));
            }
            _ => {
                let message = format!(
                    "{} is not supported: light is scattered equally in all directions",
                    object.title()
                );
                self.unsupported(&object.place, message);
                parts.push((weight, Simple::HenyeyGreenstein(0.0)));
                return Ok(());
            }
        }
        self.tell_unused(object);
        Ok(())
    }

    /// The share of a blend's second phase function.
    fn blend_weight(&mut self, object: &'a Object) -> Result<f64, ImportError> {
        let Some(property) = object.get("weight") else {
            return Err(object.place.error("the blendphase has no `weight`: add it"));
        };
        if let Value::Object(number) = property.value {
            let volume = self.object(number);
            if volume.plugin == "constvolume" {
                return Ok(volume.float("value", 1.0)?.clamp(0.0, 1.0));
            }
            self.unsupported(&property.place, "a `weight` that varies is not supported: 0.5 is taken");
            return Ok(0.5);
        }
        Ok(object.float("weight", 0.5)?.clamp(0.0, 1.0))
    }

    fn tabulated(&mut self, number: usize, parts: &[(f64, Simple)]) -> Result<PhaseDescription, ImportError> {
        let object = self.object(number);
        let cosines = match parts {
            [(_, Simple::Table(values))] => equal_steps(values.len()),
            parts => {
                let tables = parts.iter().filter_map(|(_, part)| match part {
                    Simple::Table(values) => Some(values.len()),
                    _ => None,
                });
                let message =
                    "a blend of phase functions other than two of Henyey and Greenstein becomes a table";
                self.choice(&object.place, message);
                let mut cosines: Vec<f64> = tables.flat_map(equal_steps).chain(dense_forward()).collect();
                cosines.sort_by(f64::total_cmp);
                cosines.dedup();
                cosines
            }
        };
        let mut text = String::from("cos_theta,value\n");
        for cosine in cosines {
            let value: f64 = parts.iter().map(|(weight, part)| weight * part.value(cosine)).sum();
            // Writing to a string cannot fail.
            let _ = writeln!(text, "{},{value}", cosine.clamp(-1.0, 1.0));
        }
        let name = object.id.as_deref().unwrap_or("phase");
        let file = self.sidecar.write_copy(name, "csv", &mut text.as_bytes())?;
        Ok(PhaseDescription::Tabulated { file: file.to_string_lossy().into_owned(), wavelength_nm: None })
    }
}

impl Simple {
    /// Density, 1/sr.
    fn value(&self, cosine: f64) -> f64 {
        use std::f64::consts::PI;
        match self {
            Self::HenyeyGreenstein(g) => {
                let root = 1.0 + g * g - 2.0 * g * cosine;
                (1.0 - g * g) / (4.0 * PI * root * root.sqrt())
            }
            Self::Rayleigh => 3.0 / (16.0 * PI) * (1.0 + cosine * cosine),
            Self::Table(values) => {
                let at = 0.5 * (cosine + 1.0) * (values.len() - 1) as f64;
                let below = (at as usize).min(values.len() - 2);
                let share = at - below as f64;
                values[below] * (1.0 - share) + values[below + 1] * share
            }
        }
    }
}

/// The values of a `tabphase`.
fn table(object: &Object) -> Result<Simple, ImportError> {
    let text = object.text("values")?;
    let text = text.ok_or_else(|| object.place.error("the tabphase has no `values`: add them"))?;
    let mut values = text::numbers(text).map_err(|message| object.place.error(message))?;
    let steps = values.len().saturating_sub(1) as f64;
    let sum: f64 = values.windows(2).map(|pair| 0.5 * (pair[0] + pair[1])).sum();
    let integral = 4.0 * std::f64::consts::PI * sum / steps.max(1.0);
    let is_sound = values.iter().all(|value| *value >= 0.0) && integral > 0.0 && integral.is_finite();
    if !is_sound {
        return Err(object.place.error("the `values` must be two at least, none below 0 and not all 0"));
    }
    for value in &mut values {
        *value /= integral;
    }
    Ok(Simple::Table(values))
}

/// So many cosines from −1 to 1.
fn equal_steps(count: usize) -> Vec<f64> {
    (0..count).map(|step| -1.0 + 2.0 * step as f64 / (count.max(2) - 1) as f64).collect()
}

/// Cosines that come close to each other near 1 and −1, where lobes are steep.
fn dense_forward() -> impl Iterator<Item = f64> {
    (0..=1800).map(|step| {
        // A quarter of a degree apart in the middle; the steps shrink towards both ends.
        let x = f64::from(step) / 900.0 - 1.0;
        let angle = std::f64::consts::FRAC_PI_2 * (1.0 - x * (1.5 - 0.5 * x * x));
        libm::cos(angle)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn simple_phase_functions_integrate_to_one() {
        let table =
            Simple::Table(vec![0.5 / (4.0 * std::f64::consts::PI), 1.5 / (4.0 * std::f64::consts::PI)]);
        for phase in [Simple::HenyeyGreenstein(0.7), Simple::Rayleigh, table] {
            let n = 20_000;
            let step = 2.0 / f64::from(n);
            let sum: f64 = (0..n).map(|i| phase.value(-1.0 + (f64::from(i) + 0.5) * step)).sum();
            assert!((2.0 * std::f64::consts::PI * sum * step - 1.0).abs() < 1e-6, "{phase:?}");
        }
    }

    #[test]
    fn the_cosines_of_a_table_reach_both_ends_and_are_dense_there() {
        let cosines: Vec<f64> = dense_forward().collect();
        assert!((cosines[0] + 1.0).abs() < 1e-12 && (cosines[1800] - 1.0).abs() < 1e-12);
        assert!(cosines.windows(2).all(|pair| pair[0] < pair[1]));
        let last = cosines[1799].acos().to_degrees();
        assert!(last < 1e-3, "{last}");
    }
}
