//! The exact sums behind the pixels of a film or of one of its tiles.
//!
//! Per pixel: 132 bytes for Σx and Σx² of red, green, blue, the count of camera paths that met anything and the greatest
//! luminance of a sample, and, per layer that is kept and has seen anything but zero, 4 bytes (object), 8 (effort), 16 (depth), 24
//! (albedo, normal) or 48 (emission, single, multiple, shadow catcher). A 1280x720 picture of a cloud with all layers
//! (no emission) takes 247 MB, without layers 122 MB. If a sample was rejected, the counts of those take 4 bytes more.
//!
//! The number of an object and the greatest luminance are no sums: like a sum of integers, the greatest of all does not
//! depend on order or split.

use crate::estimates::LUMINANCE;
use crate::fixed_point::{LIMIT, SUM_FRACTION_BITS, SquareSum, to_fixed};
use crate::sample::{Layers, Sample};

/// Fractional bits of Σ depth: steps of 4e-15, up to 2.8e14 scene units.
pub const DEPTH_FRACTION_BITS: i32 = 48;
/// Depths must be smaller than this in magnitude, so that 2^31 of them can be added.
const DEPTH_LIMIT: f32 = 281_474_976_710_656.0;
/// Fractional bits of Σ albedo: steps of 2e-10.
pub const ALBEDO_FRACTION_BITS: i32 = 32;
/// Albedos must be smaller than this, so that 2^31 of them can be added.
const ALBEDO_LIMIT: f32 = 2.0;

/// Fractional bits of Σ normal: steps of 5e-10.
pub const NORMAL_FRACTION_BITS: i32 = 31;
/// The numbers of a normal must be smaller than this in magnitude, so that 2^31 of them can be added.
const NORMAL_LIMIT: f32 = 2.0;

/// Sums of what every pixel keeps.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct PixelSums {
    /// Σx of red, green, blue; [`SUM_FRACTION_BITS`].
    pub radiance: [i128; 3],
    /// Σx² of red, green, blue.
    pub squares: [SquareSum; 3],
    /// Camera paths that collided with a medium or met a surface.
    pub hits: u64,
}

/// Sums of the camera rays that ended on a shadow catcher.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct CatcherSums {
    /// Σ luminance that the catcher reflects, and that it would reflect without anything before its lights;
    /// [`SUM_FRACTION_BITS`].
    pub light: [i128; 2],
    /// How many rays.
    pub rays: u64,
}

/// Sums of many pixels; a plane of a layer is empty as long as all of it is zero.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Sums {
    /// Radiance and coverage, one a pixel.
    pub pixels: Vec<PixelSums>,
    /// Greatest luminance of a sample; 0 where all are black or negative.
    pub largest: Vec<f32>,
    /// How many samples had no place in the sums, and of which they hold nothing.
    pub rejected: Vec<u32>,
    /// Σ depth of hits; [`DEPTH_FRACTION_BITS`].
    pub depth: Vec<i128>,
    /// Σ albedo of hits; [`ALBEDO_FRACTION_BITS`].
    pub albedo: Vec<[u64; 3]>,
    /// Σ normal of hits, in two's complement; [`NORMAL_FRACTION_BITS`].
    pub normal: Vec<[u64; 3]>,
    /// Greatest number of the objects met.
    pub object: Vec<u32>,
    /// What shadow catchers reflect.
    pub catcher: Vec<CatcherSums>,
    /// Random numbers that the samples took.
    pub effort: Vec<u64>,
    /// Σ emission; [`SUM_FRACTION_BITS`], as the next two.
    pub emission: Vec<[i128; 3]>,
    /// Σ light scattered once.
    pub single: Vec<[i128; 3]>,
    /// Σ light scattered more than once.
    pub multiple: Vec<[i128; 3]>,
}

impl Sums {
    /// Zero sums of `count` pixels.
    pub fn zero(count: usize) -> Self {
        Self { pixels: vec![PixelSums::default(); count], ..Self::default() }
    }

