//! Media that glow, as lights: points are drawn as their density says, nowhere with density 0 where there is light, and the
//! better the more light there is.

use std::sync::Arc;

use glam::{DAffine3, DQuat, DVec3};
use tyndall_lanes::Random;
use tyndall_optics::PhaseFunction;
use tyndall_optics::planck::BlackbodyColours;
use tyndall_scene::light::VolumeLight;
use tyndall_scene::{Density, Field, Fields, Light, Medium, TemperatureField, Volume};
use tyndall_volumes::{BrickGrid, Filter, LEAF_VOXELS, Leaf, Storage, Tree};

/// A grid of 32 × 24 × 16 voxels with these values; what is nowhere above 0 is left out.
fn grid(filter: Filter, value: impl Fn(DVec3) -> f32) -> Arc<BrickGrid> {
    let mut tree = Tree { background: 0.0, tiles: vec![], leaves: vec![], leaf_values: vec![] };
    for k in 0..4 * 3 * 2 {
        let origin = [k / 6 * 8, k / 2 % 3 * 8, k % 2 * 8];
        let corner = DVec3::from_array(origin.map(f64::from));
        let voxel =
            |i: usize| value(corner + DVec3::new((i >> 6) as f64, (i >> 3 & 7) as f64, (i & 7) as f64));
        let values: Vec<f32> = (0..LEAF_VOXELS).map(voxel).collect();
        if values.iter().any(|value| *value > 0.0) {
            tree.leaves.push(Leaf { origin, active: [u64::MAX; 8] });
            tree.leaf_values.extend(values);
        }
    }
    Arc::new(BrickGrid::from_tree(&tree, "glow", Storage::F32).unwrap().with_filter(filter))
}

/// A flame: bright about its foot, dark beyond.
fn flame(p: DVec3) -> f32 {
    (1.0 - (p - DVec3::new(11.0, 6.0, 8.0)).length() / 7.0).max(0.0) as f32
}

fn smoke(p: DVec3) -> f32 {
    if p.x < 24.0 { (1.2 + (p.x * 0.7).sin() + (p.y * 0.3).cos()).max(0.0) as f32 } else { 0.0 }
}

/// Into a box about [1, 2, 3], turned, with voxels of 0.1.
fn place() -> DAffine3 {
    DAffine3::from_scale_rotation_translation(
        DVec3::new(0.1, 0.1, 0.2),
        DQuat::from_rotation_y(0.6),
        DVec3::new(1.0, 2.0, 3.0),
    )
}

fn volume(density: Density, to_world: DAffine3, emission: [DVec3; 2], fields: Option<Fields>) -> Volume {
    let medium = Medium::grey(2.0, 0.25, PhaseFunction::Isotropic);
    let medium = Medium { emission: emission[0], emission_per_length: emission[1], ..medium };
    let fields = fields.map(Arc::new);
    Volume { name: "glow".into(), world_to_local: to_world.inverse(), density, medium, fields }
}

