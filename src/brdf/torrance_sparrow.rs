//! The Torrance-Sparrow form, a Gaussian of the angle beta between normal and half vector:
//! `exp(-beta^2 / (4 sigma^2)) / (4 pi sigma^2)` (Han et al. 2007, eq. 18).
//!
//! That integrates to 1 over a plane; over the sphere it comes to `h / sigma^2`, with
//! `h(x) = 1/2 int_0^pi exp(-beta^2 / (4 x)) sin(beta) dbeta`, `x = sigma^2`, a Dawson function cut off at pi. Here it is
//! divided by that, so `f = exp(-beta^2 / (4 sigma^2)) / (4 pi h(sigma^2))` integrates to 1 for every sigma, up to the
//! uniform lobe. Its multipliers follow `exp(-sigma^2 l (l+1))`, a lobe's `exp(-l (l+1) / (2 kappa))`, so blurred by a
//! lobe it is the same form of `sigma'^2 = sigma^2 + 1 / (2 kappa)` (eq. 21). It has no horizon: normals that face away
//! by more than 90 degrees still reflect, by `exp(-10)` of the peak at sigma = 0.25.

use std::f64::consts::PI;

use super::kind::{ModelKind, ModelParameter};
use super::{Brdf, Material};

/// `torrance-sparrow:SIGMA`.
pub static KIND: ModelKind = ModelKind {
    name: "torrance-sparrow",
    label: "Torrance-Sparrow",
    tooltip: "Torrance-Sparrow form: exp(-b^2 / (4 sigma^2)) / (4 pi sigma^2), b the angle between n and h (Han et al. \
              2007, eq. 18).",
    parameter: Some(ModelParameter {
        symbol: "SIGMA",
        label: "Roughness sigma",
        range: [0.01, 0.5],
        most: 0.5,
        default: Material::DEFAULT.sigma,
        decimals: 3,
        tooltip: "Width of exp(-b^2 / (4 sigma^2)); as wide as Blinn-Phong of s = 1 / (2 sigma^2). A lobe widens it to \
                  sigma'^2 = sigma^2 + 1 / (2 kappa) (Han et al. 2007, eq. 21).",
        field: |material| &mut material.sigma,
        model: |sigma| Brdf::TorranceSparrow(TorranceSparrow { sigma }),
    }),
};

/// The least concentration that divides; below, a lobe is uniform anyway.
const LEAST_KAPPA: f64 = 1e-6;

/// The form by its roughness.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TorranceSparrow {
    /// The roughness sigma, above 0.
    pub sigma: f64,
}

impl TorranceSparrow {
    /// `f(u)`, which integrates to 1 over the sphere.
    pub fn zonal(self, cosine: f64) -> f64 {
        let angle = cosine.clamp(-1.0, 1.0).acos();
        self.peak() * (-0.25 * (angle / self.sigma).powi(2)).exp()
    }

    /// The value at the normal, `1 / (4 pi h)`.
    pub fn peak(self) -> f64 {
        1.0 / (4.0 * PI * mean_over_sphere(self.sigma * self.sigma))
    }

    /// Blurred by a lobe (Han et al. 2007, eq. 21).
    pub fn blurred(self, kappa: f64) -> Self {
        Self { sigma: (self.sigma * self.sigma + 0.5 / kappa.max(LEAST_KAPPA)).sqrt() }
    }

    /// `1 / (2 sigma^2)`: the exponent whose multipliers the papers write alike, `exp(-l^2 / (2 s))` and
    /// `exp(-sigma^2 l^2)`.
    pub fn exponent(self) -> f64 {
        0.5 / (self.sigma * self.sigma)
    }

    /// The form as wide as Blinn-Phong of an exponent.
    pub fn of_exponent(exponent: f64) -> Self {
        Self { sigma: (0.5 / exponent).sqrt() }
    }

    /// `exp(-sigma^2 l^2)` for `l < bands`, as eq. 18 has the multipliers.
    pub fn zonal_of_paper(self, bands: usize) -> Vec<f64> {
        (0..bands).map(|l| (-(self.sigma * l as f64).powi(2)).exp()).collect()
    }
}

/// `h(x)`, to 5e-6 of itself: up to x = 1/4 Dawson's series, beyond a rational fit that ends as the integral does,
/// `1 - (pi^2 - 4) / (8 x)`.
fn mean_over_sphere(x: f64) -> f64 {
    if x < 0.25 {
        return x * (1.0 - x * (2.0 / 3.0 - x * (4.0 / 15.0 - x * (8.0 / 105.0 - x * 16.0 / 945.0))));
    }
    let y = 1.0 / x;
    (1.0 + y * (0.411_301_7 + y * (0.116_752_45 - y * 4.930_641e-4)))
        / (1.0 + y * (1.145_002_25 + y * (0.535_102_54 + y * 0.109_010_96)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn its_integral_over_the_sphere_is_one_for_every_width() {
        for sigma in [0.01, 0.1, 0.4, 0.499, 0.501, 0.7, 1.2, 4.5, 100.0] {
            let model = TorranceSparrow { sigma };
            let end = PI.min(14.0 * sigma);
            let steps = 100_000;
            let step = end / f64::from(steps);
            let value = |i: i32| (f64::from(i) + 0.5) * step;
            let sum: f64 = (0..steps).map(|i| model.zonal(value(i).cos()) * value(i).sin()).sum();
            assert!((2.0 * PI * step * sum - 1.0).abs() < 6e-6, "sigma {sigma}: {}", 2.0 * PI * step * sum);
        }
    }
}