    /// Memory of the sums of `count` pixels once all of the layers are in use.
    pub fn bytes(count: usize, layers: Layers) -> usize {
        let planes = [
            (layers.depth, size_of::<i128>()),
            (layers.albedo, size_of::<[u64; 3]>()),
            (layers.emission, size_of::<[i128; 3]>()),
            (layers.single, size_of::<[i128; 3]>()),
            (layers.multiple, size_of::<[i128; 3]>()),
            (layers.normal, size_of::<[u64; 3]>()),
            (layers.object_id, size_of::<u32>()),
            (layers.shadow_catcher, size_of::<CatcherSums>()),
            (layers.effort, size_of::<u64>()),
        ];
        let pixel = planes.iter().filter(|(is_kept, _)| *is_kept).map(|(_, bytes)| bytes).sum::<usize>();
        count.saturating_mul(size_of::<PixelSums>() + size_of::<f32>() + pixel)
    }

    /// Memory that is taken by now.
    pub fn taken_bytes(&self) -> usize {
        size_of_val(&*self.pixels)
            + size_of_val(&*self.depth)
            + size_of_val(&*self.albedo)
            + size_of_val(&*self.normal)
            + size_of_val(&*self.object)
            + size_of_val(&*self.catcher)
            + size_of_val(&*self.effort)
            + size_of_val(&*self.emission)
            + size_of_val(&*self.single)
            + size_of_val(&*self.multiple)
            + size_of_val(&*self.rejected)
            + size_of_val(&*self.largest)
    }

    /// Adds a sample to the pixel at `index`. If some number of it has no place in the sums (not finite, or too large),
    /// it is only counted as rejected: no sum holds anything of it.
    pub fn add(&mut self, index: usize, sample: &Sample, layers: Layers) {
        let count = self.pixels.len();
        if !representable(sample, layers) {
            count_more(&mut plane(&mut self.rejected, count)[index], 1);
            return;
        }
        let luminance = luminance(sample.radiance);
        if luminance > 0.0 {
            keep_largest(&mut plane(&mut self.largest, count)[index], luminance);
        }
        let pixel = &mut self.pixels[index];
        for (channel, &x) in sample.radiance.iter().enumerate() {
            pixel.radiance[channel] = pixel.radiance[channel].wrapping_add(to_fixed(x, SUM_FRACTION_BITS));
            pixel.squares[channel].add_square_of(x);
        }
        if sample.hit {
            pixel.hits = pixel.hits.wrapping_add(1);
            if layers.depth && sample.depth != 0.0 {
                let sum = &mut plane(&mut self.depth, count)[index];
                *sum = sum.wrapping_add(to_fixed(sample.depth, DEPTH_FRACTION_BITS));
            }
            if layers.albedo && !is_zero(sample.albedo) {
                let fixed = sample.albedo.map(|a| to_fixed(a, ALBEDO_FRACTION_BITS) as u64);
                add_words(&mut plane(&mut self.albedo, count)[index], fixed);
            }
            if layers.normal && !is_zero(sample.normal) {
                let fixed = sample.normal.map(|x| to_fixed(x, NORMAL_FRACTION_BITS) as u64);
                add_words(&mut plane(&mut self.normal, count)[index], fixed);
            }
        }
        if layers.object_id && sample.object != 0 {
            keep_greatest(&mut plane(&mut self.object, count)[index], sample.object);
        }
        if layers.shadow_catcher && sample.is_on_catcher() {
            let light = sample.catcher.map(|x| to_fixed(x, SUM_FRACTION_BITS));
            plane(&mut self.catcher, count)[index].add(CatcherSums { light, rays: 1 });
        }
        if layers.effort && sample.effort != 0 {
            let effort = &mut plane(&mut self.effort, count)[index];
            *effort = effort.wrapping_add(sample.effort.into());
        }
        for (keep, light, sums) in [
            (layers.emission, sample.emission, &mut self.emission),
            (layers.single, sample.single, &mut self.single),
            (layers.multiple, sample.multiple, &mut self.multiple),
        ] {
            if keep && !is_zero(light) {
                let fixed = light.map(|x| to_fixed(x, SUM_FRACTION_BITS));
                add_light(&mut plane(sums, count)[index], fixed);
            }
        }
    }

