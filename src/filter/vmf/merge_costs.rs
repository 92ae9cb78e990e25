//! What merging one lobe with each of many would cost: the criteria of [`super::merge`] on lanes, a partner a lane.

use std::f32::consts::{PI, TAU};
use std::ops::Range;

use glam::Vec3;
use multiversion::multiversion;
use multiversion::target::target_cfg_f;

use super::lanes::{LANES, exp_of_negative, lanes};
use crate::sphere::mixture::MAX_LOBES;

/// Most candidates a texel has: a box reaches into at most 4 by 4 children.
pub const MAX_CANDIDATES: usize = 16 * MAX_LOBES;

/// A cost for every candidate.
pub type Costs = [f32; MAX_CANDIDATES];

/// The candidates as the loops read them.
#[derive(Clone, Debug)]
pub struct Columns {
    alpha: [f32; MAX_CANDIDATES],
    /// Mean resultant vectors, by axis.
    resultant: [[f32; MAX_CANDIDATES]; 3],
    /// Their directions, by axis.
    mu: [[f32; MAX_CANDIDATES]; 3],
    /// The criterion's own number.
    feature: [f32; MAX_CANDIDATES],
}

impl Columns {
    /// No candidates: such as cost a number, and count for nothing.
    pub const EMPTY: Self = Self {
        alpha: [1.0; MAX_CANDIDATES],
        resultant: [[0.0; MAX_CANDIDATES]; 3],
        mu: [[0.0; MAX_CANDIDATES]; 3],
        feature: [1.0; MAX_CANDIDATES],
    };

    /// Sets one candidate.
    pub fn set(&mut self, index: usize, alpha: f32, resultant: Vec3, feature: f32) {
        (self.alpha[index], self.feature[index]) = (alpha, feature);
        let mu = resultant.try_normalize().unwrap_or(Vec3::ZERO);
        for axis in 0..3 {
            (self.resultant[axis][index], self.mu[axis][index]) = (resultant[axis], mu[axis]);
        }
    }
}

/// [`super::merge::Ward`]'s costs of lobe `i` with each of the first `count`.
#[multiversion(targets(
    "x86_64+avx+avx2+bmi1+bmi2+fma+avx512f+avx512bw+avx512dq+avx512vl",
    "x86_64+avx+avx2+bmi1+bmi2+fma",
    "x86_64+sse4.1"
))]
pub fn ward(columns: &Columns, count: usize, i: usize, costs: &mut Costs) {
    let [x, y, z] = &columns.resultant;
    let (alpha, own) = (columns.alpha[i], [x[i], y[i], z[i]]);
    for (group, costs) in costs.chunks_exact_mut(LANES).enumerate().take(count.div_ceil(LANES)) {
        let (other, x, y, z) = (lanes(&columns.alpha, group), lanes(x, group), lanes(y, group), lanes(z, group));
        for k in 0..LANES {
            let (dx, dy, dz) = (x[k] - own[0], y[k] - own[1], z[k] - own[2]);
            // No fused sums: a map turned by a right angle must cost the same.
            costs[k] = alpha * other[k] / (alpha + other[k]) * (dx * dx + dy * dy + dz * dz);
        }
    }
}

