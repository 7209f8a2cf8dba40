//! The film: the sums of a whole picture and which samples they hold.
//!
//! A film is filled in *passes*. [`Film::open_range`] starts one; every 16x16 tile is then filled by one thread in
//! a [`FilmTile`] of its own and merged, in any order; [`Film::complete_through`] ends the pass. A pass that was
//! interrupted leaves each tile with samples of its own count, and can be continued tile by tile. As all sums are
//! exact (see `fixed_point`), neither the order, nor how samples were split into passes, films
//! or machines changes a single bit.

use std::ops::Range;

use tyndall_machine::memory::{self, MemoryError};

use crate::ranges::{RangeError, SampleRanges};
use crate::rates::{self, Rates};
use crate::sample::{Layers, Sample};
use crate::sums::Sums;

/// Edge of a tile in pixels; those at the right and lower border may be smaller.
pub const TILE_EDGE: u32 = 16;
/// The greatest film in pixels (35 GB of sums without layers).
pub const MAX_PIXELS: u64 = 1 << 28;
/// What writing takes for a pixel: some thirty channels of f32, once as they are and once as a file.
const WRITTEN_BYTES: usize = 2 * 30 * size_of::<f32>();

/// A rectangle of pixels; x to the right and y downwards from the upper left corner of the picture.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Rect {
    /// Least x.
    pub x: u32,
    /// Least y.
    pub y: u32,
    /// Columns.
    pub width: u32,
    /// Rows.
    pub height: u32,
}

/// Exact sums of some samples of one tile, owned by the thread that renders it.
#[derive(Debug, Clone)]
pub struct FilmTile {
    rect: Rect,
    rounds: Range<u64>,
    /// Rates of its pixels, if they differ.
    rates: Vec<u16>,
    layers: Layers,
    sums: Sums,
}

impl FilmTile {
    /// An empty tile for `samples` of every pixel of `rect`, which is one of [`Film::tile_rect`] of a film without [`Rates`];
    /// [`Film::open_tile`] makes those of any film.
    pub fn new(rect: Rect, samples: Range<u64>, layers: Layers) -> Self {
        let sums = Sums::zero(rect.pixels());
        Self { rect, rounds: samples, rates: Vec::new(), layers, sums }
    }

    /// Where the tile is.
    pub fn rect(&self) -> Rect {
        self.rect
    }

    /// Which rounds of samples it gets: without [`Rates`] one sample a round for every pixel.
    pub fn rounds(&self) -> Range<u64> {
        self.rounds.clone()
    }

    /// Numbers of the samples that pixel (`x`, `y`) of the film, which must lie in [`rect`](Self::rect), gets in some rounds.
    #[inline(always)]
    pub fn samples_of(&self, x: u32, y: u32, rounds: Range<u64>) -> Range<u64> {
        if self.rates.is_empty() {
            rounds
        } else {
            rates::samples(Some(self.rates[self.index(x, y)]), &rounds)
        }
    }

    /// Number of samples that all its pixels get together.
    pub fn sample_count(&self) -> u64 {
        count_samples(self.rect, &self.rates, &self.rounds)
    }

    #[inline(always)]
    fn index(&self, x: u32, y: u32) -> usize {
        (y - self.rect.y) as usize * self.rect.width as usize + (x - self.rect.x) as usize
    }

    /// Adds a sample to pixel (`x`, `y`) of the film, which must lie in [`rect`](Self::rect). One that is not
    /// finite, or too large, is only counted as rejected: the pixel's estimates are those of its other samples.
    pub fn add(&mut self, x: u32, y: u32, sample: &Sample) {
        debug_assert!(x - self.rect.x < self.rect.width);
        self.sums.add(self.index(x, y), sample, self.layers);
    }
}

impl Rect {
    fn pixels(&self) -> usize {
        self.width as usize * self.height as usize
    }
}

/// Number of samples of some pixels in some rounds; `rates` is empty if they all get one a round.
fn count_samples(rect: Rect, rates: &[u16], rounds: &Range<u64>) -> u64 {
    let length = |range: Range<u64>| range.end.saturating_sub(range.start);
    if rates.is_empty() {
        return rect.pixels() as u64 * length(rounds.clone());
    }
    rates.iter().map(|&step| length(rates::samples(Some(step), rounds))).sum()
}

/// A pass that has begun: every tile's own progress.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct OpenPass {
    pub start: u64,
    /// Samples beyond `start` that every pixel of a tile holds, one number a tile.
    pub done: Vec<u64>,
}

