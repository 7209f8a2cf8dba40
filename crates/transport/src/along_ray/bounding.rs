//! Majorant, minorant and control: what null-collision methods know of the extinction over a piece of a ray.
//!
//! Over each piece min ≤ μt ≤ max. The majorant is max times a factor; above 1 it is looser than it need be, below 1
//! it does not bound, which only weighted methods stand. The control is what residual and decomposition methods take
//! care of analytically (Novák, Selle & Jarosz 2014; Kutz, Habel, Li & Novák 2017).

/// A stretch of a ray with the bounds of what is in it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Cell {
    pub start: f64,
    pub end: f64,
    pub min: f64,
    pub max: f64,
}

/// A stretch of a ray with what a null-collision method may use there.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Piece {
    /// Distance where it starts.
    pub start: f64,
    /// Distance where it ends.
    pub end: f64,
    /// Extinction that is exceeded everywhere, 1/length.
    pub minorant: f64,
    /// Extinction of the medium with all null matter, 1/length.
    pub majorant: f64,
    /// Control extinction μc, 1/length.
    pub control: f64,
    /// Majorant of |μt − μc|, 1/length.
    pub residual_majorant: f64,
}

/// Over what a bound is taken.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Extent {
    /// Over each cell of the grid, or piece of a profile.
    #[default]
    Cells,
    /// Over all of the ray.
    WholeRay,
}

/// What the control extinction is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Control {
    /// The minorant, so that the residual is nowhere negative.
    #[default]
    Minorant,
    /// Half-way between the bounds: of all constants the one with the least residual majorant.
    Middle,
}

/// How the bounds of a ray are made from those of its cells.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Bounding {
    /// Over what they are taken.
    pub extent: Extent,
    /// Factor on the majorants.
    pub majorant_scale: f64,
    /// What the control is.
    pub control: Control,
    /// Factor on the control.
    pub control_scale: f64,
}

impl Default for Bounding {
    fn default() -> Self {
        Self {
            extent: Extent::default(),
            majorant_scale: 1.0,
            control: Control::default(),
            control_scale: 1.0,
        }
    }
}

impl Bounding {
    pub(super) fn piece(&self, cell: Cell) -> Piece {
        let majorant = cell.max * self.majorant_scale;
        let control = self.control_scale
            * match self.control {
                Control::Minorant => cell.min,
                Control::Middle => 0.5 * (cell.min + cell.max),
            };
        Piece {
            start: cell.start,
            end: cell.end,
            minorant: cell.min,
            majorant,
            control,
            residual_majorant: self.majorant_scale * (cell.max - control).max(control - cell.min),
        }
    }
}
