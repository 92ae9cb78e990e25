//! Normalised Blinn-Phong, `f(u) = (s+1)/(2 pi) max(u, 0)^s`, and its convolution with a von Mises-Fisher lobe.
//!
//! The convolution is again close to a Blinn-Phong lobe of a smaller exponent s'. The rules differ in how s' is
//! found; `1/kappa` is the lobe's width squared, 0 for a delta, where every rule gives s' = s. The exact convolution is
//! a Legendre series.

use std::f64::consts::PI;

use crate::sphere::harmonics::{cosine_power_zonal, vmf_zonal, zonal_series};
use crate::sphere::vmf::{self, KAPPA_MAX};

/// Blinn-Phong as a function of the cosine between normal and half vector.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BlinnPhong {
    /// The exponent s, at least 1.
    pub shininess: f64,
}

impl BlinnPhong {
    /// `f(u)`, which integrates to 1 over the sphere.
    pub fn zonal(self, cosine: f64) -> f64 {
        (self.shininess + 1.0) / (2.0 * PI) * cosine.max(0.0).powf(self.shininess)
    }
}

/// How the exponent of a blurred Blinn-Phong lobe is found.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum ConvolutionRule {
    /// `s' = kappa s / (kappa + s)` (Han et al. 2007, eq. 20).
    Paper,
    /// `s' + 1 = kappa (s+1) / (kappa + s + 1)`, floored at s' = 0: Blinn-Phong's multipliers follow
    /// `exp(-l(l+1) / (2(s+1)))`, so it is `s + 1` that adds like `kappa`. The default: it measures best.
    #[default]
    ShiftedExponent,
    /// `s' = (2m-1)/(1-m)` with `m = A(kappa) (s+1)/(s+2)`, floored at 0: exact in the first moment.
    Moment,
    /// The convolution itself, `sum_l (2l+1)/(4 pi) rho_l A_l(kappa) P_l(u)`: slow, and the judge of the others.
    Exact,
}

/// How a lobe reflects diffusely.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum DiffuseRule {
    /// The clamped cosine of the mean direction (Han et al. 2007, Algorithm 2), wrong for wide lobes.
    #[default]
    Cosine,
    /// The clamped cosine convolved with the lobe.
    Exact,
}

impl DiffuseRule {
    /// Every rule, in the order they are offered.
    pub const ALL: [Self; 2] = [Self::Cosine, Self::Exact];

    /// The name to show.
    pub fn label(self) -> &'static str {
        match self {
            Self::Cosine => "cosine (Algorithm 2)",
            Self::Exact => "exact",
        }
    }

    /// The lobe's `max(n . w, 0)`, for the cosine between its mean direction and the light.
    pub fn cosine(self, kappa: f64, cosine: f64) -> f64 {
        match self {
            Self::Cosine => cosine.max(0.0),
            Self::Exact => PI * self.convolved_with(kappa).at(cosine),
        }
    }

    /// That over pi, ready for any number of cosines.
    pub fn convolved_with(self, kappa: f64) -> Convolved {
        match self {
            Self::Cosine => Convolved::Power(BlinnPhong { shininess: 1.0 }),
            Self::Exact => ConvolutionRule::Exact.convolved_with(kappa, 1.0),
        }
    }
}

/// `exp(-NOTHING)` is less than what f64 resolves beside a peak.
const NOTHING: f64 = 40.0;

/// Blinn-Phong convolved with one lobe, ready for any number of cosines.
#[derive(Clone, Debug, PartialEq)]
pub enum Convolved {
    /// Blinn-Phong of a smaller exponent.
    Power(BlinnPhong),
    /// A Legendre series by its coefficients.
    Series(Vec<f64>),
}

impl Convolved {
    /// The value at the cosine to the lobe's mean direction.
    pub fn at(&self, cosine: f64) -> f64 {
        match self {
            // u^s <= exp(-s (1-u)): far from a sharp lobe there is nothing to raise to a power.
            Self::Power(model) if model.shininess * (1.0 - cosine) > NOTHING => 0.0,
            Self::Power(model) => model.zonal(cosine),
            Self::Series(coefficients) => zonal_series(coefficients.iter().copied(), cosine).max(0.0),
        }
    }
}

/// The coefficients of the exact convolution, `rho_l A_l(kappa)`; `None` for a lobe sharper than [`KAPPA_MAX`], which
/// takes too many, and for which the rule of s + 1 is as good.
pub(super) fn series(kappa: f64, shininess: f64) -> Option<Vec<f64>> {
    if kappa > KAPPA_MAX {
        return None;
    }
    // The terms follow exp(-l^2/2 (1/kappa + 1/(s+1))); below s = 8 those of f fall off too slowly to count on.
    let width = if shininess < 8.0 { kappa } else { kappa * (shininess + 1.0) / (kappa + shininess + 1.0) };
    let bands = 10 + (7.0 * width.sqrt()) as usize;
    let terms = cosine_power_zonal(shininess, bands).into_iter().zip(vmf_zonal(kappa, bands));
    Some(terms.map(|(rho, a)| rho * a).collect())
}

