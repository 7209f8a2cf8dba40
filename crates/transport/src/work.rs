//! A pass over the film, shared out among threads: the samples that each is to begin, and where they go once they have ended.
//!
//! A thread takes block after block, and an engine with many paths in flight begins with the next while the last paths of
//! the one before are still under way: its pool runs empty only once, at the end of the pass. A tile is added to
//! the film when all of its samples have come; those that have not when a render is cancelled are given up.

use std::cmp::Reverse;
use std::ops::Range;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Mutex, MutexGuard, PoisonError};

use tyndall_film::{Film, FilmTile, Sample, TILE_EDGE};

use crate::counters::{self, Event};
use crate::render::Control;

/// Tiles along each edge of a block: 32×32 pixels, neighbours that look into the same parts of the volumes.
const BLOCK_TILES: u32 = 2;

/// What all threads share.
pub(crate) struct Pass<'f> {
    film: Mutex<&'f mut Film>,
    /// Numbers of the film's tiles.
    blocks: Vec<Vec<usize>>,
    next_block: AtomicUsize,
    /// The round that tiles are to be rendered up to.
    end: u64,
    control: &'f Control,
}

impl<'f> Pass<'f> {
    /// The samples that the film's open pass lacks before round `end`.
    pub fn new(film: &'f mut Film, end: u64, control: &'f Control) -> Self {
        let blocks = blocks(film, end);
        Self { film: Mutex::new(film), blocks, next_block: AtomicUsize::new(0), end, control }
    }

    /// Empty tiles for what the next block lacks; `None` if there is none left.
    fn open_block(&self) -> Option<Vec<FilmTile>> {
        let block = self.blocks.get(self.next_block.fetch_add(1, Ordering::Relaxed))?;
        let film = self.film();
        Some(block.iter().filter_map(|&tile| film.open_tile(tile, self.end)).collect())
    }

    #[cold]
    fn merge(&self, tile: &FilmTile) {
        let samples = tile.sample_count();
        counters::count(Event::Path, samples);
        self.film().merge_tile(tile);
        self.control.samples.fetch_add(samples, Ordering::Relaxed);
    }

