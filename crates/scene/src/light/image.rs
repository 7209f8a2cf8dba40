//! A picture of the surroundings, equirectangular or of equal areas, sampled in proportion to its radiance.
//!
//! The sphere is cut into one cell for each texel; a cell is chosen with probability ∝ L̄ Ω, with L̄ the mean
//! of the *filtered* radiance over the cell and Ω its solid angle, and a direction uniformly within it: pdf =
//! P / Ω. The mean over the cell of the bilinear filter takes the neighbours with weights (1, 6, 1)/8 along
//! each axis, so that the pdf is positive wherever the radiance is.

use std::f64::consts::PI;

use glam::{DMat3, DVec3};

use super::texel_distribution::TexelDistribution;
use super::{LightSample, equal_area, equirectangular};
use crate::description::{ImageFilter, ImageMapping};

/// Texels of a picture of the surroundings, row by row from the top; finite and not negative.
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

    fn bilinear(&self, mapping: ImageMapping, u: f64, v: f64) -> DVec3 {
        let x = u * self.width as f64 - 0.5;
        let y = v * self.height as f64 - 0.5;
        let (left, top) = (x.floor(), y.floor());
        let (x, y) = (x - left, y - top);
        let (left, top) = (left as isize, top as isize);
        let is_inside = |at: isize, count: usize| at >= 0 && (at as usize) + 1 < count;
        if is_inside(left, self.width) && is_inside(top, self.height) {
            let above = top as usize * self.width + left as usize;
            let [above, below] = [above, above + self.width];
            let texel = |number: usize| DVec3::from_array(self.texels[number].map(f64::from));
            return (texel(above).lerp(texel(above + 1), x)).lerp(texel(below).lerp(texel(below + 1), x), y);
        }
        let texel = |column: isize, row: isize| {
            let [column, row] = self.wrapped(mapping, column, row);
            self.texel(column, row)
        };
        texel(left, top)
            .lerp(texel(left + 1, top), x)
            .lerp(texel(left, top + 1).lerp(texel(left + 1, top + 1), x), y)
    }

    /// The texel that lies on the sphere where a column and a row, at most one beyond the picture, would go on.
    fn wrapped(&self, mapping: ImageMapping, column: isize, row: isize) -> [usize; 2] {
        let (width, height) = (self.width as isize, self.height as isize);
        let [column, row] = match mapping {
            // Longitude goes round; latitude ends at the poles.
            ImageMapping::Equirectangular => [column.rem_euclid(width), row.clamp(0, height - 1)],
            // Each edge is folded together about its middle.
            ImageMapping::EqualArea => {
                let beyond = |at: isize, count: isize| at < 0 || at >= count;
                let (column, row) = if beyond(column, width) {
                    (column.clamp(0, width - 1), height - 1 - row)
                } else {
                    (column, row)
                };
                if beyond(row, height) {
                    [width - 1 - column, row.clamp(0, height - 1)]
                } else {
                    [column, row]
                }
            }
        };
        [column as usize, row as usize]
    }

    fn nearest(&self, u: f64, v: f64) -> DVec3 {
        let [column, row] = self.texel_at(u, v);
        self.texel(column, row)
    }

    fn texel_at(&self, u: f64, v: f64) -> [usize; 2] {
        let index = |coordinate: f64, count: usize| ((coordinate * count as f64) as usize).min(count - 1);
        [index(u, self.width), index(v, self.height)]
    }

    /// Mean brightness of the bilinear filter over a texel's cell.
    fn mean_of_cell(&self, mapping: ImageMapping, column: usize, row: usize) -> f64 {
        let weights = [(-1, 0.125), (0, 0.75), (1, 0.125)];
        let mut sum = 0.0;
        for (down, row_weight) in weights {
            for (across, column_weight) in weights {
                let [column, row] = self.wrapped(mapping, column as isize + across, row as isize + down);
                sum += row_weight * column_weight * self.brightness(column, row);
            }
        }
        sum
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
    mapping: ImageMapping,
    filter: ImageFilter,
    scale: f64,
    /// Directions of the picture to those of the scene; orthogonal.
    orientation: DMat3,
    /// None if the picture is black: then directions are uniform.
    distribution: Option<TexelDistribution>,
    total: DVec3,
}

impl ImageLight {
    /// The surroundings of the equirectangular `image`, times `scale`, turned by `rotation` degrees about +y
    /// (right-handed).
    pub fn new(image: LightImage, filter: ImageFilter, scale: f64, rotation: f64) -> Self {
        let orientation = crate::rotation(DVec3::Y, rotation.to_radians());
        Self::mapped(image, ImageMapping::Equirectangular, filter, scale, orientation)
    }

