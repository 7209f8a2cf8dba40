//! SGGX: particles that mirror light, oriented about an axis, such as flakes and fibres.
//!
//! Source: Heitz, Dupuy, Crassin & Dachsbacher 2015, "The SGGX microflake distribution". The particles' normals are
//! those of an ellipsoid with the matrix S; here it is symmetric about an axis a:
//!
//!   surface-like: S = r² (I − a aᵀ) + a aᵀ        fibre-like: S = (I − a aᵀ) + r² a aᵀ
//!   projected area σ(ω) = √(ωᵀ S ω)               normals D(h) = 1/(π √|S| (hᵀ S⁻¹ h)²)
//!   phase function f(ω → ω′) = D(h)/(4 σ(ω)),     h = normalize(ω′ − ω)
//!
//! with directions of travel ω, ω′. The extinction along ω is μt σ(ω). σ(ω) f(ω → ω′) is symmetric, so a path may be
//! traced from either end. Visible normals are sampled as S^½ maps those of a sphere, which are distributed by the
//! cosine to the viewer, onto the ellipsoid's.

use glam::DVec3;
use std::f64::consts::{PI, TAU};

/// What the particles look like.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum SggxKind {
    /// Flakes, whose normals gather about the axis.
    Surface,
    /// Fibres along the axis, whose normals are across it.
    Fibre,
}

/// An SGGX phase function with rotational symmetry.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sggx {
    axis: DVec3,
    /// √ of the eigenvalue of S along the axis: the projected area seen along it.
    along: f64,
    /// The same across the axis.
    across: f64,
}

impl Sggx {
    /// Particles about `axis`, which need not have unit length but some, with `roughness` in (0, 1]: 1 is isotropic.
    pub fn new(kind: SggxKind, axis: DVec3, roughness: f64) -> Sggx {
        let (along, across) = match kind {
            SggxKind::Surface => (1.0, roughness),
            SggxKind::Fibre => (roughness, 1.0),
        };
        Sggx { axis: axis.normalize_or(DVec3::Y), along, across }
    }

    /// The unit vector about which the distribution is symmetric.
    pub fn axis(&self) -> DVec3 {
        self.axis
    }

    /// S^½ v.
    fn stretch(&self, v: DVec3) -> DVec3 {
        v * self.across + self.axis * ((self.along - self.across) * self.axis.dot(v))
    }

    pub(super) fn projected_area(&self, direction: DVec3) -> f64 {
        self.stretch(direction).length()
    }

    /// D at a normal whose squared cosine to the axis is `cos2`.
    fn normals(&self, cos2: f64) -> f64 {
        let (along2, across2) = (self.along * self.along, self.across * self.across);
        let quadratic = cos2 / along2 + (1.0 - cos2) / across2;
        1.0 / (PI * self.along * across2 * quadratic * quadratic)
    }

    pub(super) fn value(&self, before: DVec3, after: DVec3) -> f64 {
        // Exactly forward, the normal is any direction across: the limit depends on it, and has no weight.
        let h = (after - before).try_normalize().unwrap_or_else(|| before.any_orthonormal_vector());
        let cos2 = self.axis.dot(h).powi(2).min(1.0);
        self.normals(cos2) / (4.0 * self.projected_area(before))
    }

    pub(super) fn value_along_axis(&self, cos_theta: f64) -> f64 {
        self.normals(0.5 * (1.0 - cos_theta)) / (4.0 * self.along)
    }

    pub(super) fn sample(&self, before: DVec3, u: [f64; 2]) -> DVec3 {
        let toward = self.stretch(-before).normalize();
        let (cos, sin) = (u[0].sqrt(), (1.0 - u[0]).sqrt());
        let (sin_phi, cos_phi) = libm::sincos(TAU * u[1]);
        let (tangent, bitangent) = toward.any_orthonormal_pair();
        let of_sphere = tangent * (sin * cos_phi) + bitangent * (sin * sin_phi) + toward * cos;
        let h = self.stretch(of_sphere).normalize();
        (before - h * (2.0 * before.dot(h))).normalize()
    }

    pub(super) fn sample_along_axis(&self, u: f64) -> f64 {
        let (along2, across2) = (self.along * self.along, self.across * self.across);
        let cos2 = along2 * (1.0 - u) / (along2 * (1.0 - u) + across2 * u);
        1.0 - 2.0 * cos2
    }

    /// 1 − 2E, where E = (1 − ln(1 + x)/x)(1 + x)/x with 1 + x = along²/across² is the mean squared cosine of the
    /// visible normals.
    pub(super) fn mean_cosine_along_axis(&self) -> f64 {
        let x = (self.along - self.across) * (self.along + self.across) / (self.across * self.across);
        // The series about 0: E = (1 + x)(1/2 − x/3 + x²/4 − …).
        let mean = if x.abs() < 1e-2 {
            (0..10).map(|n| (-x).powi(n) / f64::from(n + 2)).sum::<f64>()
        } else {
            (1.0 - libm::log1p(x) / x) / x
        };
        1.0 - 2.0 * (1.0 + x) * mean
    }

    /// 1 − 2 E (ω·h)², by a product rule over the visible normals of the sphere: the midpoint rule in azimuth, Simpson's
    /// in the cosine.
    pub(super) fn mean_cosine(&self, before: DVec3) -> f64 {
        const INTERVALS: usize = 128;
        const AZIMUTHS: usize = 64;
        let toward = self.stretch(-before).normalize();
        let (tangent, bitangent) = toward.any_orthonormal_pair();
        let ring = |cos: f64| {
            let sin = (1.0 - cos * cos).max(0.0).sqrt();
            let squared = (0..AZIMUTHS).map(|i| {
                let (sin_phi, cos_phi) = libm::sincos(TAU * (i as f64 + 0.5) / AZIMUTHS as f64);
                let n = tangent * (sin * cos_phi) + bitangent * (sin * sin_phi) + toward * cos;
                self.stretch(n).normalize().dot(before).powi(2)
            });
            2.0 * cos * squared.sum::<f64>() / AZIMUTHS as f64
        };
        let simpson = (0..=INTERVALS).map(|i| {
            let weight = if i == 0 || i == INTERVALS { 1.0 } else { 2.0 + 2.0 * (i % 2) as f64 };
            weight * ring(i as f64 / INTERVALS as f64)
        });
        1.0 - 2.0 * simpson.sum::<f64>() / (3.0 * INTERVALS as f64)
    }
}
