//! A cell of the grid in one word: what is there, and between which bounds its filtered values lie.

/// Least and greatest value.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Bounds {
    /// No value is below this.
    pub min: f32,
    /// No value is above this.
    pub max: f32,
}

impl Bounds {
    /// The bounds of no values: the neutral element of [`Bounds::union`].
    pub const EMPTY: Bounds = Bounds { min: f32::INFINITY, max: f32::NEG_INFINITY };

    /// The bounds of one value.
    pub fn of(value: f32) -> Bounds {
        Bounds { min: value, max: value }
    }

    /// The bounds of both.
    #[must_use]
    pub fn union(self, other: Bounds) -> Bounds {
        Bounds { min: self.min.min(other.min), max: self.max.max(other.max) }
    }
}

/// What a cell holds.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Content {
    /// One value, by its index among the grid's constants.
    Constant(u32),
    /// 8³ voxels, by the index of the brick.
    Brick(u32),
    /// 4³ smaller cells, by the index in `entries` of the first.
    Node(u32),
}

/// Bits 0-1: kind of content; 2-31: its index; 32-47: minimum; 48-63: maximum (bfloat16, rounded outwards).
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Entry(u64);

pub(super) const KIND_CONSTANT: u32 = 0;
pub(super) const KIND_BRICK: u32 = 1;
pub(super) const KIND_NODE: u32 = 2;

/// Greatest index that fits into an entry.
pub(super) const INDEX_LIMIT: usize = 1 << 30;

impl Entry {
    pub(super) fn new(content: Content, bounds: Bounds) -> Entry {
        let (kind, index) = match content {
            Content::Constant(index) => (KIND_CONSTANT, index),
            Content::Brick(index) => (KIND_BRICK, index),
            Content::Node(index) => (KIND_NODE, index),
        };
        let low = u64::from(index << 2 | kind);
        let min = u64::from(bf16_below(bounds.min));
        let max = u64::from(bf16_below(-bounds.max) ^ 0x8000);
        Entry(low | min << 32 | max << 48)
    }

    #[inline(always)]
    pub(super) fn kind(self) -> u32 {
        self.0 as u32 & 3
    }

    #[inline(always)]
    pub(super) fn index(self) -> u32 {
        (self.0 as u32) >> 2
    }

    #[inline(always)]
    pub(super) fn min(self) -> f32 {
        f32::from_bits((self.0 >> 16) as u32 & 0xffff_0000)
    }

    #[inline(always)]
    pub(super) fn max(self) -> f32 {
        f32::from_bits((self.0 >> 32) as u32 & 0xffff_0000)
    }

    pub(super) fn bounds(self) -> Bounds {
        Bounds { min: self.min(), max: self.max() }
    }
}

/// The greatest bfloat16 that is not above `x`, as bits. Values past the range stay at its ends, which are those
/// of f32 to within rounding; callers hold finite values only.
fn bf16_below(x: f32) -> u16 {
    let bits = x.to_bits();
    let truncated = (bits >> 16) as u16;
    let exact = bits & 0xffff == 0;
    // Truncation moves towards 0: that is downwards unless x is negative.
    if x.is_sign_negative() && !exact { truncated + 1 } else { truncated }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn entries_keep_their_content_and_round_bounds_outwards() {
        for content in [Content::Constant(0), Content::Brick(77), Content::Node((INDEX_LIMIT - 1) as u32)] {
            for (min, max) in
                [(0.0, 0.0), (0.1, 0.3), (-0.7, 1e-9), (-3.3e7, -1e-20), (1.0, 1.0), (-0.0, 0.5)]
            {
                let entry = Entry::new(content, Bounds { min, max });
                let (kind, index) = match content {
                    Content::Constant(i) => (KIND_CONSTANT, i),
                    Content::Brick(i) => (KIND_BRICK, i),
                    Content::Node(i) => (KIND_NODE, i),
                };
                assert_eq!((entry.kind(), entry.index()), (kind, index));
                assert!(entry.min() <= min && entry.min() >= min - min.abs() / 127.0);
                assert!(entry.max() >= max && entry.max() <= max + max.abs() / 127.0);
            }
        }
        let zero = Entry::new(Content::Constant(0), Bounds::of(0.0));
        assert_eq!(zero.bounds(), Bounds::of(0.0));
    }
}
