//! Any description, printed, reads back identically; and scenes that render the same have the same hash.

use std::fs;

use proptest::option::of;
use proptest::prelude::*;
use tyndall_scene::description::*;
use tyndall_scene::{SceneDescription, SceneDocument, scene_hash};

#[path = "strategies/materials.rs"]
mod materials;
use materials::named_materials;

/// Whole numbers, decimals and numbers with all their digits.
fn number() -> impl Strategy<Value = f64> {
    prop_oneof![
        (-1_000_i32..1_000).prop_map(f64::from),
        (-1_000_i32..1_000).prop_map(|n| f64::from(n) / 100.0),
        -1e3..1e3,
        -1e12..1e12,
        Just(-0.0),
        Just(1e-30),
    ]
}

fn within(least: f64, most: f64) -> impl Strategy<Value = f64> {
    prop_oneof![least..=most, Just(least), Just(most)]
}

fn positive() -> impl Strategy<Value = f64> {
    prop_oneof![1e-9..1e9, (1_u32..100).prop_map(f64::from)]
}

fn vector() -> impl Strategy<Value = [f64; 3]> {
    [number(), number(), number()]
}

fn direction() -> impl Strategy<Value = [f64; 3]> {
    [-1.0..1.0, -1.0..1.0, 0.1..1.0]
}

fn rgb(least: f64, most: f64) -> impl Strategy<Value = Rgb> {
    let value = move || within(least, most);
    prop_oneof![value().prop_map(Rgb::Grey), [value(), value(), value()].prop_map(Rgb::Channels)]
}

fn samples(most: f64) -> impl Strategy<Value = SpectrumDescription> {
    proptest::collection::vec(within(0.0, most), 1..4).prop_map(|values| {
        let wavelengths = (0..values.len()).map(|n| 400.0 + 33.25 * n as f64).collect();
        let table =
            SpectrumTable { wavelengths: Some(wavelengths), values: Some(values), ..Default::default() };
        SpectrumDescription::Table(table)
    })
}

fn colours(most: f64) -> impl Strategy<Value = SpectrumDescription> {
    let value = move || within(0.0, most);
    prop_oneof![
        value().prop_map(SpectrumDescription::Grey),
        [value(), value(), value()].prop_map(SpectrumDescription::Channels),
        samples(most),
    ]
}

fn light_colours() -> impl Strategy<Value = SpectrumDescription> {
    let body = (within(1e3, 1e6), of(within(1e-9, 1e6))).prop_map(|(kelvin, luminance)| {
        let table = SpectrumTable { blackbody: Some(kelvin), luminance, ..Default::default() };
        SpectrumDescription::Table(table)
    });
    let power = (within(-4.0, 4.0), within(100.0, 1e3)).prop_map(|(power_law, at)| {
        let (power_law, at, value) = (Some(power_law), Some(at), Some(1.0));
        SpectrumDescription::Table(SpectrumTable { power_law, at, value, ..Default::default() })
    });
    prop_oneof![colours(1e6), body, power]
}

fn words() -> impl Strategy<Value = String> {
    "[a-zA-Z0-9_ ./\\\\\"'#=µ\\n\\t\u{7f}\u{0}-]{0,20}"
}

fn camera() -> impl Strategy<Value = CameraDescription> {
    (vector(), direction(), of(positive()), within(0.5, 179.0), any::<bool>()).prop_map(
        |(position, direction, focus_distance, vertical_fov, is_lens)| CameraDescription {
            projection: Default::default(),
            height: None,
            window: None,
            inside: None,
            position,
            target: None,
            direction: Some(direction),
            up: [0.1, 2.0, -0.3],
            vertical_fov,
            aperture_radius: if is_lens && focus_distance.is_some() { 0.25 } else { 0.0 },
            focus_distance,
        },
    )
}

fn film_and_render() -> impl Strategy<Value = (FilmDescription, RenderDescription)> {
    let layers = of(proptest::sample::subsequence(
        vec![Layer::StandardError, Layer::SampleCount, Layer::Depth, Layer::Albedo, Layer::Multiple],
        0..5,
    ));
    let film = ([1_u32..=65536, 1..=65536], within(-100.0, 100.0), layers).prop_map(
        |(resolution, exposure, layers)| FilmDescription {
            resolution,
            exposure,
            layers,
            ..Default::default()
        },
    );
    let integrator = prop_oneof![Just(Integrator::Fast), Just(Integrator::Reference)];
    let sampler = prop_oneof![Just(Sampler::Independent), Just(Sampler::Sobol)];
    let render = (1_u32.., any::<u32>(), of(any::<u32>()), integrator, sampler, any::<bool>()).prop_map(
        |(spp, seed, max_depth, integrator, sampler, adaptive)| RenderDescription {
            spp,
            seed,
            max_depth,
            integrator,
            sampler,
            adaptive,
            mode: ColourMode::Spectral,
        },
    );
    (film, render)
}