/// [`super::merge::Blurred`]'s costs of lobe `i` with each of the first `count`; `blur` is the material's variance.
#[multiversion(targets(
    "x86_64+avx+avx2+bmi1+bmi2+fma+avx512f+avx512bw+avx512dq+avx512vl",
    "x86_64+avx+avx2+bmi1+bmi2+fma",
    "x86_64+sse4.1"
))]
pub fn blurred(columns: &Columns, count: usize, i: usize, blur: f32, costs: &mut Costs) {
    const FMA: bool = target_cfg_f!(any(target_feature = "fma", target_arch = "aarch64"));
    let ([x, y, z], [mx, my, mz]) = (&columns.resultant, &columns.mu);
    let (alpha, own, mu, feature) = (columns.alpha[i], [x[i], y[i], z[i]], (mx[i], my[i], mz[i]), columns.feature[i]);
    for (group, costs) in costs.chunks_exact_mut(LANES).enumerate().take(count.div_ceil(LANES)) {
        let (x, y, z) = (lanes(x, group), lanes(y, group), lanes(z, group));
        let (mx, my, mz) = (lanes(mx, group), lanes(my, group), lanes(mz, group));
        let (alphas, features) = (lanes(&columns.alpha, group), lanes(&columns.feature, group));
        for k in 0..LANES {
            let (other, both) = (alphas[k], alpha + alphas[k]);
            let inverse = 1.0 / both;
            let (first, second) = (alpha * inverse, other * inverse);
            let rx = first * own[0] + second * x[k];
            let ry = first * own[1] + second * y[k];
            let rz = first * own[2] + second * z[k];
            let square = (rx * rx + ry * ry + rz * rz).min(1.0);
            let length = square.sqrt().max(f32::MIN_POSITIVE);
            // Banerjee's kappa, its inverse at most 10.
            let merged = ((1.0 - square) / (length * (3.0 - square))).min(10.0) + blur;
            let inverse = 1.0 / length;
            let sum = (rx * inverse, ry * inverse, rz * inverse);
            let of_pair = overlap::<FMA>(mu, (mx[k], my[k], mz[k]), feature + features[k]);
            let of_own = overlap::<FMA>(mu, sum, feature + merged);
            let of_other = overlap::<FMA>((mx[k], my[k], mz[k]), sum, features[k] + merged);
            let squares = alpha * alpha / feature + other * other / features[k] + both * both / merged;
            let products = alpha * other * of_pair - both * (alpha * of_own + other * of_other);
            costs[k] = squares / (4.0 * PI) + 2.0 * products;
        }
    }
}

/// The least of the costs in `range`.
#[multiversion(targets(
    "x86_64+avx+avx2+bmi1+bmi2+fma+avx512f+avx512bw+avx512dq+avx512vl",
    "x86_64+avx+avx2+bmi1+bmi2+fma",
    "x86_64+sse4.1"
))]
pub fn least(costs: &Costs, range: &Range<usize>) -> f32 {
    let (start, end) = (range.start as u32, range.end as u32);
    let mut least = [f32::INFINITY; LANES];
    for group in range.start / LANES..range.end.div_ceil(LANES) {
        let (costs, first) = (lanes(costs, group), (group * LANES) as u32);
        for k in 0..LANES {
            let index = first + k as u32;
            let cost = if index >= start && index < end { costs[k] } else { f32::INFINITY };
            least[k] = if cost < least[k] { cost } else { least[k] };
        }
    }
    let mut half = LANES / 2;
    while half > 0 {
        for k in 0..half {
            least[k] = if least[k + half] < least[k] { least[k + half] } else { least[k] };
        }
        half /= 2;
    }
    least[0]
}

/// The integral of the product of two planar Gaussians whose variances sum to `variance`.
#[inline(always)]
fn overlap<const FMA: bool>(a: (f32, f32, f32), b: (f32, f32, f32), variance: f32) -> f32 {
    let (dx, dy, dz) = (a.0 - b.0, a.1 - b.1, a.2 - b.2);
    let inverse = 1.0 / variance;
    exp_of_negative::<FMA>(-0.5 * (dx * dx + dy * dy + dz * dz) * inverse) * inverse / TAU
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::filter::vmf::merge::{Blurred, Candidates, Criterion, Ward};
    use glam::DVec3;

    fn costs_are_those_of_pairs(criterion: &impl Criterion) {
        let mut candidates = Candidates::default();
        for i in 0..20 {
            let angle = f64::from(i);
            let mu = DVec3::new(0.4 * (1.7 * angle).sin(), 0.4 * (2.9 * angle).cos(), 1.0).normalize();
            candidates.push(criterion.candidate(0.02 + 0.005 * angle, mu * (0.8 + 0.009 * angle)));
        }
        let mut costs = [0.0; MAX_CANDIDATES];
        for i in 0..20 {
            criterion.costs(&candidates, i, &mut costs);
            let lobes = candidates.lobes();
            for k in (0..20).filter(|&k| k != i) {
                let exact = criterion.pair_cost(&lobes[i], &lobes[k]);
                // What is left of terms a thousand times as large, in single precision.
                assert!((f64::from(costs[k]) - exact).abs() < 1e-6 + 1e-4 * exact, "{i}, {k}: {} {exact}", costs[k]);
            }
        }
    }

    #[test]
    fn costs_on_lanes_are_those_of_pairs() {
        costs_are_those_of_pairs(&Ward);
        costs_are_those_of_pairs(&Blurred { shininess: 64.0 });
    }
}
