//! GGX, the microfacet distribution of most engines: `D(u) = alpha^2 / (pi (1 - (1 - alpha^2) u^2)^2)` above the horizon
//! (Walter, Marschner, Li and Torrance 2007, eq. 33; Trowbridge and Reitz 1975).
//!
//! `D u` integrates to 1 over the hemisphere, D itself to `1 + alpha^2 atanh(e) / e` with `e^2 = 1 - alpha^2`; f is D over
//! that. Masking and shadowing depend on the normal and are left out, as in every model here (Han et al. 2007, eq. 3).
//!
//! No closed form convolves it with a lobe: it is taken as a sum of Blinn-Phong lobes ([`super::projection`]), whose
//! error is below 1 % of its power for every alpha.

use std::f64::consts::{LN_2, PI, SQRT_2};

use super::kind::{ModelKind, ModelParameter};
use super::{Brdf, Material};

/// `ggx:ALPHA`.
pub static KIND: ModelKind = ModelKind {
    name: "ggx",
    label: "GGX",
    tooltip: "GGX: alpha^2 / (pi (1 - (1 - alpha^2) (n.h)^2)^2) (Walter et al. 2007, eq. 33); a sharp peak with a long \
              tail.",
    parameter: Some(ModelParameter {
        symbol: "ALPHA",
        label: "Roughness alpha",
        range: [0.02, 1.0],
        most: 1.0,
        default: Material::DEFAULT.alpha,
        decimals: 3,
        tooltip: "Width of alpha^2 / (pi (1 - (1 - alpha^2) (n.h)^2)^2). Lobes see it as eight Blinn-Phong lobes, \
                  within 1 %.",
        field: |material| &mut material.alpha,
        model: |alpha| Brdf::Ggx(Ggx { alpha }),
    }),
};

/// GGX by its roughness.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ggx {
    /// The roughness alpha, above 0, at most 1.
    pub alpha: f64,
}

impl Ggx {
    /// `f(u)`, which integrates to 1 over the sphere.
    pub fn zonal(self, cosine: f64) -> f64 {
        if cosine <= 0.0 {
            return 0.0;
        }
        let a2 = self.alpha * self.alpha;
        // As in the shader: 1 - (1 - alpha^2) u^2 itself loses digits near the peak.
        let denominator = a2 + (1.0 - a2) * (1.0 - cosine * cosine);
        self.peak() * (a2 / denominator).powi(2)
    }

    /// The value at the normal.
    pub fn peak(self) -> f64 {
        let a2 = self.alpha * self.alpha;
        let e = (1.0 - a2).max(0.0).sqrt();
        // atanh(e) / e -> 1 as e -> 0.
        let ratio = if e < 1e-6 { 1.0 } else { e.atanh() / e };
        1.0 / (PI * a2 * (1.0 + a2 * ratio))
    }

    /// GGX as wide as Blinn-Phong of an exponent: half its peak at the same angle, or alpha 1 where none is so wide.
    pub fn of_exponent(exponent: f64) -> Self {
        let squared_cosine = 0.25_f64.powf(1.0 / exponent);
        Self { alpha: ((1.0 - squared_cosine) / (SQRT_2 - squared_cosine)).sqrt() }
    }

    /// The exponent whose Blinn-Phong falls to half its peak at the same angle, at least 1.
    pub fn exponent(self) -> f64 {
        let a2 = self.alpha * self.alpha;
        let squared_cosine = (1.0 - SQRT_2 * a2) / (1.0 - a2).max(f64::MIN_POSITIVE);
        if squared_cosine <= 0.0 { 1.0 } else { (-2.0 * LN_2 / squared_cosine.ln()).max(1.0) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_equivalent_exponent_falls_to_half_its_peak_where_ggx_does() {
        for alpha in [0.02, 0.1, 0.5] {
            let model = Ggx { alpha };
            let cosine = 0.5_f64.powf(1.0 / model.exponent());
            assert!((model.zonal(cosine) / model.peak() - 0.5).abs() < 1e-6, "alpha {alpha}");
        }
    }
}
