//! What a thread has to do: the samples of its tiles.

use std::ops::Range;

use tyndall_film::FilmTile;

use super::pool::Pixel;

/// The samples of the tiles, one tile after the other, round by round.
#[derive(Default)]
pub(crate) struct Work {
    tile: usize,
    column: u32,
    row: u32,
    /// Rounds that are done.
    done: u64,
    /// Those of the pixel before that are left.
    samples: Range<u64>,
    pixel: Pixel,
}

impl Work {
    #[inline(always)]
    pub(crate) fn next(&mut self, tiles: &[FilmTile]) -> Option<(Pixel, u64)> {
        loop {
            if let Some(sample) = self.samples.next() {
                return Some((self.pixel, sample));
            }
            let tile = tiles.get(self.tile)?;
            let (rect, rounds) = (tile.rect(), tile.rounds());
            let round = rounds.start + self.done;
            if round < rounds.end && self.row < rect.height {
                let (x, y) = (rect.x + self.column, rect.y + self.row);
                self.pixel = Pixel { tile: self.tile as u32, x, y };
                self.samples = tile.samples_of(x, y, round..round + 1);
                self.column += 1;
                if self.column == rect.width {
                    (self.column, self.row) = (0, self.row + 1);
                }
                continue;
            }
            (self.column, self.row, self.done) = (0, 0, self.done + 1);
            if rounds.start + self.done >= rounds.end {
                (self.tile, self.done) = (self.tile + 1, 0);
            }
        }
    }
}
