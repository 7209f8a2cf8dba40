//! Closed meshes for tests: blunt and sharp, convex and not.

use std::f64::consts::{PI, TAU};

use glam::DVec3;
use tyndall_scene::description::{MeshShape, ShapeDescription};

/// Vertices and triangles that run counter-clockwise from outside.
pub struct ClosedMesh {
    pub name: &'static str,
    pub vertices: Vec<DVec3>,
    pub triangles: Vec<[u32; 3]>,
}

impl ClosedMesh {
    pub fn description(&self) -> ShapeDescription {
        ShapeDescription {
            mesh: Some(MeshShape {
                vertices: Some(self.vertices.iter().map(DVec3::to_array).collect()),
                triangles: Some(self.triangles.clone()),
                ..MeshShape::default()
            }),
            ..ShapeDescription::default()
        }
    }

    pub fn corners(&self, triangle: usize) -> [DVec3; 3] {
        self.triangles[triangle].map(|corner| self.vertices[corner as usize])
    }
}

pub fn all() -> Vec<ClosedMesh> {
    vec![
        cube(),
        blade(),
        star(),
        ball("bumpy ball", 24, |a, b| 1.0 + 0.3 * (5.0 * a).sin() * (4.0 * b).sin()),
        torus(),
    ]
}

fn cube() -> ClosedMesh {
    let vertices =
        (0..8_u32).map(|n| DVec3::from_array([0, 1, 2].map(|axis| f64::from(n >> axis & 1)))).collect();
    let mut triangles = Vec::new();
    for [a, b, c, d] in [[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]] {
        triangles.extend([[a, b, c], [a, c, d]]);
    }
    ClosedMesh { name: "cube", vertices, triangles }
}

/// Two of its edges have an angle of 3 degrees.
fn blade() -> ClosedMesh {
    let vertices = vec![
        DVec3::new(-1.0, 0.0, 0.0),
        DVec3::new(1.0, 0.1, 0.0),
        DVec3::new(0.1, 1.0, 0.05),
        DVec3::new(0.0, 1.0, 0.0),
    ];
    ClosedMesh { name: "blade", vertices, triangles: vec![[0, 1, 2], [0, 3, 1], [0, 2, 3], [1, 3, 2]] }
}

/// An octahedron with a spike on every face.
fn star() -> ClosedMesh {
    let mut vertices: Vec<DVec3> =
        DVec3::AXES.into_iter().flat_map(|axis| [axis * 0.4, axis * -0.4]).collect();
    let mut triangles = Vec::new();
    for octant in 0..8_u32 {
        let [x, y, z] = [0, 1, 2].map(|axis| 2 * axis + (octant >> axis & 1));
        let is_odd = (octant.count_ones() % 2) == 1;
        let [a, b, c] = if is_odd { [x, z, y] } else { [x, y, z] };
        let apex = vertices.len() as u32;
        let sum = vertices[a as usize] + vertices[b as usize] + vertices[c as usize];
        vertices.push(sum.normalize() * 1.5);
        triangles.extend([[a, b, apex], [b, c, apex], [c, a, apex]]);
    }
    ClosedMesh { name: "star", vertices, triangles }
}

/// A surface r(longitude, latitude) over `rows` rows of latitude.
pub fn ball(name: &'static str, rows: u32, radius: impl Fn(f64, f64) -> f64) -> ClosedMesh {
    let columns = 2 * rows;
    let place = |column: u32, row: u32| {
        let (a, b) = (TAU * f64::from(column) / f64::from(columns), PI * f64::from(row) / f64::from(rows));
        DVec3::new(b.sin() * a.cos(), b.sin() * a.sin(), b.cos()) * radius(a, b)
    };
    let mut vertices = vec![DVec3::Z * radius(0.0, 0.0), DVec3::NEG_Z * radius(0.0, PI)];
    for row in 1..rows {
        vertices.extend((0..columns).map(|column| place(column, row)));
    }
    let number = |column: u32, row: u32| match row {
        0 => 0,
        _ if row == rows => 1,
        _ => 2 + (row - 1) * columns + column % columns,
    };
    let mut triangles = Vec::new();
    for (row, column) in (0..rows).flat_map(|row| (0..columns).map(move |column| (row, column))) {
        let [a, b] = [number(column, row), number(column + 1, row)];
        let [c, d] = [number(column, row + 1), number(column + 1, row + 1)];
        if row > 0 {
            triangles.push([a, c, b]);
        }
        if row + 1 < rows {
            triangles.push([b, c, d]);
        }
    }
    ClosedMesh { name, vertices, triangles }
}

fn torus() -> ClosedMesh {
    let (n, m) = (40, 20);
    let mut vertices = Vec::new();
    let mut triangles = Vec::new();
    for (i, j) in (0..n).flat_map(|i| (0..m).map(move |j| (i, j))) {
        let (a, b) = (TAU * f64::from(i) / f64::from(n), TAU * f64::from(j) / f64::from(m));
        let ring = 1.0 + 0.4 * b.cos();
        vertices.push(DVec3::new(ring * a.cos(), ring * a.sin(), 0.4 * b.sin()));
        let number = |i: u32, j: u32| (i % n) * m + j % m;
        let [p, q, r, s] = [number(i, j), number(i + 1, j), number(i + 1, j + 1), number(i, j + 1)];
        triangles.extend([[p, q, r], [p, r, s]]);
    }
    ClosedMesh { name: "torus", vertices, triangles }
}
