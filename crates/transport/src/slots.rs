//! Places in a pool, appended without branches.

/// Numbers of up to `ROOM` − 1 places; the last of the room takes what is written and not kept.
pub(crate) struct Slots<const ROOM: usize> {
    slots: [u16; ROOM],
    length: usize,
}

impl<const ROOM: usize> Slots<ROOM> {
    pub fn new() -> Self {
        Self { slots: [0; ROOM], length: 0 }
    }

    #[inline(always)]
    pub fn clear(&mut self) {
        self.length = 0;
    }

    #[inline(always)]
    pub fn push_if(&mut self, slot: usize, condition: bool) {
        self.slots[self.length.min(ROOM - 1)] = slot as u16;
        self.length += usize::from(condition);
    }

    #[inline(always)]
    pub fn slots(&self) -> &[u16] {
        &self.slots[..self.length.min(ROOM - 1)]
    }
}
