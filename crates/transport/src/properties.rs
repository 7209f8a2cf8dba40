//! What every estimator declares of itself, and why one may not fit a ray or a scene.

use std::fmt;

/// What an estimator is and needs.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Properties {
    /// Name on the command line and in reports.
    pub name: &'static str,
    /// Whether its mean is the true value.
    pub unbiased: bool,
    /// How it uses a majorant.
    pub majorant: MajorantUse,
    /// What must be known beside the extinction at single places.
    pub needs: &'static [Need],
    /// Where it is from.
    pub source: &'static str,
}

/// Whether an estimator relies on an upper bound of the extinction.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum MajorantUse {
    /// It uses none.
    None,
    /// It is wrong where the extinction exceeds the bound.
    Bounding,
    /// It stays right where the extinction exceeds the bound, with weights that may be negative.
    NonBounding,
}

/// Something an estimator needs to know.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Need {
    /// Formulas for the optical thickness (and, to sample distances, its inverse), or voxels that are constant.
    ClosedForm,
    /// The optical thickness to rounding, by formula or voxel by voxel.
    ExactThickness,
    /// A lower bound, or another control extinction.
    Control,
    /// A point light.
    PointLight,
}

impl fmt::Display for MajorantUse {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str(match self {
            Self::None => "none",
            Self::Bounding => "bounding",
            Self::NonBounding => "need not bound",
        })
    }
}

impl fmt::Display for Need {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str(match self {
            Self::ClosedForm => "closed form",
            Self::ExactThickness => "exact optical thickness",
            Self::Control => "control extinction",
            Self::PointLight => "point light",
        })
    }
}

/// Why an estimator cannot be used, and what can; one line.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Reason(pub(crate) String);

impl fmt::Display for Reason {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str(&self.0)
    }
}

impl std::error::Error for Reason {}

/// Whether what the estimator needs is there on this ray.
pub(crate) fn check(properties: &Properties, ray: &crate::AlongRay) -> Result<(), Reason> {
    let name = properties.name;
    if properties.majorant == MajorantUse::Bounding && ray.bounding().majorant_scale < 1.0 {
        return Err(Reason(format!(
            "{name} needs a majorant that bounds the extinction: scale it by 1 or more"
        )));
    }
    for need in properties.needs {
        let missing = match need {
            Need::ClosedForm if !ray.has_closed_form() => {
                "a closed form of the optical thickness, which interpolated voxels have not: take regular-tracking"
            }
            Need::PointLight if ray.light().is_none() => "a point light beside the ray",
            _ => continue,
        };
        return Err(Reason(format!("{name} needs {missing}")));
    }
    Ok(())
}