fn medium() -> impl Strategy<Value = MediumDescription> {
    let none = MediumDescription::default;
    let coefficients = prop_oneof![
        (light_colours_without_bodies(), colours(1.0)).prop_map(move |(mu_t, albedo)| {
            MediumDescription { mu_t: Some(mu_t), albedo: Some(albedo), ..none() }
        }),
        (positive(), colours(1.0)).prop_map(move |(path, albedo)| MediumDescription {
            mean_free_path: Some(path.into()),
            albedo: Some(albedo),
            ..none()
        }),
        (positive(), rgb(0.0, 1.0)).prop_map(move |(path, reflectance)| MediumDescription {
            mean_free_path: Some(path.into()),
            reflectance: Some(match reflectance {
                Rgb::Grey(grey) => grey.into(),
                Rgb::Channels(channels) => channels.into(),
            }),
            ..none()
        }),
        (colours(1e6), colours(1e6)).prop_map(move |(mu_a, mu_s)| MediumDescription {
            mu_a: Some(mu_a),
            mu_s: Some(mu_s),
            ..none()
        }),
        Just(MediumDescription { preset: Some("White Zinfandel".into()), ..none() }),
    ];
    let phase = of(prop_oneof![
        Just(PhaseDescription::Isotropic),
        Just(PhaseDescription::Rayleigh),
        within(-0.999, 0.999).prop_map(|g| PhaseDescription::Hg { g }),
        within(-0.999, 0.999).prop_map(|k| PhaseDescription::Schlick { k }),
        within(-0.999, 0.999).prop_map(|g| PhaseDescription::CornetteShanks { g }),
        (within(-0.999, 0.999), within(0.0, 300.0))
            .prop_map(|(g, alpha)| PhaseDescription::Draine { g, alpha }),
        (within(-0.999, 0.999), within(-0.999, 0.999), within(0.0, 1.0))
            .prop_map(|(g1, g2, weight)| PhaseDescription::DoubleHg { g1, g2, weight }),
        within(0.001, 50.0).prop_map(|droplet_diameter_um| PhaseDescription::Fog { droplet_diameter_um }),
        (direction(), within(0.001, 1.0), any::<bool>()).prop_map(|(axis, roughness, flat)| {
            let kind = if flat { SggxShape::Surface } else { SggxShape::Fibre };
            PhaseDescription::Sggx { kind, axis, roughness }
        }),
        (words(), of(within(1.0, 2000.0)))
            .prop_map(|(file, wavelength_nm)| PhaseDescription::Tabulated { file, wavelength_nm }),
    ]);
    (coefficients, phase, of(light_colours()), of(colours(9.0)), of(within(1e-3, 1e3))).prop_map(
        |(medium, phase, emission, emission_per_length, scale)| MediumDescription {
            phase,
            emission,
            emission_per_length,
            scale,
            ..medium
        },
    )
}

/// Extinctions above 0.
fn light_colours_without_bodies() -> impl Strategy<Value = SpectrumDescription> {
    prop_oneof![
        positive().prop_map(SpectrumDescription::Grey),
        [positive(), positive(), positive()].prop_map(SpectrumDescription::Channels),
    ]
}

fn transform() -> impl Strategy<Value = TransformDescription> {
    let scale = prop_oneof![
        positive().prop_map(Scale::Uniform),
        [positive(), positive(), positive()].prop_map(Scale::PerAxis)
    ];
    let matrix = [1.0, 0.5, 0.0, 3.0, 0.0, 2.0, 0.25, -1.0, 0.0, 0.0, 4.0, 0.0, 0.0, 0.0, 0.0, 1.0];
    prop_oneof![
        (of(scale), of(vector()), of(vector())).prop_map(|(scale, rotate, translate)| TransformDescription {
            scale,
            rotate,
            translate,
            matrix: None
        }),
        Just(TransformDescription { matrix: Some(matrix), ..Default::default() }),
    ]
}

