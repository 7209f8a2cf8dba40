//! Scenes that are odd as a whole: places that coincide, what files hold that is no number, light that cannot get out.

use std::path::Path;

use crate::files::npy;

/// What is to become of a scene.
pub enum Expected {
    /// It renders, and nothing is said.
    Rendered,
    /// It renders, with a note that has these words.
    Noted(&'static str),
    /// It is refused, in words among which are these.
    Refused(&'static str),
}

use Expected::{Noted, Refused, Rendered};

/// The tables of scenes that have [`REST`](crate::base_scenes::REST) as well, and what is to become of them.
#[rustfmt::skip]
pub const SPECIAL_SCENES: &[(&str, &str, Expected)] = &[
    ("the camera is inside a lamp", r#"
        camera = { position = [0, 0, 0], target = [0, 0, -1] }
        shape = [{ sphere = { center = [0, 0, 0], radius = 1 }, material = { type = "diffuse" }, emission = { radiance = 1, two_sided = true } }]
    "#, Rendered),
    ("the camera is on a surface", r#"
        camera = { position = [0, 0.5, 0], target = [0, -1, 0], up = [1, 0, 0] }
        shape = [{ sphere = { center = [0, 0, 0], radius = 0.5 }, material = { type = "diffuse" } }]
    "#, Rendered),
    ("the camera is at a corner", r#"
        camera = { position = [1, 1, 1], target = [0, 0, 0] }
        shape = [{ box = { min = [-1, -1, -1], max = [1, 1, 1] }, material = { type = "dielectric" } }]
        volume = [{ box = { min = [-1, -1, -1], max = [1, 1, 1] }, mu_t = 1, albedo = 0.5 }]
    "#, Rendered),
    ("the camera is a point light", r#"
        camera = { position = [0, 0, 4], target = [0, 0, 0] }
        light = [{ type = "point", position = [0, 0, 4], intensity = 1 }]
        medium = { mu_t = 1, albedo = 0.5 }
    "#, Rendered),
    ("a light is on a surface", r#"
        light = [{ type = "point", position = [0, 0.5, 0], intensity = 1 }]
        shape = [{ sphere = { center = [0, 0, 0], radius = 0.5 }, material = { type = "diffuse" } }]
    "#, Rendered),
    ("two lamps are one", r#"
        shape = [
            { sphere = { center = [0, 0, 0], radius = 1 }, material = { type = "diffuse" }, emission = { radiance = 1 } },
            { sphere = { center = [0, 0, 0], radius = 1 }, material = { type = "diffuse" }, emission = { radiance = 1 } },
        ]
    "#, Rendered),
    ("two volumes are one", r#"
        volume = [
            { sphere = { center = [0, 0, 0], radius = 1 }, mu_t = 1, albedo = 0.5 },
            { sphere = { center = [0, 0, 0], radius = 1 }, mu_t = 1, albedo = 0.5 },
        ]
    "#, Rendered),
    ("shapes and grids are mirrored", r#"
        shape = [{ sphere = { center = [0, 0, 0], radius = 1 }, material = { type = "dielectric" }, transform = { scale = [-1, 1, 1] } }]
        volume = [{ file = "density.npy", mu_t = 1, albedo = 0.5, transform = { scale = -1 } }]
    "#, Rendered),
    ("light cannot get out and is not absorbed", r#"
        camera = { position = [0, 0, 0.5], target = [0, 0, 0] }
        light = []
        medium = { mu_t = 1, albedo = 1 }
        shape = [
            { box = { min = [-1, -1, -1], max = [1, 1, 1] }, material = { type = "diffuse", reflectance = 1 } },
            { sphere = { center = [0, 0.5, 0], radius = 0.1 }, material = { type = "diffuse" }, emission = { radiance = 1 } },
        ]
    "#, Rendered),
    ("the camera is among mirrors", r#"
        camera = { position = [0, 0, 0.5], target = [0, 0, 0] }
        shape = [{ box = { min = [-1, -1, -1], max = [1, 1, 1] }, material = { type = "conductor", reflectance = 1 } }]
    "#, Rendered),
    ("a lamp is as small as can be", r#"
        shape = [{ sphere = { center = [0, 0, 0], radius = 1e-12 }, material = { type = "diffuse" }, emission = { radiance = 1 } }]
        medium = { mu_t = 1, albedo = 0.5 }
    "#, Rendered),
    ("a grid is denser than can be", r#"
        volume = [{ file = "dense.npy", mu_t = 1, albedo = 0.5 }]
    "#, Refused("too dense")),
    ("a grid is far denser than single floats can follow", r#"
        volume = [{ file = "density.npy", mu_t = 1e4, albedo = 0.5 }]
    "#, Noted("double precision")),
    ("a grid is NaN and infinite", r#"
        volume = [{ file = "nan.npy", mu_t = 1, albedo = 0.5 }]
    "#, Noted("12 values of `density` are not finite and count as 0")),
    ("a grid is negative", r#"
        volume = [{ file = "negative.npy", mu_t = 1, albedo = 0.5 }]
    "#, Noted("negative values of `density` count as 0")),
    ("a grid is empty", r#"
        volume = [{ file = "empty.npy", mu_t = 1, albedo = 0.5 }]
    "#, Noted("nowhere above 0")),
    ("a grid has no voxels", r#"
        volume = [{ file = "none.npy", mu_t = 1, albedo = 0.5 }]
    "#, Refused("none.npy")),
    ("temperatures are NaN", r#"
        volume = [{ file = "density.npy", mu_t = 1, albedo = 0.5, temperature = { file = "nan.npy", grid = "density" } }]
    "#, Noted("not finite")),
    ("surroundings are brighter than pictures can be", r#"
        light = [{ type = "image", file = "bright.hdr" }]
    "#, Noted("beyond 4e9")),
    ("a mesh file has a vertex that is no number", r#"
        shape = [{ mesh = { file = "nan.ply" }, material = { type = "diffuse" } }]
    "#, Refused("nan.ply")),
    ("a mesh file has a vertex that is infinite", r#"
        shape = [{ mesh = { file = "infinite.obj" }, material = { type = "diffuse" } }]
    "#, Refused("infinite.obj")),
    ("a table of a phase function is no number", r#"
        medium = { mu_t = 1, albedo = 0.5, phase = { type = "tabulated", file = "nan.csv" } }
    "#, Refused("nan.csv")),
    ("a table of a phase function is negative", r#"
        medium = { mu_t = 1, albedo = 0.5, phase = { type = "tabulated", file = "negative.csv" } }
    "#, Refused("negative.csv")),
    ("a table of a refractive index is no number", r#"
        medium = { particles = { material_file = "nan_index.csv", distribution = { type = "single", r = "1 um" }, volume_fraction = 1e-7 } }
    "#, Refused("nan_index.csv")),
    ("wavelengths go down", r#"
        medium = { mu_t = { wavelengths = [600, 500], values = [1, 2] }, albedo = 0.5 }
    "#, Refused("mu_t")),
];

/// Writes the files that they name.
pub fn write_special_files(folder: &Path) {
    let write =
        |name: &str, bytes: &[u8]| std::fs::write(folder.join(name), bytes).expect("a folder for files");
    let shape = [3, 4, 2];
    write("dense.npy", &npy(shape, 1, |_| 1e30));
    write("nan.npy", &npy(shape, 1, |i| [1.0, f32::NAN, f32::INFINITY, 0.5][i % 4]));
    write("negative.npy", &npy(shape, 1, |i| i as f32 - 5.0));
    write("empty.npy", &npy(shape, 1, |_| 0.0));
    write("none.npy", &npy([0, 4, 2], 1, |_| 0.0));
    write("bright.hdr", b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 1 +X 2\n\x80\x80\x80\xff\x80\x80\x80\x80");
    let ply = "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\nelement face 1\n\
               property list uchar int vertex_indices\nend_header\n0 0 0\n1 nan 0\n0 1 0\n3 0 1 2\n";
    write("nan.ply", ply.as_bytes());
    write("infinite.obj", b"v 0 0 0\nv 1 inf 0\nv 0 1 0\nf 1 2 3\n");
    write("nan.csv", b"angle_deg,value\n0,1\n90,nan\n180,1\n");
    write("negative.csv", b"angle_deg,value\n0,1\n90,-1\n180,1\n");
    write("nan_index.csv", b"wavelength_nm,n,k\n300,1.5,0\n900,nan,0\n");
}