impl ConvolutionRule {
    /// Every rule, in the order they are offered.
    pub const ALL: [Self; 4] = [Self::ShiftedExponent, Self::Moment, Self::Paper, Self::Exact];

    /// The name to show.
    pub fn label(self) -> &'static str {
        match self {
            Self::Paper => "paper (eq. 20)",
            Self::ShiftedExponent => "s + 1",
            Self::Moment => "moment",
            Self::Exact => "exact",
        }
    }

    /// Blinn-Phong of exponent `shininess` convolved with a lobe of concentration `kappa`, at the cosine to the lobe's
    /// mean direction.
    pub fn convolved(self, kappa: f64, shininess: f64, cosine: f64) -> f64 {
        self.convolved_with(kappa, shininess).at(cosine)
    }

    /// That for any number of cosines.
    pub fn convolved_with(self, kappa: f64, shininess: f64) -> Convolved {
        let power = || Convolved::Power(BlinnPhong { shininess: self.blurred_exponent(kappa, shininess) });
        match self {
            Self::Exact => series(kappa, shininess).map_or_else(power, Convolved::Series),
            _ => power(),
        }
    }

    /// The exponent s' of Blinn-Phong with exponent `shininess` convolved with a lobe of concentration `kappa`; where
    /// the rule has none, that of the default.
    pub fn blurred_exponent(self, kappa: f64, shininess: f64) -> f64 {
        match self {
            Self::Paper => kappa * shininess / (kappa + shininess),
            Self::ShiftedExponent | Self::Exact => {
                (kappa * (shininess + 1.0) / (kappa + shininess + 1.0) - 1.0).max(0.0)
            }
            Self::Moment => {
                let m = vmf::mean_resultant_length(kappa) * (shininess + 1.0) / (shininess + 2.0);
                ((2.0 * m - 1.0) / (1.0 - m)).max(0.0)
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn blinn_phong_integrates_to_one() {
        for shininess in [1.0, 10.0, 4000.0] {
            let steps = 400_000;
            let sum: f64 = (0..steps)
                .map(|i| {
                    let t = (f64::from(i) + 0.5) / f64::from(steps);
                    BlinnPhong { shininess }.zonal(1.0 - t * t) * 2.0 * t * 2.0 * PI
                })
                .sum();
            assert!((sum / f64::from(steps) - 1.0).abs() < 1e-5, "s {shininess}");
        }
    }

    #[test]
    fn a_delta_leaves_the_exponent_alone_under_every_rule() {
        for rule in ConvolutionRule::ALL {
            let blurred = rule.blurred_exponent(1e12, 64.0);
            assert!((blurred - 64.0).abs() < 1e-3, "{rule:?}: {blurred}");
        }
    }

    #[test]
    fn the_exact_convolution_is_the_integral_over_the_lobe() {
        for (kappa, shininess) in
            [(0.0_f64, 10.0_f64), (2.0, 1.0), (30.0, 1.0), (5.0, 10.0), (15.5, 400.0), (2e3, 64.0)]
        {
            for u in [1.0_f64, 0.9, 0.3, -0.2] {
                // Midpoint rule over the lobe: cosine to the lobe's axis by equal shares of its weight, and azimuth.
                let (steps, turns) = (2000, 64);
                let mut sum = 0.0;
                for i in 0..steps {
                    let share = (f64::from(i) + 0.5) / f64::from(steps);
                    let c = if kappa == 0.0 {
                        2.0 * share - 1.0
                    } else {
                        1.0 + (share + (1.0 - share) * (-2.0 * kappa).exp()).ln() / kappa
                    };
                    for turn in 0..turns {
                        let azimuth = f64::from(turn) * 2.0 * PI / f64::from(turns);
                        let cosine = c * u + ((1.0 - c * c) * (1.0 - u * u)).sqrt() * azimuth.cos();
                        sum += BlinnPhong { shininess }.zonal(cosine);
                    }
                }
                let integral = sum / f64::from(steps * turns);
                let exact = ConvolutionRule::Exact.convolved(kappa, shininess, u);
                let peak = ConvolutionRule::Exact.convolved(kappa, shininess, 1.0);
                assert!(
                    (exact - integral).abs() < 2e-3 * peak,
                    "kappa {kappa}, s {shininess}, u {u}: {exact} {integral}"
                );
            }
        }
    }

    #[test]
    fn the_exact_cosine_of_a_sharp_lobe_is_the_clamped_one_and_of_a_uniform_one_a_quarter() {
        for u in [-0.5, 0.2, 1.0] {
            assert!((DiffuseRule::Exact.cosine(9e4, u) - DiffuseRule::Cosine.cosine(9e4, u)).abs() < 1e-4, "{u}");
            assert!((DiffuseRule::Exact.cosine(0.0, u) - 0.25).abs() < 1e-12, "{u}");
        }
    }
}
