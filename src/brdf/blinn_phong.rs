//! Normalised Blinn-Phong, `f(u) = (s+1)/(2 pi) max(u, 0)^s`, and its convolution with a von Mises-Fisher lobe.
//!
//! The convolution is again close to a Blinn-Phong lobe of a smaller exponent s'. The rules differ in how s' is
//! found; `1/kappa` is the lobe's width squared, 0 for a delta, where every rule gives s' = s.

use std::f64::consts::PI;

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
}

impl ConvolutionRule {
    /// Every rule, in the order they are offered.
    pub const ALL: [Self; 3] = [Self::ShiftedExponent, Self::Moment, Self::Paper];

    /// The name to show.
    pub fn label(self) -> &'static str {
        match self {
            Self::Paper => "paper (eq. 20)",
            Self::ShiftedExponent => "s + 1",
            Self::Moment => "moment",
        }
    }

    /// The exponent s' of Blinn-Phong with exponent `shininess` convolved with a lobe of concentration `kappa`.
    pub fn blurred_exponent(self, kappa: f64, shininess: f64) -> f64 {
        match self {
            Self::Paper => kappa * shininess / (kappa + shininess),
            Self::ShiftedExponent => (kappa * (shininess + 1.0) / (kappa + shininess + 1.0) - 1.0).max(0.0),
            Self::Moment => {
                let m = crate::sphere::vmf::mean_resultant_length(kappa) * (shininess + 1.0) / (shininess + 2.0);
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
}
