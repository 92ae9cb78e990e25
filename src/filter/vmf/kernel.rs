//! The E-step over a block of normals: the only loop that matters for a fit's speed.
//!
//! Structure of arrays, f32, one version per instruction set chosen at run time. The arithmetic is written without
//! fused multiply-adds, so every version and every processor gives the same bits. Sums run in f32 within a block of
//! at most [`BLOCK`] samples and in f64 across blocks: a plain f32 mean of 65 536 unit normals would come out
//! longer than 1.

#![expect(clippy::needless_range_loop, reason = "lanes of several arrays are walked by one index, which vectorises")]

use std::cell::RefCell;

use multiversion::multiversion;

use crate::sphere::mixture::MAX_LOBES;

/// Samples are padded to a multiple of this with weight 0.
pub const LANES: usize = 16;

/// Samples per block; a block's densities of all lobes stay in the first-level cache.
pub const BLOCK: usize = 256;

/// Log-density standing in for `ln 0`, far below any other, and finite so that differences stay numbers.
const LOG_ZERO: f32 = -1e30;

/// The lobes of a mixture as the loop reads them.
#[derive(Clone, Copy, Debug)]
pub struct KernelLobes {
    /// Lobes in use; the arrays beyond hold nothing.
    pub count: usize,
    /// Mean directions.
    pub mu: [[f32; 3]; MAX_LOBES],
    /// `-kappa / 2`, the factor on `|n - mu|^2`.
    pub neg_half_kappa: [f32; MAX_LOBES],
    /// `ln(alpha) + ln(peak density)`.
    pub log_scale: [f32; MAX_LOBES],
}

impl Default for KernelLobes {
    fn default() -> Self {
        Self { count: 0, mu: [[0.0; 3]; MAX_LOBES], neg_half_kappa: [0.0; MAX_LOBES], log_scale: [LOG_ZERO; MAX_LOBES] }
    }
}

/// What an E-step leaves for the M-step.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Sums {
    /// `sum_i w_i z_ij`.
    pub weight: [f64; MAX_LOBES],
    /// `sum_i w_i z_ij (n_i - mu_j)`.
    pub deviation: [[f64; 3]; MAX_LOBES],
    /// `sum_i w_i ln(density of the mixture at n_i)`.
    pub log_likelihood: f64,
    /// `sum_i w_i`.
    pub total: f64,
}

impl std::ops::AddAssign<&Self> for Sums {
    /// Adds the sums of further samples.
    fn add_assign(&mut self, other: &Self) {
        for j in 0..MAX_LOBES {
            self.weight[j] += other.weight[j];
            for axis in 0..3 {
                self.deviation[j][axis] += other.deviation[j][axis];
            }
        }
        self.log_likelihood += other.log_likelihood;
        self.total += other.total;
    }
}

/// Normals and weights as structure of arrays; equal lengths, a multiple of [`LANES`].
#[derive(Clone, Copy, Debug)]
pub struct SampleSlices<'a> {
    /// x components.
    pub x: &'a [f32],
    /// y components.
    pub y: &'a [f32],
    /// z components.
    pub z: &'a [f32],
    /// Weights, 0 for padding and invalid texels.
    pub w: &'a [f32],
    /// `1 - |n|^2` where a sample is the mean of several normals; empty where every sample is one normal. With it
    /// `|n - mu|^2 + spread` is twice `1 - n.mu`, whatever the length of n.
    pub spread: &'a [f32],
}

impl<'a> SampleSlices<'a> {
    /// Samples `start..end`.
    #[inline(always)]
    pub fn range(&self, start: usize, end: usize) -> SampleSlices<'a> {
        SampleSlices {
            x: &self.x[start..end],
            y: &self.y[start..end],
            z: &self.z[start..end],
            w: &self.w[start..end],
            spread: if self.spread.is_empty() { self.spread } else { &self.spread[start..end] },
        }
    }
}

/// `exp(v)` for `v <= 0`, relative error 2e-7, 0 below -87: the reduction and polynomial of Cephes (Moshier 1992),
/// written without branches so that it vectorises.
#[inline(always)]
pub(super) fn exp_of_negative(v: f32) -> f32 {
    const ROUND: f32 = 12_582_912.0; // 1.5 * 2^23: adding it rounds to an integer in the low mantissa bits.
    let v = v.max(-87.0);
    let shifted = v * std::f32::consts::LOG2_E + ROUND;
    let n = shifted - ROUND;
    let r = (v - n * 0.693_359_4) + n * 2.121_944_4e-4;
    let p = 1.987_569_1e-4;
    let p = p * r + 1.398_199_9e-3;
    let p = p * r + 8.333_452e-3;
    let p = p * r + 4.166_579_6e-2;
    let p = p * r + 1.666_666_5e-1;
    let p = p * r + 5.000_000_3e-1;
    let p = p * r * r + r + 1.0;
    let exponent = shifted.to_bits().wrapping_shl(23);
    f32::from_bits(p.to_bits().wrapping_add(exponent))
}