fn cases() -> Vec<(&'static str, Volume)> {
    let glow = [DVec3::new(3.0, 2.0, 1.0), DVec3::ZERO];
    let both = [DVec3::ONE, DVec3::new(0.2, 0.1, 0.4)];
    let dark = [DVec3::ZERO; 2];
    let cuboid = Density::Box { min: DVec3::ZERO, max: DVec3::new(30.0, 20.0, 10.0) };
    let field = |filter, value: fn(DVec3) -> f32| Field {
        world_to_local: place().inverse(),
        grid: grid(filter, value),
    };
    let flames = |filter| Fields { emission: Some((field(filter, flame), 2.5)), ..Default::default() };
    let hot = Fields {
        temperature: Some(TemperatureField {
            field: field(Filter::Trilinear, flame),
            scale: 1500.0,
            offset: 400.0,
            radiance_scale: 1.0,
            normalised: false,
            colours: Arc::new(BlackbodyColours::new()),
        }),
        ..Default::default()
    };
    let of_smoke = |filter| Density::Grid(grid(filter, smoke));
    let large = place() * DAffine3::from_scale(DVec3::new(9.0, 9.0, 5.0));
    vec![
        ("ball", volume(Density::Sphere, large, glow, None)),
        ("box", volume(cuboid.clone(), place(), both, None)),
        ("box with flames", volume(cuboid.clone(), place(), glow, Some(flames(Filter::Nearest)))),
        ("hot box", volume(cuboid, place(), dark, Some(hot.clone()))),
        ("hot ball", volume(Density::Sphere, large, dark, Some(hot.clone()))),
        ("smoke", volume(of_smoke(Filter::Trilinear), place(), both, None)),
        ("smoke of voxels", volume(of_smoke(Filter::Nearest), place(), glow, None)),
        ("hot smoke", volume(of_smoke(Filter::Trilinear), place(), dark, Some(hot))),
        (
            "smoke and flames",
            volume(of_smoke(Filter::Trilinear), place(), both, Some(flames(Filter::Trilinear))),
        ),
        ("flames in the open", volume(Density::Everywhere, place(), glow, Some(flames(Filter::Trilinear)))),
    ]
}

/// What the volume adds to a ray per length, by the equation.
fn source(volume: &Volume, position: DVec3) -> f64 {
    let local = volume.world_to_local.transform_point3(position);
    let is_inside = match &volume.density {
        Density::Sphere => local.length() < 1.0,
        _ => volume.local_box().is_none_or(|[min, max]| local.clamp(min, max) == local),
    };
    let density = if is_inside { volume.density_at(local) } else { 0.0 };
    let at_collisions = 2.0 * (1.0 - 0.25) * density * volume.emission_at(position).x;
    let factor = match volume.fields.as_ref().and_then(|fields| fields.emission.as_ref()) {
        Some(_) if is_inside || matches!(volume.density, Density::Grid(_)) => {
            volume.emission_factor(position)
        }
        Some(_) => 0.0,
        None => density,
    };
    at_collisions + volume.medium.emission_per_length.x * factor
}

/// χ² over 6³ bins of the box around; 5 standard deviations of it are below 1e-4 for all cases together.
#[test]
fn points_are_drawn_as_their_density_says() {
    const ALONG: usize = 6;
    for (number, (name, volume)) in cases().iter().enumerate() {
        let light = VolumeLight::new(volume, 3).unwrap();
        assert_eq!(light.volume(), 3);
        let [min, max] = light.bounds();
        let bin = |position: DVec3| {
            let along = (position - min) / (max - min) * ALONG as f64;
            let [x, y, z] = along.to_array().map(|i| (i as usize).min(ALONG - 1));
            (x * ALONG + y) * ALONG + z
        };
        let n = 120;
        let mut expected = vec![0.0; ALONG.pow(3)];
        for k in 0_u32..n * n * n {
            let index = [k / (n * n), k / n % n, k % n].map(|i| (f64::from(i) + 0.5) / f64::from(n));
            let position = min + (max - min) * DVec3::from_array(index);
            let cell = (max - min).element_product() / f64::from(n).powi(3);
            expected[bin(position)] += light.pdf_volume(position) * cell;
        }
        let total: f64 = expected.iter().sum();
        assert!((total - 1.0).abs() < 0.03, "{name}: the pdf integrates to {total}");

        let mut random = Random::new(3, number as u64, 0);
        let draws = 20_000;
        let mut counts = vec![0.0; expected.len()];
        for _ in 0..draws {
            let sample = light.sample([random.f64(), random.f64(), random.f64()]);
            let pdf = light.pdf_volume(sample.position);
            assert!((pdf / sample.pdf_volume - 1.0).abs() < 1e-9, "{name}: {pdf} {sample:?}");
            assert!(sample.position.cmpge(min - 1e-9).all() && sample.position.cmple(max + 1e-9).all());
            counts[bin(sample.position)] += 1.0;
        }
        let (mut statistic, mut freedom, mut rest) = (0.0, -1.0, (0.0, 0.0));
        for (probability, count) in expected.iter().zip(counts) {
            let expected = probability / total * f64::from(draws);
            if expected < 20.0 {
                rest = (rest.0 + expected, rest.1 + count);
            } else {
                // The sum over a lattice leaves 2 % of a bin open.
                statistic += (count - expected).powi(2) / (expected + (0.02 * expected).powi(2));
                freedom += 1.0;
            }
        }
        assert!(freedom > 4.0 && f64::abs(rest.1 - rest.0) < 5.0 * rest.0.sqrt() + 20.0, "{name}: {rest:?}");
        let limit = freedom + 5.0 * f64::sqrt(2.0 * freedom);
        assert!(statistic < limit, "{name}: χ² = {statistic} with {freedom} degrees of freedom");
    }
}

