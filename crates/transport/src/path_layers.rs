//! A path's contributions, in three colours or four channels, by what made them.

use std::ops::{Add, AddAssign, Mul};

use glam::DVec3;
use tyndall_film::Sample;

/// A path's contributions in the channels `C`.
#[derive(Debug, Default)]
pub(crate) struct PathLayers<C> {
    /// What media sent out.
    pub emission: C,
    /// What the camera ray met first.
    pub first: Option<FirstMet>,
    background: C,
    single: C,
    multiple: C,
}

/// Light that next-event estimation brings.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct DirectLight<C> {
    /// What arrives and is sent on, before the weight of the path.
    pub radiance: C,
    /// Whether a medium sent it out.
    pub is_glow: bool,
}

/// What a camera ray meets first: a collision, or a surface.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct FirstMet {
    /// Its distance.
    pub distance: f64,
    /// Its albedo.
    pub albedo: DVec3,
    /// Normal of the surface; 0 of a collision.
    pub normal: DVec3,
    /// Number of the surface's object; 0 of a collision.
    pub object: u32,
    /// Of a shadow catcher, what it reflects: as it is, and if nothing stood in the way.
    pub caught: Option<[f32; 2]>,
}

impl FirstMet {
    /// The sample of a path that met this, or nothing, first.
    pub fn describe(first: Option<FirstMet>, sample: Sample) -> Sample {
        let Some(first) = first else { return sample };
        Sample {
            hit: first.caught.is_none(),
            depth: first.distance as f32,
            albedo: first.albedo.as_vec3().to_array(),
            normal: first.normal.as_vec3().to_array(),
            object: first.object,
            catcher: first.caught.unwrap_or_default(),
            ..sample
        }
    }
}

impl<C: Copy + Add<Output = C> + AddAssign + Mul<Output = C>> PathLayers<C> {
    /// Adds light that media have scattered so many times.
    pub fn add(&mut self, scatterings: u32, radiance: C) {
        match scatterings {
            0 => self.background += radiance,
            1 => self.single += radiance,
            _ => self.multiple += radiance,
        }
    }

    /// Adds what a path of this weight has found by next-event estimation.
    pub fn add_direct(&mut self, scatterings: u32, weight: C, light: DirectLight<C>) {
        let radiance = weight * light.radiance;
        if light.is_glow {
            self.emission += radiance;
        } else {
            self.add(scatterings, radiance);
        }
    }

    /// The film's sample; `colour` makes the film's three channels of the path's.
    pub fn into_sample(self, colour: impl Fn(C) -> DVec3) -> Sample {
        let colour = |channels: C| colour(channels).as_vec3().to_array();
        let sample = Sample {
            radiance: colour(self.background + self.emission + self.single + self.multiple),
            emission: colour(self.emission),
            single: colour(self.single),
            multiple: colour(self.multiple),
            ..Sample::default()
        };
        FirstMet::describe(self.first, sample)
    }
}
