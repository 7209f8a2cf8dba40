//! Which rays the estimators are tried on: those asked for, or some of the camera's.

use glam::DVec3;
use miette::miette;
use tyndall_scene::{Ray, Scene};
use tyndall_transport::{AlongRay, Lookups};

/// A ray with what it meets.
pub struct ChosenRay<'a> {
    /// The pixel through whose middle it goes, if it is a camera ray.
    pub pixel: Option<[u32; 2]>,
    /// The ray.
    pub ray: Ray,
    /// What it meets.
    pub along: AlongRay<'a>,
    /// Its optical thickness.
    pub optical_thickness: f64,
}

/// A ray as the command line names it.
#[derive(Debug, Clone, Copy)]
pub enum Request {
    /// Through the middle of a pixel.
    Pixel([u32; 2]),
    /// From a point in a direction of unit length.
    Ray(Ray),
}

/// Optical thickness of the rays that are looked for: thin, middling and thick, and all with light to be estimated.
const TARGETS: [f64; 3] = [0.1, 1.0, 4.0];
/// Most columns and rows of pixels among which they are looked for.
const CANDIDATES: [u32; 2] = [40, 24];
/// No number shows what is behind more than this.
const OPAQUE: f64 = 800.0;

/// The rays asked for.
///
/// # Errors
/// One line that says which ray meets nothing, or which pixel is outside the picture.
pub fn requested<'a>(scene: &'a Scene, requests: &[Request]) -> miette::Result<Vec<ChosenRay<'a>>> {
    let [width, height] = scene.resolution;
    let chosen = requests.iter().map(|request| {
        let (pixel, ray, name) = match *request {
            Request::Pixel([x, y]) if x >= width || y >= height => {
                return Err(miette!(
                    "--pixel {x},{y}: the picture has {width}x{height} pixels, counted from 0,0 at the upper left"
                ));
            }
            Request::Pixel(pixel) => {
                (Some(pixel), through_middle(scene, pixel), format!("--pixel {},{}", pixel[0], pixel[1]))
            }
            Request::Ray(ray) => (None, ray, format!("--ray from {} along {}", ray.origin, ray.direction)),
        };
        ChosenRay::new(scene, pixel, ray, f64::INFINITY)
            .map(|chosen| chosen.cut(scene, OPAQUE))
            .ok_or_else(|| miette!("{name}: meets no medium; choose another, or leave it away to have rays chosen"))
    });
    chosen.collect()
}

/// Camera rays of about the optical thicknesses looked for, as far as there are such; where all are much thicker,
/// the first part of one.
pub fn chosen_from_camera(scene: &Scene) -> Vec<ChosenRay<'_>> {
    let candidates: Vec<ChosenRay> = candidate_pixels(scene.resolution)
        .filter_map(|pixel| ChosenRay::new(scene, Some(pixel), through_middle(scene, pixel), f64::INFINITY))
        .collect();
    let mut chosen: Vec<ChosenRay> = Vec::new();
    for target in TARGETS {
        let score = |candidate: &ChosenRay| {
            let off_target = (candidate.optical_thickness / target).ln().abs();
            off_target + 0.1 * off_middle(candidate.pixel, scene.resolution)
        };
        let nearest = candidates.iter().min_by(|a, b| score(a).total_cmp(&score(b)));
        let Some(nearest) = nearest else { break };
        let ray = if nearest.optical_thickness > 2.0 * target {
            nearest.cut(scene, target)
        } else {
            nearest.cut(scene, OPAQUE)
        };
        let is_new = |other: &ChosenRay| (ray.optical_thickness / other.optical_thickness).ln().abs() > 0.2;
        if chosen.iter().all(is_new) {
            chosen.push(ray);
        }
    }
    chosen
}

/// Middles of equal parts of the picture.
fn candidate_pixels([width, height]: [u32; 2]) -> impl Iterator<Item = [u32; 2]> {
    let [columns, rows] = [width.min(CANDIDATES[0]), height.min(CANDIDATES[1])];
    let middle = |i: u32, parts: u32, size: u32| {
        let twice = u64::from(2 * i + 1) * u64::from(size);
        (twice / u64::from(2 * parts)) as u32
    };
    (0..rows).flat_map(move |row| {
        (0..columns).map(move |column| [middle(column, columns, width), middle(row, rows, height)])
    })
}

/// 0 in the middle of the picture, 1 in the middle of its edges.
fn off_middle(pixel: Option<[u32; 2]>, resolution: [u32; 2]) -> f64 {
    let Some(pixel) = pixel else { return 0.0 };
    let offset = [0, 1].map(|i| 2.0 * (f64::from(pixel[i]) + 0.5) / f64::from(resolution[i]) - 1.0);
    offset[0].hypot(offset[1])
}

fn through_middle(scene: &Scene, pixel: [u32; 2]) -> Ray {
    scene.camera.ray(pixel, [0.5; 2], [0.5; 2])
}

impl<'a> ChosenRay<'a> {
    /// `None` if there is no extinction before the distance `end`.
    fn new(scene: &'a Scene, pixel: Option<[u32; 2]>, ray: Ray, end: f64) -> Option<Self> {
        let along = AlongRay::through(&scene.volumes, &ray, end)?;
        let optical_thickness = along.thickness(f64::INFINITY, &mut Lookups::default());
        if optical_thickness.is_nan() || optical_thickness <= 0.0 {
            return None;
        }
        Some(Self { pixel, ray, along: along.with_point_light_of(scene, &ray), optical_thickness })
    }

    /// The ray up to where its optical thickness is `most`.
    fn cut(&self, scene: &'a Scene, most: f64) -> Self {
        let end = self.along.distance_at(most, &mut Lookups::default());
        let cut = end.and_then(|end| Self::new(scene, self.pixel, self.ray, end));
        cut.unwrap_or_else(|| Self { along: self.along.clone(), ..*self })
    }
}

/// `--pixel X,Y`
pub fn parse_pixel(text: &str) -> Result<[u32; 2], String> {
    let pixel =
        text.split_once(',').and_then(|(x, y)| Some([x.trim().parse().ok()?, y.trim().parse().ok()?]));
    pixel.ok_or("write X,Y counted from the upper left, such as 320,180".into())
}

/// `--ray OX,OY,OZ,DX,DY,DZ`
pub fn parse_ray(text: &str) -> Result<Ray, String> {
    let numbers: Vec<f64> = text.split(',').filter_map(|number| number.trim().parse().ok()).collect();
    let is_complete = numbers.len() == 6 && text.split(',').count() == 6;
    if !is_complete || numbers.iter().any(|number| !number.is_finite()) {
        return Err("write origin and direction, OX,OY,OZ,DX,DY,DZ".into());
    }
    let direction = DVec3::from_slice(&numbers[3..]).try_normalize();
    let direction = direction.ok_or("the direction DX,DY,DZ has no length")?;
    Ok(Ray { origin: DVec3::from_slice(&numbers), direction })
}
