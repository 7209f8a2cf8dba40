//! The volumes as the fast engine sees them: f32, about a common centre, grids in local voxel coordinates.

use glam::{Affine3A, DAffine3, DVec3, Vec3};
use tyndall_lanes::Random;
use tyndall_optics::PhaseFunction;
use tyndall_scene::{Density, Light, Ray, Scene, Volume};
use tyndall_volumes::bricks::Bricks;
use tyndall_volumes::{BrickGrid, Filter};

use super::gather;
use super::homogeneous::Homogeneous;
use super::light_cache::LightCache;
use super::pool::Path;
use super::sided::lights_seen_at_once;
use super::split;
use crate::emission::path_weight_by;

/// Throughput below which paths play roulette in most scenes.
const ROULETTE_THROUGHPUT: f32 = 0.25;

/// Everything in f32 is kept relative to a point amid the volumes, so that a scene far from the origin loses no
/// digits.
pub(crate) struct FastScene<'a> {
    pub scene: &'a Scene,
    pub centre: DVec3,
    pub volumes: Vec<FastVolume<'a>>,
    /// Whether any volume sends out light along the way.
    pub shines: bool,
    /// Whether paths carry what surfaces need.
    pub is_sided: bool,
    /// Whether glowing volumes are drawn as lights.
    pub has_volume_lights: bool,
    /// Roughly what gets through to some of the lights.
    pub light_cache: Option<LightCache>,
    /// Whether camera rays [gather](super::gather).
    pub(super) gathers: bool,
    /// Lights that are all looked at from the first surface.
    pub(super) seen_at_once: Vec<usize>,
    /// Whether rays gather, the cache knows all lights, and all are points or parallel light: they are [corrected](super::next_event)
    /// one by one.
    pub(super) knows_all_lights: bool,
    /// Throughput below which paths play roulette; survivors get twice this.
    pub(super) roulette_throughput: f32,
    /// Into how many branches paths split where they first turn.
    pub(super) branches: u32,
    /// The scene without a pool, if it is homogeneous.
    pub(super) homogeneous: Option<Homogeneous<'a>>,
}

pub(crate) struct FastVolume<'a> {
    pub kind: Kind<'a>,
    pub mu_t: f32,
    pub albedo: Vec3,
    pub phase: Phase<'a>,
    /// (1 − albedo)·Le: what a collision adds.
    pub emission: Vec3,
    /// What has to be looked up at each collision, if anything.
    pub fields: Option<Fields<'a>>,
    /// The volume, if it sends out light along the way.
    pub shines: Option<&'a Volume>,
}