fn volume() -> impl Strategy<Value = VolumeDescription> {
    let source = prop_oneof![
        (words(), of(words())).prop_map(|(file, grid)| VolumeDescription {
            file: Some(file),
            grid,
            values: Some(GridMeaning::SignedDistance),
            raw_shape: Some([3, 4, 5]),
            raw_type: Some(RawType::F16),
            storage: Some(Storage::F32),
            ..Default::default()
        }),
        (vector(), positive()).prop_map(|(center, radius)| VolumeDescription {
            sphere: Some(SphereShape { center, radius }),
            ..Default::default()
        }),
        positive().prop_map(|size| VolumeDescription {
            cuboid: Some(BoxShape { min: [-size, -1.0, 0.0], max: [size, 1.0, size] }),
            ..Default::default()
        }),
        positive().prop_map(|top| VolumeDescription {
            slab: Some(SlabShape { bottom: 0.0, top }),
            ..Default::default()
        }),
        (any::<u32>(), 8_u32..=2048, vector(), positive()).prop_map(|(seed, resolution, center, size)| {
            let cumulus = ProceduralDescription::Cumulus { seed, resolution, center, size };
            VolumeDescription { procedural: Some(cumulus), ..Default::default() }
        }),
    ];
    (source, of(words()), of(transform()), medium())
        .prop_map(|(volume, name, transform, medium)| VolumeDescription { name, transform, medium, ..volume })
}

fn shape() -> impl Strategy<Value = ShapeDescription> {
    let none = ShapeDescription::default;
    let triangle = MeshShape {
        vertices: Some(vec![[0.0, 0.0, 0.0], [1.0, 0.5, 0.0], [0.0, 1e-3, 7.0]]),
        triangles: Some(vec![[0, 1, 2], [2, 1, 0]]),
        normals: Some(vec![[0.0, 0.0, 1.0]; 3]),
        uvs: Some(vec![[0.0, 0.25]; 3]),
        ..Default::default()
    };
    let geometry = prop_oneof![
        (words(), any::<bool>()).prop_map(move |(file, flat)| {
            let mesh = MeshShape { file: Some(file), flat, ..Default::default() };
            ShapeDescription { mesh: Some(mesh), ..none() }
        }),
        Just(ShapeDescription { mesh: Some(triangle), ..none() }),
        (vector(), positive()).prop_map(move |(center, radius)| ShapeDescription {
            sphere: Some(SphereShape { center, radius }),
            ..none()
        }),
        positive().prop_map(move |size| ShapeDescription {
            cuboid: Some(BoxShape { min: [-size, -1.0, 0.0], max: [size, 1.0, size] }),
            ..none()
        }),
        (vector(), positive()).prop_map(move |(corner, u)| ShapeDescription {
            rectangle: Some(RectangleShape { corner, u: [u, 0.0, 0.0], v: [0.0, -0.5, 3.0] }),
            ..none()
        }),
        (vector(), direction(), within(0.5, 9.0), within(0.0, 0.4)).prop_map(
            move |(center, normal, radius, inner_radius)| ShapeDescription {
                disc: Some(DiscShape { center, normal, radius, inner_radius }),
                ..none()
            }
        ),
        (direction(), positive(), any::<bool>()).prop_map(move |(to, radius, capped)| ShapeDescription {
            cylinder: Some(CylinderShape { from: [0.0; 3], to, radius, capped }),
            ..none()
        }),
        (vector(), direction()).prop_map(move |(point, normal)| ShapeDescription {
            plane: Some(PlaneShape { point, normal }),
            ..none()
        }),
    ];
    let emission = (light_colours(), within(0.0, 9.0), any::<bool>())
        .prop_map(|(radiance, scale, two_sided)| SurfaceEmission { radiance, scale, two_sided });
    let grey = MaterialDescription::Diffuse { reflectance: 0.25.into() };
    let keys = (of(words()), of(1_u32..=16_777_215), any::<bool>(), any::<bool>());
    let instances = of(proptest::collection::vec(transform(), 0..3));
    (geometry, of(transform()), instances, of(emission), keys).prop_map(
        move |(shape, transform, instances, emission, (name, id, flip, shadow_catcher))| ShapeDescription {
            name,
            transform,
            instances,
            material: Some(MaterialChoice::Here(Box::new(grey.clone()))),
            emission,
            interior: flip.then(|| Names::Several(vec!["inside".into(), "medium".into()])),
            exterior: shadow_catcher.then(|| Names::One("inside".into())),
            flip,
            shadow_catcher,
            id,
            ..shape
        },
    )
}

