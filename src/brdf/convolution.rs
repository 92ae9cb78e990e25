//! A model convolved with a von Mises-Fisher lobe.
//!
//! Blinn-Phong is again close to a Blinn-Phong lobe of a smaller exponent s'. The rules differ in how s' is found;
//! `1/kappa` is the lobe's width squared, 0 for a delta, where every rule gives s' = s. The Torrance-Sparrow form has a
//! closed form of its own (Han et al. 2007, eq. 21), which is at once the paper's and the counterpart of the rule of
//! s + 1; models without one are a sum of Blinn-Phong lobes, each convolved by the rule, steps at the horizon by their own
//! ([`super::blurred_powers`]). The exact convolution is a
//! Legendre series of any model.

use std::f64::consts::PI;

use super::blurred_powers::BlurredPowers;
use super::projection::{Projection, bands_for};
use super::{BlinnPhong, Brdf, TorranceSparrow};
use crate::sphere::harmonics::{cosine_power_zonal, vmf_zonal, zonal_series};
use crate::sphere::vmf::{self, KAPPA_MAX};

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
            Self::Cosine => Convolved::Itself(Brdf::Lambert),
            Self::Exact => Brdf::Lambert.convolved_with(ConvolutionRule::Exact, kappa),
        }
    }
}

/// `exp(-NOTHING)` is less than what f64 resolves beside a peak.
const NOTHING: f64 = 40.0;

/// Concentrations between which lobes that stand for a model give way to the model itself, by the logarithm: the blur
/// of such lobes is next to none, and what the fit of those leaves out is seen in dark places. A step from one to the
/// other would fall on either side of it by a rounding.
const SHARP: [f64; 2] = [1e4, 1e6];

/// The share of the model itself under a lobe of concentration `kappa`.
fn own_share(kappa: f64) -> f64 {
    ((kappa / SHARP[0]).ln() / (SHARP[1] / SHARP[0]).ln()).clamp(0.0, 1.0)
}

/// A model convolved with one lobe, ready for any number of cosines.
#[derive(Clone, Debug, PartialEq)]
pub enum Convolved {
    /// Blinn-Phong of a smaller exponent.
    Power(BlinnPhong),
    /// The Torrance-Sparrow form of a larger width.
    Gaussian(TorranceSparrow),
    /// The Blinn-Phong lobes that stand for the model, each convolved.
    Powers(BlurredPowers),
    /// The same under a sharp lobe: beside them the model as it is, by its share.
    Sharp(BlurredPowers, Brdf, f64),
    /// The model as it is: the lobe is a delta.
    Itself(Brdf),
    /// A Legendre series by its coefficients.
    Series(Vec<f64>),
}

impl Convolved {
    /// The value at the cosine to the lobe's mean direction.
    pub fn at(&self, cosine: f64) -> f64 {
        match self {
            Self::Power(model) => power(*model, cosine),
            Self::Gaussian(model) => model.zonal(cosine),
            Self::Powers(lobes) => lobes.at(cosine),
            Self::Sharp(lobes, model, share) => (1.0 - share) * lobes.at(cosine) + share * model.zonal(cosine),
            Self::Itself(model) => model.zonal(cosine),
            Self::Series(coefficients) => zonal_series(coefficients.iter().copied(), cosine).max(0.0),
        }
    }
}

/// Blinn-Phong's value, without the work where there is none.
pub(super) fn power(model: BlinnPhong, cosine: f64) -> f64 {
    // u^s <= exp(-s (1-u)): far from a sharp lobe there is nothing to raise to a power.
    if model.shininess * (1.0 - cosine) > NOTHING { 0.0 } else { model.zonal(cosine) }
}

impl Brdf {
    /// This model convolved with a lobe of concentration `kappa`, ready for any number of cosines to the lobe's mean
    /// direction. Lobes sharper than [`KAPPA_MAX`] take too long a series, and a closed form is as good.
    pub fn convolved_with(self, rule: ConvolutionRule, kappa: f64) -> Convolved {
        if rule == ConvolutionRule::Exact && kappa <= KAPPA_MAX {
            return Convolved::Series(self.series(kappa));
        }
        match self {
            Self::Lambert => Convolved::Power(rule.blurred(BlinnPhong { shininess: 1.0 }, kappa)),
            Self::BlinnPhong(model) => Convolved::Power(rule.blurred(model, kappa)),
            Self::TorranceSparrow(model) => Convolved::Gaussian(model.blurred(kappa)),
            Self::Ggx(_) | Self::Measured(_) => {
                let lobes = || BlurredPowers::new(self.lobes(), rule, kappa);
                match own_share(kappa) {
                    0.0 => Convolved::Powers(lobes()),
                    1.0 => Convolved::Itself(self),
                    share => Convolved::Sharp(lobes(), self, share),
                }
            }
        }
    }

