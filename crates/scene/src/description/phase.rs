//! How a medium spreads scattered light over directions: the phase functions of `tyndall-optics` by name.

use glam::DVec3;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::spheres::{DistributionDescription, IndexDescription, MaterialName, substance};

/// How scattered light is spread over directions. Asymmetries above 0 are forward.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(tag = "type", rename_all = "snake_case")]
pub enum PhaseDescription {
    /// Equally in all directions.
    #[default]
    Isotropic,
    /// Henyey and Greenstein 1941.
    Hg {
        /// Mean cosine of the scattering angle; above 0 is forward.
        #[schemars(extend("exclusiveMinimum" = -1, "exclusiveMaximum" = 1))]
        g: f64,
    },
    /// Two Henyey-Greenstein lobes.
    DoubleHg {
        /// Mean cosine of the first lobe.
        #[schemars(extend("exclusiveMinimum" = -1, "exclusiveMaximum" = 1))]
        g1: f64,
        /// Mean cosine of the second lobe.
        #[schemars(extend("exclusiveMinimum" = -1, "exclusiveMaximum" = 1))]
        g2: f64,
        /// Weight of the first lobe.
        #[schemars(range(min = 0, max = 1))]
        weight: f64,
    },
    /// Schlick's approximation of Henyey and Greenstein's (Blasi, Le Saëc & Schlick 1993).
    Schlick {
        /// Parameter; about 1.55 g - 0.55 g³ for a mean cosine g.
        #[schemars(extend("exclusiveMinimum" = -1, "exclusiveMaximum" = 1))]
        k: f64,
    },
    /// Molecules, and particles far smaller than the wavelength.
    Rayleigh,
    /// Cornette and Shanks 1992: between Rayleigh's and Henyey and Greenstein's.
    CornetteShanks {
        /// Parameter; the mean cosine is 3 g (4 + g²)/(5 (2 + g²)).
        #[schemars(extend("exclusiveMinimum" = -1, "exclusiveMaximum" = 1))]
        g: f64,
    },
    /// Draine 2003: Henyey and Greenstein's times 1 + alpha cos².
    Draine {
        /// Parameter; the mean cosine is another.
        #[schemars(extend("exclusiveMinimum" = -1, "exclusiveMaximum" = 1))]
        g: f64,
        /// Weight of the squared cosine.
        #[schemars(range(min = 0))]
        alpha: f64,
    },
    /// Water droplets of fog and clouds (Jendersie & d'Eon 2023).
    Fog {
        /// Diameter of the droplets, micrometres.
        #[schemars(extend("exclusiveMinimum" = 0, "maximum" = 50))]
        droplet_diameter_um: f64,
    },
    /// Oriented particles that mirror light (Heitz et al. 2015, SGGX). The extinction changes with direction: it is that
    /// of the medium times the area that a particle turns to the light, which is 1 at most.
    Sggx {
        /// What the particles look like.
        kind: SggxShape,
        /// Direction in the scene about which flakes' normals gather, or along which fibres lie.
        #[serde(default = "up")]
        axis: [f64; 3],
        /// 0 for particles that are all aligned, 1 for none.
        #[schemars(extend("exclusiveMinimum" = 0, "maximum" = 1))]
        roughness: f64,
    },
    /// A table in a text file: angle in degrees and value on each line, or CSV with a header such as `angle_deg,value` or
    /// `angle_deg,450,550,650` (wavelengths in nm); linear in the cosine between rows, of any normalisation.
    Tabulated {
        /// The file, relative to the scene file.
        file: String,
        /// Wavelength, in nm, whose phase function is taken from a table of several; 550 unless given.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        #[schemars(extend("exclusiveMinimum" = 0))]
        wavelength_nm: Option<f64>,
    },
    /// Spheres, by Lorenz-Mie theory: of `material`, `m` or `material_file`, and of the sizes of a `distribution` or of
    /// one size parameter `x`.
    Mie {
        /// A material that is built in.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        material: Option<MaterialName>,
        /// Refractive index relative to the medium around.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        m: Option<IndexDescription>,
        /// A CSV table of the refractive index, with the heading `wavelength_nm,n,k` or `wavelength_um,n,k`.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        material_file: Option<String>,
        /// Sizes of the spheres.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        distribution: Option<DistributionDescription>,
        /// Size parameter of one sphere: circumference over wavelength.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        #[schemars(range(min = 1e-6, max = 1e5))]
        x: Option<f64>,
        /// Wavelength, in nm, whose phase function is taken; that of each colour unless given.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        #[schemars(extend("exclusiveMinimum" = 0))]
        wavelength_nm: Option<f64>,
    },
}

/// What oriented particles look like.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum SggxShape {
    /// Flakes.
    Surface,
    /// Fibres.
    Fibre,
}

fn up() -> [f64; 3] {
    [0.0, 1.0, 0.0]
}

impl PhaseDescription {
    /// A key whose value the ranges allow and that still makes no sense, and the mend.
    pub fn violation(&self) -> Option<(&'static str, String)> {
        match self {
            Self::Sggx { axis, .. } if DVec3::from_array(*axis).try_normalize().is_none() => {
                Some(("axis", "`axis` is a direction and must not be [0, 0, 0]".into()))
            }
            Self::Mie { material, m, material_file, distribution, x, .. } => {
                mie_violation(*material, m.as_ref(), material_file.as_deref(), distribution.as_ref(), *x)
            }
            _ => None,
        }
    }

    /// The file that it is read from, if it is.
    pub fn file(&self) -> Option<&str> {
        match self {
            Self::Tabulated { file, .. } => Some(file),
            Self::Mie { material_file, .. } => material_file.as_deref(),
            _ => None,
        }
    }

    /// The same, to be changed.
    pub fn file_mut(&mut self) -> Option<&mut String> {
        match self {
            Self::Tabulated { file, .. } => Some(file),
            Self::Mie { material_file, .. } => material_file.as_mut(),
            _ => None,
        }
    }
}

fn mie_violation(
    material: Option<MaterialName>,
    m: Option<&IndexDescription>,
    material_file: Option<&str>,
    distribution: Option<&DistributionDescription>,
    x: Option<f64>,
) -> Option<(&'static str, String)> {
    if let Err(violation) = substance(material, m, material_file) {
        return Some(violation);
    }
    match (distribution, x) {
        (Some(distribution), None) => {
            distribution.value().err().map(|(_, message)| ("distribution", message))
        }
        (None, Some(_)) => None,
        (None, None) => Some(("", "the spheres have no size: give `distribution` or `x`".into())),
        (Some(_), Some(_)) => Some(("x", "the spheres have both `x` and `distribution`: keep one".into())),
    }
}