/// Shapes, the volume that they bound, and the medium in which they are.
fn bounded(
    shapes: Vec<ShapeDescription>,
    volumes: &mut Vec<VolumeDescription>,
    medium: &mut Option<MediumDescription>,
) -> Vec<ShapeDescription> {
    let filling = MediumDescription { preset: Some("coke".into()), ..Default::default() };
    let is_shape = |shape: &ShapeDescription| shape.interior.is_some();
    if shapes.iter().any(is_shape) {
        medium.get_or_insert(filling.clone());
        volumes.push(VolumeDescription {
            name: Some("inside".into()),
            medium: filling,
            ..Default::default()
        });
        return shapes;
    }
    shapes.into_iter().map(|shape| ShapeDescription { exterior: None, ..shape }).collect()
}

fn light() -> impl Strategy<Value = LightDescription> {
    let sky = (of(within(-6.0, 90.0)), of(number()), within(1.0, 20.0), rgb(0.0, 1.0), any::<bool>())
        .prop_map(|(sun_elevation, sun_azimuth, turbidity, ground_albedo, sun)| SkyDescription {
            sun_elevation,
            sun_azimuth,
            turbidity,
            ground_albedo,
            sun,
            ..Default::default()
        });
    prop_oneof![
        light_colours()
            .prop_map(|radiance| LightDescription::Constant(ConstantLightDescription { radiance })),
        (words(), number(), positive(), any::<bool>()).prop_map(|(file, rotation, scale, is_turned)| {
            let filter = ImageFilter::Nearest;
            LightDescription::Image(ImageLightDescription {
                file,
                mapping: if is_turned { ImageMapping::EqualArea } else { ImageMapping::Equirectangular },
                orientation: is_turned.then_some([0.0, 1.0, 0.0, 0.0, 0.0, 1.0, -1.0, 0.0, 0.0]),
                rotation,
                scale,
                filter,
            })
        }),
        sky.prop_map(LightDescription::Sky),
        (direction(), light_colours(), within(1e-3, 90.0)).prop_map(
            |(direction, irradiance, angular_diameter)| {
                LightDescription::Sun(SunLightDescription { direction, irradiance, angular_diameter })
            }
        ),
        (direction(), light_colours()).prop_map(|(direction, irradiance)| {
            LightDescription::Distant(DistantLightDescription { direction, irradiance })
        }),
        (vector(), light_colours()).prop_map(|(position, intensity)| {
            LightDescription::Point(PointLightDescription { position, intensity })
        }),
        (vector(), direction(), light_colours(), within(1e-3, 180.0), within(0.0, 1.0), any::<bool>())
            .prop_map(|(position, direction, intensity, angle, inner, is_linear)| {
                let falloff = if is_linear { SpotFalloff::Linear } else { SpotFalloff::Smooth };
                let inner_angle = inner * angle;
                LightDescription::Spot(SpotLightDescription {
                    position,
                    direction,
                    intensity,
                    angle,
                    inner_angle,
                    falloff,
                })
            }),
    ]
}

fn meter() -> impl Strategy<Value = MeterDescription> {
    let layer = (of(any::<bool>()), within(0.0, 1.0), of(number()), any::<bool>()).prop_map(
        |(is_lit, ground_albedo, phi, is_periodic)| {
            MeterDescription::Layer(LayerMeterDescription {
                name: None,
                bottom: -1.0,
                top: 2.5,
                direction: is_lit.map(|_| [1.0, -2.0, 0.5]),
                periodic: is_periodic.then_some([0.0, 0.0, 3.0, 4.0]),
                columns: is_periodic.then_some([4, 5]),
                ground_albedo,
                radiance: phi.map(|phi| [30.0, phi]).into_iter().collect(),
                channel: is_lit.map(|_| Channel::Green),
            })
        },
    );
    prop_oneof![
        layer,
        (direction(), 1_u32..100).prop_map(|(direction, bins)| {
            MeterDescription::Body(BodyMeterDescription { name: None, direction, bins, channel: None })
        }),
        (vector(), direction()).prop_map(|(position, normal)| {
            MeterDescription::Irradiance(IrradianceMeterDescription { name: None, position, normal })
        }),
        (vector(), direction()).prop_map(|(position, direction)| {
            MeterDescription::Radiance(RadianceMeterDescription { name: None, position, direction })
        }),
    ]
}

fn scene() -> impl Strategy<Value = SceneDescription> {
    (
        words(),
        camera(),
        film_and_render(),
        of(medium().prop_map(|medium| MediumDescription { emission_per_length: None, ..medium })),
        (proptest::collection::vec(volume(), 0..3), proptest::collection::vec(shape(), 0..3)),
        proptest::collection::vec(light(), 0..3),
        proptest::collection::vec(meter(), 0..3),
        named_materials(),
    )
        .prop_map(
            |(unit, camera, (film, render), mut medium, (mut volumes, shapes), lights, meters, materials)| {
                SceneDescription {
                    shapes: bounded(shapes, &mut volumes, &mut medium),
                    materials,
                    unit: if unit.len() % 2 == 0 { "mm".to_owned() } else { "km".to_owned() },
                    camera,
                    film,
                    render,
                    medium,
                    volumes,
                    lights,
                    meters,
                }
            },
        )
}

