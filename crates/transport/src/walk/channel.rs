//! Media in one channel: a packet carries one number, so that of coloured media one colour is measured at a time.

use std::sync::Arc;

use tyndall_scene::{Channels, Fields, Medium, Volume};

/// The volumes as `channel` (0 red, 1 green, 2 blue) sees them: grey.
///
/// # Errors
/// The name of a volume that depends on colour, if no channel is chosen.
pub fn in_one_channel(volumes: &[Volume], channel: Option<usize>) -> Result<Vec<Volume>, String> {
    let grey = |volume: &Volume| {
        let chosen = match channel {
            Some(channel) => channel,
            None if is_grey(volume) => 0,
            None => return Err(volume.name.clone()),
        };
        let medium = volume.medium.in_channels(&Channels::Rgb);
        let phase_function = medium.phases.of(chosen).clone();
        let medium = Medium::grey(medium.mu_t[chosen], medium.albedo[chosen], phase_function);
        let fields = volume.fields.as_deref().map(|fields| {
            let albedo = fields.albedo.as_ref().map(|channels| [0; 3].map(|_| channels[chosen].clone()));
            Arc::new(Fields { albedo, ..fields.clone() })
        });
        Ok(Volume { medium, fields, ..volume.clone() })
    };
    let volumes: Result<Vec<Volume>, String> = volumes.iter().map(grey).collect();
    // Nothing collides where there is no extinction.
    volumes.map(|volumes| volumes.into_iter().filter(|volume| volume.medium.mu_t > 0.0).collect())
}

fn is_grey(volume: &Volume) -> bool {
    let medium = &volume.medium;
    let has_colours = volume.fields.as_ref().is_some_and(|fields| fields.albedo.is_some());
    medium.chromatic.is_none() && medium.albedo.min_element() == medium.albedo.max_element() && !has_colours
}
