//! Sums of samples: all layers or none, whole or interrupted, in several ranges.

use tyndall_film::{Accumulation, Colours, Film, FilmTile, ImageMetadata, Layers, Sample};

use super::put;

pub fn write_all() {
    put("acc", "all_layers", &accumulation(Layers::ALL, false).to_bytes().unwrap());
    put("acc", "no_layers", &accumulation(Layers::NONE, false).to_bytes().unwrap());
    put("acc", "interrupted", &accumulation(Layers::ALL, true).to_bytes().unwrap());
    let mut merged = accumulation(Layers::NONE, false);
    let other = {
        let mut other = merged.clone();
        other.film = film(Layers::NONE, 9, false);
        other
    };
    merged.merge("a".as_ref(), &other, "b.acc".as_ref()).unwrap();
    put("acc", "two_ranges", &merged.to_bytes().unwrap());
}

fn accumulation(layers: Layers, is_open: bool) -> Accumulation {
    let metadata = ImageMetadata {
        scene_hash: "12ab".into(),
        version: "0.1.0".into(),
        options: "integrator=fast".into(),
        seed: 7,
        colours: Colours::Xyz,
        crop: None,
        seconds: 2.0,
    };
    Accumulation { film: film(layers, 3, is_open), metadata }
}

/// Two samples a pixel from `first` on, of all tiles or of the first one.
fn film(layers: Layers, first: u64, is_open: bool) -> Film {
    let mut film = Film::new(18, 17, layers).unwrap();
    film.open_range(first).unwrap();
    for number in 0..if is_open { 1 } else { film.tile_count() } {
        let rect = film.tile_rect(number);
        let mut tile = FilmTile::new(rect, first..first + 2, film.layers());
        for n in 0..2 * rect.width * rect.height {
            let (x, y) = (rect.x + n % rect.width, rect.y + n / rect.width % rect.height);
            let u = (n % 7) as f32;
            let met = Sample { hit: n % 2 == 0, depth: u, object: n % 3, ..Sample::default() };
            tile.add(
                x,
                y,
                &Sample { radiance: [u; 3], single: [0.5 * u; 3], normal: [0.0, 1.0, 0.0], ..met },
            );
        }
        film.merge_tile(&tile);
    }
    if !is_open {
        film.complete_through(first + 2).unwrap();
    }
    film
}
