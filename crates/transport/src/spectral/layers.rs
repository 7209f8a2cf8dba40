//! A path's contributions in every channel, by what made them.

use glam::{DVec3, DVec4};
use tyndall_film::Sample;

/// A path's contributions.
#[derive(Debug, Default)]
pub(super) struct Layers {
    pub emission: DVec4,
    background: DVec4,
    single: DVec4,
    multiple: DVec4,
    collision: Option<(f64, DVec3)>,
}

impl Layers {
    /// Notes where the camera's own ray collided, and the albedo there.
    pub(super) fn first_collision(&mut self, distance: f64, albedo: DVec3) {
        self.collision = Some((distance, albedo));
    }

    /// Adds light that arrives after so many scatterings.
    pub(super) fn add_in_scattered(&mut self, scatterings: u32, radiance: DVec4) {
        match scatterings {
            0 => self.background += radiance,
            1 => self.single += radiance,
            _ => self.multiple += radiance,
        }
    }

    /// The film's sample, of which each channel of the path gives so much of the film's three. Coverage, depth and albedo
    /// are those of the collisions of all heroes alike.
    pub(super) fn into_sample(self, film_of_channels: &[DVec3; 4]) -> Sample {
        let colour = |channels: DVec4| {
            let parts = film_of_channels.iter().zip(channels.to_array());
            parts.map(|(film, channel)| *film * channel).sum::<DVec3>().as_vec3().to_array()
        };
        let (depth, albedo) = self.collision.unwrap_or_default();
        Sample {
            radiance: colour(self.background + self.emission + self.single + self.multiple),
            hit: self.collision.is_some(),
            depth: depth as f32,
            albedo: albedo.as_vec3().to_array(),
            emission: colour(self.emission),
            single: colour(self.single),
            multiple: colour(self.multiple),
            ..Sample::default()
        }
    }
}
