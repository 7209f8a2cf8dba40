//! The facts about a volume file, under the keys of `inspect --json`.

use std::mem::size_of;

use serde::Serialize;
use serde_json::{Value, json};
use tyndall_volumes::{Grid, GridClass, GridValues, Leaf, Tile, Tree, VolumeFile};

/// What is told about a file.
#[derive(Debug, Serialize)]
pub struct Report {
    /// Format that the content of the file has.
    pub format: String,
    /// The grids, in file order.
    pub grids: Vec<GridReport>,
    /// Grids that are not read.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub skipped: Vec<Skipped>,
}

/// A grid that is not read.
#[derive(Debug, Serialize)]
pub struct Skipped {
    /// Its name.
    pub name: String,
    /// The reason.
    pub why: String,
}

/// What is told about a grid. Values are numbers, arrays of three for vectors, or truth values.
#[derive(Debug, Serialize)]
pub struct GridReport {
    /// Name in the file.
    pub name: String,
    /// `FloatGrid`, `DoubleGrid`, `Vec3SGrid`, `Int32Grid`, `Int64Grid`, `BoolGrid` or `MaskGrid`, as OpenVDB says.
    #[serde(rename = "type")]
    pub kind: &'static str,
    /// `fog volume`, `level set`, `staggered` or `unknown`.
    pub class: &'static str,
    /// Active voxels, those of tiles included.
    pub active_voxels: u64,
    /// Active tiles.
    pub active_tiles: u64,
    /// Least finite active value of each component; `null` where there is none.
    pub min: Value,
    /// Greatest finite active value of each component; `null` where there is none.
    pub max: Value,
    /// Sum of the finite active values of each component.
    pub sum: Value,
    /// Components of active voxels that are infinite or not a number.
    pub non_finite: u64,
    /// Value outside of everything.
    pub background: Value,
    /// First and last active voxel along each axis; as in OpenVDB, of a grid without active voxels the greatest
    /// integers and the least.
    pub index_bbox: [[i32; 3]; 2],
    /// Rows of the matrix that takes index coordinates (a column vector with 1 as its last number) to the world:
    /// the last column is the translation.
    pub index_to_world: [[f64; 4]; 4],
    /// Length of an index step along each axis in world units.
    pub voxel_size: [f64; 3],
    /// Whether the file holds 16-bit floats.
    pub saved_as_half: bool,
    /// Compression in the file.
    pub codec: String,
    /// Memory that the values take once read.
    pub memory_bytes: u64,
    /// Mean over parallel rays of the integral of the value through the box, along each axis, in value times world
    /// unit; the optical thickness for a coefficient equal to the value. Scalar fog only.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub mean_line_integral: Option<[f64; 3]>,
    /// Voxel, value, activity.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub probes: Vec<([i32; 3], Value, bool)>,
}

impl Report {
    /// The facts about a file, and the values of some voxels in each grid.
    pub fn new(file: &VolumeFile, probes: &[[i32; 3]]) -> Self {
        Self {
            format: file.format.to_string(),
            grids: file.grids.iter().map(|grid| GridReport::new(grid, probes)).collect(),
            skipped: file
                .skipped
                .iter()
                .map(|(name, why)| Skipped { name: name.clone(), why: why.clone() })
                .collect(),
        }
    }
}

impl GridReport {
    fn new(grid: &Grid, voxels: &[[i32; 3]]) -> Self {
        let statistics = grid.values.statistics();
        let (kind, memory_bytes) = kind_and_memory(&grid.values);
        let matrix = grid.index_to_world.matrix3;
        let voxel_size = [matrix.x_axis.length(), matrix.y_axis.length(), matrix.z_axis.length()];
        let index_bbox = statistics.active_bbox.unwrap_or([[i32::MAX; 3], [i32::MIN; 3]]);
        let value = |components: &[f64]| value(&grid.values, components);
        let probes = grid.values.probe(voxels);
        let scalar = statistics.sum.len() == 1 && grid.class != GridClass::LevelSet;
        Self {
            name: grid.name.clone(),
            kind,
            class: match grid.class {
                GridClass::Unknown => "unknown",
                GridClass::FogVolume => "fog volume",
                GridClass::LevelSet => "level set",
                GridClass::Staggered => "staggered",
            },
            active_voxels: statistics.active_voxels,
            active_tiles: statistics.active_tiles,
            min: numbers(&statistics.min),
            max: numbers(&statistics.max),
            sum: numbers(&statistics.sum),
            non_finite: statistics.non_finite,
            background: value(&grid.values.background()),
            index_bbox,
            index_to_world: rows(grid),
            voxel_size,
            saved_as_half: grid.saved_as_half,
            codec: grid.codec.clone(),
            memory_bytes,
            mean_line_integral: statistics
                .active_bbox
                .filter(|_| scalar)
                .map(|bbox| mean_line_integral(statistics.sum[0], bbox, voxel_size)),
            probes: voxels
                .iter()
                .zip(probes)
                .map(|(&voxel, (components, active))| (voxel, value(&components), active))
                .collect(),
        }
    }
}

/// ∫ along an axis is Σ · step over the voxels of a row; its mean is the sum of all over the number of rows.
fn mean_line_integral(sum: f64, [first, last]: [[i32; 3]; 2], voxel_size: [f64; 3]) -> [f64; 3] {
    let edges = [0, 1, 2].map(|axis| f64::from(last[axis]) - f64::from(first[axis]) + 1.0);
    let voxels: f64 = edges.iter().product();
    [0, 1, 2].map(|axis| sum * voxel_size[axis] * edges[axis] / voxels)
}

fn rows(grid: &Grid) -> [[f64; 4]; 4] {
    let (m, t) = (grid.index_to_world.matrix3, grid.index_to_world.translation);
    let row = |axis: usize| [m.x_axis[axis], m.y_axis[axis], m.z_axis[axis], t[axis]];
    [row(0), row(1), row(2), [0.0, 0.0, 0.0, 1.0]]
}

fn kind_and_memory(values: &GridValues) -> (&'static str, u64) {
    match values {
        GridValues::Float(tree) => ("FloatGrid", memory(tree)),
        GridValues::Double(tree) => ("DoubleGrid", memory(tree)),
        GridValues::Vec3(tree) => ("Vec3SGrid", memory(tree)),
        GridValues::Int32(tree) => ("Int32Grid", memory(tree)),
        GridValues::Int64(tree) => ("Int64Grid", memory(tree)),
        GridValues::Bool(tree) => ("BoolGrid", memory(tree)),
        GridValues::Mask(tree) => ("MaskGrid", memory(tree)),
    }
}

fn memory<T>(tree: &Tree<T>) -> u64 {
    let bytes = tree.leaf_values.len() * size_of::<T>()
        + tree.leaves.len() * size_of::<Leaf>()
        + tree.tiles.len() * size_of::<Tile<T>>();
    bytes as u64
}

/// A value of the grid's own type.
fn value(values: &GridValues, components: &[f64]) -> Value {
    match values {
        GridValues::Bool(_) | GridValues::Mask(_) => json!(components.first().is_some_and(|&x| x != 0.0)),
        GridValues::Int32(_) | GridValues::Int64(_) => json!(components.first().map(|&x| x as i64)),
        _ => numbers(components),
    }
}

/// One number, or an array of them; what is not finite becomes `null`, as JSON has no such numbers.
fn numbers(components: &[f64]) -> Value {
    match components {
        [number] => json!(number),
        several => json!(several),
    }
}
