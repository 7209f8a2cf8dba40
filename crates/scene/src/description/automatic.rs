//! The scene of a bare volume: framed, lit by sun and sky, with a density scale chosen from the data.
//!
//! The extinction per grid value is `mu_t = 16 / (mean · ℓ)`: a body of the grid's mean value has the optical
//! thickness 16 along ℓ, which is bright and opaque in the middle and still translucent at the rim. ℓ = b
//! f^(1/3) is the size of the body: b is the middle one of the box's three edges and f the fraction of the
//! box that is active, so that f^(1/3) is the part of an edge that a compact body fills.

use glam::DVec3;
use tyndall_optics::planck;
use tyndall_volumes::GridClass;

use super::lights::direction_of_compass;
use super::{
    CameraDescription, EmissionGridDescription, FilmDescription, GridMeaning, LightDescription,
    MediumDescription, PhaseDescription, Projection, SceneDescription, SkyDescription, SpectrumDescription,
    SpectrumTable, TemperatureDescription, VolumeDescription,
};

/// What is known of a grid when a scene for it is made up.
#[derive(Debug, Clone, PartialEq)]
pub struct VolumeSummary {
    /// Name of the grid in its file.
    pub grid_name: String,
    /// Least and greatest corner of the active voxels, world units.
    pub world_box: [DVec3; 2],
    /// Mean of the active values.
    pub mean: f64,
    /// Greatest active value.
    pub max: f64,
    /// Fraction of the box's voxels that are active.
    pub active_fraction: f64,
    /// Edge of a voxel, world units.
    pub voxel_size: f64,
    /// What the values are, as the file says.
    pub class: GridClass,
    /// Whether the grid is taken for a temperature for lack of a density.
    pub value_is_temperature: bool,
    /// A grid beside it by which the volume glows.
    pub glow: Option<Glow>,
}

/// A grid by which a volume glows.
#[derive(Debug, Clone, PartialEq)]
pub enum Glow {
    /// Temperatures in kelvin.
    Temperature {
        /// Name of the grid.
        grid_name: String,
        /// Greatest active value, K.
        max: f64,
    },
    /// Brightness without a unit.
    Flame {
        /// Name of the grid.
        grid_name: String,
        /// Greatest active value.
        max: f64,
    },
}

impl Glow {
    /// What a grid of this name, with this greatest value, says of a glow: temperatures are taken for such if they can be
    /// kelvin of something that is seen to glow.
    pub fn of_grid(grid_name: &str, max: f64) -> Option<Glow> {
        let name = grid_name.to_ascii_lowercase();
        let grid_name = grid_name.to_owned();
        if name.contains("temperature") && (LEAST_KELVIN..1e5).contains(&max) {
            Some(Self::Temperature { grid_name, max })
        } else if ["flame", "heat", "fire"].iter().any(|word| name.contains(word))
            && max > 0.0
            && max.is_finite()
        {
            Some(Self::Flame { grid_name, max })
        } else {
            None
        }
    }
}

/// A made-up scene, and what it says of its choices.
#[derive(Debug, Clone, PartialEq)]
pub struct AutomaticScene {
    /// The scene.
    pub description: SceneDescription,
    /// Comments: the path of a key and what to say above it.
    pub notes: Vec<(Vec<String>, String)>,
}

impl AutomaticScene {
    /// The scene file with its comments.
    pub fn to_toml(&self) -> String {
        self.description.to_toml_with_notes(&self.notes)
    }
}

