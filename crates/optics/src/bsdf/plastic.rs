//! A diffuse base under a dielectric coat, on both sides: plastic, paint, varnished wood.
//!
//! The coat, smooth or of microfacets, reflects R(θ) as a [`dielectric`](super::dielectric) does and lets T(θ) = 1 − R(θ)
//! through. The base scatters that evenly, and of what comes back the coat throws the fraction r back onto it, again and
//! again:
//!
//!   f = f_coat + T(θ) T(θ′)/(π η²) · ρ/(1 − ρ r),   r = 1 − T̄/η²,   T̄ = ∫₀¹ 2μ T(μ) dμ
//!
//! (the last by reciprocity). So a white base gives back all light: R + T · T̄/η²/(1 − r) = 1. That is `nonlinear` in ρ and deepens
//! colours; the linear form has ρ/(1 − r), so that the base looks as bright as ρ says whatever the coat. With a smooth
//! coat both are what Mitsuba 3 computes as `plastic`. For rough coats T comes from the microfacets' albedo rather than from their refraction,
//! so that no energy is lost. pbrt's `coateddiffuse` follows random walks between a coat and a base a distance apart; its
//! light blurs and is absorbed there as well, which this model leaves out.

use std::f64::consts::PI;

use glam::{DVec3, DVec4};

use super::ggx::Ggx;
use super::{BsdfSample, diffuse, fresnel};

/// A coat: what is the same all over a surface, computed once.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Coat {
    index: f64,
    facets: Option<Ggx>,
    /// T at [`node`]s of a rough coat.
    transmittance: [f32; NODES],
    /// T̄, of light from all directions.
    diffuse_transmittance: f64,
    /// r, of light from the base.
    internal_reflectance: f64,
}

const NODES: usize = 32;

/// Cosine of a node: denser at grazing angles, where T falls steeply.
fn node(number: usize) -> f64 {
    (number as f64 / (NODES - 1) as f64).powi(2)
}

impl Coat {
    /// A coat of the refractive index `index` over that of the outside, with microfacets of the widths `alpha`.
    pub fn new(index: f64, alpha: [f64; 2]) -> Coat {
        let facets = Ggx::new(alpha);
        // Between the two widths where they differ: the albedo then depends on the azimuth a little.
        let mean = facets.and(Ggx::new([(alpha[0] * alpha[1]).sqrt(); 2]));
        let transmittance = std::array::from_fn(|number| match mean {
            Some(facets) => 1.0 - albedo(index, &facets, node(number)) as f32,
            None => 0.0,
        });
        let mut coat =
            Coat { index, facets, transmittance, diffuse_transmittance: 0.0, internal_reflectance: 0.0 };
        const STEPS: u32 = 2048;
        let middles = (0..STEPS).map(|step| (f64::from(step) + 0.5) / f64::from(STEPS));
        let integral: f64 = middles.map(|cos| 2.0 * cos * coat.transmittance(cos)).sum();
        coat.diffuse_transmittance = integral / f64::from(STEPS);
        coat.internal_reflectance = 1.0 - coat.diffuse_transmittance / (index * index);
        coat
    }

    /// T under the cosine `cos` ≥ 0.
    fn transmittance(&self, cos: f64) -> f64 {
        if self.facets.is_none() {
            return 1.0 - fresnel::dielectric(cos.min(1.0), self.index).0;
        }
        let place = cos.clamp(0.0, 1.0).sqrt() * (NODES - 1) as f64;
        let number = (place as usize).min(NODES - 2);
        let within = place - number as f64;
        let [low, high] = [number, number + 1].map(|number| f64::from(self.transmittance[number]));
        low + (high - low) * within
    }
}

