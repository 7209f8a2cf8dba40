//! Files in gzip, unpacked no further than a scene or a mesh could need.

use std::io::{self, Read};

use flate2::read::MultiGzDecoder;

/// Bytes that each byte of a file may unpack to. Numbers in text shrink to a third, a very regular text to a fiftieth.
const GREATEST_RATIO: u64 = 100;
/// Bytes that any file may unpack to.
const ALLOWED: u64 = 64 << 20;

/// What `source`, of `length` bytes, unpacks to; an error in the place of what is more than a file of its kind holds.
pub(crate) fn unpacked(source: impl Read, length: u64) -> impl Read {
    Bounded {
        source: MultiGzDecoder::new(source),
        left: ALLOWED.saturating_add(length.saturating_mul(GREATEST_RATIO)),
    }
}

struct Bounded<R> {
    source: R,
    left: u64,
}

impl<R: Read> Read for Bounded<R> {
    fn read(&mut self, bytes: &mut [u8]) -> io::Result<usize> {
        let length = self.source.read(bytes)?;
        match self.left.checked_sub(length as u64) {
            Some(left) => self.left = left,
            None => {
                let message = "unpacks to more than 100 times its size, as no scene does; unpack it yourself if it is sound";
                return Err(io::Error::other(message));
            }
        }
        Ok(length)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn packed(length: u64) -> Vec<u8> {
        let mut packed = Vec::new();
        let mut encoder =
            flate2::read::GzEncoder::new(io::repeat(b' ').take(length), flate2::Compression::best());
        encoder.read_to_end(&mut packed).unwrap();
        packed
    }

    #[test]
    fn a_bomb_is_not_unpacked_to_its_end() {
        let bomb = packed(100 << 20);
        let mut taken = 0;
        let mut bytes = vec![0; 1 << 16];
        let mut source = unpacked(bomb.as_slice(), bomb.len() as u64);
        let error = loop {
            match source.read(&mut bytes) {
                Ok(0) => panic!("the bomb was unpacked"),
                Ok(length) => taken += length as u64,
                Err(error) => break error.to_string(),
            }
        };
        assert!(error.contains("more than 100 times its size"), "{error}");
        assert!(taken <= ALLOWED + GREATEST_RATIO * bomb.len() as u64);
        let small = packed(1 << 20);
        let mut text = Vec::new();
        unpacked(small.as_slice(), small.len() as u64).read_to_end(&mut text).unwrap();
        assert_eq!(text.len(), 1 << 20);
    }
}
