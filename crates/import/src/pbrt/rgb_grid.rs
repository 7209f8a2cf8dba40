//! A medium whose coefficients are colours from cell to cell: several volumes, which overlap and add.
//!
//! Where all cells have the same hue, one grid of numbers times that colour says the same; otherwise each channel has a
//! grid of its own. Absorption and scattering are interpolated apart, and so stay volumes of their own unless they are
//! proportional to each other.

use tyndall_optics::cie::Y_INTEGRAL_NM;
use tyndall_scene::description::{
    BoxShape, EmissionGridDescription, MediumDescription, SpectrumDescription, VolumeDescription,
};

use super::grids::{Cells, Lattice};
use super::media::{Corners, EVERYWHERE, Maker, Matter, emission_grid};
use super::parameters::Kind;
use super::spectra;
use super::transforms;
use crate::ImportError;

/// Colours of cells.
type Colours = Vec<[f64; 3]>;

/// A grid of numbers times a colour.
struct Tinted {
    cells: Cells,
    colour: [f64; 3],
    /// End of the names of files.
    suffix: String,
}

impl Maker<'_> {
    pub(super) fn rgb_grid(&self) -> Result<Matter, ImportError> {
        let lattice = self.lattice()?;
        let [sigma_a, sigma_s, glow] =
            [self.colours("sigma_a")?, self.colours("sigma_s")?, self.colours("Le")?];
        let place = &self.entity.place;
        if sigma_a.is_none() && sigma_s.is_none() {
            return Err(place.error("an \"rgbgrid\" needs `sigma_a` or `sigma_s`"));
        }
        if glow.is_some() && sigma_a.is_none() {
            return Err(place.error("an \"rgbgrid\" with `Le` needs `sigma_a`"));
        }
        let scale = self.scale()?;
        let glow_scale = self.entity.parameters.float_or("Lescale", 1.0)?.max(0.0);
        let glow_scale = glow_scale * self.exposure * Y_INTEGRAL_NM;
        let phase = self.phase()?;
        let medium = |mu_a: [f64; 3], mu_s: [f64; 3]| MediumDescription {
            mu_a: Some(spectra::grey_or_channels(mu_a)),
            mu_s: Some(spectra::grey_or_channels(mu_s)),
            scale: Some(scale).filter(|scale| *scale != 1.0),
            phase: phase.clone(),
            ..MediumDescription::default()
        };
        let mut volumes = Vec::new();
        let mut support = None;
        let parts: Vec<(Tinted, bool)> = match (&sigma_a, &sigma_s) {
            (Some(a), Some(s)) if glow.is_none() => match self.proportional(lattice, a, s)? {
                Some((tinted, mu_s)) => {
                    support = grown(support, &tinted.cells);
                    volumes.extend(self.volume("", &tinted.cells, medium(tinted.colour, mu_s))?);
                    Vec::new()
                }
                None => self.both(lattice, a, s)?,
            },
            (a, s) => {
                let mut parts = Vec::new();
                if let Some(a) = a {
                    let by_channel = glow.as_ref().is_some_and(|glow| hue(glow).is_none());
                    parts.extend(
                        self.tinted(lattice, a, "_absorption", by_channel)?.into_iter().map(|t| (t, true)),
                    );
                }
                if let Some(s) = s {
                    parts.extend(
                        self.tinted(lattice, s, "_scattering", false)?.into_iter().map(|t| (t, false)),
                    );
                }
                parts
            }
        };
        for (part, absorbs) in parts {
            let (mu_a, mu_s) = if absorbs { (part.colour, [0.0; 3]) } else { ([0.0; 3], part.colour) };
            let Some(mut volume) = self.volume(&part.suffix, &part.cells, medium(mu_a, mu_s))? else {
                continue;
            };
            if let Some(glow) = glow.as_ref().filter(|_| absorbs && glow_scale > 0.0) {
                let (emission, grid) = self.glow(lattice, glow, &part, glow_scale)?;
                volume.medium.emission = emission;
                volume.emission_grid = grid;
            }
            support = grown(support, &part.cells);
            volumes.push(volume);
        }
        // The coefficient that is not given is 1 in the whole box.
        if sigma_a.is_none() || sigma_s.is_none() {
            let [mu_a, mu_s] = [&sigma_a, &sigma_s].map(|given| [if given.is_none() { 1.0 } else { 0.0 }; 3]);
            let [min, max] = lattice.bounds.map(|corner| corner.to_array());
            volumes.push(VolumeDescription {
                cuboid: Some(BoxShape { min, max }),
                transform: transforms::description(&self.to_world),
                medium: medium(mu_a, mu_s),
                ..VolumeDescription::default()
            });
            support =
                support.map(|[min, max]: Corners| [min.min(lattice.bounds[0]), max.max(lattice.bounds[1])]);
            support = support.or(Some(lattice.bounds));
        }
        if volumes.is_empty() {
            self.tell_empty();
        }
        let support = support.unwrap_or(EVERYWHERE);
        Ok(Matter::Grids { volumes, bounds: Some(lattice.bounds), support })
    }

    fn colours(&self, name: &str) -> Result<Option<Colours>, ImportError> {
        let Some(parameter) = self.entity.parameters.find(name, &[Kind::Rgb]) else { return Ok(None) };
        let (colours, rest) = parameter.numbers().as_chunks::<3>();
        if !rest.is_empty() || colours.as_flattened().iter().any(|value| *value < 0.0) {
            return Err(parameter.error("needs three numbers for each cell, at least 0"));
        }
        Ok(Some(colours.to_vec()))
    }

    fn cells_of(
        &self,
        lattice: Lattice,
        colours: &Colours,
        channel: impl Fn(&[f64; 3]) -> f64,
    ) -> Result<Cells, ImportError> {
        Cells::new(lattice, colours.iter().map(channel))
            .map_err(|message| self.entity.place.error(format!("the grid {message}")))
    }

    /// One grid if all cells have the same hue, else one a channel.
    fn tinted(
        &self,
        lattice: Lattice,
        colours: &Colours,
        suffix: &str,
        by_channel: bool,
    ) -> Result<Vec<Tinted>, ImportError> {
        if let Some(colour) = hue(colours).filter(|_| !by_channel) {
            let cells = self.cells_of(lattice, colours, greatest)?;
            return Ok(vec![Tinted { cells, colour, suffix: suffix.to_owned() }]);
        }
        let channel = |(number, name): (usize, &str)| {
            let mut colour = [0.0; 3];
            colour[number] = 1.0;
            let cells = self.cells_of(lattice, colours, |colour| colour[number])?;
            Ok(Tinted { cells, colour, suffix: format!("{suffix}_{name}") })
        };
        ["red", "green", "blue"].into_iter().enumerate().map(channel).collect()
    }

    fn both(&self, lattice: Lattice, a: &Colours, s: &Colours) -> Result<Vec<(Tinted, bool)>, ImportError> {
        let absorption = self.tinted(lattice, a, "_absorption", false)?.into_iter().map(|part| (part, true));
        let scattering = self.tinted(lattice, s, "_scattering", false)?.into_iter().map(|part| (part, false));
        Ok(absorption.chain(scattering).collect())
    }

    /// Both coefficients as multiples of one grid, if they are: the grid with μa, and μs.
    fn proportional(
        &self,
        lattice: Lattice,
        a: &Colours,
        s: &Colours,
    ) -> Result<Option<(Tinted, [f64; 3])>, ImportError> {
        let (Some(mu_a), Some(mu_s)) = (hue(a), hue(s)) else { return Ok(None) };
        let brightest = |colours: &Colours| colours.iter().map(greatest).fold(0.0, f64::max);
        let (of_a, of_s) = (brightest(a), brightest(s));
        let is_same = a.len() == s.len()
            && a.iter()
                .zip(s)
                .all(|(a, s)| (greatest(a) * of_s - greatest(s) * of_a).abs() <= 1e-6 * of_a * of_s);
        if !is_same && of_a > 0.0 && of_s > 0.0 {
            return Ok(None);
        }
        // A coefficient that is 0 everywhere is a multiple of any grid.
        let (colours, reference) = if of_s > 0.0 { (s, of_s) } else { (a, of_a) };
        let cells = self.cells_of(lattice, colours, greatest)?;
        self.cells_of(lattice, a, greatest)?;
        let times = |hue: [f64; 3], factor: f64| {
            hue.map(|channel| if reference > 0.0 { channel * factor / reference } else { 0.0 })
        };
        let tinted = Tinted { cells, colour: times(mu_a, of_a), suffix: String::new() };
        Ok(Some((tinted, times(mu_s, of_s))))
    }

    /// The light of an absorbing part, and the grid that multiplies it.
    fn glow(
        &self,
        lattice: Lattice,
        glow: &Colours,
        part: &Tinted,
        scale: f64,
    ) -> Result<(Option<SpectrumDescription>, Option<EmissionGridDescription>), ImportError> {
        let suffix = format!("{}_glow", part.suffix);
        let (colour, cells) = match hue(glow) {
            Some(colour) => (colour, self.cells_of(lattice, glow, greatest)?),
            None => {
                let channel = part.colour.iter().position(|&value| value > 0.0).unwrap_or(0);
                (part.colour, self.cells_of(lattice, glow, |colour| colour[channel])?)
            }
        };
        let Some(file) = self.grid_file(&suffix, &cells)? else { return Ok((None, None)) };
        let light = spectra::grey_or_channels(colour.map(|channel| channel * scale));
        Ok((Some(light), Some(emission_grid(file))))
    }
}

fn greatest(colour: &[f64; 3]) -> f64 {
    colour.iter().copied().fold(0.0, f64::max)
}

/// The colour, its greatest channel 1, that all cells which are not black have; white if all are black.
fn hue(colours: &Colours) -> Option<[f64; 3]> {
    let of = |colour: &[f64; 3]| colour.map(|channel| channel / greatest(colour));
    let mut hues = colours.iter().filter(|colour| greatest(colour) > 0.0).map(of);
    let Some(first) = hues.next() else { return Some([1.0; 3]) };
    let is_same = |other: [f64; 3]| first.iter().zip(other).all(|(a, b)| (a - b).abs() <= 1e-6);
    hues.all(is_same).then_some(first)
}

fn grown(support: Option<Corners>, cells: &Cells) -> Option<Corners> {
    match (support, cells.support()) {
        (Some([min, max]), Some([least, most])) => Some([min.min(least), max.max(most)]),
        (one, other) => one.or(other),
    }
}
