//! The meters of a scene: from their description to what they measure.

use std::sync::atomic::AtomicBool;

use glam::DVec3;
use tyndall_scene::description::{BodyMeterDescription, Channel, LayerMeterDescription, MeterDescription};
use tyndall_scene::{Density, Ray, Scene, Volume};

use crate::walk::{
    Body, BodyPowers, Estimate, Incidence, Layer, LayerFluxes, LightMeter, LightMeterKind, Tile, WalkOptions,
    doubts, in_one_channel, run,
};

/// What a meter has measured, and one line for each reason to doubt its standard errors.
pub type Doubted = (Measurement, Vec<String>);

/// What a meter has measured.
#[derive(Debug, Clone, PartialEq)]
pub enum Measurement {
    /// Of a layer.
    Layer(LayerFluxes),
    /// Of a body.
    Body(BodyPowers),
    /// Irradiance or radiance, red, green and blue; and the number of paths.
    Light([Estimate; 3], u64),
}

impl Measurement {
    /// Number of photons or paths.
    pub fn samples(&self) -> u64 {
        match self {
            Self::Layer(fluxes) => fluxes.samples,
            Self::Body(powers) => powers.samples,
            Self::Light(_, samples) => *samples,
        }
    }
}

/// Measures in `scene` until the goal is reached or `cancel` is set.
///
/// # Errors
/// A sentence, if the scene is not one that this meter can measure.
pub fn measure(
    scene: &Scene,
    meter: &MeterDescription,
    options: &WalkOptions,
    cancel: &AtomicBool,
) -> Result<Doubted, String> {
    match meter {
        MeterDescription::Layer(meter) => layer(scene, meter, options, cancel),
        MeterDescription::Body(meter) => body(scene, meter, options, cancel),
        MeterDescription::Irradiance(meter) => {
            let normal = DVec3::from_array(meter.normal).normalize();
            let position = DVec3::from_array(meter.position);
            light(scene, LightMeterKind::Irradiance { position, normal }, options, cancel)
        }
        MeterDescription::Radiance(meter) => {
            let direction = DVec3::from_array(meter.direction).normalize();
            let ray = Ray { origin: DVec3::from_array(meter.position), direction };
            light(scene, LightMeterKind::Radiance(ray), options, cancel)
        }
    }
}

fn layer(
    scene: &Scene,
    meter: &LayerMeterDescription,
    options: &WalkOptions,
    cancel: &AtomicBool,
) -> Result<Doubted, String> {
    let volumes = grey(scene, meter.channel)?;
    if meter.periodic.is_none()
        && let Some(volume) = volumes.iter().find(|volume| !is_plane_parallel(volume))
    {
        return Err(format!(
            "`{}` is not the same everywhere in x and z: give the meter a `periodic` tile",
            volume.name
        ));
    }
    let incidence = meter
        .direction
        .map_or(Incidence::Diffuse, |direction| Incidence::Beam(DVec3::from_array(direction).normalize()));
    let layer = Layer {
        volumes: &volumes,
        faces: [meter.bottom, meter.top],
        tile: meter.periodic.map(|[x0, z0, x1, z1]| Tile { min: [x0, z0], max: [x1, z1] }),
        incidence,
        refractive_index: 1.0,
        ground_albedo: meter.ground_albedo,
        columns: meter.columns.map(|columns| columns.map(|n| n as usize)),
        views: meter.radiance.iter().map(|&angles| direction_of(angles)).collect(),
        depth_limit: None,
    };
    let tallies = run(&layer, options, cancel);
    let doubts = doubts(&tallies, layer.radiance_tallies());
    Ok((Measurement::Layer(layer.fluxes(&tallies)), doubts))
}

fn body(
    scene: &Scene,
    meter: &BodyMeterDescription,
    options: &WalkOptions,
    cancel: &AtomicBool,
) -> Result<Doubted, String> {
    let volumes = grey(scene, meter.channel)?;
    let direction = DVec3::from_array(meter.direction).normalize();
    let body = Body::new(volumes, direction, meter.bins as usize)?;
    let tallies = run(&body, options, cancel);
    // Each photon brings 1 at most to what becomes of the light: rare ones cannot weigh much.
    Ok((Measurement::Body(body.powers(&tallies)), doubts(&tallies, [])))
}

fn light(
    scene: &Scene,
    kind: LightMeterKind,
    options: &WalkOptions,
    cancel: &AtomicBool,
) -> Result<Doubted, String> {
    if scene.is_chromatic() && matches!(kind, LightMeterKind::Irradiance { .. }) {
        return Err(
            "irradiance is not measured yet where extinction depends on colour: measure `radiance`, or make \
                    the extinction grey"
                .into(),
        );
    }
    let meter = LightMeter { scene, kind };
    let tallies = run(&meter, options, cancel);
    let doubts = doubts(&tallies, (0..).zip(["red", "green", "blue"]));
    Ok((Measurement::Light(meter.values(&tallies), tallies.photons()), doubts))
}

fn grey(scene: &Scene, channel: Option<Channel>) -> Result<Vec<Volume>, String> {
    let channel = channel.map(|channel| match channel {
        Channel::Red => 0,
        Channel::Green => 1,
        Channel::Blue => 2,
    });
    in_one_channel(&scene.volumes, channel).map_err(|name| {
        format!("`{name}` depends on colour: give the meter a `channel`, \"red\", \"green\" or \"blue\"")
    })
}

/// Whether the density depends on the height alone.
fn is_plane_parallel(volume: &Volume) -> bool {
    match volume.density {
        Density::Everywhere => true,
        Density::Slab { .. } | Density::Atmosphere { .. } => {
            let map = volume.world_to_local.matrix3;
            map.x_axis.y == 0.0 && map.z_axis.y == 0.0
        }
        Density::Box { .. } | Density::Sphere | Density::Grid(_) => false,
    }
}

/// The unit vector at `theta` from +y and `phi` about it, degrees.
fn direction_of([theta, phi]: [f64; 2]) -> DVec3 {
    let (sin_theta, cos_theta) = libm::sincos(theta.to_radians());
    let (sin_phi, cos_phi) = libm::sincos(phi.to_radians());
    DVec3::new(sin_theta * cos_phi, cos_theta, sin_theta * sin_phi)
}