/// What varies in a volume beside its density.
pub(crate) enum Fields<'a> {
    /// A grid that multiplies the emission; one random voxel of it will do, as in the march.
    Emission(FastGrid<'a>),
    /// Albedo or temperature, evaluated in f64: they do not enter by a factor alone.
    Any(&'a Volume),
}

pub(crate) enum Kind<'a> {
    /// A density with a closed form; evaluated in f64, which happens once a ray.
    ClosedForm(&'a Volume),
    Grid(FastGrid<'a>),
}

pub(crate) struct FastGrid<'a> {
    pub grid: &'a BrickGrid,
    /// Centred world space to local voxel coordinates (index space less the table's origin).
    pub to_local: Affine3A,
    /// The domain in local voxel coordinates.
    pub min: Vec3,
    pub max: Vec3,
    /// Width of the interval over which a tap is spread along each axis: a voxel, or nothing without a filter.
    pub spread: f32,
}

impl<'a> FastScene<'a> {
    pub fn new(scene: &'a Scene) -> FastScene<'a> {
        let boxes: Vec<[DVec3; 2]> = scene.volumes.iter().filter_map(Volume::world_box).collect();
        let centre = match boxes.split_first() {
            None => DVec3::ZERO,
            Some((&[min, max], rest)) => {
                let all = rest.iter().fold((min, max), |(low, high), b| (low.min(b[0]), high.max(b[1])));
                (all.0 + all.1) * 0.5
            }
        };
        let volumes: Vec<_> = scene.volumes.iter().map(|volume| FastVolume::new(volume, centre)).collect();
        let shines = volumes.iter().any(|volume| volume.shines.is_some());
        let has_volume_lights = scene.lights.iter().any(|light| matches!(light, Light::Volume(_)));
        let is_sided = !scene.surfaces.is_empty();
        let homogeneous = Homogeneous::new(scene);
        let light_cache = LightCache::new(scene, centre);
        let branches = split::branches(scene);
        let gathers = gather::pays(scene, &volumes, light_cache.as_ref(), branches);
        let seen_at_once = lights_seen_at_once(scene);
        let knows_all_lights = gathers && light_cache.is_some() && !seen_at_once.is_empty();
        let roulette_throughput = match (gathers, branches) {
            (_, 2..) => split::ROULETTE_THROUGHPUT / branches as f32,
            (true, _) => gather::ROULETTE_THROUGHPUT,
            (false, _) => ROULETTE_THROUGHPUT,
        };
        FastScene {
            scene,
            centre,
            volumes,
            shines,
            is_sided,
            has_volume_lights,
            light_cache,
            gathers,
            seen_at_once,
            knows_all_lights,
            roulette_throughput,
            branches,
            homogeneous,
        }
    }

    /// Weight of the glow that a path has found at its collision in a volume, against next-event estimation.
    #[inline(always)]
    pub(super) fn glow_weight(&self, path: &Path, volume: usize, emission: Vec3) -> f32 {
        if !self.has_volume_lights || emission == Vec3::ZERO {
            return 1.0;
        }
        let Some(from) = path.turned else { return 1.0 };
        let (here, pdf) = (self.to_world(path.position), f64::from(path.turn_pdf));
        let extinction = |toward| self.extinction_about(volume, here, toward);
        path_weight_by(self.scene, volume, from, here, pdf, extinction) as f32
    }

    /// The albedo of a volume at a place, and what a collision there adds.
    #[inline(always)]
    pub fn albedo_and_emission(
        &self,
        volume: &FastVolume,
        position: Vec3,
        random: &mut Random,
    ) -> (Vec3, Vec3) {
        match &volume.fields {
            None => (volume.albedo, volume.emission),
            Some(Fields::Emission(grid)) => (volume.albedo, volume.emission * grid.drawn(position, random)),
            Some(Fields::Any(volume)) => looked_up(volume, self.to_world(position)),
        }
    }

    pub fn to_world(&self, position: Vec3) -> DVec3 {
        position.as_dvec3() + self.centre
    }

    /// A ray of the pool in f64.
    pub fn world_ray(&self, origin: Vec3, direction: Vec3) -> Ray {
        Ray { origin: self.to_world(origin), direction: direction.as_dvec3() }
    }
}

impl<'a> FastGrid<'a> {
    pub fn new(grid: &'a BrickGrid, world_to_local: DAffine3, centre: DVec3) -> FastGrid<'a> {
        let origin = DVec3::from_array(grid.origin().map(f64::from));
        let to_local =
            DAffine3::from_translation(-origin) * world_to_local * DAffine3::from_translation(centre);
        let [min, max] = grid.domain();
        FastGrid {
            grid,
            to_local: to_local.as_affine3a(),
            min: (min - origin).as_vec3(),
            max: (max - origin).as_vec3(),
            spread: match grid.filter() {
                Filter::Trilinear => 1.0,
                Filter::Nearest => 0.0,
            },
        }
    }

    /// The voxel drawn with its trilinear weight for the local place; its mean is the field's value.
    #[inline(always)]
    pub fn tap(&self, place: Vec3, u: [f32; 3]) -> f32 {
        let place = place + self.spread * Vec3::from_array(u);
        let voxel = voxel_around(place);
        let value = match self.grid.bricks() {
            Bricks::U8(bricks) => self.grid.local_voxel(bricks, voxel),
            Bricks::F16(bricks) => self.grid.local_voxel(bricks, voxel),
            Bricks::F32(bricks) => self.grid.local_voxel(bricks, voxel),
        };
        if value > 0.0 { value } else { 0.0 }
    }

    /// A value whose mean is the field's at a place relative to the scene's centre; outside the domain its background.
    #[inline(always)]
    pub fn drawn(&self, position: Vec3, random: &mut Random) -> f32 {
        match self.place_inside(position) {
            Some(place) => self.tap(place, random.f32x3()),
            None => self.grid.background(),
        }
    }

    /// The same, but nothing outside the domain.
    #[inline(always)]
    pub fn drawn_or_nothing(&self, position: Vec3, random: &mut Random) -> f32 {
        match self.place_inside(position) {
            Some(place) => self.tap(place, random.f32x3()),
            None => 0.0,
        }
    }

    /// The voxel nearest to a place relative to the scene's centre, or nothing outside the domain.
    pub fn nearest_or_nothing(&self, position: Vec3) -> f32 {
        self.place_inside(position).map_or(0.0, |place| self.nearest(place))
    }

    /// Bound of the values about a place relative to the scene's centre, or nothing outside the domain.
    #[inline(always)]
    pub fn bound_or_nothing(&self, position: Vec3) -> f32 {
        match self.place_inside(position) {
            Some(place) => self.grid.cell(voxel_around(place)).max.max(0.0),
            None => 0.0,
        }
    }

    /// The local place of one relative to the scene's centre, if it is in the domain.
    #[inline(always)]
    fn place_inside(&self, position: Vec3) -> Option<Vec3> {
        let place = self.to_local.transform_point3(position);
        (place.cmpge(self.min).all() && place.cmple(self.max).all()).then_some(place)
    }

    /// The voxel nearest to the local place.
    #[inline(always)]
    pub fn nearest(&self, place: Vec3) -> f32 {
        self.tap(place, [0.5; 3])
    }
}

/// The voxel that a local place lies in.
#[inline(always)]
fn voxel_around(place: Vec3) -> [u32; 3] {
    [place.x as i32 as u32, place.y as i32 as u32, place.z as i32 as u32]
}

impl<'a> FastVolume<'a> {
    fn new(volume: &'a Volume, centre: DVec3) -> FastVolume<'a> {
        let medium = &volume.medium;
        let kind = match &volume.density {
            Density::Grid(grid) => Kind::Grid(FastGrid::new(grid, volume.world_to_local, centre)),
            _ => Kind::ClosedForm(volume),
        };
        let (fields, scale) = match volume.fields.as_deref() {
            None => (None, 1.0),
            Some(tyndall_scene::Fields {
                emission: Some((field, scale)),
                temperature: None,
                albedo: None,
            }) => {
                let grid = FastGrid::new(&field.grid, field.world_to_local, centre);
                (Some(Fields::Emission(grid)), *scale)
            }
            Some(_) => (Some(Fields::Any(volume)), 1.0),
        };
        FastVolume {
            kind,
            mu_t: medium.mu_t as f32,
            albedo: medium.albedo.as_vec3(),
            phase: Phase::new(&medium.phase_function),
            emission: (scale * (DVec3::ONE - medium.albedo) * medium.emission).as_vec3(),
            fields,
            shines: (medium.emission_per_length != DVec3::ZERO).then_some(volume),
        }
    }
}

/// The albedo at a place in the world, and what a collision there adds.
#[cold]
fn looked_up(volume: &Volume, position: DVec3) -> (Vec3, Vec3) {
    let albedo = volume.albedo_at(position);
    (albedo.as_vec3(), ((DVec3::ONE - albedo) * volume.emission_at(position)).as_vec3())
}

/// 1/(4π).
const INVERSE_SPHERE: f32 = 0.25 * std::f32::consts::FRAC_1_PI;

/// A phase function in f32, of which [`PhaseFunction`] is the oracle; the less common ones are left to it.
#[derive(Clone, Copy)]
pub(crate) enum Phase<'a> {
    Isotropic,
    HenyeyGreenstein { g: f32 },
    Other(&'a PhaseFunction),
}

impl<'a> Phase<'a> {
    pub fn new(phase: &'a PhaseFunction) -> Phase<'a> {
        match *phase {
            PhaseFunction::HenyeyGreenstein { g } if g.abs() > 1e-3 => {
                Phase::HenyeyGreenstein { g: g as f32 }
            }
            // Below |g| = 1e-3 the f32 inverse loses its digits; to that order the phase function is isotropic to
            // within 0.3 %, and a picture, which g enters through 1 − g, to within 0.1 %.
            PhaseFunction::HenyeyGreenstein { .. } | PhaseFunction::Isotropic => Phase::Isotropic,
            _ => Phase::Other(phase),
        }
    }

    /// Value in 1/sr between unit vectors of travel.
    #[inline(always)]
    pub fn value(self, before: Vec3, after: Vec3) -> f32 {
        match self {
            Phase::Isotropic => INVERSE_SPHERE,
            Phase::HenyeyGreenstein { g } => henyey_greenstein(g, before.dot(after)),
            Phase::Other(phase) => other_value(phase, before, after),
        }
    }

    /// What next-event estimation asks of a collision on a ray: the value toward a direction, and the density of going on there.
    #[inline(always)]
    pub fn turning(self, before: Vec3) -> impl Fn(DVec3) -> (DVec3, f64) {
        move |toward| {
            let value = f64::from(self.value(before, toward.as_vec3()));
            (DVec3::splat(value), value)
        }
    }

    /// Values between each way's direction before, and each of its `N` directions afterwards; directions are by component.
    #[inline(always)]
    pub fn values<const W: usize, const N: usize>(
        self,
        before: &[[f32; W]; 3],
        after: &[[[f32; W]; N]; 3],
    ) -> [[f32; W]; N] {
        let mut values = [[INVERSE_SPHERE; W]; N];
        match self {
            Phase::Isotropic => {}
            Phase::HenyeyGreenstein { g } => {
                for k in 0..N {
                    for w in 0..W {
                        let cos_theta = before[0][w] * after[0][k][w]
                            + before[1][w] * after[1][k][w]
                            + before[2][w] * after[2][k][w];
                        values[k][w] = henyey_greenstein(g, cos_theta);
                    }
                }
            }
            Phase::Other(phase) => {
                for k in 0..N {
                    for w in 0..W {
                        let before = Vec3::new(before[0][w], before[1][w], before[2][w]);
                        let after = Vec3::new(after[0][k][w], after[1][k][w], after[2][k][w]);
                        values[k][w] = other_value(phase, before, after);
                    }
                }
            }
        }
        values
    }

    #[inline(always)]
    pub fn sample(self, before: Vec3, u: [f32; 2]) -> Vec3 {
        let cos_theta = match self {
            Phase::Isotropic => 2.0 * u[0] - 1.0,
            Phase::HenyeyGreenstein { g } => {
                let ratio = (1.0 - g * g) / (1.0 - g + 2.0 * g * u[0]);
                ((1.0 + g * g - ratio * ratio) / (2.0 * g)).clamp(-1.0, 1.0)
            }
            Phase::Other(phase) => return other_sample(phase, before, u),
        };
        let sin_theta = (1.0 - cos_theta * cos_theta).max(0.0).sqrt();
        let (sin_phi, cos_phi) = tyndall_lanes::sin_cos_turns(u[1]);
        let (tangent, bitangent) = before.any_orthonormal_pair();
        let after = tangent * (sin_theta * cos_phi) + bitangent * (sin_theta * sin_phi) + before * cos_theta;
        // One Newton step of the inverse square root about 1 keeps thousands of turns at unit length.
        after * (1.5 - 0.5 * after.length_squared())
    }

    /// What the extinction is multiplied by along `direction`.
    #[inline(always)]
    pub fn projected_area(self, direction: Vec3) -> f32 {
        match self {
            Phase::Isotropic | Phase::HenyeyGreenstein { .. } => 1.0,
            Phase::Other(phase) => phase.projected_area(direction.as_dvec3()) as f32,
        }
    }
}

#[inline(always)]
fn henyey_greenstein(g: f32, cos_theta: f32) -> f32 {
    // (1 − g)² + 2g(1 − cos) keeps its digits at the forward peak.
    let denominator = (1.0 - g) * (1.0 - g) + 2.0 * g * (1.0 - cos_theta);
    INVERSE_SPHERE * (1.0 - g * g) / (denominator * denominator.sqrt())
}

// Out of line, to keep them out of the way of the common kinds. The directions are made unit vectors to the last digit
// of f64, as peaks may be sharper than f32 can tell.

#[inline(never)]
fn other_value(phase: &PhaseFunction, before: Vec3, after: Vec3) -> f32 {
    phase.value(before.as_dvec3().normalize(), after.as_dvec3().normalize()) as f32
}

#[inline(never)]
fn other_sample(phase: &PhaseFunction, before: Vec3, u: [f32; 2]) -> Vec3 {
    phase.sample(before.as_dvec3().normalize(), u.map(f64::from)).as_vec3()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn f32_phase_functions_follow_the_f64_ones() {
        for phase in [
            PhaseFunction::Isotropic,
            PhaseFunction::HenyeyGreenstein { g: -0.5 },
            PhaseFunction::HenyeyGreenstein { g: 0.002 },
            PhaseFunction::HenyeyGreenstein { g: 0.85 },
            PhaseFunction::HenyeyGreenstein { g: 0.99 },
        ] {
            let fast = Phase::new(&phase);
            for i in 0..=1000 {
                let cos = -1.0 + i as f32 * 0.002;
                let truth = phase.value_at_cosine(f64::from(cos));
                let after = Vec3::new((1.0 - cos * cos).max(0.0).sqrt(), 0.0, cos);
                assert!(
                    (f64::from(fast.value(Vec3::Z, after)) / truth - 1.0).abs() < 2e-5,
                    "{phase:?} at {cos}"
                );
            }
            for i in 0..1000 {
                let u = (i as f32 + 0.5) / 1000.0;
                let before = Vec3::new(0.48, -0.6, 0.64);
                let after = fast.sample(before, [u, 0.3]);
                let truth = phase.sample_cosine(f64::from(u));
                assert!((f64::from(after.dot(before)) - truth).abs() < 2e-4, "{phase:?} at {u}");
                assert!((after.length() - 1.0).abs() < 1e-6);
            }
        }
    }
}
