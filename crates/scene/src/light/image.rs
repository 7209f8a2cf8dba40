//! An equirectangular picture of the surroundings, sampled in proportion to its radiance.
//!
//! The sphere is cut into one cell for each texel; a cell is chosen with probability ∝ L̄ Ω, with L̄ the mean
//! of the *filtered* radiance over the cell and Ω its solid angle, and a direction uniformly within it: pdf =
//! P / Ω. The mean over the cell of the bilinear filter takes the neighbours with weights (1, 6, 1)/8 along
//! each axis, so that the pdf is positive wherever the radiance is.

use std::f64::consts::PI;

use glam::DVec3;

use super::LightSample;
use super::equirectangular::{direction_to_uv, uv_to_direction};
use super::texel_distribution::TexelDistribution;
use crate::description::ImageFilter;

/// Texels of an equirectangular picture, row by row from the top; finite and not negative.
#[derive(Debug, Clone, PartialEq)]
pub struct LightImage {
    width: usize,
    height: usize,
    texels: Vec<[f32; 3]>,
}

impl LightImage {
    /// The picture of `width` times `height` texels. None if the numbers do not fit or are 0. Values that are
    /// no radiance are mended: NaN and negative values become 0, infinite ones the greatest finite
    /// value.
    pub fn new(width: usize, height: usize, texels: Vec<[f32; 3]>) -> Option<Self> {
        if texels.is_empty() || width.checked_mul(height) != Some(texels.len()) {
            return None;
        }
        Some(Self::mended(width, height, texels).0)
    }

    /// The picture with NaN and negative values made 0 and infinite ones the greatest finite value of the
    /// picture, and how many there were.
    pub(crate) fn mended(width: usize, height: usize, mut texels: Vec<[f32; 3]>) -> (Self, usize) {
        let values = || texels.iter().flatten().copied();
        let greatest = values().filter(|value| value.is_finite()).fold(0.0, f32::max);
        let mut mended = 0;
        for value in texels.iter_mut().flatten() {
            let sound = match *value {
                f32::INFINITY => greatest,
                value if value >= 0.0 => value,
                _ => 0.0,
            };
            // Negative zero is no mistake.
            mended += usize::from(sound != *value);
            *value = sound;
        }
        (Self { width, height, texels }, mended)
    }

    /// Texels in a row.
    pub fn width(&self) -> usize {
        self.width
    }

    /// Rows.
    pub fn height(&self) -> usize {
        self.height
    }

    /// The texel of a column and a row, which must be inside.
    pub fn texel(&self, column: usize, row: usize) -> DVec3 {
        DVec3::from_array(self.texels[row * self.width + column].map(f64::from))
    }

    fn bilinear(&self, u: f64, v: f64) -> DVec3 {
        let x = u * self.width as f64 - 0.5;
        let y = (v * self.height as f64 - 0.5).clamp(0.0, (self.height - 1) as f64);
        let (left, top) = (x.floor(), y.floor());
        let (x, y) = (x - left, y - top);
        // u wraps around; v ends at the poles.
        let left = (left + self.width as f64) as usize % self.width;
        let right = (left + 1) % self.width;
        let top = top as usize;
        let bottom = (top + 1).min(self.height - 1);
        self.texel(left, top)
            .lerp(self.texel(right, top), x)
            .lerp(self.texel(left, bottom).lerp(self.texel(right, bottom), x), y)
    }

    fn nearest(&self, u: f64, v: f64) -> DVec3 {
        let [column, row] = self.texel_at(u, v);
        self.texel(column, row)
    }

    fn texel_at(&self, u: f64, v: f64) -> [usize; 2] {
        let index = |coordinate: f64, count: usize| ((coordinate * count as f64) as usize).min(count - 1);
        [index(u, self.width), index(v, self.height)]
    }

    /// Mean over the channels of the texel.
    fn brightness(&self, column: usize, row: usize) -> f64 {
        self.texel(column, row).element_sum() / 3.0
    }
}

/// A light that surrounds the scene as a picture says.
#[derive(Debug, Clone)]
pub struct ImageLight {
    image: LightImage,
    filter: ImageFilter,
    scale: f64,
    /// Sine and cosine of the rotation about +y, right-handed.
    rotation: [f64; 2],
    /// None if the picture is black: then directions are uniform.
    distribution: Option<TexelDistribution>,
    total: DVec3,
}

