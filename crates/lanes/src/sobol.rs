//! Owen-scrambled Sobol points: samples of a pixel that fill the unit cube more evenly than independent ones do.
//!
//! Coordinate d of point i is the sum of the direction numbers v_d of the bits of i (Sobol 1967; Joe & Kuo 2008, file
//! new-joe-kuo-6), the sum being that of vectors of bits,
//!
//!   x_d(i) = ⊕ v_{d,k} over the bits k that are set in i.
//!
//! Owen's nested scrambling (1995) flips each digit of x by a coin that depends on all digits before it: single points
//! become uniform, so that estimates are unbiased, while each elementary interval keeps its points. The first two
//! coordinates of 2^m points with consecutive numbers, from a multiple of 2^m on, form a (0, m, 2)-net, and the variance of
//! a mean of n such points falls as n⁻³ log n for smooth integrands (Owen 1997), about as n^(-3/2) where there is a jump.
//!
//! The coins are a hash (Burley 2020, "Practical hash-based Owen scrambling"): of Laine & Karras' kind, in which each bit
//! is changed by those below it alone, with the constants of Vegdahl 2021 ("Building a better LK hash"); it runs over the
//! digits in reverse. Dimensions past the fourth are further sets of four, which take the same points in an order of
//! their own, a scrambling of i (*padding*, Burley, section 4).
//!
//! Everything is a pure function of (seed, pixel, sample, set), so that the same bits come out however work is split.

use crate::random::{GAMMA, mix};

/// Sets the hashes of this file apart from those of [`Random`](crate::Random).
const STRATIFIED: u64 = 0x6f77_656e_5f73_6f62;

/// Degree, inner coefficients and first direction numbers m of the primitive polynomials of coordinates 1 to 3 (Joe & Kuo
/// 2008, rows d = 2, 3, 4); coordinate 0 is the radical inverse of i.
const POLYNOMIALS: [(usize, u32, [u32; 3]); 3] =
    [(1, 0b0, [1, 0, 0]), (2, 0b1, [1, 3, 0]), (3, 0b01, [1, 3, 1])];

/// For each bit of i the direction numbers of the four coordinates, first digit in the lowest bit.
const DIRECTIONS: [[u32; 4]; 32] = directions();

const fn directions() -> [[u32; 4]; 32] {
    let mut directions = [[0; 4]; 32];
    let mut bit = 0;
    while bit < 32 {
        directions[bit][0] = 1 << bit;
        bit += 1;
    }
    let mut row = 0;
    while row < POLYNOMIALS.len() {
        let (degree, inner, first) = POLYNOMIALS[row];
        // With the first digit in the lowest bit, m/2^k is m reversed, and division by 2^s a shift to the left.
        let mut bit = 0;
        while bit < 32 {
            let mut v = 0;
            if bit < degree {
                v = (first[bit] << (31 - bit)).reverse_bits();
            } else {
                let back = directions[bit - degree][row + 1];
                v ^= back ^ (back << degree);
                let mut k = 1;
                while k < degree {
                    if inner >> (degree - 1 - k) & 1 == 1 {
                        v ^= directions[bit - k][row + 1];
                    }
                    k += 1;
                }
            }
            directions[bit][row + 1] = v;
            bit += 1;
        }
        row += 1;
    }
    directions
}

/// What each value of each four bits of i adds up to.
const SUMS: [[[u32; 4]; 16]; 8] = sums();

const fn sums() -> [[[u32; 4]; 16]; 8] {
    let mut sums = [[[0; 4]; 16]; 8];
    let mut place = 0;
    while place < 8 {
        let mut value = 1;
        while value < 16 {
            // The sum without the highest bit, and that bit's.
            let bit = 7 - (value as u8).leading_zeros() as usize;
            let (rest, last) = (sums[place][value & !(1 << bit)], DIRECTIONS[4 * place + bit]);
            let mut coordinate = 0;
            while coordinate < 4 {
                sums[place][value][coordinate] = rest[coordinate] ^ last[coordinate];
                coordinate += 1;
            }
            value += 1;
        }
        place += 1;
    }
    sums
}

/// The stratified numbers of one sample of one pixel: sets of up to four coordinates, each in [0, 1) and a multiple of
/// 2^-24. Different sets, pixels and seeds are independent of each other.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Stratified {
    key: u64,
    sample: u32,
}

impl Stratified {
    /// The numbers of sample `sample` of pixel `pixel` under `seed`.
    #[inline]
    pub fn new(seed: u64, pixel: u64, sample: u64) -> Stratified {
        // Each 2^32 samples are a scrambling of their own.
        let batch = sample >> 32;
        let key = mix(mix(mix(seed ^ STRATIFIED) ^ pixel.wrapping_mul(GAMMA)).wrapping_add(batch));
        Stratified { key, sample: sample as u32 }
    }