    /// A thread that panicked holding the lock has ended the render anyway.
    fn film(&self) -> MutexGuard<'_, &'f mut Film> {
        self.film.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// Numbers of the film's tiles, by block; where pixels have different numbers of samples, those with most first.
fn blocks(film: &Film, end: u64) -> Vec<Vec<usize>> {
    let columns = film.width().div_ceil(TILE_EDGE);
    let block_columns = columns.div_ceil(BLOCK_TILES) as usize;
    let block_rows = film.height().div_ceil(TILE_EDGE * BLOCK_TILES) as usize;
    let mut blocks = vec![Vec::new(); block_columns * block_rows];
    for tile in 0..film.tile_count() {
        let rect = film.tile_rect(tile);
        let along = |pixels: u32| (pixels / (TILE_EDGE * BLOCK_TILES)) as usize;
        blocks[along(rect.y) * block_columns + along(rect.x)].push(tile);
    }
    if film.rates().is_some() {
        let lacking = |block: &[usize]| block.iter().map(|&tile| film.lacking(tile, end)).sum::<u64>();
        blocks.sort_by_cached_key(|block| Reverse(lacking(block)));
    }
    blocks
}

/// What one thread does of a pass.
pub(crate) struct Work<'a, 'f> {
    pass: &'a Pass<'f>,
    /// Tiles of its last block whose samples have not begun.
    waiting: Vec<FilmTile>,
    /// Places of tiles whose samples have; one that misses none is free.
    open: Vec<OpenTile>,
    /// The place of the tile whose samples begin, and how far that has come: the next pixel, and the round.
    place: usize,
    column: u32,
    row: u32,
    round: u64,
    /// The pixel before that, and its samples that are left.
    pixel: Pixel,
    samples: Range<u64>,
}

struct OpenTile {
    tile: FilmTile,
    /// Samples that have not been added.
    missing: u64,
}

/// A pixel of the film, and the place of its tile among those of a thread.
#[derive(Clone, Copy, Default)]
pub(crate) struct Pixel {
    pub x: u32,
    pub y: u32,
    place: u32,
}

impl<'a, 'f> Work<'a, 'f> {
    pub fn new(pass: &'a Pass<'f>) -> Self {
        Self {
            pass,
            waiting: Vec::new(),
            open: Vec::new(),
            place: 0,
            column: 0,
            row: 0,
            round: 0,
            pixel: Pixel::default(),
            samples: 0..0,
        }
    }

    /// Whether the render is to end soon, whatever is left to do.
    #[inline(always)]
    pub fn is_cancelled(&self) -> bool {
        self.pass.control.cancel.load(Ordering::Relaxed)
    }

    /// The next sample to begin, by its number in its pixel: one tile after the other, each round by round.
    #[inline(always)]
    pub fn next(&mut self) -> Option<(Pixel, u64)> {
        loop {
            if let Some(sample) = self.samples.next() {
                return Some((self.pixel, sample));
            }
            if !self.next_pixel() && !self.next_tile() {
                return None;
            }
        }
    }

    /// `false` if the tile has no more.
    #[inline(always)]
    fn next_pixel(&mut self) -> bool {
        let Some(OpenTile { tile, .. }) = self.open.get(self.place) else { return false };
        let rect = tile.rect();
        if self.row == rect.height {
            (self.row, self.round) = (0, self.round + 1);
        }
        if self.round >= tile.rounds().end {
            return false;
        }
        let (x, y) = (rect.x + self.column, rect.y + self.row);
        self.pixel = Pixel { x, y, place: self.place as u32 };
        self.samples = tile.samples_of(x, y, self.round..self.round + 1);
        self.column += 1;
        if self.column == rect.width {
            (self.column, self.row) = (0, self.row + 1);
        }
        true
    }

    /// `false` if there are none left for this thread.
    #[cold]
    fn next_tile(&mut self) -> bool {
        loop {
            let Some(tile) = self.waiting.pop() else {
                let Some(block) = self.pass.open_block() else { return false };
                self.waiting = block;
                self.waiting.reverse();
                continue;
            };
            let missing = tile.sample_count();
            if missing == 0 {
                self.pass.merge(&tile);
                continue;
            }
            (self.column, self.row, self.round) = (0, 0, tile.rounds().start);
            let open = OpenTile { tile, missing };
            match self.open.iter().position(|open| open.missing == 0) {
                Some(free) => (self.place, self.open[free]) = (free, open),
                None => {
                    self.place = self.open.len();
                    self.open.push(open);
                }
            }
            return true;
        }
    }

    /// Adds a sample that [`next`](Self::next) gave to its pixel.
    #[inline(always)]
    pub fn add(&mut self, pixel: Pixel, sample: &Sample) {
        let open = &mut self.open[pixel.place as usize];
        open.tile.add(pixel.x, pixel.y, sample);
        open.missing -= 1;
        if open.missing == 0 {
            self.pass.merge(&open.tile);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use tyndall_film::{Layers, Rates};

    /// However late samples end, and however many blocks that spans, each begins once, in a pixel that is still there.
    #[test]
    fn every_sample_begins_once_and_reaches_its_pixel_late_or_soon() {
        for rates in [None, Some(rates_of_stripes(70, 45))] {
            let mut film = Film::new(70, 45, Layers::NONE).unwrap();
            if let Some(rates) = rates {
                film.set_rates(rates);
            }
            film.open_range(0).unwrap();
            let is_adaptive = film.rates().is_some();
            let is_idle = |film: &Film, tile| film.open_tile(tile, 3).is_some() && film.lacking(tile, 3) == 0;
            for end in [2, 3, 4, 8] {
                // Some tiles get no sample in that round, and have to be there after it all the same.
                let idle = (0..film.tile_count()).filter(|&tile| is_idle(&film, tile)).count();
                assert_eq!(idle > 0, is_adaptive && end == 3, "{idle} idle tiles before round {end}");
                let control = Control::default();
                let pass = Pass::new(&mut film, end, &control);
                let mut work = Work::new(&pass);
                let mut under_way = std::collections::VecDeque::new();
                let mut begun = std::collections::HashSet::new();
                while let Some((pixel, sample)) = work.next() {
                    assert!(begun.insert((pixel.x, pixel.y, sample)), "began twice");
                    under_way.push_back(pixel);
                    if under_way.len() > 1500 {
                        let ended = under_way.remove(begun.len() * 7 % 1500).unwrap();
                        work.add(ended, &Sample { radiance: [ended.x as f32; 3], ..Sample::default() });
                    }
                }
                for ended in under_way {
                    work.add(ended, &Sample { radiance: [ended.x as f32; 3], ..Sample::default() });
                }
                assert_eq!(control.samples.into_inner(), begun.len() as u64);
            }
            film.complete_through(8).unwrap();
            for (number, mean) in film.mean_image().iter().enumerate() {
                assert_eq!(mean[0], (number % 70) as f32, "pixel {number}");
            }
        }
    }

    /// Many and few samples in turn.
    fn rates_of_stripes(width: u32, height: u32) -> Rates {
        let mut pilot = Film::new(width, height, Layers { effort: true, ..Layers::NONE }).unwrap();
        pilot.open_range(0).unwrap();
        for number in 0..pilot.tile_count() {
            let mut tile = pilot.open_tile(number, 4).unwrap();
            let rect = tile.rect();
            for sample in 0..4 {
                for (x, y) in
                    (0..rect.width * rect.height).map(|i| (rect.x + i % rect.width, rect.y + i / rect.width))
                {
                    let noise = if x / 40 % 2 == 0 { sample as f32 } else { 1.0 };
                    tile.add(x, y, &Sample { radiance: [noise; 3], effort: 10, ..Sample::default() });
                }
            }
            pilot.merge_tile(&tile);
        }
        pilot.complete_through(4).unwrap();
        Rates::of_pilot(&pilot)
    }
}
