//! Two ways to pull a texel's mean directions towards its neighbours'.
//!
//! Both follow from the prior `prod_j prod_k exp(C' alpha_jk mu_j . mu_jk)` over the neighbours k (Han et al. 2007,
//! appendix; Mikkelsen 2008, eq. 110). Its exact M-step is Mikkelsen's eq. 113; with weights of the normals that sum
//! to 1 and `c = C' / I` for I normals it reads `mu_j ~ kappa_j alpha_j r_j + c sum_k alpha_jk mu_jk`. Han's eq. 23 is
//! that of `C' = C kappa_j S_j` (Mikkelsen, eq. 115), which depends on what is sought and so maximises nothing.
//!
//! Given mu_j the best kappa_j is `A^-1(r_j . mu_j)`, not `A^-1(|r_j|)`: the part of the likelihood that holds kappa_j
//! is `log_peak(kappa_j) + kappa_j (r_j . mu_j - 1)`. Han takes the latter, and Mikkelsen left the question open.

use glam::DVec3;

/// The least mean length of a lobe that was turned away from its normals: nearly uniform, its direction still stored.
const LEAST_LENGTH: f64 = 1e-9;

/// How neighbours pull, and how hard.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Pull {
    /// `mu_j ~ r_j + C sum_k alpha_jk mu_jk` (Han et al. 2007, eq. 23).
    Paper {
        /// Strength C, at least 0.
        c: f64,
    },
    /// `mu_j ~ kappa_j alpha_j r_j + c sum_k alpha_jk mu_jk` (Mikkelsen 2008, eq. 113, per normal).
    Map {
        /// Strength c, at least 0.
        c: f64,
    },
}

/// A lobe after the plain M-step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Unpulled {
    /// The concentration that the E-step used.
    pub kappa: f64,
    /// Weight.
    pub alpha: f64,
    /// Mean resultant vector of its normals.
    pub resultant: DVec3,
}

impl Pull {
    /// EM iterations per texel: the paper says seldom more than ten; the exact step needs fewer from the blend seed.
    pub fn iterations(self) -> usize {
        match self {
            Self::Paper { .. } => 10,
            Self::Map { .. } => 5,
        }
    }

    /// The lobe's resultant turned towards `towards = sum_k alpha_jk mu_jk`, as long as its own projection on the new
    /// direction. Without a pull it is left alone.
    pub fn turned(self, lobe: Unpulled, towards: DVec3) -> DVec3 {
        let (own, pull) = match self {
            Self::Paper { c } => (lobe.resultant, c * towards),
            Self::Map { c } => (lobe.kappa * lobe.alpha * lobe.resultant, c * towards),
        };
        if pull == DVec3::ZERO {
            return lobe.resultant;
        }
        let turned = |mu: DVec3| lobe.resultant.dot(mu).max(LEAST_LENGTH) * mu;
        (own + pull).try_normalize().map_or(lobe.resultant, turned)
    }

    /// What the prior adds to the mean log-likelihood for one lobe of direction `mu`, a constant apart. A retired lobe
    /// points anywhere, hence where it is best. Eq. 23 maximises no such thing.
    pub fn log_prior(self, mu: Option<DVec3>, towards: DVec3) -> f64 {
        match self {
            Self::Paper { .. } => 0.0,
            Self::Map { c } => c * mu.map_or(towards.length(), |mu| mu.dot(towards)),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const LOBE: Unpulled = Unpulled { kappa: 20.0, alpha: 0.5, resultant: DVec3::new(0.0, 0.0, 0.9) };

    #[test]
    fn no_pull_leaves_a_lobe_alone_and_a_strong_one_turns_it_all_the_way() {
        for pull in [Pull::Paper { c: 0.0 }, Pull::Map { c: 0.0 }] {
            assert_eq!(pull.turned(LOBE, DVec3::X), LOBE.resultant);
        }
        for pull in [Pull::Paper { c: 1e9 }, Pull::Map { c: 1e9 }] {
            let turned = pull.turned(LOBE, DVec3::new(0.3, 0.0, 0.4));
            assert!(turned.normalize().distance(DVec3::new(0.6, 0.0, 0.8)) < 1e-7, "{turned}");
            assert!((turned.length() - 0.9 * 0.8).abs() < 1e-7, "its projection: {turned}");
        }
    }

    #[test]
    fn a_lobe_turned_away_from_its_normals_keeps_a_direction() {
        let turned = Pull::Paper { c: 1e9 }.turned(LOBE, -DVec3::Z);
        assert!(turned.z < 0.0 && turned.length() < 1e-8, "{turned}");
    }
}