#[test]
fn the_density_is_above_0_wherever_there_is_light_and_follows_it() {
    for (number, (name, volume)) in cases().iter().enumerate() {
        let light = VolumeLight::new(volume, 0).unwrap();
        let [min, max] = light.bounds();
        let mut random = Random::new(4, number as u64, 0);
        let mut point = || [random.f64(), random.f64(), random.f64()];
        let draws = 100_000;
        let (mut uniform, mut lit) = ([0.0; 2], 0);
        for _ in 0..draws {
            // A hair beyond the box as well: nothing may glow there.
            let position = min + (max - min) * (DVec3::from_array(point()) * 1.2 - 0.1);
            let light_here = source(volume, position);
            assert!(
                light_here == 0.0 || light.pdf_volume(position) > 0.0,
                "{name}: {light_here} at {position}"
            );
            lit += u32::from(light_here > 0.0);
            let value = light_here * (max - min).element_product() * 1.728;
            uniform[0] += value;
            uniform[1] += value * value;
        }
        assert!(lit > 1000, "{name}: {lit}");
        let mut drawn = [0.0; 2];
        for _ in 0..draws {
            let sample = light.sample(point());
            let value = source(volume, sample.position) / sample.pdf_volume;
            drawn[0] += value;
            drawn[1] += value * value;
        }
        let n = f64::from(draws);
        let moments = |[sum, squares]: [f64; 2]| (sum / n, (squares / n - (sum / n).powi(2)).max(0.0));
        let [(truth, spread), (mean, variance)] = [uniform, drawn].map(moments);
        let error = ((spread + variance) / n).sqrt();
        assert!((mean - truth).abs() < 4.5 * error, "{name}: {mean}, not {truth} ± {error}");
        assert!(variance < 0.5 * spread, "{name}: {variance} is hardly better than {spread}");
    }
}

#[test]
fn what_does_not_glow_or_has_no_bounds_is_no_light() {
    let glow = [DVec3::ONE, DVec3::ZERO];
    let slab = Density::Slab { bottom: 0.0, top: 1.0 };
    for volume in [
        volume(Density::Everywhere, place(), glow, None),
        volume(slab, place(), glow, None),
        volume(Density::Sphere, place(), [DVec3::ZERO; 2], None),
    ] {
        assert!(VolumeLight::new(&volume, 0).is_none());
    }
    let mut white = volume(Density::Sphere, place(), glow, None);
    white.medium.albedo = DVec3::ONE;
    assert!(VolumeLight::new(&white, 0).is_none(), "what absorbs nothing sends out nothing");
}

#[test]
fn a_ball_sends_out_what_its_volume_does() {
    let ball = volume(Density::Sphere, DAffine3::from_scale(DVec3::splat(2.0)), [DVec3::ONE; 2], None);
    let weight = Light::Volume(VolumeLight::new(&ball, 0).unwrap()).selection_weight(1.0);
    let expected = 4.0 * std::f64::consts::PI * (4.0 / 3.0 * std::f64::consts::PI * 8.0) * (1.5 + 1.0);
    assert!((weight / expected - 1.0).abs() < 1e-12, "{weight} {expected}");
}
