//! Grids of `gridvolume`, as the files that Tyndall reads.
//!
//! Mitsuba lays a grid of n cells over the unit cube, cell centres at (i + ½)/n, and the cube wherever `to_world` says;
//! with `use_grid_bbox` over the box that the file names instead. Between centres values are interpolated, and from the
//! outermost centres to the faces of the box, half a cell, the outermost values go on (`clamp`). In Tyndall they would fall
//! towards 0 there; so a grid whose outermost values are not 0 gets a layer of the same around it.

use std::io::Read;
use std::path::{Path, PathBuf};

use glam::{DAffine3, DVec3};
use tyndall_machine::files;
use tyndall_volumes::{Grid, GridValues, LEAF_VOXELS, Lookup, ReadRequest, Tree, read, read_bytes};

use super::boundaries::Extent;
use crate::{ImportError, Sidecar};

/// A `.vol` file.
#[derive(Debug, Clone)]
pub(super) struct GridFile {
    path: PathBuf,
    grid: Grid,
    /// Cells along x, y and z.
    cells: [i32; 3],
    /// Corners of the box that the file names.
    corners: [DVec3; 2],
    /// Whether the file itself can be rendered.
    is_sound: bool,
}

/// A grid and where it stands.
#[derive(Debug, Clone)]
pub(super) struct Placed {
    pub file: GridFile,
    /// From where the file says to the world.
    pub transform: DAffine3,
    /// Whether values between cells are interpolated, so that those at the border have to go on.
    pub filter_reaches_out: bool,
}

/// A file with a density, and its transform.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct DensityFile {
    pub file: String,
    pub transform: DAffine3,
}

impl GridFile {
    /// Reads a file; `uses_box` says whether its box counts.
    pub fn read(path: &Path, uses_box: bool) -> Result<Self, ImportError> {
        let unreadable = |error| ImportError::unreadable(path, &error);
        let mut header = [0; HEADER];
        let mut file = files::open(path).map_err(unreadable)?;
        let length = file.read(&mut header).map_err(unreadable)?;
        if length < HEADER || !header.starts_with(MAGIC) {
            return Err(ImportError::of(path, "is no grid volume of Mitsuba, version 3"));
        }
        let number = |at: usize| [header[at], header[at + 1], header[at + 2], header[at + 3]];
        let cells = [8, 12, 16].map(|at| i32::from_le_bytes(number(at)));
        let corner = |at: usize| {
            DVec3::from_array([at, at + 4, at + 8].map(|at| f32::from_le_bytes(number(at)).into()))
        };
        let mut corners: [DVec3; 2] = [corner(24), corner(36)];
        let size = corners[1] - corners[0];
        let is_sound = size.is_finite() && size.min_element() > 0.0;
        let request = ReadRequest::default();
        let grids = if is_sound || uses_box {
            read(path, &request)
        } else {
            // The box is without meaning, but Tyndall's own reader asks for one.
            corners = [DVec3::ZERO, DVec3::ONE];
            let mut bytes = files::read(path).map_err(unreadable)?;
            for (at, value) in [0.0_f32, 0.0, 0.0, 1.0, 1.0, 1.0].into_iter().enumerate() {
                bytes[24 + 4 * at..28 + 4 * at].copy_from_slice(&value.to_le_bytes());
            }
            read_bytes(&bytes, path, &request)
        };
        let grids = grids.map_err(|error| {
            let message = error.to_string();
            let prefix = format!("{}: ", path.display());
            ImportError::of(path, message.strip_prefix(&prefix).unwrap_or(&message))
        })?;
        let Some(grid) = grids.grids.into_iter().next() else {
            return Err(ImportError::of(path, "has no grid"));
        };
        Ok(Self { path: path.to_path_buf(), grid, cells, corners, is_sound })
    }

