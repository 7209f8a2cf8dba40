//! Damage to files: bits flipped, bytes put in, cut out and written over, parts of others mixed in.

/// SplitMix64 (Steele, Lea, Flood 2014).
#[derive(Debug, Clone)]
pub struct Random(pub u64);

impl Random {
    /// 64 random bits.
    pub fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// A number below `end`; 0 if that is 0.
    pub fn below(&mut self, end: usize) -> usize {
        (self.bits() % end.max(1) as u64) as usize
    }
}

/// Numbers at which sizes and indices go wrong.
const NUMBERS: [u64; 10] =
    [0, 1, u64::MAX, 1 << 31, i32::MAX as u64, i64::MAX as u64, 1 << 32, 1 << 62, 0x7f80_0000, 0x7ff0 << 48];
/// The same in text, and what texts are made of.
const WORDS: [&str; 24] = [
    "0",
    "-1",
    "1e308",
    "nan",
    "inf",
    "1e-310",
    "99999999999",
    "4294967295",
    "\"",
    "'",
    "[",
    "]",
    "{",
    "}",
    "<",
    "/>",
    "#",
    "\n",
    "\\",
    "=",
    "\u{feff}",
    "é",
    ".",
    " ",
];

/// `file` with one to four damages; `other` is what parts are taken from.
pub fn mutated(file: &[u8], other: &[u8], random: &mut Random) -> Vec<u8> {
    let mut bytes = file.to_vec();
    for _ in 0..1 + random.below(4) {
        damage(&mut bytes, other, random);
    }
    bytes
}

fn damage(bytes: &mut Vec<u8>, other: &[u8], random: &mut Random) {
    // Headers are short and say most.
    let reach = if random.below(2) == 0 { bytes.len() } else { bytes.len().min(1024) };
    let at = random.below(reach);
    let end = (at + 1 + random.below(64)).min(bytes.len());
    match random.below(8) {
        0 => {
            for _ in 0..=random.below(4) {
                let at = random.below(reach);
                bytes.iter_mut().skip(at).take(1).for_each(|byte| *byte ^= 1 << random.below(8));
            }
        }
        1 => {
            let (number, len) = (NUMBERS[random.below(NUMBERS.len())], [1, 2, 4, 8][random.below(4)]);
            let number = if random.below(4) == 0 { number.to_be_bytes() } else { number.to_le_bytes() };
            bytes.iter_mut().skip(at).take(len).zip(number).for_each(|(byte, new)| *byte = new);
        }
        2 => {
            // A number in the text gets another.
            let is_number = |byte: &u8| byte.is_ascii_digit() || *byte == b'.';
            let begin = bytes.iter().skip(at).position(is_number).map_or(at, |found| at + found);
            let end = bytes.iter().skip(begin).position(|byte| !is_number(byte));
            let end = end.map_or(bytes.len(), |found| begin + found);
            bytes.splice(begin..end, WORDS[random.below(8)].bytes());
        }
        3 => drop(bytes.splice(at..at, WORDS[random.below(WORDS.len())].bytes())),
        4 => drop(bytes.drain(at.min(end)..end)),
        5 => {
            let part = bytes.get(at..end).unwrap_or_default().to_vec();
            let to = random.below(bytes.len());
            bytes.splice(to..to, part);
        }
        6 => {
            let from = random.below(other.len());
            let part = other.iter().skip(from).take(1 + random.below(200)).copied();
            bytes.splice(at.min(end)..end, part);
        }
        _ if random.below(4) == 0 => bytes.truncate(at),
        _ => {
            bytes.iter_mut().skip(at).take(1 + random.below(16)).for_each(|byte| *byte = random.bits() as u8)
        }
    }
}