const OPTICAL_THICKNESS: f64 = 16.0;
/// Below this temperature nothing is seen to glow.
const LEAST_KELVIN: f64 = 700.0;
/// Luminance of the brightest flames, times that of white.
const GLOW: f64 = 4.0;
/// Colour of flames without a temperature, K.
const FLAME_KELVIN: f64 = 1900.0;
const ALBEDO: f64 = 0.99;
const ASYMMETRY: f64 = 0.5;
/// Part of the picture's width or height that the box fills.
const FILLED: f64 = 0.97;
const VERTICAL_FOV: f64 = 30.0;
/// Stops above the exposure that shows a white surface in full sun as white: a body that is partly shaded, before a
/// deep blue sky, looks dull at 0.
const EXPOSURE: f64 = 0.4;
/// The sun stands in the east and the viewer south-east of the volume, so that light comes from the right and
/// shapes it.
const SUN: [f64; 2] = [35.0, 90.0];
/// Elevation and azimuth of the viewer as seen from the volume: below it, so that the sky is behind it.
const VIEWER: [f64; 2] = [-20.0, 150.0];

impl SceneDescription {
    /// A scene that shows the grid of `summary` from `file`.
    pub fn for_volume(file: &str, summary: &VolumeSummary) -> AutomaticScene {
        let film = FilmDescription { exposure: EXPOSURE, ..FilmDescription::default() };
        let aspect = f64::from(film.resolution[0]) / f64::from(film.resolution[1]);
        let is_level_set = summary.class == GridClass::LevelSet;
        let description = Self {
            unit: super::default_unit(),
            camera: framing_camera(sound_box(summary), aspect),
            film,
            render: Default::default(),
            medium: None,
            materials: Vec::new(),
            shapes: Vec::new(),
            volumes: vec![VolumeDescription {
                file: Some(file.to_owned()),
                grid: Some(summary.grid_name.clone()),
                values: Some(if is_level_set { GridMeaning::SignedDistance } else { GridMeaning::Density }),
                medium: MediumDescription {
                    mu_t: Some(extinction(summary).into()),
                    albedo: Some(ALBEDO.into()),
                    phase: Some(PhaseDescription::Hg { g: ASYMMETRY }),
                    ..glowing(summary).medium
                },
                ..glowing(summary)
            }],
            lights: vec![LightDescription::Sky(SkyDescription {
                sun_elevation: Some(SUN[0]),
                sun_azimuth: Some(SUN[1]),
                ..SkyDescription::default()
            })],
            meters: Vec::new(),
        };
        AutomaticScene { notes: notes(summary), description }
    }
}

/// The keys by which the volume glows.
fn glowing(summary: &VolumeSummary) -> VolumeDescription {
    let mut volume = VolumeDescription::default();
    match &summary.glow {
        None => {}
        Some(Glow::Temperature { grid_name, max }) => {
            // Of Planck's light a collision brings the share that is absorbed.
            let scale = GLOW / ((1.0 - ALBEDO) * planck::luminance(*max));
            volume.emission_scale = Some(round_to(scale, 1e-2 * scale));
            volume.temperature = Some(TemperatureDescription {
                file: None,
                grid: Some(grid_name.clone()),
                scale: 1.0,
                offset: 0.0,
                normalised: false,
            });
        }
        Some(Glow::Flame { grid_name, max }) => {
            // Bright along a quarter of the body.
            let luminance = 4.0 * GLOW / (max * middle_edge(summary));
            volume.medium.emission_per_length = Some(SpectrumDescription::Table(SpectrumTable {
                blackbody: Some(FLAME_KELVIN),
                luminance: Some(round_to(luminance, 1e-2 * luminance).clamp(0.0, 1e25)),
                ..SpectrumTable::default()
            }));
            volume.emission_grid =
                Some(EmissionGridDescription { file: None, grid: Some(grid_name.clone()), scale: 1.0 });
        }
    }
    volume
}

/// The middle one of the box's edges.
fn middle_edge(summary: &VolumeSummary) -> f64 {
    let [min, max] = sound_box(summary);
    let mut edges = (max - min).to_array();
    edges.sort_by(f64::total_cmp);
    edges[1]
}

