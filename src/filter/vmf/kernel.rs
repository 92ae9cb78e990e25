//! The E-step over a block of normals: the only loop that matters for a fit's speed.
//!
//! Structure of arrays, f32, one version per instruction set chosen at run time ([`super::lanes`]). Sums run in f32
//! within a block of at most [`BLOCK`] samples and in f64 across blocks: a plain f32 mean of 65 536 unit normals would
//! come out longer than 1.

#![expect(clippy::needless_range_loop, reason = "lanes of several arrays are walked by one index, which vectorises")]

use std::cell::RefCell;
use std::f32::consts::{LN_2, LOG2_E};

use multiversion::multiversion;
use multiversion::target::target_cfg_f;

use super::lanes::{LANES, Lanes, exp2_of_negative, halving_sum, lanes, ln_of_positive, mul_add};
use super::lobe_lanes::LobeLanes;
use crate::sphere::mixture::MAX_LOBES;

/// Samples per block; a block's densities of all lobes stay in the first-level cache.
pub const BLOCK: usize = 256;

/// Log-density standing in for `ln 0`, far below any other, and finite so that differences stay numbers.
pub const LOG_ZERO: f32 = -1e30;

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

impl Sums {
    /// Adds the sums of a block, all lanes together.
    #[inline(always)]
    fn add_lanes(&mut self, lanes: &LaneSums, count: usize) {
        for (j, lobe) in lanes.lobes.iter().enumerate().take(count) {
            let [weight, deviation @ ..] = lobe;
            self.weight[j] += f64::from(halving_sum(weight.0));
            for axis in 0..3 {
                self.deviation[j][axis] += f64::from(halving_sum(deviation[axis].0));
            }
        }
        self.log_likelihood += f64::from(halving_sum(lanes.log_likelihood.0));
        self.total += f64::from(halving_sum(lanes.total.0));
    }
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

/// Lobes that the loop can read.
pub trait ReadLobes {
    /// Lobes in use, at most [`MAX_LOBES`].
    fn count(&self) -> usize;

    /// Lobe `j`.
    fn lobe(&self, j: usize) -> LobeLanes;
}

impl ReadLobes for KernelLobes {
    #[inline(always)]
    fn count(&self) -> usize {
        self.count.min(MAX_LOBES)
    }

    #[inline(always)]
    fn lobe(&self, j: usize) -> LobeLanes {
        // Not `map`: it is no part of what is compiled for the instruction set, and called for every lobe.
        let [x, y, z] = self.mu[j];
        LobeLanes {
            mu: [Lanes::splat(x), Lanes::splat(y), Lanes::splat(z)],
            factor: Lanes::splat(self.neg_half_kappa[j] * LOG2_E),
            scale: Lanes::splat(self.log_scale[j] * LOG2_E),
        }
    }
}

/// The sums of an E-step over a block, lane by lane.
#[derive(Clone, Copy, Debug)]
pub struct LaneSums {
    /// `sum_i w_i z_ij`, then that times `n_i - mu_j` by axis.
    pub lobes: [[Lanes; 4]; MAX_LOBES],
    /// `sum_i w_i ln(density of the mixture at n_i)`.
    pub log_likelihood: Lanes,
    /// `sum_i w_i`.
    pub total: Lanes,
}

impl LaneSums {
    /// Nothing yet.
    pub const ZERO: Self = Self {
        lobes: [[Lanes::splat(0.0); 4]; MAX_LOBES],
        log_likelihood: Lanes::splat(0.0),
        total: Lanes::splat(0.0),
    };

    /// Starts anew for `count` lobes.
    #[inline(always)]
    pub fn clear(&mut self, count: usize) {
        self.lobes[..count].fill([Lanes::splat(0.0); 4]);
        (self.log_likelihood, self.total) = (Lanes::splat(0.0), Lanes::splat(0.0));
    }
}

/// Room for an E-step: densities of a block under every lobe in use, group by group and lobe by lobe, and its sums.
pub struct Scratch {
    density: [Lanes; BLOCK / LANES * MAX_LOBES],
    /// The block's sums.
    pub sums: LaneSums,
}

impl Scratch {
    /// Empty room.
    pub const EMPTY: Self = Self { density: [Lanes::splat(0.0); BLOCK / LANES * MAX_LOBES], sums: LaneSums::ZERO };
}

thread_local! {
    /// One for each thread: clearing 16 KiB anew would cost as much as the E-step of a small footprint.
    static SCRATCH: RefCell<Box<Scratch>> = RefCell::new(Box::new(Scratch::EMPTY));
}

/// Adds the E-step of `samples` under `lobes` to `sums`.
pub fn accumulate(samples: &SampleSlices, lobes: &KernelLobes, sums: &mut Sums) {
    SCRATCH.with_borrow_mut(|scratch| accumulate_blocks(samples, lobes, scratch, sums));
}

#[multiversion(targets(
    "x86_64+avx+avx2+bmi1+bmi2+fma+avx512f+avx512bw+avx512dq+avx512vl",
    "x86_64+avx+avx2+bmi1+bmi2+fma",
    "x86_64+sse4.1"
))]
fn accumulate_blocks(samples: &SampleSlices, lobes: &KernelLobes, scratch: &mut Scratch, sums: &mut Sums) {
    const FMA: bool = target_cfg_f!(any(target_feature = "fma", target_arch = "aarch64"));
    for start in (0..samples.x.len()).step_by(BLOCK) {
        let block = samples.range(start, (start + BLOCK).min(samples.x.len()));
        scratch.sums.clear(lobes.count());
        if block.spread.is_empty() {
            sum_block::<FMA, false>(&block, lobes, scratch);
        } else {
            sum_block::<FMA, true>(&block, lobes, scratch);
        }
        sums.add_lanes(&scratch.sums, lobes.count());
    }
}

