//! The data's part of the squared distance between shaded mixtures: sums over the normals of every lobe's density
//! under the blur of every material, in one pass.
//!
//! Structure of arrays, f32, one version per instruction set chosen at run time, as the E-step in [`super::kernel`].
//! The exponent is `-K |n - mu|^2 / 2`.

use std::f32::consts::LOG2_E;

use multiversion::multiversion;
use multiversion::target::target_cfg_f;

use super::kernel::SampleSlices;
use super::lanes::{LANES, exp2_of_negative, halving_sum, lanes, mul_add};
use crate::sphere::mixture::MAX_LOBES;

/// Exponents of the materials whose shaded look is compared: broad, usual and sharp.
pub const MATERIALS: [f64; 3] = [10.0, 64.0, 400.0];

/// Groups of lanes that are summed in f32 before f64 takes over.
const GROUPS: usize = 16;

/// Lobes under the blur of each material, as the loop reads them.
#[derive(Clone, Copy, Debug, Default)]
pub struct ShadedLobes {
    /// Lobes in use.
    pub count: usize,
    /// Mean directions.
    pub mu: [[f32; 3]; MAX_LOBES],
    /// `-K / 2` by lobe and material.
    pub neg_half_kappa: [[f32; MATERIALS.len()]; MAX_LOBES],
}

/// What one lobe's density under one material sums to, without its peak.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct DensitySum {
    /// `sum_i w_i e_i` with `e = exp(-K |n - mu|^2 / 2)`.
    pub value: f64,
    /// `sum_i w_i e_i (n_i - mu)`.
    pub deviation: [f64; 3],
}

/// The sums of every lobe under every material.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ShadedSums {
    /// By lobe and material.
    pub density: [[DensitySum; MATERIALS.len()]; MAX_LOBES],
    /// `sum_i w_i`.
    pub total: f64,
}

impl std::ops::AddAssign<&Self> for ShadedSums {
    fn add_assign(&mut self, other: &Self) {
        for (own, other) in self.density.iter_mut().flatten().zip(other.density.iter().flatten()) {
            own.value += other.value;
            for axis in 0..3 {
                own.deviation[axis] += other.deviation[axis];
            }
        }
        self.total += other.total;
    }
}

/// Adds the densities of `lobes` at `samples` to `sums`.
#[multiversion(targets(
    "x86_64+avx+avx2+bmi1+bmi2+fma+avx512f+avx512bw+avx512dq+avx512vl",
    "x86_64+avx+avx2+bmi1+bmi2+fma",
    "x86_64+sse4.1"
))]
pub fn accumulate(samples: &SampleSlices, lobes: &ShadedLobes, sums: &mut ShadedSums) {
    const FMA: bool = target_cfg_f!(any(target_feature = "fma", target_arch = "aarch64"));
    for start in (0..samples.x.len()).step_by(GROUPS * LANES) {
        let block = samples.range(start, (start + GROUPS * LANES).min(samples.x.len()));
        sums.total += block.w.iter().map(|&w| f64::from(w)).sum::<f64>();
        for j in 0..lobes.count.min(MAX_LOBES) {
            for material in 0..MATERIALS.len() {
                let sum = &mut sums.density[j][material];
                let neg_half_kappa = lobes.neg_half_kappa[j][material];
                if block.spread.is_empty() {
                    add_block::<FMA, false>(&block, lobes.mu[j], neg_half_kappa, sum);
                } else {
                    add_block::<FMA, true>(&block, lobes.mu[j], neg_half_kappa, sum);
                }
            }
        }
    }
}

#[inline(always)]
fn add_block<const FMA: bool, const SPREAD: bool>(
    samples: &SampleSlices,
    [mx, my, mz]: [f32; 3],
    neg_half_kappa: f32,
    sum: &mut DensitySum,
) {
    let k = neg_half_kappa * LOG2_E;
    let mut acc = [[0.0_f32; LANES]; 4];
    for group in 0..samples.x.len() / LANES {
        let (x, y, z, w) =
            (lanes(samples.x, group), lanes(samples.y, group), lanes(samples.z, group), lanes(samples.w, group));
        let spread = if SPREAD { lanes(samples.spread, group) } else { [0.0; LANES] };
        for i in 0..LANES {
            let (dx, dy, dz) = (x[i] - mx, y[i] - my, z[i] - mz);
            let flat = if SPREAD { mul_add::<FMA>(dx, dx, spread[i]) } else { dx * dx };
            let chord = mul_add::<FMA>(dz, dz, mul_add::<FMA>(dy, dy, flat));
            let value = w[i] * exp2_of_negative::<FMA>(k * chord);
            acc[0][i] += value;
            acc[1][i] = mul_add::<FMA>(value, dx, acc[1][i]);
            acc[2][i] = mul_add::<FMA>(value, dy, acc[2][i]);
            acc[3][i] = mul_add::<FMA>(value, dz, acc[3][i]);
        }
    }
    let [value, deviation @ ..] = acc;
    sum.value += f64::from(halving_sum(value));
    for (total, part) in sum.deviation.iter_mut().zip(deviation) {
        *total += f64::from(halving_sum(part));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::{DVec3, Vec3};

    #[test]
    fn the_block_loop_equals_the_plain_sums_in_f64() {
        let n = 3 * GROUPS * LANES + 5 * LANES;
        let normal = |i: usize| Vec3::new((i as f32 * 0.7).sin() * 0.4, (i as f32 * 1.3).cos() * 0.3, 1.0).normalize();
        let column = |axis: usize| (0..n).map(|i| normal(i)[axis]).collect::<Vec<f32>>();
        let (x, y, z) = (column(0), column(1), column(2));
        let w: Vec<f32> = (0..n).map(|i| if i % 7 == 0 { 0.0 } else { 0.5 + (i % 3) as f32 }).collect();
        let mut lobes = ShadedLobes { count: 2, ..ShadedLobes::default() };
        for j in 0..2 {
            lobes.mu[j] = Vec3::new(j as f32 * 0.3 - 0.2, 0.1, 1.0).normalize().to_array();
            lobes.neg_half_kappa[j] = [-2.5, -20.0, -190.0];
        }
        let mut sums = ShadedSums::default();
        accumulate(&SampleSlices { x: &x, y: &y, z: &z, w: &w, spread: &[] }, &lobes, &mut sums);
        let total: f64 = w.iter().map(|&w| f64::from(w)).sum();
        assert!((sums.total - total).abs() < 1e-9);
        for j in 0..2 {
            for material in 0..MATERIALS.len() {
                let (mut value, mut deviation) = (0.0, DVec3::ZERO);
                for (i, &w) in w.iter().enumerate() {
                    let d = (normal(i) - Vec3::from(lobes.mu[j])).as_dvec3();
                    let exponent = f64::from(lobes.neg_half_kappa[j][material]) * d.length_squared();
                    value += f64::from(w) * exponent.exp();
                    deviation += f64::from(w) * exponent.exp() * d;
                }
                let found = sums.density[j][material];
                assert!((found.value - value).abs() < 1e-6 * total);
                assert!((DVec3::from(found.deviation) - deviation).length() < 1e-6 * total);
            }
        }
    }
}