/// The sums of a picture.
///
/// Memory per pixel: 132 bytes, and for each layer that is kept and has seen anything but zero 4 (object), 8 (effort), 16 (depth),
/// 24 (albedo, normal) or 48 (emission, single, multiple, shadow catcher) more: 247 MB at 1280x720 for a cloud with all
/// layers but emission. Once a sample was rejected, 4 bytes more count them.
///
/// A sample that is not finite, or too large, never reaches the sums. It is counted in its pixel, and every estimate of
/// the pixel and of its layers is over the other samples. Where those are rejected whose light is unlike the others',
/// which cannot be known, that is biased: [`rejected`](Self::rejected) is to be told along with the picture. A pixel all
/// of whose samples were rejected has mean 0 and an infinite standard error.
#[derive(Debug, Clone, PartialEq)]
pub struct Film {
    pub(crate) width: u32,
    pub(crate) height: u32,
    pub(crate) layers: Layers,
    pub(crate) sums: Sums,
    /// How many samples each pixel gets of a round; one, if there are none.
    pub(crate) rates: Option<Rates>,
    pub(crate) complete: SampleRanges,
    pub(crate) open: Option<OpenPass>,
}

/// A size that a film cannot have.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum SizeError {
    /// No film can.
    #[error(
        "a picture of {width}x{height} pixels cannot be made: it must have between 1 and {MAX_PIXELS} pixels"
    )]
    Pixels {
        /// Columns.
        width: u32,
        /// Rows.
        height: u32,
    },
    /// There is no memory for it.
    #[error("{0}, such as a smaller resolution or fewer layers")]
    Memory(#[from] MemoryError),
}

/// Number of pixels of a film of this size.
pub(crate) fn pixel_count(width: u32, height: u32) -> Result<usize, SizeError> {
    match u64::from(width) * u64::from(height) {
        count @ 1..=MAX_PIXELS => Ok(count as usize),
        _ => Err(SizeError::Pixels { width, height }),
    }
}

/// Number of tiles of a film of this size.
pub(crate) fn tile_count(width: u32, height: u32) -> usize {
    width.div_ceil(TILE_EDGE) as usize * height.div_ceil(TILE_EDGE) as usize
}

impl Film {
    /// A film without samples.
    pub fn new(width: u32, height: u32, layers: Layers) -> Result<Self, SizeError> {
        let count = pixel_count(width, height)?;
        let sums = Sums::default();
        let complete = SampleRanges::default();
        let film = Self { width, height, layers, sums, rates: None, complete, open: None };
        film.ask_for_rest(count)?;
        Ok(Self { sums: Sums::zero(count), ..film })
    }

    /// Gives the pixels different numbers of samples.
    ///
    /// # Panics
    /// If the film holds samples, or the rates are of another size.
    pub fn set_rates(&mut self, rates: Rates) {
        assert!(self.is_empty(), "the film holds samples");
        assert!(rates.as_steps().len() == self.sums.pixels.len(), "the rates are those of another film");
        self.rates = Some(rates);
    }

    /// Whether it holds no samples, and no pass was begun.
    pub fn is_empty(&self) -> bool {
        self.complete.count() == 0 && self.open.is_none()
    }

    /// How many samples each pixel gets for one of the others, if that differs.
    pub fn rates(&self) -> Option<&Rates> {
        self.rates.as_ref()
    }

    /// Asks for the memory that is not taken yet, of layers that have seen nothing so far and of the files that will be
    /// written: before rendering, when whatever else a render takes is taken.
    ///
    /// # Errors
    /// If there is not so much.
    pub fn ask_for_memory_to_come(&self) -> Result<(), SizeError> {
        self.ask_for_rest(self.sums.pixels.len())
    }

    fn ask_for_rest(&self, count: usize) -> Result<(), SizeError> {
        let rest = Sums::bytes(count, self.layers).saturating_sub(self.sums.taken_bytes());
        let written = count.saturating_mul(WRITTEN_BYTES);
        memory::ask((rest as u64).saturating_add(written as u64), || {
            let Self { width, height, .. } = self;
            format!("{width}x{height} pixels of {} bytes", (rest + written) / count.max(1))
        })?;
        Ok(())
    }

    /// Columns of pixels.
    pub fn width(&self) -> u32 {
        self.width
    }

    /// Rows of pixels.
    pub fn height(&self) -> u32 {
        self.height
    }

    /// What is kept beside radiance.
    pub fn layers(&self) -> Layers {
        self.layers
    }

    /// Memory of the sums, once all layers that are kept are in use.
    pub fn bytes(&self) -> usize {
        Sums::bytes(self.sums.pixels.len(), self.layers)
    }