/// The box, or a voxel's worth of one where it has no extent or is not finite.
fn sound_box(summary: &VolumeSummary) -> [DVec3; 2] {
    let [min, max] = summary.world_box;
    let voxel =
        if summary.voxel_size.is_finite() && summary.voxel_size > 0.0 { summary.voxel_size } else { 1.0 };
    if !(min.is_finite() && max.is_finite() && (max - min).min_element() >= 0.0) {
        return [DVec3::splat(-0.5 * voxel), DVec3::splat(0.5 * voxel)];
    }
    [min, max.max(min + DVec3::splat(voxel))]
}

fn extinction(summary: &VolumeSummary) -> f64 {
    let is_level_set = summary.class == GridClass::LevelSet;
    // Of a level set only the voxels near the surface are active; a body fills about half of its box.
    let fraction = if is_level_set { 0.5 } else { summary.active_fraction };
    let fraction = if fraction > 0.0 && fraction <= 1.0 { fraction } else { 1.0 };
    let is_usable = |value: &f64| *value > 0.0 && value.is_finite();
    let mean = if is_level_set {
        1.0
    } else {
        [summary.mean, summary.max].into_iter().find(is_usable).unwrap_or(1.0)
    };
    let mu_t = OPTICAL_THICKNESS / (mean * middle_edge(summary) * libm::cbrt(fraction));
    round_to(mu_t.clamp(1e-25, 1e25), 1e-3 * mu_t.clamp(1e-25, 1e25))
}

/// The nearest camera in the viewer's direction that has the whole box in the picture.
fn framing_camera([min, max]: [DVec3; 2], aspect: f64) -> CameraDescription {
    let centre = 0.5 * (min + max);
    let half = 0.5 * (max - min);
    let toward_viewer = direction_of_compass(VIEWER[0], VIEWER[1]);
    let forward = -toward_viewer;
    let right = forward.cross(DVec3::Y).normalize_or(DVec3::X);
    let up = right.cross(forward);
    let tan_vertical = libm::tan(0.5 * VERTICAL_FOV.to_radians()) * FILLED;
    let tan_horizontal = tan_vertical * aspect;

    let mut distance = 0.0_f64;
    for corner in 0..8 {
        let sign = |axis: i32| if corner >> axis & 1 == 1 { 1.0 } else { -1.0 };
        let offset = half * DVec3::new(sign(0), sign(1), sign(2));
        // In the picture if its distance across is at most tan · (distance along).
        let along = offset.dot(forward);
        distance = distance
            .max(offset.dot(right).abs() / tan_horizontal - along)
            .max(offset.dot(up).abs() / tan_vertical - along);
    }
    let step = 1e-4 * distance;
    let rounded = |point: DVec3| point.to_array().map(|coordinate| round_to(coordinate, step));
    CameraDescription {
        position: rounded(centre + distance * toward_viewer),
        target: Some(rounded(centre)),
        direction: None,
        up: [0.0, 1.0, 0.0],
        projection: Projection::Perspective,
        height: None,
        window: None,
        inside: None,
        vertical_fov: VERTICAL_FOV,
        aperture_radius: 0.0,
        focus_distance: None,
    }
}

/// Rounds to decimals as a person would write them, off by at most `step`.
fn round_to(value: f64, step: f64) -> f64 {
    let digits = -libm::log10(step).floor();
    if !(-300.0..300.0).contains(&digits) {
        return value;
    }
    // Through text: the product with a power of ten would leave digits such as 0.30000000000000004.
    let digits = digits as i32;
    if digits >= 0 {
        format!("{value:.*}", digits as usize).parse().unwrap_or(value)
    } else {
        let unit = 10.0_f64.powi(-digits);
        (value / unit).round() * unit
    }
}

