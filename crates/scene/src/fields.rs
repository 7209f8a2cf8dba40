//! What varies from place to place in a volume beside its density: emission, temperature, albedo.
//!
//! All are looked up where a path collides, so that tracking a ray through the density knows nothing of them. A field is
//! the filtered value of its grid; a temperature's light is that of the filtered temperature, B(λ, scale · value + offset).

use glam::{DAffine3, DVec3};
use std::sync::Arc;
use tyndall_optics::planck::{self, BlackbodyColours};
use tyndall_volumes::BrickGrid;

use crate::medium::box_interval;
use crate::{Density, Ray, Volume};

/// A scalar grid that stands somewhere.
#[derive(Debug, Clone)]
pub struct Field {
    /// World space to the coordinates of the grid's filter.
    pub world_to_local: DAffine3,
    /// The grid.
    pub grid: Arc<BrickGrid>,
}

/// A temperature at each place.
#[derive(Debug, Clone)]
pub struct TemperatureField {
    /// The grid's values.
    pub field: Field,
    /// Kelvin for each unit of them.
    pub scale: f64,
    /// Kelvin where they are 0.
    pub offset: f64,
    /// Factor on Planck's radiance, W/(m² sr nm), or on the normalised one.
    pub radiance_scale: f64,
    /// Whether every black body's spectrum is scaled to 1 where it is greatest.
    pub normalised: bool,
    /// Colours of black bodies in RGB.
    pub colours: Arc<BlackbodyColours>,
}

/// The grids of a volume beside its density.
#[derive(Debug, Clone, Default)]
pub struct Fields {
    /// Multiplies the emission; a factor on the grid's values goes with it. None of its values is negative.
    pub emission: Option<(Field, f64)>,
    /// Adds a black body's light to the emitted radiance Le.
    pub temperature: Option<TemperatureField>,
    /// Multiplies the albedo of red, green and blue; between 0 and 1.
    pub albedo: Option<[Field; 3]>,
}

impl Field {
    /// The value at a place in the world; outside the grid's domain its background.
    pub fn value(&self, position: DVec3) -> f64 {
        let local = self.world_to_local.transform_point3(position);
        let [min, max] = self.grid.domain();
        if local.cmpge(min).all() && local.cmple(max).all() {
            self.grid.value(local)
        } else {
            f64::from(self.grid.background())
        }
    }

    /// The distances between which the local ray is inside the grid's domain, cut to those from `start` to `end`.
    pub fn interval(&self, local: &Ray, (start, end): (f64, f64)) -> Option<(f64, f64)> {
        let [min, max] = self.grid.domain();
        let (enter, leave) = box_interval(local, min, max)?;
        let (enter, leave) = (enter.max(start), leave.min(end));
        (enter < leave).then_some((enter, leave))
    }

    /// The ray in the coordinates of the grid's filter; distances along it stay those of the world.
    pub fn local_ray(&self, ray: &Ray) -> Ray {
        Ray {
            origin: self.world_to_local.transform_point3(ray.origin),
            direction: self.world_to_local.transform_vector3(ray.direction),
        }
    }
}

impl TemperatureField {
    /// Temperature at a place, K.
    pub fn kelvin(&self, position: DVec3) -> f64 {
        self.scale * self.field.value(position) + self.offset
    }

    /// What Planck's radiance at a temperature is multiplied by. Normalised bodies of 100 K and below are black, so that
    /// what is cold does not glow at all.
    pub fn radiance_factor(&self, kelvin: f64) -> f64 {
        match self.normalised {
            false => self.radiance_scale,
            true if kelvin > 100.0 => self.radiance_scale / planck::greatest_radiance(kelvin),
            true => 0.0,
        }
    }
}

impl Volume {
    /// Single-scattering albedo of red, green and blue at a place.
    pub fn albedo_at(&self, position: DVec3) -> DVec3 {
        self.medium.albedo * self.albedo_factor(position)
    }

    /// Emitted radiance Le of red, green and blue at a place.
    pub fn emission_at(&self, position: DVec3) -> DVec3 {
        let Some(fields) = &self.fields else { return self.medium.emission };
        let factor = self.emission_factor(position);
        if factor == 0.0 {
            return DVec3::ZERO;
        }
        let glow = fields.temperature.as_ref().map_or(DVec3::ZERO, |temperature| {
            let kelvin = temperature.kelvin(position);
            temperature.colours.at(kelvin) * temperature.radiance_factor(kelvin)
        });
        (self.medium.emission + glow) * factor
    }

