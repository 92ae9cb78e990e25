//! Normalised Blinn-Phong, `f(u) = (s+1)/(2 pi) max(u, 0)^s`.
//!
//! Its multipliers are closed (see [`cosine_power_zonal`](crate::sphere::harmonics::cosine_power_zonal)); the Lambertian
//! is s = 1. Blurred by a lobe it is again close to a Blinn-Phong lobe, of an exponent that a
//! [`ConvolutionRule`](super::ConvolutionRule) finds.

use std::f64::consts::PI;

use super::kind::{ModelKind, ModelParameter};
use super::{Brdf, Material};

/// `blinn-phong:S`.
pub static KIND: ModelKind = ModelKind {
    name: "blinn-phong",
    label: "Blinn-Phong",
    tooltip: "Blinn-Phong, normalised: (s + 1) / (2 pi) max(n.h, 0)^s.",
    parameter: Some(ModelParameter {
        symbol: "S",
        label: "Shininess s",
        range: [1.0, 4000.0],
        most: 1e5,
        default: Material::DEFAULT.shininess,
        decimals: 1,
        tooltip: "Blinn-Phong exponent: (s + 1) / (2 pi) max(n.h, 0)^s.",
        field: |material| &mut material.shininess,
        model: |shininess| Brdf::BlinnPhong(BlinnPhong { shininess }),
    }),
};

/// Blinn-Phong as a function of the cosine between normal and half vector.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BlinnPhong {
    /// The exponent s, at least 0.
    pub shininess: f64,
}

impl BlinnPhong {
    /// `f(u)`, which integrates to 1 over the sphere.
    pub fn zonal(self, cosine: f64) -> f64 {
        (self.shininess + 1.0) / (2.0 * PI) * cosine.max(0.0).powf(self.shininess)
    }
}

/// That in f32, as pictures take it: the shader's twin.
pub fn blinn_phong(shininess: f32, cosine: f32) -> f32 {
    // pow(0, 0) differs between processors; a cosine of 0 contributes only where the exponent is 0.
    let power = if cosine > 0.0 { (shininess * cosine.ln()).exp() } else { f32::from(shininess == 0.0) };
    (shininess + 1.0) / std::f32::consts::TAU * power
}