    /// That at one cosine.
    pub fn convolved(self, rule: ConvolutionRule, kappa: f64, cosine: f64) -> f64 {
        self.convolved_with(rule, kappa).at(cosine)
    }

    /// The coefficients of the exact convolution, `rho_l A_l(kappa)`.
    pub(super) fn series(self, kappa: f64) -> Vec<f64> {
        let (of_lobe, shininess) = (vmf_zonal, self.exponent());
        // The terms follow exp(-l^2/2 (1/kappa + 1/(s+1))); below s = 8 those of f fall off too slowly to count on, and
        // so do those of a long tail.
        let is_smooth = !self.has_tail() && shininess >= 8.0;
        let bands = bands_for(if is_smooth { kappa * (shininess + 1.0) / (kappa + shininess + 1.0) } else { kappa });
        let product = |(rho, a): (f64, f64)| rho * a;
        match self {
            Self::Lambert | Self::BlinnPhong(_) => {
                cosine_power_zonal(shininess, bands).into_iter().zip(of_lobe(kappa, bands)).map(product).collect()
            }
            Self::TorranceSparrow(_) | Self::Ggx(_) | Self::Measured(_) => {
                let projection = Projection::of(self);
                projection.multipliers(bands).iter().copied().zip(of_lobe(kappa, bands)).map(product).collect()
            }
        }
    }
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

    fn blurred(self, model: BlinnPhong, kappa: f64) -> BlinnPhong {
        BlinnPhong { shininess: self.blurred_exponent(kappa, model.shininess) }
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
    use super::super::tests::some_models;
    use super::*;

    #[test]
    fn a_delta_leaves_the_exponent_alone_under_every_rule() {
        for rule in ConvolutionRule::ALL {
            let blurred = rule.blurred_exponent(1e12, 64.0);
            assert!((blurred - 64.0).abs() < 1e-3, "{rule:?}: {blurred}");
        }
    }

    /// Midpoint rule over the lobe: cosine to the lobe's axis by equal shares of its weight, and azimuth.
    fn integral(model: Brdf, kappa: f64, u: f64) -> f64 {
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
                sum += model.zonal(c * u + ((1.0 - c * c) * (1.0 - u * u)).sqrt() * azimuth.cos());
            }
        }
        sum / f64::from(steps * turns)
    }

    fn assert_is_integral(model: Brdf, kappa: f64) {
        let peak = model.convolved(ConvolutionRule::Exact, kappa, 1.0);
        for u in [1.0_f64, 0.9, 0.3, -0.2] {
            let (exact, integral) = (model.convolved(ConvolutionRule::Exact, kappa, u), integral(model, kappa, u));
            assert!((exact - integral).abs() < 2e-3 * peak, "{model}, kappa {kappa}, u {u}: {exact} {integral}");
        }
    }

    #[test]
    fn the_exact_convolution_is_the_integral_over_the_lobe() {
        let blinn_phong = |shininess| Brdf::BlinnPhong(BlinnPhong { shininess });
        for (kappa, shininess) in
            [(0.0_f64, 10.0_f64), (2.0, 1.0), (30.0, 1.0), (5.0, 10.0), (15.5, 400.0), (2e3, 64.0)]
        {
            assert_is_integral(blinn_phong(shininess), kappa);
        }
        for model in some_models() {
            assert_is_integral(model, 20.0);
        }
    }

    #[test]
    fn the_closed_forms_come_near_the_exact_convolution() {
        for model in some_models() {
            let mut worst = 0.0_f64;
            for kappa in [10.0, 30.0, 100.0, 1e3, 1e4] {
                let [closed, exact] = [ConvolutionRule::ShiftedExponent, ConvolutionRule::Exact]
                    .map(|rule| model.convolved_with(rule, kappa));
                let off = |i: i32| (closed.at(f64::from(i) / 50.0) - exact.at(f64::from(i) / 50.0)).abs();
                worst = worst.max((0..=50).map(off).fold(0.0, f64::max) / exact.at(1.0));
            }
            println!("{model}: {worst:.3} of the peak");
            let limit = match model {
                // The clamped cosine has a kink; it is off by 0.135.
                Brdf::Lambert => 0.15,
                _ => 0.1,
            };
            assert!(worst < limit, "{model}: {worst}");
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