    /// Number of samples that were not finite or too large, and which the estimates leave out.
    pub fn rejected(&self) -> u64 {
        self.sums.rejected.iter().map(|&count| u64::from(count)).sum()
    }

    /// Number of tiles; they are numbered row by row.
    pub fn tile_count(&self) -> usize {
        tile_count(self.width, self.height)
    }

    /// Where tile number `tile` is.
    pub fn tile_rect(&self, tile: usize) -> Rect {
        let columns = self.width.div_ceil(TILE_EDGE) as usize;
        let (x, y) = ((tile % columns) as u32 * TILE_EDGE, (tile / columns) as u32 * TILE_EDGE);
        Rect { x, y, width: TILE_EDGE.min(self.width - x), height: TILE_EDGE.min(self.height - y) }
    }

    fn tile_at(&self, x: u32, y: u32) -> usize {
        let columns = self.width.div_ceil(TILE_EDGE) as usize;
        (y / TILE_EDGE) as usize * columns + (x / TILE_EDGE) as usize
    }

    /// Rounds of samples that the film holds: without [`Rates`] the samples of every pixel.
    pub fn complete(&self) -> &SampleRanges {
        &self.complete
    }

    /// The first sample of the pass that has begun and is not complete, if there is one.
    pub fn open_start(&self) -> Option<u64> {
        self.open.as_ref().map(|pass| pass.start)
    }

    /// The next round that tile number `tile` needs in the open pass.
    pub fn next_round(&self, tile: usize) -> Option<u64> {
        self.open.as_ref().map(|pass| pass.start + pass.done[tile])
    }

    /// An empty tile for the rounds that tile number `tile` needs in the open pass before round `end`; `None` if it
    /// needs none.
    pub fn open_tile(&self, tile: usize, end: u64) -> Option<FilmTile> {
        let rounds = self.next_round(tile)?..end;
        let rect = self.tile_rect(tile);
        (!rounds.is_empty())
            .then(|| FilmTile { rates: self.rates_of(rect), ..FilmTile::new(rect, rounds, self.layers) })
    }

    /// Number of samples that [`open_tile`](Self::open_tile) asks for.
    pub fn lacking(&self, tile: usize, end: u64) -> u64 {
        let rect = self.tile_rect(tile);
        self.next_round(tile).map_or(0, |start| count_samples(rect, &self.rates_of(rect), &(start..end)))
    }

    /// Rates of some pixels, row by row; none if they do not differ.
    fn rates_of(&self, rect: Rect) -> Vec<u16> {
        let Some(rates) = &self.rates else { return Vec::new() };
        let rows = (rect.y..rect.y + rect.height).map(|y| self.index(rect.x, y));
        rows.flat_map(|start| rates.as_steps()[start..start + rect.width as usize].iter().copied()).collect()
    }

    /// Number of samples that pixel (`x`, `y`) holds, those among them that were rejected.
    pub fn sample_count(&self, x: u32, y: u32) -> u64 {
        let open = self.open.as_ref().map(|pass| pass.start..pass.start + pass.done[self.tile_at(x, y)]);
        let step = self.rates.as_ref().map(|rates| rates.as_steps()[self.index(x, y)]);
        let rounds = self.complete.as_slice().iter().chain(&open);
        rounds.map(|rounds| rates::samples(step, rounds)).map(|samples| samples.end - samples.start).sum()
    }

    /// Number of samples that the pixel with the lowest rate holds in the rounds that are complete: no pixel has fewer, but for
    /// one in each range of rounds.
    pub fn least_sample_count(&self) -> u64 {
        let step = self.rates.as_ref().and_then(|rates| rates.as_steps().iter().copied().min());
        let samples = self.complete.as_slice().iter().map(|rounds| rates::samples(step, rounds));
        samples.map(|samples| samples.end - samples.start).sum()
    }

    /// Begins a pass with sample number `start`, or continues the one that begins there.
    pub fn open_range(&mut self, start: u64) -> Result<(), RangeError> {
        match &self.open {
            Some(pass) if pass.start == start => return Ok(()),
            Some(pass) => return Err(RangeError::Unfinished(pass.start)),
            None => {}
        }
        let next = start.checked_add(1).ok_or(RangeError::TooMany)?;
        let mut held = self.complete.clone();
        held.insert(start..next)?;
        if self.rates.is_some() {
            rates::check(&held)?;
        }
        self.open = Some(OpenPass { start, done: vec![0; self.tile_count()] });
        Ok(())
    }