fn read(text: &str) -> SceneDescription {
    match SceneDocument::parse("printed.toml", text).and_then(|document| document.description()) {
        Ok(description) => description,
        Err(error) => panic!("{error}\n{text}"),
    }
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::with_cases(512) })]

    #[test]
    fn what_is_printed_reads_back_identically(description in scene()) {
        let text = description.to_toml();
        let back = read(&text);
        prop_assert_eq!(&back, &description, "{}", text);
        prop_assert_eq!(back.to_toml(), text);
    }

    #[test]
    fn no_text_makes_reading_panic(text in "[\\[\\]{}=.,\"'a-z0-9\\n #-]{0,60}", cut in 0_usize..400, with in any::<char>()) {
        let _ = SceneDocument::parse("scene.toml", &text).and_then(|document| document.description());
        // And a sound scene with one character changed.
        let sound = EXAMPLE;
        if let Some((at, old)) = sound.char_indices().nth(cut % sound.chars().count()) {
            let changed = format!("{}{with}{}", &sound[..at], &sound[at + old.len_utf8()..]);
            if let Err(error) = SceneDocument::parse("scene.toml", &changed).and_then(|document| document.description()) {
                prop_assert!(!error.to_string().contains('\n'), "{}", error);
            }
        }
    }
}

const EXAMPLE: &str = r#"unit = "m"

[camera]
position = [0, 1.5, 5]
target = [0, 0, 0]
up = [0, 1, 0]
vertical_fov = 40

[film]
resolution = [1280, 720]
exposure = 0

[render]
spp = 64
seed = 0
integrator = "fast"

[[volume]]
file = "cloud.vdb"
transform = { scale = 0.01, translate = [0, 0.5, 0] }
mu_t = 8
albedo = [0.99, 0.98, 0.97]
phase = { type = "hg", g = 0.85 }

[[light]]
type = "constant"
radiance = 1
"#;

#[test]
fn a_printed_scene_looks_as_a_person_would_write_it() {
    assert_eq!(read(EXAMPLE).to_toml(), EXAMPLE);
}

#[test]
fn the_hash_tells_scenes_apart_that_differ_in_what_is_seen() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("cloud.vdb"), "voxels").unwrap();
    fs::write(folder.path().join("copy.vdb"), "voxels").unwrap();
    fs::write(folder.path().join("other.vdb"), "other voxels").unwrap();
    let hash = |option: &str| {
        let mut document = SceneDocument::parse("scene.toml", EXAMPLE).unwrap();
        if !option.is_empty() {
            document.set(option).unwrap();
        }
        scene_hash(&document.description().unwrap(), folder.path()).unwrap()
    };
    let plain = hash("");
    for same in [
        "volume.0.file=copy.vdb",
        "volume.0.name=cloud",
        "render.spp=128",
        "render.seed=3",
        "film.exposure=2",
        "camera.vertical_fov=40.0",
    ] {
        assert_eq!(hash(same), plain, "{same}");
    }
    for different in [
        "volume.0.file=other.vdb",
        "volume.0.mu_t=8.0000001",
        "render.max_depth=3",
        "render.mode=spectral",
        "volume.0.emission={ blackbody = 3000 }",
        "volume.0.scale=2",
        "film.resolution=[1280, 721]",
        "light.0.radiance=2",
        "camera.position=[0, 1.5, 6]",
    ] {
        assert_ne!(hash(different), plain, "{different}");
    }
    let with_preset = |unit: &str| {
        let text = EXAMPLE.replace("mu_t = 8\nalbedo = [0.99, 0.98, 0.97]", "preset = \"coke\"");
        let description = read(&text.replace("unit = \"m\"", &format!("unit = \"{unit}\"")));
        scene_hash(&description, folder.path()).unwrap()
    };
    assert_ne!(with_preset("m"), with_preset("cm"));
    // The hash is part of files that are merged later: it must not change by accident.
    assert_eq!(plain.to_string().len(), 32);
}

#[test]
fn the_hash_names_a_file_that_is_not_there() {
    let error = scene_hash(&read(EXAMPLE), std::path::Path::new("no/such/folder")).unwrap_err().to_string();
    assert!(error.starts_with("no/such/folder/cloud.vdb: "), "{error}");
}
