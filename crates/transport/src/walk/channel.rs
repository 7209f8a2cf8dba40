//! Media in one channel: a packet carries one number, so that of coloured media one colour is measured at a time.

use glam::DVec3;
use tyndall_scene::{Channels, Medium, Volume};

/// The volumes as `channel` (0 red, 1 green, 2 blue) sees them: grey.
///
/// # Errors
/// The name of a volume that depends on colour, if no channel is chosen.
pub fn in_one_channel(volumes: &[Volume], channel: Option<usize>) -> Result<Vec<Volume>, String> {
    let grey = |volume: &Volume| {
        let chosen = match channel {
            Some(channel) => channel,
            None if is_grey(&volume.medium) => 0,
            None => return Err(volume.name.clone()),
        };
        let medium = volume.medium.in_channels(&Channels::Rgb);
        let medium = Medium {
            mu_t: medium.mu_t[chosen],
            albedo: DVec3::splat(medium.albedo[chosen]),
            phase_function: medium.phases.of(chosen).clone(),
            emission: DVec3::ZERO,
            chromatic: None,
        };
        Ok(Volume { medium, ..volume.clone() })
    };
    let volumes: Result<Vec<Volume>, String> = volumes.iter().map(grey).collect();
    // Nothing collides where there is no extinction.
    volumes.map(|volumes| volumes.into_iter().filter(|volume| volume.medium.mu_t > 0.0).collect())
}

fn is_grey(medium: &Medium) -> bool {
    medium.chromatic.is_none() && medium.albedo.min_element() == medium.albedo.max_element()
}