    /// The numbers of branch `branch` of `branches` into which the sample splits: points as even over all branches of all samples as
    /// the sample's own are over the samples, and independent of these. Those of a single branch are the sample's.
    #[inline]
    pub fn branch(&self, branch: u32, branches: u32) -> Stratified {
        let number = u64::from(self.sample) * u64::from(branches) + u64::from(branch);
        // What goes beyond 2^32 points is a scrambling of its own.
        let own = (number >> 32).wrapping_add(u64::from(branches - 1).wrapping_mul(STRATIFIED));
        Stratified { key: self.key.wrapping_add(own), sample: number as u32 }
    }

    /// The first coordinate of the points of set `set`.
    #[inline]
    pub fn point1(&self, set: u32) -> f32 {
        let [order, first] = halves(self.hash(set, 0));
        to_unit(scrambled(self.index(order), first).reverse_bits())
    }

    /// The first two coordinates of the points of set `set`, a (0, 2)-sequence.
    #[inline]
    pub fn point2(&self, set: u32) -> [f32; 2] {
        let [order, first] = halves(self.hash(set, 0));
        let [second, _] = halves(self.hash(set, 1));
        let index = self.index(order);
        // Two reversals for the price of one.
        let x = u64::from(scrambled(index, first));
        let y = u64::from(scrambled(second_coordinate(index), second));
        let [x, y] = halves((y << 32 | x).reverse_bits());
        [to_unit(x), to_unit(y)]
    }

    /// All four coordinates of the points of set `set`.
    #[inline]
    pub fn point4(&self, set: u32) -> [f32; 4] {
        let [order, first] = halves(self.hash(set, 0));
        let [second, third] = halves(self.hash(set, 1));
        let [fourth, _] = halves(self.hash(set, 2));
        let [x, y, z, w] = coordinates(self.index(order));
        let [x, y] = [scrambled(x, first), scrambled(y, second)];
        let [z, w] = [scrambled(z, third), scrambled(w, fourth)];
        // Two reversals for the price of one.
        let [y, x] = halves((u64::from(x) << 32 | u64::from(y)).reverse_bits());
        let [w, z] = halves((u64::from(z) << 32 | u64::from(w)).reverse_bits());
        [to_unit(x), to_unit(y), to_unit(z), to_unit(w)]
    }

    #[inline(always)]
    fn hash(&self, set: u32, number: u64) -> u64 {
        mix(self.key.wrapping_add((u64::from(set) * 4 + number).wrapping_mul(GAMMA)))
    }

    /// The point's number in the set's order: the sample's, scrambled from its first digit on, by which each aligned block
    /// of 2^m numbers goes to such a block.
    #[inline(always)]
    fn index(&self, order: u32) -> u32 {
        scrambled(self.sample.reverse_bits(), order).reverse_bits()
    }
}

/// The coordinates of point `index`, first digit in the lowest bit.
#[inline(always)]
fn coordinates(index: u32) -> [u32; 4] {
    let mut point = [0; 4];
    for (place, sums) in SUMS.iter().enumerate() {
        let sum = sums[(index >> (4 * place)) as usize % 16];
        for coordinate in 0..4 {
            point[coordinate] ^= sum[coordinate];
        }
    }
    point
}

/// Coordinate 1 of [`coordinates`]. Its direction numbers are Pascal's triangle modulo 2, the powers of (1 + x), so that it
/// is the polynomial `index` with 1 + x in place of x; and (1 + x)^16 = 1 + x^16, and so on downwards.
#[inline(always)]
fn second_coordinate(mut index: u32) -> u32 {
    index ^= index >> 16;
    index ^= (index & 0xff00_ff00) >> 8;
    index ^= (index & 0xf0f0_f0f0) >> 4;
    index ^= (index & 0xcccc_cccc) >> 2;
    index ^ (index & 0xaaaa_aaaa) >> 1
}

/// Owen's scrambling of digits that begin in the lowest bit.
#[inline(always)]
fn scrambled(mut digits: u32, seed: u32) -> u32 {
    digits ^= digits.wrapping_mul(0x3d20_adea);
    digits = digits.wrapping_add(seed);
    digits = digits.wrapping_mul(seed >> 16 | 1);
    digits ^= digits.wrapping_mul(0x0552_6c56);
    digits ^ digits.wrapping_mul(0x53a2_2864)
}

#[inline(always)]
fn halves(bits: u64) -> [u32; 2] {
    [(bits >> 32) as u32, bits as u32]
}

#[inline(always)]
fn to_unit(bits: u32) -> f32 {
    (bits >> 8) as f32 * (1.0 / (1u32 << 24) as f32)
}

#[cfg(test)]
mod tests;