    /// The surroundings of `image`, times `scale`; `orientation`, a rotation that may mirror, leads from its directions to
    /// those of the scene. Equal areas need a picture as wide as it is high.
    pub fn mapped(
        image: LightImage,
        mapping: ImageMapping,
        filter: ImageFilter,
        scale: f64,
        orientation: DMat3,
    ) -> Self {
        let (width, height) = (image.width, image.height);
        let mut blurred = vec![0.0; width];
        let mut total = DVec3::ZERO;
        let distribution = TexelDistribution::new(width, height, |row, weights| {
            let solid_angle = cell_solid_angle(mapping, width, height, row);
            total += (0..width).map(|column| image.texel(column, row)).sum::<DVec3>() * solid_angle;
            match (filter, mapping) {
                (ImageFilter::Nearest, _) => {
                    for (column, weight) in weights.iter_mut().enumerate() {
                        *weight = image.brightness(column, row) * solid_angle;
                    }
                }
                (ImageFilter::Bilinear, ImageMapping::Equirectangular) => {
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
                (ImageFilter::Bilinear, ImageMapping::EqualArea) => {
                    for (column, weight) in weights.iter_mut().enumerate() {
                        *weight = image.mean_of_cell(mapping, column, row) * solid_angle;
                    }
                }
            }
        });
        Self { image, mapping, filter, scale, orientation, distribution, total: total * scale }
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
        // Uniform in solid angle: on the globe, uniform in the cosine of the polar angle.
        let v = match self.mapping {
            ImageMapping::EqualArea => (chosen.row as f64 + chosen.inside[1]) / height as f64,
            ImageMapping::Equirectangular => {
                let edge = |row: usize| libm::cos(PI * row as f64 / height as f64);
                let [top, bottom] = [chosen.row, chosen.row + 1].map(edge);
                let cos_polar = top + (bottom - top) * chosen.inside[1];
                libm::acos(cos_polar.clamp(-1.0, 1.0)) / PI
            }
        };
        let u = (chosen.column as f64 + chosen.inside[0]) / width as f64;
        let pdf = chosen.probability / cell_solid_angle(self.mapping, width, height, chosen.row);
        LightSample {
            toward: self.orientation * self.uv_to_direction(u, v),
            distance: f64::INFINITY,
            radiance_over_pdf: self.radiance_at(u, v) / pdf,
            pdf,
            is_delta: false,
        }
    }

    pub(super) fn radiance(&self, direction: DVec3) -> DVec3 {
        let [u, v] = self.direction_to_uv(direction);
        self.radiance_at(u, v)
    }

    pub(super) fn pdf(&self, direction: DVec3) -> f64 {
        let Some(distribution) = &self.distribution else { return 1.0 / (4.0 * PI) };
        let [u, v] = self.direction_to_uv(direction);
        let [column, row] = self.image.texel_at(u, v);
        let (width, height) = (self.image.width, self.image.height);
        distribution.probability(column, row) / cell_solid_angle(self.mapping, width, height, row)
    }

    /// Sum over the texels of radiance times solid angle.
    pub(super) fn total(&self) -> DVec3 {
        self.total
    }

    fn radiance_at(&self, u: f64, v: f64) -> DVec3 {
        self.scale
            * match self.filter {
                ImageFilter::Bilinear => self.image.bilinear(self.mapping, u, v),
                ImageFilter::Nearest => self.image.nearest(u, v),
            }
    }

    fn uv_to_direction(&self, u: f64, v: f64) -> DVec3 {
        match self.mapping {
            ImageMapping::Equirectangular => equirectangular::uv_to_direction(u, v),
            ImageMapping::EqualArea => equal_area::equal_area_to_direction(u, v),
        }
    }

    /// The place in the picture of a direction in the scene.
    fn direction_to_uv(&self, direction: DVec3) -> [f64; 2] {
        let direction = self.orientation.transpose() * direction;
        match self.mapping {
            ImageMapping::Equirectangular => equirectangular::direction_to_uv(direction),
            ImageMapping::EqualArea => equal_area::direction_to_equal_area(direction),
        }
    }
}

/// Solid angle of a texel's cell; on the globe (2π / width) (cos θ_top - cos θ_bottom), as a product without cancellation.
fn cell_solid_angle(mapping: ImageMapping, width: usize, height: usize, row: usize) -> f64 {
    match mapping {
        ImageMapping::EqualArea => 4.0 * PI / (width as f64 * height as f64),
        ImageMapping::Equirectangular => {
            let half_step = 0.5 * PI / height as f64;
            let middle = PI * (row as f64 + 0.5) / height as f64;
            2.0 * PI / width as f64 * 2.0 * libm::sin(middle) * libm::sin(half_step)
        }
    }
}