    /// The map of the file's box to the unit cube.
    pub fn box_to_unit_cube(&self) -> DAffine3 {
        let [least, greatest] = self.corners;
        DAffine3::from_scale((greatest - least).recip()) * DAffine3::from_translation(-least)
    }

    /// The first and the last cell, along each axis, that is not 0; what is not counted may be.
    fn filled_cells(&self) -> [[i32; 3]; 2] {
        match &self.grid.values {
            GridValues::Float(tree) => filled(tree, |value| *value != 0.0),
            GridValues::Vec3(tree) => filled(tree, |value| *value != [0.0; 3]),
            _ => [[0; 3], self.cells.map(|count| count - 1)],
        }
    }

    /// Whether the outermost cells are 0, so that nothing needs to go on.
    fn ends_in_zero(&self) -> bool {
        let [first, last] = self.filled_cells();
        (0..3).all(|axis| first[axis] > last[axis] || first[axis] > 0 && last[axis] < self.cells[axis] - 1)
    }

    /// The grid with a layer of the outermost values around it.
    fn with_border(&self) -> Result<Grid, ImportError> {
        let channels = if matches!(self.grid.values, GridValues::Vec3(_)) { 3 } else { 1 };
        let cells = self.cells.map(|count| count + 2);
        let edge = (self.corners[1] - self.corners[0]) / DVec3::from_array(self.cells.map(f64::from));
        let mut bytes = MAGIC.to_vec();
        bytes.extend(1i32.to_le_bytes());
        bytes.extend(cells.into_iter().chain([channels]).flat_map(i32::to_le_bytes));
        for corner in [self.corners[0] - edge, self.corners[1] + edge] {
            bytes.extend(corner.to_array().into_iter().flat_map(|x| (x as f32).to_le_bytes()));
        }
        let inner = |at: i32, axis: usize| (at - 1).clamp(0, self.cells[axis] - 1);
        let mut write = |values: &mut dyn FnMut([i32; 3], &mut Vec<u8>)| {
            for z in 0..cells[2] {
                for y in 0..cells[1] {
                    for x in 0..cells[0] {
                        values([inner(x, 0), inner(y, 1), inner(z, 2)], &mut bytes);
                    }
                }
            }
        };
        match &self.grid.values {
            GridValues::Float(tree) => {
                let lookup = Lookup::new(tree);
                write(&mut |voxel, bytes| bytes.extend(lookup.probe(voxel).0.to_le_bytes()));
            }
            GridValues::Vec3(tree) => {
                let lookup = Lookup::new(tree);
                write(&mut |voxel, bytes| {
                    bytes.extend(lookup.probe(voxel).0.into_iter().flat_map(f32::to_le_bytes));
                });
            }
            _ => {}
        }
        let name = Path::new("border.vol");
        let file = read_bytes(&bytes, name, &ReadRequest::default());
        let file = file.map_err(|error| ImportError::of(&self.path, error.to_string()))?;
        let Some(mut grid) = file.grids.into_iter().next() else {
            return Err(ImportError::of(&self.path, "has no grid"));
        };
        // The box of the header is in 32 bits: the place is that of the file itself.
        let place = self.grid.index_to_world;
        grid.index_to_world = place * DAffine3::from_translation(DVec3::splat(-1.0));
        Ok(grid)
    }
}

impl Placed {
    /// Where the density is.
    pub fn extent(&self) -> Extent {
        let [first, last] = self.file.filled_cells().map(|cell| DVec3::from_array(cell.map(f64::from)));
        let cells = DVec3::from_array(self.file.cells.map(f64::from));
        // Interpolation reaches to the centres of the neighbours, of which the border is a layer more.
        let reach = match self.filter_reaches_out {
            false => 0.0,
            true if self.file.ends_in_zero() => 0.5,
            true => 1.5,
        };
        let support = [(first - reach) / cells, (last + 1.0 + reach) / cells];
        let is_empty = first.cmpgt(last).any();
        let support = if is_empty { [DVec3::splat(0.5); 2] } else { support };
        Extent { to_world: self.transform * self.file.box_to_unit_cube().inverse(), support, is_box: false }
    }