    /// Adds `length` pixels of `other` from `other_start` on to those of `self` from `start` on.
    pub fn add_run(&mut self, start: usize, other: &Self, other_start: usize, length: usize) {
        let run = Run { count: self.pixels.len(), to: start, from: other_start, length };
        run.add(&mut self.pixels, &other.pixels, PixelSums::add);
        run.add(&mut self.largest, &other.largest, keep_largest);
        run.add(&mut self.rejected, &other.rejected, count_more);
        run.add(&mut self.depth, &other.depth, |a, b| *a = a.wrapping_add(b));
        run.add(&mut self.albedo, &other.albedo, add_words);
        run.add(&mut self.normal, &other.normal, add_words);
        run.add(&mut self.object, &other.object, keep_greatest);
        run.add(&mut self.catcher, &other.catcher, CatcherSums::add);
        run.add(&mut self.effort, &other.effort, |a, b| *a = a.wrapping_add(b));
        run.add(&mut self.emission, &other.emission, add_light);
        run.add(&mut self.single, &other.single, add_light);
        run.add(&mut self.multiple, &other.multiple, add_light);
    }
}

/// `length` pixels from number `to` on of a film of `count` pixels, and as many from number `from` on of another.
struct Run {
    count: usize,
    to: usize,
    from: usize,
    length: usize,
}

impl Run {
    fn add<T: Copy + Default>(&self, sums: &mut Vec<T>, other: &[T], add: impl Fn(&mut T, T)) {
        if other.is_empty() {
            return;
        }
        let sums = &mut plane(sums, self.count)[self.to..self.to + self.length];
        for (a, &b) in sums.iter_mut().zip(&other[self.from..self.from + self.length]) {
            add(a, b);
        }
    }
}

impl PixelSums {
    fn add(&mut self, other: Self) {
        add_light(&mut self.radiance, other.radiance);
        for (a, b) in self.squares.iter_mut().zip(other.squares) {
            a.add(b);
        }
        self.hits = self.hits.wrapping_add(other.hits);
    }
}

impl CatcherSums {
    fn add(&mut self, other: Self) {
        add_light(&mut self.light, other.light);
        self.rays = self.rays.wrapping_add(other.rays);
    }
}

fn representable(sample: &Sample, layers: Layers) -> bool {
    // A comparison with NaN is false, so each test also refuses NaN.
    let light = |keep: bool, x: &[f32]| !keep || x.iter().all(|x| x.abs() < LIMIT);
    let albedo = |a: &f32| *a >= 0.0 && *a < ALBEDO_LIMIT;
    light(true, &sample.radiance)
        && light(layers.emission, &sample.emission)
        && light(layers.single, &sample.single)
        && light(layers.multiple, &sample.multiple)
        && light(layers.shadow_catcher && sample.is_on_catcher(), &sample.catcher)
        && (!sample.hit
            || (!layers.depth || sample.depth.abs() < DEPTH_LIMIT)
                && (!layers.albedo || sample.albedo.iter().all(albedo))
                && (!layers.normal || sample.normal.iter().all(|x| x.abs() < NORMAL_LIMIT)))
}

/// The plane of a layer, made when the first sum arrives.
fn plane<T: Copy + Default>(sums: &mut Vec<T>, count: usize) -> &mut [T] {
    if sums.is_empty() {
        sums.resize(count, T::default());
    }
    sums
}

/// Written out: arrays are compared by a call.
fn is_zero([x, y, z]: [f32; 3]) -> bool {
    x == 0.0 && y == 0.0 && z == 0.0
}

fn add_light<const N: usize>(sums: &mut [i128; N], light: [i128; N]) {
    for (sum, x) in sums.iter_mut().zip(light) {
        *sum = sum.wrapping_add(x);
    }
}

fn add_words(sums: &mut [u64; 3], words: [u64; 3]) {
    for (sum, word) in sums.iter_mut().zip(words) {
        *sum = sum.wrapping_add(word);
    }
}

