//! Sound scenes in which, together, every key of the schema stands in every form: what bad values are put into.
//!
//! A scene is made of these tables and of [`REST`], as far as it has no such tables itself.

/// What every scene needs.
pub const REST: &str = r#"
    camera = { position = [0, 0.3, 4], target = [0, 0, 0] }
    film = { resolution = [2, 1] }
    render = { spp = 2 }
    light = [{ type = "constant", radiance = 1 }]
"#;

/// The tables, by what they are about.
pub const BASE_SCENES: &[(&str, &str)] = &[
    (
        "lens",
        r#"
        camera = { position = [0, 0.3, 4], target = [0, 0, 0], up = [0, 1, 0], projection = "perspective", vertical_fov = 40, aperture_radius = 0.1, focus_distance = 4, inside = "fog" }
        volume = [{ name = "fog", mu_t = 1, albedo = 0.5 }]
        shape = [{ sphere = { center = [0, 0, 0], radius = 9 }, material = { type = "null" }, interior = "fog" }]
    "#,
    ),
    (
        "orthographic",
        r#"
        camera = { position = [0, 0.3, 4], direction = [0, 0, -1], projection = "orthographic", height = 2, inside = ["fog"] }
        volume = [{ name = "fog", mu_t = 1, albedo = 0.5 }]
        shape = [{ sphere = { center = [0, 0, 0], radius = 9 }, material = { type = "null" }, interior = ["fog"] }]
    "#,
    ),
    (
        "window",
        r#"
        camera = { position = [0, 0.3, 4], direction = [0, 0, -1], window = [-0.5, 0.5, -0.4, 0.4] }
        volume = [{ sphere = { center = [0, 0, 0], radius = 1 }, mu_t = 1, albedo = 0.5 }]
    "#,
    ),
    (
        "film",
        r#"
        film = { resolution = [5, 4], crop = [1, 1, 3, 2], exposure = 1, layers = ["depth", "albedo", "emission", "single", "multiple", "normal", "object_id", "shadow_catcher", "effort"], output = "rgb" }
        render = { spp = 2, seed = 1, max_depth = 5, integrator = "fast", sampler = "sobol", adaptive = true, mode = "rgb" }
        volume = [{ sphere = { center = [0, 0, 0], radius = 1 }, mu_t = 1, albedo = 0.5 }]
    "#,
    ),
    (
        "bands",
        r#"
        film = { resolution = [3, 2], bands = [450, 550] }
        render = { spp = 2, mode = "spectral" }
        volume = [{ sphere = { center = [0, 0, 0], radius = 1 }, mu_t = 1, albedo = 0.5 }]
    "#,
    ),
    (
        "fog everywhere",
        r#"
        unit = "m"
        medium = { mu_t = 0.5, albedo = 0.9, scale = 1, phase = { type = "hg", g = 0.5 }, emission = 0.1 }
        light = [{ type = "distant", direction = [1, -1, 0], irradiance = 1 }]
    "#,
    ),
    (
        "coloured fog everywhere",
        r#"
        medium = { mu_t = [0.5, 0.6, 0.7], albedo = [0.9, 0.8, 0.7], phase = { type = "draine", g = 0.5, alpha = 1 }, emission = [0.1, 0.2, 0.3], emission_per_length = [0.1, 0.2, 0.3] }
    "#,
    ),
    (
        "absorbing fog everywhere",
        r#"
        medium = { mu_a = 0.5, mu_s = 0.2, phase = { type = "cornette_shanks", g = 0.5 }, emission_per_length = 0.1 }
        light = [{ type = "point", position = [1, 2, 1], intensity = 5 }]
    "#,
    ),
    (
        "coloured absorbing fog everywhere",
        r#"
        medium = { mu_a = [0.5, 0.1, 0.2], mu_s = [0.2, 0.2, 0.2], phase = { type = "schlick", k = 0.5 } }
    "#,
    ),
    (
        "fog everywhere by its mean free path",
        r#"
        medium = { mean_free_path = 2, reflectance = 0.5, phase = { type = "isotropic" } }
        light = [{ type = "spot", position = [0, 3, 0], direction = [0, -1, 0], intensity = 9, angle = 40, inner_angle = 10, falloff = "linear" }]
    "#,
    ),
    (
        "coloured fog everywhere by its mean free path",
        r#"
        medium = { mean_free_path = [2, 3, 4], reflectance = [0.5, 0.6, 0.7] }
        light = [{ type = "spot", position = [0, 3, 0], direction = [0, -1, 0], intensity = [9, 8, 7], angle = 40 }]
    "#,
    ),
    (
        "measured fog everywhere",
        r#"
        medium = { preset = "skimmilk", scale = 0.01 }
    "#,
    ),
    (
        "particles everywhere",
        r#"
        medium = { particles = { m = [1.4, 0.001], distribution = { type = "single", r = "0.3 um" }, number_density = "10 /cm3" } }
    "#,
    ),
    (
        "ball",
        r#"
        volume = [{ name = "ball", sphere = { center = [0, 0, 0], radius = 1 }, mu_t = 2, albedo = 0.9, scale = 1, phase = { type = "double_hg", g1 = 0.5, g2 = -0.2, weight = 0.7 }, emission = 0.2, emission_scale = 2, transform = { scale = 1.1, rotate = [0, 20, 0], translate = [0.1, 0, 0] } }]
        light = [{ type = "point", position = [1, 2, 1], intensity = [5, 4, 3] }]
    "#,
    ),
    (
        "coloured ball",
        r#"
        volume = [{ sphere = { center = [0, 0, 0], radius = 1 }, mu_t = [2, 1, 3], albedo = [0.9, 0.8, 0.7], phase = { type = "rayleigh" }, emission = [0.1, 0.2, 0.3], transform = { scale = [1.1, 1, 0.9] } }]
    "#,
    ),
    (
        "cube",
        r#"
        volume = [{ box = { min = [-1, -1, -1], max = [1, 1, 1] }, mu_a = 0.5, mu_s = 1.5, phase = { type = "fog", droplet_diameter_um = 10 }, emission_per_length = 0.2, transform = { matrix = [1, 0.1, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1] } }]
        light = [{ type = "sun", direction = [1, -1, 0], irradiance = 1, angular_diameter = 2 }]
    "#,
    ),
    (
        "coloured cube",
        r#"
        volume = [{ box = { min = [-1, -1, -1], max = [1, 1, 1] }, mu_a = [0.5, 0.6, 0.7], mu_s = [1, 2, 3], emission_per_length = [0.2, 0.1, 0.1] }]
        light = [{ type = "sun", direction = [1, -1, 0], irradiance = [1, 2, 3] }]
    "#,
    ),
    (
        "slab",
        r#"
        volume = [{ slab = { bottom = -1, top = 1 }, mean_free_path = 2, albedo = 0.5, phase = { type = "sggx", kind = "surface", axis = [0, 1, 0], roughness = 0.5 } }]
        light = [{ type = "distant", direction = [1, -1, 0], irradiance = [1, 2, 3] }]
    "#,
    ),
    (
        "coloured slab",
        r#"
        volume = [{ slab = { bottom = -1, top = 1 }, mean_free_path = [2, 1, 3], reflectance = [0.3, 0.4, 0.5], phase = { type = "tabulated", file = "phase.csv", wavelength_nm = 500 } }]
    "#,
    ),
    (
        "atmosphere",
        r#"
        volume = [{ atmosphere = { bottom = 0, top = 50, scale_height = 2 }, mean_free_path = 3, reflectance = 0.5 }]
        light = [{ type = "distant", direction = [1, -1, 0], irradiance = 1 }]
    "#,
    ),
    (
        "procedural cloud",
        r#"
        volume = [{ procedural = { type = "cumulus", seed = 1, resolution = 8, center = [0, 0, 0], size = 2 }, mu_t = 5, albedo = 0.9, storage = "f16", filter = "trilinear" }]
        light = [{ type = "distant", direction = [1, -1, 0], irradiance = 1 }]
    "#,
    ),
    (
        "grid",
        r#"
        volume = [{ file = "density.npy", grid = "density", values = "density", filter = "nearest", storage = "u8", mu_t = 2, albedo = 0.8, albedo_grid = { file = "paint.npy", grid = "vector" }, emission = 1, emission_grid = { file = "density.npy", grid = "density", scale = 2 }, transform = { translate = [-1.5, -2, -1] } }]
        light = [{ type = "constant", radiance = [1, 2, 3] }]
    "#,
    ),
    (
        "fire",
        r#"
        volume = [{ file = "density.npy", mu_t = 2, albedo = 0.8, temperature = { file = "kelvin.npy", grid = "density", scale = 1, offset = 10, normalised = true }, transform = { translate = [-1.5, -2, -1] } }]
    "#,
    ),
    (
        "raw grid",
        r#"
        volume = [{ file = "bytes.raw", raw_shape = [4, 3, 2], raw_type = "u8", mu_t = 0.1, albedo = 0.8 }]
    "#,
    ),
    (
        "measured ball",
        r#"
        unit = "cm"
        volume = [{ sphere = { center = [0, 0, 0], radius = 1 }, preset = "skimmilk" }]
    "#,
    ),
    (
        "spectra",
        r#"
        volume = [{ sphere = { center = [0, 0, 0], radius = 1 }, mu_t = { wavelengths = [450, 650], values = [1, 2] }, albedo = { power_law = -1, at = 550, value = 0.5 } }]
        light = [{ type = "constant", radiance = { blackbody = 5000, luminance = 2 } }]
    "#,
    ),
    (
        "black body",
        r#"
        volume = [{ sphere = { center = [0, 0, 0], radius = 1 }, mu_t = 1, albedo = 0.5 }]
        light = [{ type = "point", position = [1, 2, 1], intensity = { blackbody = 3000, scale = 0.001 } }]
    "#,
    ),
    (
        "droplets",
        r#"
        volume = [{ sphere = { center = [0, 0, 0], radius = 1 }, particles = { material = "water", distribution = { type = "gamma", r_eff = "0.4 um", v_eff = 0.1 }, liquid_water = "0.01 g/m3" } }]
    "#,
    ),
    (
        "dust",
        r#"
        volume = [{ sphere = { center = [0, 0, 0], radius = 1 }, particles = { m = 1.5, distribution = { type = "log_normal", r_g = "0.1 um", sigma_g = 1.3, r_min = "0.05 um", r_max = "0.2 um" }, mass_concentration = "50 mg/m3", density = "2.6 g/cm3" } }]
    "#,
    ),
    (
        "soot",
        r#"
        volume = [{ sphere = { center = [0, 0, 0], radius = 1 }, particles = { m = "1.75+0.4i", distribution = { type = "modified_gamma", r_mode = "0.1 um", alpha = 6, gamma = 1 }, volume_fraction = 1e-7 } }]
    "#,
    ),
    (
        "powder",
        r#"
        volume = [{ sphere = { center = [0, 0, 0], radius = 1 }, particles = { material_file = "index.csv", distribution = { type = "power_law", exponent = 3, r_min = "0.1 um", r_max = "0.3 um" }, volume_fraction = 1e-7 } }]
    "#,
    ),
    (
        "one sphere",
        r#"
        volume = [{ sphere = { center = [0, 0, 0], radius = 1 }, mu_t = 1, albedo = 0.5, phase = { type = "mie", m = 1.33, x = 3, wavelength_nm = 550 } }]
    "#,
    ),
    (
        "many spheres",
        r#"
        volume = [{ sphere = { center = [0, 0, 0], radius = 1 }, mu_t = 1, albedo = 0.5, phase = { type = "mie", m = [1.33, 0.01], distribution = { type = "single", r = "0.2 um" } } }]
    "#,
    ),
    (
        "water spheres",
        r#"
        volume = [{ sphere = { center = [0, 0, 0], radius = 1 }, mu_t = 1, albedo = 0.5, phase = { type = "mie", material = "water", x = 3 } }, { sphere = { center = [0, 1, 0], radius = 1 }, mu_t = 1, albedo = 0.5, phase = { type = "mie", material_file = "index.csv", x = 3 } }, { sphere = { center = [0, 2, 0], radius = 1 }, mu_t = 1, albedo = 0.5, phase = { type = "mie", m = "1.4+0.1i", x = 3 } }]
    "#,
    ),
    (
        "sky",
        r#"
        light = [{ type = "sky", sun_elevation = 30, sun_azimuth = 90, turbidity = 2, altitude = 100, ground_albedo = 0.2, intensity = 1, sun = true, angular_diameter = 0.5 }]
    "#,
    ),
    (
        "coloured ground",
        r#"
        light = [{ type = "sky", toward_sun = [0.2, 0.5, 0], ground_albedo = [0.2, 0.3, 0.4], sun = false }]
    "#,
    ),
    (
        "surroundings",
        r#"
        light = [{ type = "image", file = "picture.hdr", mapping = "equirectangular", orientation = [1, 0, 0, 0, 1, 0, 0, 0, 1], rotation = 10, scale = 2, filter = "bilinear" }]
        volume = [{ sphere = { center = [0, 0, 0], radius = 1 }, mu_t = 1, albedo = 0.5 }]
    "#,
    ),
    (
        "surroundings on a square",
        r#"
        light = [{ type = "image", file = "square.hdr", mapping = "equal_area" }]
        volume = [{ sphere = { center = [0, 0, 0], radius = 1 }, mu_t = 1, albedo = 0.5 }]
    "#,
    ),
    (
        "matte shapes",
        r#"
        material = [{ name = "paper", type = "diffuse", reflectance = 0.5 }, { name = "chalk", type = "rough_diffuse", reflectance = 0.5, sigma = 20 }]
        shape = [
            { name = "ball", sphere = { center = [0, 0, 0], radius = 0.5 }, material = "paper", flip = false, shadow_catcher = false, id = 3, transform = { scale = 1.1, rotate = [0, 20, 0], translate = [0.1, 0, 0] } },
            { rectangle = { corner = [-2, -1, -2], u = [0, 0, 4], v = [4, 0, 0] }, material = "chalk" },
        ]
    "#,
    ),
    (
        "coloured matte shapes",
        r#"
        shape = [
            { box = { min = [-0.5, -0.5, -0.5], max = [0.5, 0.5, 0.5] }, material = { type = "diffuse", reflectance = [0.5, 0.6, 0.7] } },
            { disc = { center = [0, -1, 0], normal = [0, 1, 0], radius = 3, inner_radius = 0.2 }, material = { type = "rough_diffuse", reflectance = [0.5, 0.6, 0.7], sigma = 20 } },
        ]
    "#,
    ),
    (
        "textures",
        r#"
        shape = [
            { rectangle = { corner = [-2, -1, 0], u = [4, 0, 0], v = [0, 3, 0] }, material = { type = "diffuse", reflectance = { image = "picture.hdr", srgb = false, filter = "bilinear", wrap = "repeat", scale = [2, 2], offset = [0.1, 0.2], factor = 0.9 } } },
            { rectangle = { corner = [-2, -1, -2], u = [0, 0, 4], v = [4, 0, 0] }, material = { type = "diffuse", reflectance = { checker = [0.2, [0.3, 0.4, 0.5]], scale = [2, 2], offset = [0.1, 0.2] } } },
        ]
    "#,
    ),
    (
        "metals",
        r#"
        shape = [
            { sphere = { center = [0, 0, 0], radius = 0.5 }, material = { type = "conductor", metal = "copper", roughness = 0.2, tint = 0.9 } },
            { sphere = { center = [1, 0, 0], radius = 0.5 }, material = { type = "conductor", eta = 0.2, k = 3, roughness = [0.2, 0.3], tint = [0.9, 0.8, 0.7] } },
            { sphere = { center = [-1, 0, 0], radius = 0.5 }, material = { type = "conductor", eta = [0.2, 0.3, 0.4], k = [3, 2, 1] } },
            { sphere = { center = [0, 1, 0], radius = 0.5 }, material = { type = "conductor", reflectance = 0.5 } },
            { sphere = { center = [0, -1, 0], radius = 0.5 }, material = { type = "conductor", reflectance = [0.5, 0.6, 0.7] } },
        ]
    "#,
    ),
    (
        "glass",
        r#"
        shape = [
            { sphere = { center = [0, 0, 0], radius = 0.5 }, material = { type = "dielectric", index = 1.5, roughness = 0.2, reflection_tint = 0.9, transmission_tint = 0.8 } },
            { sphere = { center = [1, 0, 0], radius = 0.5 }, material = { type = "dielectric", index = "water", roughness = [0.2, 0.3], reflection_tint = [0.9, 0.8, 0.7], transmission_tint = [0.9, 0.8, 0.7] } },
            { sphere = { center = [-1, 0, 0], radius = 0.5 }, material = { type = "dielectric", index = 1.5 } },
            { sphere = { center = [0, 1, 0], radius = 0.5 }, material = { type = "thin_dielectric", index = 1.5, reflection_tint = 0.9, transmission_tint = 0.8 } },
            { sphere = { center = [0, -1, 0], radius = 0.5 }, material = { type = "thin_dielectric", index = "bk7", reflection_tint = [0.9, 0.8, 0.7], transmission_tint = [0.9, 0.8, 0.7] } },
        ]
    "#,
    ),
    (
        "plastic",
        r#"
        shape = [
            { sphere = { center = [0, 0, 0], radius = 0.5 }, material = { type = "plastic", reflectance = 0.5, index = 1.5, roughness = 0.2, reflection_tint = 0.9, nonlinear = true } },
            { sphere = { center = [1, 0, 0], radius = 0.5 }, material = { type = "plastic", reflectance = [0.5, 0.6, 0.7], index = "water", roughness = [0.2, 0.3], reflection_tint = [0.9, 0.8, 0.7] } },
            { sphere = { center = [-1, 0, 0], radius = 0.5 }, material = { type = "plastic" } },
        ]
    "#,
    ),
    (
        "mixtures",
        r#"
        material = [{ name = "paper", type = "diffuse" }, { name = "both", type = "mix", materials = ["paper", { type = "conductor", metal = "gold" }], amount = 0.5 }, { name = "others", type = "mix", materials = ["paper", "gold"], amount = [0.5, 0.6, 0.7] }, { name = "gold", type = "conductor", metal = "gold" }, { name = "glass", type = "dielectric" }, { name = "pane", type = "thin_dielectric" }, { name = "paint", type = "plastic" }, { name = "none", type = "null" }]
        shape = [
            { sphere = { center = [0, 0, 0], radius = 0.5 }, material = "both" },
            { sphere = { center = [1, 0, 0], radius = 0.5 }, material = { type = "mix", materials = [{ type = "null" }, "paper"], amount = [0.5, 0.6, 0.7] } },
            { sphere = { center = [-1, 0, 0], radius = 0.5 }, material = { type = "mix", materials = ["glass", "paint"], amount = 0.5 } },
        ]
    "#,
    ),
    (
        "mesh",
        r#"
        shape = [{ mesh = { vertices = [[-1, -1, 0], [1, -1, 0], [0, 1, 0]], triangles = [[0, 1, 2]], normals = [[0, 0, 1], [0, 0.1, 1], [0.1, 0, 1]], uvs = [[0, 0], [1, 0], [0, 1]], flat = false }, material = { type = "diffuse", reflectance = { checker = [0.2, 0.8] } }, instances = [{ scale = [1, 1, 1], rotate = [0, 0, 10], translate = [0, 0, 0.5] }, { matrix = [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1] }] }]
    "#,
    ),
    (
        "mesh file",
        r#"
        shape = [{ mesh = { file = "square.obj", flat = true }, material = { type = "diffuse" }, shadow_catcher = true }]
        light = [{ type = "point", position = [1, 2, 1], intensity = 5 }]
    "#,
    ),
    (
        "shapes of fog",
        r#"
        medium = { mu_t = 0.2, albedo = 0.5 }
        volume = [{ name = "milk", mu_t = 3, albedo = 0.9 }]
        shape = [
            { cylinder = { from = [0, -1, 0], to = [0, 1, 0], radius = 0.7, capped = true }, material = { type = "dielectric" }, interior = ["milk"], exterior = ["medium"] },
            { sphere = { center = [1.5, 0, 0], radius = 0.5 }, material = { type = "null" }, interior = "milk", exterior = "medium" },
            { plane = { point = [0, -1, 0], normal = [0, 1, 0] }, material = { type = "diffuse" } },
        ]
    "#,
    ),
    (
        "lamps",
        r#"
        light = []
        medium = { mu_t = 0.1, albedo = 0.5 }
        shape = [
            { sphere = { center = [0, 2, 0], radius = 0.3 }, material = { type = "diffuse" }, emission = { radiance = 5, scale = 2, two_sided = true } },
            { disc = { center = [0, -1, 0], normal = [0, 1, 0], radius = 1 }, material = { type = "diffuse" }, emission = { radiance = [1, 2, 3] } },
            { rectangle = { corner = [-2, -1, -2], u = [0, 3, 0], v = [4, 0, 0] }, material = { type = "diffuse" }, emission = { radiance = 1 } },
            { cylinder = { from = [2, -1, 0], to = [2, 1, 0], radius = 0.1 }, material = { type = "diffuse" }, emission = { radiance = 1 } },
            { box = { min = [-2, -1, 0], max = [-1.5, 1, 1] }, material = { type = "diffuse" }, emission = { radiance = 1 } },
            { mesh = { vertices = [[-1, -1, 0], [1, -1, 0], [0, 1, 0]], triangles = [[0, 1, 2]] }, material = { type = "diffuse" }, emission = { radiance = 1 } },
        ]
    "#,
    ),
    (
        "layer meter",
        r#"
        volume = [{ slab = { bottom = -1, top = 1 }, mu_t = [1, 2, 3], albedo = 0.5 }]
        meter = [{ type = "layer", name = "cloud", bottom = -1, top = 1, direction = [0.1, -1, 0], periodic = [0, 0, 2, 2], columns = [2, 2], ground_albedo = 0.3, radiance = [[30, 0], [150, 10]], channel = "red" }]
    "#,
    ),
    (
        "body meter",
        r#"
        volume = [{ sphere = { center = [0, 0, 0], radius = 1 }, mu_t = [1, 2, 3], albedo = 0.5 }]
        meter = [{ type = "body", name = "ball", direction = [0, -1, 0], bins = 4, channel = "blue" }]
    "#,
    ),
    (
        "light meters",
        r#"
        volume = [{ sphere = { center = [0, 0, 0], radius = 1 }, mu_t = 1, albedo = 0.5 }]
        meter = [{ type = "irradiance", name = "ground", position = [0, -2, 0], normal = [0, 1, 0] }, { type = "radiance", name = "up", position = [0, -2, 0], direction = [0, 1, 0] }]
    "#,
    ),
];
