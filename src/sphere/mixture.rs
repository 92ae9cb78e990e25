//! Mixtures of von Mises-Fisher lobes, in the form that is stored and in the form that is read.
//!
//! A lobe is stored as `(alpha, alpha A(kappa) mu)`: four channels that interpolate and add linearly (Han et al.
//! 2007, section 6.2), so merging two lobes is adding their channels.

use glam::{DVec3, Vec3};

use super::vmf;

/// The most lobes a texel can hold.
pub const MAX_LOBES: usize = 16;

/// A lobe as stored: `[alpha, alpha A(kappa) mu_x, .. mu_y, .. mu_z]`.
pub type StoredLobe = [f32; 4];

/// Weights below this are an empty slot.
pub const EMPTY_WEIGHT: f32 = 1e-7;

/// How many slots hold a lobe.
pub fn used(stored: &[StoredLobe]) -> usize {
    stored.iter().filter(|lobe| lobe[0] > EMPTY_WEIGHT).count()
}

/// One lobe in the papers' terms.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
pub struct Lobe {
    /// Weight, `0..=1`.
    #[serde(rename = "alpha")]
    pub weight: f64,
    /// Mean direction mu, a unit vector in tangent space.
    #[serde(rename = "mu")]
    pub mean_direction: DVec3,
    /// Concentration kappa.
    #[serde(rename = "kappa")]
    pub concentration: f64,
}

impl Lobe {
    /// Reads a stored lobe; `None` for an empty slot.
    pub fn from_stored(stored: StoredLobe) -> Option<Self> {
        let weight = f64::from(stored[0]);
        if stored[0] < EMPTY_WEIGHT {
            return None;
        }
        let resultant = Vec3::new(stored[1], stored[2], stored[3]).as_dvec3() / weight;
        let length = resultant.length();
        Some(Self {
            weight,
            mean_direction: resultant.try_normalize().unwrap_or(DVec3::Z),
            concentration: vmf::concentration(1.0 - length),
        })
    }

    /// The stored form, `(alpha, alpha A(kappa) mu)`.
    pub fn to_stored(self) -> StoredLobe {
        let length = 1.0 - shortfall(self.concentration);
        let resultant = (self.weight * length * self.mean_direction).as_vec3();
        [self.weight as f32, resultant.x, resultant.y, resultant.z]
    }

    /// Natural log of the lobe's density at unit vector `direction`, per steradian, without the weight.
    pub fn log_density(&self, direction: DVec3) -> f64 {
        vmf::log_peak(self.concentration)
            - 0.5 * self.concentration * (direction - self.mean_direction).length_squared()
    }
}

/// `1 - A(kappa)` without the cancellation of the subtraction.
fn shortfall(kappa: f64) -> f64 {
    if kappa > 50.0 { 1.0 / kappa } else { 1.0 - vmf::mean_resultant_length(kappa) }
}

/// The lobes of one texel, empty slots left out.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Mixture {
    /// Slot and lobe, in stored order.
    pub lobes: Vec<(usize, Lobe)>,
}

impl Mixture {
    /// Reads stored lobes, slot by slot.
    pub fn from_stored(stored: &[StoredLobe]) -> Self {
        let lobes = stored.iter().enumerate().filter_map(|(slot, &s)| Some((slot, Lobe::from_stored(s)?)));
        Self { lobes: lobes.collect() }
    }

    /// The geometric mean of the concentrations by weight, `exp(sum_j alpha_j ln kappa_j / sum_j alpha_j)`: one figure
    /// that no single sharp lobe rules. A concentration below 0.01 counts as that; `None` without lobes.
    pub fn mean_concentration(&self) -> Option<f64> {
        let weight: f64 = self.lobes.iter().map(|(_, lobe)| lobe.weight).sum();
        let sum: f64 = self.lobes.iter().map(|(_, lobe)| lobe.weight * lobe.concentration.max(0.01).ln()).sum();
        (weight > 0.0).then(|| (sum / weight).exp())
    }

    /// Density at unit vector `direction`, per steradian.
    pub fn density(&self, direction: DVec3) -> f64 {
        self.lobes.iter().map(|(_, lobe)| lobe.weight * lobe.log_density(direction).exp()).sum()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_lobe_survives_storage() {
        for kappa in [0.0, 0.3, 15.5, 400.0, 9e4] {
            let lobe = Lobe { weight: 0.4, mean_direction: DVec3::new(0.6, 0.0, 0.8), concentration: kappa };
            let read = Lobe::from_stored(lobe.to_stored()).expect("not empty");
            // f32 storage resolves 1 - |r| to about 1e-7, which is 1 % of 1/kappa at 1e5.
            assert!((read.concentration - kappa).abs() <= 1e-6 + kappa * (1e-5 + 1e-7 * kappa), "{kappa}: {read:?}");
            assert!((read.weight - 0.4).abs() < 1e-7);
        }
        assert_eq!(Lobe::from_stored([0.0; 4]), None);
    }

    #[test]
    fn merging_two_lobes_is_adding_their_channels() {
        let make = |x: f64| Lobe { weight: 0.5, mean_direction: DVec3::new(x, 0.0, 0.8), concentration: 1e7 };
        let (a, b) = (make(0.6).to_stored(), make(-0.6).to_stored());
        let merged = Lobe::from_stored(std::array::from_fn(|i| a[i] + b[i])).expect("not empty");
        assert!((merged.mean_direction - DVec3::Z).length() < 1e-6);
        assert!((vmf::mean_resultant_length(merged.concentration) - 0.8).abs() < 1e-6);
    }
}
