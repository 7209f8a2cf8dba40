//! What the three channels of a film are, and the names that they have in files.
//!
//! A film always has three. Usually they are red, green and blue; they may be X, Y and Z, or three single wavelengths, and
//! a picture of more bands than that is several films.

use serde::{Deserialize, Serialize};

use crate::accumulation_file::Accumulation;
use crate::estimates::{Channel, Estimate};
use crate::film::Film;

/// What the three channels of a film are.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Colours {
    /// Linear red, green and blue, Rec. 709.
    #[default]
    Rgb,
    /// CIE 1931 XYZ.
    Xyz,
    /// Radiance per wavelength at three wavelengths in nm, some of which may be the same.
    Bands([f64; 3]),
}

/// The mean of a band over the picture.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct BandMean {
    /// In nm.
    pub wavelength_nm: f64,
    /// Mean radiance, and its standard error.
    #[serde(flatten)]
    pub estimate: Estimate,
}

impl Colours {
    /// The name in files of a channel that is called `name` in an RGB picture, such as `R` or `StandardError.R`. The
    /// albedo is in RGB even if light is in XYZ.
    fn name(&self, name: &str) -> String {
        let (layer, colour) = name.rsplit_once('.').map_or(("", name), |(layer, colour)| (layer, colour));
        let Some(index) = ["R", "G", "B"].iter().position(|own| *own == colour) else {
            return name.to_owned();
        };
        let own = match self {
            Self::Xyz if layer != "Albedo" => ["X", "Y", "Z"][index].to_owned(),
            Self::Rgb | Self::Xyz => colour.to_owned(),
            // The point has a meaning in names of channels.
            Self::Bands(wavelengths_nm) => format!("{}nm", wavelengths_nm[index]).replace('.', ","),
        };
        if layer.is_empty() { own } else { format!("{layer}.{own}") }
    }
}

/// All channels of a film (see [`Film::channels`]) under the names that they have in files: `X`, `Y`, `Z` of XYZ, `450nm` of
/// a band, with a comma for the decimal point.
pub fn named_channels(film: &Film, colours: &Colours) -> Vec<Channel> {
    let named = |channel: Channel| Channel { name: colours.name(&channel.name), ..channel };
    film.channels().into_iter().map(named).collect()
}

/// The channels of all films of a picture. What is not of one band, such as the coverage, is the first film's.
pub(crate) fn channels_of_bands(pictures: &[Accumulation]) -> Vec<Channel> {
    let mut all: Vec<Channel> = Vec::new();
    for picture in pictures {
        for channel in named_channels(&picture.film, &picture.metadata.colours) {
            if !all.iter().any(|known| known.name == channel.name) {
                all.push(channel);
            }
        }
    }
    all
}

/// The means of all bands, by wavelength; none of pictures in colour.
pub(crate) fn band_means(pictures: &[Accumulation]) -> Vec<BandMean> {
    let mut means: Vec<BandMean> = Vec::new();
    for Accumulation { film, metadata } in pictures {
        let Colours::Bands(wavelengths_nm) = metadata.colours else { continue };
        for (wavelength_nm, estimate) in wavelengths_nm.into_iter().zip(film.image_mean()) {
            if !means.iter().any(|known| known.wavelength_nm == wavelength_nm) {
                means.push(BandMean { wavelength_nm, estimate });
            }
        }
    }
    means.sort_by(|a, b| a.wavelength_nm.total_cmp(&b.wavelength_nm));
    means
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::metadata::ImageMetadata;
    use crate::sample::Layers;

    #[test]
    fn channels_are_called_what_they_are() {
        let bands = Colours::Bands([450.0, 532.5, 650.0]);
        for (colours, name, expected) in [
            (Colours::Rgb, "StandardError.G", "StandardError.G"),
            (Colours::Xyz, "G", "Y"),
            (Colours::Xyz, "Single.B", "Single.Z"),
            (Colours::Xyz, "Albedo.R", "Albedo.R"),
            (bands, "R", "450nm"),
            (bands, "StandardError.G", "StandardError.532,5nm"),
            (bands, "Albedo.B", "Albedo.650nm"),
            (bands, "Depth.Z", "Depth.Z"),
            (bands, "SampleCount", "SampleCount"),
        ] {
            assert_eq!(colours.name(name), expected, "{colours:?}");
        }
    }

    #[test]
    fn bands_of_several_films_come_once_each() {
        let picture = |bands| Accumulation {
            film: Film::new(1, 1, Layers::NONE).unwrap(),
            metadata: ImageMetadata { colours: Colours::Bands(bands), ..ImageMetadata::default() },
        };
        let pictures = [picture([650.0, 550.0, 450.0]), picture([350.0, 350.0, 350.0])];
        let names: Vec<String> = channels_of_bands(&pictures).into_iter().map(|c| c.name).collect();
        for name in ["650nm", "450nm", "350nm", "StandardError.350nm", "A"] {
            assert_eq!(names.iter().filter(|own| *own == name).count(), 1, "{name} in {names:?}");
        }
        let means: Vec<f64> = band_means(&pictures).iter().map(|mean| mean.wavelength_nm).collect();
        assert_eq!(means, [350.0, 450.0, 550.0, 650.0]);
    }
}
