//! The pictures of the gallery, in the order of the subject: what each panel renders, shows and says.

/// A folder of `examples/` and its picture.
pub struct Chapter {
    pub folder: &'static str,
    pub picture: Picture,
}

/// How a picture is made.
pub enum Picture {
    /// `picture.png`: renders side by side.
    Panels { columns: usize, panels: &'static [Panel] },
    /// `picture.svg`: what `tyndall` draws when it is given this line.
    Command { line: &'static str },
    /// `picture.svg`: what a program of the gallery draws.
    Chart(Chart),
}

/// Programs that draw charts, each in a file of that name.
pub enum Chart {
    Convergence,
    Distances,
    Transmittances,
}

/// One of several pictures side by side.
pub struct Panel {
    /// What follows `tyndall render`, in the folder of the chapter.
    pub render: &'static str,
    pub shown: Shown,
    pub caption: &'static str,
}

/// The layer that a panel shows.
pub enum Shown {
    Radiance,
    /// Light that was neither emitted nor scattered by a medium.
    Background,
    Emission,
    Single,
    Multiple,
    Transmittance,
    StandardError {
        /// By how much it is brightened.
        times: f32,
    },
}

const fn panel(render: &'static str, caption: &'static str) -> Panel {
    Panel { render, shown: Shown::Radiance, caption }
}

const fn layer(render: &'static str, shown: Shown, caption: &'static str) -> Panel {
    Panel { render, shown, caption }
}

const fn panels(folder: &'static str, columns: usize, panels: &'static [Panel]) -> Chapter {
    Chapter { folder, picture: Picture::Panels { columns, panels } }
}

const fn chart(folder: &'static str, chart: Chart) -> Chapter {
    Chapter { folder, picture: Picture::Chart(chart) }
}

/// All chapters.
pub const CHAPTERS: &[Chapter] = &[
    panels(
        "01_absorption",
        4,
        &[
            panel("scene.toml --set volume.0.mu_a=0.5", "μa = 0.5 /km"),
            panel("scene.toml --set volume.0.mu_a=2", "μa = 2 /km"),
            panel("scene.toml --set volume.0.mu_a=8", "μa = 8 /km"),
            panel("scene.toml --set volume.0.mu_a=32", "μa = 32 /km"),
        ],
    ),
    panels(
        "02_out_scattering",
        3,
        &[
            panel("scene.toml --set volume.0.mu_a=4 --set volume.0.mu_s=0", "absorbed: μa = 4, μs = 0"),
            panel("scene.toml", "scattered out: μa = 0, μs = 4"),
            panel("scene.toml --set render.max_depth=1000", "... and where it went"),
        ],
    ),
    panels(
        "03_in_scattering",
        4,
        &[
            panel("scene.toml --set render.max_depth=1", "scattered once"),
            panel("scene.toml --set render.max_depth=4", "at most 4 times"),
            panel("scene.toml --set render.max_depth=16", "at most 16 times"),
            panel("scene.toml", "as often as it happens"),
        ],
    ),
    panels(
        "04_emission",
        4,
        &[
            panel("scene.toml --set volume.0.mu_a=0.25", "μa = 0.25 /m"),
            panel("scene.toml --set volume.0.mu_a=1", "μa = 1 /m"),
            panel("scene.toml --set volume.0.mu_a=4", "μa = 4 /m"),
            panel("scene.toml --set volume.0.mu_a=64", "μa = 64 /m: L = Le"),
        ],
    ),
    panels(
        "05_radiative_transfer_equation",
        3,
        &[
            layer("scene.toml", Shown::Background, "T Lo: what gets through"),
            layer("scene.toml", Shown::Emission, "+ light of the fire"),
            layer("scene.toml", Shown::Single, "+ scattered once"),
            layer("scene.toml", Shown::Multiple, "+ scattered more often"),
            layer("scene.toml", Shown::Radiance, "= L: all of it"),
            layer("scene.toml", Shown::Transmittance, "the transmittance T"),
        ],
    ),
    panels(
        "06_transmittance",
        3,
        &[
            panel("scene.toml --set volume.24.mu_a=0", "vacuum: T = 1"),
            panel(
                "scene.toml --set volume.24.atmosphere.scale_height=1e6 --set volume.24.mu_a=0.05",
                "μa = 0.05 /m everywhere",
            ),
            panel("scene.toml", "thinning out with height"),
        ],
    ),
    Chapter {
        folder: "07_phase_functions",
        picture: Picture::Command { line: "phase isotropic rayleigh hg:0.5 hg:0.85 fog(d=10um)" },
    },
    panels(
        "08_smoke_and_steam",
        1,
        &[panel("scene.toml", "      smoke: albedo 0.4                        steam: albedo 0.9999")],
    ),
    panels(
        "09_isotropic_and_forward",
        3,
        &[
            panel("scene.toml --set volume.0.phase.g=-0.5", "sun behind the cloud, g = -0.5"),
            panel("scene.toml", "g = 0: isotropic"),
            panel("scene.toml --set volume.0.phase.g=0.7", "g = 0.7: forward"),
            panel(
                "scene.toml --set light.0.direction=[-0.5,-0.45,-1.0] --set volume.0.phase.g=-0.5",
                "sun behind the viewer, g = -0.5",
            ),
            panel("scene.toml --set light.0.direction=[-0.5,-0.45,-1.0]", "g = 0: isotropic"),
            panel(
                "scene.toml --set light.0.direction=[-0.5,-0.45,-1.0] --set volume.0.phase.g=0.7",
                "g = 0.7: forward",
            ),
        ],
    ),
    panels(
        "10_background_radiance",
        3,
        &[
            panel("scene.toml", "Lo = 0"),
            panel("scene.toml --set light.1={type=\"constant\",radiance=0.3}", "Lo = 0.3 all around"),
            panel(
                "scene.toml --set light.1={type=\"sky\",sun_elevation=4,sun_azimuth=50}",
                "Lo = an evening sky",
            ),
        ],
    ),
    chart("11_monte_carlo_integration", Chart::Convergence),
    panels(
        "12_volume_rendering_estimator",
        5,
        &[
            panel("scene.toml --spp 1", "1 sample a pixel"),
            panel("scene.toml --spp 4", "4 samples"),
            panel("scene.toml --spp 16", "16 samples"),
            panel("scene.toml --spp 64", "64 samples"),
            panel("scene.toml --spp 256", "256 samples"),
            layer("scene.toml --spp 1", Shown::StandardError { times: 2.0 }, "SE: not known from 1"),
            layer("scene.toml --spp 4", Shown::StandardError { times: 2.0 }, "2 x standard error"),
            layer("scene.toml --spp 16", Shown::StandardError { times: 2.0 }, "half as large"),
            layer("scene.toml --spp 64", Shown::StandardError { times: 2.0 }, "a quarter"),
            layer("scene.toml --spp 256", Shown::StandardError { times: 2.0 }, "an eighth"),
        ],
    ),
    chart("13_distance_sampling", Chart::Distances),
    chart("14_transmittance_estimation", Chart::Transmittances),
    panels(
        "15_chromatic_media",
        4,
        &[
            panel("scene.toml", "whole milk"),
            panel("scene.toml --set volume.0.preset=Skimmilk", "skimmed milk"),
            panel("scene.toml --set volume.0.preset=Ketchup", "ketchup"),
            panel("scene.toml --set volume.0.preset=CranberryJuice", "cranberry juice"),
        ],
    ),
    panels(
        "16_blackbody_fire",
        5,
        &[
            panel("scene.toml --set volume.0.emission.blackbody=1200", "1200 K: embers"),
            panel("scene.toml --set volume.0.emission.blackbody=1900", "1900 K: a candle"),
            panel("scene.toml", "3000 K: a light bulb"),
            panel("scene.toml --set volume.0.emission.blackbody=5800", "5800 K: the sun"),
            panel("scene.toml --set volume.0.emission.blackbody=20000", "20000 K: a hot star"),
        ],
    ),
    panels(
        "17_rainbow_and_glory",
        3,
        &[
            panel("scene.toml", "10 μm: fogbow and glory"),
            panel("scene.toml --set volume.0.phase.distribution.r_eff=50um", "50 μm"),
            panel("scene.toml --set volume.0.phase.distribution.r_eff=500um", "500 μm: rain, two bows"),
        ],
    ),
    panels(
        "18_blue_sky",
        3,
        &[
            panel("scene.toml", "the sun 60° high"),
            panel("scene.toml --set light.0.direction=[-0.3,-0.15,-0.95]", "9° high"),
            panel("scene.toml --set light.0.direction=[-0.3,-0.03,0.95]", "setting before us"),
        ],
    ),
    panels(
        "19_glass_of_milk",
        2,
        &[
            panel("scene.toml", "whole milk"),
            panel("scene.toml --set volume.0.preset=Skimmilk", "skimmed milk"),
        ],
    ),
    panels("20_fog_in_a_room", 1, &[panel("scene.toml", "the sun through a window, in fog")]),
    panels("21_lamps_in_smoke", 1, &[panel("scene.toml", "a bulb and a spot light")]),
    panels("22_fire_over_a_floor", 1, &[panel("scene.toml", "the flames are the only light")]),
];