/// Adds the sums of a block of at most [`BLOCK`] samples: densities first, then each lobe's sums.
#[inline(always)]
pub fn sum_block<const FMA: bool, const SPREAD: bool>(
    samples: &SampleSlices<'_>,
    lobes: &impl ReadLobes,
    scratch: &mut Scratch,
) {
    let Scratch { density, sums } = scratch;
    let count = lobes.count();
    let groups = (samples.x.len() / LANES).min(BLOCK / LANES);
    let mut largest = [Lanes::splat(0.0); BLOCK / LANES];
    let mut scaled = [Lanes::splat(0.0); BLOCK / LANES];
    for group in 0..groups {
        let rows = &mut density[group * count..(group + 1) * count];
        (largest[group], scaled[group]) = densities::<FMA, SPREAD>(samples, group, lobes, rows);
    }
    // Apart from the loop above, whose chain of operations is long enough without a logarithm and a division.
    let mut log_likelihood = Lanes::splat(0.0);
    let mut total = Lanes::splat(0.0);
    for group in 0..groups {
        let w = lanes(samples.w, group);
        let (max, sum) = (&largest[group].0, &mut scaled[group].0);
        for i in 0..LANES {
            let log = mul_add::<FMA>(max[i], LN_2, ln_of_positive::<FMA>(sum[i]));
            log_likelihood.0[i] = mul_add::<FMA>(w[i], log, log_likelihood.0[i]);
            total.0[i] += w[i];
            sum[i] = w[i] / sum[i];
        }
    }
    sums.log_likelihood.add(&log_likelihood);
    sums.total.add(&total);
    for j in 0..count {
        let [mx, my, mz] = lobes.lobe(j).mu;
        let mut acc = [Lanes::splat(0.0); 4];
        for group in 0..groups {
            let (x, y, z) = (lanes(samples.x, group), lanes(samples.y, group), lanes(samples.z, group));
            let (row, scaled) = (&density[group * count + j].0, &scaled[group].0);
            for i in 0..LANES {
                let weight = row[i] * scaled[i];
                acc[0].0[i] += weight;
                acc[1].0[i] = mul_add::<FMA>(weight, x[i] - mx.0[i], acc[1].0[i]);
                acc[2].0[i] = mul_add::<FMA>(weight, y[i] - my.0[i], acc[2].0[i]);
                acc[3].0[i] = mul_add::<FMA>(weight, z[i] - mz.0[i], acc[3].0[i]);
            }
        }
        for part in 0..4 {
            sums.lobes[j][part].add(&acc[part]);
        }
    }
}

/// Every lobe's density over the largest one, for one group of samples: a row a lobe. Returns the largest one's
/// logarithm to base 2, and the sum of the rows.
#[inline(always)]
fn densities<const FMA: bool, const SPREAD: bool>(
    samples: &SampleSlices<'_>,
    group: usize,
    lobes: &impl ReadLobes,
    rows: &mut [Lanes],
) -> (Lanes, Lanes) {
    let (x, y, z) = (lanes(samples.x, group), lanes(samples.y, group), lanes(samples.z, group));
    let spread = if SPREAD { lanes(samples.spread, group) } else { [0.0; LANES] };
    let mut max = Lanes::splat(LOG_ZERO);
    for (j, row) in rows.iter_mut().enumerate() {
        let LobeLanes { mu: [mx, my, mz], factor, scale } = lobes.lobe(j);
        for i in 0..LANES {
            let (dx, dy, dz) = (x[i] - mx.0[i], y[i] - my.0[i], z[i] - mz.0[i]);
            let flat = if SPREAD { mul_add::<FMA>(dx, dx, spread[i]) } else { dx * dx };
            let chord = mul_add::<FMA>(dz, dz, mul_add::<FMA>(dy, dy, flat));
            let log_density = mul_add::<FMA>(factor.0[i], chord, scale.0[i]);
            row.0[i] = log_density;
            max.0[i] = if log_density > max.0[i] { log_density } else { max.0[i] };
        }
    }
    let mut sum = Lanes::splat(0.0);
    for row in rows {
        for i in 0..LANES {
            let value = exp2_of_negative::<FMA>(row.0[i] - max.0[i]);
            row.0[i] = value;
            sum.0[i] += value;
        }
    }
    (max, sum)
}

#[cfg(test)]
mod tests {
    use super::*;

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