fn notes(summary: &VolumeSummary) -> Vec<(Vec<String>, String)> {
    let [min, max] = sound_box(summary);
    let size = max - min;
    let step = 1e-3 * size.max_element();
    let [x, y, z] = size.to_array().map(|edge| round_to(edge, step));
    let values = match summary.class {
        GridClass::LevelSet => {
            "The file says that this is a level set: density 1 inside the surface, 0 outside.".to_owned()
        }
        _ => format!(
            "The grid's values multiply mu_t; active ones are {} on average, {} at most.",
            round_to(summary.mean, 1e-3 * summary.mean.abs()),
            round_to(summary.max, 1e-3 * summary.max.abs())
        ),
    };
    let mut grid = format!("The box of the active voxels is {x} x {y} x {z}.");
    if summary.value_is_temperature {
        grid += "\nThere is no density in the file: its temperature is shown as if it were one.";
    }
    let path = |keys: &[&str]| keys.iter().map(|key| (*key).to_owned()).collect();
    let glow = summary.glow.as_ref().map(|glow| match glow {
        Glow::Temperature { max, .. } => (
            path(&["volume", "0", "temperature"]),
            format!(
                "Taken for kelvin, {} at most: the volume glows; without this key and `emission_scale` it does not.",
                round_to(*max, 1.0)
            ),
        ),
        Glow::Flame { max, .. } => (
            path(&["volume", "0", "emission_grid"]),
            format!(
                "Taken for flames, {} at most: they shine; without this key and `emission_per_length` they do not.",
                round_to(*max, 1e-3 * max)
            ),
        ),
    });
    let mut notes = vec![
        (path(&["camera"]), "Chosen by itself: the whole volume in view, the sky behind it.".to_owned()),
        (path(&["volume", "0", "grid"]), grid),
        (path(&["volume", "0", "values"]), values),
        (
            path(&["volume", "0", "mu_t"]),
            format!("Makes the body's optical thickness about {OPTICAL_THICKNESS}; more is denser."),
        ),
        (
            path(&["volume", "0", "albedo"]),
            "The fraction of light that is scattered and not absorbed.".to_owned(),
        ),
        (path(&["volume", "0", "phase"]), "g above 0 scatters forward, as droplets do.".to_owned()),
        (
            path(&["light", "0"]),
            "A clear day; at exposure 0 a white surface in full sun is white.".to_owned(),
        ),
    ];
    notes.extend(glow);
    notes
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Camera, SceneDocument};

    fn summary() -> VolumeSummary {
        VolumeSummary {
            grid_name: "density".to_owned(),
            world_box: [DVec3::new(-10.0, 3.0, 100.0), DVec3::new(30.0, 13.0, 120.0)],
            mean: 0.25,
            max: 2.0,
            active_fraction: 0.125,
            voxel_size: 0.1,
            class: GridClass::FogVolume,
            value_is_temperature: false,
            glow: None,
        }
    }

    fn read_back(scene: &AutomaticScene) -> SceneDescription {
        SceneDocument::parse("automatic.toml", &scene.to_toml())
            .and_then(|document| document.description())
            .unwrap()
    }

    #[test]
    fn the_box_fills_the_picture_and_does_not_leave_it() {
        for size in [[40.0, 10.0, 20.0], [1.0, 50.0, 1.0], [1e-3, 1e-3, 1e-3], [3e6, 2e6, 1e6]] {
            let world_box =
                [DVec3::new(7.0, -3.0, 2.0), DVec3::new(7.0, -3.0, 2.0) + DVec3::from_array(size)];
            let voxel_size = 1e-3 * size[1];
            let scene =
                SceneDescription::for_volume("a.vdb", &VolumeSummary { world_box, voxel_size, ..summary() });
            let description = scene.description.camera;
            let camera = Camera::new(&description, [1600, 900], None);
            let corner_ray = |pixel| camera.ray(pixel, [0.0, 0.0], [0.5, 0.5]).direction;
            let [left_top, right_bottom] = [corner_ray([0, 0]), corner_ray([1600, 900])];
            let forward = camera.forward();
            let right = forward.cross(DVec3::Y).normalize();
            let up = right.cross(forward);
            let in_picture = |direction: DVec3| {
                let along = direction.dot(forward);
                [direction.dot(right) / along, direction.dot(up) / along]
            };
            let (edge, low) = (in_picture(right_bottom), in_picture(left_top));
            let mut greatest = 0.0_f64;
            for corner in 0..8 {
                let pick = |axis: usize| world_box[corner >> axis & 1][axis];
                let offset = DVec3::new(pick(0), pick(1), pick(2)) - DVec3::from_array(description.position);
                let [x, y] = in_picture(offset);
                greatest = greatest.max((x / edge[0]).abs()).max((y / low[1]).abs());
            }
            assert!((0.95..=1.0).contains(&greatest), "{size:?}: {greatest}");
        }
    }

    #[test]
    fn the_density_scale_gives_the_body_its_optical_thickness() {
        let scene = SceneDescription::for_volume("a.vdb", &summary());
        let Some(SpectrumDescription::Grey(mu_t)) = scene.description.volumes[0].medium.mu_t else {
            panic!("{:?}", scene.description.volumes[0].medium)
        };
        // The middle edge is 20, half of which the active eighth of the box fills.
        assert!((mu_t * 0.25 * 10.0 - 16.0).abs() < 0.02, "{mu_t}");
    }

    #[test]
    fn the_printed_scene_reads_back_and_explains_itself() {
        let scene = SceneDescription::for_volume("clouds/a.vdb", &summary());
        assert_eq!(read_back(&scene), scene.description);
        let text = scene.to_toml();
        for (_, note) in &scene.notes {
            assert!(note.lines().all(|line| text.contains(&format!("# {line}\n"))), "{text}");
        }
    }

    #[test]
    fn what_can_glow_glows() {
        assert_eq!(Glow::of_grid("temperature", 1.97), None);
        assert_eq!(Glow::of_grid("flame", f64::NEG_INFINITY), None);
        assert_eq!(Glow::of_grid("density", 3.0), None);
        let fire = VolumeSummary { glow: Glow::of_grid("Temperature", 1400.0), ..summary() };
        let scene = SceneDescription::for_volume("a.vdb", &fire);
        let volume = &scene.description.volumes[0];
        assert_eq!(volume.temperature.as_ref().and_then(|field| field.grid.as_deref()), Some("Temperature"));
        let brightest = (1.0 - ALBEDO) * volume.emission_scale.unwrap() * planck::luminance(1400.0);
        assert!((brightest / GLOW - 1.0).abs() < 0.01, "{brightest}");
        assert!(scene.to_toml().contains("# Taken for kelvin, 1400 at most"), "{}", scene.to_toml());
    }

    #[test]
    fn odd_grids_have_sound_scenes() {
        let base = summary();
        let point = [DVec3::ONE, DVec3::ONE];
        let nowhere = [DVec3::splat(f64::INFINITY), DVec3::splat(f64::NEG_INFINITY)];
        for odd in [
            VolumeSummary { world_box: point, ..base.clone() },
            VolumeSummary { world_box: nowhere, voxel_size: f64::NAN, ..base.clone() },
            VolumeSummary { mean: f64::NAN, max: 0.0, active_fraction: 0.0, ..base.clone() },
            VolumeSummary { mean: -3.0, max: 1e-20, ..base.clone() },
            VolumeSummary { class: GridClass::LevelSet, mean: -0.1, ..base.clone() },
            VolumeSummary { value_is_temperature: true, mean: 900.0, max: 2000.0, ..base.clone() },
            VolumeSummary { glow: Glow::of_grid("temperature", 1500.0), ..base.clone() },
            VolumeSummary { glow: Glow::of_grid("flames", 1e-9), ..base.clone() },
            VolumeSummary { glow: Glow::of_grid("Heat", 1e30), ..base },
        ] {
            let scene = SceneDescription::for_volume("a.vdb", &odd);
            assert_eq!(read_back(&scene), scene.description, "{odd:?}");
        }
    }
}
