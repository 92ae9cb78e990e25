//! One isotropic Gaussian over `(n_x, n_y)`, in the form that is stored and in the form that is read.
//!
//! Stored as `(alpha, alpha mu_x, alpha mu_y, alpha (sigma^2 + |mu|^2 / 2))`, which interpolates linearly: `sigma^2` is
//! the variance of each of two axes, so `E |n|^2 / 2 = sigma^2 + |mu|^2 / 2`, and it is read as `T / alpha - |mu|^2 / 2`.
//! The paper prints the whole `|mu|^2` both times, which takes an interpolated pair of Gaussians for too wide a one.

use std::f64::consts::TAU;

use glam::{DVec2, DVec3};

/// The most Gaussians a texel can hold.
pub const MAX_GAUSSIANS: usize = 16;

/// Weights below this are an empty slot.
pub const EMPTY_WEIGHT: f64 = 1e-7;

/// A weighted Gaussian.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PlanarGaussian {
    /// Weight alpha, `0..=1`.
    pub weight: f64,
    /// Mean `(n_x, n_y)`, inside the unit disc.
    pub mean: DVec2,
    /// Variance sigma^2 along each axis.
    pub variance: f64,
}

impl PlanarGaussian {
    /// Reads the stored form; `None` for an empty slot.
    pub fn from_stored(stored: [f32; 4]) -> Option<Self> {
        let [weight, x, y, squares] = stored.map(f64::from);
        if weight < EMPTY_WEIGHT {
            return None;
        }
        let mean = DVec2::new(x, y) / weight;
        Some(Self { weight, mean, variance: (squares / weight - 0.5 * mean.length_squared()).max(0.0) })
    }

    /// The stored form.
    pub fn to_stored(self) -> [f32; 4] {
        let mean = self.weight * self.mean;
        let squares = self.weight * (self.variance + 0.5 * self.mean.length_squared());
        [self.weight as f32, mean.x as f32, mean.y as f32, squares as f32]
    }

    /// `g(h; mu, sigma^2 + added)` at a half vector, without the weight, per unit of the disc's area: the paper counts
    /// no Jacobian. Nothing below the horizon.
    pub fn density(&self, added: f64, half: DVec3) -> f64 {
        if half.z <= 0.0 {
            return 0.0;
        }
        let variance = self.variance + added;
        (-0.5 * half.truncate().distance_squared(self.mean) / variance).exp() / (TAU * variance)
    }

    /// The unit normal above the mean.
    pub fn normal(&self) -> DVec3 {
        self.mean.extend((1.0 - self.mean.length_squared()).max(0.0).sqrt()).normalize()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_gaussian_survives_storage() {
        let gaussian = PlanarGaussian { weight: 0.3, mean: DVec2::new(0.5, -0.2), variance: 0.02 };
        let read = PlanarGaussian::from_stored(gaussian.to_stored()).expect("not empty");
        assert!((read.variance - 0.02).abs() < 1e-7 && read.mean.distance(gaussian.mean) < 1e-7);
        assert_eq!(PlanarGaussian::from_stored([0.0; 4]), None);
    }

    #[test]
    fn a_blend_has_the_variance_that_sampling_both_gives() {
        // Means 0.6 apart along x, each of variance 0.01: the samples' variance is 0.01 + 0.09 along x and 0.01 along
        // y, 0.055 on the mean. The printed formula gives 0.100.
        let at = |x| PlanarGaussian { weight: 1.0, mean: DVec2::new(x, 0.0), variance: 0.01 }.to_stored();
        let (a, b) = (at(-0.3), at(0.3));
        let blend = PlanarGaussian::from_stored(std::array::from_fn(|i| 0.5 * (a[i] + b[i]))).expect("not empty");
        assert!((blend.variance - 0.055).abs() < 1e-7 && blend.mean.length() < 1e-7, "{blend:?}");
    }

    #[test]
    fn the_density_integrates_to_one_over_the_disc() {
        let gaussian = PlanarGaussian { weight: 1.0, mean: DVec2::new(0.1, 0.2), variance: 0.01 };
        let steps = 600;
        let at = |i: i32| f64::from(i) / f64::from(steps) - 1.0;
        let mut sum = 0.0;
        for (x, y) in (0..2 * steps).flat_map(|i| (0..2 * steps).map(move |j| (at(i), at(j)))) {
            let squared = x * x + y * y;
            if squared < 1.0 {
                sum += gaussian.density(0.002, DVec3::new(x, y, (1.0 - squared).sqrt()));
            }
        }
        assert!((sum / f64::from(steps).powi(2) - 1.0).abs() < 1e-3, "{sum}");
    }
}