    /// What multiplies the emission at a place.
    pub fn emission_factor(&self, position: DVec3) -> f64 {
        let emission = self.fields.as_ref().and_then(|fields| fields.emission.as_ref());
        emission.map_or(1.0, |(field, scale)| field.value(position) * scale)
    }

    /// What multiplies the emission per length at any place: the emission grid if there is one, the density otherwise.
    pub fn emission_per_length_factor(&self, position: DVec3) -> f64 {
        let local = self.world_to_local.transform_point3(position);
        if self.fields.as_ref().is_none_or(|fields| fields.emission.is_none()) {
            return self.density_anywhere(local);
        }
        // Beside a grid of densities there may be flames as well.
        let is_lit = matches!(self.density, Density::Grid(_)) || self.contains(local);
        if is_lit { self.emission_factor(position) } else { 0.0 }
    }

    /// What multiplies the albedo of red, green and blue at a place.
    pub fn albedo_factor(&self, position: DVec3) -> DVec3 {
        let albedo = self.fields.as_ref().and_then(|fields| fields.albedo.as_ref());
        albedo.map_or(DVec3::ONE, |[red, green, blue]| {
            DVec3::new(red.value(position), green.value(position), blue.value(position))
        })
    }

    /// Whether the volume sends out light of its own.
    pub fn glows(&self) -> bool {
        self.medium.emission != DVec3::ZERO
            || self.medium.emission_per_length != DVec3::ZERO
            || self.fields.as_ref().is_some_and(|fields| fields.temperature.is_some())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DMat3;
    use tyndall_optics::cie;
    use tyndall_volumes::{GridClass, GridValues, Storage, Tile, Tree};

    fn temperatures(kelvin: f32, normalised: bool) -> TemperatureField {
        let tile = Tile { origin: [0; 3], log2_edge: 3, value: kelvin, active: true };
        let grid = tyndall_volumes::Grid {
            name: "temperature".to_owned(),
            class: GridClass::Unknown,
            index_to_world: DAffine3::IDENTITY,
            saved_as_half: false,
            codec: String::new(),
            metadata: Vec::new(),
            values: GridValues::Float(Tree {
                background: 0.0,
                tiles: vec![tile],
                leaves: Vec::new(),
                leaf_values: Vec::new(),
            }),
        };
        let grid = Arc::new(BrickGrid::new(&grid, Storage::F32).expect("the grid is small"));
        let world_to_local = DAffine3::from_mat3(DMat3::IDENTITY);
        TemperatureField {
            field: Field { world_to_local, grid },
            scale: 1.0,
            offset: 0.0,
            radiance_scale: 3.0,
            normalised,
            colours: Arc::new(BlackbodyColours::new()),
        }
    }

    #[test]
    fn a_normalised_black_body_has_the_scale_for_its_greatest_radiance() {
        let field = temperatures(2500.0, true);
        let kelvin = field.kelvin(DVec3::splat(3.5));
        assert_eq!(kelvin, 2500.0);
        let best = (100..5000).map(|nm| planck::radiance(f64::from(nm), kelvin)).fold(0.0, f64::max);
        assert!((best * field.radiance_factor(kelvin) / 3.0 - 1.0).abs() < 1e-5);
        assert_eq!(temperatures(2500.0, false).radiance_factor(kelvin), 3.0);
        // Its colour is that of the body, its luminance that of a spectrum whose peak is the scale.
        let colour = field.colours.at(kelvin) * field.radiance_factor(kelvin);
        let expected = 3.0 * cie::xyz(|nm| planck::radiance(nm, kelvin) / best).y;
        assert!((cie::luminance(colour) / expected - 1.0).abs() < 1e-4, "{colour} {expected}");
    }

    #[test]
    fn what_is_cold_does_not_glow() {
        let field = temperatures(90.0, true);
        for kelvin in [90.0, 0.0, -10.0, f64::NAN] {
            assert_eq!(field.radiance_factor(kelvin), 0.0);
        }
    }
}
