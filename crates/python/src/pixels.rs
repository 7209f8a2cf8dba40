//! Films as NumPy arrays, and the files of a picture.

use std::path::Path;

use numpy::{PyArray1, PyArrayDyn, PyArrayMethods};
use pyo3::prelude::{Bound, PyDictMethods, PyResult, Python};
use pyo3::types::PyDict;
use tyndall_film::{Accumulation, Channel, Colours, Film, named_channels};
use tyndall_session::{Output, check_writable, write_all};

use crate::error::{of_session, wrong};

/// Writes the picture to a file whose extension says the kind.
pub(crate) fn save(py: Python<'_>, path: &Path, pictures: &[Accumulation], exposure: f32) -> PyResult<()> {
    let text = path.display();
    let output: Output = path.to_string_lossy().parse().map_err(|why| wrong(format!("{text}: {why}")))?;
    let colours = pictures.first().map(|picture| picture.metadata.colours).unwrap_or_default();
    py.detach(|| {
        output.check_colours(&colours, pictures.len())?;
        check_writable([output.path()])?;
        write_all(&[output], pictures, exposure)
    })
    .map_err(of_session)
}

/// Mean radiance, of shape (H, W, 3), or (H, W, N) of a picture of bands.
pub(crate) fn image<'py>(
    py: Python<'py>,
    pictures: &[Accumulation],
) -> PyResult<Bound<'py, PyArrayDyn<f32>>> {
    match whole(pictures) {
        Some(film) => arrange_colours(py, film, py.detach(|| film.mean_image())),
        None => stack(py, pictures, ""),
    }
}

/// Its standard error, of the same shape.
pub(crate) fn standard_error<'py>(
    py: Python<'py>,
    pictures: &[Accumulation],
) -> PyResult<Bound<'py, PyArrayDyn<f32>>> {
    let Some(film) = whole(pictures) else { return stack(py, pictures, "StandardError") };
    let errors = py.detach(|| {
        let pixels = (0..film.height()).flat_map(|y| (0..film.width()).map(move |x| (x, y)));
        pixels.map(|(x, y)| film.standard_error(x, y).map(|error| error as f32)).collect()
    });
    arrange_colours(py, film, errors)
}

/// The film of a picture whose channels are just its own three.
fn whole(pictures: &[Accumulation]) -> Option<&Film> {
    match pictures {
        [Accumulation { film, metadata }] if !matches!(metadata.colours, Colours::Bands(_)) => Some(film),
        _ => None,
    }
}

fn arrange_colours<'py>(
    py: Python<'py>,
    film: &Film,
    pixels: Vec<[f32; 3]>,
) -> PyResult<Bound<'py, PyArrayDyn<f32>>> {
    let shape = vec![film.height() as usize, film.width() as usize, 3];
    PyArray1::from_vec(py, pixels.into_flattened()).reshape(shape)
}

/// The other layers by their names, of shape (H, W) or (H, W, channels).
pub(crate) fn layers<'py>(py: Python<'py>, pictures: &[Accumulation]) -> PyResult<Bound<'py, PyDict>> {
    let layers = PyDict::new(py);
    let channels = py.detach(|| channels(pictures));
    for channel in &channels {
        let name = layer(channel, pictures);
        if !matches!(name, "" | "StandardError") && !layers.contains(name)? {
            layers.set_item(name, arrange(py, pictures, &channels, name)?)?;
        }
    }
    Ok(layers)
}

/// Names of the channels of the image: `R`, `G`, `B`, or wavelengths such as `550nm`.
pub(crate) fn channel_names(pictures: &[Accumulation]) -> Vec<String> {
    let channels = channels(pictures);
    let of_image = channels.iter().filter(|channel| layer(channel, pictures).is_empty());
    of_image.map(|channel| channel.name.clone()).collect()
}

/// The channels of all films, each once.
fn channels(pictures: &[Accumulation]) -> Vec<Channel> {
    let mut all: Vec<Channel> = Vec::new();
    for Accumulation { film, metadata } in pictures {
        for channel in named_channels(film, &metadata.colours) {
            if !all.iter().any(|known| known.name == channel.name) {
                all.push(channel);
            }
        }
    }
    all
}

/// The layer that a channel belongs to: what stands before the point of its name, or the name itself of those that are
/// alone in theirs; nothing of the image's own.
fn layer<'a>(channel: &'a Channel, pictures: &[Accumulation]) -> &'a str {
    let name = channel.name.as_str();
    if let Some((layer, _)) = name.split_once('.') {
        return layer;
    }
    let is_band = pictures.iter().any(|picture| matches!(picture.metadata.colours, Colours::Bands(_)));
    match name {
        "R" | "G" | "B" | "X" | "Y" | "Z" => "",
        band if is_band && band.ends_with("nm") => "",
        alone => alone,
    }
}

fn stack<'py>(
    py: Python<'py>,
    pictures: &[Accumulation],
    name: &str,
) -> PyResult<Bound<'py, PyArrayDyn<f32>>> {
    let channels = py.detach(|| channels(pictures));
    arrange(py, pictures, &channels, name)
}

/// The channels of a layer as one array.
fn arrange<'py>(
    py: Python<'py>,
    pictures: &[Accumulation],
    channels: &[Channel],
    name: &str,
) -> PyResult<Bound<'py, PyArrayDyn<f32>>> {
    let of_layer: Vec<&Channel> =
        channels.iter().filter(|channel| layer(channel, pictures) == name).collect();
    let shape = |film: &Film| [film.height() as usize, film.width() as usize];
    let [height, width] = pictures.first().map_or([0, 0], |picture| shape(&picture.film));
    if let ([channel], false) = (of_layer.as_slice(), matches!(name, "" | "StandardError")) {
        return PyArray1::from_slice(py, &channel.values).reshape(vec![height, width]);
    }
    let mut values = Vec::with_capacity(height * width * of_layer.len());
    for pixel in 0..height * width {
        values.extend(of_layer.iter().map(|channel| channel.values[pixel]));
    }
    PyArray1::from_vec(py, values).reshape(vec![height, width, of_layer.len()])
}
