//! What a thread has to do: the samples of its tiles.

use tyndall_film::FilmTile;

use super::pool::Pixel;

/// The samples of the tiles, one after the other.
#[derive(Default)]
pub(crate) struct Work {
    tile: usize,
    column: u32,
    row: u32,
    done: u64,
}

impl Work {
    #[inline(always)]
    pub(crate) fn next(&mut self, tiles: &[FilmTile]) -> Option<(Pixel, u64)> {
        loop {
            let tile = tiles.get(self.tile)?;
            let (rect, samples) = (tile.rect(), tile.samples());
            if samples.start + self.done < samples.end && self.row < rect.height {
                let pixel = Pixel { tile: self.tile as u32, x: rect.x + self.column, y: rect.y + self.row };
                let sample = samples.start + self.done;
                self.column += 1;
                if self.column == rect.width {
                    (self.column, self.row) = (0, self.row + 1);
                }
                return Some((pixel, sample));
            }
            (self.column, self.row, self.done) = (0, 0, self.done + 1);
            if samples.start + self.done >= samples.end {
                (self.tile, self.done) = (self.tile + 1, 0);
            }
        }
    }
}
