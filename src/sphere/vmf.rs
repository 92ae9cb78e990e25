//! The von Mises-Fisher lobe: density, mean resultant length and its inverse.
//!
//! `f(n) = kappa / (2 pi (1 - exp(-2 kappa))) exp(kappa (n.mu - 1))` (Fisher 1953; Banerjee et al. 2005), written
//! so that neither `sinh(kappa)` nor `exp(kappa)` is formed. Valid for kappa from 0, the uniform density 1/(4 pi),
//! upward. The exponent is taken as `-kappa |n - mu|^2 / 2`, equal for unit vectors: in f32 at kappa = 1e5,
//! `kappa (n.mu - 1)` would err by 0.012 where this errs by 3e-5.

use std::f64::consts::PI;

/// The sharpest lobe that a fit may use in its likelihood.
///
/// Rounding to 8 bits spreads a component by a variance of `(2/255)^2 / 12 = 5.1e-6`, which is a lobe of kappa
/// 2e5: a sharper one says nothing of the surface. Equal normals, frequent in 8-bit maps, would otherwise drive the
/// likelihood to infinity. Half that width is kept as margin for maps rounded twice.
pub const KAPPA_MAX: f64 = 1e5;

/// The sharpest lobe that storage can tell from a delta: f32 resolves `1 - |r|` to 6e-8.
pub const KAPPA_DELTA: f64 = 1e7;

/// Natural log of the density's value at its peak, `ln(kappa / (2 pi (1 - exp(-2 kappa))))`.
pub fn log_peak(kappa: f64) -> f64 {
    if kappa < 1e-8 {
        return kappa - (4.0 * PI).ln();
    }
    kappa.ln() - (2.0 * PI).ln() - (-(-2.0 * kappa).exp_m1()).ln()
}

/// `A(kappa) = coth(kappa) - 1/kappa`, the length of the lobe's mean vector (Banerjee et al. 2005, eq. 2.3).
pub fn mean_resultant_length(kappa: f64) -> f64 {
    if kappa < 0.05 {
        // The closed form cancels; its series does not.
        let k2 = kappa * kappa;
        return kappa * (1.0 / 3.0 - k2 * (1.0 / 45.0 - k2 * (2.0 / 945.0 - k2 / 4725.0)));
    }
    1.0 / kappa.tanh() - 1.0 / kappa
}

/// `dA / dkappa = 1/kappa^2 - 1/sinh^2(kappa)`.
fn mean_resultant_slope(kappa: f64) -> f64 {
    if kappa < 0.05 {
        let k2 = kappa * kappa;
        return 1.0 / 3.0 - k2 * (1.0 / 15.0 - k2 * 2.0 / 189.0);
    }
    let sinh = kappa.min(300.0).sinh();
    1.0 / (kappa * kappa) - 1.0 / (sinh * sinh)
}

/// Which inverse of `A` a fit uses.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum KappaRule {
    /// The exact inverse, by Newton's method.
    #[default]
    Exact,
    /// Banerjee's closed form, up to 5 % off, as the papers have it.
    Banerjee,
}

impl KappaRule {
    /// The concentration whose mean resultant length is `1 - shortfall`, at most [`KAPPA_DELTA`].
    ///
    /// The argument is `1 - |r|` because `|r|` alone loses the digits that matter near 1.
    pub fn concentration(self, shortfall: f64) -> f64 {
        match self {
            Self::Exact => concentration(shortfall),
            Self::Banerjee => banerjee(shortfall).clamp(0.0, KAPPA_DELTA),
        }
    }
}

/// `kappa = (3 r - r^3) / (1 - r^2)` at `r = 1 - shortfall` (Banerjee et al. 2005, eq. 4.4 with d = 3).
fn banerjee(shortfall: f64) -> f64 {
    let r = 1.0 - shortfall;
    r * (3.0 - r * r) / (shortfall * (1.0 + r)).max(1.0 / KAPPA_DELTA)
}

/// `A^-1(1 - shortfall)`: the concentration with that mean resultant length, in `0..=KAPPA_DELTA`, to 1e-6 relative.
pub fn concentration(shortfall: f64) -> f64 {
    if shortfall < 0.02 {
        // coth(kappa) = 1 to within exp(-100) here, so A = 1 - 1/kappa exactly.
        return (1.0 / shortfall.max(1.0 / KAPPA_DELTA)).min(KAPPA_DELTA);
    }
    let r = 1.0 - shortfall;
    if r <= 0.0 {
        return 0.0;
    }
    let mut kappa = banerjee(shortfall);
    for _ in 0..3 {
        kappa -= (mean_resultant_length(kappa) - r) / mean_resultant_slope(kappa);
    }
    kappa.max(0.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn vmf_integrates_to_one() {
        for kappa in [0.0, 1e-9, 0.01, 1.0, 20.0, 900.0] {
            // Integrate over u = n.mu: 2 pi f(u) du on -1..1, substituting towards the peak.
            let steps = 200_000;
            let sum: f64 = (0..steps)
                .map(|i| {
                    let t = (f64::from(i) + 0.5) / f64::from(steps);
                    let u = 1.0 - 2.0 * t * t;
                    (log_peak(kappa) + kappa * (u - 1.0)).exp() * 2.0 * PI * 4.0 * t
                })
                .sum();
            assert!((sum / f64::from(steps) - 1.0).abs() < 1e-6, "kappa {kappa}: {}", sum / f64::from(steps));
        }
    }

    #[test]
    fn concentration_inverts_the_mean_resultant_length() {
        for exponent in -30..=70 {
            let kappa = 10.0_f64.powf(f64::from(exponent) / 10.0);
            let shortfall = if kappa > 50.0 { 1.0 / kappa } else { 1.0 - mean_resultant_length(kappa) };
            let found = concentration(shortfall);
            assert!((found / kappa - 1.0).abs() < 1e-6, "kappa {kappa}: {found}");
        }
    }

    #[test]
    fn banerjee_is_at_most_five_percent_off() {
        for exponent in -20..=50 {
            let kappa = 10.0_f64.powf(f64::from(exponent) / 10.0);
            let found = KappaRule::Banerjee.concentration(1.0 - mean_resultant_length(kappa));
            assert!((found / kappa - 1.0).abs() < 0.05, "kappa {kappa}: {found}");
        }
    }

    #[test]
    fn no_resultant_means_no_concentration_and_a_full_one_a_delta() {
        assert!(concentration(1.0).abs() < f64::EPSILON);
        assert!((concentration(0.0) - KAPPA_DELTA).abs() < f64::EPSILON);
        assert!((log_peak(0.0) + (4.0 * PI).ln()).abs() < 1e-12);
    }
}