/// Fraction that the facets of a coat reflect, by quadrature over the normals that are seen.
fn albedo(index: f64, facets: &Ggx, cos: f64) -> f64 {
    const STEPS: u32 = 40;
    let cos = cos.max(1e-4);
    let wo = DVec3::new((1.0 - cos * cos).sqrt(), 0.0, cos);
    let mut sum = 0.0;
    for step in 0..STEPS * STEPS {
        let u = [step / STEPS, step % STEPS].map(|k| (f64::from(k) + 0.5) / f64::from(STEPS));
        let mirrored = facets.sample_mirror(wo, u).and_then(|wi| facets.mirror(wo, wi));
        if let Some(mirrored) = mirrored {
            sum += fresnel::dielectric(mirrored.cos, index).0 * mirrored.value / mirrored.pdf;
        }
    }
    sum / f64::from(STEPS * STEPS)
}

/// A coated surface at a point.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Plastic {
    coat: Coat,
    /// ρ/(1 − ρ r)/η².
    base: DVec4,
    reflection_tint: DVec4,
}

impl Plastic {
    /// A base of reflectance ρ under `coat`, whose reflection is multiplied by `reflection_tint`; both are 0 in lanes that are no
    /// channel.
    pub fn new(coat: Coat, reflectance: DVec4, reflection_tint: DVec4, nonlinear: bool) -> Plastic {
        let each_time = if nonlinear { reflectance } else { DVec4::ONE };
        let to_and_fro = DVec4::ONE - each_time * coat.internal_reflectance;
        let base = reflectance / to_and_fro / (coat.index * coat.index);
        // No coat lets nothing out; were it so, there would be no base to see.
        let base = if base.is_finite() { base } else { DVec4::ZERO };
        Plastic { coat, base, reflection_tint }
    }

    pub(super) fn sample(&self, wo: DVec3, choice: f64, u: [f64; 2]) -> Option<BsdfSample> {
        if wo.z == 0.0 {
            return None;
        }
        let coat_probability = self.coat_probability(wo)?;
        let by_coat = choice < coat_probability;
        let wi = match &self.coat.facets {
            None if by_coat => {
                let reflected = fresnel::dielectric(wo.z.abs().min(1.0), self.coat.index).0;
                let weight = self.reflection_tint * (reflected / coat_probability);
                return Some(BsdfSample::delta(DVec3::new(-wo.x, -wo.y, wo.z), weight));
            }
            Some(facets) if by_coat => facets.sample_mirror(wo, u)?,
            _ => diffuse::sample_cosine(wo, u),
        };
        let pdf = self.pdf(wo, wi);
        BsdfSample::if_sound(wi, self.value(wo, wi) / pdf, pdf, 1.0)
    }

    pub(super) fn value(&self, wo: DVec3, wi: DVec3) -> DVec4 {
        if wo.z * wi.z <= 0.0 {
            return DVec4::ZERO;
        }
        let through = self.coat.transmittance(wo.z.abs()) * self.coat.transmittance(wi.z.abs());
        let base = self.base * (through * wi.z.abs() / PI);
        match self.coat.facets.as_ref().and_then(|facets| facets.mirror(wo, wi)) {
            Some(mirrored) => {
                let reflected = fresnel::dielectric(mirrored.cos, self.coat.index).0;
                base + self.reflection_tint * (reflected * mirrored.value)
            }
            None => base,
        }
    }

    pub(super) fn pdf(&self, wo: DVec3, wi: DVec3) -> f64 {
        let Some(coat_probability) = self.coat_probability(wo) else { return 0.0 };
        let base = (1.0 - coat_probability) * diffuse::pdf(wo, wi);
        match self.coat.facets.as_ref().and_then(|facets| facets.mirror(wo, wi)) {
            Some(mirrored) => base + coat_probability * mirrored.pdf,
            None => base,
        }
    }

    pub(super) fn albedo(&self) -> DVec4 {
        let through = self.coat.transmittance(1.0);
        self.reflection_tint * (1.0 - through) + self.base * (through * self.coat.diffuse_transmittance)
    }

    /// Probability that a path goes on by the coat: its share of the light. `None` if there is no light.
    fn coat_probability(&self, wo: DVec3) -> Option<f64> {
        let through = self.coat.transmittance(wo.z.abs());
        let coat = self.reflection_tint.element_sum() * (1.0 - through);
        let base = self.base.element_sum() * through * self.coat.diffuse_transmittance;
        (coat + base > 0.0).then(|| coat / (coat + base))
    }
}