    /// Files with the density of each channel: the file itself if it will do.
    pub fn split(&self, sidecar: &Sidecar) -> Result<Vec<DensityFile>, ImportError> {
        let needs_border = self.filter_reaches_out && !self.file.ends_in_zero();
        let is_scalar = matches!(self.file.grid.values, GridValues::Float(_));
        let transform = self.transform;
        if is_scalar && !needs_border && self.file.is_sound {
            let file = self.file.path.to_string_lossy().into_owned();
            return Ok(vec![DensityFile { file, transform }]);
        }
        let grid = if needs_border { self.file.with_border()? } else { self.file.grid.clone() };
        let stem = self.stem();
        if is_scalar {
            let file = write(sidecar, &stem, &grid)?;
            return Ok(vec![DensityFile { file, transform }]);
        }
        let channels = [("red", 0), ("green", 1), ("blue", 2)];
        channels
            .into_iter()
            .filter_map(|(name, axis)| Some((name, grid.component(axis)?)))
            .map(|(name, channel)| {
                let channel = Grid { name: "density".into(), ..channel };
                let file = write(sidecar, &format!("{stem}-{name}"), &channel)?;
                Ok(DensityFile { file, transform })
            })
            .collect()
    }

    /// A file with the grid in its place for a volume whose transform is `own`: the file itself if it will do.
    pub fn file_in(&self, own: &DAffine3, sidecar: &Sidecar) -> Result<String, ImportError> {
        let needs_border = self.filter_reaches_out && !self.file.ends_in_zero();
        if !needs_border && self.transform == *own && self.file.is_sound {
            return Ok(self.file.path.to_string_lossy().into_owned());
        }
        let mut grid = if needs_border { self.file.with_border()? } else { self.file.grid.clone() };
        if self.transform != *own {
            grid.index_to_world = own.inverse() * self.transform * grid.index_to_world;
        }
        write(sidecar, &self.stem(), &grid)
    }

    fn stem(&self) -> String {
        let stem = self.file.path.file_stem().map(|stem| stem.to_string_lossy().into_owned());
        stem.unwrap_or_else(|| "grid".into())
    }
}

fn write(sidecar: &Sidecar, name: &str, grid: &Grid) -> Result<String, ImportError> {
    sidecar.write_grid(name, grid).map(|path| path.to_string_lossy().into_owned())
}

/// The least and the greatest coordinates of active voxels that count; the first above the last if none does.
fn filled<T: Copy>(tree: &Tree<T>, counts: impl Fn(&T) -> bool) -> [[i32; 3]; 2] {
    let mut bounds = [[i32::MAX; 3], [i32::MIN; 3]];
    let mut add = |voxel: [i32; 3]| {
        for axis in 0..3 {
            bounds[0][axis] = bounds[0][axis].min(voxel[axis]);
            bounds[1][axis] = bounds[1][axis].max(voxel[axis]);
        }
    };
    for (leaf, values) in tree.leaves.iter().zip(tree.leaf_values.chunks(LEAF_VOXELS)) {
        for (at, value) in values.iter().enumerate() {
            let (x, y, z) = (at >> 6, at >> 3 & 7, at & 7);
            let is_active = leaf.active[x] >> (y << 3 | z) & 1 == 1;
            if is_active && counts(value) {
                add([leaf.origin[0] + x as i32, leaf.origin[1] + y as i32, leaf.origin[2] + z as i32]);
            }
        }
    }
    for tile in tree.tiles.iter().filter(|tile| tile.active && counts(&tile.value)) {
        add(tile.origin);
        add(tile.origin.map(|coordinate| coordinate + (1 << tile.log2_edge) - 1));
    }
    bounds
}

const MAGIC: &[u8] = b"VOL\x03";
const HEADER: usize = 48;
