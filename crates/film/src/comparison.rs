//! How far one picture is from another, and whether noise explains it.
//!
//! With pictures A and B and the mean ⟨·⟩ over pixels and channels,
//!
//! ```text
//! MSE = ⟨(A − B)²⟩    relMSE = ⟨(A − B)² / (B² + 0.01)⟩    z = (⟨A⟩ − ⟨B⟩) / SE   per channel
//! ```
//!
//! so that B is the reference (relMSE after Rousselle et al. 2011). The trimmed relMSE leaves out the worst 0.1 % of
//! the pixels, which a handful of fireflies would otherwise decide. The standard error SE comes from the
//! `StandardError` layers of both pictures if they have them; if not, from the scatter of the differences between
//! pixels, which takes them for independent and B for far less noisy, or at least for noise of its own. Either way
//! two renders with the same seed are *not* independent and look more alike than SE says. A z is normal only as far as
//! the means are: with few samples and rare bright ones, blocks stray further than stated.

mod perceptual;
mod picture;
mod significance;

use serde::Serialize;

pub use picture::Picture;

use crate::estimates::Estimate;
use significance::{block_tests, critical_z, two_sided_tail};

/// Edge of the blocks that are tested one by one, in pixels; incomplete ones at the borders are left out.
const BLOCK_EDGE: usize = 16;
/// Probability of calling two pictures of the same scene significantly different.
const SIGNIFICANCE_LEVEL: f64 = 0.01;
/// Share of the pixels that the trimmed relMSE leaves out.
const TRIM: f64 = 0.001;
/// Added to B² in relMSE.
const RELMSE_OFFSET: f64 = 0.01;

/// Where the standard error of differences comes from.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum ErrorSource {
    /// The `StandardError` layers of both pictures.
    StandardErrorLayers,
    /// The scatter of the differences between pixels.
    PixelDifferences,
}

/// The result of [`compare`].
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Comparison {
    /// Mean of (A−B)².
    pub mse: f64,
    /// Mean of (A−B)²/(B²+0.01).
    pub relmse: f64,
    /// The same without the worst 0.1 % of the pixels.
    pub relmse_trimmed: f64,
    /// Perceived difference, 0 to 1: both exposed so that B has a mean luminance of 0.25, tone-mapped as for a
    /// screen, blurred by what the eye resolves (σ = 1 pixel, as at 67 pixels a degree), mean of the HyAB
    /// distance |ΔL*| + |Δ(a*, b*)| in CIELAB, each at most 100, over 100. It follows FLIP (Andersson et al. 2020)
    /// in this, without its edge and point detectors, so its numbers are not those of FLIP.
    pub flip_like: f64,
    /// Mean of A per channel.
    pub mean_a: [f64; 3],
    /// Mean of B per channel.
    pub mean_b: [f64; 3],
    /// `mean_a` − `mean_b`.
    pub mean_difference: [f64; 3],
    /// Standard error of `mean_difference`.
    pub standard_error: [f64; 3],
    /// Where it comes from.
    pub standard_error_from: ErrorSource,
    /// `mean_difference` / `standard_error`.
    pub z: [f64; 3],
    /// The same in blocks of pixels.
    pub blocks: BlockSummary,
    /// Whether some of these z is larger than noise explains: the two-sided probability of the largest, multiplied
    /// by their number (Bonferroni), is below `significance_level`.
    pub significant: bool,
    /// Probability that `significant` is said of two pictures that differ by noise only.
    pub significance_level: f64,
    /// The least |z| that is significant.
    pub critical_z: f64,
    /// Pixels with NaN or infinity in A or B; such values count as 0.
    pub non_finite_pixels: usize,
}

/// z of the means of 16x16 blocks of pixels, in each channel.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct BlockSummary {
    /// Edge of a block in pixels.
    pub edge: usize,
    /// Number of z, three a block.
    pub tests: usize,
    /// How many have |z| > 3.
    pub beyond_3_sigma: usize,
    /// How many would have by noise alone.
    pub expected_beyond_3_sigma: f64,
    /// The greatest |z|.
    pub largest_z: f64,
}