/// `ln(v)` for normal positive `v`, relative error 1e-6: the polynomial of Cephes (Moshier 1992) without branches.
#[inline(always)]
fn ln_of_positive(v: f32) -> f32 {
    // Mantissa in 1/sqrt(2) .. sqrt(2).
    let bits = v.to_bits().wrapping_sub(0x3f35_04f3);
    let exponent = (bits as i32 >> 23) as f32;
    let m = f32::from_bits((bits & 0x007f_ffff).wrapping_add(0x3f35_04f3)) - 1.0;
    let p = 7.037_683_6e-2;
    let p = p * m - 1.151_461e-1;
    let p = p * m + 1.167_699_9e-1;
    let p = p * m - 1.242_014_1e-1;
    let p = p * m + 1.424_932_3e-1;
    let p = p * m - 1.666_805_8e-1;
    let p = p * m + 2.000_071_5e-1;
    let p = p * m - 2.499_999_4e-1;
    let p = p * m + 3.333_333e-1;
    m + (m * m * (m * p - 0.5) + exponent * std::f32::consts::LN_2)
}

/// Densities of a block under every lobe.
type Density = [[f32; BLOCK]; MAX_LOBES];

thread_local! {
    /// One for each thread: clearing 16 KiB anew would cost as much as the E-step of a small footprint.
    static DENSITY: RefCell<Box<Density>> = RefCell::new(Box::new([[0.0; BLOCK]; MAX_LOBES]));
}

/// Adds the E-step of `samples` under `lobes` to `sums`.
pub fn accumulate(samples: &SampleSlices, lobes: &KernelLobes, sums: &mut Sums) {
    DENSITY.with_borrow_mut(|density| accumulate_blocks(samples, lobes, density, sums));
}

#[multiversion(targets(
    "x86_64+avx+avx2+bmi1+bmi2+fma+avx512f+avx512bw+avx512dq+avx512vl",
    "x86_64+avx+avx2+bmi1+bmi2+fma",
    "x86_64+sse4.1"
))]
fn accumulate_blocks(samples: &SampleSlices, lobes: &KernelLobes, density: &mut Density, sums: &mut Sums) {
    let mut start = 0;
    while start < samples.x.len() {
        let end = (start + BLOCK).min(samples.x.len());
        let block = samples.range(start, end);
        if block.spread.is_empty() {
            accumulate_block::<false>(block, lobes, density, sums);
        } else {
            accumulate_block::<true>(block, lobes, density, sums);
        }
        start = end;
    }
}

#[inline(always)]
pub(super) fn lanes(slice: &[f32], group: usize) -> &[f32; LANES] {
    match slice[group * LANES..].first_chunk() {
        Some(lanes) => lanes,
        None => &[0.0; LANES],
    }
}

#[inline(always)]
fn lanes_mut(row: &mut [f32; BLOCK], group: usize) -> &mut [f32] {
    &mut row[group * LANES..(group + 1) * LANES]
}

#[inline(always)]
fn accumulate_block<const SPREAD: bool>(
    samples: SampleSlices<'_>,
    lobes: &KernelLobes,
    density: &mut Density,
    sums: &mut Sums,
) {
    let groups = samples.x.len() / LANES;
    let count = lobes.count.min(MAX_LOBES);
    let mut scaled = [[0.0_f32; LANES]; BLOCK / LANES];
    let mut log_likelihood = [0.0_f32; LANES];
    let mut total = [0.0_f32; LANES];
    for group in 0..groups {
        let (x, y, z, w) =
            (lanes(samples.x, group), lanes(samples.y, group), lanes(samples.z, group), lanes(samples.w, group));
        let spread = if SPREAD { lanes(samples.spread, group) } else { &[0.0; LANES] };
        let mut max = [LOG_ZERO; LANES];
        for j in 0..count {
            let ([mx, my, mz], k, l) = (lobes.mu[j], lobes.neg_half_kappa[j], lobes.log_scale[j]);
            let row = lanes_mut(&mut density[j], group);
            for i in 0..LANES {
                let (dx, dy, dz) = (x[i] - mx, y[i] - my, z[i] - mz);
                let chord = dx * dx + dy * dy + dz * dz;
                let log_density = l + k * if SPREAD { chord + spread[i] } else { chord };
                row[i] = log_density;
                max[i] = if log_density > max[i] { log_density } else { max[i] };
            }
        }
        let mut sum = [0.0_f32; LANES];
        for row in density.iter_mut().take(count) {
            let row = lanes_mut(row, group);
            for i in 0..LANES {
                let value = exp_of_negative(row[i] - max[i]);
                row[i] = value;
                sum[i] += value;
            }
        }
        for i in 0..LANES {
            scaled[group][i] = w[i] / sum[i];
            log_likelihood[i] += w[i] * (max[i] + ln_of_positive(sum[i]));
            total[i] += w[i];
        }
    }
    sums.log_likelihood += widened_sum(&log_likelihood);
    sums.total += widened_sum(&total);
    for j in 0..count {
        let mut acc = [[0.0_f32; LANES]; 4];
        let [mx, my, mz] = lobes.mu[j];
        for group in 0..groups {
            let (x, y, z) = (lanes(samples.x, group), lanes(samples.y, group), lanes(samples.z, group));
            let row = lanes_mut(&mut density[j], group);
            for i in 0..LANES {
                let weight = row[i] * scaled[group][i];
                acc[0][i] += weight;
                acc[1][i] += weight * (x[i] - mx);
                acc[2][i] += weight * (y[i] - my);
                acc[3][i] += weight * (z[i] - mz);
            }
        }
        sums.weight[j] += widened_sum(&acc[0]);
        for axis in 0..3 {
            sums.deviation[j][axis] += widened_sum(&acc[axis + 1]);
        }
    }
}

