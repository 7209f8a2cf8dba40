//! Any materials, for round trips.

use proptest::option::of;
use proptest::prelude::*;
use tyndall_scene::description::*;

use super::{colours, number, positive, within, words};

fn placement() -> impl Strategy<Value = (Option<[f64; 2]>, Option<[f64; 2]>)> {
    (of([number(), number()]), of([number(), number()]))
}

fn texture() -> BoxedStrategy<TextureDescription> {
    let wrap = prop_oneof![Just(TextureWrap::Repeat), Just(TextureWrap::Clamp), Just(TextureWrap::Mirror)];
    let filter = prop_oneof![Just(ImageFilter::Bilinear), Just(ImageFilter::Nearest)];
    let image = (words(), of(any::<bool>()), filter, wrap, placement(), of(positive())).prop_map(
        |(name, srgb, filter, wrap, (scale, offset), factor)| {
            let image = format!("{name}.png");
            TextureDescription::Image(ImageTexture { image, srgb, filter, wrap, scale, offset, factor })
        },
    );
    let checker = ([colours(1.0), colours(1.0)], placement()).prop_map(|(checker, (scale, offset))| {
        TextureDescription::Checker(CheckerTexture { checker, scale, offset })
    });
    prop_oneof![colours(1.0).prop_map(TextureDescription::Constant), image, checker].boxed()
}

fn roughness() -> impl Strategy<Value = Option<Roughness>> {
    let alpha = || within(0.0, 1.0);
    of(prop_oneof![alpha().prop_map(Roughness::Equal), [alpha(), alpha()].prop_map(Roughness::Pair)])
}

fn index() -> impl Strategy<Value = IndexChoice> {
    let names = prop_oneof![Just("water"), Just("glass-BK7"), Just("fused quartz")];
    prop_oneof![
        within(0.01, 100.0).prop_map(IndexChoice::Number),
        names.prop_map(|name| IndexChoice::Name(name.to_owned())),
    ]
}

fn conductor() -> BoxedStrategy<MaterialDescription> {
    let none = |metal, eta, k, reflectance| MaterialDescription::Conductor {
        metal,
        eta,
        k,
        reflectance,
        roughness: None,
        tint: None,
    };
    let index = prop_oneof![
        prop_oneof![Just("copper"), Just("Au"), Just("metal-CuZn-eta")].prop_map(move |name| none(
            Some(name.to_owned()),
            None,
            None,
            None
        )),
        (colours(9.0), colours(9.0)).prop_map(move |(eta, k)| none(None, Some(eta), Some(k), None)),
        colours(1.0).prop_map(move |reflectance| none(None, None, None, Some(reflectance))),
    ];
    (index, roughness(), of(texture()))
        .prop_map(|(mut conductor, rough, factor)| {
            if let MaterialDescription::Conductor { roughness, tint, .. } = &mut conductor {
                (*roughness, *tint) = (rough, factor);
            }
            conductor
        })
        .boxed()
}

/// A material that is no mixture by name.
pub fn material() -> BoxedStrategy<MaterialDescription> {
    let simple = prop_oneof![
        texture().prop_map(|reflectance| MaterialDescription::Diffuse { reflectance }),
        (texture(), within(0.0, 90.0))
            .prop_map(|(reflectance, sigma)| MaterialDescription::RoughDiffuse { reflectance, sigma }),
        conductor(),
        (index(), roughness(), of(texture()), of(texture())).prop_map(
            |(index, roughness, reflection_tint, transmission_tint)| MaterialDescription::Dielectric {
                index,
                roughness,
                reflection_tint,
                transmission_tint,
            }
        ),
        (index(), of(texture()), of(texture())).prop_map(|(index, reflection_tint, transmission_tint)| {
            MaterialDescription::ThinDielectric { index, reflection_tint, transmission_tint }
        }),
        (texture(), index(), roughness(), of(texture()), any::<bool>()).prop_map(
            |(reflectance, index, roughness, reflection_tint, nonlinear)| MaterialDescription::Plastic {
                reflectance,
                index,
                roughness,
                reflection_tint,
                nonlinear,
            }
        ),
        Just(MaterialDescription::Null),
    ];
    // In boxes, since a strategy of so many parts is too large for the stack.
    let simple = simple.boxed();
    let mixed = (simple.clone(), simple.clone(), texture()).prop_map(|(first, second, amount)| {
        let materials = [first, second].map(|part| MaterialChoice::Here(Box::new(part)));
        MaterialDescription::Mix { materials, amount }
    });
    prop_oneof![4 => simple, 1 => mixed].boxed()
}

/// Materials of different names, each of which may be mixed of those before it.
pub fn named_materials() -> BoxedStrategy<Vec<NamedMaterial>> {
    proptest::collection::vec((words(), material(), of(texture())), 0..3)
        .prop_map(|parts| {
            let mut named: Vec<NamedMaterial> = Vec::new();
            for (number, (name, material, amount)) in parts.into_iter().enumerate() {
                let material = match (amount, named.last()) {
                    (Some(amount), Some(before)) => {
                        let first = MaterialChoice::Name(before.name.clone());
                        let materials = [first, MaterialChoice::Here(Box::new(material))];
                        MaterialDescription::Mix { materials, amount }
                    }
                    _ => material,
                };
                named.push(NamedMaterial { name: format!("{name}{number}"), material });
            }
            named
        })
        .boxed()
}