/// Compares two pictures of the same size; the error is one line without names of files.
pub fn compare(a: &Picture, b: &Picture) -> Result<Comparison, String> {
    if (a.width, a.height) != (b.width, b.height) {
        return Err(format!(
            "the sizes differ, {}x{} and {}x{}; render both at the same size",
            a.width, a.height, b.width, b.height
        ));
    }
    let non_finite = |(a, b): &(&[f32; 3], &[f32; 3])| !a.iter().chain(b.iter()).all(|x| x.is_finite());
    let non_finite_pixels = a.rgb.iter().zip(&b.rgb).filter(non_finite).count();
    let (a, b) = (&a.with_finite_colours(), &b.with_finite_colours());
    let errors = Errors::of(a, b);

    let mean = errors.mean_difference();
    let z = mean.map(|difference| ratio(difference.mean, difference.standard_error));
    let (mut tests, mut beyond, mut largest) = (0, 0, 0.0f64);
    for z in block_tests(a, b, BLOCK_EDGE) {
        tests += 1;
        beyond += usize::from(z.abs() > 3.0);
        largest = largest.max(z.abs());
    }
    let critical = critical_z(SIGNIFICANCE_LEVEL / (tests + z.len()) as f64);
    Ok(Comparison {
        mse: errors.mse(),
        relmse: errors.relmse(),
        relmse_trimmed: errors.relmse_trimmed(),
        flip_like: perceptual::difference(a, b),
        mean_a: a.mean(),
        mean_b: b.mean(),
        mean_difference: mean.map(|difference| difference.mean),
        standard_error: mean.map(|difference| difference.standard_error),
        standard_error_from: errors.source(),
        z,
        blocks: BlockSummary {
            edge: BLOCK_EDGE,
            tests,
            beyond_3_sigma: beyond,
            expected_beyond_3_sigma: tests as f64 * two_sided_tail(3.0),
            largest_z: largest,
        },
        significant: z.iter().fold(largest, |most, z| most.max(z.abs())) > critical,
        significance_level: SIGNIFICANCE_LEVEL,
        critical_z: critical,
        non_finite_pixels,
    })
}

/// The differences of two pictures, pixel by pixel.
struct Errors<'a> {
    a: &'a Picture,
    b: &'a Picture,
    /// Mean of (A−B)²/(B²+0.01) over the channels of a pixel.
    relative: Vec<f64>,
}

impl<'a> Errors<'a> {
    fn of(a: &'a Picture, b: &'a Picture) -> Self {
        let relative = |(a, b): (&[f32; 3], &[f32; 3])| {
            let term = |c: usize| {
                let (a, b) = (f64::from(a[c]), f64::from(b[c]));
                (a - b).powi(2) / (b * b + RELMSE_OFFSET)
            };
            (term(0) + term(1) + term(2)) / 3.0
        };
        Self { a, b, relative: a.rgb.iter().zip(&b.rgb).map(relative).collect() }
    }

    fn mse(&self) -> f64 {
        let differences = self.a.rgb.iter().flatten().zip(self.b.rgb.iter().flatten());
        let sum: f64 = differences.map(|(&a, &b)| (f64::from(a) - f64::from(b)).powi(2)).sum();
        sum / (3 * self.relative.len()) as f64
    }

    fn relmse(&self) -> f64 {
        self.relative.iter().sum::<f64>() / self.relative.len() as f64
    }

    fn relmse_trimmed(&self) -> f64 {
        let mut sorted = self.relative.clone();
        sorted.sort_unstable_by(f64::total_cmp);
        sorted.truncate(sorted.len() - (sorted.len() as f64 * TRIM).ceil() as usize);
        sorted.iter().sum::<f64>() / sorted.len().max(1) as f64
    }

    fn source(&self) -> ErrorSource {
        match significance::layers(self.a, self.b) {
            Some(_) => ErrorSource::StandardErrorLayers,
            None => ErrorSource::PixelDifferences,
        }
    }

    fn mean_difference(&self) -> [Estimate; 3] {
        let everything: Vec<usize> = (0..self.relative.len()).collect();
        significance::mean_difference(self.a, self.b, &everything)
    }
}

/// x/y, with 0/0 = 0: no difference is none, however exact.
fn ratio(x: f64, y: f64) -> f64 {
    if x == 0.0 { 0.0 } else { x / y }
}

#[cfg(test)]
mod tests;