#[inline(always)]
fn widened_sum(lanes: &[f32; LANES]) -> f64 {
    lanes.iter().map(|&v| f64::from(v)).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn exp_and_ln_are_right_to_a_few_units_in_the_last_place() {
        for i in 0..8700 {
            let v = -f64::from(i) / 100.0;
            let exact = f64::from(v as f32).exp();
            assert!((f64::from(exp_of_negative(v as f32)) / exact - 1.0).abs() < 3e-7, "exp {v}");
        }
        for i in 1..2000 {
            let v = f64::from(i) / 100.0;
            assert!((f64::from(ln_of_positive(v as f32)) - f64::from(v as f32).ln()).abs() < 1e-6, "ln {v}");
        }
    }

    #[test]
    fn the_block_loop_equals_the_plain_sums_in_f64() {
        let n = 5 * LANES + BLOCK;
        let normal =
            |i: usize| glam::DVec3::new((i as f64 * 0.7).sin() * 0.4, (i as f64 * 1.3).cos() * 0.3, 1.0).normalize();
        let column = |axis: usize| (0..n).map(|i| normal(i)[axis] as f32).collect::<Vec<_>>();
        let (x, y, z) = (column(0), column(1), column(2));
        let w: Vec<f32> = (0..n).map(|i| if i % 7 == 0 { 0.0 } else { 0.5 + (i % 3) as f32 }).collect();
        let mut lobes = KernelLobes { count: 3, ..Default::default() };
        for j in 0..3 {
            let mu = glam::Vec3::new(j as f32 * 0.2 - 0.2, 0.1, 1.0).normalize();
            lobes.mu[j] = mu.to_array();
            lobes.neg_half_kappa[j] = -5.0 * (j + 1) as f32;
            lobes.log_scale[j] = 0.3 * j as f32 - 1.0;
        }
        let mut fast = Sums::default();
        accumulate(&SampleSlices { x: &x, y: &y, z: &z, w: &w, spread: &[] }, &lobes, &mut fast);
        let mut plain = Sums::default();
        for i in 0..n {
            let p = glam::Vec3::new(x[i], y[i], z[i]).as_dvec3();
            let d: Vec<f64> = (0..3)
                .map(|j| {
                    let mu = glam::Vec3::from(lobes.mu[j]).as_dvec3();
                    (f64::from(lobes.log_scale[j]) + f64::from(lobes.neg_half_kappa[j]) * (p - mu).length_squared())
                        .exp()
                })
                .collect();
            let (sum, weight) = (d.iter().sum::<f64>(), f64::from(w[i]));
            plain.total += weight;
            plain.log_likelihood += weight * sum.ln();
            for j in 0..3 {
                plain.weight[j] += weight * d[j] / sum;
                let deviation = p - glam::Vec3::from(lobes.mu[j]).as_dvec3();
                for axis in 0..3 {
                    plain.deviation[j][axis] += weight * d[j] / sum * deviation[axis];
                }
            }
        }
        assert!((fast.log_likelihood - plain.log_likelihood).abs() < 1e-5 * plain.total);
        for j in 0..3 {
            assert!((fast.weight[j] - plain.weight[j]).abs() < 1e-6 * plain.total);
            for axis in 0..3 {
                assert!((fast.deviation[j][axis] - plain.deviation[j][axis]).abs() < 1e-6 * plain.total);
            }
        }
    }
}
