//! What a panel shows: the radiance of a render or one of the layers of its EXR file.

use std::collections::BTreeMap;
use std::error::Error;
use std::path::Path;

use exr::prelude::read_first_flat_layer_from_file;
use tyndall_film::{srgb_signal, tone_map};
use tyndall_scene::SceneDocument;

use crate::chapters::{Panel, Shown};
use crate::command::Tyndall;

/// A panel for the screen: 8-bit sRGB.
#[derive(Clone)]
pub struct Image {
    pub size: [usize; 2],
    pub pixels: Vec<[u8; 3]>,
    pub caption: &'static str,
}

/// Renders the panels of a chapter; those that only show other layers of one render are rendered once.
pub fn render(tyndall: &Tyndall, folder: &Path, panels: &[Panel]) -> Result<Vec<Image>, Box<dyn Error>> {
    let temporary = tempfile::tempdir()?;
    let file = temporary.path().join("panel.exr");
    let mut renders: BTreeMap<&str, Channels> = BTreeMap::new();
    for panel in panels {
        if !renders.contains_key(panel.render) {
            let line = format!("render {} --progress none -o {}", panel.render, file.display());
            tyndall.run(folder, &line)?;
            renders.insert(panel.render, Channels::read(&file)?);
        }
    }
    panels.iter().map(|panel| develop(panel, &renders[panel.render], exposure(folder, panel)?)).collect()
}

/// Stops by which the scene of the panel is brightened.
fn exposure(folder: &Path, panel: &Panel) -> Result<f32, Box<dyn Error>> {
    let scene = panel.render.split_whitespace().next().ok_or("a panel without a scene")?;
    Ok(SceneDocument::read(&folder.join(scene))?.description()?.film.exposure as f32)
}

fn develop(panel: &Panel, channels: &Channels, exposure: f32) -> Result<Image, Box<dyn Error>> {
    let rgb = |layer: &str, factor: f32| channels.rgb(layer).map(|image| scaled(&image, factor));
    let brighter = exposure.exp2();
    let linear = match panel.shown {
        Shown::Radiance => rgb("", brighter)?,
        Shown::Emission => rgb("Emission.", brighter)?,
        Shown::Single => rgb("Single.", brighter)?,
        Shown::Multiple => rgb("Multiple.", brighter)?,
        Shown::StandardError { times } => rgb("StandardError.", brighter * times)?,
        Shown::Background => {
            let parts = [rgb("Emission.", brighter)?, rgb("Single.", brighter)?, rgb("Multiple.", brighter)?];
            let mut rest = rgb("", brighter)?;
            for (index, pixel) in rest.iter_mut().enumerate() {
                *pixel =
                    std::array::from_fn(|c| pixel[c] - parts.iter().map(|part| part[index][c]).sum::<f32>());
            }
            rest
        }
        Shown::Transmittance => channels.get("Transmittance")?.iter().map(|&t| [t; 3]).collect(),
    };
    let signal = |pixel: &[f32; 3]| tone_map(*pixel).map(|value| (255.0 * srgb_signal(value) + 0.5) as u8);
    Ok(Image { size: channels.size, pixels: linear.iter().map(signal).collect(), caption: panel.caption })
}

fn scaled(image: &[[f32; 3]], factor: f32) -> Vec<[f32; 3]> {
    image.iter().map(|pixel| pixel.map(|value| value * factor)).collect()
}

/// The channels of an EXR file by name.
struct Channels {
    size: [usize; 2],
    by_name: BTreeMap<String, Vec<f32>>,
}

impl Channels {
    fn read(file: &Path) -> Result<Channels, Box<dyn Error>> {
        let layer = read_first_flat_layer_from_file(file)?.layer_data;
        let by_name = layer
            .channel_data
            .list
            .iter()
            .map(|channel| (channel.name.to_string(), channel.sample_data.values_as_f32().collect()))
            .collect();
        Ok(Channels { size: [layer.size.0, layer.size.1], by_name })
    }

    /// A layer that nothing but zero arrived at is not in the file.
    fn rgb(&self, layer: &str) -> Result<Vec<[f32; 3]>, Box<dyn Error>> {
        if !layer.is_empty() && !self.by_name.contains_key(&format!("{layer}R")) {
            return Ok(vec![[0.0; 3]; self.size[0] * self.size[1]]);
        }
        let [r, g, b] = ["R", "G", "B"].map(|name| self.get(&format!("{layer}{name}")));
        Ok(r?.iter().zip(g?).zip(b?).map(|((&r, &g), &b)| [r, g, b]).collect())
    }

    fn get(&self, name: &str) -> Result<&[f32], Box<dyn Error>> {
        Ok(self.by_name.get(name).ok_or_else(|| format!("the picture has no channel `{name}`"))?)
    }
}