fn luminance(radiance: [f32; 3]) -> f32 {
    (0..3).map(|c| LUMINANCE[c] * f64::from(radiance[c])).sum::<f64>() as f32
}

fn keep_largest(largest: &mut f32, luminance: f32) {
    *largest = luminance.max(*largest);
}

fn count_more(count: &mut u32, more: u32) {
    *count = count.wrapping_add(more);
}

fn keep_greatest(greatest: &mut u32, object: u32) {
    *greatest = object.max(*greatest);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_pixel_takes_128_bytes() {
        assert_eq!(size_of::<PixelSums>(), 128);
    }

    #[test]
    fn numbers_without_a_place_are_refused_whole() {
        let good = Sample { radiance: [1.0; 3], hit: true, depth: 2.0, ..Sample::default() };
        let bad = [
            Sample { radiance: [0.0, f32::NAN, 0.0], ..good },
            Sample { radiance: [f32::INFINITY, 0.0, 0.0], ..good },
            Sample { radiance: [-5e9, 0.0, 0.0], ..good },
            Sample { depth: f32::INFINITY, ..good },
            Sample { albedo: [-0.1, 0.0, 0.0], ..good },
            Sample { normal: [0.0, f32::NAN, 0.0], ..good },
            Sample { normal: [0.0, 0.0, -2.0], ..good },
            Sample { hit: false, object: 1, catcher: [1.0, f32::NAN], ..good },
            Sample { emission: [f32::NAN; 3], ..good },
            Sample { single: [f32::NAN; 3], ..good },
            Sample { multiple: [f32::NAN; 3], ..good },
        ];
        let mut sums = Sums::zero(1);
        for (number, sample) in (1..).zip(&bad) {
            sums.add(0, sample, Layers::ALL);
            assert_eq!(sums, Sums { rejected: vec![number], ..Sums::zero(1) }, "{sample:?}");
        }
        sums.add(0, &good, Layers::ALL);
        assert_eq!((sums.rejected[0], sums.pixels[0].hits), (bad.len() as u32, 1));
    }

    #[test]
    fn a_layer_that_is_not_kept_cannot_spoil_a_sample() {
        let bad = [f32::NAN; 3];
        let sample = Sample { hit: true, depth: f32::NAN, single: bad, normal: bad, ..Sample::default() };
        let on_catcher = Sample { object: 1, catcher: [f32::NAN; 2], ..Sample::default() };
        let mut sums = Sums::zero(1);
        sums.add(0, &sample, Layers::NONE);
        sums.add(0, &on_catcher, Layers::NONE);
        assert!(sums.rejected.is_empty());
    }

    #[test]
    fn planes_stay_empty_until_something_arrives() {
        let mut sums = Sums::zero(4);
        sums.add(1, &Sample { radiance: [1.0; 3], single: [1.0; 3], ..Sample::default() }, Layers::ALL);
        assert_eq!(sums.single.len(), 4);
        assert!(sums.multiple.is_empty() && sums.emission.is_empty() && sums.depth.is_empty());
        assert!(sums.normal.is_empty() && sums.object.is_empty() && sums.catcher.is_empty());
        assert!(sums.rejected.is_empty());
    }

    #[test]
    fn the_largest_luminance_is_kept_and_negative_ones_are_not() {
        let mut sums = Sums::zero(1);
        let grey = |x| Sample { radiance: [x; 3], ..Sample::default() };
        sums.add(0, &grey(-2.0), Layers::NONE);
        assert!(sums.largest.is_empty());
        [0.5, 4.0, 1.0].into_iter().for_each(|x| sums.add(0, &grey(x), Layers::NONE));
        assert_eq!(sums.largest, [4.0]);
    }

    #[test]
    fn opposite_normals_cancel_exactly() {
        let mut sums = Sums::zero(1);
        for normal in [[0.6, -0.8, 0.1], [-0.6, 0.8, -0.1]] {
            sums.add(0, &Sample { hit: true, normal, ..Sample::default() }, Layers::ALL);
        }
        assert_eq!(sums.normal, [[0; 3]]);
    }
}
