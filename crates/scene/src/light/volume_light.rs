//! Stub.

use glam::DVec3;

/// A volume that glows.
#[derive(Debug, Clone)]
pub struct VolumeLight {
    volume: usize,
}

/// A point in a glowing volume.
#[derive(Debug, Clone, Copy)]
pub struct VolumeLightSample {
    /// Where.
    pub position: DVec3,
    /// Density per volume.
    pub pdf_volume: f64,
}

impl VolumeLight {
    /// Number of the volume.
    pub fn volume(&self) -> usize {
        self.volume
    }
    /// A point.
    pub fn sample(&self, _from: DVec3, _u: [f64; 3]) -> VolumeLightSample {
        VolumeLightSample { position: DVec3::ZERO, pdf_volume: 0.0 }
    }
    /// Density.
    pub fn pdf_volume(&self, _position: DVec3) -> f64 {
        0.0
    }
}