impl ImageLight {
    /// The surroundings of `image`, times `scale`, turned by `rotation` degrees about +y (right-handed).
    pub fn new(image: LightImage, filter: ImageFilter, scale: f64, rotation: f64) -> Self {
        let (width, height) = (image.width, image.height);
        let mut blurred = vec![0.0; width];
        let mut total = DVec3::ZERO;
        let distribution = TexelDistribution::new(width, height, |row, weights| {
            let solid_angle = cell_solid_angle(width, height, row);
            total += (0..width).map(|column| image.texel(column, row)).sum::<DVec3>() * solid_angle;
            match filter {
                ImageFilter::Nearest => {
                    for (column, weight) in weights.iter_mut().enumerate() {
                        *weight = image.brightness(column, row) * solid_angle;
                    }
                }
                ImageFilter::Bilinear => {
                    let [above, below] = [row.saturating_sub(1), (row + 1).min(height - 1)];
                    for (column, value) in blurred.iter_mut().enumerate() {
                        let outer = image.brightness(column, above) + image.brightness(column, below);
                        *value = 0.125 * outer + 0.75 * image.brightness(column, row);
                    }
                    for (column, weight) in weights.iter_mut().enumerate() {
                        let outer = blurred[(column + width - 1) % width] + blurred[(column + 1) % width];
                        *weight = (0.125 * outer + 0.75 * blurred[column]) * solid_angle;
                    }
                }
            }
        });
        let (sin, cos) = rotation.to_radians().sin_cos();
        Self { image, filter, scale, rotation: [sin, cos], distribution, total: total * scale }
    }

    /// The picture.
    pub fn image(&self) -> &LightImage {
        &self.image
    }

    pub(super) fn sample(&self, u: [f64; 2]) -> LightSample {
        let Some(distribution) = &self.distribution else {
            return super::ConstantLight::new(DVec3::ZERO).sample(u);
        };
        let (width, height) = (self.image.width, self.image.height);
        let chosen = distribution.sample(u);
        // Uniform in solid angle: uniform in u and in the cosine of the polar angle.
        let [top, bottom] = [chosen.row, chosen.row + 1].map(|edge| (PI * edge as f64 / height as f64).cos());
        let cos_polar = top + (bottom - top) * chosen.inside[1];
        let v = cos_polar.clamp(-1.0, 1.0).acos() / PI;
        let u = (chosen.column as f64 + chosen.inside[0]) / width as f64;
        let pdf = chosen.probability / cell_solid_angle(width, height, chosen.row);
        LightSample {
            toward: self.to_world(uv_to_direction(u, v)),
            distance: f64::INFINITY,
            radiance_over_pdf: self.radiance_at(u, v) / pdf,
            pdf,
            is_delta: false,
        }
    }

    pub(super) fn radiance(&self, direction: DVec3) -> DVec3 {
        let [u, v] = direction_to_uv(self.to_image(direction));
        self.radiance_at(u, v)
    }

    pub(super) fn pdf(&self, direction: DVec3) -> f64 {
        let Some(distribution) = &self.distribution else { return 1.0 / (4.0 * PI) };
        let [u, v] = direction_to_uv(self.to_image(direction));
        let [column, row] = self.image.texel_at(u, v);
        distribution.probability(column, row) / cell_solid_angle(self.image.width, self.image.height, row)
    }

    /// Sum over the texels of radiance times solid angle.
    pub(super) fn total(&self) -> DVec3 {
        self.total
    }

    fn radiance_at(&self, u: f64, v: f64) -> DVec3 {
        self.scale
            * match self.filter {
                ImageFilter::Bilinear => self.image.bilinear(u, v),
                ImageFilter::Nearest => self.image.nearest(u, v),
            }
    }

    fn to_world(&self, local: DVec3) -> DVec3 {
        let [sin, cos] = self.rotation;
        DVec3::new(cos * local.x + sin * local.z, local.y, cos * local.z - sin * local.x)
    }

    fn to_image(&self, world: DVec3) -> DVec3 {
        let [sin, cos] = self.rotation;
        DVec3::new(cos * world.x - sin * world.z, world.y, cos * world.z + sin * world.x)
    }
}

/// Solid angle of a texel's cell: (2π / width) (cos θ_top - cos θ_bottom), as a product without cancellation.
fn cell_solid_angle(width: usize, height: usize, row: usize) -> f64 {
    let half_step = 0.5 * PI / height as f64;
    let middle = PI * (row as f64 + 0.5) / height as f64;
    2.0 * PI / width as f64 * 2.0 * middle.sin() * half_step.sin()
}