    /// Adds the samples of a tile, which must be those that the tile needs next.
    ///
    /// # Panics
    /// If no pass is open, or the tile is none of the film's, or its rounds do not follow those it holds or have other rates.
    pub fn merge_tile(&mut self, tile: &FilmTile) {
        let number = self.tile_at(tile.rect.x, tile.rect.y);
        assert!(self.tile_rect(number) == tile.rect, "{:?} is no tile of the film", tile.rect);
        let next = self.next_round(number);
        assert!(next == Some(tile.rounds.start), "tile {number} needs {next:?}, not {:?}", tile.rounds);
        assert!(self.rates_of(tile.rect) == tile.rates, "tile {number} has other numbers of samples");
        if let Some(pass) = &mut self.open {
            pass.done[number] += tile.rounds.end - tile.rounds.start;
        }
        for row in 0..tile.rect.height {
            let start = (tile.rect.y + row) as usize * self.width as usize + tile.rect.x as usize;
            let tile_start = row as usize * tile.rect.width as usize;
            self.sums.add_run(start, &tile.sums, tile_start, tile.rect.width as usize);
        }
    }

    /// Ends the pass: every tile must hold all rounds from its start up to, not including, `end`.
    pub fn complete_through(&mut self, end: u64) -> Result<(), RangeError> {
        let Some(pass) = &self.open else { return Ok(()) };
        let start = pass.start;
        for &done in &pass.done {
            if start + done != end {
                return Err(RangeError::Ragged { held: start + done, end });
            }
        }
        self.hold(&SampleRanges::try_from(vec![(start, end)])?)?;
        self.open = None;
        Ok(())
    }

    /// Unchanged on error.
    fn hold(&mut self, rounds: &SampleRanges) -> Result<(), RangeError> {
        let mut complete = self.complete.clone();
        complete.insert_all(rounds)?;
        if self.rates.is_some() {
            rates::check(&complete)?;
        }
        self.complete = complete;
        Ok(())
    }

    /// Adds all samples of another film of the same size and layers; nothing changes on error.
    pub fn merge(&mut self, other: &Self) -> Result<(), MergeError> {
        for film in [&*self, other] {
            if let Some(pass) = &film.open {
                return Err(MergeError::Incomplete(pass.start));
            }
        }
        if (self.width, self.height) != (other.width, other.height) {
            return Err(MergeError::Sizes(self.width, self.height, other.width, other.height));
        }
        if self.layers != other.layers {
            return Err(MergeError::Layers);
        }
        if self.rates != other.rates {
            return Err(MergeError::Rates);
        }
        self.hold(&other.complete)?;
        self.sums.add_run(0, &other.sums, 0, self.sums.pixels.len());
        Ok(())
    }
}

/// Why two films cannot become one.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum MergeError {
    /// The pictures have different sizes.
    #[error("one is {0}x{1} pixels, the other {2}x{3}; render both at the same size")]
    Sizes(u32, u32, u32, u32),
    /// The films keep different layers.
    #[error("they keep different layers; render both with the same")]
    Layers,
    /// The pixels have different numbers of samples.
    #[error("adaptive sampling gave their pixels different numbers of samples; render both in the same way")]
    Rates,
    /// A film was interrupted in the middle of a pass.
    #[error("one was interrupted in the pass that begins at sample {0}; resume it to its end first")]
    Incomplete(u64),
    /// The samples cannot be held together.
    #[error(transparent)]
    Ranges(#[from] RangeError),
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// A sample that is a fixed function of its place, with a wide range of brightness, and is now and then no number.
    fn sample(x: u32, y: u32, index: u64) -> Sample {
        let mut state = (u64::from(x) << 40 | u64::from(y) << 20) ^ index.wrapping_mul(0x9e37_79b9_7f4a_7c15);
        let mut next = || {
            state = (state ^ state >> 30).wrapping_mul(0xbf58_476d_1ce4_e5b9).wrapping_add(0x94d0_49bb);
            (state >> 40) as f32 / (1 << 24) as f32
        };
        let mut colour = |exponent: i32| [next(), next(), next()].map(|u| u * 2f32.powi(exponent));
        let (single, multiple) = (colour(-20), colour(18));
        let albedo = colour(0);
        let normal = colour(1).map(|x| x - 1.0);
        let catcher = [single[0], multiple[0]];
        let spoilt = if state.is_multiple_of(19) { f32::NAN } else { 0.0 };
        let radiance = [0, 1, 2].map(|c| single[c] + multiple[c] + spoilt);
        let (hit, object) = (!index.is_multiple_of(3), (albedo[1] * 5.0) as u32);
        let depth = albedo[0] * 7.0;
        Sample {
            radiance,
            hit,
            depth,
            albedo,
            normal,
            object,
            catcher,
            emission: [0.0; 3],
            single,
            multiple,
            effort: 1,
        }
    }

    fn render(film: &mut Film, tiles: impl Iterator<Item = usize>, end: u64) {
        for tile in tiles {
            let Some(start) = film.next_round(tile) else { panic!("no pass is open") };
            let rect = film.tile_rect(tile);
            let mut part = FilmTile::new(rect, start..end, film.layers());
            for index in start..end {
                for y in rect.y..rect.y + rect.height {
                    for x in rect.x..rect.x + rect.width {
                        part.add(x, y, &sample(x, y, index));
                    }
                }
            }
            film.merge_tile(&part);
        }
    }

    fn film_of(range: Range<u64>) -> Film {
        let mut film = Film::new(35, 20, Layers::ALL).unwrap();
        film.open_range(range.start).unwrap();
        render(&mut film, 0..6, range.end);
        film.complete_through(range.end).unwrap();
        film
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(16))]
        #[test]
        fn any_split_and_order_of_merging_gives_the_same_bits(
            cuts in prop::collection::btree_set(1u64..24, 0..6), seed: u64,
        ) {
            let edges: Vec<u64> = [0].into_iter().chain(cuts).chain([24]).collect();
            let mut parts: Vec<Film> = edges.windows(2).map(|w| film_of(w[0]..w[1])).collect();
            let mut state = seed;
            let mut merged = parts.swap_remove(state as usize % parts.len());
            while !parts.is_empty() {
                state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
                merged.merge(&parts.swap_remove((state >> 33) as usize % parts.len())).unwrap();
            }
            prop_assert_eq!(merged, film_of(0..24));
        }
    }

    #[test]
    fn an_interrupted_pass_continues_tile_by_tile_to_the_same_bits() {
        let mut film = film_of(0..4);
        film.open_range(4).unwrap();
        render(&mut film, [5, 0, 2].into_iter(), 7);
        assert_eq!((film.sample_count(0, 0), film.sample_count(17, 0)), (7, 4));
        assert_eq!(film.complete_through(7), Err(RangeError::Ragged { held: 4, end: 7 }));
        film.open_range(4).unwrap();
        render(&mut film, (0..6).rev(), 9);
        film.complete_through(9).unwrap();
        assert_eq!(film, film_of(0..9));
    }

    #[test]
    fn films_that_do_not_belong_together_are_refused_unchanged() {
        let film = film_of(0..2);
        let mut other_size = Film::new(20, 35, Layers::ALL).unwrap();
        assert!(matches!(other_size.merge(&film), Err(MergeError::Sizes(..))));
        let mut other_layers = Film::new(35, 20, Layers::NONE).unwrap();
        assert_eq!(other_layers.merge(&film), Err(MergeError::Layers));
        let mut overlapping = film_of(1..3);
        assert_eq!(overlapping.merge(&film), Err(MergeError::Ranges(RangeError::Overlap(1..2))));
        assert_eq!(overlapping, film_of(1..3));
        let mut open = film_of(2..3);
        open.open_range(3).unwrap();
        assert_eq!(open.merge(&film), Err(MergeError::Incomplete(3)));
        assert_eq!(film.clone().merge(&open), Err(MergeError::Incomplete(3)));
    }

    #[test]
    fn a_pass_cannot_repeat_samples_or_leave_another_unfinished() {
        let mut film = film_of(0..2);
        assert_eq!(film.open_range(1), Err(RangeError::Overlap(1..2)));
        film.open_range(2).unwrap();
        assert_eq!(film.open_range(5), Err(RangeError::Unfinished(2)));
    }

    #[test]
    fn impossible_sizes_are_refused() {
        for (width, height) in [(0, 5), (5, 0), (u32::MAX, u32::MAX)] {
            assert_eq!(Film::new(width, height, Layers::NONE), Err(SizeError::Pixels { width, height }));
        }
    }

    #[test]
    fn a_pixel_takes_as_much_memory_as_is_stated() {
        assert_eq!(Sums::bytes(10, Layers::NONE), 1320);
        assert_eq!(Film::new(2, 5, Layers::ALL).unwrap().sums.taken_bytes(), 1280);
    }

    #[test]
    fn rejected_samples_are_counted_pixel_by_pixel_and_split_or_not() {
        let film = film_of(0..24);
        assert!(film.rejected() > 100);
        assert_eq!(film_of(0..9).rejected() + film_of(9..24).rejected(), film.rejected());
        let of_pixels = |film: &Film| film.sums.rejected.iter().filter(|&&count| count > 0).count();
        assert!(of_pixels(&film) > 100 && of_pixels(&film_of(0..1)) < of_pixels(&film));
    }
}
